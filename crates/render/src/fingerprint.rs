//! What indirect light depends on, as numbers that tell one scene from another and say what differs: shapes, materials,
//! which surface has which, light sources, definitions of function files, and the options.
//!
//! Every surface gives a 64-bit hash, and the hashes are added: the order of files and the number of threads do not
//! matter. Modifiers count by what they are, with everything that modifies them, not by their names; files by their
//! contents, not by where they are found. Numbers are taken as octrees store them (31-bit mantissas), so that a frozen
//! octree is the same scene. Modifiers that no surface has do not count.

use crate::prepare::{Contents, Definition, Environment, Loaded};
use crate::{Options, Selection};
use ambit_ambient::{Bounces, Clamping, Fingerprint, Gravity, Interpolation, Mark, MarkLine, Spacing, StepTest};
use ambit_base::{Rgb, hash_bits, hash_point, mix};
use ambit_file::{bytes_of, encode_float, general, text_of};
use ambit_octree::Mesh;
use ambit_scene::{Class, Kind, ObjectId, Scene, VOID};
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};

/// The version of the numbers below; another one is another fingerprint.
const VERSION: &str = "1";
/// Objects that one task hashes.
const CHUNK: usize = 4096;

impl Loaded {
    /// The fingerprint of this scene, without the options that its light is computed with.
    pub fn fingerprint(&self, environment: &Environment<'_>) -> SceneFingerprint {
        let modifiers = Modifiers::of(&self.scene, environment);
        let marks = scene_marks(&Surfaces { loaded: self, modifiers: &modifiers }.total(), environment);
        // Where nothing relays light, -dr changes nothing.
        let relays =
            self.scene.ids().any(|id| matches!(self.scene.object(id).kind, Kind::Mirror | Kind::Prism1 | Kind::Prism2));
        SceneFingerprint { marks, edge: self.cube.edge, relays }
    }
}

/// What tells a scene from others, for options that are settled later.
#[derive(Clone, Debug)]
pub struct SceneFingerprint {
    marks: Vec<Mark>,
    /// Edge of the octree's cube, scene units.
    edge: f64,
    /// Whether something relays light.
    relays: bool,
}

impl SceneFingerprint {
    /// The fingerprint of the light in the scene as `options` compute it.
    pub fn with(self, options: &Options) -> Fingerprint {
        let mut marks = self.marks;
        marks.extend(option_marks(options, self.edge, self.relays));
        Fingerprint { marks }
    }
}

/// What every modifier is, with all that it refers to.
struct Modifiers {
    /// By object; 0 where it is no modifier.
    hashes: Vec<u64>,
    /// True for materials that emit, and what leads to them.
    emits: Vec<bool>,
}

impl Modifiers {
    fn of(scene: &Scene, environment: &Environment<'_>) -> Self {
        let mut all = Self { hashes: vec![0; scene.len()], emits: vec![false; scene.len()] };
        let mut files = HashMap::new();
        // Modifiers are defined before they are used.
        for id in scene.ids() {
            let object = scene.object(id);
            if !object.kind.is_modifier() {
                continue;
            }
            let mut hash = mix(object.kind as u64, all.hash(object.modifier));
            let mut emits = matches!(object.kind, Kind::Light | Kind::Illum | Kind::Glow | Kind::Spotlight);
            if object.kind.class() != Class::Material {
                emits |= all.emits(object.modifier);
            }
            for text in scene.strings_bytes(id) {
                let named = refers(object.kind).then(|| scene.modifier_before(text, id)).flatten();
                hash = mix(
                    hash,
                    match named {
                        Some(m) => {
                            emits |= object.kind.class() != Class::Material && all.emits(m);
                            all.hash(m)
                        }
                        None => word(text, &mut files, environment),
                    },
                );
            }
            all.hashes[id as usize] = reals(hash, scene.reals(id));
            all.emits[id as usize] = emits;
        }
        all
    }

    fn hash(&self, id: ObjectId) -> u64 {
        self.hashes.get(id as usize).copied().unwrap_or(0)
    }

    fn emits(&self, id: ObjectId) -> bool {
        self.emits.get(id as usize).copied().unwrap_or(false)
    }
}

/// True for types whose strings may name modifiers.
fn refers(kind: Kind) -> bool {
    let class = kind.class();
    matches!(class, Class::Alias | Class::Mixture) || matches!(kind, Kind::Illum | Kind::Mirror | Kind::Antimatter)
}

/// A string argument: the contents of the file that it names, or itself.
fn word(text: &[u8], files: &mut HashMap<Vec<u8>, u64>, environment: &Environment<'_>) -> u64 {
    if let Some(&known) = files.get(text) {
        return known;
    }
    let hash = file(text, environment).unwrap_or_else(|| bytes(text));
    files.insert(text.to_owned(), hash);
    hash
}

/// What the file of that name contains, if it may be a name and there is such a file.
fn file(text: &[u8], environment: &Environment<'_>) -> Option<u64> {
    let name = &*text_of(text);
    let number = |text: &str| text.parse::<f64>().is_ok();
    if name.starts_with('-') || number(name) {
        return None;
    }
    match (environment.find)(name).filter(|path| path.is_file()) {
        Some(path) => std::fs::read(path).ok().map(|contents| bytes(&contents)),
        None => ambit_cal::embedded(name).map(|text| bytes(text.as_bytes())),
    }
}

fn bytes(bytes: &[u8]) -> u64 {
    let (words, rest) = bytes.as_chunks::<8>();
    let hash = words.iter().fold(bytes.len() as u64, |h, w| mix(h, u64::from_le_bytes(*w)));
    rest.iter().fold(hash, |h, &b| mix(h, u64::from(b)))
}

/// Numbers, as an octree stores them.
fn reals(hash: u64, reals: &[f64]) -> u64 {
    reals.iter().fold(mix(hash, reals.len() as u64), |h, &x| {
        let [a, b, c, d, e] = encode_float(x);
        mix(h, u64::from_be_bytes([0, 0, 0, a, b, c, d, e]))
    })
}

/// What surfaces add up to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Sum {
    /// Shapes that do not emit.
    geometry: u64,
    /// Shapes with what they are made of.
    surfaces: u64,
    /// Distinct materials.
    materials: u64,
    /// Shapes that emit, with their light.
    lights: u64,
}

impl Sum {
    fn add(self, other: Self) -> Self {
        Self {
            geometry: self.geometry.wrapping_add(other.geometry),
            surfaces: self.surfaces.wrapping_add(other.surfaces),
            materials: self.materials.wrapping_add(other.materials),
            lights: self.lights.wrapping_add(other.lights),
        }
    }
}

struct Surfaces<'a> {
    loaded: &'a Loaded,
    modifiers: &'a Modifiers,
}

impl Surfaces<'_> {
    fn total(&self) -> Sum {
        let scene = &self.loaded.scene;
        let count = scene.len() as ObjectId;
        let part = |k: ObjectId| self.part(k * CHUNK as ObjectId..count.min((k + 1) * CHUNK as ObjectId));
        let chunks = count.div_ceil(CHUNK as ObjectId);
        let total = (0..chunks).into_par_iter().map(part).reduce(Sum::default, Sum::add);
        Sum { materials: self.materials(), ..total }
    }

    fn part(&self, range: std::ops::Range<ObjectId>) -> Sum {
        range.map(|id| self.one(id)).fold(Sum::default(), Sum::add)
    }

    fn one(&self, id: ObjectId) -> Sum {
        let scene = &self.loaded.scene;
        let object = scene.object(id);
        let shape = match object.kind.class() {
            Class::Surface => reals(object.kind as u64, scene.reals(id)),
            Class::Volume => self.volume(id),
            _ => return Sum::default(),
        };
        let made = mix(shape, self.modifiers.hash(object.modifier));
        if self.modifiers.emits(object.modifier) {
            Sum { lights: made, ..Sum::default() }
        } else {
            Sum { geometry: mix(shape, 0), surfaces: made, ..Sum::default() }
        }
    }

    /// An instance or mesh: where it stands, and what it holds. The objects of an octree count by themselves, too.
    fn volume(&self, id: ObjectId) -> u64 {
        let scene = &self.loaded.scene;
        let hash = scene.strings_bytes(id).skip(1).fold(scene.object(id).kind as u64, |h, text| mix(h, bytes(text)));
        match self.loaded.volumes.get(id).map(|placed| &placed.contents) {
            Some(Contents::Mesh(mesh)) => mix(hash, self.mesh(mesh)),
            Some(Contents::Octree(range)) => {
                let shape = |id: ObjectId| reals(scene.object(id).kind as u64, scene.reals(id));
                let surfaces = range.clone().filter(|&id| scene.object(id).kind.class() == Class::Surface);
                mix(hash, surfaces.fold(0, |sum: u64, id| sum.wrapping_add(shape(id))))
            }
            None => hash,
        }
    }

    fn mesh(&self, mesh: &Mesh) -> u64 {
        let one = |t: usize| {
            let corners = mesh.positions(t).map(hash_point);
            let normals = mesh.normals(t).map_or(0, |n| hash_bits(&n.map(hash_point)));
            let uv = mesh.uv(t).map_or(0, |uv| hash_bits(&uv.map(|uv| mix(uv.x.to_bits(), uv.y.to_bits()))));
            let material = self.modifiers.hash(mesh.materials.get(t).copied().unwrap_or(VOID));
            hash_bits(&[hash_bits(&corners), normals, uv, material])
        };
        (0..mesh.triangles.len()).into_par_iter().with_min_len(CHUNK).map(one).reduce(|| 0, u64::wrapping_add)
    }

    /// The materials of surfaces that do not emit, each once.
    fn materials(&self) -> u64 {
        let scene = &self.loaded.scene;
        let mut used = vec![false; scene.len()];
        for id in scene.ids() {
            let object = scene.object(id);
            if !object.kind.is_modifier() && object.modifier != VOID {
                used[object.modifier as usize] = true;
            }
        }
        let distinct: HashSet<u64> = scene
            .ids()
            .filter(|&id| used[id as usize] && !self.modifiers.emits(id))
            .map(|id| self.modifiers.hash(id))
            .collect();
        distinct.into_iter().fold(0, u64::wrapping_add)
    }
}

fn scene_marks(sum: &Sum, environment: &Environment<'_>) -> Vec<Mark> {
    let definitions = environment.definitions.iter().fold(0, |h, definition| {
        mix(
            h,
            match definition {
                Definition::Text(text) => bytes(text.as_bytes()),
                Definition::File(name) => file(&bytes_of(name), environment).unwrap_or_else(|| bytes(name.as_bytes())),
            },
        )
    });
    let mark =
        |key, label, value: String| Mark { line: MarkLine::Scene, key, label, value, gravity: Gravity::Decisive };
    let hashed = |key, label, hash: u64| mark(key, label, format!("{hash:016x}"));
    vec![
        mark("version", "version of fingerprint", VERSION.to_owned()),
        hashed("geometry", "geometry", sum.geometry),
        hashed("materials", "materials", sum.materials),
        hashed("surfaces", "materials of surfaces", sum.surfaces),
        hashed("lights", "light sources", sum.lights),
        hashed("definitions", "definitions of function files (-e, -f)", definitions),
    ]
}

fn option_marks(options: &Options, edge: f64, relays: bool) -> Vec<Mark> {
    let (a, d, s, medium) = (&options.ambient, &options.direct, &options.specular, &options.medium);
    let g = |x: f64| general(x, 6);
    let colour = |c: Rgb| c.to_array().map(|x| g(f64::from(x))).join(",");
    let switch = |on: bool| if on { "on" } else { "off" }.to_owned();
    let mark = |gravity, key, label, value| Mark { line: MarkLine::Options, key, label, value, gravity };
    let decisive = |key, label, value: String| mark(Gravity::Decisive, key, label, value);
    let accuracy = |key, label, value: String| mark(Gravity::Accuracy, key, label, value);
    let slight = |key, label, value: String| mark(Gravity::Slight, key, label, value);
    vec![
        decisive("ab", "-ab", a.bounces.to_string()),
        decisive("av", "-av", colour(a.value)),
        decisive("aw", "-aw", a.weight.max(0).to_string()),
        decisive("ae", "list of modifiers (-ae, -ai)", selection(&a.selection)),
        decisive("me", "-me", colour(medium.extinction)),
        decisive("ma", "-ma", colour(medium.albedo)),
        decisive("mg", "-mg", g(medium.eccentricity)),
        decisive("bv", "-bv", switch(options.back_visible)),
        decisive("virtual", "virtual light sources (-dr)", switch(!relays || d.relays > 0)),
        accuracy("ad", "-ad", a.divisions.to_string()),
        accuracy("as", "-as", a.super_samples.to_string()),
        accuracy("ar", "-ar", a.resolution.to_string()),
        accuracy("cube", "size of the octree", g(edge)),
        accuracy("st", "-st", g(s.threshold)),
        // Those whose defaults differ between rpict and rtrace, and what hardly shows in records.
        slight("dr", "-dr", d.relays.to_string()),
        slight("ds", "-ds", g(d.sampling)),
        slight("dt", "-dt", g(d.threshold)),
        slight("dc", "-dc", g(d.certainty)),
        slight("dj", "-dj", g(d.jitter)),
        slight("ss", "-ss", g(s.sampling)),
        slight("lr", "-lr", options.limits.reflections.to_string()),
        slight("lw", "-lw", g(options.limits.weight)),
        slight("ms", "-ms", g(medium.sampling)),
        // Ours; the files of older versions do not have them, and do not differ.
        decisive("unbounded", "--unbounded-bounces", switch(a.unbounded)),
        // Values are converted, which a warning of its own tells.
        slight("cw", "-cw", options.spectrum.limits().map(g).join(",")),
        slight("spacing", "--spacing", spacing(a.systems.spacing).to_owned()),
        slight("clamping", "--neighbor-clamping", switch(a.systems.clamping == Clamping::All)),
        slight("weights", "--actual-weights", switch(a.systems.actual_weights)),
        slight(
            "bounces",
            "--bounces",
            if a.unbounded || a.systems.bounces == Bounces::Mixed { "mixed" } else { "apart" }.to_owned(),
        ),
        slight("overlap", "--overlap", g(f64::from(a.overlap))),
        slight("smoothing", "--smoothing", g(f64::from(a.smoothing))),
        slight("interpolation", "--interpolation", interpolation(a.systems.interpolation).to_owned()),
        slight("steps", "--step-test", switch(a.systems.step_test == StepTest::On)),
        slight("measured", "--measured-reuse", switch(a.systems.measured_reuse)),
    ]
}

/// The word of the option.
fn interpolation(interpolation: Interpolation) -> &'static str {
    match interpolation {
        Interpolation::First => "first",
        Interpolation::Second => "second",
    }
}

/// The word of the option.
fn spacing(spacing: Spacing) -> &'static str {
    match spacing {
        Spacing::Hessian => "hessian",
        Spacing::Classical => "classical",
    }
}

/// The names, in no order.
fn selection(selection: &Selection) -> String {
    let (kind, names) = match selection {
        Selection::All => return "none".to_owned(),
        Selection::Exclude(names) => ("without", names),
        Selection::Include(names) => ("only", names),
    };
    let distinct: HashSet<&String> = names.iter().collect();
    let sum = distinct.iter().fold(0u64, |sum, name| sum.wrapping_add(bytes(name.as_bytes())));
    format!("{kind}:{sum:016x}")
}
