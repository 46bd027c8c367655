//! The header of a picture.

use super::frame::Frame;
use super::frame::Picture;
use crate::session::Session;
use ambit_file::{Header, Resolution};

/// Pixels whose aspect is within this of 1 count as square.
const SQUARE: f64 = 0.005;

impl Picture<'_> {
    /// The lines that all pictures of a run have in common.
    pub(crate) fn preamble(&self, octree: &Header) -> Header {
        let mut header = Header::empty();
        header.extend(octree.lines_without_format());
        header.extend(self.session.command_lines());
        header
    }

    /// The header of a frame, without the preamble if it stands on the stream already.
    pub(crate) fn header(&self, frame: &Frame, octree: &Header) -> Header {
        let begun = frame.number.is_some() && frame.output.is_none();
        let mut header = if begun { Header::empty() } else { self.preamble(octree) };
        if let Some(number) = frame.number {
            header.push(format!("FRAME={number}"));
        }
        header.push(frame.view.view.header_line());
        if (frame.pixel_aspect - 1.0).abs() > SQUARE {
            header.push(format!("PIXASPECT={:.6}", frame.pixel_aspect));
        }
        header.extend(Session::time_lines());
        if let Some(p) = self.options.common.output.recorded() {
            let numbers: Vec<String> = p.iter().map(|x| format!("{x:.4}")).collect();
            header.push(format!("PRIMARIES= {}", numbers.join(" ")));
        }
        header.push(format!("FORMAT={}", self.space.format()));
        header
    }
}

/// The line after the header.
pub(crate) fn resolution_line(width: u32, height: u32) -> String {
    format!("{}\n", Resolution::new(width, height))
}
