//! Adaptive sampling of a picture: a lattice of pixels first, then what lies between, traced where the picture is busy.
//!
//! With an irradiance cache the lattice of the whole picture is traced coarse to fine, in growing batches, so that
//! values are spread evenly; without one, line by line, so that finished lines come out at once.

use super::lattice::Lattice;
use super::order::{Batches, coarse_to_fine, hilbert_index};
use super::slab::{Density, Rule, Slab};
use ambit_base::Rgb;
use rayon::prelude::*;

/// Pixels that are decided together: enough to make large batches, few enough to get lines out soon. It is a count,
/// so that results do not depend on threads.
const SLAB_PIXELS: usize = 1 << 14;

/// Pixels whose places along the curve are not worth more than one thread.
const FEW: usize = 1024;

/// The fraction of the pixels off the lattice that is traced in pictures of moderate detail; it only matters to reports.
const USUALLY_TRACED: f64 = 0.25;

/// A pixel to be traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelRequest {
    /// Column from the left.
    pub x: u32,
    /// Row from the bottom.
    pub y: u32,
    /// Number of the sample: neighbours have near numbers, so that their samples stratify together.
    pub index: u32,
}

/// What is known of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pixel {
    /// Its colour, in the space that is written.
    pub colour: Rgb,
    /// Distance to what it shows.
    pub distance: f32,
}

impl Pixel {
    /// Between `a` (at 0) and `b` (at 1). Both are weighted in double precision, rounded, and then added: a picture's
    /// codes are cut off, not rounded, so the last bit shows.
    pub(crate) fn between(a: &Self, b: &Self, at: f64) -> Self {
        let part = |c: Rgb, weight: f64| (c.as_dvec3() * weight).as_vec3();
        let distance = f64::from(a.distance) * (1.0 - at) + f64::from(b.distance) * at;
        Self { colour: part(a.colour, 1.0 - at) + part(b.colour, at), distance: distance as f32 }
    }
}

/// In which order the lattice is traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// All of it first, coarse to fine.
    CoarseToFine,
    /// With the lines that need it, from the top down.
    TopDown,
}

/// How a picture is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampler {
    /// Pixels across.
    pub width: u32,
    /// Rows to make: the lowest ones of the picture.
    pub rows: u32,
    /// All rows of the picture.
    pub height: u32,
    /// `-ps`: spacing of the samples in pixels.
    pub spacing: u32,
    /// `-pt`: relative difference of two pixels above which the one between them is traced.
    pub threshold: f64,
    /// Differences in distance count, too.
    pub distances: bool,
    /// In which order the lattice is traced.
    pub order: Order,
}

/// Answers a batch of pixels, in order.
pub type Trace<'a, E> = dyn FnMut(&[PixelRequest]) -> Result<Vec<Pixel>, E> + 'a;

/// Finished rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// Number of the first of them, from the bottom of the picture.
    pub top: u32,
    /// The rows, from there down.
    pub rows: Vec<Vec<Pixel>>,
}

impl Sampler {
    /// Makes the picture: `trace` answers batches of pixels in order, `emit` takes finished rows from the top down.
    ///
    /// # Errors
    /// Those of `trace` and `emit`.
    pub fn run<E>(&self, trace: &mut Trace<'_, E>, emit: &mut dyn FnMut(Band) -> Result<(), E>) -> Result<(), E> {
        if self.width == 0 || self.rows == 0 {
            return Ok(());
        }
        let lattice = Lattice::new(self.width, self.rows, self.spacing);
        let mut batches = Batches::default();
        let mut first = match self.order {
            Order::CoarseToFine => self.trace_lattice(&lattice, &mut batches, trace)?.into_iter(),
            Order::TopDown => Vec::new().into_iter(),
        };
        let per_slab = (SLAB_PIXELS / (self.width as usize * lattice.down as usize)).max(1);
        let rule = Rule { threshold: self.threshold, distances: self.distances };
        let mut density: Density = vec![lattice.across as i32; lattice.widest() as usize + 1];
        let mut above: Option<Vec<Pixel>> = None;
        let last = lattice.lines.len() - 1;
        let mut line = 0;
        loop {
            let end = (line + per_slab).min(last);
            let mut slab = Slab::new(&lattice, self.width, (line, end), rule);
            if let Some(top) = &above {
                slab.set_top(top);
            }
            for n in line + usize::from(above.is_some())..=end {
                for ((x, y), pixel) in lattice.columns(n).map(|x| (x, lattice.lines[n])).zip(&mut first) {
                    slab.set(x, y, pixel);
                }
            }
            density = loop {
                let (missing, busy) = slab.decide_lines(&density, above.is_some());
                if missing.is_empty() {
                    break busy;
                }
                self.trace_missing(&mut slab, missing, &mut batches, trace)?;
            };
            loop {
                let missing = slab.decide_columns();
                if missing.is_empty() {
                    break;
                }
                self.trace_missing(&mut slab, missing, &mut batches, trace)?;
            }
            let done = end == last;
            let rows: Vec<Vec<Pixel>> = slab.rows(done).collect();
            if !rows.is_empty() {
                emit(Band { top: lattice.lines[line], rows })?;
            }
            if done {
                return Ok(());
            }
            above = Some(slab.bottom());
            line = end;
        }
    }

    /// How many pixels are traced before the first rows come out, and which part of the work that is, roughly.
    pub fn first_pass(&self) -> (usize, f64) {
        if self.order == Order::TopDown || self.width == 0 {
            return (0, 0.0);
        }
        let lattice = Lattice::new(self.width, self.rows, self.spacing);
        let size: usize = (0..lattice.lines.len()).map(|n| lattice.columns(n).count()).sum();
        let others = f64::from(self.width) * f64::from(self.rows) - size as f64;
        (size, size as f64 / (size as f64 + USUALLY_TRACED * others))
    }

    fn request(&self, (x, y): (u32, u32)) -> PixelRequest {
        PixelRequest { x, y, index: hilbert_index(x, y, self.width, self.height) }
    }

    /// Traces the whole lattice coarse to fine. Returns its pixels line by line.
    fn trace_lattice<E>(
        &self,
        lattice: &Lattice,
        batches: &mut Batches,
        trace: &mut Trace<'_, E>,
    ) -> Result<Vec<Pixel>, E> {
        let lines: Vec<Vec<u32>> = (0..lattice.lines.len()).map(|n| lattice.columns(n).collect()).collect();
        let starts: Vec<usize> = lines
            .iter()
            .scan(0, |sum, line| {
                let start = *sum;
                *sum += line.len();
                Some(start)
            })
            .collect();
        // Places on the lattice, which is about square in the picture: numbers of sample and line.
        let places = coarse_to_fine(lattice.widest(), lines.len() as u32);
        let (slots, wanted): (Vec<usize>, Vec<PixelRequest>) = places
            .into_iter()
            .filter_map(|(i, n)| {
                let (i, n) = (i as usize, n as usize);
                let x = *lines[n].get(i)?;
                Some((starts[n] + i, self.request((x, lattice.lines[n]))))
            })
            .unzip();
        let mut pixels = vec![Pixel::default(); wanted.len()];
        let mut at = 0;
        while at < wanted.len() {
            let size = batches.next(wanted.len() - at);
            for (slot, pixel) in slots[at..at + size].iter().zip(trace(&wanted[at..at + size])?) {
                pixels[*slot] = pixel;
            }
            at += size;
        }
        Ok(pixels)
    }

    /// Traces pixels that were missed, those with near numbers together.
    fn trace_missing<E>(
        &self,
        slab: &mut Slab,
        missing: Vec<(u32, u32)>,
        batches: &mut Batches,
        trace: &mut Trace<'_, E>,
    ) -> Result<(), E> {
        let mut wanted: Vec<PixelRequest> =
            missing.into_par_iter().with_min_len(FEW).map(|p| self.request(p)).collect();
        wanted.par_sort_unstable_by_key(|r| r.index);
        let mut rest = wanted.as_slice();
        while !rest.is_empty() {
            let (batch, later) = rest.split_at(batches.next(rest.len()));
            for (request, pixel) in batch.iter().zip(trace(batch)?) {
                slab.set(request.x, request.y, pixel);
            }
            rest = later;
        }
        Ok(())
    }
}
