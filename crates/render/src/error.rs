//! What can go wrong between an octree and its light: one type, with the class that decides the exit status.

use ambit_base::Location;
use ambit_scene::{ErrorClass, ObjectId, Scene, VOID};

/// An error with Radiance's text for it and, where known, the place in the scene.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{text}")]
pub struct Error {
    class: ErrorClass,
    text: String,
    location: Location,
}

impl Error {
    /// An error that is the user's (`fatal`).
    pub fn user(text: impl Into<String>) -> Self {
        Self { class: ErrorClass::User, text: text.into(), location: Location::default() }
    }

    /// An error of the operating system (`system`).
    pub fn system(text: impl Into<String>) -> Self {
        Self { class: ErrorClass::System, text: text.into(), location: Location::default() }
    }

    /// `TEXT for TYPE "identifier"`, with the primitive's place.
    pub fn primitive(scene: &Scene, id: ObjectId, text: &str) -> Self {
        Self {
            class: ErrorClass::User,
            text: format!("{text} for {}", scene.describe(id)),
            location: scene.location(id),
        }
    }

    /// An error whose text is complete, with the place of a primitive.
    pub(crate) fn at(scene: &Scene, id: ObjectId, text: impl Into<String>) -> Self {
        Self { location: scene.location(id), ..Self::user(text) }
    }

    /// A file that a primitive names and the search path does not have.
    pub(crate) fn missing_file(scene: &Scene, id: ObjectId, what: &str, name: &str) -> Self {
        Self {
            class: ErrorClass::System,
            text: format!("cannot find {what} \"{name}\": No such file or directory"),
            location: scene.location(id),
        }
    }

    /// What is wrong in a file that a primitive names, with the place in that file.
    pub(crate) fn in_file(text: String, location: Location) -> Self {
        Self { class: ErrorClass::User, text, location }
    }

    /// A primitive type that cannot be rendered.
    pub(crate) fn unsupported(scene: &Scene, id: ObjectId) -> Self {
        Self::primitive(scene, id, "unsupported primitive type: Ambit cannot render this yet,")
    }

    /// A material found among another material's modifiers.
    pub(crate) fn conflicting_material(scene: &Scene, material: ObjectId, surface: ObjectId) -> Self {
        let name = scene.name(material);
        if surface == VOID {
            return Self::user(format!("conflicting material \"{name}\""));
        }
        Self::primitive(scene, surface, &format!("conflicting material \"{name}\""))
    }

    /// Whose fault it is.
    pub fn class(&self) -> ErrorClass {
        self.class
    }

    /// Where in the scene; an empty file if unknown.
    pub fn location(&self) -> &Location {
        &self.location
    }
}

impl From<ambit_scene::Error> for Error {
    fn from(e: ambit_scene::Error) -> Self {
        Self { class: e.class(), text: e.to_string(), location: e.location().clone() }
    }
}

impl From<ambit_octree::Error> for Error {
    fn from(e: ambit_octree::Error) -> Self {
        let location = Location::default();
        Self { class: e.class(), text: e.to_string(), location }
    }
}
