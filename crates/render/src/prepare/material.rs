//! Arguments of materials, checked and typed.

use super::Modifiers;
use crate::Error;
use crate::antimatter::Antimatter;
use crate::materials::{
    Alternate, Anisotropic, Ashikhmin, Brtd, Bsdf, Dielectric, FunctionMaterial, Glass, Light, Material, Mirror, Mist,
    Normal, NormalKind, Prism, WINDOW_INDEX, Wgmd,
};
use crate::patterns::Compiler;
use crate::sources::Spot;
use ambit_base::{DVec3, EPSILON, Rgb};
use ambit_file::text_of;
use ambit_scene::{Kind, ObjectId, Scene, VOID};

/// Compiles the material `id`; errors are those that Radiance reports when a ray first meets it.
pub(crate) fn compile_material(
    scene: &Scene,
    id: ObjectId,
    _earlier: &Modifiers,
    compiler: &mut Compiler<'_>,
) -> Result<Material, Error> {
    let r = scene.reals(id);
    let object = scene.object(id);
    let bad = |text: &str| Err(Error::primitive(scene, id, text));
    Ok(match object.kind {
        Kind::Plastic | Kind::Metal | Kind::Trans => {
            let wanted = if object.kind == Kind::Trans { 7 } else { 5 };
            if r.len() != wanted {
                return bad("bad number of arguments");
            }
            Material::Normal(Normal {
                kind: match object.kind {
                    Kind::Plastic => NormalKind::Plastic,
                    Kind::Metal => NormalKind::Metal,
                    _ => NormalKind::Trans,
                },
                colour: colour(r),
                specular: r[3],
                roughness: r[4],
                transmission: r.get(5).copied().unwrap_or(0.0),
                transmitted_specular: r.get(6).copied().unwrap_or(0.0),
            })
        }
        Kind::Glass => {
            if r.len() != 3 && r.len() != 4 {
                return bad("bad arguments");
            }
            let index = r.get(3).copied().unwrap_or(WINDOW_INDEX);
            Material::Glass(Glass { transmissivity: colour(r), index })
        }
        Kind::Dielectric => {
            if r.len() != 5 {
                return bad("bad arguments");
            }
            // The Hartmann constant shifts the index at the wavelength of 500 nm that stands for all.
            Material::Dielectric(Dielectric { inside: (colour(r), r[3] + r[4] / 500.0), outside: None })
        }
        Kind::Interface => {
            if r.len() != 8 {
                return bad("bad arguments");
            }
            Material::Dielectric(Dielectric { inside: (colour(r), r[3]), outside: Some((colour(&r[4..]), r[7])) })
        }
        Kind::Mirror => {
            if r.len() != 3 || scene.string_count(id) > 1 {
                return bad("bad number of arguments");
            }
            Material::Mirror(Mirror { colour: colour(r), alternate: alternate(scene, id) })
        }
        Kind::Light | Kind::Illum | Kind::Glow | Kind::Spotlight => light(scene, id)?,
        Kind::Plastic2 | Kind::Metal2 | Kind::Trans2 => {
            Material::Anisotropic(Box::new(Anisotropic::compile(scene, id, compiler)?))
        }
        Kind::Ashik2 => Material::Ashikhmin(Box::new(Ashikhmin::compile(scene, id, compiler)?)),
        Kind::PlasFunc | Kind::MetFunc | Kind::TransFunc | Kind::PlasData | Kind::MetData | Kind::TransData => {
            Material::Function(Box::new(FunctionMaterial::compile(scene, id, compiler)?))
        }
        Kind::BrtdFunc => Material::Brtd(Box::new(Brtd::compile(scene, id, compiler)?)),
        Kind::WgmdFunc => Material::Wgmd(Box::new(Wgmd::compile(scene, id, compiler)?)),
        Kind::Prism1 | Kind::Prism2 => Material::Prism(Box::new(Prism::compile(scene, id, compiler)?)),
        Kind::Mist => Material::Mist(Mist::compile(scene, id)?),
        Kind::Antimatter => antimatter(scene, id, compiler)?,
        Kind::Bsdf | Kind::ABsdf => Material::Bsdf(Box::new(Bsdf::compile(scene, id, compiler)?)),
        _ => return Err(Error::unsupported(scene, id)),
    })
}

fn colour(r: &[f64]) -> Rgb {
    Rgb::new(r[0] as f32, r[1] as f32, r[2] as f32)
}

/// The modifier named by the first string argument, or nothing if there is no string.
fn alternate(scene: &Scene, id: ObjectId) -> Option<Alternate> {
    let name = scene.string_bytes(id, 0)?;
    Some(scene.modifier_before(name, id).map_or(Alternate::Void, Alternate::Modifier))
}

fn light(scene: &Scene, id: ObjectId) -> Result<Material, Error> {
    let r = scene.reals(id);
    let kind = scene.object(id).kind;
    let wanted = match kind {
        Kind::Glow => 4,
        Kind::Spotlight => 7,
        _ => 3,
    };
    if r.len() < wanted {
        return Err(Error::primitive(scene, id, "bad # arguments"));
    }
    let mut spot = None;
    if kind == Kind::Spotlight {
        let v = DVec3::new(r[4], r[5], r[6]);
        let focal = v.length();
        if r[3] <= EPSILON {
            return Err(Error::primitive(scene, id, "zero angle"));
        }
        if focal <= 0.0 {
            return Err(Error::primitive(scene, id, "zero focus vector"));
        }
        spot = Some(Spot { aim: v / focal, cosine: (0.5 * r[3]).to_radians().cos(), focal });
    }
    Ok(Material::Light(Light {
        kind,
        emission: colour(r),
        radius: if kind == Kind::Glow { r[3] } else { f64::INFINITY },
        spot,
        alternate: if kind == Kind::Illum { alternate(scene, id) } else { None },
    }))
}

fn antimatter(scene: &Scene, id: ObjectId, compiler: &Compiler<'_>) -> Result<Material, Error> {
    let count = scene.string_count(id);
    if count < 1 || !scene.reals(id).is_empty() {
        return Err(Error::primitive(scene, id, "bad # arguments"));
    }
    let mut listed = Vec::with_capacity(count);
    let mut first = VOID;
    for i in 0..count {
        let Some(name) = scene.string_bytes(id, i) else { continue };
        if name == b"void" {
            continue;
        }
        let text = text_of(name);
        match scene.modifier_before(name, id) {
            None => compiler.warn(&format!("unknown modifier \"{text}\" for {}", scene.describe(id))),
            Some(m) if listed.contains(&m) => {
                compiler.warn(&format!("duplicate modifier \"{text}\" for {}", scene.describe(id)));
            }
            Some(m) => {
                if i == 0 {
                    first = m;
                }
                listed.push(m);
            }
        }
    }
    listed.sort_unstable();
    Ok(Material::Antimatter(Antimatter { first, listed: listed.into() }))
}
