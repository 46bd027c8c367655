//! Values of another wavelength sampling (`-cs`, `-cw`): of an ambient file that a run of other bins reads and continues.
//!
//! As in Radiance: a value is taken as constant within each bin, and the value of another bin is its mean there, dark beyond
//! the limits of what is known. Three bins count as thirds of their range, wherever red and blue end. But a spectrum read
//! as red, green and blue becomes the colour of what the CIE 1931 observer sees, and three bins read as three stay as they
//! are, whatever their range.

use crate::components::Components;
use ambit_base::{DVec3, TO_XYZ, desaturated};
use ambit_file::{Header, general};
use std::fmt;
use std::ops::Range;

/// CIE 1931 tristimulus values of unit radiance in a band (nm).
pub type Observer = fn(&Range<f64>) -> DVec3;

/// Significant digits of wavelengths.
pub(crate) const DIGITS: usize = 6;
/// The wavelengths of a file that does not tell.
pub(crate) const SPLITS: [f64; 4] = [780.0, 588.0, 480.0, 380.0];

/// Bins of equal width, from long to short wavelengths.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sampling {
    count: usize,
    longest: f64,
    shortest: f64,
}

/// As options: what programs would be given for such bins.
impl fmt::Display for Sampling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [from, to] = self.limits();
        write!(f, "-cs {} -cw {from} {to}", self.count)
    }
}

impl Sampling {
    /// So many bins between limits, which stand first and last in either order (nm). None if they are none.
    pub(crate) fn new(count: usize, splits: [f64; 4]) -> Option<Self> {
        let (longest, shortest) = (splits[0].max(splits[3]), splits[0].min(splits[3]));
        let sound = shortest >= 0.0 && longest.is_finite() && longest > shortest;
        sound.then_some(Self { count, longest, shortest })
    }

    /// What a header tells.
    pub(crate) fn of(header: &Header) -> Option<Self> {
        Self::new(header.components() as usize, header.wavelength_splits().unwrap_or(SPLITS))
    }

    /// Limits as headers have them.
    fn limits(&self) -> [String; 2] {
        [self.shortest, self.longest].map(|nm| general(nm, DIGITS))
    }

    /// Limits of all bins, nm.
    fn bands(&self) -> Vec<Range<f64>> {
        let border = |k: usize| self.longest - (self.longest - self.shortest) * k as f64 / self.count as f64;
        (0..self.count).map(|k| border(k + 1)..border(k)).collect()
    }

    /// True if headers would tell the same.
    pub(crate) fn is_as(&self, other: &Self) -> bool {
        self.count == other.count && self.limits() == other.limits()
    }
}

/// Shares of bins in other bins: for each of these, one for each of those.
type Shares = Vec<Vec<f64>>;

/// From the bins of a file to those of a run and back.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Conversion {
    /// Bins of the file.
    count: usize,
    reading: Reading,
    writing: Shares,
}

/// How a file's values are read.
#[derive(Clone, Debug, PartialEq)]
enum Reading {
    /// As they are.
    Same,
    /// As the colour that the observer sees: of each bin, unit radiance.
    Colour(Vec<DVec3>),
    /// As means within each bin of the run.
    Means(Shares),
}

impl Conversion {
    /// Between a file's and a run's sampling.
    pub(crate) fn new(file: &Sampling, run: &Sampling, observer: Observer) -> Self {
        let reading = match (file.count, run.count) {
            (3, 3) => Reading::Same,
            (_, 3) => Reading::Colour(file.bands().iter().map(observer).collect()),
            _ => Reading::Means(shares(file, run)),
        };
        Self { count: file.count, reading, writing: shares(run, file) }
    }

    /// Bins of the file.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// The run's bins of the file's.
    pub(crate) fn read(&self, values: &[f32]) -> [f32; Components::MOST] {
        match &self.reading {
            Reading::Same => filled(values.iter().copied()),
            Reading::Colour(xyz) => {
                let sum: DVec3 = xyz.iter().zip(values).map(|(&c, &v)| c * f64::from(v)).sum();
                filled(desaturated(TO_XYZ.inverse() * sum, sum.y).max(DVec3::ZERO).as_vec3().to_array())
            }
            Reading::Means(shares) => means(shares, values),
        }
    }

    /// The file's bins of the run's.
    pub(crate) fn write(&self, values: &[f32]) -> [f32; Components::MOST] {
        means(&self.writing, values)
    }
}

/// What part of each bin of `to` each bin of `from` covers.
fn shares(from: &Sampling, to: &Sampling) -> Shares {
    let covered = |a: &Range<f64>, b: &Range<f64>| (a.end.min(b.end) - a.start.max(b.start)).max(0.0);
    let row = |to: &Range<f64>| from.bands().iter().map(|from| covered(from, to) / (to.end - to.start)).collect();
    to.bands().iter().map(row).collect()
}

fn means(shares: &Shares, values: &[f32]) -> [f32; Components::MOST] {
    filled(shares.iter().map(|row| row.iter().zip(values).map(|(s, &v)| s * f64::from(v)).sum::<f64>() as f32))
}

/// Values, and darkness behind them.
fn filled(values: impl IntoIterator<Item = f32>) -> [f32; Components::MOST] {
    let mut all = [0.0; Components::MOST];
    all.iter_mut().zip(values).for_each(|(a, v)| *a = v);
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampling(count: usize, shortest: f64, longest: f64) -> Sampling {
        Sampling::new(count, [longest, 588.0, 480.0, shortest]).unwrap()
    }

    fn grey(band: &Range<f64>) -> DVec3 {
        DVec3::splat((band.end - band.start) / 400.0)
    }

    /// An observer of one colour: red above 600 nm, green above 500 nm, blue below, each in its own proportion.
    fn keen(band: &Range<f64>) -> DVec3 {
        let within = |low: f64, high: f64| (band.end.min(high) - band.start.max(low)).max(0.0) / 100.0;
        DVec3::new(within(600.0, 1e9), 2.0 * within(500.0, 600.0), 3.0 * within(0.0, 500.0))
    }

    /// What is read or written is this, as far as bins go, and dark beyond.
    fn near(values: &[f32], wanted: &[f32], error: f32) {
        let (bins, rest) = values.split_at(wanted.len());
        assert!(bins.iter().zip(wanted).all(|(a, b)| (a - b).abs() <= error * b), "{values:?} {wanted:?}");
        assert!(rest.iter().all(|&v| v == 0.0), "{values:?}");
    }

    /// What rtrace 6.0a answers from a file of one record, and what it appends.
    #[test]
    fn bins_are_converted_as_measured() {
        let three = [2.098_486, 3.153_865, 4.184_7];
        for (run, wanted) in [
            (sampling(6, 380.0, 780.0), &[2.0985, 2.0985, 3.1539, 3.1539, 4.1847, 4.1847][..]),
            (
                sampling(9, 380.0, 1000.0),
                &[0.0, 0.0, 0.0, 1.692_327, 2.098_486, 3.017_687, 3.153_865, 4.118_195, 4.1847],
            ),
            (
                sampling(9, 500.0, 780.0),
                &[2.0985, 2.0985, 2.0985, 2.0985, 2.852_328, 3.1539, 3.1539, 3.1539, 3.595_651],
            ),
        ] {
            assert_eq!(run.count, wanted.len());
            near(&Conversion::new(&sampling(3, 380.0, 780.0), &run, grey).read(&three), wanted, 2e-5);
        }
        let twenty = [
            0.5996, 0.5332, 0.5020, 0.5020, 0.5020, 0.4785, 0.4004, 0.4004, 0.4004, 0.4004, 0.3223, 0.2988, 0.2988,
            0.2988, 0.2676, 0.2012, 0.2012, 0.2012, 0.2012, 0.1113,
        ];
        let narrow = Conversion::new(&sampling(20, 400.0, 700.0), &sampling(6, 380.0, 780.0), grey);
        let read = narrow.read(&twenty).map(|v| v * std::f32::consts::PI);
        near(&read, &[0.0, 1.352_664, 1.416_785, 1.098_944, 0.786_319, 0.378_893], 2e-3);
        // What is appended, by a run in red, green and blue of another range, too.
        let other = Conversion::new(&sampling(3, 380.0, 780.0), &sampling(3, 400.0, 700.0), grey);
        let written = other.write(&[0.4730, 0.3449, 0.1815]);
        assert_eq!(written.map(|v| (v * 512.0) as i32)[..3], [96, 199, 87]);
        assert!(written[3..].iter().all(|&v| v == 0.0) && other.count() == 3);
        near(&other.read(&three), &three, 0.0);
    }

    #[test]
    fn a_spectrum_read_as_red_green_and_blue_is_the_colour_that_the_observer_sees() {
        let conversion = Conversion::new(&sampling(4, 380.0, 780.0), &sampling(3, 380.0, 780.0), grey);
        near(&conversion.read(&[1.0; 4]), &(TO_XYZ.inverse() * DVec3::ONE).as_vec3().to_array(), 1e-6);
        // Bins go from long to short wavelengths: 680 to 780 nm first.
        let conversion = Conversion::new(&sampling(4, 380.0, 780.0), &sampling(3, 400.0, 700.0), keen);
        let xyz = [
            DVec3::new(1.0, 0.0, 0.0),
            DVec3::new(0.8, 0.4, 0.0),
            DVec3::new(0.0, 1.6, 0.6),
            DVec3::new(0.0, 0.0, 3.0),
        ];
        let seen = |values: [f32; 4]| xyz.iter().zip(values).map(|(&c, v)| c * f64::from(v)).sum::<DVec3>();
        // A colour that red, green and blue can make comes out as it is.
        let values = [1.0, 0.9, 1.1, 0.5];
        let sum = seen(values);
        let colour = TO_XYZ.inverse() * sum;
        assert!(colour.min_element() > 0.0, "{colour}");
        near(&conversion.read(&values), &colour.as_vec3().to_array(), 1e-6);
        // What they cannot make loses saturation until no channel is negative, and keeps its brightness.
        for k in 0..4 {
            let mut values = [0.0; 4];
            values[k] = 2.0;
            let (sum, read) = (seen(values), conversion.read(&values));
            let read = DVec3::from_array([0, 1, 2].map(|c| f64::from(read[c])));
            assert!(read.min_element() >= 0.0, "{read}");
            assert!(((TO_XYZ * read).y - sum.y).abs() <= 1e-6 * sum.y, "{k}: {} {}", (TO_XYZ * read).y, sum.y);
            assert_eq!(read.min_element(), 0.0, "{read} is as saturated as can be");
        }
        // What is written takes no observer.
        near(&conversion.write(&[3.0, 2.0, 1.0]), &[0.6, 2.8, 1.8, 0.8], 1e-6);
    }

    /// What is converted keeps its sum over wavelengths, what lies beyond the other's limits is dark.
    #[test]
    fn means_keep_the_light_within_common_limits() {
        let light = |s: &Sampling, v: &[f32]| -> f64 {
            s.bands().iter().zip(v).map(|(band, &v)| (band.end - band.start) * f64::from(v)).sum()
        };
        let values = [0.5, 3.0, 1.0, 0.0, 2.0, 4.0, 0.25];
        let file = sampling(7, 400.0, 700.0);
        for run in [sampling(5, 380.0, 780.0), sampling(24, 400.0, 700.0), sampling(7, 400.0, 700.0)] {
            let there = Conversion::new(&file, &run, grey);
            let read = there.read(&values);
            assert!((light(&run, &read) - light(&file, &values)).abs() < 1e-3, "{run}");
            assert!(read[run.count..].iter().all(|&v| v == 0.0));
            // The way back is that of the opposite conversion.
            assert_eq!(there.write(&read), Conversion::new(&run, &file, grey).read(&read));
        }
        // Of one bin from 500 to 600 nm, a third of the range, all is kept; the rest stays dark.
        let narrow = Conversion::new(&sampling(3, 500.0, 600.0), &file, grey).read(&[6.0; 3]);
        assert!((light(&file, &narrow) - 600.0).abs() < 1e-3 && narrow[0] == 0.0 && narrow[6] == 0.0);
    }

    #[test]
    fn samplings_are_the_same_if_headers_say_so() {
        let one = sampling(9, 380.0, 780.0);
        assert!(one.is_as(&Sampling::new(9, [380.0, 0.0, 0.0, 780.000_01]).unwrap()));
        assert!(!one.is_as(&sampling(9, 380.0, 780.5)) && !one.is_as(&sampling(8, 380.0, 780.0)));
        assert_eq!(one.to_string(), "-cs 9 -cw 380 780");
        for bad in [[500.0, 0.0, 0.0, 500.0], [f64::NAN, 0.0, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0, 1.0]] {
            assert!(Sampling::new(9, bad).is_none());
        }
    }
}
