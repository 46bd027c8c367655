//! Which of a primitive's strings names its function file (function-files.md section 12).

use ambit_scene::Kind;

/// Index of the string that names the function file; `None` for types without functions.
pub(crate) fn function_file(kind: Kind) -> Option<usize> {
    use Kind as K;
    Some(match kind {
        K::BrightFunc | K::SpecFunc | K::PlasFunc | K::MetFunc | K::TransFunc => 1,
        K::BrightData | K::SpecData | K::SpecPict | K::PlasData | K::MetData | K::TransData => 2,
        K::TexFunc | K::ColorFunc | K::MixFunc | K::Plastic2 | K::Metal2 | K::Trans2 | K::Ashik2 => 3,
        K::ColorPict | K::MixData | K::MixPict | K::Prism1 | K::ABsdf => 4,
        K::Bsdf => 5,
        K::TexData | K::ColorData => 6,
        K::Prism2 => 8,
        K::BrtdFunc => 9,
        K::WgmdFunc => 12,
        _ => return None,
    })
}
