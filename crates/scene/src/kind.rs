//! The table of primitive types, in the order of type numbers in frozen octrees.

/// What part a primitive plays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Geometry with a place in space (or a distant `source`).
    Surface,
    /// Geometry held in another file.
    Volume,
    /// Another name for a modifier.
    Alias,
    /// Decides what light does at a surface.
    Material,
    /// Perturbs the surface normal.
    Texture,
    /// Multiplies the colour.
    Pattern,
    /// Blends two modifiers.
    Mixture,
}

/// A primitive type.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Kind {
    /// `polygon`
    Polygon,
    /// `cone`
    Cone,
    /// `sphere`
    Sphere,
    /// `texfunc`
    TexFunc,
    /// `ring`
    Ring,
    /// `cylinder`
    Cylinder,
    /// `instance`
    Instance,
    /// `cup`
    Cup,
    /// `bubble`
    Bubble,
    /// `tube`
    Tube,
    /// `mesh`
    Mesh,
    /// `alias`
    Alias,
    /// `plastic`
    Plastic,
    /// `metal`
    Metal,
    /// `glass`
    Glass,
    /// `trans`
    Trans,
    /// `dielectric`
    Dielectric,
    /// `plastic2`
    Plastic2,
    /// `metal2`
    Metal2,
    /// `trans2`
    Trans2,
    /// `interface`
    Interface,
    /// `plasfunc`
    PlasFunc,
    /// `metfunc`
    MetFunc,
    /// `brightfunc`
    BrightFunc,
    /// `brightdata`
    BrightData,
    /// `brighttext`
    BrightText,
    /// `colorpict`
    ColorPict,
    /// `glow`
    Glow,
    /// `source`
    Source,
    /// `light`
    Light,
    /// `illum`
    Illum,
    /// `spotlight`
    Spotlight,
    /// `mist`
    Mist,
    /// `mirror`
    Mirror,
    /// `transfunc`
    TransFunc,
    /// `BRTDfunc`
    BrtdFunc,
    /// `BSDF`
    Bsdf,
    /// `aBSDF`
    ABsdf,
    /// `WGMDfunc`
    WgmdFunc,
    /// `plasdata`
    PlasData,
    /// `metdata`
    MetData,
    /// `transdata`
    TransData,
    /// `colorfunc`
    ColorFunc,
    /// `antimatter`
    Antimatter,
    /// `colordata`
    ColorData,
    /// `colortext`
    ColorText,
    /// `texdata`
    TexData,
    /// `mixfunc`
    MixFunc,
    /// `mixdata`
    MixData,
    /// `mixtext`
    MixText,
    /// `mixpict`
    MixPict,
    /// `prism1`
    Prism1,
    /// `prism2`
    Prism2,
    /// `ashik2`
    Ashik2,
    /// `spectrum`
    Spectrum,
    /// `specfile`
    SpecFile,
    /// `specfunc`
    SpecFunc,
    /// `specdata`
    SpecData,
    /// `specpict`
    SpecPict,
}

/// Every type with its name in scene files and its class; the index is the type number.
pub const KINDS: [(Kind, &str, Class); 59] = [
    (Kind::Polygon, "polygon", Class::Surface),
    (Kind::Cone, "cone", Class::Surface),
    (Kind::Sphere, "sphere", Class::Surface),
    (Kind::TexFunc, "texfunc", Class::Texture),
    (Kind::Ring, "ring", Class::Surface),
    (Kind::Cylinder, "cylinder", Class::Surface),
    (Kind::Instance, "instance", Class::Volume),
    (Kind::Cup, "cup", Class::Surface),
    (Kind::Bubble, "bubble", Class::Surface),
    (Kind::Tube, "tube", Class::Surface),
    (Kind::Mesh, "mesh", Class::Volume),
    (Kind::Alias, "alias", Class::Alias),
    (Kind::Plastic, "plastic", Class::Material),
    (Kind::Metal, "metal", Class::Material),
    (Kind::Glass, "glass", Class::Material),
    (Kind::Trans, "trans", Class::Material),
    (Kind::Dielectric, "dielectric", Class::Material),
    (Kind::Plastic2, "plastic2", Class::Material),
    (Kind::Metal2, "metal2", Class::Material),
    (Kind::Trans2, "trans2", Class::Material),
    (Kind::Interface, "interface", Class::Material),
    (Kind::PlasFunc, "plasfunc", Class::Material),
    (Kind::MetFunc, "metfunc", Class::Material),
    (Kind::BrightFunc, "brightfunc", Class::Pattern),
    (Kind::BrightData, "brightdata", Class::Pattern),
    (Kind::BrightText, "brighttext", Class::Pattern),
    (Kind::ColorPict, "colorpict", Class::Pattern),
    (Kind::Glow, "glow", Class::Material),
    (Kind::Source, "source", Class::Surface),
    (Kind::Light, "light", Class::Material),
    (Kind::Illum, "illum", Class::Material),
    (Kind::Spotlight, "spotlight", Class::Material),
    (Kind::Mist, "mist", Class::Material),
    (Kind::Mirror, "mirror", Class::Material),
    (Kind::TransFunc, "transfunc", Class::Material),
    (Kind::BrtdFunc, "BRTDfunc", Class::Material),
    (Kind::Bsdf, "BSDF", Class::Material),
    (Kind::ABsdf, "aBSDF", Class::Material),
    (Kind::WgmdFunc, "WGMDfunc", Class::Material),
    (Kind::PlasData, "plasdata", Class::Material),
    (Kind::MetData, "metdata", Class::Material),
    (Kind::TransData, "transdata", Class::Material),
    (Kind::ColorFunc, "colorfunc", Class::Pattern),
    (Kind::Antimatter, "antimatter", Class::Material),
    (Kind::ColorData, "colordata", Class::Pattern),
    (Kind::ColorText, "colortext", Class::Pattern),
    (Kind::TexData, "texdata", Class::Texture),
    (Kind::MixFunc, "mixfunc", Class::Mixture),
    (Kind::MixData, "mixdata", Class::Mixture),
    (Kind::MixText, "mixtext", Class::Mixture),
    (Kind::MixPict, "mixpict", Class::Mixture),
    (Kind::Prism1, "prism1", Class::Material),
    (Kind::Prism2, "prism2", Class::Material),
    (Kind::Ashik2, "ashik2", Class::Material),
    (Kind::Spectrum, "spectrum", Class::Pattern),
    (Kind::SpecFile, "specfile", Class::Pattern),
    (Kind::SpecFunc, "specfunc", Class::Pattern),
    (Kind::SpecData, "specdata", Class::Pattern),
    (Kind::SpecPict, "specpict", Class::Pattern),
];

impl Kind {
    /// The type called `name` in scene files (case matters).
    pub fn from_name(name: &[u8]) -> Option<Self> {
        KINDS.iter().find(|k| k.1.as_bytes() == name).map(|k| k.0)
    }

    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        KINDS[self as usize].1
    }

    /// The part it plays.
    pub fn class(self) -> Class {
        KINDS[self as usize].2
    }

    /// The same surface seen from the other side.
    pub(crate) fn inside_out(self) -> Self {
        match self {
            Self::Sphere => Self::Bubble,
            Self::Bubble => Self::Sphere,
            Self::Cone => Self::Cup,
            Self::Cup => Self::Cone,
            Self::Cylinder => Self::Tube,
            Self::Tube => Self::Cylinder,
            other => other,
        }
    }

    /// True for everything that other primitives can name as their modifier.
    pub fn is_modifier(self) -> bool {
        !matches!(self.class(), Class::Surface | Class::Volume)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_enum() {
        for (i, &(kind, name, _)) in KINDS.iter().enumerate() {
            assert_eq!(kind as usize, i);
            assert_eq!(Kind::from_name(name.as_bytes()), Some(kind));
        }
    }
}
