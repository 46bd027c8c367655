//! `--error` as a script sees it: what it chooses, what it says, and that the work itself is that of the chosen settings.

use std::fs;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// A closed room with a lamp of some size, a ball and a board.
const ROOM: &str = "\
void plastic grey 0 0 5 .7 .7 .7 0 0
void plastic red 0 0 5 .6 .2 .2 0 0
void light lamp 0 0 3 20 20 20
grey polygon floor 0 0 12 0 0 0 4 0 0 4 3 0 0 3 0
grey polygon ceiling 0 0 12 0 0 2.5 0 3 2.5 4 3 2.5 4 0 2.5
red polygon west 0 0 12 0 0 0 0 3 0 0 3 2.5 0 0 2.5
grey polygon east 0 0 12 4 0 0 4 0 2.5 4 3 2.5 4 3 0
grey polygon north 0 0 12 0 3 0 4 3 0 4 3 2.5 0 3 2.5
grey polygon south 0 0 12 0 0 0 0 0 2.5 4 0 2.5 4 0 0
red sphere ball 0 0 4 1 2 .5 .3
grey polygon board 0 0 12 2 2 1 3 2 1 3 2.5 1 2 2.5 1
lamp polygon light 0 0 12 1.5 1 2.4 1.5 2 2.4 2.5 2 2.4 2.5 1 2.4
";
const VIEW: &str = "-vp 2 .2 1.2 -vd 0 1 -.1 -vh 80 -vv 80 -x 40 -y 40 -pj 0";

struct Bench(TempDir);

impl Bench {
    fn new() -> Self {
        let bench = Self(tempfile::tempdir().unwrap());
        fs::write(bench.0.path().join("s.rad"), ROOM).unwrap();
        let octree = bench.run(env!("CARGO_BIN_EXE_oconv"), "s.rad", "");
        assert!(octree.status.success(), "{}", errors(&octree));
        fs::write(bench.0.path().join("s.oct"), octree.stdout).unwrap();
        bench
    }

    fn run(&self, program: &str, line: &str, input: &str) -> Output {
        let mut command = Command::new(program);
        command.args(line.split_whitespace()).current_dir(self.0.path()).stdin(Stdio::piped());
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut stdin = child.stdin.take().unwrap();
        // A program may end before it has read everything.
        let _ = std::io::Write::write_all(&mut stdin, input.as_bytes());
        drop(stdin);
        child.wait_with_output().unwrap()
    }

    fn rpict(&self, more: &str) -> Output {
        self.run(env!("CARGO_BIN_EXE_rpict"), &format!("{VIEW} {more} s.oct"), "")
    }

    fn rtrace(&self, more: &str, rays: &str) -> Output {
        self.run(env!("CARGO_BIN_EXE_rtrace"), &format!("-h {more} s.oct"), rays)
    }
}

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The settings that were chosen, and the error that is estimated, in per cent.
fn chosen(output: &Output) -> (String, f64) {
    let text = errors(output);
    assert!(output.status.success(), "{text}");
    let after = text.split("asked: ").nth(1).expect(&text);
    let (settings, rest) = after.split_once("; estimated error ").expect(&text);
    (settings.to_owned(), rest.split_once(" %").expect(&text).0.parse().expect(&text))
}

/// What follows the header.
fn body(file: &[u8]) -> &[u8] {
    let end = file.windows(2).position(|w| w == b"\n\n").expect("a header");
    &file[end..]
}

/// The value after a flag.
fn value(settings: &str, flag: &str) -> f64 {
    let words: Vec<&str> = settings.split(' ').collect();
    let at = words.iter().position(|w| *w == flag).expect(settings);
    words[at + 1].parse().unwrap()
}

fn sensors(count: usize) -> String {
    let line = |i| format!("{} {} .8 0 0 1\n", 0.2 + 0.01 * i as f64, 0.3 + 0.13 * (i % 19) as f64);
    (0..count).map(line).collect::<Vec<_>>().concat()
}

#[test]
fn the_picture_is_that_of_the_settings_that_are_told() {
    let bench = Bench::new();
    let one = bench.rpict("-ab 2 --error 10% -n 1");
    let (settings, error) = chosen(&one);
    assert!(error > 0.0 && error <= 10.0, "{error}");
    // Neither threads nor how the error is written matter, and pilots leave no trace in the picture.
    let three = bench.rpict("-ab 2 --error .1 -n 3");
    let plain = bench.rpict(&format!("-ab 2 -ps 1 {settings}"));
    assert!(plain.status.success() && errors(&plain).is_empty(), "{}", errors(&plain));
    assert!(body(&one.stdout) == body(&three.stdout) && body(&one.stdout) == body(&plain.stdout));
    assert_eq!(chosen(&three), (settings, error));
}

#[test]
fn less_error_takes_finer_settings() {
    let bench = Bench::new();
    let divisions = |goal: &str| {
        let (settings, error) = chosen(&bench.rpict(&format!("-ab 1 --error {goal}")));
        (value(&settings, "-ad") / value(&settings, "-aa").powi(2), error)
    };
    let (coarse, fine) = (divisions("30%"), divisions("4%"));
    assert!(coarse.0 < fine.0 && coarse.1 > fine.1, "{coarse:?} {fine:?}");
}

#[test]
fn options_that_are_given_stay() {
    let bench = Bench::new();
    let (settings, _) = chosen(&bench.rpict("-ab 1 -ad 100 -dt .07 --error 10%"));
    assert!(settings.contains("-ad 100 -as 25") && settings.contains("-dt 0.07"), "{settings}");
    let (settings, _) = chosen(&bench.rpict("-ab 1 --error 10% -aa .25 -ar 33 -as 7 -ds .2"));
    assert!(settings.contains("-aa 0.25 -ar 33") && settings.contains("-as 7 -ds 0.2"), "{settings}");
    // All of them: there is nothing to choose, but the error is told.
    let (settings, error) = chosen(&bench.rpict("-ab 1 -aa .3 -ar 16 -ad 64 -as 0 -ds .2 -dt .05 --error 1%"));
    assert_eq!(settings, "-aa 0.3 -ar 16 -ad 64 -as 0 -ds 0.2 -dt 0.05");
    assert!(error > 1.0);
}

#[test]
fn what_is_out_of_reach_is_said() {
    let bench = Bench::new();
    let text = errors(&bench.rpict("-ab 1 -aa .5 -ad 16 --error .1%"));
    assert!(text.contains("warning") && text.contains("that is above what is asked"), "{text}");
}

#[test]
fn without_bounces_only_direct_light_counts() {
    let bench = Bench::new();
    let (settings, error) = chosen(&bench.rpict("--error 2%"));
    assert!(settings.starts_with("-ds ") && !settings.contains("-a") && error <= 2.0, "{settings} {error}");
}

#[test]
fn pilots_leave_the_ambient_file_alone() {
    let bench = Bench::new();
    let (settings, _) = chosen(&bench.rpict("-ab 1 --error 15% -af a.amb"));
    assert!(bench.rpict(&format!("-ab 1 -ps 1 {settings} -af b.amb")).status.success());
    let read = |name: &str| fs::read(bench.0.path().join(name)).unwrap();
    assert!(body(&read("a.amb")).len() > 1000 && body(&read("a.amb")) == body(&read("b.amb")));
    // The next picture uses it.
    let again = bench.rpict("-ab 1 --error 15% -af a.amb");
    assert!(chosen(&again).0 == settings && !errors(&again).contains("left alone"), "{}", errors(&again));
}

/// Files of Radiance and of older versions say nothing of smoothing, and none is in force with them.
#[test]
fn estimates_smooth_no_more_than_the_ambient_file_allows() {
    let bench = Bench::new();
    let tells = |text: &str| text.lines().find(|l| l.contains("% asked")).expect(text).to_owned();
    let picture = |more: &str| tells(&errors(&bench.rpict(&format!("-ab 1 -ad 64 -aa .2 --error 15% {more}"))));
    let sensors = |more: &str| {
        let line = format!("-I -ab 1 -ad 64 -aa .2 --error 15% {more}");
        tells(&errors(&bench.rtrace(&line, &sensors(300))))
    };
    assert!(bench.rpict("-ab 1 -ad 64 -aa .2 -af new.amb").status.success());
    let file = fs::read(bench.0.path().join("new.amb")).unwrap();
    let end = file.windows(2).position(|w| w == b"\n\n").unwrap();
    let (head, records) = (String::from_utf8(file[..end].to_vec()).unwrap(), &file[end..]);
    assert!(head.contains(" smoothing=1.25"), "{head}");
    let older = head.replace(" smoothing=1.25", "");
    let theirs: Vec<&str> = head.lines().filter(|l| !l.starts_with("AMBIT")).collect();
    for (name, head) in [("older.amb", older), ("theirs.amb", theirs.join("\n"))] {
        fs::write(bench.0.path().join(name), [head.as_bytes(), records].concat()).unwrap();
    }
    assert_ne!(picture(""), picture("--smoothing 1"), "smoothing shows");
    for estimate in [&picture as &dyn Fn(&str) -> String, &sensors] {
        let (smooth, rough) = (estimate(""), estimate("--smoothing 1"));
        // What begins a file smooths, and so does what goes on with one of ours.
        assert_eq!(estimate("-af absent.amb"), smooth);
        assert_eq!(estimate("-af absent.amb"), smooth);
        fs::remove_file(bench.0.path().join("absent.amb")).unwrap();
        for name in ["older.amb", "theirs.amb"] {
            assert_eq!(estimate(&format!("-af {name}")), rough, "{name}");
        }
    }
}

#[test]
fn sensors_have_settings_of_their_own() {
    let bench = Bench::new();
    let rays = sensors(300);
    let one = bench.rtrace("-I -ab 2 --error 10% -n 1", &rays);
    let (settings, error) = chosen(&one);
    assert!(error > 0.0 && error <= 10.0 && errors(&one).contains("256 rays"), "{}", errors(&one));
    assert_eq!(String::from_utf8_lossy(&one.stdout).lines().count(), 300);
    let three = bench.rtrace("-I -ab 2 --error 10% -n 3", &rays);
    let plain = bench.rtrace(&format!("-I -ab 2 {settings}"), &rays);
    assert!(one.stdout == three.stdout && one.stdout == plain.stdout);
    // Nothing to shade, nothing to choose; no rays, nothing to see.
    let cast = bench.rtrace("-ab 2 --error 10% -op", &rays);
    assert!(cast.status.success() && errors(&cast).is_empty(), "{}", errors(&cast));
    let none = bench.rtrace("-ab 2 --error 10%", "");
    assert!(none.status.success() && errors(&none).contains("nothing but black"), "{}", errors(&none));
}

#[test]
fn what_is_no_error_is_refused() {
    let bench = Bench::new();
    for bad in ["0", "-3%", "x", "101%", "nan"] {
        let output = bench.rpict(&format!("--error {bad}"));
        let text = errors(&output);
        assert!(output.status.code() == Some(1) && text.contains(&format!("--error {bad} is no error")), "{text}");
        assert_eq!(bench.rtrace(&format!("--error {bad}"), "").status.code(), Some(1));
    }
    let output = bench.run(env!("CARGO_BIN_EXE_rpict"), "-S 1 --error 5% s.oct", "");
    assert!(output.status.code() == Some(1) && errors(&output).contains("not supported"), "{}", errors(&output));
}
