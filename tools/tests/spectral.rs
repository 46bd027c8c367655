//! Calculations by wavelength as a script sees them: headers, pixels, pictures, what is refused. The numbers are answers of
//! Radiance 6.0a.

use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

const SCENE: &str = "void glow M 0 0 4 1 2 3 0\nM polygon f 0 0 12 -5 -5 0 5 -5 0 5 5 0 -5 5 0\n";
/// Two spectra and three bounces of light.
const ROOM: &str = "void spectrum P 0 0 8 400 700 .1 .15 .2 .3 .7 .8\nP plastic red 0 0 5 1 1 1 .02 .05\n\
    void plastic white 0 0 5 .7 .7 .7 0 0\nvoid spectrum Q 0 0 8 400 700 .5 .6 .9 1 1.1 1.2\n\
    Q light L 0 0 3 20 20 20\nwhite polygon floor 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n\
    red polygon left 0 0 12 0 0 0 0 4 0 0 4 3 0 0 3\nL polygon lamp 0 0 12 1.5 1.5 2.9 1.5 2.5 2.9 2.5 2.5 2.9 2.5 1.5 2.9\n";
const DOWN: &[u8] = b"0 0 1 0 0 -1\n";
const VIEW: &str = "-vp 0 0 1 -vd 0 0 -1 -vu 0 1 0 -x 1 -y 1";

struct Bench(TempDir);

impl Bench {
    fn new(scene: &str) -> Self {
        let bench = Self(tempfile::tempdir().unwrap());
        std::fs::write(bench.0.path().join("scene.rad"), scene).unwrap();
        let octree = bench.run(env!("CARGO_BIN_EXE_oconv"), "scene.rad", b"");
        assert!(octree.status.success());
        std::fs::write(bench.0.path().join("scene.oct"), octree.stdout).unwrap();
        bench
    }

    fn run(&self, program: &str, line: &str, input: &[u8]) -> Output {
        let mut command = Command::new(program);
        command.args(line.split_whitespace()).current_dir(self.0.path()).stdin(Stdio::piped());
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        // A program that refuses its options reads nothing.
        let _ = std::io::Write::write_all(&mut child.stdin.take().unwrap(), input);
        child.wait_with_output().unwrap()
    }

    fn rtrace(&self, line: &str, input: &[u8]) -> Output {
        self.run(env!("CARGO_BIN_EXE_rtrace"), &format!("{line} scene.oct"), input)
    }

    fn rpict(&self, line: &str) -> Output {
        self.run(env!("CARGO_BIN_EXE_rpict"), &format!("{line} scene.oct"), b"")
    }
}

/// Lines of a header but for those that the octree, the command and the time make, and what follows it.
fn split(output: &Output) -> (Vec<String>, Vec<u8>) {
    let bytes = &output.stdout;
    let end = bytes.windows(2).position(|w| w == b"\n\n").expect("a header ends with an empty line");
    let head = String::from_utf8_lossy(&bytes[..end]).into_owned();
    let kept = head.lines().skip_while(|l| !l.starts_with("GMT=")).skip(1).map(str::to_owned).collect();
    (kept, bytes[end + 2..].to_vec())
}

fn numbers(bytes: &[u8]) -> Vec<f64> {
    String::from_utf8_lossy(bytes).split_whitespace().map(|w| w.parse().unwrap()).collect()
}

#[test]
fn headers_say_what_the_numbers_are() {
    let bench = Bench::new(SCENE);
    for (line, wanted) in [
        ("-w -cs 9 -co+", &["NCOMP=9", "WAVELENGTH_SPLITS= 780 588 480 380", "FORMAT=ascii"][..]),
        ("-w -cs 9", &["NCOMP=3", "FORMAT=ascii"]),
        ("-w -co+", &["NCOMP=3", "FORMAT=ascii"]),
        ("-w -cs 9 -co+ -faf", &["NCOMP=9", "WAVELENGTH_SPLITS= 780 588 480 380", "BigEndian=0", "FORMAT=float"]),
        ("-w -cs 9 -co+ -fad", &["NCOMP=9", "WAVELENGTH_SPLITS= 780 588 480 380", "BigEndian=0", "FORMAT=double"]),
        ("-w -cs 9 -co+ -fac", &["NCOMP=9", "WAVELENGTH_SPLITS= 780 588 480 380", "FORMAT=Radiance_spectra"]),
        ("-w -cs 9 -fac", &["NCOMP=3", "FORMAT=32-bit_rle_rgbe"]),
        ("-w -cs 6 -cw 600 700 -co+", &["NCOMP=6", "WAVELENGTH_SPLITS= 700 666.667 633.333 600", "FORMAT=ascii"]),
        ("-w -cs 5 -co+ -osL", &["NCOMP=2", "WAVELENGTH_SPLITS= 780 588 480 380", "FORMAT=ascii"]),
        ("-w -cs 9 -co+ -ovWrxlLw", &["NCOMP=39", "WAVELENGTH_SPLITS= 780 588 480 380", "FORMAT=ascii"]),
        ("-w -pS -cs 9", &["NCOMP=1", "FORMAT=ascii"]),
        (
            "-w -pXYZ -cs 9",
            &["NCOMP=3", "PRIMARIES= 1.0000 0.0000 0.0000 1.0000 0.0000 0.0000 0.3333 0.3333", "FORMAT=ascii"],
        ),
    ] {
        let (head, _) = split(&bench.rtrace(line, DOWN));
        let head: Vec<&str> = head.iter().map(|l| l.trim_end()).collect();
        assert_eq!(head, wanted, "{line}");
    }
}

#[test]
fn binary_records_hold_all_bins() {
    let bench = Bench::new(SCENE);
    let pixel = bench.rtrace("-h -w -cs 9 -co+ -fac", DOWN).stdout;
    assert_eq!(pixel, [0x40, 0x40, 0x40, 0x40, 0x80, 0x80, 0x80, 0xc0, 0xc0, 0x82]);
    assert_eq!(bench.rtrace("-h -w -cs 9 -fac", DOWN).stdout, [0x55, 0x7e, 0xba, 0x82]);
    let floats = bench.rtrace("-h -w -cs 4 -co+ -faf", DOWN).stdout;
    assert_eq!(floats, [1f32, 1.0, 2.0, 3.0].map(f32::to_ne_bytes).concat());
    assert_eq!(bench.rtrace("-h -w -cs 9 -co+ -fad", DOWN).stdout.len(), 72);
    // A picture that Radiance's programs read.
    let picture = bench.rtrace("-w -cs 9 -co+ -fac -x 1 -y 1", DOWN);
    assert_eq!(split(&picture).1, [b"-Y        1 +X        1\n", &pixel[..]].concat());
    // A ray without direction is black, and nothing is in its way.
    assert_eq!(
        numbers(&bench.rtrace("-h -w -cs 4 -co+ -ovW", b"0 0 1 0 0 0\n").stdout),
        [0., 0., 0., 0., 1., 1., 1., 1.]
    );
}

#[test]
fn pictures_are_seen_in_colour() {
    let bench = Bench::new(SCENE);
    for (line, format, wanted) in [
        ("-cs 6", "FORMAT=32-bit_rle_rgbe", [0.8029268, 2.100502, 3.170776]),
        ("-cs 6 -cw 400 700", "FORMAT=32-bit_rle_rgbe", [1.200805, 2.068381, 3.118726]),
        ("-cs 9 -pXYZ", "FORMAT=32-bit_rle_xyze", [321.4297, 333.3221, 494.2350]),
        ("-cs 9 -pc .7 .3 .2 .7 .1 .1 .33 .33", "FORMAT=32-bit_rle_rgbe", [1.631215, 1.785644, 2.845118]),
    ] {
        let (head, data) = split(&bench.rpict(&format!("{VIEW} -w {line}")));
        assert_eq!(head.last().map(String::as_str), Some(format), "{line}");
        let code = &data[data.len() - 4..];
        let unit = (f64::from(code[3]) - 136.0).exp2();
        for (&m, w) in code.iter().zip(wanted) {
            // A mantissa counts 256ths of the greatest channel's power of two.
            assert!((f64::from(m) * unit - w).abs() <= unit, "{line}: {code:?} for {wanted:?}");
        }
    }
}

#[test]
fn limits_and_options_are_refused_as_by_radiance() {
    let bench = Bench::new(SCENE);
    let says = |output: &Output| String::from_utf8_lossy(&output.stderr).into_owned();
    for line in ["-cs 2", "-cs 9 -cw 500 549", "-cw 500 500", "-cs -1"] {
        for output in [bench.rtrace(line, DOWN), bench.rpict(&format!("{VIEW} {line}"))] {
            assert_eq!(output.status.code(), Some(1), "{line}");
            assert!(says(&output).contains("fatal - unsupported spectral sampling"), "{line}: {}", says(&output));
        }
    }
    // A range without the peaks shows no colours: a warning, an error, or nothing if bins are written.
    let warning = "rtrace: warning - spectral range incompatible with color output";
    let lines = [
        ("-cs 6 -cw 600 700", true),
        ("-cw 600 700", true),
        ("-cw 600 700 -pXYZ", true),
        ("-cs 6 -cw 600 700 -co+", false),
        ("-cw 600 700 -pY", false),
        ("-cs 6 -cw 600 700 -pA", false),
    ];
    for (line, warns) in lines {
        let output = bench.rtrace(&format!("-h {line}"), DOWN);
        assert_eq!((output.status.code(), says(&output).contains(warning)), (Some(0), warns), "{line}");
    }
    let refused = bench.rpict(&format!("{VIEW} -cs 6 -cw 600 700"));
    assert!(says(&refused).starts_with("rpict: fatal - unsupported spectral sampling"), "{}", says(&refused));
    assert!(says(&bench.rpict(&format!("{VIEW} -cs 9 -co+"))).contains("command line error at '-co+'"));
    // More than 24 bins are 24.
    assert_eq!(numbers(&bench.rtrace("-h -w -cs 40 -co+", DOWN).stdout).len(), 24);
}

/// Options of a small calculation of the room.
const COARSE: &str = "-w -u- -ab 2 -aa .2 -ad 64 -as 16 -ar 32";

/// Rays that meet the room's surfaces at many places.
fn rays() -> Vec<u8> {
    let at = |k: u32| format!("{} {} 1 {} {} -1\n", k % 4, k / 4 % 4, f64::from(k % 7) - 3.0, f64::from(k % 5) - 2.0);
    (0..64).map(at).collect::<String>().into_bytes()
}

/// Header, and records of the ambient file of a calculation of `bins`.
fn ambient(bench: &Bench, name: &str, bins: usize) -> (String, Vec<Vec<u8>>) {
    let bytes = std::fs::read(bench.0.path().join(name)).unwrap();
    let end = bytes.windows(2).position(|w| w == b"\n\n").unwrap();
    let (records, rest) = (bytes[end + 4..].chunks_exact(64 + bins), (bytes.len() - end - 4) % (64 + bins));
    assert_eq!((&bytes[end + 2..end + 4], rest), (&[0x02, 0x31][..], 0));
    (String::from_utf8(bytes[..end].to_vec()).unwrap(), records.map(<[u8]>::to_vec).collect())
}

#[test]
fn ambient_files_hold_all_bins() {
    let bench = Bench::new(ROOM);
    // Smoothed values of early rays lack records of later ones.
    let run = |line: &str| bench.rtrace(&format!("-h {COARSE} --smoothing 1 -cs 9 -co+ {line}"), &rays()).stdout;
    let alone = run("-n 1 -af alone.amb");
    let (header, records) = ambient(&bench, "alone.amb", 9);
    assert!(header.contains(" -cw 380 780 -cs 9 scene.oct\n"), "{header}");
    assert!(header.ends_with("\nWAVELENGTH_SPLITS= 780 588 480 380\nNCOMP=9\nFORMAT=Radiance_ambval"), "{header}");
    assert!(records.len() > 20, "{} records", records.len());
    for threads in [2, 3] {
        assert!(run(&format!("-n {threads} -af {threads}.amb")) == alone, "-n {threads} differs");
        assert_eq!(ambient(&bench, &format!("{threads}.amb"), 9).1, records);
    }
    // Who reads it computes nothing anew, and answers as who made it.
    let again = run("-af alone.amb");
    assert_eq!(ambient(&bench, "alone.amb", 9).1, records);
    for (a, b) in numbers(&again).iter().zip(numbers(&alone)) {
        assert!((a - b).abs() <= 2e-6 * b, "{a} {b}");
    }
    // Long waves are reflected more than short ones: every bin has a mantissa of its own.
    let (long, short) = records.iter().fold((0, 0), |(l, s), r| (l + u32::from(r[65]), s + u32::from(r[70])));
    assert!(long > 2 * short, "{long} {short}");
}

#[test]
fn a_scene_without_spectra_fills_all_bins_of_a_channel_alike() {
    let bench = Bench::new(&ROOM.replace("P plastic", "void plastic").replace("Q light", "void light"));
    let run = |line: &str| numbers(&bench.rtrace(&format!("-h {COARSE} {line}"), &rays()).stdout);
    let spectral = run("-cs 9 -co+ -af nine.amb");
    let (_, records) = ambient(&bench, "nine.amb", 9);
    assert!(!records.is_empty());
    for r in &records {
        assert_eq!((&r[63..67], &r[67..70], r[70]), (&[r[63]; 4][..], &[r[67]; 3][..], r[71]));
    }
    let colours = run("-af three.amb");
    assert!(spectral.chunks(9).zip(colours.chunks(3)).all(|(bins, rgb)| [bins[0], bins[4], bins[7]] == rgb));
}

#[test]
fn bounces_without_end_bring_all_light_in_every_bin() {
    let bubble = "void spectrum S 0 0 8 400 700 .2 .4 .5 .7 .6 .3\nS plastic W 0 0 5 1 1 1 0 0\n\
        void light L 0 0 3 10 10 10\nL sphere s 0 0 4 0 0 2 .2\nW bubble b 0 0 4 0 0 2 3\n";
    let bench = Bench::new(bubble);
    let rays = b"0 0 3 .5 .3 .6\n".repeat(600);
    let mean = |line: &str| -> Vec<f64> {
        let all = numbers(&bench.rtrace(&format!("-h -w -u- -cs 6 -co+ -lr 0 -lw 0 {line}"), &rays).stdout);
        (0..6).map(|bin| all.iter().skip(bin).step_by(6).sum::<f64>() / 600.0).collect()
    };
    let endless = mean("-ab 1 -aa 0 -ad 32 --unbounded-bounces");
    for other in [mean("-ab 40 -aa 0 -ad 1"), mean("-ab 2 -aa .2 -ad 1024 --unbounded-bounces")] {
        assert!(endless.iter().zip(&other).all(|(a, b)| (a - b).abs() <= 0.02 * b), "{endless:?} {other:?}");
    }
}

/// A sky of a spectrum over a red floor, on which Radiance's answers are known.
const SKY: &str = "void spectrum S 0 0 9 380 780 .1 .2 .3 .4 .5 .6 .7\nS glow sky 0 0 4 1 1 1 0\n\
    sky source sky 0 0 4 0 0 1 180\nvoid plastic red 0 0 5 .7 .4 .2 0 0\n\
    red polygon floor 0 0 12 -5 -5 0 5 -5 0 5 5 0 -5 5 0\n";

#[test]
fn ambient_files_of_other_bins_are_converted_and_continued() {
    let bench = Bench::new(SKY);
    let run = |line: &str, rays: &[u8]| bench.rtrace(&format!("-h -I -u- -ab 1 -ad 64 -aa .1 -co+ {line}"), rays);
    let (one, two) = (&b"1 1 0 0 0 1\n"[..], &b"1 1 0 0 0 1\n3 3 0 0 0 1\n"[..]);
    // What rtrace 6.0a reads from a file of the first options with the second, and what it appends.
    let cases: [(&str, &str, &[f64], &[u8]); 6] = [
        ("-cs 9", "", &[1.509216, 1.073637, 0.5848372], &[243, 243, 243, 176, 176, 176, 93, 93, 93, 127]),
        (
            "-cs 9",
            "-cs 6",
            &[2.039172, 1.728285, 1.413308, 1.102421, 0.7874435, 0.4765567],
            &[166, 153, 140, 115, 102, 89, 64, 51, 38, 128],
        ),
        ("-cw 400 700", "", &[1.487961, 1.08299, 0.5675729], &[212, 165, 93, 127]),
        ("", "-cw 400 700", &[1.494097, 1.08299, 0.5737088], &[96, 199, 87, 127]),
        (
            "",
            "-cs 9 -cw 380 1000",
            &[0.0, 0.0, 0.0, 1.204917, 1.494097, 1.136037, 1.08299, 0.6065657, 0.5737088],
            &[153, 102, 51, 128],
        ),
        ("-cs 6 -cw 400 700", "-cs 6 -cw 400 700", &[], &[]),
    ];
    for (k, (made, read, first, appended)) in cases.into_iter().enumerate() {
        let file = format!("{k}.amb");
        run(&format!("{made} -af {file}"), one);
        let before = std::fs::read(bench.0.path().join(&file)).unwrap();
        let refused = run(&format!("{read} -af {file} --reuse strict"), two);
        assert_eq!(refused.status.code().unwrap(), i32::from(!first.is_empty()));
        std::fs::write(bench.0.path().join(&file), &before).unwrap();
        let used = run(&format!("{read} -af {file}"), two);
        let text = String::from_utf8_lossy(&used.stderr).into_owned();
        assert_eq!(used.status.code(), Some(0), "{text}");
        // Said once.
        let said = text.matches("different ambient file wavelength sampling").count();
        assert_eq!(said, usize::from(!first.is_empty()), "{text}");
        // Bytes of a mantissa each: the two programs' records need not round alike.
        let answered = numbers(&used.stdout);
        for (a, b) in answered.iter().zip(first) {
            assert!((a - b).abs() <= 0.01 * b, "{made} / {read}: {answered:?} {first:?}");
        }
        let (now, bins) = (std::fs::read(bench.0.path().join(&file)).unwrap(), appended.len().max(1) - 1);
        assert!(now.starts_with(&before));
        if !first.is_empty() {
            assert_eq!(now.len() - before.len(), 64 + bins);
            let value = &now[now.len() - bins - 1..];
            assert_eq!(value.last(), appended.last(), "{made} / {read}: {value:?}");
            assert!(
                value.iter().zip(appended).all(|(a, b)| a.abs_diff(*b) <= 1),
                "{made} / {read}: {value:?} {appended:?}"
            );
        }
    }
}

/// Shares of light (`W`) are weighed as light is, but are not multiplied by lumens; `-co-` undoes only `-co+`.
#[test]
fn shares_of_light_have_no_unit() {
    let bench = Bench::new(
        "void metal mirror 0 0 5 .8 .5 .2 1 0\nmirror polygon floor 0 0 12 -5 -5 0 5 -5 0 5 5 0 -5 5 0\n\
        void glow sky 0 0 4 1 1.5 2 0\nsky source sky 0 0 4 0 0 1 180\n",
    );
    let run =
        |line: &str| numbers(&bench.rtrace(&format!("-h -w -ab 0 -lr 2 -otW {line}"), b"1 1 1 .3 .1 -1\n").stdout);
    let chromaticities = "-pc .64 .33 .3 .6 .15 .06 .3127 .329";
    // What rtrace 6.0a prints for the reflected ray, and for the ray itself.
    for (line, wanted) in [
        ("", &[0.8003503, 0.5008758, 0.2014014, 1.0, 1.0, 1.0][..]),
        ("-pS", &[0.4204676, 1.0]),
        ("-pS -co-", &[0.4204676, 1.0]),
        ("-pS -co+ -co-", &[0.8003503, 0.5008758, 0.2014014, 1.0, 1.0, 1.0]),
        (chromaticities, &[0.8490595, 0.5025808, 0.2097973, 1.000136, 0.9998877, 0.9999042]),
        ("-cs 6", &[0.8592717, 0.4708879, 0.1495173, 0.9999119, 1.0001, 0.9993263]),
        ("-cs 6 -pY", &[0.5530297, 1.0]),
        ("-cs 6 -pM", &[0.2754805, 1.0]),
        ("-cs 6 -pXYZ", &[0.6185207, 0.5530297, 0.206104, 0.9998779, 1.0, 0.9994354]),
    ] {
        let made = run(line);
        assert_eq!(made.len(), wanted.len(), "{line}: {made:?}");
        assert!(made.iter().zip(wanted).all(|(a, b)| (a - b).abs() <= 3e-5 * b), "{line}: {made:?}");
    }
}

#[test]
fn programs_look_into_ambient_files_of_many_bins() {
    let bench = Bench::new(ROOM);
    assert_eq!(bench.rtrace(&format!("-h {COARSE} -cs 9 -af x.amb"), &rays()).status.code(), Some(0));
    // What is printed of a record is its colour.
    let listed = bench.run(env!("CARGO_BIN_EXE_lookamb"), "-h -d x.amb", b"").stdout;
    let rows: Vec<f64> = numbers(&listed);
    assert_eq!(rows.len() / 21, ambient(&bench, "x.amb", 9).1.len());
    // The room is reddish, but for hemispheres that see nothing.
    assert!(rows.chunks(21).all(|r| r[13] >= r[15]) && rows.chunks(21).any(|r| r[13] > r[15] && r[14] > 0.0));
    let sound = bench.run(env!("CARGO_BIN_EXE_ambrec"), "check x.amb", b"");
    assert_eq!(sound.status.code(), Some(0), "{}", String::from_utf8_lossy(&sound.stdout));
}

#[test]
fn bins_do_not_depend_on_threads_or_on_what_is_written() {
    let bench = Bench::new(ROOM);
    let rays = b"1 1 1 -1 .2 0\n2 1 1 0 .3 -1\n3 2 1 -1 0 -.5\n1 3 2 .1 0 -1\n".repeat(8);
    let run = |line: &str| bench.rtrace(&format!("-h -w -u- -ab 2 -aa .2 -ad 64 -as 0 -ar 32 {line}"), &rays).stdout;
    let bins = run("-cs 5 -co+ -n 1");
    assert_eq!(numbers(&bins).len(), 32 * 5);
    assert!(bins == run("-cs 5 -co+ -n 3"), "-n 3 differs from -n 1");
    // The mean of the bins is their mean.
    let means = numbers(&run("-cs 5 -pA"));
    for (five, mean) in numbers(&bins).chunks(5).zip(means) {
        assert!((five.iter().sum::<f64>() / 5.0 - mean).abs() <= 2e-6 * mean.max(1.0), "{five:?} {mean}");
    }
    // The red wall reflects long waves more than short ones, which all passes agree on.
    assert!(numbers(&bins).chunks(5).all(|b| b[1] > b[3]), "no wall is red");
}

#[test]
fn pixels_outside_of_the_view_are_black_and_shift_nothing() {
    let bench = Bench::new(SCENE);
    // So narrow that scanlines are not encoded: four bytes a pixel, the last of black ones 0.
    let line = "-w -vth -vp 0 0 1 -vd 0 0 -1 -vu 0 1 0 -vh 180 -vv 180 -x 7 -y 7 -ps 1 -pj 0";
    let lit = |more: &str| -> Vec<bool> {
        let (_, body) = split(&bench.rpict(&format!("{line} {more}")));
        let pixels = &body[body.len() - 7 * 7 * 4..];
        pixels.chunks(4).map(|pixel| pixel[3] > 0).collect()
    };
    let (three, nine) = (lit("-cs 3"), lit("-cs 9"));
    assert_eq!(three, nine);
    assert!(!three[0] && three[3 * 7 + 3], "corners lie outside, the middle does not");
}
