//! From the records of a scene to what rays need: modifiers compiled, surfaces in a hierarchy, sources listed.

mod fault;
mod load;
mod material;
mod modifiers;
mod world;

pub(crate) use fault::Fault;
pub(crate) use load::Contents;
pub use load::{Definition, Environment, Loaded, load};
pub(crate) use material::compile_material;
pub(crate) use modifiers::{Modifiers, Node};

use crate::patterns::Complaints;
use crate::sources::{Choice, Emitter, Lamp, Obstacles, Relay, Source, SourceId};
use crate::{Error, Options, Selection};
use ambit_file::bytes_of;
use ambit_scene::{Kind, ObjectId, Scene, VOID};
use ambit_trace::World;

/// Everything that stays the same while light is traced.
#[derive(Debug)]
pub(crate) struct Prepared {
    pub(crate) objects: Scene,
    pub(crate) modifiers: Modifiers,
    pub(crate) world: World,
    pub(crate) sources: Vec<Source>,
    /// What stands in the sources' light.
    pub(crate) obstacles: Obstacles,
    /// The sources that are sampled, in scene order.
    pub(crate) lamps: Vec<Lamp>,
    /// Which of them stand for all where hemisphere samples end.
    pub(crate) choice: Choice,
    /// Sources at infinity, in scene order.
    pub(crate) distant: Vec<SourceId>,
    /// Mirrors and prisms that relay light.
    pub(crate) relays: Vec<Relay>,
    /// Sources that mists name.
    pub(crate) scatterers: Vec<SourceId>,
    /// Objects of the main scene.
    pub(crate) top_level: std::ops::Range<ObjectId>,
    pub(crate) clip_sets: crate::antimatter::ClipSets,
    /// Modifiers whose surfaces the ambient calculation leaves out; empty if none.
    left_out: Vec<bool>,
    pub(crate) fault: Fault,
    /// Modifiers that had no value on some ray.
    pub(crate) complaints: Complaints,
    pub(crate) cube: ambit_octree::Cube,
}

impl Prepared {
    /// Compiles a loaded scene for the given options.
    pub(crate) fn new(loaded: Loaded, options: &Options, environment: &Environment<'_>) -> Result<Self, Error> {
        let Loaded { mut scene, top_level, volumes, cube, .. } = loaded;
        let modifiers = Modifiers::compile(&scene, environment, options)?;
        let sources = crate::sources::find_sources(
            &scene,
            top_level.clone(),
            &modifiers,
            options.ambient.bounces > 0,
            options.casting,
            environment,
        )?;
        let world = world::build(&scene, top_level.clone(), &volumes, &modifiers, environment)?;
        let obstacles = Obstacles::new(&sources, &world);
        let left_out = left_out(&scene, &options.ambient.selection);
        scene.shrink_to_fit();
        let complaints = Complaints::new(scene.len());
        let mut prepared = Self {
            objects: scene,
            modifiers,
            world,
            obstacles,
            distant: distant(&sources),
            sources,
            lamps: Vec::new(),
            choice: Choice::default(),
            relays: Vec::new(),
            scatterers: Vec::new(),
            top_level,
            clip_sets: crate::antimatter::ClipSets::default(),
            left_out,
            fault: Fault::default(),
            complaints,
            cube,
        };
        crate::sources::add_virtual_sources(&mut prepared, options, environment);
        crate::sources::name_scatterers(&mut prepared, environment);
        prepared.lamps = Lamp::all(&prepared.sources);
        if options.ambient.bounces > 0 {
            prepared.choice = Choice::new(&prepared.lamps, &prepared.world.bounds());
        }
        Ok(prepared)
    }

    /// True for polygons and rings, whose hits share one normal.
    pub(crate) fn is_flat(&self, surface: ObjectId) -> bool {
        surface != VOID && matches!(self.objects.object(surface).kind, Kind::Polygon | Kind::Ring)
    }

    /// True if surfaces with this immediate modifier take part in the ambient calculation.
    pub(crate) fn takes_part(&self, modifier: ObjectId) -> bool {
        self.left_out.is_empty() || modifier == VOID || !self.left_out[modifier as usize]
    }
}

fn distant(sources: &[Source]) -> Vec<SourceId> {
    let at_infinity = |(_, s): &(usize, &Source)| matches!(s.emitter, Emitter::Distant);
    sources.iter().enumerate().filter(at_infinity).map(|(i, _)| i as SourceId).collect()
}

fn left_out(scene: &Scene, selection: &Selection) -> Vec<bool> {
    let (names, listed_out) = match selection {
        Selection::All => return Vec::new(),
        Selection::Exclude(names) => (names, true),
        Selection::Include(names) => (names, false),
    };
    let listed = |id| {
        let kind = scene.object(id).kind;
        kind.is_modifier() && names.iter().any(|n| *bytes_of(n) == *scene.name_bytes(id))
    };
    scene.ids().map(|id| listed(id) == listed_out).collect()
}
