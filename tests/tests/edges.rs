//! Views straight along a box have pixels on the very edges of its walls, where hemispheres leave through what they stand
//! on. No record of such a place may darken what lies around it.

use ambit_tests::{Program, programs::foreign};
use std::fmt::Write;

/// The inside of six faces, centred at the origin: a cube, but for a floor that slopes, by so much from its middle.
fn cube(half: f64, slope: f64) -> String {
    let mut scene = String::from("void plastic wall 0 0 5 .5 .5 .5 0 0\n");
    for (axis, side) in (0..3).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
        write!(scene, "wall polygon face{axis}{} 0 0 12", if side > 0.0 { "p" } else { "m" })
            .expect("a string takes all");
        // Turned so that the front looks inwards.
        for (u, v) in [(-1.0, -1.0), (-side, side), (1.0, 1.0), (side, -side)] {
            let mut corner = [0.0; 3];
            (corner[axis], corner[(axis + 1) % 3], corner[(axis + 2) % 3]) = (side * half, u * half, v * half);
            if corner[2] < 0.0 {
                corner[2] += slope * corner[0];
            }
            write!(scene, " {} {} {}", corner[0], corner[1], corner[2]).expect("a string takes all");
        }
        scene.push('\n');
    }
    scene
}

#[test]
fn records_on_edges_darken_nothing() {
    if foreign() {
        return; // Real Radiance has pixels there of half the light.
    }
    // Every other ray of the diagonals is at an edge, as far as arithmetic can tell.
    let steps: Vec<f64> = (0..24).map(|k| (f64::from(k) - 11.5) / 8.0).collect();
    for (half, slope) in [(1e-2, 0.0), (1.0, 0.0), (1e3, 0.0), (1.0, 0.3), (1.0, -0.75)] {
        let scratch = tempfile::tempdir().expect("a scratch folder can be made");
        let octree = scratch.path().join("cube.oct");
        std::fs::write(&octree, Program::new("oconv").arg("-").feed(cube(half, slope).as_bytes()).well("oconv").out)
            .expect("the scratch folder can be written");
        let ray = |x: &f64, z: &f64| {
            // Below, lines of sight end on the sloping floor's edges.
            let z = if *z < 0.0 { z * (1.0 - slope * x.signum()) } else { *z };
            format!("0 {} 0 {x} 1 {z}\n", -0.9 * half)
        };
        let rays: String = steps.iter().flat_map(|x| steps.iter().map(move |z| ray(x, z))).collect();
        let line = "-h -w- -ab 1 -av 1 1 1 -aa .2 -ar 32 -ad 256 -as 0";
        let answer = Program::new("rtrace").line(line).arg(&octree).feed(rays.as_bytes()).well("rtrace");
        let values: Vec<f64> = answer.text().split_whitespace().map(|w| w.parse().expect("a number")).collect();
        assert_eq!(values.len(), 3 * 576);
        // Walls that reflect half see walls that reflect half of 1.
        let darkest = values.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(darkest > 0.25 * 0.99, "half an edge of {half}, slope {slope}: {darkest} instead of 0.25");
    }
}
