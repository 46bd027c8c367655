//! Data files: tables of up to six dimensions, interpolated between their points (scene.md 15.1).
//!
//! Interpolation is multilinear. With x the fractional index along an axis and i the cell it falls in, held to the
//! table, an axis gives its two ends the weights (i + 1 − x, x − i) for i − 1 ≤ x ≤ i + 2, so one division beyond either
//! end is extrapolated; farther out the result decays as 1/distance, with the jump at x = i + 2 that Radiance has.

use crate::grammar;
use crate::tokens::Tokens;
use crate::{AuxiliaryProblem, Error, ErrorKind};
use ambit_base::EPSILON;

/// Most dimensions a table can have.
pub const MAX_DIMENSIONS: usize = 6;

/// One dimension of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Coordinate of the first point.
    pub begin: f32,
    /// Coordinate of the last point; may be smaller than `begin`.
    pub end: f32,
    /// Number of points.
    pub count: usize,
    /// The points' coordinates if they are not evenly spaced, strictly monotonic.
    pub points: Option<Box<[f32]>>,
}

/// A table of numbers over one to six coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct DataTable {
    axes: Vec<Axis>,
    /// The last dimension varies fastest.
    values: Vec<f32>,
}

impl Axis {
    /// Evenly spaced points.
    pub fn even(begin: f32, end: f32, count: usize) -> Self {
        Self { begin, end, count, points: None }
    }

    /// The cell that coordinate `p` falls in and the weights of its two ends. An axis of one point has weights (1, 0);
    /// infinitely far out both are zero.
    pub fn cell(&self, p: f64) -> (usize, f64, f64) {
        if self.count < 2 {
            return (0, 1.0, 0.0);
        }
        let last = self.count - 2;
        let (i, x) = match &self.points {
            None => {
                let span = f64::from(self.end) - f64::from(self.begin);
                let x = (p - f64::from(self.begin)) / span * (self.count - 1) as f64;
                // A cast of a negative number gives 0, of a large one the largest integer.
                ((x as usize).min(last), x)
            }
            Some(points) => {
                let rising = self.end > self.begin;
                let passed = points.partition_point(|&q| if rising { f64::from(q) <= p } else { f64::from(q) >= p });
                let i = passed.saturating_sub(1).min(last);
                let (a, b) = (f64::from(points[i]), f64::from(points[i + 1]));
                (i, i as f64 + (p - a) / (b - a))
            }
        };
        if !x.is_finite() {
            return (i, 0.0, 0.0);
        }
        let beyond = x - i as f64;
        let (c0, c1) = if beyond > 2.0 {
            let c = 1.0 / (-1.0 - beyond);
            (c, -2.0 * c)
        } else if beyond < -1.0 {
            (-2.0 / beyond, 1.0 / beyond)
        } else {
            (1.0 - beyond, beyond)
        };
        (i, c0, c1)
    }
}

impl DataTable {
    /// A table from its parts; `None` if there are more than six axes or none, an axis is empty or not monotonic, the
    /// number of values is not the product of the counts, or a value is not finite.
    pub fn new(axes: Vec<Axis>, values: Vec<f32>) -> Option<Self> {
        let size = axes.iter().try_fold(1usize, |n, axis| n.checked_mul(axis.count))?;
        let shaped = (1..=MAX_DIMENSIONS).contains(&axes.len()) && size > 0 && size == values.len();
        (shaped && axes.iter().all(is_usable) && values.iter().all(|v| v.is_finite())).then_some(Self { axes, values })
    }

    /// Parses a data file. `name` is what the scene calls it, `path` where it was found; messages quote either.
    pub fn parse(name: &str, path: &str, bytes: &[u8]) -> Result<Self, Error> {
        let mut tokens = Tokens::new(bytes);
        let auxiliary = |problem, location| Err(Error::new(ErrorKind::Auxiliary(problem), location));
        match Self::read(&mut tokens) {
            Ok(table) => Ok(table),
            Err(Fault::Dimensions) => auxiliary(AuxiliaryProblem::Dimensions(name.to_owned()), tokens.location(path)),
            // A malformed last word may be one that was cut short.
            Err(Fault::Format) if !tokens.at_end() => {
                auxiliary(AuxiliaryProblem::DataFormat(path.to_owned()), tokens.location(path))
            }
            Err(Fault::Order | Fault::Range) => {
                auxiliary(AuxiliaryProblem::DataFormat(path.to_owned()), tokens.location(path))
            }
            Err(Fault::Format | Fault::Ends) => {
                auxiliary(AuxiliaryProblem::DataEnds(path.to_owned()), tokens.location(path))
            }
        }
    }

    fn read(tokens: &mut Tokens<'_>) -> Result<Self, Fault> {
        let dimensions = integer(tokens)?;
        if !(1..=MAX_DIMENSIONS as i32).contains(&dimensions) {
            return Err(Fault::Dimensions);
        }
        let mut axes = Vec::new();
        for _ in 0..dimensions {
            axes.push(axis(tokens)?);
        }
        let size = axes.iter().try_fold(1usize, |n, a: &Axis| n.checked_mul(a.count)).ok_or(Fault::Range)?;
        // No room is reserved: the file may promise more than it has.
        let mut values = Vec::new();
        for _ in 0..size {
            values.push(number(tokens)?);
        }
        Ok(Self { axes, values })
    }

    /// The dimensions, in order.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// All values, the last dimension fastest.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The value at a point, one coordinate for each dimension (missing ones count as zero, surplus ones are ignored).
    /// Always finite for finite coordinates.
    pub fn interpolate(&self, point: &[f64]) -> f64 {
        let mut cells = [(0, 0.0, 0.0); MAX_DIMENSIONS];
        for (d, (cell, axis)) in cells.iter_mut().zip(&self.axes).enumerate() {
            *cell = axis.cell(point.get(d).copied().unwrap_or(0.0));
        }
        self.blend(0, 0, &cells)
    }

    /// The value within the block of dimensions from `dimension` on that begins at `base`.
    fn blend(&self, dimension: usize, base: usize, cells: &[(usize, f64, f64); MAX_DIMENSIONS]) -> f64 {
        if dimension == self.axes.len() {
            return f64::from(self.values[base]);
        }
        let (i, c0, c1) = cells[dimension];
        let at = |i: usize| self.blend(dimension + 1, (base + i) * self.stride(dimension), cells);
        // Weights that vanish spare a whole block of points, as in Radiance.
        let low = if c0.abs() > EPSILON { c0 * at(i) } else { 0.0 };
        let high = if c1.abs() > EPSILON { c1 * at(i + 1) } else { 0.0 };
        low + high
    }

    /// Number of points along the next dimension.
    fn stride(&self, dimension: usize) -> usize {
        self.axes.get(dimension + 1).map_or(1, |a| a.count)
    }
}

enum Fault {
    Dimensions,
    Format,
    Order,
    Range,
    Ends,
}

fn integer(tokens: &mut Tokens<'_>) -> Result<i32, Fault> {
    grammar::integer(tokens.next().ok_or(Fault::Ends)?).ok_or(Fault::Format)
}

/// A number in single precision, in which tables are kept.
fn number(tokens: &mut Tokens<'_>) -> Result<f32, Fault> {
    let value = grammar::real(tokens.next().ok_or(Fault::Ends)?).ok_or(Fault::Format)? as f32;
    // Radiance would go on with infinity.
    if value.is_finite() { Ok(value) } else { Err(Fault::Range) }
}

/// `begin end count`, and the coordinates themselves if the ends are equal.
fn axis(tokens: &mut Tokens<'_>) -> Result<Axis, Fault> {
    let (begin, end, count) = (number(tokens)?, number(tokens)?, integer(tokens)?);
    if count < 2 {
        return Err(Fault::Order);
    }
    let count = count as usize;
    if begin != end {
        return Ok(Axis::even(begin, end, count));
    }
    let mut points: Vec<f32> = Vec::new();
    for i in 0..count {
        points.push(number(tokens)?);
        let turns = i >= 2 && (points[i] > points[i - 1]) != (points[1] > points[0]);
        if i >= 1 && (turns || points[i] == points[i - 1]) {
            return Err(Fault::Order);
        }
    }
    Ok(Axis { begin: points[0], end: points[count - 1], count, points: Some(points.into()) })
}

fn is_usable(axis: &Axis) -> bool {
    let strictly = |points: &[f32]| {
        let rising = axis.end > axis.begin;
        points.len() == axis.count
            && points.first() == Some(&axis.begin)
            && points.last() == Some(&axis.end)
            && points.windows(2).all(|w| w[0] != w[1] && (w[1] > w[0]) == rising)
    };
    axis.begin.is_finite()
        && axis.end.is_finite()
        && axis.count > 0
        && (axis.count == 1 || axis.begin != axis.end)
        && axis.points.as_deref().is_none_or(strictly)
}

#[cfg(test)]
mod tests;
