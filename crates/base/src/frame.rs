//! Orthonormal frames around a direction.

use glam::DVec3;

/// A right-handed orthonormal frame: `u × v = n`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// First tangent.
    pub u: DVec3,
    /// Second tangent, `n × u`.
    pub v: DVec3,
    /// The axis the frame was built around, unit length.
    pub n: DVec3,
}

impl Frame {
    /// A frame around the unit vector `n`: `u` is the normalised cross product of `n` with the last coordinate axis
    /// along which `n` has a component below 0.6 in size.
    pub fn around(n: DVec3) -> Self {
        let axis = if n.z.abs() < 0.6 {
            DVec3::Z
        } else if n.y.abs() < 0.6 {
            DVec3::Y
        } else {
            DVec3::X
        };
        let u = axis.cross(n).normalize();
        Self { u, v: n.cross(u), n }
    }

    /// The frame around `n` whose `u` is turned by `angle` radians from that of [`Frame::around`].
    pub fn turned(n: DVec3, angle: f64) -> Self {
        let f = Self::around(n);
        let (s, c) = angle.sin_cos();
        let u = f.u * c + f.v * s;
        Self { u, v: n.cross(u), n }
    }

    /// From frame coordinates to the coordinates `u`, `v`, `n` are given in.
    #[inline]
    pub fn to_world(&self, p: DVec3) -> DVec3 {
        self.u * p.x + self.v * p.y + self.n * p.z
    }

    /// From the coordinates `u`, `v`, `n` are given in to frame coordinates.
    #[inline]
    pub fn to_local(&self, p: DVec3) -> DVec3 {
        DVec3::new(p.dot(self.u), p.dot(self.v), p.dot(self.n))
    }
}
