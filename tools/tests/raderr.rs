//! raderr from end to end on a tiny room: reference, ladder, two programs (ours twice), files.

use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

/// A closed grey sphere with a ball in it and a lamp below the ceiling.
const SCENE: &str = "\
void plastic grey 0 0 5 .5 .5 .5 0 0
void light glow 0 0 3 20 20 20
grey bubble box 0 0 4 0 0 0 1
grey sphere ball 0 0 4 .2 .3 -.3 .3
glow sphere lamp 0 0 4 0 0 .6 .1
";

const VIEW: &str = "-vp 0 -.9 0 -vd 0 1 0 -vh 60 -vv 60";

struct Bench(TempDir);

impl Bench {
    fn new() -> Self {
        let bench = Self(tempfile::tempdir().unwrap());
        std::fs::write(bench.path("box.rad"), SCENE).unwrap();
        std::fs::write(bench.path("ladder"), "coarse: -aa 1 -ad 4 -as 0\nfine: -aa .35 -ad 49 # slow\n").unwrap();
        let points: Vec<_> = (0..12).map(|i| format!("{} 0 -.5 0 0 1", f64::from(i) * 0.03)).collect();
        std::fs::write(bench.path("points"), points.join("\n")).unwrap();
        bench
    }

    fn path(&self, name: &str) -> std::path::PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, line: &str) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_raderr"));
        command.args(line.split_whitespace()).current_dir(self.0.path()).output().unwrap()
    }

    /// What it says when it stops.
    fn refused(&self, line: &str) -> String {
        let done = self.run(line);
        assert_eq!(done.status.code(), Some(1), "{line}");
        assert!(done.stdout.is_empty(), "{line}");
        String::from_utf8(done.stderr).unwrap()
    }

    fn text(&self, line: &str) -> String {
        let done = self.run(line);
        assert!(done.status.success(), "{line}: {}", String::from_utf8_lossy(&done.stderr));
        String::from_utf8(done.stdout).unwrap()
    }
}

/// The cells of the row of a rung and a program.
fn row<'a>(table: &'a str, rung: &str, program: &str) -> Vec<&'a str> {
    let rows = table.lines().map(|l| l.split_whitespace().collect::<Vec<_>>());
    rows.into_iter().find(|r| r.len() > 2 && r[..2] == [rung, program]).unwrap_or_else(|| panic!("{table}"))
}

#[test]
fn pictures_of_two_programs() {
    let bench = Bench::new();
    let ours = env!("CARGO_BIN_EXE_rpict");
    let common = format!("box.rad --size 32 --ladder ladder --reference box.ref --passes 24 -q -- {VIEW}");
    let line =
        format!("--repeats 2 --against {ours} --json box.json --csv box.csv --svg box.svg --png box.png {common}");
    let table = bench.text(&line);
    // The same program twice: the same pictures, so the same errors and records.
    let (one, two) = (row(&table, "coarse", "ours"), row(&table, "coarse", "theirs"));
    assert_eq!(one[5..], two[5..], "{table}");
    let records = |rung: &str| row(&table, rung, "ours")[9].parse::<u64>().unwrap();
    let error = |rung: &str| row(&table, rung, "ours")[5].parse::<f64>().unwrap();
    assert!(records("fine") > records("coarse") && records("coarse") > 0, "{table}");
    assert!(error("fine") < error("coarse") && error("coarse") < 50.0, "{table}");
    assert!(row(&table, "fine", "ours")[10].parse::<u64>().unwrap() > 1000, "{table}");
    assert!(table.contains("at equal RMS error") && table.contains("theirs takes "), "{table}");
    assert!(std::fs::read_to_string(bench.path("box.csv")).unwrap().lines().count() == 5);
    assert!(std::fs::read(bench.path("box.png")).unwrap().starts_with(b"\x89PNG"));
    assert!(std::fs::read_to_string(bench.path("box.svg")).unwrap().contains("</svg>"));

    // The reference is kept, says how it was made, and gives the same errors again.
    let kept = std::fs::read(bench.path("box.ref")).unwrap();
    let head = String::from_utf8_lossy(&kept[..600]).into_owned();
    for line in ["MADE_BY=", "OPTIONS=", "-aa 0 -as 0 -ad 64", "PASSES=", "FORMAT=float"] {
        assert!(head.contains(line), "{line}: {head}");
    }
    let again = bench.text(&format!("--repeats 2 {common}"));
    assert_eq!(row(&again, "fine", "ours")[5..], row(&table, "fine", "ours")[5..]);
    assert_eq!(std::fs::read(bench.path("box.ref")).unwrap(), kept);
    let said = bench.refused(&format!("--repeats 1 {common} -ab 3"));
    assert!(said.contains("made for another") && said.contains("--any-reference"), "{said}");

    bench.text("page --out speed.md box.json");
    let page = std::fs::read_to_string(bench.path("speed.md")).unwrap();
    assert!(
        page.contains("## box") && page.contains("](speed/box.svg)") && page.contains("`-aa .35 -ad 49`"),
        "{page}"
    );
    assert!(bench.path("speed/box.svg").exists());
}

#[test]
fn sensors() {
    let bench = Bench::new();
    let table =
        bench.text("box.rad --sensors points --ladder ladder --repeats 1 --passes 4 --csv s.csv --bright 20 -q");
    assert!(row(&table, "fine", "ours")[9].parse::<u64>().unwrap() > 0, "{table}");
    assert!(table.contains("0 of 12 values are left out"), "{table}");
    // rtrace does not tell its rays.
    assert_eq!(row(&table, "fine", "ours")[10], "–", "{table}");
}

#[test]
fn what_can_not_be_measured_says_why() {
    let bench = Bench::new();
    std::fs::write(bench.path("bad"), "-aa .2 -wrong 3\n").unwrap();
    let said = bench.refused(&format!("box.rad --ladder bad -- {VIEW}"));
    assert!(said.contains("'-wrong'") && said.contains("command:"), "{said}");
    let said = bench.refused(&format!("box.rad --against /no/such/rpict -- {VIEW}"));
    assert!(said.contains("/no/such/rpict: No such file"), "{said}");
    let said = bench.refused(&format!("no.rad -- {VIEW}"));
    assert!(said.contains("no.rad"), "{said}");
    std::fs::write(bench.path("empty.rad"), "void plastic grey 0 0 5 .5 .5 .5 0 0\ngrey sphere s 0 0 4 9 9 9 1\n")
        .unwrap();
    let said = bench.refused(&format!("empty.rad --size 8 --repeats 1 -q -- {VIEW}"));
    assert!(said.contains("the reference is 0e0") || said.contains("bit by bit"), "{said}");
    std::fs::write(bench.path("words"), "aa .2\n").unwrap();
    assert!(bench.refused("box.rad --ladder words").contains("words, line 1"));
}

#[test]
fn pictures_with_a_value_that_is_not_finite_are_refused() {
    let bench = Bench::new();
    // A stand-in for rtrace that prints a value that is none, as a program with a fault would. Ours makes the reference.
    let script = "#!/bin/sh\ncase \"$*\" in *-version*) echo 'broken 1.0';; *-defaults*) ;; *) while read l; do echo '1 nan 1'; done;; esac\n";
    let path = bench.path("broken");
    std::fs::write(&path, script).unwrap();
    std::fs::set_permissions(&path, std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
    let line =
        format!("box.rad --sensors points --ladder ladder --repeats 1 --passes 2 -q --against {}", path.display());
    let said = bench.refused(&line);
    // Warming up tells nothing yet; the first rung does.
    assert!(said.contains("theirs, rung coarse") && said.contains("value 0 is not finite (NaN)"), "{said}");
}

#[test]
fn the_manual_page_is_kept() {
    let printed = Command::new(env!("CARGO_BIN_EXE_raderr")).arg("--man").output().unwrap().stdout;
    let kept = std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("../man/raderr.1")).unwrap();
    assert!(!printed.is_empty() && printed == kept, "man/raderr.1 differs from raderr --man");
}
