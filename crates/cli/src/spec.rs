//! What `rtrace -o…` writes of a ray.

use crate::failure::Failure;

/// One field of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    /// `o`: origin.
    Origin,
    /// `d`: unit direction.
    Direction,
    /// `v`: radiance or irradiance.
    Value,
    /// `V`: value times coefficient.
    Contribution,
    /// `w`: weight.
    Weight,
    /// `W`: coefficient.
    Coefficient,
    /// `l`: effective length.
    Length,
    /// `L`: distance to the first surface.
    FirstLength,
    /// `c`: local coordinates.
    Coordinates,
    /// `p`: intersection.
    Point,
    /// `n`: shading normal.
    Normal,
    /// `N`: geometric normal.
    GeometricNormal,
    /// `s`: name of the surface.
    Surface,
    /// `m`: name of its modifier.
    Modifier,
    /// `M`: name of its material.
    Material,
    /// `r`: mirrored part of the value.
    Mirrored,
    /// `x`: the other part.
    Unmirrored,
    /// `R`: distance of what is mirrored.
    MirroredLength,
    /// `X`: distance of what is not.
    UnmirroredLength,
    /// `~`: a tilde.
    Tilde,
}

use Field as F;

/// The letters, and the words of `-defaults` (which has none for coordinates).
const LETTERS: [(char, Field, &str); 20] = [
    ('o', F::Origin, "origin"),
    ('d', F::Direction, "direction"),
    ('r', F::Mirrored, "reflect_contrib"),
    ('R', F::MirroredLength, "reflect_length"),
    ('x', F::Unmirrored, "unreflect_contrib"),
    ('X', F::UnmirroredLength, "unreflect_length"),
    ('v', F::Value, "value"),
    ('V', F::Contribution, "contribution"),
    ('l', F::Length, "length"),
    ('L', F::FirstLength, "first_length"),
    ('c', F::Coordinates, ""),
    ('p', F::Point, "point"),
    ('n', F::Normal, "normal"),
    ('N', F::GeometricNormal, "unperturbed_normal"),
    ('s', F::Surface, "surface"),
    ('w', F::Weight, "weight"),
    ('W', F::Coefficient, "coefficient"),
    ('m', F::Modifier, "modifier"),
    ('M', F::Material, "material"),
    ('~', F::Tilde, "tilde"),
];

/// The words that `-defaults` prints for the letters, each after a blank; unknown letters have none.
pub(crate) fn spec_words(letters: &str) -> String {
    let word = |c: char| match c {
        't' | 'T' => " trace".to_owned(),
        c => match LETTERS.iter().find(|row| row.0 == c) {
            Some((.., word)) if !word.is_empty() => format!(" {word}"),
            _ => String::new(),
        },
    };
    letters.chars().map(word).collect()
}

/// What is written of every ray of a tree.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TreeSpec {
    /// The fields.
    pub fields: Vec<Field>,
    /// `T`: shadow rays that reach their source are written, too.
    pub shadows: bool,
}

/// The fields of a record, in order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputSpec {
    /// The fields of the primary ray, written when it has been answered.
    pub fields: Vec<Field>,
    /// `t` or `T`: what is written of every ray that follows from it, before that.
    pub tree: Option<TreeSpec>,
}

impl OutputSpec {
    /// Reads the letters after `-o`: those before the first `t` or `T` are the record's, those after the last one the
    /// tree's. One with no letter after it means nothing.
    ///
    /// # Errors
    /// For no letter, and for a letter that is none.
    pub fn parse(letters: &str) -> Result<Self, Failure> {
        if letters.is_empty() {
            return Err(Failure::user("empty output specification"));
        }
        let (mut fields, mut tree) = (Vec::new(), None);
        for c in letters.trim_end_matches(['t', 'T']).chars() {
            match LETTERS.iter().find(|row| row.0 == c) {
                Some(row) => tree.as_mut().unwrap_or(&mut fields).push(row.1),
                None if c == 't' || c == 'T' => tree = Some(Vec::new()),
                None => {
                    let known: String = LETTERS.iter().map(|row| row.0).chain(['t', 'T']).collect();
                    let text = format!("unrecognized output option '{c}' (expected letters of {known})");
                    return Err(Failure::user(text));
                }
            }
        }
        let tree = tree.map(|fields| TreeSpec { fields, shadows: letters.contains('T') });
        Ok(Self { fields, tree })
    }

    /// True if a field needs the ray to be shaded, not only cast. Trees always do.
    pub fn shades(&self) -> bool {
        use Field::{
            Coefficient, Contribution, Length, Mirrored, MirroredLength, Normal, Unmirrored, UnmirroredLength, Value,
        };
        let shaded = |f: &Field| {
            matches!(
                f,
                Value
                    | Contribution
                    | Coefficient
                    | Length
                    | Normal
                    | Mirrored
                    | Unmirrored
                    | MirroredLength
                    | UnmirroredLength
            )
        };
        self.tree.is_some() || self.fields.iter().any(shaded)
    }

    /// True if a field of the record is one of these.
    pub fn has(&self, fields: &[Field]) -> bool {
        self.fields.iter().any(|f| fields.contains(f))
    }

    /// How many values a record has, if a colour has `channels`: names count as one, a tilde as none.
    pub fn components(&self, channels: usize) -> usize {
        self.fields
            .iter()
            .map(|f| match f {
                F::Origin | F::Direction | F::Point | F::Normal | F::GeometricNormal => 3,
                F::Value | F::Contribution | F::Coefficient | F::Mirrored | F::Unmirrored => channels,
                F::Coordinates => 2,
                F::Tilde => 0,
                _ => 1,
            })
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_become_fields() {
        let spec = OutputSpec::parse("odvpNs~").unwrap();
        assert_eq!(spec.components(3), 16);
        assert_eq!(spec.components(1), 14);
        assert!(spec.shades());
        assert!(!OutputSpec::parse("odLcpNsmMw~").unwrap().shades());
        let plain = OutputSpec::parse("vt").unwrap();
        assert_eq!((&plain.fields[..], plain.tree), (&[Field::Value][..], None));
        for (letters, text) in [
            ("", "empty output specification"),
            ("vq", "unrecognized output option 'q' (expected letters of odrRxXvVlLcpnNswWmM~tT)"),
        ] {
            assert_eq!(OutputSpec::parse(letters).unwrap_err().text, text);
        }
    }

    #[test]
    fn letters_after_a_t_are_the_trees() {
        let spec = |letters| {
            let spec = OutputSpec::parse(letters).unwrap();
            let tree = spec.tree.unwrap();
            (spec.fields, tree.fields, tree.shadows)
        };
        assert_eq!(spec("ts"), (vec![], vec![Field::Surface], false));
        assert_eq!(spec("vTsd"), (vec![Field::Value], vec![Field::Surface, Field::Direction], true));
        assert_eq!(spec("sTvtp"), (vec![Field::Surface], vec![Field::Point], true));
        assert_eq!(spec("sTvt"), (vec![Field::Surface], vec![Field::Value], true));
        assert!(OutputSpec::parse("tv").unwrap().shades());
    }
}
