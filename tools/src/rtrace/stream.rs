//! The stream of rays: batches, flushing, and the number of records.
//!
//! Batches grow from one ray to 4096 and end where output must be flushed; where they end depends on the options and on
//! the rays, never on how a pipe delivers them.

use super::input::{Awaited, RayReader};
use super::record::RecordWriter;
use super::tree::TreeWriter;
use crate::light::Light;
use crate::session::Stop;
use ambit_base::{DVec3, FAR};
use ambit_cli::{OutputSpec, RayOptions};
use ambit_render::picture::Batches;
use ambit_render::{Aim, Answer, Request};
use std::io::Write;

/// Bytes of a tree that are collected before they are written.
const BUFFER: usize = 1 << 16;

/// Bytes of records that are collected before they are written, while rays are at hand: as many as Radiance collects. So
/// `rtrace -h … | head -1` reads all of a short output before it closes the pipe.
const COLLECTED: usize = 1 << 12;

/// How a stream is cut.
pub(crate) struct Stream {
    aim: Aim,
    limited: bool,
    /// Flush after so many rays; 0 for never.
    interval: u64,
    /// Stop after so many records; 0 for never.
    most: u64,
    /// Whether a number of records was told (`-y`), be it one that is never reached because it is negative.
    promised: bool,
}

impl Stream {
    /// The stream that the options ask for.
    pub(crate) fn new(options: &RayOptions, spec: &OutputSpec) -> Self {
        let aim = match (options.immediate, spec.shades()) {
            (true, _) => Aim::Irradiance,
            (false, true) => Aim::Radiance,
            (false, false) => Aim::Geometry,
        };
        let (x, y) = (options.width.max(0) as u64, options.height.max(0) as u64);
        // In a picture only a width of one flushes.
        let interval = if y > 0 && x > 1 { 0 } else { x };
        let most = if y > 0 { x.max(1) * y } else { 0 };
        Self { aim, limited: options.limited, interval, most, promised: options.height != 0 }
    }

    /// What is asked for a ray, by its number.
    pub(crate) fn request(&self, origin: DVec3, direction: DVec3, index: u32) -> Request {
        let limit = if self.limited { direction.length() } else { FAR };
        Request { origin, direction, limit, index, aim: self.aim }
    }

    /// Most rays that are answered, and directions of zero that count as such.
    pub(crate) fn most(&self) -> usize {
        if self.most == 0 { usize::MAX } else { usize::try_from(self.most).unwrap_or(usize::MAX) }
    }

    /// Answers rays until they end. Returns false if more were promised (`-y`).
    pub(crate) fn run<R: Awaited>(
        &self,
        rays: &mut RayReader<R>,
        records: &RecordWriter<'_>,
        tree: Option<&TreeWriter<'_>>,
        light: &mut dyn Light,
        out: &mut dyn Write,
    ) -> Result<bool, Stop> {
        let mut bytes = Vec::new();
        let result = self.answer(rays, records, tree, light, &mut bytes, out);
        // What ended it does not take with it what was calculated; the first error counts.
        let written = put(&mut bytes, out);
        result.and_then(|complete| written.map(|()| complete))
    }

    /// As [`Self::run`]; what is left in `bytes` has not been written.
    fn answer<R: Awaited>(
        &self,
        rays: &mut RayReader<R>,
        records: &RecordWriter<'_>,
        tree: Option<&TreeWriter<'_>>,
        light: &mut dyn Light,
        bytes: &mut Vec<u8>,
        out: &mut dyn Write,
    ) -> Result<bool, Stop> {
        let mut batches = Batches::default();
        let mut requests: Vec<Request> = Vec::new();
        let mut answers = Vec::new();
        let mut before = (DVec3::ZERO, DVec3::ZERO);
        // Records made in all, and rays since the last flush.
        let (mut made, mut unflushed) = (0u64, 0u64);
        let mut index = 0u32;
        loop {
            let mut room = u64::MAX;
            if self.interval > 0 {
                room = self.interval - unflushed;
            }
            if self.most > 0 {
                room = room.min(self.most - made);
            }
            let size = batches.next(usize::try_from(room).unwrap_or(usize::MAX));
            let mut end = false;
            let mut zero = false;
            while requests.len() < size {
                // What has been calculated is safe from whatever ends the program while the next rays are waited for.
                if !bytes.is_empty() && rays.waits() {
                    put(bytes, out)?;
                }
                let Some((origin, direction)) = rays.next() else {
                    end = true;
                    break;
                };
                if direction.length() == 0.0 {
                    zero = true;
                    break;
                }
                requests.push(self.request(origin, direction, index));
                index = index.wrapping_add(1);
            }
            if let Some(tree) = tree {
                for request in &requests {
                    // Trees can be large; but what was read before the input ended is answered.
                    if !end {
                        light.check()?;
                    }
                    let answer = show(request, tree, bytes, light, out)?;
                    records.write_all(bytes, &[answer], light.spectra(), &|id, modifier| light.name(id, modifier));
                    before = (answer.origin, answer.direction);
                }
            } else {
                light.trace(&requests, &mut answers)?;
                records.write_all(bytes, &answers, light.spectra(), &|id, modifier| light.name(id, modifier));
                if let Some(last) = answers.last() {
                    before = (last.origin, last.direction);
                }
            }
            made += requests.len() as u64;
            unflushed += requests.len() as u64;
            requests.clear();
            let mut flush = self.interval > 0 && unflushed >= self.interval;
            if zero {
                records.write_bogus(bytes, before, &|id, modifier| light.name(id, modifier));
                made += 1;
                // Alone it is written, but no reason to flush.
                flush |= unflushed > 0;
            }
            let full = self.most > 0 && made >= self.most;
            if flush || end || full || bytes.len() >= COLLECTED {
                put(bytes, out)?;
            }
            if flush || end || full {
                out.flush().map_err(|e| Stop::writing("write error", &e))?;
                unflushed = 0;
            }
            // Whether the input has ended or a signal ended it: what was read is answered.
            light.check()?;
            if end || full {
                return Ok(full || !self.promised);
            }
        }
    }
}

/// Writes what was collected, once: what cannot be written is not tried again.
fn put(bytes: &mut Vec<u8>, out: &mut dyn Write) -> Result<(), Stop> {
    if bytes.is_empty() {
        return Ok(());
    }
    let written = out.write_all(bytes);
    bytes.clear();
    written.map_err(|e| Stop::writing("write error", &e))
}

/// Answers one ray and writes its tree, which may be larger than memory.
fn show(
    request: &Request,
    tree: &TreeWriter<'_>,
    bytes: &mut Vec<u8>,
    light: &mut dyn Light,
    out: &mut dyn Write,
) -> Result<Answer, Stop> {
    let mut written = Ok(());
    let answer = light.trace_tree(request, &mut |ray, bins, names| {
        tree.write(bytes, ray, bins, names);
        if bytes.len() >= BUFFER {
            if written.is_ok() {
                written = put(bytes, out);
            }
            bytes.clear();
        }
    });
    if written.is_err() {
        bytes.clear();
    }
    written.and(answer)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectral::Converter;
    use ambit_base::Rgb;
    use ambit_cli::{InputFormat, Output, OutputFormat};
    use ambit_render::{Rays, Seen, Visit};
    use ambit_scene::ObjectId;
    use std::cell::RefCell;
    use std::io::Read;
    use std::rc::Rc;

    /// A light whose radiance is the ray's first coordinate, and which a negative one stops; it notes the sizes of batches,
    /// and insists on being given the memory of the answers before.
    struct Plain {
        log: Rc<RefCell<Vec<String>>>,
        /// Answers of the last batch, and the memory that they are in.
        left: (usize, usize),
    }

    impl Light for Plain {
        fn trace(&mut self, requests: &[Request], answers: &mut Vec<Answer>) -> Result<(), Stop> {
            if !requests.is_empty() {
                self.log.borrow_mut().push(format!("trace {}", requests.len()));
            }
            assert_eq!((answers.len(), answers.capacity()), self.left, "other memory than before");
            if requests.iter().any(|r| r.origin.x < 0.0) {
                return Err(Stop::Signal);
            }
            let answer = |r: &Request| {
                let mut a = Answer::nothing(r.origin, r.direction.normalize());
                a.value = Rgb::splat(r.origin.x as f32);
                a
            };
            answers.clear();
            answers.extend(requests.iter().map(answer));
            self.left = (answers.len(), answers.capacity());
            Ok(())
        }

        fn see(&mut self, _: &dyn Rays, _: &mut Vec<Seen>) -> Result<(), Stop> {
            unreachable!("these tests ask for no pictures")
        }

        fn trace_tree(&mut self, _: &Request, _: Visit<'_>) -> Result<Answer, Stop> {
            unreachable!("these tests ask for no trees")
        }

        fn name(&self, _: ObjectId, _: ObjectId) -> &[u8] {
            b"it"
        }
    }

    /// Output that notes how many bytes come at once.
    struct Pieces(Vec<usize>);

    impl Write for Pieces {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.push(bytes.len());
            Ok(bytes.len())
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    /// Input whose parts, the last one first, come one after the other.
    struct Slow<'a>(Vec<&'a [u8]>);

    impl Read for Slow<'_> {
        fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
            let part = self.0.pop().unwrap_or_default();
            bytes[..part.len()].copy_from_slice(part);
            Ok(part.len())
        }
    }

    impl Awaited for Slow<'_> {
        fn waits(&self) -> bool {
            !self.0.is_empty()
        }
    }

    /// The pieces in which records of 4 bytes are written.
    fn pieces(input: impl Awaited) -> (Vec<usize>, Result<bool, Stop>) {
        let mut options = RayOptions::new(1);
        options.format = OutputFormat::Float;
        options.common.output = Output::Average;
        let spec = OutputSpec::parse(&options.fields).unwrap();
        let converter = Converter::new(options.common.output, &options.rendering.options.spectrum);
        let records = RecordWriter::new(&spec.fields, &converter, &options);
        let mut out = Pieces(Vec::new());
        let mut light = Plain { log: Rc::default(), left: (0, 0) };
        let mut rays = RayReader::new(input, InputFormat::Ascii);
        let result = Stream::new(&options, &spec).run(&mut rays, &records, None, &mut light, &mut out);
        (out.0, result)
    }

    #[test]
    fn records_are_collected_while_rays_are_at_hand() {
        assert_eq!(pieces(rays(9).as_bytes()).0, [36]);
        // Batches of 1, 1, 2, 4 … 512 are 4096 bytes.
        assert_eq!(pieces(rays(1500).as_bytes()).0, [4096, 1904]);
        // Before more is waited for, what is there is written: the third ray is in a batch with the fourth.
        let (first, second) = (rays(3), rays(2));
        assert_eq!(pieces(Slow(vec![second.as_bytes(), first.as_bytes()])).0, [8, 12]);
        // As it is if a part of a ray has come.
        let part = format!("{first}9 0 ");
        let rest = second.split_once(' ').unwrap().1.split_once(' ').unwrap().1;
        assert_eq!(pieces(Slow(vec![rest.as_bytes(), part.as_bytes()])).0, [8, 12]);
    }

    #[test]
    fn what_was_calculated_is_written_whatever_ends_the_run() {
        let input = rays(9).replace("7 0 0", "-7 0 0");
        let (written, result) = pieces(input.as_bytes());
        assert_eq!(written, [16]);
        assert!(matches!(result, Err(Stop::Signal)));
    }

    /// Output that notes when it is flushed, and how many bytes came.
    struct Watched(Rc<RefCell<Vec<String>>>, Vec<u8>, usize);

    impl Write for Watched {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.1.extend_from_slice(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> std::io::Result<()> {
            self.0.borrow_mut().push(format!("flush {}", (self.1.len() - self.2) / 4));
            self.2 = self.1.len();
            Ok(())
        }
    }

    fn run(set: impl Fn(&mut RayOptions), input: &str) -> (Vec<String>, Vec<f32>, bool) {
        let mut options = RayOptions::new(1);
        options.format = OutputFormat::Float;
        options.common.output = Output::Average;
        set(&mut options);
        let spec = OutputSpec::parse(&options.fields).unwrap();
        let converter = Converter::new(options.common.output, &options.rendering.options.spectrum);
        let records = RecordWriter::new(&spec.fields, &converter, &options);
        let log = Rc::new(RefCell::new(Vec::new()));
        let mut out = Watched(Rc::clone(&log), Vec::new(), 0);
        let mut rays = RayReader::new(input.as_bytes(), InputFormat::Ascii);
        let mut light = Plain { log: Rc::clone(&log), left: (0, 0) };
        let complete = Stream::new(&options, &spec).run(&mut rays, &records, None, &mut light, &mut out).unwrap();
        let values = out.1.chunks_exact(4).map(|b| f32::from_ne_bytes(b.try_into().unwrap())).collect();
        let log = log.borrow().clone();
        (log, values, complete)
    }

    fn rays(n: usize) -> String {
        (1..=n).map(|i| format!("{i} 0 0 0 0 2\n")).collect::<Vec<_>>().concat()
    }

    #[test]
    fn batches_grow_without_flushing() {
        let (log, values, complete) = run(|_| {}, &rays(9));
        assert_eq!(log, ["trace 1", "trace 1", "trace 2", "trace 4", "trace 1", "flush 9"]);
        assert_eq!(values, [1., 2., 3., 4., 5., 6., 7., 8., 9.]);
        assert!(complete);
    }

    #[test]
    fn every_ray_is_flushed_if_that_is_asked() {
        let (log, ..) = run(|o| o.width = 1, &rays(3));
        assert_eq!(log, ["trace 1", "flush 1", "trace 1", "flush 1", "trace 1", "flush 1", "flush 0"]);
        let (log, ..) = run(|o| o.width = 4, &rays(6));
        assert_eq!(log, ["trace 1", "trace 1", "trace 2", "flush 4", "trace 2", "flush 2"]);
    }

    #[test]
    fn a_zero_direction_flushes_what_is_pending() {
        let zero = "9 9 9 0 0 0\n";
        let input = format!("{zero}{}{zero}{zero}5 0 0 0 1 0\n", rays(1));
        let (log, values, _) = run(|_| {}, &input);
        // The first and the third have nothing pending.
        assert_eq!(log, ["trace 1", "flush 3", "trace 1", "flush 2"]);
        assert_eq!(values, [0., 1., 0., 0., 5.]);
        let (_, values, _) = run(|o| o.fields = "od".into(), "1 2 3 0 0 2 9 9 9 0 0 0");
        assert_eq!(values, [1., 2., 3., 0., 0., 1., 1., 2., 3., 0., 0., 1.]);
    }

    #[test]
    fn the_number_of_records_is_kept() {
        let (_, values, complete) = run(|o| o.height = 2, &rays(5));
        assert_eq!((values.len(), complete), (2, true));
        let (log, values, complete) = run(|o| (o.width, o.height) = (2, 2), &rays(5));
        assert_eq!((values.len(), complete), (4, true));
        assert_eq!(log.last().unwrap(), "flush 4");
        let (_, values, complete) = run(|o| (o.width, o.height) = (2, 3), &format!("0 0 0 0 0 0 {}", rays(4)));
        assert_eq!((values.len(), complete), (5, false));
        let (_, values, complete) = run(|o| o.height = -1, &rays(5));
        assert_eq!((values.len(), complete), (5, false));
    }
}
