use super::*;
use ambit_file::{Library, SearchPath};
use std::fs::{create_dir, read_to_string, write};

/// One of each kind that a transform treats differently.
const SCENE: &str = "\
void brightfunc pat 2 Px+1 . 0 0
void mist fog 2 s1>a b 0 7 .1 .2 .3 .4 .5 .6 .7
pat glow g 0 0 4 1 2 3 5
g sphere s 0 0 4 1 2 3 .5
g polygon p 0 0 9 0 0 0 1 0 0 1 1 0
g ring r 0 0 8 0 0 0 0 0 1 .5 1
g cup c 0 0 8 0 0 0 0 0 1 .5 1
void dielectric d 0 0 5 .9 .8 .7 1.523456789 0
void brighttext t 2 f x 0 11 0 0 0 1 0 0 0 -1 0 1 .1
void spotlight sp 0 0 7 10 20 30 45 0 1 -2
void interface it 0 0 8 .9 .8 .7 1.5 .95 .85 .75 1.2
g cylinder cy 0 0 7 0 0 0 0 0 1 .5
g cone co 0 0 8 4 0 0 4 0 1 .5 .2
# no word of the scene
inherit alias i g
g source sun 0 0 4 0 0 1 5
g instance in 3 foo.oct -rx 90 0 0
";

/// What Radiance's `xform -n q -m n -I -s -2 -rz 30 -t 1 2 3` prints of it.
const CARRIED: &str = "\
void brightfunc pat 12 Px+1 . -i 1 -s -2 -rz 30 -t 1 2 3 0 0
void mist fog 2 q.s1>q.a q.b 0 7 0.05 0.1 0.15 0.4 0.5 0.6 0.7
pat glow g 0 0 4 1 2 3 10
n bubble q.s 0 0 4 1.26794919243 -2.46410161514 -3 1
n polygon q.p 0 0 9 1 2 3 -0.732050807569 1 3 0.267949192431 -0.732050807569 3
n ring q.r 0 0 8 1 2 3 -0 -0 2 1 2
n cone q.c 0 0 8 1 2 3 1 2 1 1 2
void dielectric d 0 0 5 0.948683 0.894427 0.83666 1.52346 0
void brighttext t 2 f x 0 11 1 2 3 -1.73205080757 -1 0 -1 1.73205080757 0 1 0.1
void spotlight sp 0 0 7 10 20 30 45 1 -1.73205080757 4
void interface it 0 0 8 0.948683 0.894427 0.83666 1.5 0.974679 0.921954 0.866025 1.2
n tube q.cy 0 0 7 1 2 3 1 2 1 1
n cup q.co 0 0 8 -5.92820323028 -2 3 -5.92820323028 -2 1 1 0.4
inherit alias i g
n source q.sun 0 0 4 0 0 -2 5
n instance q.in 13 foo.oct -rx 90 -i 1 -s -2 -rz 30 -t 1 2 3 0 0
";

/// A command's text, or that it has to be run, in a folder along no other path.
fn expanded(command: &str, folder: &Path) -> Option<String> {
    let search = SearchPath::new(Some("."), None, Library::NONE);
    match expand(command.as_bytes(), folder, 0, Commands::new(&search)).unwrap() {
        Expansion::Done(output) => Some(String::from_utf8(output.text).unwrap()),
        Expansion::Untouched | Expansion::GivenUp => None,
    }
}

/// Words, numbers among them as what they are.
fn words(text: &str) -> Vec<String> {
    text.split_whitespace().map(|w| w.parse::<f64>().map_or_else(|_| w.to_owned(), |x| format!("{x:?}"))).collect()
}

#[test]
fn every_type_is_carried_as_radiance_does() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path().join("a.rad"), SCENE).unwrap();
    for command in [
        "xform -n q -m n -I -s -2 -rz 30 -t 1 2 3 a.rad",
        "xform -n q -m n -I -s -2 -rz 30 -t 1 2 3 ./a.rad",
        "cat a.rad | xform -n q -m n -I -s -2 -rz 30 -t 1 2 3",
    ] {
        assert_eq!(words(&expanded(command, folder.path()).unwrap()), words(CARRIED), "{command}");
    }
}

#[test]
fn arrays_are_numbered_and_run_commands_once() {
    let folder = tempfile::tempdir().unwrap();
    create_dir(folder.path().join("part")).unwrap();
    let inner = "void alias m void\n!echo run >> runs; cat s.rad\n!xform -n in -t 0 0 1 s.rad\n";
    write(folder.path().join("part/a.rad"), inner).unwrap();
    write(folder.path().join("part/s.rad"), "m sphere s 0 0 4 0 0 0 1\n").unwrap();
    let text = expanded("xform -t 5 0 0 -a 2 -t 1 0 0 -a 2 -t 0 1 0 -i 1 -s 2 part/a.rad", folder.path()).unwrap();
    let expected = [("a0.0", 10, 0), ("a0.1", 10, 2), ("a1.0", 12, 0), ("a1.1", 12, 2)].map(|(name, x, y)| {
        let spheres = format!("m sphere {name}.s 0 0 4 {x} {y} 0 2 m sphere {name}.in.s 0 0 4 {x} {y} 2 2");
        format!("void alias m void {spheres} ")
    });
    let expected = expected.concat();
    assert_eq!(words(&text), words(&expected));
    assert_eq!(read_to_string(folder.path().join("part/runs")).unwrap(), "run\n");
    // A name takes the place of the first array's letter; the words are those of each place.
    write(folder.path().join("p.rad"), "void brightfunc p 2 x . 0 0\np sphere s 0 0 4 0 0 0 1\n").unwrap();
    let text = expanded("xform -n q -a 2 -rz 90 p.rad", folder.path()).unwrap();
    let both = "void brightfunc p 6 x . -i 0 -rz 90 0 0 p sphere q.0.s 0 0 4 0 0 0 1
                void brightfunc p 6 x . -i 1 -rz 90 0 0 p sphere q.1.s 0 0 4 0 0 0 1";
    assert_eq!(words(&text), words(both));
}

#[test]
fn what_is_wrong_or_unusual_is_left_to_the_program() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [
        ("a.rad", "void sphere s 0 0 4 0 0 0 1\n"),
        ("count.rad", "void sphere s 0 0 3 0 0 0\n"),
        ("strings.rad", "void sphere s 1 x 0 4 0 0 0 1\n"),
        ("type.rad", "void ball s 0 0 4 0 0 0 1\n"),
        ("short.rad", "void sphere s 0 0 4 0 0\n"),
        ("quote.rad", "void sphere \"s'\" 0 0 4 0 0 0 1\n"),
        ("huge.rad", "void sphere s 0 0 4 1e308 0 0 1\n"),
        ("glow.rad", "void glow g 0 0 0\n"),
        ("lamp.rad", "void glow g 1 x 0 4 1 1 1 1\n"),
        ("mist.rad", "void mist m 0 0 2 1 1\n"),
        ("late.rad", "!echo ran >> ran\nvoid sphere \"s'\" 0 0 4 0 0 0 1\n"),
        ("nothing.rad", "# no word\n"),
        ("empty.rad", "!true\n"),
        ("fails.rad", "!cat a.rad; false\n"),
    ] {
        write(folder.path().join(name), text).unwrap();
    }
    assert!(expanded("xform a.rad", folder.path()).is_some());
    for words in [
        "a.rad missing.rad",
        "count.rad",
        "strings.rad",
        "type.rad",
        "short.rad",
        "quote.rad",
        "-s 100 huge.rad",
        "a.rad nothing.rad",
        "glow.rad",
        "lamp.rad",
        "mist.rad",
        "late.rad",
        "-n '\"' a.rad",
        "-m '#a' a.rad",
        "-i 4294967298 -t 1 0 0 a.rad",
        "empty.rad",
        "fails.rad",
        "",
        "-c a.rad",
        "-f a.rad",
        "-t 1 2 a.rad",
        "-s 0 a.rad",
        "-q a.rad",
        "-a 0 a.rad",
        "-a x a.rad",
        "-n q -n r -a 2 a.rad",
        "~/a.rad",
        "< a.rad",
    ] {
        assert_eq!(expanded(&format!("xform {words}"), folder.path()), None, "{words}");
    }
    assert!(!folder.path().join("ran").exists(), "the program would run it again");
    assert_eq!(expanded("cat a.rad | xform a.rad", folder.path()), None);
}

#[test]
fn what_comes_before_a_pipe_runs_once() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path().join("odd.rad"), "void sphere \"s'\" 0 0 4 0 0 0 1\n").unwrap();
    // The program is called with what has been printed, whether there is one or not.
    expanded("sh -c 'echo run >> runs; cat odd.rad' | xform -s 2", folder.path());
    assert_eq!(read_to_string(folder.path().join("runs")).unwrap(), "run\n");
}

#[test]
fn failures_far_below_are_told_once_more_only() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path().join("n0.rad"), "!echo run >> runs\n").unwrap();
    for k in 1..6 {
        write(folder.path().join(format!("n{k}.rad")), format!("!xform n{}.rad\n", k - 1)).unwrap();
    }
    assert_eq!(expanded("xform n5.rad", folder.path()), None);
    assert_eq!(read_to_string(folder.path().join("runs")).unwrap(), "run\n");
}
