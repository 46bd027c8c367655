//! Angle bases of matrices: the hemisphere cut into bands of latitude, and each band into equal patches, the first one
//! centred on azimuth 0 (Klems 1994, *A New Method for Predicting the Solar Heat Gain of Complex Fenestration Systems*).

use ambit_base::DVec3;
use std::f64::consts::PI;

/// Most bands of a basis.
pub(super) const MOST_BANDS: usize = 46;
/// Most bases of a file, the built-in ones included.
pub(super) const MOST_BASES: usize = 7;

/// Bases that every file knows: name, lower bound of the first band, then upper bound in degrees and number of patches.
const BUILT_IN: [(&str, &[(f64, u32)]); 3] = [
    (
        "LBNL/Klems Full",
        &[(5.0, 1), (15.0, 8), (25.0, 16), (35.0, 20), (45.0, 24), (55.0, 24), (65.0, 24), (75.0, 16), (90.0, 12)],
    ),
    ("LBNL/Klems Half", &[(6.5, 1), (19.5, 8), (32.5, 12), (45.5, 16), (58.5, 20), (71.5, 12), (90.0, 8)]),
    ("LBNL/Klems Quarter", &[(9.0, 1), (27.0, 8), (45.0, 12), (63.0, 12), (90.0, 8)]),
];

/// One band of latitude.
#[derive(Clone, Debug, PartialEq)]
struct Band {
    /// Upper bound of the polar angle, degrees; it belongs to the next band.
    upper: f64,
    /// Patches.
    count: u32,
    /// Index of the first patch.
    first: u32,
    /// Squared cosines of the lower and the upper bound.
    cos2: [f64; 2],
    /// Projected solid angle of one patch.
    area: f64,
}

/// A partition of the hemisphere.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Basis {
    pub(super) name: String,
    bands: Vec<Band>,
}

/// Why bands make no basis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BadBand {
    /// No patch, or a whole band as one patch that is not the pole.
    Count,
    /// Bounds that do not rise, or do not meet.
    Theta,
}

impl Basis {
    /// The bases that need no definition.
    pub(super) fn built_in() -> Vec<Self> {
        BUILT_IN.iter().map(|(name, bands)| Self::rising(name, bands)).collect()
    }

    fn rising(name: &str, list: &[(f64, u32)]) -> Self {
        let mut basis = Self { name: name.to_owned(), bands: Vec::new() };
        let mut lower = 0.0;
        for &(upper, count) in list {
            basis.add(lower, upper, count).expect("the built-in bands meet");
            lower = upper;
        }
        basis
    }

    /// An empty basis, to be filled from the pole outwards.
    pub(super) fn named(name: &str) -> Self {
        Self { name: name.to_owned(), bands: Vec::new() }
    }

    /// Adds the next band; bounds in degrees.
    pub(super) fn add(&mut self, lower: f64, upper: f64, count: u32) -> Result<(), BadBand> {
        if count < 1 || (count == 1 && !self.bands.is_empty()) {
            return Err(BadBand::Count);
        }
        let meets = self.bands.last().is_none_or(|b| b.upper == lower);
        if !(meets && 0.0 <= lower && lower < upper && upper <= 90.0) {
            return Err(BadBand::Theta);
        }
        let first = self.patches() as u32;
        let end = first.checked_add(count).ok_or(BadBand::Count)?;
        if end > i32::MAX as u32 {
            return Err(BadBand::Count);
        }
        let cos2 = [lower, upper].map(|t| t.to_radians().cos().powi(2));
        let area = PI * (cos2[0] - cos2[1]) / f64::from(count);
        self.bands.push(Band { upper, count, first, cos2, area });
        Ok(())
    }

    /// How many bands there are.
    pub(super) fn len(&self) -> usize {
        self.bands.len()
    }

    /// How many patches there are.
    pub(super) fn patches(&self) -> usize {
        self.bands.last().map_or(0, |b| (b.first + b.count) as usize)
    }

    /// The patch that looks towards (x, y, |z|); None beyond the last band.
    pub(super) fn patch(&self, x: f64, y: f64, z: f64) -> Option<usize> {
        let theta = z.abs().min(1.0).acos().to_degrees();
        let band = self.bands.iter().find(|b| theta < b.upper)?;
        if band.count == 1 {
            return Some(band.first as usize);
        }
        let turns = y.atan2(x) / (2.0 * PI);
        let turns = if turns < 0.0 { turns + 1.0 } else { turns };
        let j = (turns * f64::from(band.count) + 0.5) as u32;
        Some((band.first + if j >= band.count { 0 } else { j }) as usize)
    }

    /// Projected solid angle of a patch.
    pub(super) fn area(&self, patch: usize) -> f64 {
        self.band(patch).map_or(0.0, |b| b.area)
    }

    /// The smallest projected solid angle of any patch.
    pub(super) fn least_area(&self) -> f64 {
        self.bands.iter().map(|b| b.area).fold(f64::INFINITY, f64::min)
    }

    fn band(&self, patch: usize) -> Option<&Band> {
        self.bands.iter().find(|b| patch < (b.first + b.count) as usize)
    }

    /// Chooses a direction with z ≥ 0 by two numbers in [0, 1). `cumulative` holds for each patch the sum of the shares
    /// up to and including it; within a patch the density per projected solid angle is even.
    pub(super) fn sample(&self, cumulative: &[f32], [x, y]: [f64; 2]) -> Option<DVec3> {
        let upto = |patch: u32| if patch == 0 { 0.0 } else { f64::from(cumulative[patch as usize - 1]) };
        let all = upto(self.patches() as u32);
        if all <= 0.0 {
            return None;
        }
        // The second number chooses the band and the height in it, the first one the patch and the azimuth in it.
        let sought = y * all;
        let mut chosen = None;
        for band in &self.bands {
            let (low, high) = (upto(band.first), upto(band.first + band.count));
            if high > low {
                chosen = Some((band, low, high));
                if sought < high {
                    break;
                }
            }
        }
        let (band, low, high) = chosen?;
        let height = ((sought - low) / (high - low)).clamp(0.0, 1.0);
        let sought = low + x * (high - low);
        let shares = &cumulative[band.first as usize..(band.first + band.count) as usize];
        let mut j = shares.partition_point(|&c| f64::from(c) <= sought) as u32;
        while j > 0 && (j >= band.count || upto(band.first + j + 1) <= upto(band.first + j)) {
            j -= 1;
        }
        let (left, right) = (upto(band.first + j), upto(band.first + j + 1));
        let across = if right > left { ((sought - left) / (right - left)).clamp(0.0, 1.0) } else { 0.5 };
        let cos2 = band.cos2[0] + (band.cos2[1] - band.cos2[0]) * height;
        let azimuth = (f64::from(j) - 0.5 + across) * 2.0 * PI / f64::from(band.count);
        let r = (1.0 - cos2).max(0.0).sqrt();
        let (s, c) = azimuth.sin_cos();
        Some(DVec3::new(r * c, r * s, cos2.max(0.0).sqrt()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn built_in_bases_have_the_published_counts_and_areas() {
        let all = Basis::built_in();
        let patches: Vec<usize> = all.iter().map(Basis::patches).collect();
        assert_eq!(patches, [145, 77, 41]);
        for basis in &all {
            let sum: f64 = (0..basis.patches()).map(|i| basis.area(i)).sum();
            assert!((sum - PI).abs() < 1e-12, "{} covers {sum}", basis.name);
        }
        let full = &all[0];
        for (patch, area) in [(0, 0.023863926), (1, 0.023322860), (144, 0.017537234), (93, 0.019685185)] {
            assert!((full.area(patch) - area).abs() < 1e-8);
        }
        assert_eq!(full.least_area(), full.area(144));
    }

    #[test]
    fn patches_are_centred_on_their_azimuth_and_bounds_belong_outwards() {
        let full = &Basis::built_in()[0];
        let at = |theta: f64, phi: f64| {
            let (st, ct) = theta.to_radians().sin_cos();
            let (sp, cp) = phi.to_radians().sin_cos();
            full.patch(st * cp, st * sp, ct)
        };
        assert_eq!(at(0.0, 0.0), Some(0));
        assert_eq!(at(10.0, 22.0), Some(1));
        assert_eq!(at(10.0, 23.0), Some(2));
        assert_eq!(at(10.0, -22.0), Some(1));
        assert_eq!(at(10.0, -23.0), Some(8));
        assert_eq!(full.patch(0.5f64.sqrt(), 0.0, 0.5f64.sqrt()), Some(69));
        assert_eq!(at(80.0, 350.0), Some(133));
    }

    #[test]
    fn samples_fall_in_their_patches_by_their_shares() {
        let basis = &Basis::built_in()[2];
        let shares: Vec<f32> = (0..basis.patches()).map(|i| if i % 3 == 1 { 0.0 } else { 1.0 + i as f32 }).collect();
        let mut sum = 0.0;
        let cumulative: Vec<f32> = shares
            .iter()
            .map(|s| {
                sum += s;
                sum
            })
            .collect();
        let n = 400;
        let mut seen = vec![0u32; basis.patches()];
        for i in 0..n {
            for j in 0..n {
                let uv = [(f64::from(i) + 0.5) / f64::from(n), (f64::from(j) + 0.5) / f64::from(n)];
                let d = basis.sample(&cumulative, uv).expect("shares are positive");
                seen[basis.patch(d.x, d.y, d.z).expect("inside")] += 1;
            }
        }
        for (patch, (&count, share)) in seen.iter().zip(&shares).enumerate() {
            let got = f64::from(count) / f64::from(n * n);
            assert!((got - f64::from(share / sum)).abs() < 2e-3, "patch {patch}: {got}");
        }
    }

    #[test]
    fn bands_that_do_not_meet_are_refused() {
        let mut basis = Basis::named("own");
        assert_eq!(basis.add(0.0, 10.0, 1), Ok(()));
        assert_eq!(basis.add(10.0, 20.0, 1), Err(BadBand::Count));
        assert_eq!(basis.add(11.0, 20.0, 4), Err(BadBand::Theta));
        assert_eq!(basis.add(10.0, f64::NAN, 4), Err(BadBand::Theta));
        assert_eq!(basis.add(10.0, 90.0, u32::MAX), Err(BadBand::Count));
    }
}
