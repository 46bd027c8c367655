//! What a program asks of the renderer, and what it gets back.

use ambit_base::{DVec3, FAR, Rgb};
use ambit_scene::{ObjectId, VOID};

/// One primary ray.
#[derive(Clone, Copy, Debug)]
pub struct Request {
    /// Where it starts, or with [`Aim::Irradiance`] the point of measurement.
    pub origin: DVec3,
    /// Where it goes, or with [`Aim::Irradiance`] the direction the sensor faces. Any length but 0.
    pub direction: DVec3,
    /// Surfaces at this distance or beyond are out of sight; [`FAR`] for no limit.
    pub limit: f64,
    /// Which sample of the image or of the list of rays this is: successive numbers stratify together.
    pub index: u32,
    /// What is measured.
    pub aim: Aim,
}

/// What a request measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aim {
    /// Radiance along the ray (`Options::irradiance` turns surfaces into sensors).
    Radiance,
    /// Irradiance at a point with an orientation (`rtrace -I`).
    Irradiance,
    /// Geometry only: nothing is shaded.
    Geometry,
    /// What a shadow ray brings that is aimed at one light source, by its number.
    Source(u32),
}

/// What is known of a primary ray after tracing.
#[derive(Clone, Copy, Debug)]
pub struct Answer {
    /// Radiance, or irradiance.
    pub value: Rgb,
    /// The part of `value` that came by mirror reflection.
    pub mirrored: Rgb,
    /// Effective length through transparent and mirroring surfaces.
    pub length: f64,
    /// Length of the mirrored part's path.
    pub mirrored_length: f64,
    /// Length of the other part's path.
    pub unmirrored_length: f64,
    /// Distance to the first surface; [`FAR`] for none.
    pub first_length: f64,
    /// Where the traced ray started (differs from the request for [`Aim::Irradiance`]).
    pub origin: DVec3,
    /// Its unit direction.
    pub direction: DVec3,
    /// The first surface point; the origin if there is none.
    pub point: DVec3,
    /// Shading normal, on the viewer's side; zero without a surface.
    pub normal: DVec3,
    /// Geometric normal as the surface defines it; zero without a surface.
    pub geometric_normal: DVec3,
    /// Surface coordinates of a mesh, else 0.
    pub uv: [f64; 2],
    /// The surface, or [`VOID`].
    pub surface: ObjectId,
    /// Its modifier, or [`VOID`].
    pub modifier: ObjectId,
    /// The material that shaded it, or [`VOID`].
    pub material: ObjectId,
    /// Weight of the ray.
    pub weight: f32,
    /// What the medium on the way leaves of its light.
    pub coefficient: Rgb,
}

impl Answer {
    /// The answer to a ray that met nothing.
    pub fn nothing(origin: DVec3, direction: DVec3) -> Self {
        Self {
            value: Rgb::ZERO,
            mirrored: Rgb::ZERO,
            length: FAR,
            mirrored_length: FAR,
            unmirrored_length: FAR,
            first_length: FAR,
            origin,
            direction,
            point: origin,
            normal: DVec3::ZERO,
            geometric_normal: DVec3::ZERO,
            uv: [0.0; 2],
            surface: VOID,
            modifier: VOID,
            material: VOID,
            weight: 1.0,
            coefficient: Rgb::ONE,
        }
    }
}
