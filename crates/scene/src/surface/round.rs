//! Spheres, cones, cylinders, rings and their inside-out twins: type and radii put right, then made into geometry.

use super::{Complaint, Cone, Ring, Shape, Source, Sphere, point};
use crate::{Kind, Problem};
use ambit_base::{DVec3, EPSILON};
use std::f64::consts::TAU;

/// A round surface with type and radii as frozen octrees store them.
pub(super) struct Tidy {
    pub(super) kind: Kind,
    reals: [f64; 8],
    count: usize,
    /// What was found, with the type at that moment: at most one repair and one reason to ignore the surface.
    pub(super) complaints: [Option<(Kind, Complaint)>; 2],
}

/// True for the types that [`Tidy`] knows.
pub(super) fn is_round(kind: Kind) -> bool {
    matches!(kind, Kind::Sphere | Kind::Bubble | Kind::Cone | Kind::Cup | Kind::Cylinder | Kind::Tube | Kind::Ring)
}

/// −1, 0 or 1; lengths within [`EPSILON`] of zero have no sign.
fn sign(x: f64) -> i32 {
    i32::from(x > EPSILON) - i32::from(x < -EPSILON)
}

impl Tidy {
    /// Checks the count and puts type and radii right.
    pub(super) fn new(kind: Kind, reals: &[f64]) -> Result<Self, Problem> {
        let (count, wrong) = match kind {
            Kind::Sphere | Kind::Bubble => (4, Problem::BadArguments),
            Kind::Cylinder | Kind::Tube => (7, Problem::BadArgumentCount),
            Kind::Cone | Kind::Cup | Kind::Ring => (8, Problem::BadArgumentCount),
            _ => return Err(Problem::NoGeometry),
        };
        if reals.len() != count {
            return Err(wrong);
        }
        let mut tidy = Self { kind, reals: [0.0; 8], count, complaints: [None; 2] };
        tidy.reals[..count].copy_from_slice(reals);
        if !reals.iter().all(|r| r.is_finite()) {
            tidy.ignore(Complaint::NotFinite);
            return Ok(tidy);
        }
        match kind {
            Kind::Sphere | Kind::Bubble => tidy.sphere(),
            Kind::Cylinder | Kind::Tube => tidy.cylinder(),
            Kind::Ring => tidy.ring(),
            _ => tidy.cone(),
        }
        Ok(tidy)
    }

    /// The arguments, tidied.
    pub(super) fn reals(&self) -> &[f64] {
        &self.reals[..self.count]
    }

    fn turn_inside_out(&mut self, complaint: Complaint) {
        self.complaints[0] = Some((self.kind, complaint));
        self.kind = self.kind.inside_out();
    }

    fn ignore(&mut self, complaint: Complaint) {
        self.complaints[1] = Some((self.kind, complaint));
    }

    fn sphere(&mut self) {
        match sign(self.reals[3]) {
            0 => self.ignore(Complaint::ZeroRadius),
            -1 => {
                self.turn_inside_out(Complaint::NegativeRadius);
                self.reals[3] = -self.reals[3];
            }
            _ => {}
        }
    }

    fn cylinder(&mut self) {
        match sign(self.reals[6]) {
            0 => return self.ignore(Complaint::IllegalRadii),
            -1 => {
                self.turn_inside_out(Complaint::NegativeRadius);
                self.reals[6] = -self.reals[6];
            }
            _ => {}
        }
        self.check_axis(point(&self.reals[3..]) - point(&self.reals));
    }

    fn cone(&mut self) {
        let (s0, s1) = self.signs();
        if s0 + s1 == 0 {
            return self.ignore(Complaint::IllegalRadii);
        }
        if s0 < 0 || s1 < 0 {
            self.turn_inside_out(Complaint::NegativeRadii);
            self.reals[6] = self.reals[6].abs();
            self.reals[7] = self.reals[7].abs();
        }
        if (self.reals[6] - self.reals[7]).abs() <= EPSILON {
            self.kind = if self.kind == Kind::Cone { Kind::Cylinder } else { Kind::Tube };
            self.count = 7;
        }
        self.check_axis(point(&self.reals[3..]) - point(&self.reals));
    }

    fn ring(&mut self) {
        let (s0, s1) = self.signs();
        if s0 < 0 || s1 < 0 || s0 + s1 == 0 || (self.reals[6] - self.reals[7]).abs() <= EPSILON {
            return self.ignore(Complaint::IllegalRadii);
        }
        self.check_axis(point(&self.reals[3..]));
    }

    /// Signs of the two radii; those without sign become exactly zero.
    fn signs(&mut self) -> (i32, i32) {
        for r in &mut self.reals[6..8] {
            if sign(*r) == 0 {
                *r = 0.0;
            }
        }
        (sign(self.reals[6]), sign(self.reals[7]))
    }

    /// Directions count as missing only if their squared length is zero (or overflows).
    fn check_axis(&mut self, axis: DVec3) {
        if axis.length_squared() == 0.0 {
            self.ignore(Complaint::UnknownOrientation);
        } else if !axis.length_squared().is_finite() {
            self.ignore(Complaint::NotFinite);
        }
    }

    /// The geometry.
    pub(super) fn shape(&self) -> Shape {
        if self.complaints[1].is_some() {
            return Shape::Degenerate;
        }
        let r = &self.reals;
        let inward = matches!(self.kind, Kind::Bubble | Kind::Cup | Kind::Tube);
        match self.kind {
            Kind::Sphere | Kind::Bubble => Shape::Sphere(Sphere { centre: point(r), radius: r[3], inward }),
            Kind::Ring => Shape::Ring(Ring {
                centre: point(r),
                normal: near_unit(point(&r[3..])).unwrap_or_else(|| point(&r[3..]).normalize()),
                r0: r[6].min(r[7]),
                r1: r[6].max(r[7]),
            }),
            _ => {
                let (mut p0, mut p1) = (point(r), point(&r[3..]));
                let (mut r0, mut r1) = (r[6], if self.count == 7 { r[6] } else { r[7] });
                if r0 > r1 {
                    (p0, p1, r0, r1) = (p1, p0, r1, r0);
                }
                let length = p0.distance(p1);
                // Times the reciprocal, as Radiance does: along a coordinate axis the last bit shows in boxes.
                let axis = near_unit(p1 - p0).unwrap_or((p1 - p0) * length.recip());
                Shape::Cone(Cone { p0, p1, r0, r1, axis, length, inward })
            }
        }
    }
}

/// The unit vector along one whose squared length is within 1e-6 of 1, to first order, as Radiance takes it: the error of
/// 1e-13 shows in the last digit of cubes around rings and cones.
fn near_unit(v: DVec3) -> Option<DVec3> {
    let excess = v.length_squared() - 1.0;
    (excess.abs() <= 1e-6).then(|| v * (1.0 - 0.5 * excess))
}

impl Source {
    /// From the arguments `dx dy dz angle`, the angle the full opening in degrees: Ω = 2π (1 − cos(angle/2)).
    pub(super) fn new(reals: &[f64]) -> Result<Self, Problem> {
        let &[x, y, z, angle] = reals else { return Err(Problem::BadArguments) };
        let direction = DVec3::new(x, y, z);
        let length = direction.length();
        if length == 0.0 || !length.is_finite() {
            return Err(Problem::ZeroDirection);
        }
        let half = 0.5 * angle.to_radians();
        // A full turn of the half angle comes back to nothing; not-a-number and infinity have no size either.
        if !(half > EPSILON && half.is_finite()) {
            return Err(Problem::ZeroSize);
        }
        Ok(Self { direction: direction / length, solid_angle: TAU * (1.0 - half.cos()) })
    }

    /// True if a ray that leaves the scene along the unit vector `d` sees the disk.
    #[inline]
    pub fn contains(&self, d: DVec3) -> bool {
        TAU * (1.0 - self.direction.dot(d)) <= self.solid_angle
    }
}
