//! Rays per second on a generated room, and memory.
//!
//! `cargo run --release -p ambit-trace --example rays -- [scalar] [mesh] [triangles=1000000] [quads=N] [serve=FOLDER]`
//!
//! `quads` makes it a furnished room of that many quadrilaterals instead, as most scenes are.
//!
//! Without `serve` it times each set of rays five times and prints the best. With it, triangles and rays go into files of
//! that folder, numbers in the order of a little-endian machine (`triangles`: nine f32 each, the lamp's two last;
//! `NAME.rays`: origin, direction, limit as f64), and what standard input says is done, line by line: `time NAME` prints
//! the seconds of processor time and the count of a set, `answers NAME FILE` writes its hits (u32 and f64 each). That is
//! what `tools/bench/embree/run` talks to. Times are of this process's own time on the processor where the system tells.

mod clock;
mod scene;
mod sets;

use ambit_trace::{Opacity, Rank, World};
use clock::cpu;
use sets::{Question, Set};
use std::io::{BufRead, BufWriter, Write};
use std::path::Path;

fn seconds(set: &Set, world: &World) -> (f64, usize) {
    let start = cpu();
    let count = set.run(world);
    (cpu() - start, count)
}

fn create(file: impl AsRef<Path>) -> std::io::Result<BufWriter<std::fs::File>> {
    Ok(BufWriter::new(std::fs::File::create(file)?))
}

fn write(folder: &Path, wanted: usize, world: &World, sets: &[Set]) -> std::io::Result<()> {
    let mut out = create(folder.join("triangles"))?;
    let mut failed = None;
    let mut triangle = |t: [ambit_base::DVec3; 3]| {
        for x in t.iter().flat_map(ambit_base::DVec3::to_array) {
            failed = out.write_all(&(x as f32).to_le_bytes()).err().or(failed.take());
        }
    };
    scene::room(wanted, &mut triangle);
    let [a, b, c, d] = scene::lamp();
    triangle([a, b, c]);
    triangle([a, c, d]);
    if let Some(e) = failed {
        return Err(e);
    }
    out.flush()?;
    for set in sets {
        let mut out = create(folder.join(format!("{}.rays", set.name)))?;
        for r in &set.rays {
            let limit = sets::limit(world, set.question, r);
            for x in [r.origin.to_array(), r.direction.to_array()].concat().into_iter().chain([limit]) {
                out.write_all(&x.to_le_bytes())?;
            }
        }
        out.flush()?;
    }
    Ok(())
}

fn serve(world: &World, sets: &[Set]) -> std::io::Result<()> {
    println!("ready {}", sets.iter().map(|s| s.name).collect::<Vec<_>>().join(" "));
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let words: Vec<&str> = line.split(' ').collect();
        let set = |name: &str| sets.iter().find(|s| s.name == name).expect("the name of a set");
        match words[..] {
            ["time", name] => {
                let (time, count) = seconds(set(name), world);
                println!("{time} {count}");
            }
            ["answers", name, file] => {
                let mut out = create(file)?;
                for (object, distance) in set(name).answers(world) {
                    out.write_all(&object.to_le_bytes())?;
                    out.write_all(&distance.to_le_bytes())?;
                }
                out.flush()?;
                println!("written");
            }
            _ => println!("?"),
        }
    }
    Ok(())
}

fn main() -> std::io::Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let has = |w: &str| words.iter().any(|x| x == w);
    let value = |name: &str| words.iter().find_map(|w| w.strip_prefix(name)?.strip_prefix('='));
    let wanted = value("triangles").map_or(1_000_000, |n| n.parse().expect("a number of triangles"));
    let rank = Rank { opacity: Opacity::Opaque, modifier: 0, blocks: true, bends: false };
    let quads = value("quads").map(|n| n.parse().expect("a number of quadrilaterals"));
    let mut world = scene::build(wanted, has("mesh"), quads, rank);
    if has("scalar") {
        world = world.without_vectors();
    }
    let sets = sets::all(&world);
    if let Some(folder) = value("serve") {
        write(Path::new(folder), wanted, &world, &sets)?;
        return serve(&world, &sets);
    }
    for set in &sets {
        let runs: Vec<(f64, usize)> = (0..5).map(|_| seconds(set, &world)).collect();
        let best = runs.iter().map(|r| r.0).fold(f64::INFINITY, f64::min);
        let what = if set.question == Question::Nearest { "hit" } else { "reach" };
        let all = set.rays.len();
        println!("{:18} {:7.3} Mrays/s   ({} of {all} {what})", set.name, all as f64 / best / 1e6, runs[0].1);
    }
    Ok(())
}
