//! What Radiance 6.0a's `oconv` accepted, refused and stored.

use super::*;
use crate::{CommandOutput, Commands, ErrorClass};
use ambit_file::{Library, SearchPath};
use std::collections::HashMap;
use std::sync::Mutex;

#[derive(Default)]
struct Log(Mutex<Vec<String>>);

impl Notify for Log {
    fn warn(&self, text: &str) {
        self.0.lock().unwrap().push(text.to_owned());
    }
}

/// Commands answered from a table.
#[derive(Default)]
struct Canned(HashMap<&'static str, &'static str>);

impl Runner for Canned {
    fn run(&mut self, command: &[u8]) -> std::io::Result<CommandOutput> {
        let answer = self.0.get(std::str::from_utf8(command).unwrap());
        let text = answer.copied().unwrap_or_default().as_bytes().to_vec();
        Ok(CommandOutput { text, success: answer.is_some() })
    }
}

fn read_with(text: &[u8], commands: &[(&'static str, &'static str)]) -> (Result<Scene, Error>, Vec<String>) {
    let (mut scene, log) = (Scene::new(), Log::default());
    let mut runner = Canned(commands.iter().copied().collect());
    let result = Reader::new(&mut scene, &log, &mut runner).read_bytes("t.rad", text);
    (result.map(|()| scene), log.0.into_inner().unwrap())
}

fn read(text: &str) -> Scene {
    let (result, warnings) = read_with(text.as_bytes(), &[]);
    assert_eq!(warnings, Vec::<String>::new(), "{text}");
    result.unwrap_or_else(|e| panic!("{text}: {e}"))
}

fn refuse(text: &str) -> String {
    read_with(text.as_bytes(), &[]).0.expect_err(text).to_string()
}

/// Number of the modifier of the last object.
fn last_modifier(text: &str) -> ObjectId {
    let scene = read(text);
    scene.object(scene.len() as ObjectId - 1).modifier
}

const MATERIAL: &str = "0 0 5 1 1 1 0 0";
const GLOW: &str = "0 0 4 1 1 1 0";

#[test]
fn comments_exist_only_between_primitives() {
    assert_eq!(refuse("void glow g # c\n0 0 4 1 2 3 0"), "(t.rad): bad arguments for glow \"g\"");
    assert_eq!(read("# a\n void glow g 0 0 4 1 2 3 0 # c").len(), 1);
    assert_eq!(refuse("void glow g 0 0 4 1 2 3 0# c"), "(t.rad): bad arguments for glow \"g\"");
}

#[test]
fn long_lines_spill() {
    let comment = |n: usize, rest: &str| format!("#{}{rest}\nvoid glow g {GLOW}", "x".repeat(n));
    assert_eq!(refuse(&comment(2046, " yyyyyyyyyy")), "(t.rad): undefined modifier \"yyyyyyyyyy\"");
    assert_eq!(read(&comment(2047, "")).len(), 1);
    assert_eq!(refuse(&comment(2048, "")), "(t.rad): undefined modifier \"x\"");
}

#[test]
fn words_end_after_511_bytes() {
    let a = "a".repeat(511);
    for name in [
        a.clone(),
        format!("{a}b"),
        format!("{a}\"\"b"),
        format!("\"{a}\"b"),
        format!("\"{a}\""),
        // An open quote whose first byte is the one that is lost: here the blank.
        format!("{a}\""),
    ] {
        let scene = read(&format!("void plastic {name} {MATERIAL}"));
        assert_eq!(scene.name_bytes(0), a.as_bytes());
    }
    for name in [format!("{a}bb"), format!("{a}\"b c\""), format!("\"{a}b\""), format!("\"{a}bb\"")] {
        let expected = format!("(t.rad): bad arguments for plastic \"{a}\"");
        assert_eq!(refuse(&format!("void plastic {name} {MATERIAL}")), expected);
    }
}

#[test]
fn quotes_stand_anywhere_and_mean_nothing() {
    let scene = read("\"void\" brightfunc a\"b c\"d \"4\" 'a''b' \"\" \"x\ty\" '\"' 0 0");
    assert_eq!(scene.name(0), "ab cd");
    assert_eq!(scene.strings(0).collect::<Vec<_>>(), ["ab", "", "x\ty", "\""]);
    assert_eq!(refuse("void plastic \"x 0 0 0"), "(t.rad): bad arguments for plastic \"x 0 0 0\"");
}

#[test]
fn numbers_are_strict() {
    let first = |word: &str| format!("void plastic m 0 0 5 {word} 1 1 0 0");
    for (word, value) in [
        ("1.", 1.0),
        (".5", 0.5),
        ("5.e1", 50.0),
        ("+.5e1", 5.0),
        ("1E2", 100.0),
        ("007", 7.0),
        ("-0.25", -0.25),
        ("\" 1\"", 1.0),
        ("1e400", f64::INFINITY),
        ("123456789012345678901234567890", 123456789012345678901234567890.0),
        ("2.2250738585072014e-308", f64::MIN_POSITIVE),
    ] {
        assert_eq!(read(&first(word)).reals(0)[0], value, "{word}");
    }
    for word in ["nan", "inf", "-inf", "0x10", "1e", "1e+", ".", ".e1", "1,5", "1e2.5", "1d2", "\"1 \"", "\"\"", "+"] {
        assert_eq!(refuse(&first(word)), "(t.rad): bad arguments for plastic \"m\"", "{word}");
    }
}

#[test]
fn counts_wrap_to_32_bits() {
    let count = |word: &str| format!("void plastic m 0 0 {word} 1 1 1 1");
    for word in ["4", "04", "+4", "4294967300", "\" 4\""] {
        assert_eq!(read(&count(word)).reals(0).len(), 4, "{word}");
    }
    for word in ["-4294967296", "-0", "-99999999999999999999999"] {
        assert_eq!(read(&format!("void plastic m 0 0 {word}")).reals(0).len(), 0, "{word}");
    }
    for word in ["4.0", "-1", "99999999999999999999999", "2147483647", "\"\"", "4a"] {
        assert_eq!(refuse(&count(word)), "(t.rad): bad arguments for plastic \"m\"", "{word}");
    }
    assert_eq!(refuse("void plastic m 0 1 7 0"), "(t.rad): bad arguments for plastic \"m\"");
}

#[test]
fn what_is_missing_is_named() {
    for (text, message) in [
        ("void", "(t.rad): unknown type \"\""),
        ("void plastic", "(t.rad): bad arguments for plastic \"\""),
        ("void plastic x", "(t.rad): bad arguments for plastic \"x\""),
        ("void alias", "(t.rad): bad reference \"\" for alias \"\""),
        ("void alias x", "(t.rad): bad reference \"\" for alias \"x\""),
        ("nope zork x", "(t.rad): undefined modifier \"nope\""),
        ("void zork x", "(t.rad): unknown type \"zork\""),
        ("void Plastic x 0 0 0", "(t.rad): unknown type \"Plastic\""),
        ("\"vo\tid\" plastic x 0 0 0", "(t.rad): illegal tab in modifier \"vo\tid\""),
        ("void \"pla\tstic\" x 0 0 0", "(t.rad): unknown type \"pla\tstic\""),
        ("void plastic \"x\ty\" 0 0 0", "(t.rad): illegal tab in identifier \"x\ty\""),
        ("void plastic void 0 0 0", "(t.rad): illegal modifier name \"void\""),
        ("void alias inherit x", "(t.rad): illegal modifier name \"inherit\""),
        ("inherit plastic inherit 0 0 0", "(t.rad): illegal modifier name \"inherit\""),
        ("inherit plastic x 0 0 z", "(t.rad): bad arguments for plastic \"x\""),
        ("inherit polygon x 0 0 0", "(t.rad): inappropriate use of 'inherit' modifier for polygon \"x\""),
        ("void sphere s 0 0 0 s sphere t 0 0 0", "(t.rad): undefined modifier \"s\""),
        ("void alias h void", "(t.rad): bad reference \"void\" for alias \"h\""),
        ("void sphere s 0 0 0 void alias h s", "(t.rad): bad reference \"s\" for alias \"h\""),
    ] {
        assert_eq!(refuse(text), message);
    }
}

#[test]
fn errors_know_their_place() {
    let (result, _) = read_with(b"void plastic m 0 0 0\n# c\n  void plastic m\n0 0 5 1 1\n 1,5 0 0", &[]);
    let error = result.unwrap_err();
    assert_eq!(error.location().to_string(), "t.rad:5:2");
    assert_eq!(error.class(), ErrorClass::User);
    let scene = read("\n\nvoid plastic m\n0\n0\n0\n  m sphere s 0 0 0");
    assert_eq!(scene.location(0).to_string(), "t.rad:3");
    assert_eq!(scene.location(1).to_string(), "t.rad:7");
}

#[test]
fn surfaces_may_have_any_name() {
    let scene = read(&format!("void glow g {GLOW} g sphere void 0 0 0 g sphere inherit 0 0 0 g sphere '' 0 0 0"));
    assert_eq!(scene.ids().map(|id| scene.name(id)).collect::<Vec<_>>(), ["g", "void", "inherit", ""]);
}

#[test]
fn names_mean_the_latest_definition_before() {
    let scene = read(&format!("void glow g {GLOW} g sphere s 0 0 0 void glow g 0 0 0 g sphere t 0 0 0"));
    assert_eq!((scene.object(1).modifier, scene.object(3).modifier), (0, 2));
    assert_eq!(scene.modifier_before(b"g", 1), Some(0));
    assert_eq!(scene.modifier_before(b"g", 2), Some(0));
    assert_eq!(scene.modifier_before(b"g", 3), Some(2));
    assert_eq!(scene.modifier_before(b"g", 0), None);
    assert_eq!(scene.modifier_before(b"s", 3), None);
    // A primitive may modify itself by its older self.
    assert_eq!(last_modifier(&format!("void glow g {GLOW} g brightfunc g 2 2 . 0 0")), 0);
}

#[test]
fn repeated_definitions_leave_the_older_one() {
    let use_ = "g sphere s 0 0 0";
    let pair = |a: &str, b: &str| last_modifier(&format!("void glow g 0 0 4 {a} void glow g 0 0 4 {b} {use_}"));
    assert_eq!(pair("1 1 1 0", "1 1 1 -0"), 0);
    assert_eq!(pair("1 1 1 0", "1.0000005 1 1 0"), 0);
    assert_eq!(pair("1e6 1 1 0", "1000000.5 1 1 0"), 0);
    assert_eq!(pair("1 1 1 0", "1.000002 1 1 0"), 1);
    assert_eq!(pair("1 1 1 0", "1 1 1 1e-9"), 0);
    assert_eq!(pair("1 1 1 1e-9", "1 1 1 0"), 1);
    // Chains are compared by content, not by name; a definition in between counts.
    let chain =
        format!("void brightfunc p 2 .5 . 0 0 p glow g {GLOW} void brightfunc q 2 .5 . 0 0 q glow g {GLOW} {use_}");
    assert_eq!(last_modifier(&chain), 1);
    assert_eq!(last_modifier(&format!("void glow g {GLOW} void glow g 0 0 0 void glow g {GLOW} {use_}")), 2);
    // References among the strings count by what they denote; those to nothing are all the same.
    let illum = |between: &str, name: &str| {
        format!(
            "void glow g {GLOW} void illum i 1 g 0 3 1 1 1 {between} void illum i 1 {name} 0 3 1 1 1 i sphere s 0 0 0"
        )
    };
    assert_eq!(last_modifier(&illum(&format!("void glow h {GLOW}"), "h")), 1);
    assert_eq!(last_modifier(&illum(&format!("void glow g {GLOW}"), "g")), 1);
    assert_eq!(last_modifier(&illum("void glow g 0 0 4 2 1 1 0", "g")), 3);
    assert_eq!(last_modifier("void illum i 1 zz 0 0 void illum i 1 void 0 0 i sphere s 0 0 0"), 0);
    assert_eq!(last_modifier("void plastic b 1 x 0 0 void plastic b 1 y 0 0 b sphere s 0 0 0"), 1);
}

#[test]
fn deep_equal_mixtures_are_compared_in_good_time() {
    use std::fmt::Write;
    let mut text = String::from("void glow a 0 0 0 void glow b 0 0 0 ");
    for _ in 0..40 {
        text.push_str("void mixfunc a 4 a a .5 . 0 0 void mixfunc b 4 b b .5 . 0 0 ");
    }
    write!(text, "void mixfunc c 4 a a .5 . 0 0 void mixfunc c 4 b b .5 . 0 0 c sphere s 0 0 0").unwrap();
    assert_eq!(last_modifier(&text), 82);
}

#[test]
fn aliases_pass_through_or_substitute() {
    let scene = read(&format!(
        "void glow g {GLOW} void alias a g void alias b a void brightfunc q 2 .5 . 0 0 \
         q alias c b void alias d c q alias e c inherit alias f c"
    ));
    let stored = |id| {
        let words: Vec<String> = scene.strings(id).map(Into::into).collect();
        (scene.object(id).modifier, words.join(" "))
    };
    // (modifier, reference) as in the frozen octree of the same text.
    for (id, modifier, reference) in [(1, 0, ""), (2, 0, ""), (4, 3, "b"), (5, VOID, "c"), (6, 4, ""), (7, 4, "")] {
        assert_eq!(stored(id), (modifier, reference.to_owned()), "object {id}");
    }
    let scene = read(&format!("void glow g {GLOW} void alias g g g sphere s 0 0 0"));
    assert_eq!((scene.object(1).modifier, scene.object(2).modifier), (0, 1));
    let scene = read(&format!("void glow g {GLOW} inherit alias h g g alias k g"));
    assert_eq!((scene.object(1).modifier, scene.object(2).modifier), (0, 0));
    assert_eq!((scene.string_count(1), scene.string_count(2)), (0, 1));
}

#[test]
fn commands_are_read_in_place() {
    let commands = [("gen", "void glow g 0 0 4 1 1 1 0 !inner\n g sphere a 0 0 0"), ("inner", "g sphere b 0 0 0")];
    let (scene, warnings) = read_with(b"!gen\ng sphere c 0 0 0 !inner\r!inner\r\n", &commands);
    let scene = scene.unwrap();
    let names: Vec<_> = scene.ids().map(|id| scene.name(id)).collect();
    assert_eq!(names, ["g", "b", "a", "c", "b", "b"]);
    assert_eq!(warnings, Vec::<String>::new());
    assert_eq!(scene.location(1).to_string(), "!inner:1");
}

#[test]
fn failing_commands_are_only_warned_about() {
    let (scene, warnings) = read_with(b"!nosuch 1 2\n!empty \\\r\n there\n!", &[("empty \\\n there", "# nothing")]);
    assert!(scene.unwrap().is_empty());
    assert_eq!(
        warnings,
        [
            "bad status from \"!nosuch 1 2\"",
            "(!nosuch 1 2): empty file",
            "(!empty \\\n there): empty file",
            "bad status from \"!\"",
            "(!): empty file",
            "(t.rad): empty file",
        ]
    );
    let (result, _) = read_with(b"!bad", &[("bad", "\nvoid zork x")]);
    let error = result.unwrap_err();
    assert_eq!(error.to_string(), "(!bad): unknown type \"zork\"");
    assert_eq!(error.location().to_string(), "!bad:2:6");
}

#[test]
fn commands_end_after_2047_bytes() {
    let command = format!("!{} sphere s 0 0 0", "x".repeat(2047 - 1 - 5));
    let (result, _) = read_with(command.as_bytes(), &[]);
    // The command took " sphe"; hence the next words are `re s 0 0 0`.
    assert_eq!(result.unwrap_err().to_string(), "(t.rad): undefined modifier \"re\"");
}

#[test]
fn commands_that_print_themselves_end() {
    let (result, _) = read_with(b"!self", &[("self", "!self")]);
    let error = result.unwrap_err();
    assert_eq!(error.class(), ErrorClass::System);
    assert!(error.to_string().starts_with("cannot execute \"!self\": "), "{error}");
}

#[test]
fn the_shell_runs_commands() {
    let (mut scene, log) = (Scene::new(), Log::default());
    let search = SearchPath::new(None, None, Library::NONE);
    let mut shell = Commands::new(&search);
    let mut reader = Reader::new(&mut scene, &log, &mut shell);
    reader.read("!echo void glow g 0 0 4 1 2 3 0; exit 3").unwrap();
    assert_eq!(scene.reals(0), [1.0, 2.0, 3.0, 0.0]);
    assert_eq!(log.0.into_inner().unwrap(), ["bad status from \"!echo void glow g 0 0 4 1 2 3 0; exit 3\""]);
}

#[test]
fn files_that_cannot_be_opened_and_folders() {
    let (mut scene, log) = (Scene::new(), Log::default());
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing.rad");
    let search = SearchPath::new(None, None, Library::NONE);
    let mut shell = Commands::new(&search);
    let mut reader = Reader::new(&mut scene, &log, &mut shell);
    let error = reader.read_file(&missing).unwrap_err();
    let expected = format!("cannot open scene file \"{}\": No such file or directory", missing.display());
    assert_eq!((error.to_string(), error.class()), (expected, ErrorClass::System));
    reader.read_file(folder.path()).unwrap();
    assert_eq!(log.0.into_inner().unwrap(), [format!("({}): empty file", folder.path().display())]);
}

#[test]
fn line_ends_of_all_kinds() {
    for end in ["\n", "\r\n", "\r", "\x0b\x0c"] {
        let scene = read(&format!("void glow g{end}0{end}0{end}4 1 2 3{end}0{end}"));
        assert_eq!(scene.reals(0), [1.0, 2.0, 3.0, 0.0]);
    }
}
