//! Whatever text is read, nothing panics, and what is refused is refused with its file and a line that exists.

use ambit_base::Silent;
use ambit_scene::{DataTable, Error, Font, NoCommands, Reader, Scene};
use proptest::collection::vec;
use proptest::prelude::*;

/// Pieces that such texts are made of, right and wrong.
const PIECES: [&str; 44] = [
    "void",
    "inherit",
    "plastic",
    "polygon",
    "sphere",
    "cone",
    "brightfunc",
    "alias",
    "instance",
    "zork",
    "m",
    "n",
    "0",
    "0",
    "0",
    "1",
    "3",
    "5",
    "-1",
    "2.5",
    "-.5e3",
    "1e400",
    "99999999999999999999",
    "4294967296",
    "nan",
    "x",
    "\"a b\"",
    "'it",
    "\"",
    "\t",
    "\n",
    "\n",
    "\r\n",
    "# comment\n",
    "#",
    "!echo m\n",
    "!a\\\nb\n",
    "\\",
    "\0",
    "\u{b}",
    "é",
    "65",
    "255",
    "..",
];

fn texts() -> impl Strategy<Value = Vec<u8>> {
    let soup = vec((0..PIECES.len(), prop::bool::weighted(0.9)), 0..80).prop_map(|pieces| {
        let mut text = Vec::new();
        for (piece, gap) in pieces {
            text.extend_from_slice(PIECES[piece].as_bytes());
            if gap {
                text.push(b' ');
            }
        }
        text
    });
    prop_oneof![4 => soup, 1 => vec(any::<u8>(), 0..200)]
}

/// A right text with a few bytes put in its place.
fn damaged(text: &'static str) -> impl Strategy<Value = Vec<u8>> {
    vec((0..text.len(), any::<u8>()), 0..4).prop_map(move |changes| {
        let mut bytes = text.as_bytes().to_vec();
        for (at, byte) in changes {
            bytes[at] = byte;
        }
        bytes
    })
}

/// That an error tells its file, and a line of it.
fn names_its_place(error: &Error, text: &[u8]) -> Result<(), TestCaseError> {
    let (place, lines) = (error.location(), text.split(|b| *b == b'\n').count() as u32);
    prop_assert!(place.file == "t.in" || place.file.starts_with('!'), "{error} at {place:?}");
    prop_assert!(place.line <= lines, "{error} at {place:?} of {lines} lines");
    prop_assert!(place.line >= 1 || place.file.starts_with('!'), "{error} at {place:?}");
    prop_assert!(!error.to_string().is_empty());
    Ok(())
}

fn read_scene(text: &[u8]) -> Result<Scene, Error> {
    let mut scene = Scene::new();
    Reader::new(&mut scene, &Silent, &mut NoCommands).read_bytes("t.in", text)?;
    Ok(scene)
}

const SCENE: &str = "# a scene\nvoid plastic m\n0\n0\n5 .5 .5 .5 0 0\nm polygon p\n0 0 9\n0 0 0 1 0 0 0 1 0\n\
    void brightfunc f 4 a+b c.cal -s 2 0 1 3\nf alias g m\ng sphere 'a ball' 0 0 4 1 2 3 .5\n";
const TABLE: &str = "# two axes\n2\n0 1 3\n0 0 2\n0 .5\n1 2 3\n4 5 6\n";
const FONT: &str = "# two glyphs\n65 3 10 10 250 10 128 240\n66 0\n67 4 0 0 255 0 255 255 0 255\n";

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn scenes(text in prop_oneof![texts(), damaged(SCENE)]) {
        if let Err(e) = read_scene(&text) {
            names_its_place(&e, &text)?;
        }
    }

    #[test]
    fn data_files(text in prop_oneof![texts(), damaged(TABLE)]) {
        if let Err(e) = DataTable::parse("t.in", "t.in", &text) {
            names_its_place(&e, &text)?;
        }
    }

    #[test]
    fn fonts(text in prop_oneof![texts(), damaged(FONT)]) {
        if let Err(e) = Font::parse("t.in", &text) {
            names_its_place(&e, &text)?;
        }
    }

    #[test]
    fn numbers_are_what_rust_makes_of_them(value in any::<f64>().prop_filter("finite", |x| x.is_finite()), form in 0..5) {
        let text = match form {
            0 => format!("{value}"),
            1 => format!("{value:e}"),
            2 => format!("{value:.6}"),
            3 => format!("{:.3}", value % 1e6),
            _ => format!("{}", (value % 1e6).trunc()),
        };
        let scene = read_scene(format!("void light l 0 0 1 {text} \n").as_bytes()).unwrap();
        prop_assert_eq!(scene.reals(0), &[text.parse::<f64>().unwrap()][..]);
    }
}

#[test]
fn the_right_texts_are_right() {
    assert_eq!(read_scene(SCENE.as_bytes()).unwrap().len(), 5);
    assert!(DataTable::parse("t.in", "t.in", TABLE.as_bytes()).is_ok());
    assert!(Font::parse("t.in", FONT.as_bytes()).is_ok());
}
