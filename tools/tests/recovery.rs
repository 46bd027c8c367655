//! Going on with pictures (`-r`, `-ro`) where little is left to go on with, as Radiance 6.0a does it.

use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

const SCENE: &str = include_str!("recorded/scene.rad");

struct Bench(TempDir);

impl Bench {
    fn new() -> Self {
        let bench = Self(tempfile::tempdir().expect("a scratch folder can be made"));
        bench.write("scene.rad", SCENE.as_bytes());
        let octree = bench.run(env!("CARGO_BIN_EXE_oconv"), "scene.rad");
        bench.write("scene.oct", &octree.stdout);
        bench
    }

    fn write(&self, name: &str, bytes: &[u8]) {
        std::fs::write(self.0.path().join(name), bytes).expect("it can be written");
    }

    fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.0.path().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// The names of files with such a beginning.
    fn names(&self, start: &str) -> Vec<String> {
        let all = std::fs::read_dir(self.0.path()).expect("a folder");
        let names = all.map(|f| f.expect("a file").file_name().to_string_lossy().into_owned());
        let mut names: Vec<String> = names.filter(|n| n.starts_with(start)).collect();
        names.sort();
        names
    }

    fn run(&self, program: &str, line: &str) -> Output {
        let views = std::fs::File::open(Path::new(self.0.path()).join("views")).map_or(Stdio::null(), Stdio::from);
        let mut command = Command::new(program);
        command.args(line.split_whitespace()).current_dir(self.0.path()).stdin(views);
        command.output().expect("it runs")
    }

    /// Status and messages, but for those of lights, of which the scene has none.
    fn rpict(&self, line: &str) -> (Option<i32>, String) {
        let done = self.run(env!("CARGO_BIN_EXE_rpict"), line);
        let text = String::from_utf8(done.stderr).expect("text");
        (done.status.code(), text.replace("rpict: warning - no light sources found\n", ""))
    }
}

/// What follows the header.
fn pixels(picture: &[u8]) -> &[u8] {
    &picture[picture.windows(2).position(|w| w == b"\n\n").expect("a header")..]
}

#[test]
fn the_frame_after_the_last_one_is_none() {
    let bench = Bench::new();
    bench.write("views", b"VIEW= -vh 50\nVIEW= -vh 60\n");
    let line = |frame: u32| format!("-S 1 -x 8 -y 8 -r {frame} -o f%d.hdr scene.oct");
    assert_eq!(bench.rpict(&line(3)), (Some(0), "rpict: warning - no output produced\n".to_owned()));
    let (status, text) = bench.rpict(&line(4));
    assert_eq!(status, Some(1));
    assert!(text.starts_with("rpict: fatal - unexpected EOF on view input\n"), "{text}");
    assert_eq!(bench.names("f"), [""; 0]);
    assert_eq!(bench.rpict(&line(2)).0, Some(0));
    assert_eq!(bench.names("f"), ["f2.hdr"]);
}

#[test]
fn pictures_without_a_view_are_those_of_the_options() {
    let bench = Bench::new();
    // Every pixel is sent a ray: those between would depend on where the picture is taken up.
    let view = "-vh 60 -vv 60 -x 40 -ps 1";
    // Seen from elsewhere than what will follow: lines that are taken over differ from those that are rendered.
    assert_eq!(bench.rpict(&format!("-w {view} -vp 1 0 0 -y 40 -o whole.hdr scene.oct")).0, Some(0));
    let whole = bench.read("whole.hdr");
    assert_eq!(bench.rpict(&format!("-w {view} -y 40 -o other.hdr scene.oct")).0, Some(0));
    let other = bench.read("other.hdr");
    // Neither the line of the view nor that of the command, which has one, too.
    let head = whole.len() - pixels(&whole).len();
    let lines = whole[..head].split_inclusive(|&b| b == b'\n');
    let mut part: Vec<u8> =
        lines.filter(|l| !l.starts_with(b"VIEW") && !l.starts_with(b"rpict")).flatten().copied().collect();
    part.extend_from_slice(&pixels(&whole)[..(whole.len() - head) / 2]);
    bench.write("part.hdr", &part);

    // Another size: the picture is left as it was.
    let (status, text) = bench.rpict(&format!("{view} -y 30 -ro part.hdr scene.oct"));
    assert_eq!(status, Some(1));
    assert!(text.contains("rpict: fatal - resolution mismatch in recover file \"part.hdr\"\n"), "{text}");
    assert_eq!((&bench.read("part.hdr"), bench.names("rf")), (&part, vec![]));

    // So is one whose lines could not be taken over, being mirrored since, and one that there is no view for.
    let mut mirrored = part.clone();
    mirrored[part.windows(4).position(|w| w == b"\n-Y ").expect("the size") + 1] = b'+';
    for (bytes, options, reason) in [
        (&mirrored, format!("{view} -y 30"), "resolution mismatch in recover file \"part.hdr\""),
        (&part, "-vh 0".to_owned(), "illegal horizontal view size"),
    ] {
        bench.write("part.hdr", bytes);
        let (status, text) = bench.rpict(&format!("{options} -ro part.hdr scene.oct"));
        assert_eq!(status, Some(1), "{options}");
        assert!(text.contains(reason), "{options}: {text}");
        assert_eq!((&bench.read("part.hdr"), bench.names("rf")), (bytes, vec![]), "{options}");
    }
    bench.write("part.hdr", &part);

    let (status, text) = bench.rpict(&format!("{view} -y 40 -r part.hdr -o new.hdr scene.oct"));
    let told = "rpict: warning - cannot recover view parameters from \"part.hdr\"\n";
    assert_eq!((status, text.as_str()), (Some(0), told));
    // The lines that were there are taken over, though the last one may have been cut off; the others are rendered.
    let (old, other, new) = (pixels(&whole), pixels(&other), bench.read("new.hdr"));
    let (new, kept, rendered) = (pixels(&new), old.len() / 2 - 200, other.len() / 4);
    assert!(kept > 200 && old[..kept] == new[..kept] && other[..kept] != new[..kept]);
    let last = &new[new.len() - rendered..];
    assert!(rendered > 200 && other.ends_with(last) && !old.ends_with(last));
    assert_eq!(bench.names("part"), [""; 0]);
}
