//! ambrec on files that rtrace made: what it says of them, and that what it writes is used again.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

const ROOM: &str = "\
void plastic grey 0 0 5 .7 .7 .7 0 0
void glow lamp 0 0 4 5 5 5 0
grey polygon floor 0 0 12 0 0 0 4 0 0 4 3 0 0 3 0
grey polygon ceiling 0 0 12 0 0 2.5 0 3 2.5 4 3 2.5 4 0 2.5
lamp polygon light 0 0 12 1.5 1 2.4 1.5 2 2.4 2.5 2 2.4 2.5 1 2.4
";
const RECORD: usize = 67;
const MIXED: &str = "-ab 2 --bounces mixed";

struct Bench(TempDir);

impl Bench {
    /// A folder with an octree and the ambient file of some points.
    fn new() -> Self {
        let bench = Self(tempfile::tempdir().unwrap());
        fs::write(bench.path("s.rad"), ROOM).unwrap();
        let octree = bench.run(env!("CARGO_BIN_EXE_oconv"), "s.rad");
        fs::write(bench.path("s.oct"), octree.stdout).unwrap();
        bench.trace("a.amb", "--reuse auto");
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, program: &str, line: &str) -> Output {
        Command::new(program).args(line.split_whitespace()).current_dir(self.0.path()).output().unwrap()
    }

    /// Runs ambrec, which must end with the status; gives its output.
    fn ambrec(&self, line: &str, status: i32) -> String {
        let output = self.run(env!("CARGO_BIN_EXE_ambrec"), line);
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(status), "{line}: {errors}");
        String::from_utf8_lossy(&output.stdout).into_owned() + &errors
    }

    /// Traces the points with an ambient file.
    fn trace(&self, file: &str, more: &str) -> (Vec<u8>, String) {
        let line = format!("-h -I -u- -ab 2 -ad 64 -as 0 -aa .2 -ar 32 -af {file} {more} s.oct");
        let mut command = Command::new(env!("CARGO_BIN_EXE_rtrace"));
        command.args(line.split_whitespace()).current_dir(self.0.path()).stdin(Stdio::piped());
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut stdin = child.stdin.take().unwrap();
        let rays = (0..40).map(|i| format!("{} 1.2 0 0 0 1\n", 0.1 * f64::from(i))).collect::<Vec<_>>().concat();
        std::io::Write::write_all(&mut stdin, rays.as_bytes()).unwrap();
        drop(stdin);
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success());
        (output.stdout, String::from_utf8_lossy(&output.stderr).into_owned())
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    /// Where the records of a file begin, and how many there are.
    fn records(&self, name: &str) -> (usize, usize) {
        let bytes = self.bytes(name);
        let start = bytes.windows(2).position(|w| w == b"\n\n").unwrap() + 4;
        assert_eq!((bytes.len() - start) % RECORD, 0);
        (start, (bytes.len() - start) / RECORD)
    }
}

#[test]
fn statistics_count_levels() {
    let bench = Bench::new();
    let (_, count) = bench.records("a.amb");
    assert!(count > 30, "{count}");
    let text = bench.ambrec("stats a.amb", 0);
    assert!(text.contains(&format!("records    {count}\n")), "{text}");
    assert!(text.contains("level 0 ") && text.contains("level 1 ") && !text.contains("level 2 "), "{text}");
    assert!(text.contains("AMBIT_OPTIONS= ab=2 "), "{text}");
    let json = bench.ambrec("stats --json a.amb", 0);
    assert!(json.contains(&format!("\"records\": {count},")) && json.contains("\"weight\": [0.5, 0.5, 0.5]"), "{json}");
    assert_eq!(json.matches('{').count(), json.matches('}').count());
    assert_eq!(json.matches('[').count(), json.matches(']').count());
}

#[test]
fn pruned_parts_merge_to_the_whole() {
    let bench = Bench::new();
    let (_, count) = bench.records("a.amb");
    bench.ambrec("prune a.amb --level-from 1 -o zero.amb", 0);
    bench.ambrec("prune a.amb --level-from 1 --keep -o one.amb", 0);
    let (zero, one) = (bench.records("zero.amb").1, bench.records("one.amb").1);
    assert!(zero > 5 && one > 5 && zero + one == count);
    bench.ambrec("merge zero.amb one.amb zero.amb -o both.amb", 0);
    assert_eq!(bench.records("both.amb").1, count);
    let same = bench.ambrec("diff a.amb both.amb", 0);
    assert!(same.contains(&format!("{count} records in both\n0 only in a.amb\n0 only in both.amb\n")), "{same}");
    bench.ambrec("diff a.amb zero.amb", 1);
    // Merged, it serves as well as before.
    let before = bench.trace("a.amb", "--reuse strict");
    assert_eq!(bench.trace("both.amb", "--reuse strict").0, before.0);
    assert_eq!(bench.records("both.amb").1, count);
    // A box takes only what is in it.
    bench.ambrec("prune a.amb --box -1 -1 -1 2 5 0.1 --keep -o part.amb", 0);
    let listed = bench.run(env!("CARGO_BIN_EXE_lookamb"), "-h -d part.amb").stdout;
    let listed = String::from_utf8(listed).unwrap();
    assert!(listed.lines().count() > 3);
    for line in listed.lines() {
        let p: Vec<f64> = line.split_whitespace().take(3).map(|w| w.parse().unwrap()).collect();
        assert!(p[0] <= 2.0 && p[2] <= 0.1, "{line}");
    }
    bench.trace("other.amb", "-ab 1");
    let refused = bench.ambrec("merge a.amb other.amb", 2);
    assert!(refused.contains("is not of the scene and parameters of"), "{refused}");
}

#[test]
fn damage_is_found_and_repaired() {
    let bench = Bench::new();
    let (start, count) = bench.records("a.amb");
    assert!(bench.ambrec("check a.amb", 0).contains(&format!("a.amb: sound: {count} records")));
    // A block that a program without a lock has written 20 bytes too late.
    let good = bench.bytes("a.amb");
    let at = start + 10 * RECORD + 20;
    let block = &good[start + 20 * RECORD..start + 26 * RECORD];
    let broken = [&good[..at], block, &good[start + 20 * RECORD..], &[9; 13]].concat();
    fs::write(bench.path("a.amb"), &broken).unwrap();
    let told = bench.ambrec("check a.amb", 1);
    assert!(told.contains("DAMAGED") && told.contains("20 damaged bytes, 13 bytes of an incomplete"), "{told}");
    let told = bench.ambrec("repair a.amb", 0);
    assert!(told.contains(&format!("{} records kept, 6 repeated ones and 33 bytes dropped", count - 10)), "{told}");
    assert!(bench.ambrec("check a.amb", 0).contains("sound"));
    let left = bench.ambrec("diff a.amb a.amb", 0);
    assert!(left.contains(&format!("{} records in both", count - 10)), "{left}");
    fs::write(bench.path("b.amb"), "void plastic\n").unwrap();
    bench.ambrec("check b.amb", 1);
    bench.ambrec("repair b.amb", 2);
    assert_eq!(bench.bytes("b.amb"), b"void plastic\n");
}

#[test]
fn layouts_convert_there_and_back() {
    let bench = Bench::new();
    let (_, count) = bench.records("a.amb");
    bench.ambrec("convert --to 559 a.amb -o five.amb", 0);
    let five = bench.bytes("five.amb");
    let (start, same) = bench.records("five.amb");
    assert_eq!((&five[start - 2..start], same), (&[2, 0x2f][..], count));
    assert!(!String::from_utf8_lossy(&five[..start]).contains("NCOMP"));
    bench.ambrec("convert five.amb -o six.amb", 0);
    assert!(bench.ambrec("diff a.amb six.amb", 0).contains(&format!("{count} records in both")));
}

#[test]
fn exported_records_are_a_scene() {
    let bench = Bench::new();
    let (_, count) = bench.records("a.amb");
    bench.ambrec("export a.amb --valid ellipse -o marks.rad", 0);
    let octree = bench.run(env!("CARGO_BIN_EXE_oconv"), "s.rad marks.rad");
    assert!(octree.status.success(), "{}", String::from_utf8_lossy(&octree.stderr));
    let text = String::from_utf8(bench.bytes("marks.rad")).unwrap();
    assert_eq!(text.matches(" sphere ").count(), count);
    assert_eq!(text.matches(" polygon ").count(), count);
    let ply = bench.ambrec("export a.amb --form ply", 0);
    let (head, body) = ply.split_once("end_header\n").unwrap();
    assert!(head.contains(&format!("element vertex {count}\n")));
    assert_eq!(body.lines().count(), count);
    assert!(body.lines().all(|l| l.split(' ').count() == head.matches("property").count()), "{body}");
}

/// Text has no room for what the last bounces brought.
#[test]
fn text_that_leaves_out_bounces_is_told() {
    let bench = Bench::new();
    for (name, options, told) in [("one.amb", "-ab 1", false), ("two.amb", "-ab 2", true), ("all.amb", MIXED, false)] {
        bench.trace(name, options);
        let text = bench.run(env!("CARGO_BIN_EXE_lookamb"), name).stdout;
        fs::write(bench.path("text"), text).unwrap();
        let back = bench.run(env!("CARGO_BIN_EXE_lookamb"), "-r text");
        let said = "lookamb: warning - text does not hold what the last bounces brought: values count as with --bounces \
                    mixed\n";
        assert_eq!(String::from_utf8_lossy(&back.stderr), if told { said } else { "" }, "{options}");
        assert!(back.status.success() && back.stdout.len() > 2 * RECORD);
    }
}
