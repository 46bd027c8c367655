//! topng: a Radiance picture as a PNG, which any program shows.

use ambit_base::Rgb;
use ambit_cli::{ConsoleMessages, answer};
use ambit_file::{Exposure, Picture, Replacement, Transfer, path_of, word_of, write_png};
use std::process::ExitCode;

const HELP: &str = "\
Usage: topng [-e STOPS] [-s N] PICTURE FILE.png

Turns a Radiance picture into a PNG. The exposure brings the logarithmic mean of the
brightness to a medium grey.

  -e STOPS   brighter (or darker, if negative) by so many powers of two
  -s N       average blocks of N x N pixels into one; what is left over at the edges goes
  --help     print this text
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args_os().skip(1).map(|word| word_of(&word)).collect();
    match run(&arguments.iter().map(String::as_str).collect::<Vec<_>>()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            ConsoleMessages { program: "topng".to_owned(), warnings: true }.print(message);
            ExitCode::FAILURE
        }
    }
}

/// Reads, shrinks, exposes and writes; the error is what to tell the user.
fn run(arguments: &[&str]) -> Result<(), String> {
    let (mut stops, mut shrink, mut rest) = (0.0, 1, arguments);
    let (picture, png) = loop {
        match *rest {
            ["--help"] => {
                answer(HELP.as_bytes());
                return Ok(());
            }
            ["-e", value, ..] => {
                stops = value.parse().map_err(|_| format!("-e wants a number, not '{value}'"))?;
            }
            ["-s", value, ..] => {
                let count = value.parse().ok().filter(|n| *n > 0);
                shrink = count.ok_or_else(|| format!("-s wants a positive integer, not '{value}'"))?;
            }
            [picture, png] if !picture.starts_with('-') => break (picture, png),
            _ => return Err("usage: topng [-e STOPS] [-s N] PICTURE FILE.png".to_owned()),
        }
        rest = &rest[2..];
    };
    let pixels = smaller(Picture::open(picture).map_err(|e| e.to_string())?, shrink);
    let exposure = Exposure::Factor(Exposure::Automatic.factor(&pixels) * f64::exp2(stops));
    let failed = |e: &dyn std::fmt::Display| format!("{png}: {e}");
    let mut out = Replacement::create(&path_of(png)).map_err(|e| failed(&e))?;
    write_png(&pixels, exposure, Transfer::Srgb, &mut out).map_err(|e| failed(&e))?;
    out.commit().map_err(|e| failed(&e))
}

/// The picture with the mean of every block of n x n pixels for the block.
fn smaller(picture: Picture, n: u32) -> Picture {
    let (width, height) = (picture.width / n, picture.height / n);
    let block = |x: u32, y: u32| {
        let inside =
            (0..n * n).filter_map(|i| picture.pixels.get(((y * n + i / n) * picture.width + x * n + i % n) as usize));
        inside.sum::<Rgb>() / (n * n) as f32
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| block(x, y)).collect();
    Picture { width, height, pixels, ..picture }
}
