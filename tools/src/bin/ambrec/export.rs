//! Records as geometry: a scene that is seen together with the one they are of, or points for other programs.

use crate::store::{Failure, Output, contents};
use ambit_ambient::Record;
use ambit_base::DVec3;
use clap::{Args, ValueEnum};
use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::PathBuf;

/// Corners of an ellipse.
const CORNERS: usize = 24;
/// Ellipses stand off their surface by this fraction of their radius, so as to be seen.
const LIFT: f64 = 1e-3;
/// Where rings and ellipses begin, as a fraction of their radius: whole discs would hide the scene and each other.
const INNER: f64 = 0.95;
/// Colours of the ellipses of levels 0, 1, 2 …
const COLOURS: [&str; 6] = [".9 .6 .1", ".2 .6 .9", ".4 .8 .2", ".7 .3 .8", ".9 .4 .5", ".5 .5 .5"];

#[derive(Clone, Copy, ValueEnum)]
enum Form {
    /// A Radiance scene.
    Rad,
    /// Points with normals, radii and values (PLY, text).
    Ply,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Validity {
    /// Spheres alone.
    None,
    /// Rings of the smaller radius.
    Disc,
    /// Ellipses, drawn as rings.
    Ellipse,
}

#[derive(Args)]
pub(crate) struct Export {
    /// The ambient file.
    file: PathBuf,
    /// What to write.
    #[arg(long, value_enum, default_value = "rad")]
    form: Form,
    /// How to show where a record is valid.
    #[arg(long, value_enum, default_value = "none")]
    valid: Validity,
    /// The tolerance (-aa), which multiplies the radii; the header's unless given.
    #[arg(long, value_name = "ERROR")]
    accuracy: Option<f64>,
    /// The radius of the spheres; a thousandth of the extent of the records unless given.
    #[arg(long, value_name = "RADIUS")]
    size: Option<f64>,
    #[command(flatten)]
    output: Output,
}

impl Export {
    /// Writes the geometry.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let all = contents(&self.file)?;
        let text = match self.form {
            Form::Ply => ply(&all.records),
            Form::Rad => {
                let accuracy = self.accuracy.or_else(|| all.header.lines().find_map(tolerance)).unwrap_or(1.0);
                let low = all.records.iter().fold(DVec3::INFINITY, |b, r| b.min(r.position));
                let high = all.records.iter().fold(DVec3::NEG_INFINITY, |b, r| b.max(r.position));
                let extent = if all.records.is_empty() { 1.0 } else { (high - low).max_element().max(1e-3) };
                self.scene(&all.records, accuracy, self.size.unwrap_or(1e-3 * extent))
            }
        };
        self.output.write(text.as_bytes())
    }

    fn scene(&self, records: &[Record], accuracy: f64, size: f64) -> String {
        // Glows of negative radius light nothing.
        let mut text = String::from("void glow ambrec_place\n0\n0\n4 1 0 0 -1\n");
        let deepest = records.iter().map(|r| r.level).max().unwrap_or(0);
        if self.valid != Validity::None {
            for level in 0..=deepest {
                let colour = COLOURS[usize::from(level) % COLOURS.len()];
                // Writing to memory does not fail.
                let _ = writeln!(text, "\nvoid glow ambrec_level{level}\n0\n0\n4 {colour} -1");
            }
        }
        for (k, r) in records.iter().enumerate() {
            let _ = writeln!(text, "\nambrec_place sphere ambrec.{k}\n0\n0\n4 {} {size}", point(r.position));
            let [r0, r1] = r.radii.map(|x| f64::from(x) * accuracy);
            let centre = r.position + r.normal * (LIFT * r0);
            let level = r.level;
            match self.valid {
                Validity::None => {}
                Validity::Disc => {
                    let _ = writeln!(
                        text,
                        "\nambrec_level{level} ring ambrec.{k}.valid\n0\n0\n8 {} {} {} {r0}",
                        point(centre),
                        point(r.normal),
                        INNER * r0
                    );
                }
                Validity::Ellipse => {
                    let corners = 2 * (CORNERS + 1);
                    let _ = write!(text, "\nambrec_level{level} polygon ambrec.{k}.valid\n0\n0\n{}", 3 * corners);
                    // Once around, and back inside: a polygon with a hole.
                    let outer = (0..=CORNERS).map(|c| (c, 1.0));
                    for (c, part) in outer.chain((0..=CORNERS).rev().map(|c| (c, INNER))) {
                        let (sin, cos) = (TAU * c as f64 / CORNERS as f64).sin_cos();
                        let offset = r.u * (r0 * cos) + r.v() * (r1 * sin);
                        let _ = write!(text, "\n\t{}", point(centre + offset * part));
                    }
                    text.push('\n');
                }
            }
        }
        text
    }
}

fn point(p: DVec3) -> String {
    format!("{} {} {}", p.x, p.y, p.z)
}

/// The value of `-aa` on a command line.
fn tolerance(line: &[u8]) -> Option<f64> {
    let mut words = std::str::from_utf8(line).ok()?.split_ascii_whitespace();
    words.find(|w| *w == "-aa")?;
    words.next()?.parse().ok().filter(|a| *a > 0.0)
}

fn ply(records: &[Record]) -> String {
    let names = "x y z nx ny nz ux uy uz radius_u radius_v level weight red green blue gradient_u gradient_v \
        rotation_u rotation_v corral";
    let mut text = format!(
        "ply\nformat ascii 1.0\ncomment irradiance records; values are irradiance/pi\nelement vertex {}\n",
        records.len()
    );
    for name in names.split_ascii_whitespace() {
        let kind = match name {
            "x" | "y" | "z" => "double",
            "level" => "uchar",
            "corral" => "uint",
            _ => "float",
        };
        // Writing to memory does not fail.
        let _ = writeln!(text, "property {kind} {name}");
    }
    text += "end_header\n";
    for r in records {
        let [r0, r1] = r.radii;
        let ([gu, gv], [hu, hv]) = (r.gradient, r.rotation);
        let (value, weight) = (r.value, r.weight);
        let _ = writeln!(
            text,
            "{} {} {} {r0} {r1} {} {weight} {} {} {} {gu} {gv} {hu} {hv} {}",
            point(r.position),
            point(r.normal),
            point(r.u),
            r.level,
            value.x,
            value.y,
            value.z,
            r.corral
        );
    }
    text
}
