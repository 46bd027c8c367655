//! Ray trees of rtrace (`-ot`, `-oT`) against what Radiance 6.0a prints: the same lines in the same order.

use std::path::Path;
use std::process::{Command, Stdio};
use tempfile::TempDir;

const CASES: &str = include_str!("recorded/trees.txt");

/// Largest relative difference of two numbers; smaller ones than [`LEAST`] count as 0.
const TOLERANCE: f64 = 2e-5;
const LEAST: f64 = 1e-7;

fn octree(folder: &TempDir, scene: &str) -> std::path::PathBuf {
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("scene.rad"), scene).unwrap();
    let made = Command::new(env!("CARGO_BIN_EXE_oconv")).arg(path("scene.rad")).output().unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    std::fs::write(path("scene.oct"), made.stdout).unwrap();
    path("scene.oct")
}

fn rtrace(octree: &Path, options: &str, rays: &str) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rtrace"));
    command.args(["-h", "-u-", "-dj", "0", "-ab", "0"]).args(options.split_whitespace()).arg(octree);
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let lines = rays.replace(';', "\n") + "\n";
    std::io::Write::write_all(&mut child.stdin.take().unwrap(), lines.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn agree(ours: &str, theirs: &str) -> bool {
    let same = |(a, b): (&str, &str)| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= TOLERANCE * b.abs() || (a.abs() < LEAST && b.abs() < LEAST),
        _ => a == b,
    };
    ours.split('\t').count() == theirs.split('\t').count() && ours.split('\t').zip(theirs.split('\t')).all(same)
}

#[test]
fn trees_are_those_of_radiance() {
    let mut cases = 0;
    for case in CASES.split("\n= ").skip(1) {
        let folder = tempfile::tempdir().unwrap();
        let mut lines = case.trim_end_matches('\n').split('\n');
        let mut next = || lines.next().unwrap();
        let (name, scene, options, rays) = (next(), next(), next(), next());
        let theirs: Vec<&str> = lines.collect();
        let answer = rtrace(&octree(&folder, scene), options, rays);
        let ours: Vec<&str> = answer.lines().collect();
        let equal = ours.len() == theirs.len() && ours.iter().zip(&theirs).all(|(a, b)| agree(a, b));
        assert!(equal, "{name}:\nours\n{}\nrecorded\n{}", ours.join("\n"), theirs.join("\n"));
        cases += 1;
    }
    assert_eq!(cases, 30);
}

/// A closed white box with a lamp in it.
const ROOM: &str = "void light lamp 0 0 3 10 10 10 lamp sphere s 0 0 4 0 0 2 .2 void plastic white 0 0 5 .5 .5 .5 0 0 \
    white polygon low 0 0 12 -3 -3 0 3 -3 0 3 3 0 -3 3 0 white polygon high 0 0 12 -3 -3 3 -3 3 3 3 3 3 3 -3 3 \
    white polygon west 0 0 12 -3 -3 0 -3 3 0 -3 3 3 -3 -3 3 white polygon east 0 0 12 3 -3 0 3 -3 3 3 3 3 3 3 0 \
    white polygon south 0 0 12 -3 -3 0 -3 -3 3 3 -3 3 3 -3 0 white polygon north 0 0 12 -3 3 0 3 3 0 3 3 3 -3 3 3";

#[test]
fn rays_of_hemispheres_are_children_of_the_ray_that_asked() {
    let folder = tempfile::tempdir().unwrap();
    let octree = octree(&folder, ROOM);
    let ray = "1 1 1 0 0 -1";
    let options = "-ab 2 -aa .2 -ad 32 -as 0 -ar 16 -w -ovtsv";
    let answer = rtrace(&octree, options, &format!("{ray};{ray}"));
    let depth = |line: &str| line.chars().take_while(|&c| c == '\t').count();
    let lines: Vec<&str> = answer.lines().collect();
    let second = lines.iter().position(|l| depth(l) == 0 && l.starts_with("low")).unwrap() + 2;
    // The first ray finds an empty cache, the second one the first one's answer.
    let children = lines[..second].iter().filter(|l| depth(l) == 1).count();
    assert!((32..200).contains(&children), "{children} rays of the first hemisphere");
    assert!(lines[..second].iter().any(|l| depth(l) == 2));
    assert_eq!(lines.len(), second + 2, "{:?}", &lines[second..]);
    // Parents come after their children.
    for pair in lines.windows(2) {
        assert!(depth(pair[1]) >= depth(pair[0]) || depth(pair[1]) + 1 == depth(pair[0]), "{pair:?}");
    }
    // The value does not depend on being shown, nor anything on threads.
    let plain = rtrace(&octree, "-ab 2 -aa .2 -ad 32 -as 0 -ar 16 -ov", ray);
    assert_eq!(plain.trim_end(), lines[1 + second - 2].trim_end());
    assert_eq!(rtrace(&octree, &format!("{options} -n 3"), &format!("{ray};{ray}")), answer);
}

#[test]
fn hemispheres_beside_edges_are_children_too() {
    let folder = TempDir::new().unwrap();
    // A floor and a wall that meet where the second ray ends.
    let scene = "void plastic m 0 0 5 .5 .5 .5 0 0\nm polygon f 0 0 12 -1 -1 0 1 -1 0 1 1 0 -1 1 0\n\
                 m polygon w 0 0 12 -1 1 0 1 1 0 1 1 2 -1 1 2\n";
    let octree = octree(&folder, scene);
    // Where the rays of the hemisphere begin, along y and z.
    let begin = |ray: &str| -> Vec<[f64; 2]> {
        let answer = rtrace(&octree, "-w- -oto -ab 1 -aa .2 -ad 64 -as 0", ray);
        let children = answer.lines().filter_map(|line| line.strip_prefix('\t'));
        let number = |word: Option<&str>| word.and_then(|w| w.parse().ok()).expect("an origin");
        let place = |mut words: std::str::SplitWhitespace<'_>| [number(words.nth(1)), number(words.next())];
        children.map(|line| place(line.split_whitespace())).collect()
    };
    let (free, edge) = (begin("0 0 1 0 .5 -1"), begin("0 0 1 0 1 -1"));
    assert_eq!((free.len(), edge.len()), (64, 64));
    assert!(free.iter().all(|&place| place == [0.5, 0.0]), "{free:?}");
    // It is the wall that is met, 16 ε above the floor (`corner.rs`).
    assert!(edge.iter().all(|&[y, z]| y == 1.0 && (z - 1.6e-5).abs() < 1e-9), "{edge:?}");
}

#[test]
fn hemispheres_are_followed_in_all_bins() {
    let folder = tempfile::tempdir().unwrap();
    let spectral =
        format!("void spectrum S 0 0 8 400 700 .2 .4 .5 .9 .6 .1 {}", ROOM.replace("void plastic", "S plastic"));
    let octree = octree(&folder, &spectral);
    let ray = "1 1 1 0 0 -1";
    let options = "-ab 2 -aa .2 -ad 32 -as 0 -ar 16 -cs 9 -co+ -lr 6";
    let numbers = |line: &str| line.split_whitespace().map(|w| w.parse().unwrap()).collect::<Vec<f64>>();
    let answer = rtrace(&octree, &format!("{options} -otV"), ray);
    let lines: Vec<&str> = answer.lines().collect();
    let children: Vec<_> = lines.iter().filter(|l| l.starts_with('\t') && !l.starts_with("\t\t")).collect();
    assert!((32..200).contains(&children.len()), "{} rays of the first hemisphere", children.len());
    // What a ray brings by its hemisphere is the mean of what the hemisphere's rays bring, in every bin.
    let (plain, direct) = (rtrace(&octree, &format!("{options} -ov"), ray), rtrace(&octree, "-cs 9 -co+ -ov", ray));
    assert_eq!(plain.trim_end(), lines[lines.len() - 1].trim_end());
    let mut sums = [0.0; 9];
    for child in children {
        sums.iter_mut().zip(numbers(child)).for_each(|(sum, v)| *sum += v);
    }
    for (bin, (whole, direct)) in numbers(&plain).into_iter().zip(numbers(&direct)).enumerate() {
        assert!((sums[bin] - (whole - direct)).abs() <= 1e-4 * whole, "bin {bin}: {} of {}", sums[bin], whole - direct);
    }
    assert_eq!(rtrace(&octree, &format!("{options} -otV -n 3"), ray), answer);
}

/// Depth of a tree's lines and what their rays bring; checks that every ray of at least some depth brings what its children
/// bring together, and the primary ray what it brings when nobody looks on.
fn summed(octree: &Path, options: &str, least: usize) -> Vec<(usize, f64)> {
    let ray = "1 1 1 0 0 -1";
    let answer = rtrace(octree, &format!("{options} -oTV"), ray);
    let lines: Vec<(usize, f64)> = answer
        .lines()
        .map(|line| {
            (line.len() - line.trim_start_matches('\t').len(), line.split_whitespace().next().unwrap().parse().unwrap())
        })
        .collect();
    // Sums of children that wait for their parents, by depth.
    let mut sums: Vec<Option<f64>> = vec![None; 200];
    for &(depth, value) in &lines {
        if let Some(sum) = sums[depth + 1].take() {
            assert!(
                depth < least || (sum - value).abs() <= 1e-4 * value + 1e-9,
                "{options}: {sum} of children at depth {depth}, {value}"
            );
        }
        sums[depth] = Some(sums[depth].unwrap_or(0.0) + value);
    }
    let plain: f64 = rtrace(octree, &format!("{options} -ov"), ray).split_whitespace().next().unwrap().parse().unwrap();
    assert!((plain - lines.last().unwrap().1).abs() <= 2e-6 * plain, "{options}: {plain} {:?}", lines.last());
    lines
}

#[test]
fn paths_without_end_are_branches_of_their_rays() {
    let folder = tempfile::tempdir().unwrap();
    let octree = octree(&folder, ROOM);
    for options in ["-w -aa 0 -ad 25 -ab 1", "-w -aa .2 -ad 36 -as 0 -ab 2"] {
        let deepest = |more: &str| {
            let lines = summed(&octree, &format!("{options} {more}"), 0);
            lines.iter().map(|line| line.0).max().unwrap()
        };
        let (ends, endless) = (deepest(""), deepest("--unbounded-bounces"));
        assert!(ends <= 3 && endless >= 5, "{options}: {ends} {endless}");
    }
}

#[test]
fn trees_show_the_lamps_that_were_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let sphere =
        |i: i32| format!(" lamp sphere s{i} 0 0 4 {} {} 2.5 .05", 0.6 * f64::from(i % 8) - 2.1, f64::from(i / 8) - 2.0);
    let lamps = (0..40).map(sphere).collect::<Vec<_>>().concat();
    let octree = octree(&folder, &ROOM.replace(" void plastic", &(lamps + " void plastic")));
    let options = "-w -aa 0 -ad 36 -ab 1";
    // Shadow rays of a hemisphere's sample are at depth 2. What the eye sees is lit by an estimate of what -dt spares, too.
    let shadows = |more: &str| {
        let lines = summed(&octree, &format!("{options} {more}"), 1);
        (lines.iter().filter(|l| l.0 == 2).count(), lines.iter().filter(|l| l.0 == 1).count())
    };
    let ((few, rays), (all, _)) = (shadows(""), shadows("-dt 0"));
    assert!(few <= 3 * rays && all >= 15 * rays, "{few} and {all} shadow rays of {rays}");
}

#[test]
fn binary_lines_are_indented_too() {
    let folder = tempfile::tempdir().unwrap();
    let scene = "void light lamp 0 0 3 10 10 10 lamp sphere s 0 0 4 0 0 5 .5 void plastic white 0 0 5 .5 .5 .5 0 0 white \
                 polygon floor 0 0 12 -5 -5 0 5 -5 0 5 5 0 -5 5 0";
    let octree = octree(&folder, scene);
    let mut command = Command::new(env!("CARGO_BIN_EXE_rtrace"));
    command.args(["-h", "-dj", "0", "-ab", "0", "-faf", "-osTwm"]).arg(octree);
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    std::io::Write::write_all(&mut child.stdin.take().unwrap(), b"1 0 1 0 0 -1\n").unwrap();
    let one = 1f32.to_ne_bytes();
    let wanted = [b"\t".as_slice(), &one, b"lamp\t", &one, b"white\tfloor\t"].concat();
    assert_eq!(child.wait_with_output().unwrap().stdout, wanted);
}
