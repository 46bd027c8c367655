//! The see-through component of an aBSDF: a peak of the transmission around straight on, told from its surround
//! (Ward et al. 2021, *Modeling specular transmission of complex fenestration systems with data-driven BSDFs*).

use super::data::Scattering;
use super::lobe::Cell;
use ambit_base::{Colour, DVec3, Rgb};
use std::f64::consts::{FRAC_1_PI, PI};

/// Probes around the straight direction, in widths of the smallest cell.
const PROBES: [[f64; 2]; 29] = {
    const fn ring(r: f64) -> [[f64; 2]; 8] {
        [[r, 0.0], [-r, 0.0], [0.0, r], [0.0, -r], [r, r], [r, -r], [-r, r], [-r, -r]]
    }
    let (a, b, c) = (ring(0.6), ring(1.2), ring(1.8));
    let mut all = [[0.0; 2]; 29];
    let mut i = 0;
    while i < 8 {
        all[1 + i] = a[i];
        all[9 + i] = b[i];
        all[17 + i] = c[i];
        i += 1;
    }
    all[25] = [2.4, 0.0];
    all[26] = [-2.4, 0.0];
    all[27] = [0.0, 2.4];
    all[28] = [0.0, -2.4];
    all
};

/// Cells larger than this many smallest ones are no part of a peak.
const WIDEST: f64 = 1.5;
/// Values below the peak's mean by this factor are no part of it.
const STEEPNESS: f32 = 8.0;
/// The surround needs at least this share of the peak's solid angle.
const LEAST_SURROUND: f64 = 0.2;
/// Weaker peaks are none.
const LEAST_PEAK: f32 = 0.0005;
/// 2.5 × 4/π: how far around the peak a source of light counts as seen through it.
const REACH: f64 = 2.5 * 4.0 * FRAC_1_PI;

/// A see-through component for one view.
#[derive(Clone, Copy, Debug)]
pub(super) struct Through {
    /// Transmittance straight on, less the Lambertian part.
    pub(super) colour: Rgb,
    /// Mean value around it, less the Lambertian part, 1/sr.
    pub(super) surround: Rgb,
    /// Whose light it is: what lies straight on is opposite.
    view: DVec3,
    /// The smallest projected solid angle of any cell.
    least_area: f64,
}

/// One cell near the straight direction.
#[derive(Clone, Copy)]
struct Probe {
    cell: Cell,
    /// Value less the Lambertian part.
    excess: Rgb,
    /// Brightness with the Lambertian part, 1/sr.
    value: f32,
    /// True if averages find no light here.
    dark: bool,
}

impl Probe {
    /// True for the same cell, and for cells without any light, which are taken together.
    fn same(&self, other: &Self) -> bool {
        self.cell.index == other.cell.index || (self.dark && other.dark)
    }
}

impl Through {
    /// The peak of a transmission seen from `view`, if there is one.
    pub(super) fn find(transmission: &Scattering, view: DVec3) -> Option<Self> {
        let lobe = transmission.lobe.as_ref()?;
        let least_area = lobe.least_area();
        let width = least_area.sqrt();
        let base = transmission.diffuse * FRAC_1_PI as f32;
        let mut found: [Option<Probe>; PROBES.len()] = [None; PROBES.len()];
        let mut count = 0;
        for [dx, dy] in PROBES {
            // The step lies in the surface, so near the horizon little of it remains.
            let direction = (DVec3::new(dx, dy, 0.0) * width - view).normalize();
            let Some(cell) = lobe.cell(view, direction) else { continue };
            let excess = lobe.excess(&cell, view, direction, base);
            // What tells peak from surround is the whole value, also of cells that averages take as empty.
            let value = (lobe.colour(&cell, view, direction).rgb() + base).brightness();
            let probe = Probe { cell, excess, value, dark: (excess + base).brightness() <= 0.0 };
            if found[..count].iter().flatten().any(|p| p.same(&probe)) {
                continue;
            }
            found[count] = Some(probe);
            count += 1;
        }
        let found = &mut found[..count];
        let value = |p: &Option<Probe>| p.map_or(0.0, |p| p.value);
        found.sort_by(|a, b| value(b).total_cmp(&value(a)));
        let (mut members, mut values, mut area, mut colour) = (0u8, 0.0, 0.0, Rgb::ZERO);
        let (mut surround_area, mut surround) = (0.0, Rgb::ZERO);
        for Probe { cell, excess, value, .. } in found.iter().flatten() {
            let size = cell.size();
            let light = *excess * size as f32;
            if size <= WIDEST * least_area && value * f32::from(members) * STEEPNESS >= values {
                members += 1;
                values += value;
                area += size;
                colour += light;
            } else if members == 0 {
                return None;
            } else {
                surround_area += size;
                surround += light;
            }
        }
        let enough = surround_area >= LEAST_SURROUND * area && colour.brightness() >= LEAST_PEAK;
        enough.then(|| Self {
            colour: colour.max(Rgb::ZERO),
            surround: (surround / surround_area as f32).max(Rgb::ZERO),
            view,
            least_area,
        })
    }

    /// True if a source of solid angle `omega` (its centre towards `v`) is seen through the peak.
    pub(super) fn shows(&self, v: DVec3, omega: f64) -> bool {
        let projected = (omega * v.z.abs()).min(PI);
        let reach = projected + self.least_area + 2.0 * (projected * self.least_area).sqrt();
        distance_squared(self.view, v) <= REACH * reach
    }
}

/// Square of how far `v` is from straight on, in projection.
pub(super) fn distance_squared(view: DVec3, v: DVec3) -> f64 {
    let (x, y) = (v.x + view.x, v.y + view.y);
    x * x + y * y
}
