//! Where pictures and distances go.

use super::frame::Frame;
use crate::session::Stop;
use ambit_cli::{Failure, StandardOutput};
use ambit_file::{Header, encode_pixel, encode_scanline, path_of};
use ambit_render::picture::Pixel;
use rayon::prelude::*;
use std::fs::{File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};

/// An open picture, and its file of distances.
pub(crate) struct PictureOutput {
    picture: Box<dyn Write>,
    distances: Option<File>,
}

/// Writes what comes before all pictures on standard output.
pub(crate) fn begin(lines: &Header) -> Result<(), Stop> {
    let mut stream = StandardOutput::new();
    let written = lines.write_lines(&mut stream).and_then(|()| stream.flush());
    written.map_err(|e| Stop::writing("error writing picture header", &e))
}

/// The longest scanline that is run-length encoded is part of the encoding; longer and shorter ones are written flat by
/// [`encode_scanline`] itself.
impl PictureOutput {
    /// Opens the outputs of a frame whose `done` upper rows are there. A picture's file must be new: if it is not, and
    /// others may make it (`Frame::shared`), there is nothing to open. A file of distances is written over; of an `empty`
    /// picture there is none.
    pub(crate) fn open(frame: &Frame, done: u32, empty: bool) -> Result<Option<Self>, Failure> {
        let stream: Box<dyn Write> = match &frame.output {
            None => Box::new(StandardOutput::new()),
            Some(name) => match OpenOptions::new().write(true).create_new(true).open(path_of(name)) {
                Ok(file) => Box::new(file),
                // Opening it tells at once whose it is: between asking whether it exists and opening it, others would.
                Err(e) if frame.shared && e.kind() == io::ErrorKind::AlreadyExists => return Ok(None),
                Err(e) => return Err(Failure::system(format!("cannot open output file \"{name}\""), &e)),
            },
        };
        let distances = match frame.distances.as_ref().filter(|_| !empty) {
            None => None,
            Some(name) => {
                let failed = |e: io::Error| Failure::system(format!("cannot open z-file \"{name}\""), &e);
                // An old, longer file keeps its tail, as Radiance's does.
                let mut file =
                    OpenOptions::new().write(true).create(true).truncate(false).open(path_of(name)).map_err(failed)?;
                let offset = u64::from(done) * u64::from(frame.width) * size_of::<f32>() as u64;
                // A pipe will do as long as it is written from its beginning.
                if offset > 0 {
                    file.seek(SeekFrom::Start(offset)).map_err(failed)?;
                }
                Some(file)
            }
        };
        Ok(Some(Self { picture: stream, distances }))
    }

    /// Writes the header and what follows it.
    pub(crate) fn head(&mut self, bytes: &[u8]) -> Result<(), Stop> {
        let written = self.picture.write_all(bytes).and_then(|()| self.picture.flush());
        written.map_err(|e| Stop::writing("error writing picture header", &e))
    }

    /// Writes scanlines of codes, from the top down.
    pub(crate) fn codes(&mut self, lines: &[Vec<[u8; 4]>]) -> Result<(), Stop> {
        let encoded = |line: &Vec<[u8; 4]>| {
            let mut bytes = Vec::new();
            encode_scanline(line, &mut bytes);
            bytes
        };
        let lines: Vec<Vec<u8>> = lines.par_iter().map(encoded).collect();
        let written = self.picture.write_all(&lines.concat()).and_then(|()| self.picture.flush());
        written.map_err(|e| Stop::writing("write error in render", &e))
    }

    /// Writes scanlines of pixels and their distances.
    pub(crate) fn pixels(&mut self, rows: &[Vec<Pixel>]) -> Result<(), Stop> {
        let codes = |row: &Vec<Pixel>| row.iter().map(|pixel| encode_pixel(pixel.colour)).collect();
        self.codes(&rows.par_iter().map(codes).collect::<Vec<_>>())?;
        if let Some(file) = &mut self.distances {
            let distances: Vec<u8> = rows.iter().flatten().flat_map(|pixel| pixel.distance.to_ne_bytes()).collect();
            file.write_all(&distances).map_err(|e| Stop::writing("write error in render", &e))?;
        }
        Ok(())
    }
}
