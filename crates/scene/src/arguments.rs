//! How many arguments each type takes (scene.md 17), checked when a primitive is first evaluated, and the transforms
//! that may end a list of strings (scene.md 6.3).

use crate::{Error, Kind, ObjectId, Problem, Scene};
use ambit_base::Transform;
use ambit_file::text_of;

/// How many real arguments a type takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RealCount {
    /// Any number.
    Any,
    /// Exactly so many.
    Exactly(usize),
    /// So many or more.
    AtLeast(usize),
    /// So many or fewer.
    AtMost(usize),
    /// From the first to the second number.
    Between(usize, usize),
    /// A multiple of three, from the first to the second number.
    Triples(usize, usize),
}

impl RealCount {
    /// True if `n` real arguments are right.
    pub fn allows(self, n: usize) -> bool {
        match self {
            Self::Any => true,
            Self::Exactly(k) => n == k,
            Self::AtLeast(k) => n >= k,
            Self::AtMost(k) => n <= k,
            Self::Between(a, b) => (a..=b).contains(&n),
            Self::Triples(a, b) => (a..=b).contains(&n) && n.is_multiple_of(3),
        }
    }
}

/// What a type asks of its arguments. Surplus strings are never an error here; where a transform may follow they must
/// then form one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arguments {
    /// Fewest string arguments.
    pub strings: usize,
    /// Number of real arguments.
    pub reals: RealCount,
    /// True if a transform may follow the strings.
    pub transform: bool,
    /// How a wrong number of reals is worded (it is looked at first).
    bad_reals: Problem,
    /// How too few strings are worded.
    bad_strings: Problem,
}

impl Kind {
    /// What the type asks of its arguments.
    pub fn arguments(self) -> Arguments {
        use Kind as K;
        use Problem as P;
        use RealCount::{Any, AtLeast, AtMost, Between, Exactly, Triples};
        // Most types word both faults alike.
        let entry = |strings, reals, transform, problem| Arguments {
            strings,
            reals,
            transform,
            bad_reals: problem,
            bad_strings: problem,
        };
        let plain = |reals| entry(0, reals, false, P::BadNumberOfArguments);
        let medium = |reals| entry(0, reals, false, P::BadArguments);
        let counted = |strings, reals| entry(strings, reals, false, P::BadArgumentCount);
        let moved = |strings, reals| entry(strings, reals, true, P::BadArgumentCount);
        let prism = |strings| entry(strings, Any, true, P::TooFewStrings);
        let anisotropic = |reals| Arguments {
            strings: 4,
            reals: Exactly(reals),
            transform: true,
            bad_reals: P::BadNumberOfRealArguments,
            bad_strings: P::TooFewStrings,
        };
        match self {
            K::Polygon => counted(0, Triples(9, usize::MAX)),
            K::Cone | K::Cup | K::Ring => counted(0, Exactly(8)),
            K::Cylinder | K::Tube | K::Spotlight => counted(0, Exactly(7)),
            K::Sphere | K::Bubble | K::Source => medium(Exactly(4)),
            K::Instance | K::Mesh => entry(1, Any, true, P::BadCountOfArguments),
            K::Alias => counted(0, Any),
            K::Plastic | K::Metal => plain(Exactly(5)),
            K::Trans => plain(Exactly(7)),
            K::Mirror => plain(Exactly(3)),
            K::Glass => medium(Between(3, 4)),
            K::Dielectric => medium(Exactly(5)),
            K::Interface => medium(Exactly(8)),
            K::Mist => medium(AtMost(7)),
            K::Plastic2 | K::Metal2 => anisotropic(6),
            K::Trans2 | K::Ashik2 => anisotropic(8),
            K::Light | K::Illum => counted(0, Exactly(3)),
            K::Glow => counted(0, Exactly(4)),
            K::Antimatter | K::SpecFile => counted(1, Any),
            K::PlasFunc | K::MetFunc => moved(2, AtLeast(4)),
            K::TransFunc => moved(2, AtLeast(6)),
            K::PlasData | K::MetData => moved(4, AtLeast(4)),
            K::TransData => moved(4, AtLeast(6)),
            K::BrtdFunc => moved(10, AtLeast(9)),
            K::Bsdf => moved(6, Triples(0, 9)),
            K::ABsdf => moved(5, Triples(0, 9)),
            K::WgmdFunc => entry(13, AtLeast(9), true, P::BadNumberOfArguments),
            K::Prism1 => prism(5),
            K::Prism2 => prism(9),
            K::BrightFunc => moved(2, Any),
            K::SpecFunc => moved(2, AtLeast(2)),
            K::TexFunc | K::ColorFunc | K::BrightData | K::SpecData | K::MixFunc => moved(4, Any),
            K::SpecPict => moved(5, Any),
            K::MixData => moved(6, Any),
            K::ColorPict | K::MixPict => moved(7, Any),
            K::ColorData | K::TexData => moved(8, Any),
            K::BrightText => counted(2, AtLeast(11)),
            K::ColorText => counted(2, AtLeast(15)),
            K::MixText => counted(4, AtLeast(9)),
            K::Spectrum => counted(0, AtLeast(5)),
        }
    }
}

/// Where a transform among string arguments begins.
const TRANSFORM_WORDS: [&[u8]; 9] = [b"-t", b"-s", b"-i", b"-rx", b"-ry", b"-rz", b"-mx", b"-my", b"-mz"];

impl Scene {
    /// Checks the number of arguments of a primitive, in the words of its type. `oconv` leaves this to whoever first
    /// evaluates a modifier.
    pub fn check_arguments(&self, id: ObjectId) -> Result<(), Error> {
        let rules = self.object(id).kind.arguments();
        if !rules.reals.allows(self.reals(id).len()) {
            return Err(self.problem(id, rules.bad_reals));
        }
        if self.string_count(id) < rules.strings {
            return Err(self.problem(id, rules.bad_strings));
        }
        Ok(())
    }

    /// The transform that ends the string arguments, looked for from string `first` (from 0) on.
    ///
    /// For instance and mesh every word must belong to it. For modifiers it begins at the first word that is a transform
    /// option, what comes before is skipped, and without one there is no transform.
    pub fn trailing_transform(&self, id: ObjectId, first: usize) -> Result<Transform, Error> {
        let is_volume = matches!(self.object(id).kind, Kind::Instance | Kind::Mesh);
        let words: Vec<_> = self
            .strings_bytes(id)
            .skip(first)
            .skip_while(|word| !is_volume && !TRANSFORM_WORDS.contains(word))
            .map(text_of)
            .collect();
        Transform::parse(&words).map_err(|_| self.problem(id, Problem::BadTransform))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{KINDS, NewObject, VOID};
    use ambit_base::DVec3;

    fn one(kind: Kind, strings: &[&[u8]], reals: usize) -> Scene {
        let mut scene = Scene::new();
        let reals = vec![0.5; reals];
        scene.push(NewObject { kind, modifier: VOID, name: b"m", strings, reals: &reals, file: 0, line: 0 });
        scene
    }

    fn complaint(kind: Kind, strings: usize, reals: usize) -> Option<String> {
        let words = vec![&b"0"[..]; strings];
        one(kind, &words, reals).check_arguments(0).err().map(|e| e.to_string())
    }

    /// As `rtrace` worded it, for the type, its strings and its reals.
    #[test]
    fn wrong_counts_are_worded_by_type() {
        for (kind, strings, reals, text) in [
            (Kind::Plastic, 0, 4, "bad number of arguments for plastic \"m\""),
            (Kind::Metal, 0, 6, "bad number of arguments for metal \"m\""),
            (Kind::Glass, 0, 5, "bad arguments for glass \"m\""),
            (Kind::Dielectric, 0, 4, "bad arguments for dielectric \"m\""),
            (Kind::Plastic2, 3, 20, "bad number of real arguments for plastic2 \"m\""),
            (Kind::Plastic2, 3, 6, "too few string arguments for plastic2 \"m\""),
            (Kind::Ashik2, 0, 0, "bad number of real arguments for ashik2 \"m\""),
            (Kind::PlasFunc, 2, 3, "bad # arguments for plasfunc \"m\""),
            (Kind::TransData, 4, 5, "bad # arguments for transdata \"m\""),
            (Kind::Bsdf, 6, 1, "bad # arguments for BSDF \"m\""),
            (Kind::ABsdf, 5, 10, "bad # arguments for aBSDF \"m\""),
            (Kind::WgmdFunc, 12, 9, "bad number of arguments for WGMDfunc \"m\""),
            (Kind::Prism2, 8, 0, "too few string arguments for prism2 \"m\""),
            (Kind::BrightText, 2, 10, "bad # arguments for brighttext \"m\""),
            (Kind::Mist, 0, 8, "bad arguments for mist \"m\""),
            (Kind::Antimatter, 0, 0, "bad # arguments for antimatter \"m\""),
            (Kind::Spectrum, 0, 4, "bad # arguments for spectrum \"m\""),
            (Kind::SpecFunc, 2, 1, "bad # arguments for specfunc \"m\""),
            (Kind::Instance, 0, 0, "bad # of arguments for instance \"m\""),
        ] {
            assert_eq!(complaint(kind, strings, reals).as_deref(), Some(text));
        }
        for (kind, strings, reals) in [
            (Kind::Plastic, 2, 5),
            (Kind::Glass, 0, 3),
            (Kind::Glass, 0, 4),
            (Kind::Mist, 1, 4),
            (Kind::Antimatter, 1, 2),
            (Kind::BrightText, 2, 13),
            (Kind::Bsdf, 9, 9),
            (Kind::Illum, 3, 3),
            (Kind::Polygon, 0, 12),
        ] {
            assert_eq!(complaint(kind, strings, reals), None);
        }
    }

    #[test]
    fn every_type_accepts_its_fewest_arguments() {
        for (kind, ..) in KINDS {
            let rules = kind.arguments();
            let reals = (0..20).find(|&n| rules.reals.allows(n)).expect("some number is right");
            assert_eq!(complaint(kind, rules.strings, reals), None);
        }
    }

    #[test]
    fn transforms_end_the_strings() {
        let at = |kind, text: &str| {
            let words: Vec<&[u8]> = text.split(' ').map(str::as_bytes).collect();
            one(kind, &words, 0).trailing_transform(0, 2).map(|t| t.point(DVec3::X).x).map_err(|e| e.to_string())
        };
        let bad = || Err("bad transform for brightfunc \"m\"".to_owned());
        for (text, expected) in [
            ("Px . -s 2 -t 1 0 0", Ok(3.0)),
            ("Px . zork -t 1 0 0", Ok(2.0)),
            ("Px . zork", Ok(1.0)),
            ("Px . -a 2", Ok(1.0)),
            ("Px . .-t 1", Ok(1.0)),
            ("Px .", Ok(1.0)),
            ("Px . -t 1 2", bad()),
            ("Px . -s 0", bad()),
            ("Px . -t 1 0 0 zork", bad()),
            ("Px . -t 1 0 0 -a 2", bad()),
            ("Px . -s 2 -i", bad()),
            ("Px . -rx x", bad()),
        ] {
            assert_eq!(at(Kind::BrightFunc, text), expected, "{text}");
        }
        let volume = |words: &[&[u8]]| one(Kind::Instance, words, 0).trailing_transform(0, 1).map(|t| t.scale());
        assert_eq!(volume(&[b"in.oct", b"-mx", b"-s", b"2"]).unwrap(), -2.0);
        assert_eq!(volume(&[b"in.oct"]).unwrap(), 1.0);
        let error = volume(&[b"in.oct", b"zork", b"-mx"]).unwrap_err();
        assert_eq!(error.to_string(), "bad transform for instance \"m\"");
    }
}
