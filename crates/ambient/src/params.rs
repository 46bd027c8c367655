//! What the options of the cache mean in numbers: tolerance, radii and record weights.

use ambit_base::{EPSILON, Rgb};

/// The reflectance assumed of every surface when the importance of deeper bounces is estimated: level ℓ counts ½^ℓ.
/// It is part of the meaning of ambient files, whose records are shared between surfaces of all reflectances.
pub const ASSUMED_REFLECTANCE: f64 = 0.5;

/// The [`Params::overlap`] unless another is asked for. 0.2 leaves as many records in a picture as Radiance does; a little
/// more costs few further records (about 4 in 100) and takes a tenth off the error where light falls off within the smallest spacing.
pub const OVERLAP: f32 = 0.3;

/// The greatest [`Params::overlap`]: a record weighs at most 1, at its own place, and a little less once it has been
/// through a file.
pub const MOST_OVERLAP: f32 = 0.9;

/// The [`Params::smoothing`] unless another is asked for. Most of the error of a value is the noise of hemispheres, which more
/// records lessen; wider yet, errors of interpolation take over in corners.
pub const SMOOTHING: f32 = 1.25;

/// The options of the diffuse indirect calculation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// `-ab`: the largest number of nested diffuse bounces; 0 or less gives the fallback everywhere. At most 255 count.
    pub bounces: i32,
    /// `-aa`: the tolerance; multiplies radii at look-up. At most [`EPSILON`] switches caching off.
    pub accuracy: f64,
    /// `-ar`: the edge of the octree cube over the smallest radius; 0 or less: no smallest radius.
    pub resolution: i32,
    /// `-ad`: hemisphere samples at weight 1; 0 or less gives the fallback everywhere.
    pub divisions: i32,
    /// `-as`: extra hemisphere samples at weight 1.
    pub super_samples: i32,
    /// `-av`: radiance used where the calculation stops, W/(sr·m²).
    pub value: Rgb,
    /// `-aw`: the number of records `-av` counts for in the running average; 0 or less: no averaging.
    pub weight: i32,
    /// `-lw`: the smallest ray weight, which limits the divisions of uncached hemispheres.
    pub min_weight: f64,
    /// The summed weight of records (each at most 1) that a query of level 0 asks for, else it gets a record of its own;
    /// deeper levels take any weight. Radiance takes any at level 0, too: 0. But its scanlines leave records at their
    /// reach from each other, where picks far apart leave gaps of up to twice that: 0.2 makes about as many. More
    /// than [`MOST_OVERLAP`] counts as that.
    pub overlap: f32,
    /// How far records count in means of level 0, as a multiple of their reach, at least 1 (which is Radiance's); their reach
    /// alone decides where records must be made. Of deeper questions hundreds make one value, which needs no smoothing.
    pub smoothing: f32,
    /// Passes of a calculation by wavelength, at least 1: colours of a record.
    pub passes: u8,
    /// Names the set of random numbers; two runs with equal seeds agree in every bit.
    pub seed: u64,
    /// Systems beyond Radiance's, all off here.
    pub systems: Systems,
}

/// Systems of the cache that Radiance does not have, each with a switch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Systems {
    /// `--actual-weights`: records and their samples weigh what the reflectances on the path come to, instead of ½^level.
    pub actual_weights: bool,
    /// `--neighbor-clamping`: which records rein each other in.
    pub clamping: Clamping,
    /// `--measured-reuse`: from level 1 on few samples, used once, where records are hardly reused.
    pub measured_reuse: bool,
    /// `--bounces`: what questions of deeper levels get of records nearer the eye.
    pub bounces: Bounces,
    /// `--spacing`: what decides how far records reach.
    pub spacing: Spacing,
    /// `--interpolation`: of what order values between records are.
    pub interpolation: Interpolation,
    /// `--step-test`: whether steps part surfaces.
    pub step_test: StepTest,
}

/// Which records rein each other in: by how much radii, before widening by weight, may exceed each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clamping {
    /// Those of deeper bounces, by twice the distance between them.
    #[default]
    Deeper,
    /// All, by the distance between them.
    All,
    /// None, as in Radiance.
    Nobody,
}

/// What questions get of records that have more bounces than are left at their level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bounces {
    /// The bounces that are left.
    #[default]
    Apart,
    /// All, as in Radiance.
    Mixed,
}

/// What decides how far records reach.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Spacing {
    /// The curvature of irradiance, from the Hessian of the sampled surroundings; ellipses.
    #[default]
    Hessian,
    /// The harmonic mean distance of the surroundings (split sphere), with the gradients of Ward & Heckbert 1992; circles.
    Classical,
}

/// Whether records answer for surfaces a step above or below theirs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StepTest {
    /// No: see [`Limits::step`].
    #[default]
    On,
    /// As far above as along, and below by what the least radius allows, as in Radiance.
    Off,
}

/// Of what order values between records are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// Means of what records extrapolate, as in Radiance: linear functions are met exactly (Ward & Heckbert 1992).
    First,
    /// Quadratic ones, too, where records lie evenly around.
    #[default]
    Second,
}

impl Default for Params {
    /// The defaults of `rpict`.
    fn default() -> Self {
        Self {
            bounces: 0,
            accuracy: 0.2,
            resolution: 64,
            divisions: 512,
            super_samples: 128,
            value: Rgb::ZERO,
            weight: 0,
            min_weight: 1e-4,
            overlap: 0.0,
            smoothing: 1.0,
            passes: 1,
            seed: 0,
            systems: Systems::default(),
        }
    }
}

impl Params {
    /// True if records are stored and reused.
    pub fn caches(&self) -> bool {
        self.accuracy > EPSILON
    }

    /// True if questions of deeper levels are answered without the bounces that they have no more.
    pub(crate) fn tells_bounces_apart(&self) -> bool {
        self.bounces > 1 && self.systems.bounces == Bounces::Apart
    }

    /// The summed weight that makes an answer at a level.
    pub(crate) fn enough(&self, level: u8) -> f32 {
        if level == 0 { self.overlap.min(MOST_OVERLAP) } else { 0.0 }
    }

    /// The weight of a record asked for at depth `level` by a ray of weight `ray`: ½^level, lowered to 1.25 times the
    /// ray's where that is less than a tenth of it.
    pub fn record_weight(level: u8, ray: f32) -> f32 {
        let nominal = ASSUMED_REFLECTANCE.powi(i32::from(level)) as f32;
        // A ray of no weight at all still makes a record that a file accepts (0 < weight).
        if ray < 0.1 * nominal { (1.25 * ray).max(f32::MIN_POSITIVE) } else { nominal }
    }
}

/// Radii and angles that follow from the options and the size of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// The tolerance `a`.
    pub accuracy: f64,
    /// Smallest stored radius before widening by level, scene units.
    pub min_radius: f64,
    /// Largest stored radius, scene units.
    pub max_radius: f64,
    /// The edge of the scene's cube, scene units.
    pub edge: f64,
    /// The largest angle between the normals of a record and a query of full weight, radians.
    pub max_angle: f64,
    /// 1, or the cube's edge where that is smaller: what the absolute tolerances of the method are scaled by, so that
    /// models in very small units keep their light.
    pub unit: f64,
    /// Records weigh what the asking ray does.
    pub actual_weights: bool,
    /// How far records of level 0 count, as a multiple of their reach.
    pub smoothing: f32,
    /// How far off a record's plane a query may lie, for its distance along the plane, before the angle between their normals
    /// is added: a smooth surface that turns by an angle rises by less than the angle times the distance. What lies farther
    /// off is on another surface, one step up or down, that may see what the record does not. Infinite without the test.
    pub step: f32,
    /// Of what order values between records are.
    pub interpolation: Interpolation,
}

/// [`Limits::step`], a slope and so the same at all scales: takes in what is engraved; from a fifth on, light comes in from
/// outside.
const STEP: f32 = 0.1;

/// The angle two normals may always differ by, radians; the tolerance is added to it.
const BASE_ANGLE: f64 = 10.0 * std::f64::consts::PI / 180.0;

impl Limits {
    /// How far records of a level count: a multiple of their reach.
    pub(crate) fn smoothing(&self, level: u8) -> f64 {
        if level == 0 { f64::from(self.smoothing) } else { 1.0 }
    }

    /// How far records of a level count: a multiple of their radii.
    pub(crate) fn used(&self, level: u8) -> f64 {
        self.accuracy * self.smoothing(level)
    }

    /// Limits for a scene whose cube has the given edge.
    ///
    /// The smallest radius is `edge / resolution`, the largest 64 times that but at most a fifth of the edge. A smallest
    /// radius that vanishes becomes 1e-5 units (less in scenes smaller than a unit).
    pub fn new(params: &Params, edge: f64) -> Self {
        let fifth = edge / 5.0;
        let unit = edge.min(1.0);
        let (mut min_radius, mut max_radius) = if params.resolution > 0 {
            let r = edge / f64::from(params.resolution);
            (r, (64.0 * r).min(fifth))
        } else {
            (0.0, fifth)
        };
        if min_radius <= EPSILON * unit {
            min_radius = 1e-5 * unit;
        }
        if max_radius <= min_radius {
            max_radius = 64.0 * min_radius;
        }
        Self {
            accuracy: params.accuracy,
            min_radius,
            max_radius,
            edge,
            max_angle: BASE_ANGLE + params.accuracy,
            unit,
            actual_weights: params.systems.actual_weights,
            smoothing: params.smoothing.max(1.0),
            step: match params.systems.step_test {
                StepTest::On => STEP,
                StepTest::Off => f32::INFINITY,
            },
            interpolation: params.systems.interpolation,
        }
    }

    /// The weight of a record asked for at depth `level` by a ray of weight `ray`: that of [`Params::record_weight`], or
    /// the ray's own where actual weights count.
    pub fn record_weight(&self, level: u8, ray: f32) -> f32 {
        if self.actual_weights { ray.clamp(f32::MIN_POSITIVE, 1.0) } else { Params::record_weight(level, ray) }
    }

    /// The angle by which normals may differ for a query of the given weight: it opens for dim rays.
    pub fn opened_angle(&self, weight: f32) -> f64 {
        if weight < 0.6 {
            let right = std::f64::consts::FRAC_PI_2;
            right - (right - self.max_angle) * f64::from(weight.max(0.0).powf(0.13))
        } else {
            self.max_angle
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_follow_the_resolution() {
        let limits = |resolution, edge| {
            let l = Limits::new(&Params { resolution, ..Params::default() }, edge);
            (l.min_radius, l.max_radius)
        };
        assert_eq!(limits(0, 4.0), (1e-5, 0.8));
        assert_eq!(limits(-3, 4.0), (1e-5, 0.8));
        assert_eq!(limits(1, 4.0), (4.0, 256.0));
        assert_eq!(limits(8, 4.0), (0.5, 0.8));
        assert_eq!(limits(64, 4.0), (0.0625, 0.8));
        assert_eq!(limits(1024, 4.0), (4.0 / 1024.0, 0.25));
        // A scene smaller than a unit has smaller absolute limits.
        assert!((limits(0, 0.01).0 - 1e-7).abs() < 1e-15);
    }

    #[test]
    fn dim_rays_open_the_angle() {
        let l = Limits::new(&Params::default(), 1.0);
        for (weight, degrees) in [(1.0, 21.46), (0.5, 27.4), (0.25, 32.8), (0.1, 39.2), (0.01, 52.3), (0.001, 62.1)] {
            let got = l.opened_angle(weight).to_degrees();
            assert!((got - degrees).abs() < 0.06, "weight {weight}: {got}");
        }
    }

    #[test]
    fn record_weights_halve_by_level_and_follow_dim_rays() {
        for (level, ray, expected) in [(0, 1.0, 1.0), (1, 0.4, 0.5), (3, 0.2, 0.125), (0, 0.0733, 0.091_625)] {
            assert!((Params::record_weight(level, ray) - expected).abs() < 1e-6);
        }
        assert!(Params::record_weight(0, 0.0) > 0.0);
    }

    #[test]
    fn actual_weights_are_those_of_rays() {
        let systems = Systems { actual_weights: true, ..Systems::default() };
        let limits = Limits::new(&Params { systems, ..Params::default() }, 1.0);
        for (level, ray, expected) in [(0, 1.0, 1.0), (1, 0.9, 0.9), (3, 0.729, 0.729), (2, 0.01, 0.01), (0, 1.5, 1.0)]
        {
            assert_eq!(limits.record_weight(level, ray), expected);
            assert_eq!(
                Limits::new(&Params::default(), 1.0).record_weight(level, ray),
                Params::record_weight(level, ray)
            );
        }
        assert!(limits.record_weight(0, 0.0) > 0.0);
    }
}
