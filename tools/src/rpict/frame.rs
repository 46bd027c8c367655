//! One picture: its view and size, what is recovered, and the rest that is computed.

use super::header::resolution_line;
use super::output::PictureOutput;
use super::recover::{self, Recovered};
use super::sequence::numbered;
use super::shots::Shots;
use super::watch::Watch;
use crate::colour::Conversion;
use crate::light::{Light, Scene};
use crate::session::{Session, Stop};
use ambit_base::Notify;
use ambit_cli::{Failure, PictureOptions};
use ambit_file::{PixelSpace, Projection, View, fit_resolution};
use ambit_render::Seen;
use ambit_render::picture::{Band, Camera, Lens, Order, Pixel, Sampler, SmallSources};

/// Most pixels across: samples are numbered along a Hilbert curve by 32 bits.
const MOST_ACROSS: u32 = 65535;

/// What is common to all pictures of a run.
pub(crate) struct Picture<'a> {
    pub(crate) session: &'a Session,
    pub(crate) options: &'a PictureOptions,
    pub(crate) conversion: Conversion,
    pub(crate) space: PixelSpace,
}

/// One picture.
pub(crate) struct Frame {
    /// Its number in a sequence.
    pub(crate) number: Option<i32>,
    /// Its view.
    pub(crate) view: Projection,
    /// The view before, if motion blurs.
    pub(crate) previous: Option<Projection>,
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) pixel_aspect: f64,
    /// Output file; none for standard output.
    pub(crate) output: Option<String>,
    /// Left to others, if its output file is there: several processes divide a sequence.
    pub(crate) shared: bool,
    /// File of distances.
    pub(crate) distances: Option<String>,
    /// What is there already.
    pub(crate) recovered: Option<Recovered>,
}

/// A view that has passed its checks.
pub(crate) fn set_up(view: &View) -> Result<Projection, Failure> {
    view.set_up().map_err(|e| Failure::user(e.to_string()))
}

impl Frame {
    /// A frame of this view, to standard output.
    pub(crate) fn new(view: Projection, options: &PictureOptions) -> Self {
        let size = |v: i32| v.max(0) as u32;
        let fit = fit_resolution(view.aspect(), options.pixel_aspect, size(options.width), size(options.height));
        Self {
            number: None,
            view,
            previous: None,
            width: fit.width,
            height: fit.height,
            pixel_aspect: fit.pixel_aspect,
            output: None,
            shared: false,
            distances: None,
            recovered: None,
        }
    }

    /// The only frame of a run, perhaps with what an interrupted one has left.
    pub(crate) fn single(picture: &Picture<'_>) -> Result<Self, Stop> {
        let options = picture.options;
        let mut recovered = None;
        if let Some(file) = &options.recover
            && let Some(path) = recover::set_aside(picture.session, file, options.output.as_deref())?
        {
            recovered = recover::read(picture.session, file, path, picture.space);
        }
        let view = recovered.as_ref().and_then(|r| r.view.as_ref()).unwrap_or(&options.view);
        let projection = set_up(view).map_err(|failure| match recovered.as_ref().map(Recovered::give_back) {
            Some(Err(stays)) => failure.hint(stays),
            _ => failure,
        })?;
        let mut frame = Self::new(projection, options);
        // The names of a sequence's pictures, without one: its number is 0.
        let named = |pattern: &Option<String>| pattern.as_ref().map(|p| numbered(p, 0));
        (frame.output, frame.distances) = (named(&options.output), named(&options.distances));
        frame.take_over(recovered)?;
        Ok(frame)
    }

    /// Takes over size and lines of an interrupted picture. One that does not tell its view has to be as large as the
    /// options say.
    pub(crate) fn take_over(&mut self, recovered: Option<Recovered>) -> Result<(), Failure> {
        if let Some(r) = &recovered {
            if r.view.is_none() && r.size != (self.width, self.height) {
                let stays = r.give_back().err();
                return Err(r.mismatch(stays));
            }
            (self.width, self.height) = r.size;
            // What the view and the size come to, whatever was asked for then.
            self.pixel_aspect = fit_resolution(self.view.aspect(), 0.0, self.width, self.height).pixel_aspect;
        }
        self.recovered = recovered;
        Ok(())
    }
}

impl Picture<'_> {
    /// Makes a picture; false if it is left to others.
    pub(crate) fn make(&self, frame: &Frame, scene: &mut Scene<'_>) -> Result<bool, Stop> {
        let options = self.options;
        self.session.meter.set_percent(0.0);
        let (width, height) = (frame.width, frame.height);
        if width.max(height) > MOST_ACROSS {
            let what = format!("a picture of {width} by {height} pixels (more than {MOST_ACROSS} across) is");
            return Err(Failure::unsupported(&what).into());
        }
        let done = frame.recovered.as_ref().map_or(0, |r| r.lines.len() as u32);
        let empty = width == 0 || height == 0;
        let Some(mut output) = PictureOutput::open(frame, done, empty)? else { return Ok(false) };
        let mut head = Vec::new();
        // Writing to memory does not fail.
        let _ = self.header(frame, &scene.header).write(&mut head);
        let (columns, rows) = if empty { (0, 0) } else { (width, height) };
        head.extend_from_slice(resolution_line(columns, rows).as_bytes());
        output.head(&head)?;
        if let Some(r) = &frame.recovered {
            output.codes(&r.lines)?;
            r.remove()?;
        }
        if empty {
            self.session.messages.warn("empty output picture");
            return Ok(true);
        }
        if let Some(number) = frame.number.filter(|_| options.report > 0) {
            use std::io::Write;
            let _ = writeln!(std::io::stderr(), "FRAME {number}: {}", frame.view.view);
        }
        let lines = |left: u32| 100.0 * f64::from(height - left) / f64::from(height);
        let mut watch = Watch::start(self.session, options.report, lines(height - done));
        self.compute(frame, height - done, scene, &mut output, &mut watch)?;
        if options.report > 0 && frame.number.is_none() {
            // What reads the last line to see if a picture is done shall find the last report there.
            scene.tell();
        }
        watch.finish();
        Ok(true)
    }

    /// Computes the lowest `rows` rows.
    fn compute(
        &self,
        frame: &Frame,
        rows: u32,
        scene: &mut Scene<'_>,
        output: &mut PictureOutput,
        watch: &mut Watch<'_>,
    ) -> Result<(), Stop> {
        let options = self.options;
        let rendering = &options.rendering.options;
        let ambient = &rendering.ambient;
        let cached = ambient.bounces > 0 && ambient.accuracy > 0.0;
        let sampler = Sampler {
            width: frame.width,
            rows,
            height: frame.height,
            spacing: options.spacing as u32,
            threshold: options.threshold,
            distances: frame.distances.is_some(),
            order: if cached { Order::CoarseToFine } else { Order::TopDown },
        };
        let camera = Camera {
            projection: frame.view,
            previous: frame.previous,
            width: frame.width,
            height: frame.height,
            lens: Lens { jitter: options.jitter, aperture: options.aperture, motion: options.motion },
            seed: rendering.seed,
        };
        // Blurred pictures show small sources blurred.
        let blurred = options.aperture > 0.0 || frame.previous.is_some();
        let outlines = if rendering.direct.visible && !blurred { scene.outlines() } else { Vec::new() };
        let small =
            SmallSources::new(&outlines, frame.view, (frame.width, frame.height), sampler.spacing, sampler.distances);
        let (first, share) = sampler.first_pass();
        let start = 100.0 * (1.0 - f64::from(rows) / f64::from(frame.height));
        let part = |fraction: f64| start + (100.0 - start) * fraction;
        let watch = std::cell::RefCell::new(watch);
        let scene = std::cell::RefCell::new(scene);
        let mut traced = 0;
        let mut shots = Shots::default();
        sampler.run(
            &mut |pixels| {
                let light = &mut **scene.borrow_mut();
                let answers = shots.trace(pixels, &|p| camera.ray(p), light, &|seen| self.pixel(seen))?;
                traced += pixels.len();
                if traced <= first {
                    watch.borrow_mut().step(part(share * traced as f64 / first as f64));
                }
                Ok(answers)
            },
            &mut |mut band: Band| {
                small.draw(&mut band, &mut |requests| -> Result<_, Stop> {
                    let (mut scene, mut answers) = (scene.borrow_mut(), Vec::new());
                    scene.check()?;
                    scene.trace(requests, &mut answers)?;
                    Ok(answers.iter().map(|answer| self.pixel(&answer.into())).collect())
                })?;
                let left = f64::from(band.top + 1) - band.rows.len() as f64;
                output.pixels(&band.rows)?;
                if left > 0.0 {
                    watch.borrow_mut().step(part(share + (1.0 - share) * (1.0 - left / f64::from(rows))));
                }
                Ok(())
            },
        )
    }

    fn pixel(&self, seen: &Seen) -> Pixel {
        Pixel { colour: self.conversion.apply(seen.value), distance: seen.length }
    }
}
