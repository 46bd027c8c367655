//! Names of files that are not UTF-8, which Unix allows: the programs pass them on as they are, as Radiance's do.

use std::ffi::{OsStr, OsString};
use std::fs;
use std::os::unix::ffi::{OsStrExt, OsStringExt};
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

struct Bench(TempDir);

fn word(bytes: &[u8]) -> &OsStr {
    OsStr::from_bytes(bytes)
}

impl Bench {
    fn path(&self, name: &[u8]) -> PathBuf {
        self.0.path().join(word(name))
    }

    fn write(&self, name: &[u8], text: &[u8]) {
        fs::write(self.path(name), text).unwrap();
    }

    fn run(&self, program: &str, line: &[&[u8]], input: &[u8]) -> Output {
        let mut command = Command::new(program);
        command.args(line.iter().map(|w| word(w))).current_dir(self.0.path()).env("SOME", word(b"-af a.amb"));
        command.env("RAYPATH", word(b".:lib\xf3"));
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        // A program may end before it has read everything.
        let _ = std::io::Write::write_all(&mut child.stdin.take().unwrap(), input);
        child.wait_with_output().unwrap()
    }
}

fn has(bytes: &[u8], part: &[u8]) -> bool {
    bytes.windows(part.len()).any(|w| w == part)
}

#[test]
fn names_may_be_any_bytes() {
    let bench = Bench(tempfile::tempdir().unwrap());
    bench.write(b"sc\xff.rad", b"void glow g\xe9 0 0 4 1 1 1 0\ng\xe9 sphere s 0 0 4 0 0 9 1\n!cat in\xfe.rad\n");
    bench.write(
        b"in\xfe.rad",
        b"void brightfunc p 2 f pat\xf0.cal 0 0\np plastic m 0 0 5 .5 .5 .5 0 0\nm ring r 0 0 8 0 0 0 0 0 1 0 9\n",
    );
    fs::create_dir(bench.path(b"lib\xf3")).unwrap();
    bench.write(b"lib\xf3/pat\xf0.cal", b"f=.5;\n");
    bench.write(b"v.vf", b"rview -vp 0 0 5 -vd 0 0 -1 -vu 0 1 0\n");
    bench.write(b"o\xf2.opt", b"-ab 1 -ad 64 $SOME\n");
    let octree = bench.run(env!("CARGO_BIN_EXE_oconv"), &[b"sc\xff.rad"], b"");
    assert!(octree.status.success(), "{}", String::from_utf8_lossy(&octree.stderr));
    assert!(has(&octree.stdout, b"\noconv sc\xff.rad\n"));
    bench.write(b"o\xff.oct", &octree.stdout);

    let rtrace = env!("CARGO_BIN_EXE_rtrace");
    let rays = b"1 1 1 0 0 -1\n0 0 5 0 0 1\n";
    let traced = bench.run(rtrace, &[b"-h", b"-w", b"@o\xf2.opt", b"-om", b"o\xff.oct"], rays);
    assert!(traced.status.success(), "{}", String::from_utf8_lossy(&traced.stderr));
    assert_eq!(traced.stdout, b"m\t\ng\xe9\t\n");
    let shaded = bench.run(rtrace, &[b"-h", b"-w", b"@o\xf2.opt", b"o\xff.oct"], rays);
    assert!(shaded.status.success() && bench.path(b"a.amb").is_file());
    // Modifiers are known by their bytes, too.
    bench.write(b"list", b"g\xe9\n");
    bench.write(b"other", b"g\xe8\n");
    let tree = |list: &[u8]| bench.run(rtrace, &[b"-h", b"-w", b"-tI", list, b"-otm", b"o\xff.oct"], rays).stdout;
    assert_eq!((&tree(b"list")[..], &tree(b"other")[..]), (&b"g\xe9\t\n"[..], &b""[..]));

    let rpict = env!("CARGO_BIN_EXE_rpict");
    let line: [&[u8]; 12] =
        [b"-w", b"-x", b"4", b"-y", b"4", b"-vf", b"v.vf", b"-z", b"z", b"-o", b"p.hdr", b"o\xff.oct"];
    let drawn = bench.run(rpict, &line, b"");
    assert!(drawn.status.success(), "{}", String::from_utf8_lossy(&drawn.stderr));
    assert_eq!(fs::read(bench.path(b"z")).unwrap().len(), 64);
    let picture = fs::read(bench.path(b"p.hdr")).unwrap();
    assert!(has(&picture, b"\nrpict -w -x 4 -y 4 -vf v.vf -z z -o p.hdr\n"));
    let missing = bench.run(rpict, &[b"no\xf7.oct"], b"");
    assert!(has(&missing.stderr, b"cannot open octree file \"no\xf7.oct\": No such file"));
    // Options that take a name of something to be written take none of these, as in Radiance.
    let refused = bench.run(rtrace, &[b"-af", b"a\xf4.amb", b"o\xff.oct"], b"");
    assert!(refused.status.code() == Some(1) && has(&refused.stderr, b"command line error at '-af'"));
    // Nothing else came into being.
    let mut names: Vec<OsString> = fs::read_dir(bench.0.path()).unwrap().map(|f| f.unwrap().file_name()).collect();
    names.sort();
    let mut known = [
        &b"sc\xff.rad"[..],
        b"list",
        b"other",
        b"in\xfe.rad",
        b"lib\xf3",
        b"v.vf",
        b"o\xf2.opt",
        b"o\xff.oct",
        b"a.amb",
        b"z",
        b"p.hdr",
    ]
    .map(|n| OsString::from_vec(n.to_vec()));
    known.sort();
    assert_eq!(names, known);
}

/// The programs beside them, which take names and say them.
#[test]
fn other_programs_take_any_bytes_too() {
    let bench = Bench(tempfile::tempdir().unwrap());
    bench.write(
        b"s\xff.rad",
        b"void glow g 0 0 4 1 1 1 0\ng sphere s 0 0 4 0 0 9 3\n\
        void plastic m 0 0 5 .5 .5 .5 0 0\nm ring r 0 0 8 0 0 0 0 0 1 0 9\n",
    );
    let octree = bench.run(env!("CARGO_BIN_EXE_oconv"), &[b"s\xff.rad"], b"");
    bench.write(b"s.oct", &octree.stdout);
    let rays = [b"-h", &b"-w"[..], b"-I", b"-ab", b"1", b"-ad", b"64", b"-aa", b".1", b"-af", b"a.amb", b"s.oct"];
    assert!(bench.run(env!("CARGO_BIN_EXE_rtrace"), &rays, b"0 0 0 0 0 1\n").status.success());
    fs::rename(bench.path(b"a.amb"), bench.path(b"a\xf1.amb")).unwrap();
    let drawn = bench.run(env!("CARGO_BIN_EXE_rpict"), &[b"-w", b"-x", b"8", b"-y", b"8", b"s.oct"], b"");
    bench.write(b"p\xf2.hdr", &drawn.stdout);
    bench.write(b"t\xf3.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let (topng, lookamb, ambrec, obj2mesh, raderr) = (
        env!("CARGO_BIN_EXE_topng"),
        env!("CARGO_BIN_EXE_lookamb"),
        env!("CARGO_BIN_EXE_ambrec"),
        env!("CARGO_BIN_EXE_obj2mesh"),
        env!("CARGO_BIN_EXE_raderr"),
    );
    for (program, line, made) in [
        (topng, &[&b"p\xf2.hdr"[..], b"p\xf4.png"][..], &b"p\xf4.png"[..]),
        (ambrec, &[b"convert", b"a\xf1.amb", b"-o", b"c\xf5.amb"], b"c\xf5.amb"),
        (obj2mesh, &[b"t\xf3.obj", b"t\xf6.rtm"], b"t\xf6.rtm"),
    ] {
        let output = bench.run(program, line, b"");
        assert!(output.status.success() && bench.path(made).is_file(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    assert!(has(&bench.run(lookamb, &[b"a\xf1.amb"], b"").stdout, b"Position:"));
    assert!(has(&bench.run(ambrec, &[b"check", b"a\xf1.amb"], b"").stdout, b"a\xf1.amb: sound"));
    for (program, line, said) in [
        (topng, &[&b"n\xf7.hdr"[..], b"n.png"][..], &b"topng: cannot open picture \"n\xf7.hdr\""[..]),
        (lookamb, &[b"n\xf7"], b"n\xf7: file not found"),
        (lookamb, &[b"-\xf7"], b"lookamb: unknown option '-\xf7'"),
        (ambrec, &[b"stats", b"n\xf7"], b"ambrec: cannot read \"n\xf7\""),
        (obj2mesh, &[b"n\xf7"], b"obj2mesh: fatal - cannot open \"n\xf7\""),
        (raderr, &[b"n\xf7.oct"], b"n\xf7.oct"),
    ] {
        let output = bench.run(program, line, b"");
        assert!(!output.status.success() && has(&output.stderr, said), "{}", String::from_utf8_lossy(&output.stderr));
    }
    // A measurement of a scene, with a reference and results of such names.
    let measured: [&[u8]; 16] = [
        b"s\xff.rad",
        b"--rungs",
        b"1",
        b"--repeats",
        b"1",
        b"--size",
        b"8",
        b"--passes",
        b"2",
        b"--reference",
        b"r\xf9.ref",
        b"--csv",
        b"c\xfa.csv",
        b"-q",
        b"--",
        b"-w",
    ];
    let view: [&[u8]; 8] = [b"-vd", b"0", b"0", b"-1", b"-vu", b"0", b"1", b"0"];
    let eye: [&[u8]; 4] = [b"-vp", b"0", b"0", b"5"];
    let line = [&measured[..], &eye, &view].concat();
    let output = bench.run(raderr, &line, b"");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(bench.path(b"r\xf9.ref").is_file() && bench.path(b"c\xfa.csv").is_file());
}
