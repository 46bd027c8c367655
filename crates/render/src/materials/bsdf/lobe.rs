//! What remains of a component once its Lambertian part is taken out, whatever its file format.
//!
//! Directions are unit vectors away from the surface in the frame of the BSDF (z the shading normal, y the up side);
//! "incident" is the one that the file's first index stands for. A component never asks on which side they are: a lobe
//! knows one pair of hemispheres, and only |z| counts.

use super::colour::Coloured;
use super::klems::Matrix;
use super::tree_lobe::TreeLobe;
use ambit_base::{DVec3, Rgb};
use std::f64::consts::PI;

/// Lambertian parts up to this reflectance or transmittance stay in the lobe.
const LEAST_DIFFUSE: f64 = 0.01;
/// Lobes whose largest directional-hemispherical value is no more than this are left out.
pub(super) const DROPPED: f64 = 0.001;

/// True if a smallest value of `least` per steradian is worth treating as a Lambertian part.
pub(super) fn is_diffuse(least: f64) -> bool {
    PI * least > LEAST_DIFFUSE
}

/// Where a pair of directions falls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cell {
    /// Tells cells of one incident direction apart.
    pub(super) index: usize,
    /// Photometric value less the Lambertian part, 1/sr.
    pub(super) value: f32,
    /// Projected solid angle on the exiting side.
    pub(super) area: f64,
    /// Projected solid angle on the incident side.
    pub(super) incident_area: f64,
}

impl Cell {
    /// The smaller of the two projected solid angles.
    pub(super) fn size(&self) -> f64 {
        self.area.min(self.incident_area)
    }
}

/// The non-Lambertian part of a component.
#[derive(Debug)]
pub(super) enum Lobe {
    Matrix(Matrix),
    Tree(TreeLobe),
}

impl Lobe {
    /// The cell of a pair of directions, or None where the data say nothing.
    pub(super) fn cell(&self, incident: DVec3, exiting: DVec3) -> Option<Cell> {
        match self {
            Self::Matrix(m) => m.cell(incident, exiting),
            Self::Tree(t) => Some(t.cell(incident, exiting)),
        }
    }

    /// The value of a cell found for these directions, with its colour.
    pub(super) fn colour(&self, cell: &Cell, incident: DVec3, exiting: DVec3) -> Coloured {
        match self {
            Self::Matrix(m) => m.colour(cell),
            Self::Tree(t) => t.colour(cell, incident, exiting),
        }
    }

    /// What a cell adds to the Lambertian value `base` (1/sr). As in Radiance, cells of trees that have nothing to add
    /// hold nothing at all, so averages over cells lose the Lambertian part there.
    pub(super) fn excess(&self, cell: &Cell, incident: DVec3, exiting: DVec3, base: Rgb) -> Rgb {
        match self {
            Self::Tree(_) if cell.value <= 0.0 => -base,
            _ => self.colour(cell, incident, exiting).rgb(),
        }
    }

    /// Projected solid angle that views are jittered by where the exiting direction is yet to be chosen.
    pub(super) fn size(&self, incident: DVec3) -> f64 {
        // A tree has many; the one that mirrors the view, or is seen straight on, is among the smallest.
        let opposite = DVec3::new(-incident.x, -incident.y, incident.z);
        self.cell(incident, opposite).map_or(0.0, |c| c.incident_area)
    }

    /// The smallest projected solid angle of any cell, on either side.
    pub(super) fn least_area(&self) -> f64 {
        match self {
            Self::Matrix(m) => m.least_area(),
            Self::Tree(t) => t.least_area(),
        }
    }

    /// Share of the light from `incident` that the lobe scatters.
    pub(super) fn total(&self, incident: DVec3) -> f64 {
        match self {
            Self::Matrix(m) => m.total(incident),
            Self::Tree(t) => t.total(incident),
        }
    }

    /// An exiting direction with z ≥ 0 for two numbers in [0, 1), with density value/total per projected solid angle.
    pub(super) fn sample(&self, incident: DVec3, x: [f64; 2]) -> Option<DVec3> {
        match self {
            Self::Matrix(m) => m.sample(incident, x),
            Self::Tree(t) => t.sample(incident, x),
        }
    }
}
