//! Surroundings given as functions, and the records made in them.

use ambit_ambient::{Answer, Cache, Miss, Params, Query, Record, Sample, SampleRay, Sampler};
use ambit_base::{DVec3, FAR, Rgb, Vec3};

/// Surroundings as a function from a ray to radiance and distance.
pub(crate) struct Around<F>(pub(crate) F);

impl<F: Fn(DVec3, DVec3) -> (f32, f64) + Sync> Sampler for Around<F> {
    type Origin = ();
    type Scratch<'a>
        = ()
    where
        Self: 'a;

    fn scratch(&self) {}

    fn sample(
        &self,
        (): &mut (),
        _: &Cache,
        query: &Query<()>,
        &SampleRay { direction, weight, .. }: &SampleRay,
        _: &mut Vec<Miss<()>>,
    ) -> Option<Sample> {
        assert_eq!(weight, 0.5);
        let (radiance, distance) = (self.0)(query.position, direction);
        Some(Sample { light: Rgb::splat(radiance).into(), distance, normal: Vec3::ZERO })
    }

    fn occluded(&self, _: &Query<()>, _: DVec3, _: DVec3) -> bool {
        false
    }
}

pub(crate) fn params(divisions: i32, seed: u64) -> Params {
    Params { bounces: 1, divisions, super_samples: 0, resolution: 0, seed, ..Params::default() }
}

pub(crate) fn query(position: DVec3) -> Query<()> {
    Query { position, normal: DVec3::Z, shading: DVec3::Z, weight: 1.0, level: 0, pass: 0, origin: () }
}

/// The record at a point facing +z.
pub(crate) fn record_with(
    params: Params,
    edge: f64,
    position: DVec3,
    around: impl Fn(DVec3, DVec3) -> (f32, f64) + Sync,
) -> Record {
    // The cube lies around whole multiples of a million, as the points do.
    let centre = (position / 1e6).round() * 1e6;
    let mut cache = Cache::new(params, centre - 0.5 * edge, edge);
    let sampler = Around(around);
    let query = query(position);
    assert_eq!(cache.ask(&sampler, &query), Answer::Miss);
    let values = cache.resolve(&sampler, &[Miss { coefficient: Rgb::ONE, query }]);
    assert_eq!(values, [cache.records()[0].value]);
    cache.records()[0].clone()
}

/// A tangential pair of a record as x and y.
pub(crate) fn world(record: &Record, pair: [f32; 2]) -> [f64; 2] {
    let v = record.u * f64::from(pair[0]) + record.v() * f64::from(pair[1]);
    [v.x, v.y]
}

pub(crate) fn close(got: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((got - expected).abs() <= tolerance, "{what}: {got} instead of {expected} ± {tolerance}");
}

/// A bright rectangle at height z = `h`, black elsewhere.
pub(crate) fn rectangle(x: [f64; 2], y: [f64; 2], h: f64) -> impl Fn(DVec3, DVec3) -> (f32, f64) + Sync {
    move |p, d| {
        let t = (h - p.z) / d.z;
        let q = p + d * t;
        let inside = q.x >= x[0] && q.x <= x[1] && q.y >= y[0] && q.y <= y[1];
        if d.z > 0.0 && inside { (1.0, t) } else { (0.0, FAR) }
    }
}
