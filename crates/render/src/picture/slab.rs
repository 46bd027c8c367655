//! Filling the pixels between the samples of the lattice, some lines at a time.
//!
//! A span between two known pixels is halved: its middle is traced if the surroundings are busy or its ends differ,
//! else interpolated; then both halves likewise. How busy a place is depends on how many pixels were traced in the
//! span above or the column before, so the decisions form a chain. They are made here with the values known so far
//! and with counts that are lower bounds; as more tracing only ever leads to more tracing, every pixel found needed
//! that way is one that deciding one pixel after the other would trace, too. Tracing those and deciding again, until
//! nothing is missing, gives the same picture as the chain does, but in a few large batches.

use super::lattice::Lattice;
use super::sampler::Pixel;

/// How busy the line above was: numbers of traced pixels per span.
pub(crate) type Density = Vec<i32>;

/// What decides if the middle of a span is traced.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rule {
    /// Relative difference of colours, or of distances.
    pub(crate) threshold: f64,
    /// Distances count.
    pub(crate) distances: bool,
}

/// Lines of a picture from one line of the lattice to another, both included.
pub(crate) struct Slab<'a> {
    lattice: &'a Lattice,
    width: usize,
    /// Numbers of the lattice's lines at the top and the bottom.
    lines: (usize, usize),
    /// Row of the picture at the bottom.
    base: u32,
    rule: Rule,
    /// Pixels that were traced, row by row from the bottom.
    traced: Vec<Option<Pixel>>,
    /// Pixels as decided last; none where a value is missing.
    decided: Vec<Option<Pixel>>,
    /// Places in `traced` of the values that were missed.
    missing: Vec<usize>,
    /// Columns between two lines of the lattice in which no value is missing, line by line.
    settled: Vec<Option<Settled>>,
}

/// A column in which no value is missing: how busy it was said to be, and how busy it is.
#[derive(Clone, Copy)]
struct Settled {
    hint: i32,
    busy: i32,
}

impl<'a> Slab<'a> {
    /// The rows between two lines of the lattice of a picture of that width.
    pub(crate) fn new(lattice: &'a Lattice, width: u32, lines: (usize, usize), rule: Rule) -> Self {
        let (top, base) = (lattice.lines[lines.0], lattice.lines[lines.1]);
        let size = width as usize * (top - base + 1) as usize;
        let (traced, decided) = (vec![None; size], vec![None; size]);
        let settled = vec![None; width as usize * (lines.1 - lines.0)];
        Self { lattice, width: width as usize, lines, base, rule, traced, decided, missing: Vec::new(), settled }
    }

    fn place(&self, x: u32, y: u32) -> usize {
        (y - self.base) as usize * self.width + x as usize
    }

    /// Column and row of a place.
    fn pixel(&self, place: usize) -> (u32, u32) {
        ((place % self.width) as u32, (place / self.width) as u32 + self.base)
    }

    /// Sets a traced pixel.
    pub(crate) fn set(&mut self, x: u32, y: u32, pixel: Pixel) {
        let place = self.place(x, y);
        self.traced[place] = Some(pixel);
    }

    /// Takes over the line of the lattice at the top, all of it, from the slab above.
    pub(crate) fn set_top(&mut self, line: &[Pixel]) {
        let start = self.decided.len() - self.width;
        for (to, from) in self.decided[start..].iter_mut().zip(line) {
            *to = Some(*from);
        }
    }

    /// Decides all pixels on lines of the lattice, except a top line that was taken over. Returns the pixels that must
    /// be traced before deciding again, and how busy the lines are, of use when none are missing.
    pub(crate) fn decide_lines(&mut self, above: &Density, top_is_done: bool) -> (Vec<(u32, u32)>, Density) {
        self.missing.clear();
        let mut density = above.clone();
        for n in self.lines.0 + usize::from(top_is_done)..=self.lines.1 {
            self.decide_line(n, &mut density);
        }
        (self.missing.iter().map(|&p| self.pixel(p)).collect(), density)
    }

    fn decide_line(&mut self, n: usize, density: &mut Density) {
        let y = self.lattice.lines[n];
        let even = n % 2 == 1;
        let mut columns = self.lattice.columns(n);
        let Some(mut left) = columns.next() else { return };
        self.sample(left, y);
        let mut before = self.lattice.across as i32;
        let mut spans = 0;
        for (span, right) in columns.enumerate() {
            self.sample(right, y);
            let busy = density[span].max(density[span + 1]);
            let count = self.fill(self.place(left, y), 1, (right - left) as usize, busy / 2);
            // Spans of the next line are shifted by half: it finds its neighbours at `span` and `span + 1`.
            density[span] = if even { count } else { before };
            (before, left, spans) = (count, right, span + 1);
        }
        if !even && spans > 0 {
            density[spans] = before;
        }
    }

    /// A pixel of the lattice, which is traced in any case.
    fn sample(&mut self, x: u32, y: u32) {
        let place = self.place(x, y);
        self.decided[place] = self.traced[place];
        if self.traced[place].is_none() {
            self.missing.push(place);
        }
    }

    /// Decides all pixels between the lines of the lattice. Returns the pixels that must be traced before deciding
    /// again.
    pub(crate) fn decide_columns(&mut self) -> Vec<(u32, u32)> {
        self.missing.clear();
        for n in self.lines.0..self.lines.1 {
            let (top, bottom) = (self.lattice.lines[n], self.lattice.lines[n + 1]);
            // The first column is as busy as can be; a last step that is shorter counts as long as it is.
            let mut busy = (top - bottom) as i32;
            for x in 0..self.width {
                let column = (n - self.lines.0) * self.width + x;
                busy = match self.settled[column] {
                    Some(Settled { hint, busy: settled }) if hint == busy / 2 => settled,
                    _ => self.decide_column(column, (self.place(x as u32, bottom), (top - bottom) as usize), busy / 2),
                }
            }
        }
        self.missing.iter().map(|&p| self.pixel(p)).collect()
    }

    /// Decides a column's pixels from a place on upwards. Returns how many are traced.
    fn decide_column(&mut self, column: usize, (at, length): (usize, usize), hint: i32) -> i32 {
        let before = self.missing.len();
        let busy = self.fill(at, self.width, length, hint);
        self.settled[column] = (self.missing.len() == before).then_some(Settled { hint, busy });
        busy
    }

    /// Decides the pixels inside a span from `at` over `length` steps, of which about `hint` are traced in any case.
    /// Returns how many are traced.
    fn fill(&mut self, at: usize, step: usize, length: usize, hint: i32) -> i32 {
        if length <= 1 {
            return 0;
        }
        let half = length / 2;
        let middle = at + half * step;
        let ends = self.decided[at].zip(self.decided[at + length * step]);
        let mut count = 0;
        if hint > 0 || ends.is_some_and(|(a, b)| self.rule.differ(&a, &b)) {
            count = 1;
            self.decided[middle] = self.traced[middle];
            if self.traced[middle].is_none() {
                self.missing.push(middle);
            }
        } else {
            self.decided[middle] = ends.map(|(a, b)| Pixel::between(&a, &b, half as f64 / length as f64));
            if ends.is_none() {
                // Nothing is known of the halves either.
                for i in 1..length {
                    self.decided[at + i * step] = None;
                }
                return 0;
            }
        }
        count + self.fill(at, step, half, (hint - 1) / 2) + self.fill(middle, step, length - half, hint / 2)
    }

    /// The rows from the top down, without the bottom one unless it is the picture's last.
    pub(crate) fn rows(&self, with_bottom: bool) -> impl Iterator<Item = Vec<Pixel>> {
        let skip = usize::from(!with_bottom);
        let rows = self.decided.len() / self.width;
        (skip..rows).rev().map(|row| self.row(row))
    }

    /// The line at the bottom.
    pub(crate) fn bottom(&self) -> Vec<Pixel> {
        self.row(0)
    }

    fn row(&self, row: usize) -> Vec<Pixel> {
        let start = row * self.width;
        self.decided[start..start + self.width].iter().map(|p| p.unwrap_or_default()).collect()
    }
}

impl Rule {
    /// True if two pixels are too different to interpolate between them.
    fn differ(self, a: &Pixel, b: &Pixel) -> bool {
        let t = self.threshold;
        let (za, zb) = (f64::from(a.distance), f64::from(b.distance));
        if self.distances && 2.0 * (za - zb).abs() > t * (za + zb) {
            return true;
        }
        let (a, b) = (a.colour.as_dvec3(), b.colour.as_dvec3());
        (a - b).cmpgt(b * t).any() || (b - a).cmpgt(a * t).any()
    }
}
