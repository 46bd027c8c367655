//! What light does at a surface, one material a file.

mod anisotropic;
mod ashikhmin;
mod brtd;
mod bsdf;
mod dielectric;
mod function;
mod glass;
mod ideal;
mod light;
mod mirror;
mod mist;
mod normal;
mod prism;
mod program;
mod rough;
mod wgmd;

pub(crate) use anisotropic::Anisotropic;
pub(crate) use ashikhmin::Ashikhmin;
pub(crate) use brtd::Brtd;
pub(crate) use bsdf::{Bsdf, Distribution};
pub(crate) use dielectric::Dielectric;
pub(crate) use function::FunctionMaterial;
pub(crate) use glass::{Glass, WINDOW_INDEX};
pub(crate) use light::Light;
pub(crate) use mirror::{Alternate, Mirror};
pub(crate) use mist::Mist;
pub(crate) use normal::{Normal, NormalKind};
pub(crate) use prism::Prism;
pub(crate) use wgmd::Wgmd;

use crate::antimatter::Antimatter;
use crate::observer::Observer;
use crate::ray::{Kinds, Ray};
use crate::walk::Walk;
use ambit_base::{DVec3, EPSILON, Rgb};
use ambit_trace::Opacity;

/// A compiled material.
#[derive(Debug)]
pub(crate) enum Material {
    /// plastic, metal, trans.
    Normal(Normal),
    /// plastic2, metal2, trans2.
    Anisotropic(Box<Anisotropic>),
    /// ashik2.
    Ashikhmin(Box<Ashikhmin>),
    /// plasfunc, metfunc, transfunc, plasdata, metdata, transdata.
    Function(Box<FunctionMaterial>),
    Brtd(Box<Brtd>),
    Wgmd(Box<Wgmd>),
    Prism(Box<Prism>),
    Mist(Mist),
    Glass(Glass),
    /// dielectric, interface.
    Dielectric(Dielectric),
    Mirror(Mirror),
    /// light, illum, glow, spotlight.
    Light(Light),
    Antimatter(Antimatter),
    /// BSDF, aBSDF.
    Bsdf(Box<Bsdf>),
}

/// What the modifiers between a surface and its material have gathered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Finish {
    /// Product of the patterns.
    pub(crate) pattern: Rgb,
    /// Sum of the perturbations of the normal, world coordinates.
    pub(crate) tilt: DVec3,
}

impl Material {
    /// How surfaces of this material take part in ties between coincident surfaces.
    pub(crate) fn opacity(&self) -> Opacity {
        let transparent = match self {
            Self::Normal(m) => m.kind == NormalKind::Trans,
            Self::Anisotropic(m) => m.kind == NormalKind::Trans,
            Self::Brtd(m) => m.transmits,
            Self::Wgmd(m) => m.transmits,
            Self::Glass(_) | Self::Dielectric(_) | Self::Mist(_) => true,
            Self::Bsdf(m) => m.see_through,
            Self::Ashikhmin(_)
            | Self::Function(_)
            | Self::Mirror(_)
            | Self::Prism(_)
            | Self::Light(_)
            | Self::Antimatter(_) => false,
        };
        if transparent { Opacity::Transparent } else { Opacity::Opaque }
    }

    /// True if it stops every shadow ray that is not aimed at it; `back_visible` is the switch `-bv`.
    pub(crate) fn blocks(&self, back_visible: bool) -> bool {
        match self {
            Self::Normal(m) => m.kind != NormalKind::Trans || back_visible && !m.transmits_beams(),
            Self::Light(m) => m.blocks(),
            Self::Anisotropic(_) | Self::Ashikhmin(_) | Self::Function(_) | Self::Prism(_) => true,
            Self::Brtd(m) => !m.transmits,
            Self::Wgmd(m) => back_visible && !m.transmits,
            _ => false,
        }
    }

    /// True if it changes the direction of shadow rays, or what they see behind it.
    pub(crate) fn bends(&self) -> bool {
        matches!(self, Self::Dielectric(_) | Self::Antimatter(_))
    }

    /// True for what transmits light and turns its surfaces to the viewer.
    pub(crate) fn is_two_sided(&self) -> bool {
        matches!(self, Self::Normal(_) | Self::Anisotropic(_) | Self::Glass(_))
    }

    /// True for stand-ins that only scattered light sees.
    pub(crate) fn is_proxy(&self) -> bool {
        matches!(self, Self::Bsdf(m) if m.proxy)
    }

    /// False if nothing that modifies the material matters, be it another material, which is an error elsewhere.
    pub(crate) fn takes_finish(&self) -> bool {
        !matches!(self, Self::Prism(_) | Self::Antimatter(_))
    }

    /// Lights and antimatter keep their meaning under the irradiance switch.
    fn keeps_meaning(&self) -> bool {
        matches!(self, Self::Light(_) | Self::Antimatter(_))
    }
}

impl<O: Observer> Walk<'_, O> {
    /// Shades a ray at its hit; false if the material lets it pass unchanged. `bare` is what had been gathered before the
    /// material's own modifiers.
    pub(crate) fn material(&mut self, ray: &mut Ray<'_>, material: &Material, finish: Finish, bare: &Finish) -> bool {
        if self.tracer.options.irradiance && ray.lineage.within(Kinds::STRAIGHT) && !material.keeps_meaning() {
            let hidden = ray.cosine() < 0.0 && !self.tracer.options.back_visible;
            if hidden || material.opacity() == Opacity::Transparent || material.is_proxy() {
                return false;
            }
            self.lambertian(ray, bare.tilt);
            return true;
        }
        match material {
            Material::Normal(m) => self.normal(ray, m, finish),
            Material::Anisotropic(m) => self.anisotropic(ray, m, finish),
            Material::Ashikhmin(m) => self.ashikhmin(ray, m, finish),
            Material::Function(m) => self.function_material(ray, m, finish),
            Material::Brtd(m) => self.brtd(ray, m, finish),
            Material::Wgmd(m) => self.wgmd(ray, m, finish, bare),
            Material::Prism(m) => self.prism(ray, m),
            Material::Mist(m) => self.mist(ray, m, finish),
            Material::Glass(m) => self.glass(ray, m, finish),
            Material::Dielectric(m) => self.dielectric(ray, m, finish),
            Material::Mirror(m) => self.mirror(ray, m, finish, bare),
            Material::Light(m) => self.light(ray, m, finish, bare),
            Material::Antimatter(m) => self.antimatter(ray, m, bare),
            Material::Bsdf(m) => self.bsdf(ray, m, finish),
        }
    }
}

/// A hit as its material sees it: turned to the viewer and perturbed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facing {
    /// Geometric normal.
    pub(crate) geometric: DVec3,
    /// Shading normal.
    pub(crate) normal: DVec3,
    /// −d·`normal`, not clamped.
    pub(crate) cosine: f64,
    pub(crate) tilt: DVec3,
    pub(crate) textured: bool,
}

/// Perturbations no longer than this (squared) leave a surface untextured.
const FLAT_TILT: f64 = 1e-12;

impl Facing {
    /// The hit of `ray` with its normals; flipped to the viewer if `flip`.
    pub(crate) fn of(ray: &Ray<'_>, tilt: DVec3, flip: bool) -> Self {
        let hit = ray.hit.as_ref().expect("materials are asked at hits");
        let side = if flip && hit.cosine < 0.0 { -1.0 } else { 1.0 };
        let geometric = hit.normal * side;
        let tilt = tilt * side;
        let textured = tilt.length_squared() > FLAT_TILT;
        let mut normal = geometric;
        if textured {
            let n = geometric + tilt;
            if n.length_squared() > FLAT_TILT {
                normal = n.normalize();
            }
            let c = -ray.direction.dot(normal);
            if (c < 0.0) != (hit.cosine * side < 0.0) {
                normal += ray.direction * (2.0 * c);
            }
        }
        let cosine = -ray.direction.dot(normal);
        Self { geometric, normal, cosine, tilt, textured }
    }

    /// d + 2 C N, on whichever side of the surface that may be.
    pub(crate) fn mirrored(&self, d: DVec3) -> DVec3 {
        d + self.normal * (2.0 * self.cosine)
    }
}

/// d + 2 C N, about the geometric normal instead where the result would enter the surface.
pub(crate) fn mirror_direction(d: DVec3, facing: &Facing) -> DVec3 {
    let r = facing.mirrored(d);
    if facing.textured && r.dot(facing.geometric) <= EPSILON {
        d - facing.geometric * (2.0 * d.dot(facing.geometric))
    } else {
        r
    }
}
