//! The irradiance cache: diffuse indirect light computed where it is first asked for, kept as records with derivatives
//! and an ellipse of validity, and interpolated from then on (Ward, Rubinstein, Clear 1988; Ward & Heckbert 1992;
//! Schwarzhaupt, Jensen, Jarosz 2012); and the ambient file that shares records between runs and programs.
//!
//! It knows neither scenes nor materials. Its user gives it hemisphere samples through [`Sampler`], asks with
//! [`Cache::ask`], collects what misses and has it computed with [`Cache::resolve`], in parallel and with bits that do
//! not depend on the number of threads:
//!
//! ```text
//! Query ─► Cache::ask ─► Value | Fallback | Uncached (plan a Hemisphere and sample it yourself)
//!                   └──► Miss ─► Cache::resolve ─► rounds of hemispheres ─► records ─► one value a miss
//! ```
//!
//! Records, radii, weights and limits are those of Radiance 6.0a, whose ambient files are read and written. Where it is
//! known to be wrong without need, this crate differs: gradients of uniform surroundings are zero (the sample mesh is
//! continued to the horizon), triangles of that mesh have the mean of connected surfaces, deeper questions are answered
//! without the bounces that are not left at their level, deeper hemispheres have the samples that they are worth, a wall
//! beside a point is no ceiling that makes probes useless, the axes of mixed curvatures are right, the rotational
//! gradient has finite variance, corralled records answer at their own place, black hemispheres have radii from the
//! distances around them, and thresholds scale with the scene.

mod average;
mod awake;
mod cache;
mod clamping;
mod classical;
mod codec;
mod components;
mod conversion;
mod corral;
mod derivatives;
mod edges;
mod entry;
mod file;
mod fill;
mod finish;
mod gather;
mod grid;
mod hemisphere;
mod light;
mod lookup;
mod mesh;
mod observe;
mod params;
mod radii;
mod record;
mod reuse;
mod round;
mod sampler;
mod select;
mod shares;
mod sieve;
mod steps;
mod store;
mod supersample;
#[cfg(test)]
mod tests;
mod text;
mod tilt;
mod worth;

pub use cache::{Cache, Statistics};
pub use codec::{Layout, RECORD_BYTES};
pub use components::Components;
pub use conversion::Observer;
pub use file::{AmbientFile, Contents, FORMAT, FileError, Habits, Opened, Opening, PATIENCE, Reuse, scan, scan_header};
pub use file::{Comparison, Fingerprint, Gravity, Mark, MarkLine, fingerprint_lines};
pub use file::{Segment, missing, remove_done, segments};
pub use hemisphere::Hemisphere;
pub use light::{APART, Light};
pub use observe::{Clock, LEVELS, Observed};
pub use params::{
    ASSUMED_REFLECTANCE, Bounces, Clamping, Interpolation, Limits, MOST_OVERLAP, OVERLAP, Params, SMOOTHING, Spacing,
    StepTest, Systems,
};
pub use record::Record;
pub use sampler::{Answer, Miss, Query, Sample, SampleRay, Sampler};
pub use steps::{CORES, Parallelism, Steps};
pub use text::TextForm;
pub use tilt::Tilt;
