//! topng: a Radiance picture as a PNG, which any program shows.

use ambit_file::{Exposure, Picture, Replacement, Transfer, write_png};
use std::path::Path;
use std::process::ExitCode;

const HELP: &str = "\
Usage: topng [-e STOPS] PICTURE FILE.png

Turns a Radiance picture into a PNG. The exposure brings the logarithmic mean of the
brightness to a medium grey.

  -e STOPS   brighter (or darker, if negative) by so many powers of two
  --help     print this text
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments.iter().map(String::as_str).collect::<Vec<_>>()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("topng: {message}");
            ExitCode::FAILURE
        }
    }
}

/// Reads, exposes and writes; the error is what to tell the user.
fn run(arguments: &[&str]) -> Result<(), String> {
    let (stops, picture, png) = match *arguments {
        ["--help"] => {
            print!("{HELP}");
            return Ok(());
        }
        ["-e", stops, picture, png] => {
            let value: f64 = stops.parse().map_err(|_| format!("-e wants a number, not '{stops}'"))?;
            (value, picture, png)
        }
        [picture, png] if !picture.starts_with('-') => (0.0, picture, png),
        _ => return Err("usage: topng [-e STOPS] PICTURE FILE.png".to_owned()),
    };
    let pixels = Picture::open(picture).map_err(|e| e.to_string())?;
    let exposure = Exposure::Factor(Exposure::Automatic.factor(&pixels) * stops.exp2());
    let failed = |e: &dyn std::fmt::Display| format!("{png}: {e}");
    let mut out = Replacement::create(Path::new(png)).map_err(|e| failed(&e))?;
    write_png(&pixels, exposure, Transfer::Srgb, &mut out).map_err(|e| failed(&e))?;
    out.commit().map_err(|e| failed(&e))
}
