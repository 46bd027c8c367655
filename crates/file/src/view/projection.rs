//! From a view to rays: set-up with its checks, the ray of an image location, and the location of a point.
//!
//! Image locations run from (0, 0) at the lower left to (1, 1) at the upper right corner.

use super::{View, ViewType};
use ambit_base::{DVec3, EPSILON, FAR};
use std::f64::consts::PI;

/// Why a view can not be used, in the words that programs print.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ViewError {
    /// A negative clipping distance, or an aft distance not beyond the fore one.
    #[error("illegal fore/aft clipping plane")]
    Clipping,
    /// The view direction has no length.
    #[error("zero view direction")]
    Direction,
    /// The up vector has no length.
    #[error("zero view up vector")]
    Up,
    /// Up and direction are parallel.
    #[error("view up parallel to view direction")]
    UpParallel,
    /// A horizontal size that is not positive or too large for the type.
    #[error("illegal horizontal view size")]
    Horizontal,
    /// A vertical size that is not positive or too large for the type.
    #[error("illegal vertical view size")]
    Vertical,
    /// A letter that is no type.
    #[error("unknown view type '{0}' (expected one of: v, l, c, h, a, s)")]
    Type(char),
}

/// The ray of an image location.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewRay {
    /// Where it starts: on the fore clipping surface.
    pub origin: DVec3,
    /// Unit direction.
    pub direction: DVec3,
    /// How far it reaches from its origin: to the aft clipping surface, [`FAR`] if there is none.
    pub length: f64,
}

/// A view that passed the checks, with what its rays need.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// The view as given.
    pub view: View,
    /// Unit view direction D.
    pub direction: DVec3,
    /// Unit vector H to the right.
    pub right: DVec3,
    /// Unit vector V upwards in the image, H × D.
    pub up: DVec3,
    /// Length of the view's direction: where depth of field focuses.
    pub focal_distance: f64,
    /// Width of the image surface at unit distance (scene units if parallel, radians if an angle).
    pub width: f64,
    /// Height of the image surface, likewise.
    pub height: f64,
}

/// Scales a vector to unit length and returns its length before, 0 for a vector too short to have one.
///
/// Close to unit length the square root is replaced by its tangent, as the format's other readers and writers do, so
/// that rays agree with theirs to the last bit.
fn normalise(v: DVec3) -> (DVec3, f64) {
    let q = v.dot(v);
    if q == 0.0 {
        (v, 0.0)
    } else if (q - 1.0).abs() <= EPSILON {
        let length = 0.5 + 0.5 * q;
        (v * (2.0 - length), length)
    } else {
        let length = q.sqrt();
        (v * (1.0 / length), length)
    }
}

impl View {
    /// Checks the view, in the order in which programs report errors, and prepares its rays.
    pub fn set_up(&self) -> Result<Projection, ViewError> {
        let v = self;
        if v.fore < -EPSILON || v.aft < -EPSILON || (v.aft > EPSILON && v.aft <= v.fore) {
            return Err(ViewError::Clipping);
        }
        let unit = |v, error| match normalise(v) {
            (_, 0.0) => Err(error),
            found => Ok(found),
        };
        let (direction, focal_distance) = unit(v.direction, ViewError::Direction)?;
        let (up, _) = unit(v.up, ViewError::Up)?;
        let (right, _) = unit(direction.cross(up), ViewError::UpParallel)?;
        let (h, w) = (v.horizontal, v.vertical);
        if h <= EPSILON {
            return Err(ViewError::Horizontal);
        }
        if w <= EPSILON {
            return Err(ViewError::Vertical);
        }
        let (width, height) = extents(v.kind, h, w)?;
        Ok(Projection { view: *v, direction, right, up: right.cross(direction), focal_distance, width, height })
    }
}

/// Sizes of the image surface, after the upper limits of the angles.
fn extents(kind: ViewType, h: f64, v: f64) -> Result<(f64, f64), ViewError> {
    let (tangent, sine) = (|a: f64| 2.0 * (a / 2.0).to_radians().tan(), |a: f64| 2.0 * (a / 2.0).to_radians().sin());
    let below = |a: f64, limit: f64, error| if a < limit - EPSILON { Ok(()) } else { Err(error) };
    let at_most = |a: f64, limit: f64, error| if a <= limit + EPSILON { Ok(()) } else { Err(error) };
    match kind {
        ViewType::Parallel => Ok((h, v)),
        ViewType::Perspective => {
            below(h, 180.0, ViewError::Horizontal)?;
            below(v, 180.0, ViewError::Vertical)?;
            Ok((tangent(h), tangent(v)))
        }
        ViewType::Cylinder => {
            at_most(h, 360.0, ViewError::Horizontal)?;
            below(v, 180.0, ViewError::Vertical)?;
            Ok((h.to_radians(), tangent(v)))
        }
        ViewType::Angular => {
            at_most(h, 360.0, ViewError::Horizontal)?;
            at_most(v, 360.0, ViewError::Vertical)?;
            Ok((h.to_radians(), v.to_radians()))
        }
        ViewType::Hemisphere => {
            at_most(h, 180.0, ViewError::Horizontal)?;
            at_most(v, 180.0, ViewError::Vertical)?;
            Ok((sine(h), sine(v)))
        }
        ViewType::Planisphere => {
            below(h, 360.0, ViewError::Horizontal)?;
            below(v, 360.0, ViewError::Vertical)?;
            let stereographic = |a: f64| sine(a) / (1.0 + (a / 2.0).to_radians().cos());
            Ok((stereographic(h), stereographic(v)))
        }
        ViewType::Unknown(letter) => Err(ViewError::Type(letter)),
    }
}

impl Projection {
    /// The ray through an image location; `None` outside a fisheye's disk.
    pub fn ray(&self, x: f64, y: f64) -> Option<ViewRay> {
        let v = &self.view;
        let (x, y) = (x - 0.5 + v.shift, y - 0.5 + v.lift);
        let (x_size, y_size) = (x * self.width, y * self.height);
        match v.kind {
            ViewType::Perspective => Some(self.planar(self.along(1.0, x_size, y_size))),
            ViewType::Cylinder => {
                let (sine, cosine) = x_size.sin_cos();
                Some(self.planar(self.along(cosine, sine, y_size)))
            }
            ViewType::Parallel => {
                let origin = v.point + self.along(v.fore, x_size, y_size);
                Some(ViewRay { origin, direction: self.direction, length: self.reach(1.0) })
            }
            ViewType::Hemisphere => {
                let square = 1.0 - x_size * x_size - y_size * y_size;
                (square >= 0.0).then(|| self.spherical(self.along(square.sqrt(), x_size, y_size)))
            }
            ViewType::Angular => {
                let (a, b) = (x * v.horizontal / 180.0, y * v.vertical / 180.0);
                let radius = (a * a + b * b).sqrt();
                if radius > 1.0 {
                    return None;
                }
                let z = (PI * radius).cos();
                let k = if radius <= EPSILON { PI } else { (1.0 - z * z).sqrt() / radius };
                Some(self.spherical(self.along(z, k * a, k * b)))
            }
            ViewType::Planisphere => {
                let q = x_size * x_size + y_size * y_size;
                let z = (1.0 - q) / (1.0 + q);
                Some(self.spherical(self.along(z, (1.0 + z) * x_size, (1.0 + z) * y_size)))
            }
            ViewType::Unknown(_) => None,
        }
    }

    fn along(&self, d: f64, h: f64, v: f64) -> DVec3 {
        self.direction * d + self.right * h + self.up * v
    }

    /// A ray whose clipping distances are measured in units of `w`.
    fn planar(&self, w: DVec3) -> ViewRay {
        let (direction, length) = normalise(w);
        ViewRay { origin: self.view.point + w * self.view.fore, direction, length: self.reach(length) }
    }

    /// A ray whose clipping distances are lengths along it.
    fn spherical(&self, direction: DVec3) -> ViewRay {
        ViewRay { origin: self.view.point + direction * self.view.fore, direction, length: self.reach(1.0) }
    }

    /// From the fore to the aft clipping surface.
    fn reach(&self, scale: f64) -> f64 {
        if self.view.aft > EPSILON { (self.view.aft - self.view.fore) * scale } else { FAR }
    }

    /// Where a point appears, which may be outside the image; `None` where it has no place: behind a perspective or
    /// hemispherical view, at the view point, or exactly where the projection is singular.
    pub fn locate(&self, point: DVec3) -> Option<[f64; 2]> {
        let w = point - self.view.point;
        let (d, b, c) = (w.dot(self.direction), w.dot(self.right), w.dot(self.up));
        let n = w.length();
        let (x, y) = match self.view.kind {
            ViewType::Perspective if d > 0.0 => (b / d, c / d),
            ViewType::Parallel => (b, c),
            ViewType::Cylinder => (b.atan2(d), c / d.hypot(b)),
            ViewType::Hemisphere if d >= 0.0 => (b / n, c / n),
            ViewType::Angular => {
                // acos(t)/√(1 − t²), written with the lengths along and across the axis so that it keeps its digits.
                let across = b.hypot(c);
                let k = if across > 0.0 { across.atan2(d) / across } else { 1.0 / d };
                if across == 0.0 && d <= 0.0 {
                    return None;
                }
                (b * k, c * k)
            }
            ViewType::Planisphere => (b / (n + d), c / (n + d)),
            _ => return None,
        };
        let at = [x / self.width + 0.5 - self.view.shift, y / self.height + 0.5 - self.view.lift];
        at.iter().all(|v| v.is_finite()).then_some(at)
    }

    /// Height over width of the image surface.
    pub fn aspect(&self) -> f64 {
        self.height / self.width
    }
}
