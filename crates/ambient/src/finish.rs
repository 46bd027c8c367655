//! From the samples of a hemisphere to a record: mean, gradients, radii, corral.

use crate::clamping::Survey;
use crate::classical;
use crate::components::Components;
use crate::corral::{border, corral};
use crate::derivatives::Derivatives;
use crate::edges::Points;
use crate::grid::Grid;
use crate::hemisphere::Hemisphere;
use crate::light::Light;
use crate::lookup::{MAX_FACTOR, MIN_FACTOR};
use crate::mesh::{cover, mesh, rotational};
use crate::params::Limits;
use crate::radii::{Ellipse, circle, ellipse, split_sphere, turned};
use crate::record::Record;
use crate::sampler::Query;
use crate::tilt::Tilt;
use ambit_base::{Colour, DVec3, EPSILON, Rgb, Vec3};

/// Share of the black floor in relative radiances, which keeps black occluders visible to the Hessian.
const FLOOR: f64 = 0.01;
/// Mean radiances up to this are black: products of sample radiances with it stay normal numbers.
const BLACK: f64 = 1e-30;
/// Share of the border that must see something very near to hold the radius down to the smallest.
const CROWDED: f64 = 0.1;
/// What is very near, as a fraction of the smallest reach R₋a. At 1 corners would take up to a tenth more records than
/// in Radiance; a point this close to a wall it should not see past is within the rounding of modelled surfaces.
const VERY_NEAR: f64 = 0.1;
/// Normals whose cosine is at least this count as one: no texture.
const UNTEXTURED: f64 = 0.9999;

/// What is known of one cell of a hemisphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    /// Mean radiance of its samples.
    pub(crate) light: Light,
    /// Distance of the first sample; 0 if it was refused.
    pub(crate) distance: f64,
    /// Reciprocal distance of the closest sample.
    pub(crate) nearness: f64,
    /// Normal where the first sample ended; 0 if unknown.
    pub(crate) normal: Vec3,
}

/// What a hemisphere came to.
#[derive(Clone, Debug)]
pub(crate) enum Outcome {
    /// A record, its answer to the query that asked, and what is known of those whose radii bound each other's.
    Record(Record, Light, Survey),
    /// Some samples were refused: an answer to use once.
    Once(Light),
    /// All samples were refused.
    Nothing,
}

impl Outcome {
    /// What it answers to the query that asked; none if all samples were refused.
    pub(crate) fn value(self) -> Option<Light> {
        match self {
            Self::Record(_, value, _) | Self::Once(value) => Some(value),
            Self::Nothing => None,
        }
    }

    /// The record as an ambient file returns it, and its answer.
    pub(crate) fn quantised<O>(self, query: &Query<O>, components: &Components) -> Self {
        match self {
            Self::Record(record, _, survey) => {
                let record = record.quantised(components);
                let answer = answer(&record, query);
                Self::Record(record, answer, survey)
            }
            other => other,
        }
    }
}

/// The least distance that counts, so that no reciprocal gets out of hand.
pub(crate) fn least_distance(limits: &Limits) -> f64 {
    EPSILON.min(EPSILON * limits.unit).max(1e-4 * limits.min_radius)
}

/// The mean of a hemisphere that is not kept, for the normal that textures turned.
pub(crate) fn once<O>(query: &Query<O>, plan: &Hemisphere, cells: &[Cell]) -> Outcome {
    let mut tilt = Tilt::default();
    let mut taken = 0;
    for (k, cell) in cells.iter().enumerate().filter(|(_, c)| c.distance > 0.0) {
        tilt.add(plan, k, cell.light.value);
        taken += 1;
    }
    if taken == 0 { Outcome::Nothing } else { Outcome::Once(mean(cells.iter()) * tilt.factor(plan, query.shading)) }
}

/// Turns cells into a record whose light in each pass is `lights`.
pub(crate) fn finish<O>(
    limits: &Limits,
    query: &Query<O>,
    plan: &Hemisphere,
    cells: &[Cell],
    lights: &[Light],
) -> Outcome {
    let grid = plan.grid();
    let taken = cells.iter().filter(|c| c.distance > 0.0).count();
    if taken == 0 {
        return Outcome::Nothing;
    }
    let once = || Outcome::Once(lights.get(usize::from(query.pass)).copied().unwrap_or_default());
    if taken < cells.len() {
        return once();
    }
    let weight = limits.record_weight(query.level, query.weight);
    let bright = lights.iter().map(|light| light.value).sum::<Rgb>().mean() / lights.len() as f32;
    let lit = (f64::from(bright) > BLACK).then_some(bright);
    let (shape, rotation) = match grid {
        Grid::Disk { .. } => curved(limits, weight, plan, cells, lit),
        Grid::Polar { .. } => split(limits, weight, grid, cells, lit),
    };
    let rotation = turned(rotation, shape.turn);
    let reach = shape.radii.map(|r| r * limits.accuracy);
    let smoothing = limits.smoothing(query.level);
    let frame = plan.frame();
    let (s, c) = shape.turn.sin_cos();
    let u = frame.u * c + frame.v * s;
    // Where bounces are not told apart there is nothing to keep.
    let told = lights.iter().any(|light| light.late != Light::NONE.late);
    let record = Record {
        position: query.position,
        normal: query.normal,
        u: (u - query.normal * u.dot(query.normal)).normalize(),
        level: query.level,
        weight,
        radii: shape.radii.map(|r| r as f32),
        gradient: shape.gradient.map(|g| g as f32),
        rotation: rotation.map(|h| h as f32),
        corral: corral(grid, |c| plan.local(c), |c| cells[c].nearness, reach, smoothing, shape.turn),
        value: lights[0].value,
        further: lights[1..].iter().map(|light| light.value).collect(),
        late: lights.iter().filter(|_| told).map(|light| light.late).collect(),
    };
    if record.is_plausible() {
        let answer = answer(&record, query);
        Outcome::Record(record, answer, Survey::NONE)
    } else {
        once()
    }
}

/// Mean radiance of the cells, those whose samples were refused being black.
pub(crate) fn mean<'c>(cells: impl ExactSizeIterator<Item = &'c Cell>) -> Light {
    let share = 1.0 / cells.len() as f64;
    let (mut sum, mut late) = (DVec3::ZERO, Light::NONE.late);
    for cell in cells.filter(|c| c.distance > 0.0) {
        sum += cell.light.value.as_dvec3();
        late.iter_mut().zip(cell.light.late).for_each(|(sum, l)| *sum += l);
    }
    Light { value: (sum * share).as_vec3(), late: late.map(|l| l * share as f32) }
}

/// The ellipse of the Hessian and the rotational gradient of a hemisphere of the given mean radiance; none in the dark.
fn curved(limits: &Limits, weight: f32, plan: &Hemisphere, cells: &[Cell], mean: Option<f32>) -> (Ellipse, [f64; 2]) {
    let n = plan.grid().side();
    let far = 10.0 * limits.edge + 1000.0;
    let numbered = cells.iter().enumerate();
    let points = Points::new(numbered.map(|(c, cell)| {
        let normal = plan.frame().to_local(cell.normal.as_dvec3());
        (plan.local(c), cell.distance.min(far).recip() as f32, normal)
    }));
    let (derivatives, rotation, least) = if let Some(mean) = mean {
        let scale = (1.0 - FLOOR) as f32;
        let values: Vec<f32> = cells.iter().map(|c| scale * (c.light.value.mean() / mean - 1.0)).collect();
        let crowd = 1.0 / (VERY_NEAR * limits.min_radius * limits.accuracy);
        let crowded = border(n).filter(|&c| cells[c].nearness > crowd).count() as f64;
        let least = crowded > CROWDED * border(n).count() as f64;
        (mesh(n, &points, &values), rotational(n, &points, &values), least)
    } else {
        // Nothing tells how far the dark reaches but the surroundings' shape.
        (Derivatives { gradient: [0.0; 2], ..cover(n, &points) }, [0.0; 2], false)
    };
    let shape = if derivatives.is_finite() {
        ellipse(&derivatives, limits, weight, least)
    } else {
        harmonic(cells, limits, weight)
    };
    (shape, rotation)
}

/// The circle of the split sphere and the classical gradients.
fn split(limits: &Limits, weight: f32, grid: Grid, cells: &[Cell], mean: Option<f32>) -> (Ellipse, [f64; 2]) {
    let (rings, sectors) = (grid.rows(), grid.columns());
    let value = |cell: &Cell| mean.map_or(0.0, |mean| f64::from(cell.light.value.mean() / mean) - 1.0);
    let values: Vec<f64> = cells.iter().map(value).collect();
    let distances: Vec<f64> = cells.iter().map(|c| c.distance).collect();
    let gradient = classical::translational(rings, sectors, &values, &distances);
    let rotation = classical::rotational(rings, sectors, &values);
    let radius = classical::harmonic_mean(cells.iter().map(|c| c.nearness)).unwrap_or(limits.max_radius);
    (split_sphere(radius, gradient, limits, weight), rotation)
}

/// Without derivatives the harmonic mean of the sample distances tells how fast light may change.
fn harmonic(cells: &[Cell], limits: &Limits, weight: f32) -> Ellipse {
    circle(classical::harmonic_mean(cells.iter().map(|c| c.nearness)).unwrap_or(limits.max_radius), limits, weight)
}

/// What a record answers at its own place, for a shading normal that textures may have turned.
pub(crate) fn answer<O>(record: &Record, query: &Query<O>) -> Light {
    let light = record.light(query.pass);
    if query.normal.dot(query.shading) >= UNTEXTURED {
        return light;
    }
    let turn = record.normal.cross(query.shading);
    let [hu, hv] = record.rotation.map(f64::from);
    let factor = 1.0 + turn.dot(record.u) * hu + turn.dot(record.v()) * hv;
    light * (factor as f32).clamp(MIN_FACTOR, MAX_FACTOR)
}
