//! The information header before the records.

use crate::session::{Session, Stop};
use ambit_cli::{Output, OutputFormat, OutputSpec, RayOptions};
use ambit_file::{Header, format_line, general};
use std::io::Write;

/// The primaries that are recorded for XYZ.
const XYZ: [f64; 8] = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0 / 3.0, 1.0 / 3.0];

/// Appends the header with its empty line.
pub(crate) fn write(
    out: &mut Vec<u8>,
    session: &Session,
    options: &RayOptions,
    octree: &Header,
    spec: &OutputSpec,
    channels: usize,
) -> Result<(), Stop> {
    let mut header = Header::empty();
    header.extend(octree.lines_without_format());
    header.extend(session.command_lines());
    header.extend(Session::time_lines());
    let components = spec.components(channels);
    // A tree has records of no fixed size. With nothing after the letter it is none.
    if components > 0 && spec.tree.is_none() {
        header.push(format!("NCOMP={components}"));
    }
    let spectrum = &options.rendering.options.spectrum;
    let spectral = options.common.output.bins() && !spectrum.is_rgb();
    if spectral {
        let limits = spectrum.limits().map(|nm| general(nm, 6));
        header.push(format!("WAVELENGTH_SPLITS= {}", limits.join(" ")));
    }
    let primaries = match options.common.output {
        Output::Xyz => Some(XYZ),
        Output::Primaries(p) => Some(p),
        _ => None,
    };
    if let Some(p) = primaries {
        let numbers: Vec<String> = p.iter().map(|x| format!("{x:.4}")).collect();
        header.push(format!("PRIMARIES= {}", numbers.join(" ")));
    }
    let format = match options.format {
        OutputFormat::Ascii => "ascii",
        OutputFormat::Float => "float",
        OutputFormat::Double => "double",
        OutputFormat::Colour if spectral => "Radiance_spectra",
        OutputFormat::Colour if options.common.output == Output::Xyz => "32-bit_rle_xyze",
        OutputFormat::Colour => "32-bit_rle_rgbe",
    };
    if matches!(options.format, OutputFormat::Float | OutputFormat::Double) {
        header.push(format!("BigEndian={}", u8::from(cfg!(target_endian = "big"))));
    }
    // The data is aligned in files; on pipes there is nothing to align.
    let start = rustix::fs::tell(std::io::stdout()).ok().map(|at| at + header.size());
    header.push(format_line(format, start));
    header.write(out).and_then(|()| out.flush()).map_err(|e| Stop::writing("write error", &e))
}
