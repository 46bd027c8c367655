//! Where a record may be reused: an ellipse from the Hessian's eigenvalues, limited by the gradient, by the scene's
//! smallest and largest radius, and widened for deeper levels and dim rays.
//!
//! With the error over a disk `½ΔᵀHΔ` integrated, r = (4/|λ|)^¼ along each eigenvector (Jarosz et al. 2012 with the error
//! constant of Radiance). The law has the dimension √length: it takes scene units for metres.

use crate::derivatives::Derivatives;
use crate::params::Limits;
use std::f64::consts::FRAC_PI_2;

/// Eigenvalues below this fraction of 1/edge² are no curvature at all.
const FLAT: f64 = 1e-12;
/// The longer radius is at most this times the shorter.
pub(crate) const ANISOTROPY: f64 = 2.0;

/// An ellipse in the tangent plane and the gradient in its axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ellipse {
    /// The angle from the frame's u to the axis of the shorter radius, radians.
    pub(crate) turn: f64,
    /// Radii along the turned u and v, scene units, the first the smaller.
    pub(crate) radii: [f64; 2],
    /// The gradient along the turned u and v, capped so that it changes at most by its value over the ellipse.
    pub(crate) gradient: [f64; 2],
}

/// The components of a tangential vector in axes turned by `angle`.
pub(crate) fn turned([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (s, c) = angle.sin_cos();
    [c * x + s * y, c * y - s * x]
}

/// The ellipse of a record of the given weight. `least` is true where the record must not reach farther than allowed
/// by the smallest radius, because something stands right beside it.
pub(crate) fn ellipse(d: &Derivatives, limits: &Limits, weight: f32, least: bool) -> Ellipse {
    let [a, b, c] = d.hessian;
    let (middle, half) = (0.5 * (a + c), (0.5 * (a - c)).hypot(b));
    let mut turn = 0.5 * (2.0 * b).atan2(a - c);
    let (mut big, mut small) = (middle + half, middle - half);
    if small.abs() > big.abs() {
        (big, small) = (small, big);
        turn += FRAC_PI_2;
    }
    let flat = FLAT / (limits.edge * limits.edge).max(1.0);
    let radius = |lambda: f64| if lambda.abs() <= flat { f64::INFINITY } else { (4.0 / lambda.abs()).powf(0.25) };
    let (mut r0, mut r1) = (radius(big), radius(small));
    if r0.is_infinite() {
        turn = 0.0;
    }
    let mut gradient = turned(d.gradient, turn);
    r0 = r0.min(1.0 / gradient[0].abs());
    r1 = r1.min(1.0 / gradient[1].abs());
    r0 = r0.min(r1);
    if r0 < limits.min_radius || least {
        r0 = limits.min_radius;
        r1 = if least { r0 } else { r1.max(r0) };
    }
    (r0, r1) = widened([r0, r1], limits, weight);
    let change = (gradient[0] * r0).hypot(gradient[1] * r1);
    if change > 1.0 {
        gradient = gradient.map(|g| g / change);
    }
    Ellipse { turn, radii: [r0, r1], gradient }
}

/// A circle for records without derivatives: the harmonic mean of the sample distances, within the limits.
pub(crate) fn circle(radius: f64, limits: &Limits, weight: f32) -> Ellipse {
    let r = radius.max(limits.min_radius);
    let (r0, r1) = widened([r, r], limits, weight);
    Ellipse { turn: 0.0, radii: [r0, r1], gradient: [0.0; 2] }
}

/// The circle of the split sphere (Ward, Rubinstein, Clear 1988): the harmonic mean distance, but not so far that the
/// value would change by more than itself; where the smallest radius is larger, it tames the gradient.
pub(crate) fn split_sphere(radius: f64, gradient: [f64; 2], limits: &Limits, weight: f32) -> Ellipse {
    let steepness = gradient[0].hypot(gradient[1]);
    let radius = radius.min(1.0 / steepness);
    let tamed = (1.0 / (steepness * limits.min_radius)).min(1.0);
    let gradient = if radius < limits.min_radius { gradient.map(|g| g * tamed) } else { gradient };
    Ellipse { gradient, ..circle(radius, limits, weight) }
}

/// Radii widened by 1/√weight and limited in their ratio and size.
fn widened([r0, r1]: [f64; 2], limits: &Limits, weight: f32) -> (f64, f64) {
    let widening = 1.0 / f64::from(weight).sqrt();
    let (r0, r1) = (r0 * widening, r1 * widening);
    let r1 = r1.min(ANISOTROPY * r0).min(limits.max_radius);
    (r0.min(limits.max_radius), r1)
}
