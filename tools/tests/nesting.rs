//! Rays that wait for each other on the stack: as many as are permitted have room there, and more are refused.

use std::fs;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// Rays that may wait for each other (`crates/render/src/walk.rs`).
const MOST: usize = 12_000;

/// What a ray crosses without loss: from little room on the stack to the most.
const CROSSED: [&str; 4] = [
    "void mist M 0 0 0",
    "void glass M 0 0 4 1 1 1 1",
    "void trans M 0 0 7 1 1 1 0 0 1 1",
    "void BRTDfunc M 10 0 0 0 1 1 1 0 0 0 . 0 9 0 0 0 0 0 0 0 0 0",
];

struct Bench(TempDir);

impl Bench {
    fn new(scene: &str) -> Self {
        let bench = Self(tempfile::tempdir().unwrap());
        fs::write(bench.0.path().join("s.rad"), scene).unwrap();
        // Long lists of surfaces: dividing them further would take long.
        let octree = bench.run(env!("CARGO_BIN_EXE_oconv"), "-n 5000 s.rad", "");
        assert!(octree.status.success(), "{}", errors(&octree));
        fs::write(bench.0.path().join("s.oct"), octree.stdout).unwrap();
        bench
    }

    fn run(&self, program: &str, line: &str, input: &str) -> Output {
        let mut command = Command::new(program);
        command.args(line.split(' ')).current_dir(self.0.path()).stdin(Stdio::piped());
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        // A program may end before it has read everything.
        let _ = std::io::Write::write_all(&mut child.stdin.take().unwrap(), input.as_bytes());
        child.wait_with_output().unwrap()
    }

    fn rtrace(&self, line: &str, rays: &str) -> Output {
        self.run(env!("CARGO_BIN_EXE_rtrace"), &format!("-h -w -lr -100000 -lw 0 -n 1 {line} s.oct"), rays)
    }
}

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// It ended by itself, with a message that says what is too much.
fn refused(output: &Output, what: &str) {
    assert_eq!(output.status.code(), Some(1), "{what}: {:?} {}", output.status, errors(output));
    assert!(errors(output).contains("rays that wait for each other are not supported"), "{what}: {}", errors(output));
}

/// So many panes, one behind the other, and a glow behind them.
fn panes(material: &str, count: usize) -> String {
    let pane = |k| format!("M ring p{k} 0 0 8 0 0 {} 0 0 1 0 1\n", k + 1);
    let glow = format!("void glow G 0 0 4 1 2 3 0\nG ring g 0 0 8 0 0 {} 0 0 -1 0 1\n", count + 1);
    format!("{material}\n{}{glow}", (0..count).map(pane).collect::<String>())
}

#[test]
fn rays_cross_as_many_panes_as_there_is_room_for() {
    for material in CROSSED {
        // The last pane and the glow are crossed and met by rays of their own.
        let bench = Bench::new(&panes(material, MOST - 1));
        let crossed = bench.rtrace("-ov", "0 .3 0 0 0 1\n");
        assert!(crossed.status.success(), "{material}: {:?} {}", crossed.status, errors(&crossed));
        let text = String::from_utf8_lossy(&crossed.stdout).into_owned();
        let light: Vec<f64> = text.split_whitespace().map(|w| w.parse().unwrap()).collect();
        let near = |a: f64, b: f64| (a - b).abs() < 0.02 * b;
        assert!(near(light[0], 1.0) && near(light[1], 2.0) && near(light[2], 3.0), "{material}: {light:?}");
        let tree = bench.rtrace("-tI /dev/null -otv", "0 .3 0 0 0 1\n");
        assert!(tree.status.success(), "{material}: {:?} {}", tree.status, errors(&tree));
        let bench = Bench::new(&panes(material, MOST));
        refused(&bench.rtrace("-ov", "0 .3 0 0 0 1\n"), material);
    }
}

/// Between perfectly white walls, in a tree that shows every bounce inside the one before; with panes on the way, too.
#[test]
fn paths_without_end_are_branches_as_long_as_there_is_room() {
    let walls = [
        "void plastic W 0 0 5 1 1 1 0 0",
        "void trans W 0 0 7 1 1 1 0 0 0 0",
        "void plasfunc W 2 .5 . 0 5 1 1 1 0 0",
        "void BRTDfunc W 10 0 0 0 0 0 0 0 0 0 . 0 9 1 1 1 0 0 0 0 0 0",
    ];
    let rays: Vec<String> = (1..30).map(|k| format!("0 0 1 .{k} .2 .7\n")).collect();
    for wall in walls {
        for panes in [0, 40] {
            let mist = |k| format!("M sphere m{k} 0 0 4 0 0 0 {}\n", 2.9 - 0.01 * f64::from(k));
            let shells = (0..panes).map(mist).collect::<String>();
            let scene = format!("{wall}\nW bubble b 0 0 4 0 0 0 3\nvoid mist M 0 0 0\n{shells}");
            // Nothing is shown: indented lines of so many rays are long.
            let tree = Bench::new(&scene)
                .rtrace("-ab 1 -ad 1 -as 0 -aa 0 --unbounded-bounces -tI /dev/null -otm", &rays.concat());
            refused(&tree, &format!("{wall} {panes}"));
        }
    }
}

/// Mirrors reflect a ray as often as any ray may be reflected, and end it without a word.
#[test]
fn reflections_end_before_the_room_does() {
    for mirror in ["void metal M 0 0 5 1 1 1 1 0", "void mirror M 0 0 3 1 1 1", "void plastic M 0 0 5 0 0 0 1 0"] {
        let bench =
            Bench::new(&format!("{mirror}\nM ring low 0 0 8 0 0 0 0 0 1 0 1\nM ring high 0 0 8 0 0 1 0 0 -1 0 1\n"));
        let output = bench.rtrace("-ab 0 -ov", "0 .3 .5 0 0 1\n");
        assert!(output.status.success(), "{mirror}: {:?} {}", output.status, errors(&output));
    }
}
