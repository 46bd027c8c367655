//! Primitives back to scene text, such that reading it gives the same primitives.

use crate::{Kind, ObjectId, Scene, VOID};
use std::io::{Result, Write};

impl Scene {
    /// Writes a primitive as scene text: words quoted where needed, numbers with as many digits as it takes to read the
    /// same `f64` again. Its modifier is named, so the text means the same where that name does.
    ///
    /// # Errors
    /// Only those of `out`.
    pub fn print(&self, id: ObjectId, out: &mut impl Write) -> Result<()> {
        let object = self.object(id);
        let is_name = object.kind == Kind::Alias && self.string_count(id) == 0;
        match object.modifier {
            // What merely names its modifier inherits everything from it.
            _ if is_name => out.write_all(b"inherit")?,
            VOID => out.write_all(b"void")?,
            modifier => print_word(self.name_bytes(modifier), out)?,
        }
        write!(out, " {} ", object.kind.name())?;
        print_word(self.name_bytes(id), out)?;
        if object.kind == Kind::Alias {
            let target = if object.modifier == VOID { b"void" } else { self.name_bytes(object.modifier) };
            out.write_all(b" ")?;
            print_word(self.string_bytes(id, 0).unwrap_or(target), out)?;
            return out.write_all(b"\n");
        }
        write!(out, "\n{}", self.string_count(id))?;
        for word in self.strings_bytes(id) {
            out.write_all(b" ")?;
            print_word(word, out)?;
        }
        write!(out, "\n0\n{}", self.reals(id).len())?;
        for &x in self.reals(id) {
            out.write_all(b" ")?;
            print_real(x, out)?;
        }
        out.write_all(b"\n")
    }
}

/// A word, quoted if it is empty or has white space or quotes in it.
pub(crate) fn print_word(word: &[u8], out: &mut impl Write) -> Result<()> {
    let special = |b: &u8| crate::grammar::is_white(*b) || matches!(b, b'"' | b'\'');
    if !word.is_empty() && !word.iter().any(special) && !matches!(word[0], b'#' | b'!') {
        return out.write_all(word);
    }
    // Each piece in the quotes that it does not contain itself.
    let mut rest = word;
    loop {
        let quote = if rest.first() == Some(&b'"') { b'\'' } else { b'"' };
        let length = rest.iter().position(|&b| b == quote).unwrap_or(rest.len());
        out.write_all(&[quote])?;
        out.write_all(&rest[..length])?;
        out.write_all(&[quote])?;
        rest = &rest[length..];
        if rest.is_empty() {
            return Ok(());
        }
    }
}

fn print_real(x: f64, out: &mut impl Write) -> Result<()> {
    // Scene text has no word for infinity but numbers that are too large.
    if x.is_infinite() {
        return out.write_all(if x > 0.0 { b"1e999" } else { b"-1e999" });
    }
    let size = x.abs();
    // Sizes at which an exponent makes the shorter word.
    if size != 0.0 && !(1e-5..1e16).contains(&size) { write!(out, "{x:e}") } else { write!(out, "{x}") }
}

#[cfg(test)]
mod tests {
    use crate::{Axis, DataTable, Font, KINDS, Kind, NewObject, NoCommands, ObjectId, Reader, Scene, Shape, VOID};
    use ambit_base::Silent;
    use proptest::collection::vec;
    use proptest::prelude::*;

    fn read(bytes: &[u8]) -> Result<Scene, crate::Error> {
        let mut scene = Scene::new();
        Reader::new(&mut scene, &Silent, &mut NoCommands).read_bytes("t.rad", bytes)?;
        Ok(scene)
    }

    fn print_all(scene: &Scene) -> Vec<u8> {
        let mut text = Vec::new();
        scene.ids().for_each(|id| scene.print(id, &mut text).unwrap());
        text
    }

    /// A primitive's type, modifier, name, strings and numbers, the latter by their bits.
    type Parts = (Kind, ObjectId, Vec<u8>, Vec<Vec<u8>>, Vec<u64>);

    fn parts(scene: &Scene) -> Vec<Parts> {
        let of = |id| {
            let o = scene.object(id);
            let strings = scene.strings_bytes(id).map(<[u8]>::to_vec).collect();
            let reals = scene.reals(id).iter().map(|x| x.to_bits()).collect();
            (o.kind, o.modifier, scene.name_bytes(id).to_vec(), strings, reals)
        };
        scene.ids().map(of).collect()
    }

    fn word() -> impl Strategy<Value = Vec<u8>> {
        prop_oneof![
            4 => "[a-c]{1,2}".prop_map(String::into_bytes),
            1 => vec(any::<u8>().prop_filter("no tab", |&b| b != b'\t'), 0..12),
        ]
    }

    /// Words of scene text and junk, so that primitives come about.
    fn token() -> impl Strategy<Value = Vec<u8>> {
        let kind = (0..KINDS.len()).prop_map(|i| KINDS[i].1.as_bytes().to_vec());
        let plain = prop_oneof![
            Just("void"),
            Just("inherit"),
            Just("0"),
            Just("1"),
            Just("3"),
            Just("4"),
            Just("9"),
            Just("-1"),
            Just(".5"),
            Just("1e400"),
            Just("-t"),
            Just("-i"),
            Just("-s"),
            Just("#"),
            Just("!x"),
            Just("\n"),
            Just("\""),
            Just("'"),
            Just("alias"),
            Just("polygon"),
            Just("a"),
            Just("b"),
        ];
        prop_oneof![plain.prop_map(|s| s.as_bytes().to_vec()), kind, word()]
    }

    /// Everything that can be asked of a primitive, for panics and numbers that are not finite.
    fn use_all(scene: &mut Scene) {
        for id in scene.ids() {
            let _ = scene.check_arguments(id);
            let _ = scene.trailing_transform(id, 1);
            let _ = scene.location(id);
            if let Ok((shape, _)) = Shape::from_object(scene, id) {
                if let Some(b) = scene.surface_bounds(id, &shape) {
                    assert!(b.min.is_finite() && b.max.is_finite());
                }
                if let Shape::Polygon(p) = &shape {
                    assert!(p.normal.is_normalized() && p.offset.is_finite() && p.area > 0.0);
                }
            }
            let _ = scene.clean(id);
        }
    }

    proptest! {
            #[test]
            fn what_is_printed_reads_the_same(
                objects in vec((0..KINDS.len(), any::<prop::sample::Index>(), word(), vec(word(), 0..3),
                                vec(any::<f64>().prop_filter("a number", |x| !x.is_nan()), 0..5)), 1..12)
            ) {
                let mut scene = Scene::new();
                for (kind, modifier, name, strings, reals) in &objects {
                    let kind = KINDS[*kind].0;
                    if kind == Kind::Alias || kind.is_modifier() && matches!(&name[..], b"void" | b"inherit") {
                        continue;
                    }
                    // Only what is in force under its name can be named.
                    let named = |id: &ObjectId| {
                        let name = scene.name_bytes(*id);
                        scene.modifier(name) == Some(*id) && !name.is_empty()
                    };
                    let candidates: Vec<ObjectId> = scene.ids().filter(named).chain([VOID]).collect();
                    let strings: Vec<&[u8]> = strings.iter().map(Vec::as_slice).collect();
                    let modifier = candidates[modifier.index(candidates.len())];
                    scene.push(NewObject { kind, modifier, name, strings: &strings, reals, file: 0, line: 0 });
                }
                let text = print_all(&scene);
                let again = read(&text).map_err(|e| TestCaseError::fail(format!("{e}: {}", text.escape_ascii())))?;
                prop_assert_eq!(parts(&scene), parts(&again));
            }

            #[test]
            fn no_bytes_make_the_reader_panic(bytes in vec(any::<u8>(), 0..400)) {
                if let Ok(mut scene) = read(&bytes) {
                    use_all(&mut scene);
                }
                let _ = DataTable::parse("d", "d", &bytes);
                let _ = Font::parse("f", &bytes);
            }

            #[test]
            fn no_words_make_the_reader_panic(words in vec(token(), 0..60)) {
                let mut text = Vec::new();
                for word in &words {
                    text.extend_from_slice(word);
                    text.push(b' ');
                    // Each beginning is text of its own, so errors late in it hide nothing.
                    if let Ok(mut scene) = read(&text) {
                        use_all(&mut scene);
                    }
                }
            }

            #[test]
            fn numbers_read_as_the_standard_library_reads_them(text in r"-?([0-9]{1,20}(\.[0-9]{0,20})?|\.[0-9]{1,20})(e-?[0-9]{1,3})?") {
                let scene = read(format!("void light l 0 0 1 {text}\n").as_bytes()).unwrap();
                prop_assert_eq!(scene.reals(0)[0].to_bits(), text.parse::<f64>().unwrap().to_bits());
            }

            #[test]
            fn tables_interpolate_between_their_points(
                points in vec(-1e3f32..1e3, 2..8), values in vec(-1e3f32..1e3, 8), t in 0.0..1.0f64, far in any::<f64>()
            ) {
                let mut points = points;
                points.sort_by(f32::total_cmp);
                points.dedup();
                prop_assume!(points.len() > 1);
                let n = points.len();
                let axis = Axis { begin: points[0], end: points[n - 1], count: n, points: Some(points.clone().into()) };
                let table = DataTable::new(vec![axis], values[..n].to_vec()).unwrap();
                for i in 0..n - 1 {
                    let (a, b) = (f64::from(points[i]), f64::from(points[i + 1]));
                    let (u, v) = (f64::from(values[i]), f64::from(values[i + 1]));
                    let seen = table.interpolate(&[a + (b - a) * t]);
    // Weights of up to EPSILON are dropped, at either end and of values up to a thousand.
                    prop_assert!((seen - (u + (v - u) * t)).abs() <= 2.1e-3, "{} {}", seen, u + (v - u) * t);
                }
                prop_assert!(table.interpolate(&[far]).is_finite());
            }
        }

    #[test]
    fn aliases_are_printed_as_what_they_are() {
        let text = "void glow g\n0\n0\n3 1 2 0.5\ninherit alias a g\nvoid brightfunc q\n2 Px+1 .\n0\n0\nq alias c a\n";
        assert_eq!(String::from_utf8(print_all(&read(text.as_bytes()).unwrap())).unwrap(), text);
    }

    #[test]
    fn awkward_words_are_quoted() {
        for word in [&b"a\"b'c"[..], b"'", b"\"", b"", b"a b", b"#a", b"!a", b"a#", b"\"'\"'", b"\xff\n"] {
            let mut scene = Scene::new();
            let strings = [word];
            scene.push(NewObject {
                kind: Kind::BrightFunc,
                modifier: VOID,
                name: word,
                strings: &strings,
                reals: &[],
                file: 0,
                line: 0,
            });
            let again = read(&print_all(&scene)).unwrap();
            assert_eq!((again.name_bytes(0), again.string_bytes(0, 0)), (word, Some(word)));
        }
    }
}
