//! The library files that come with the program. Their mathematics is documented (the papers are named in the files)
//! or was measured with a renderer; no text is taken from anywhere.

/// Name and text of every file.
pub const EMBEDDED: &[(&str, &str)] = &[
    ("illum.cal", include_str!("../lib/illum.cal")),
    ("perezlum.cal", include_str!("../lib/perezlum.cal")),
    ("rayinit.cal", include_str!("../lib/rayinit.cal")),
    ("rev.cal", include_str!("../lib/rev.cal")),
    ("skybright.cal", include_str!("../lib/skybright.cal")),
    ("source.cal", include_str!("../lib/source.cal")),
    ("surf.cal", include_str!("../lib/surf.cal")),
    ("tilt.cal", include_str!("../lib/tilt.cal")),
    ("tmesh.cal", include_str!("../lib/tmesh.cal")),
];

/// The text of a library file, by the name scenes use.
pub fn embedded(name: &str) -> Option<&'static str> {
    EMBEDDED.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}
