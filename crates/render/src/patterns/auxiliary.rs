//! Data files, pictures and fonts that modifiers name: found along the search path, loaded once, shared by name.

use super::builtin_font;
use super::image::Image;
use super::spectral_image::SpectralImage;
use crate::Error;
use crate::materials::Distribution;
use crate::prepare::Environment;
use ambit_file::{name_of, os_text};
use ambit_scene::{DataTable, Font, ObjectId, Scene};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Pictures that take more memory than this are worth a warning, bytes.
const LARGE_PICTURE: usize = 50_000_000;

/// What has been loaded, or why it could not be.
pub(crate) struct Auxiliary<'e> {
    environment: &'e Environment<'e>,
    tables: Loaded<DataTable>,
    images: Loaded<Image>,
    fonts: Loaded<Font>,
    spectral_images: Loaded<SpectralImage>,
    distributions: Loaded<Distribution>,
}

type Loaded<T> = HashMap<String, Result<Arc<T>, Error>>;

impl<'e> Auxiliary<'e> {
    pub(crate) fn new(environment: &'e Environment<'e>) -> Self {
        Self {
            environment,
            tables: HashMap::new(),
            images: HashMap::new(),
            fonts: HashMap::new(),
            spectral_images: HashMap::new(),
            distributions: HashMap::new(),
        }
    }

    /// The data file `name`, as primitive `id` calls it.
    pub(crate) fn table(&mut self, scene: &Scene, id: ObjectId, name: &str) -> Result<Arc<DataTable>, Error> {
        let environment = self.environment;
        once(&mut self.tables, name, || {
            let (path, bytes) = fetch(environment, scene, id, "data file", name)?;
            Ok(DataTable::parse(name, &name_of(&path), &bytes)?)
        })
    }

    /// The picture `name`.
    pub(crate) fn image(&mut self, scene: &Scene, id: ObjectId, name: &str) -> Result<Arc<Image>, Error> {
        let environment = self.environment;
        once(&mut self.images, name, || {
            let path = find(environment, scene, id, "picture file", name)?;
            let shown = name_of(&path);
            let image = Image::open(&shown)
                .map_err(|e| Error::at(scene, id, format!("bad picture file \"{shown}\"{}", e.detail())))?;
            if image.bytes() > LARGE_PICTURE {
                let megabytes = image.bytes() as f64 / (1024.0 * 1024.0);
                environment.notify.warn(&format!("picture file \"{name}\" using {megabytes:.1} MB of memory"));
            }
            Ok(image)
        })
    }

    /// The font `name`. Radiance's own fonts that are not found have a built-in substitute.
    pub(crate) fn font(&mut self, scene: &Scene, id: ObjectId, name: &str) -> Result<Arc<Font>, Error> {
        let environment = self.environment;
        let found = once(&mut self.fonts, name, || {
            let Some(path) = (environment.find)(name) else {
                return match builtin_font::substitute(name) {
                    Some(text) => Ok(Font::parse(name, text.as_bytes())?),
                    None => Err(Error::user(format!("cannot find font file \"{name}\""))),
                };
            };
            let shown = name_of(&path);
            let bytes = open(&path, "font file", name)?;
            Ok(Font::parse(&shown, &bytes)?)
        });
        found.map_err(|e| {
            let error = Error::primitive(scene, id, &format!("{e}: font load error"));
            // What is wrong stands in the font, if there is one.
            if e.location().line > 0 { Error::in_file(error.to_string(), e.location().clone()) } else { error }
        })
    }

    /// The bytes of a text file.
    pub(crate) fn text(&self, scene: &Scene, id: ObjectId, name: &str) -> Result<Vec<u8>, Error> {
        Ok(fetch(self.environment, scene, id, "text file", name)?.1)
    }

    /// The BSDF file `name`.
    pub(crate) fn distribution(&mut self, scene: &Scene, id: ObjectId, name: &str) -> Result<Arc<Distribution>, Error> {
        let environment = self.environment;
        once(&mut self.distributions, name, || {
            let (path, bytes) = fetch(environment, scene, id, "BSDF file", name)?;
            Distribution::read(&bytes, &name_of(&path), environment.notify)
                .map_err(|e| Error::in_file(e.text, e.location))
        })
    }

    /// The hyperspectral picture `name`.
    pub(crate) fn spectral_image(
        &mut self,
        scene: &Scene,
        id: ObjectId,
        name: &str,
    ) -> Result<Arc<SpectralImage>, Error> {
        let environment = self.environment;
        once(&mut self.spectral_images, name, || {
            let (path, bytes) = fetch(environment, scene, id, "hyperspectral image", name)?;
            let shown = name_of(&path);
            SpectralImage::parse(&bytes, &shown)
                .map_err(|e| Error::at(scene, id, format!("bad hyperspectral image \"{shown}\" ({e})")))
        })
    }
}

fn once<T>(known: &mut Loaded<T>, name: &str, make: impl FnOnce() -> Result<T, Error>) -> Result<Arc<T>, Error> {
    if let Some(made) = known.get(name) {
        return made.clone();
    }
    let made = make().map(Arc::new);
    known.insert(name.to_owned(), made.clone());
    made
}

fn find(environment: &Environment<'_>, scene: &Scene, id: ObjectId, what: &str, name: &str) -> Result<PathBuf, Error> {
    (environment.find)(name).ok_or_else(|| Error::missing_file(scene, id, what, name))
}

fn fetch(
    environment: &Environment<'_>,
    scene: &Scene,
    id: ObjectId,
    what: &str,
    name: &str,
) -> Result<(PathBuf, Vec<u8>), Error> {
    let path = find(environment, scene, id, what, name)?;
    let bytes = open(&path, what, name)?;
    Ok((path, bytes))
}

fn open(path: &std::path::Path, what: &str, name: &str) -> Result<Vec<u8>, Error> {
    std::fs::read(path).map_err(|e| Error::system(format!("cannot open {what} \"{name}\": {}", os_text(&e))))
}
