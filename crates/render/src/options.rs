//! Every parameter of a calculation, complete and typed: what the rendering options of `rpict` and `rtrace` set.

use crate::spectral::Spectrum;
use ambit_ambient::{OVERLAP, SMOOTHING, Systems};
use ambit_base::Rgb;

/// Parameters shared by all programs that trace light.
#[expect(clippy::struct_excessive_bools, reason = "each is an option by itself")]
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// `-d*`: the direct calculation.
    pub direct: Direct,
    /// `-s*`: rough specular reflection and transmission.
    pub specular: Specular,
    /// `-a*`: diffuse interreflection.
    pub ambient: Ambient,
    /// `-m*`: the medium outside every mist and dielectric.
    pub medium: Medium,
    /// `-l*`: where ray trees end.
    pub limits: Limits,
    /// `-cs`, `-cw`: bins of the spectrum.
    pub spectrum: Spectrum,
    /// `-bv`: surfaces are seen from behind.
    pub back_visible: bool,
    /// `-i`: the first opaque surface answers with its irradiance.
    pub irradiance: bool,
    /// `-u`: uncorrelated random numbers instead of stratified ones.
    pub uncorrelated: bool,
    /// Changes every random stream; equal seeds give equal bits.
    pub seed: u64,
    /// Rays only look for surfaces ([`crate::Aim::Geometry`]): that nothing lights the scene is no matter.
    pub casting: bool,
}

/// Direct light.
#[derive(Clone, Debug, PartialEq)]
pub struct Direct {
    /// `-dt`: shadow-test threshold, relative to the value found so far.
    pub threshold: f64,
    /// `-dc`: certainty, exponent of the number of samples looked ahead.
    pub certainty: f64,
    /// `-dj`: source jitter, fraction of a part's width.
    pub jitter: f64,
    /// `-ds`: largest part of a source, width over distance; 0 = undivided.
    pub sampling: f64,
    /// `-dr`: relays of virtual sources.
    pub relays: i32,
    /// `-dp`: presampling density of virtual sources.
    pub pretest: i32,
    /// `-dv`: light sources are visible.
    pub visible: bool,
}

/// Rough specular lobes.
#[derive(Clone, Debug, PartialEq)]
pub struct Specular {
    /// `-ss`: samples; 0 is sharp, above 1.5 several rays.
    pub sampling: f64,
    /// `-st`: lobes no stronger than this join the ambient part.
    pub threshold: f64,
}

/// Diffuse interreflection.
#[derive(Clone, Debug, PartialEq)]
pub struct Ambient {
    /// `-ab`: bounces.
    pub bounces: i32,
    /// `-aa`: tolerance; 0 = no cache.
    pub accuracy: f64,
    /// `-ar`: resolution, which bounds the radii.
    pub resolution: i32,
    /// `-ad`: hemisphere divisions.
    pub divisions: i32,
    /// `-as`: extra hemisphere samples.
    pub super_samples: i32,
    /// `-av`: radiance where the calculation stops.
    pub value: Rgb,
    /// `-aw`: weight of `-av` in the running average.
    pub weight: i32,
    /// `-ae`, `-ai`: modifiers left out, or the only ones let in.
    pub selection: Selection,
    /// `--unbounded-bounces`: after the last bounce paths go on until Russian roulette ends them.
    pub unbounded: bool,
    /// `--exact-textures`: without a cache hemispheres stand on the textured normal.
    pub exact_textures: bool,
    /// `--overlap`: the weight of records that a question from the eye asks for, 0 (any) to 0.9.
    pub overlap: f32,
    /// `--smoothing`: how far records count in what the eye sees, as a multiple of their reach, 1 to 2.
    pub smoothing: f32,
    /// Systems of the cache that Radiance does not have.
    pub systems: Systems,
}

impl Ambient {
    /// True if anything asks for records: interreflection, or the running average of `-aw`.
    pub fn asks(&self) -> bool {
        self.bounces > 0 || self.weight > 0
    }
}

/// Which surfaces take part in the ambient calculation, by the name of their immediate modifier.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Selection {
    /// All of them.
    #[default]
    All,
    /// All but these.
    Exclude(Vec<String>),
    /// Only these.
    Include(Vec<String>),
}

/// A participating medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// `-me`: extinction per unit length.
    pub extinction: Rgb,
    /// `-ma`: scattering albedo.
    pub albedo: Rgb,
    /// `-mg`: Henyey–Greenstein eccentricity.
    pub eccentricity: f64,
    /// `-ms`: distance between scattering samples.
    pub sampling: f64,
}

/// Where ray trees end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// `-lr`: most reflections; 0 or less: Russian roulette (with the magnitude as a hard limit if below 0).
    pub reflections: i32,
    /// `-lw`: least weight of a ray.
    pub weight: f64,
}

impl Options {
    /// The defaults of `rpict`.
    pub fn rpict() -> Self {
        Self {
            direct: Direct {
                threshold: 0.05,
                certainty: 0.5,
                jitter: 0.0,
                sampling: 0.25,
                relays: 1,
                pretest: 512,
                visible: true,
            },
            specular: Specular { sampling: 1.0, threshold: 0.15 },
            ambient: Ambient {
                bounces: 0,
                accuracy: 0.2,
                resolution: 64,
                divisions: 512,
                super_samples: 128,
                value: Rgb::ZERO,
                weight: 0,
                selection: Selection::All,
                unbounded: false,
                exact_textures: false,
                overlap: OVERLAP,
                smoothing: SMOOTHING,
                systems: Systems::default(),
            },
            medium: Medium { extinction: Rgb::ZERO, albedo: Rgb::ZERO, eccentricity: 0.0, sampling: 0.0 },
            limits: Limits { reflections: 7, weight: 1e-4 },
            spectrum: Spectrum::default(),
            back_visible: true,
            irradiance: false,
            uncorrelated: false,
            seed: 0,
            casting: false,
        }
    }

    /// `--unbiased`: every source of bias of the interreflection off, each of which has an option of its own. Without a
    /// cache there is no interpolation, no spacing, no assumed reflectance and no super-sampling.
    pub fn unbiased(&mut self) {
        let a = &mut self.ambient;
        (a.accuracy, a.super_samples, a.resolution, a.weight) = (0.0, 0, 0, 0);
        (a.unbounded, a.exact_textures, a.systems.actual_weights) = (true, true, true);
        self.limits.reflections = 0;
        self.direct.threshold = 0.0;
    }

    /// The defaults of `rtrace`.
    pub fn rtrace() -> Self {
        let mut o = Self::rpict();
        o.uncorrelated = true;
        o.direct = Direct { threshold: 0.03, certainty: 0.75, sampling: 0.2, relays: 2, ..o.direct };
        o.ambient = Ambient { accuracy: 0.1, resolution: 256, divisions: 1024, super_samples: 512, ..o.ambient };
        o.limits.reflections = -10;
        o
    }
}
