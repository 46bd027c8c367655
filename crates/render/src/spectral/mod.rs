//! Calculations by wavelength (`-cs`, `-cw`): how radiation is divided into bins, and how bins are computed.
//!
//! Everything that a scene says in red, green and blue holds throughout the bins of that channel, and shading treats
//! channels alike. So a calculation of three channels *is* one of three bins, if one of them is red, one green, one blue:
//! only spectral patterns differ. A spectrum of many bins takes several passes over the same rays with the same random
//! numbers, each of which computes the next bin of each channel; a scene without spectral patterns needs one, whose
//! channels all bins of theirs share. The calculation in red, green and blue knows nothing of all this.

mod cie;
mod efficiency;
mod spectra;

pub(crate) use cie::{desaturate, rgb_of_xyz};
pub use efficiency::Efficiency;
pub(crate) use efficiency::tristimulus;
pub use spectra::{Bins, Spectra};

use ambit_ambient::Components;
use glam::DVec3;
use std::ops::Range;

/// The least range, nm.
const LEAST_RANGE: f64 = 50.0;
/// Wavelengths from here on are red (nm), those below the second blue.
const SPLITS: [f64; 2] = [588.0, 480.0];
/// Where channels are seen best, nm. A range that leaves out the first or the last is divided into thirds instead.
const PEAKS: [f64; 3] = [607.0, 553.0, 469.0];

/// How radiation is divided by wavelength: bins of equal width, from long to short.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spectrum {
    bins: usize,
    longest: f64,
    shortest: f64,
    /// Where red ends, and green.
    splits: [f64; 2],
    peaks: [f64; 3],
}

impl Default for Spectrum {
    /// Red, green and blue.
    fn default() -> Self {
        Self { bins: 3, longest: 780.0, shortest: 380.0, splits: SPLITS, peaks: PEAKS }
    }
}

impl Spectrum {
    /// Most bins.
    pub const MOST: usize = 24;

    /// So many bins between two wavelengths (nm, in either order); three are red, green and blue, more than 24 are 24.
    /// None if there are fewer than three or the range is below 50 nm.
    pub fn new(bins: i32, from: f64, to: f64) -> Option<Self> {
        // Single precision decides to which channel a bin belongs whose centre lies on a border, as in Radiance.
        let (shortest, longest) = (f64::from(from.min(to) as f32), f64::from(from.max(to) as f32));
        let range = longest - shortest;
        if bins < 3 || !range.is_finite() || range < LEAST_RANGE {
            return None;
        }
        let mut spectrum = Self { bins: (bins as usize).min(Self::MOST), longest, shortest, ..Self::default() };
        if !spectrum.shows_colour() {
            let at = |share: f64| longest - range * share;
            spectrum.splits = [at(1.0 / 3.0), at(2.0 / 3.0)];
            spectrum.peaks = [at(1.0 / 6.0), at(0.5), at(5.0 / 6.0)];
        }
        Some(spectrum)
    }

    /// Number of bins.
    pub fn bins(&self) -> usize {
        self.bins
    }

    /// True for red, green and blue.
    pub fn is_rgb(&self) -> bool {
        self.bins == 3
    }

    /// True if the range covers where red, green and blue are seen best. If not, its thirds take their places.
    pub fn shows_colour(&self) -> bool {
        self.shortest < PEAKS[2] && self.longest > PEAKS[0]
    }

    /// Longest wavelength, where red ends, where green ends, shortest wavelength, nm.
    pub fn limits(&self) -> [f64; 4] {
        [self.longest, self.splits[0], self.splits[1], self.shortest]
    }

    /// CIE 1931 tristimulus values of unit radiance in each bin; those of all visible bins together are 1, 1, 1.
    pub fn tristimulus(&self) -> Vec<DVec3> {
        (0..self.bins).map(|i| tristimulus(&self.band(i))).collect()
    }

    /// What a function weighs unit radiance in each bin; all bins that it covers together weigh 1.
    pub fn efficiency(&self, function: Efficiency) -> Vec<f64> {
        (0..self.bins).map(|i| function.share(&self.band(i))).collect()
    }

    /// Linear red, green and blue of tristimulus values; a colour out of gamut turns greyer until no channel is negative.
    pub fn rgb(xyz: DVec3) -> DVec3 {
        desaturate(rgb_of_xyz(xyz))
    }

    /// Limits of a bin, nm.
    pub fn band(&self, bin: usize) -> Range<f64> {
        let border = |i: usize| self.longest - i as f64 * self.width();
        border(bin + 1)..border(bin)
    }

    /// Width of a bin, nm.
    pub(crate) fn width(&self) -> f64 {
        (self.longest - self.shortest) / self.bins as f64
    }

    /// The bins of a channel in the order of passes. What is seen best comes first, so that the first pass decides as a
    /// calculation of all bins does, which looks there.
    pub(crate) fn channel(&self, channel: usize) -> Vec<usize> {
        let of = |bin: &usize| {
            let centre = self.band(*bin).start + 0.5 * self.width();
            channel == usize::from(centre < self.splits[0]) + usize::from(centre < self.splits[1])
        };
        let mut bins: Vec<usize> = (0..self.bins).filter(of).collect();
        let off = |bin: &usize| (self.band(*bin).start + 0.5 * self.width() - self.peaks[channel]).abs();
        bins.sort_by(|a, b| off(a).total_cmp(&off(b)));
        bins
    }

    /// How many passes compute all bins.
    pub(crate) fn passes(&self) -> usize {
        if self.is_rgb() { 1 } else { (0..3).map(|c| self.channel(c).len()).max().unwrap_or(1) }
    }

    /// The bins of the three channels in each pass. Channels that have run out of bins repeat their last one, those
    /// that have none at all take any.
    fn turns(&self, passes: usize) -> Vec<[usize; 3]> {
        let channels = [0, 1, 2].map(|c| self.channel(c));
        let bin = |bins: &Vec<usize>, pass: usize| bins.get(pass).or(bins.last()).copied().unwrap_or(0);
        (0..passes).map(|pass| [0, 1, 2].map(|c| bin(&channels[c], pass))).collect()
    }

    /// The bands of the three channels in each pass.
    pub(crate) fn schedule(&self) -> Vec<[Range<f64>; 3]> {
        self.turns(self.passes()).into_iter().map(|turn| turn.map(|bin| self.band(bin))).collect()
    }

    /// Pass and channel of each bin; a single pass serves all.
    fn places(&self, passes: usize) -> Vec<(usize, usize)> {
        let mut places = vec![(0, 0); self.bins];
        for channel in 0..3 {
            for (pass, bin) in self.channel(channel).into_iter().enumerate() {
                places[bin] = (pass.min(passes - 1), channel);
            }
        }
        places
    }

    /// Where bins stand in records of so many passes.
    pub(crate) fn components(&self, passes: usize) -> Components {
        if self.is_rgb() {
            return Components::default();
        }
        let places = self.places(passes).into_iter().map(|(pass, channel)| (pass as u8, channel as u8)).collect();
        let turns = self.turns(passes).into_iter().map(|turn| turn.map(|bin| bin as u8)).collect();
        Components::new(places, turns).expect("there are three to 24 bins, and each has its place")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channels(bins: i32, from: f64, to: f64) -> Vec<usize> {
        let spectrum = Spectrum::new(bins, from, to).unwrap();
        let mut channels = vec![9; spectrum.bins()];
        for c in 0..3 {
            spectrum.channel(c).into_iter().for_each(|bin| channels[bin] = c);
        }
        channels
    }

    #[test]
    fn bins_belong_to_channels_as_measured() {
        assert_eq!(channels(9, 380.0, 780.0), [0, 0, 0, 0, 1, 1, 1, 2, 2]);
        // The centre of one lies at 480 nm, but for rounding.
        assert_eq!(channels(6, 380.0, 780.0), [0, 0, 0, 1, 2, 2]);
        assert_eq!(channels(10, 380.0, 780.0), [0, 0, 0, 0, 0, 1, 1, 1, 2, 2]);
        assert_eq!(channels(6, 450.0, 620.0), [0, 1, 1, 1, 1, 2]);
        assert_eq!(channels(6, 300.0, 1200.0), [0, 0, 0, 0, 1, 2]);
        assert_eq!(channels(4, 100.0, 700.0), [0, 2, 2, 2]);
        assert_eq!(channels(4, 400.0, 1e4), [0; 4]);
        // Without a peak: thirds.
        assert_eq!(channels(6, 700.0, 600.0), [0, 0, 1, 1, 2, 2]);
        assert_eq!(channels(4, 500.0, 1e9), [0, 1, 1, 2]);
        assert_eq!(channels(6, 469.0, 607.0), [0, 0, 1, 1, 2, 2]);
        assert_eq!(channels(6, 468.0, 608.0), [0, 1, 1, 1, 1, 2]);
    }

    #[test]
    fn the_first_pass_looks_where_eyes_do() {
        for bins in 4..=24 {
            let spectrum = Spectrum::new(bins, 380.0, 780.0).unwrap();
            let schedule = spectrum.schedule();
            for (band, peak) in schedule[0].iter().zip(PEAKS) {
                let off = band.start.max(peak) - band.end.min(peak);
                assert!(off <= 0.5 * spectrum.width(), "{bins}: {band:?}");
            }
            assert_eq!(schedule.len(), spectrum.passes());
        }
    }

    #[test]
    fn impossible_spectra_are_none() {
        assert!(Spectrum::new(2, 380.0, 780.0).is_none());
        assert!(Spectrum::new(9, 500.0, 549.9).is_none());
        assert!(Spectrum::new(9, 500.0, f64::NAN).is_none());
        assert_eq!(Spectrum::new(40, 550.0, 500.0).unwrap().bins(), 24);
        assert_eq!(Spectrum::new(3, 380.0, 780.0), Some(Spectrum::default()));
    }
}
