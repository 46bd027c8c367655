//! The library files that come with the program, written from their documented mathematics.

/// Name and text of every file.
pub const EMBEDDED: &[(&str, &str)] = &[("rayinit.cal", include_str!("../lib/rayinit.cal"))];

/// The text of a library file, by the name scenes use.
pub fn embedded(name: &str) -> Option<&'static str> {
    EMBEDDED.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}
