//! Modifiers compiled once: each primitive that can modify a surface becomes a node and the modifier it goes on with.

use super::{Environment, compile_material};
use crate::materials::{Glass, Material};
use crate::patterns::{Mixture, Pattern, Texture};
use crate::{Error, Options};
use ambit_scene::{Class, Kind, ObjectId, Scene, VOID};
use ambit_trace::Opacity;

/// What a modifier does when a ray gets to it.
#[derive(Debug)]
pub(crate) enum Node {
    Material(Material),
    Pattern(Pattern),
    Texture(Texture),
    Mixture(Mixture),
    /// An alias without a target, another name for what follows: does nothing itself.
    Transparent,
    /// Cannot be used; the calculation ends when a ray needs it.
    Unusable(Error),
}

/// A modifier: which primitive defines what it does, and what follows.
#[derive(Clone, Copy, Debug)]
struct Link {
    node: u32,
    /// The primitive that `node` was compiled from (an alias's target).
    definition: ObjectId,
    next: ObjectId,
}

const NO_LINK: Link = Link { node: u32::MAX, definition: VOID, next: VOID };

/// All modifiers of a scene.
#[derive(Debug)]
pub(crate) struct Modifiers {
    links: Vec<Link>,
    nodes: Vec<Node>,
    opacity: Vec<Opacity>,
    /// Chains on which a material stands, be it inside a mixture.
    has_material: Vec<bool>,
    /// Modifiers that surely stop every shadow ray.
    blocks: Vec<bool>,
    /// Modifiers that may send shadow rays off their line, or hide other surfaces from them.
    bends: Vec<bool>,
}

impl Modifiers {
    /// Compiles every modifier of `scene`. Faulty ones become [`Node::Unusable`]: only a ray that needs one fails.
    pub(crate) fn compile(scene: &Scene, environment: &Environment<'_>, options: &Options) -> Result<Self, Error> {
        let last = scene.ids().rev().find(|&id| scene.object(id).kind.is_modifier()).map_or(0, |id| id as usize + 1);
        let mut all = Self {
            links: vec![NO_LINK; last],
            nodes: Vec::new(),
            opacity: vec![Opacity::Nothing; last],
            has_material: vec![false; last],
            blocks: vec![false; last],
            bends: vec![false; last],
        };
        let mut compiler = crate::patterns::Compiler::new(scene, environment, options.spectrum)?;
        for id in 0..last as ObjectId {
            let object = scene.object(id);
            if !object.kind.is_modifier() {
                continue;
            }
            let link = if object.kind == Kind::Alias {
                all.alias(scene, id)
            } else {
                let node = all.node(scene, id, &mut compiler);
                all.nodes.push(node);
                Link { node: all.nodes.len() as u32 - 1, definition: id, next: object.modifier }
            };
            all.links[id as usize] = link;
            all.classify(scene, id, options.back_visible);
        }
        all.clear_clipped(scene);
        Ok(all)
    }

    fn node(&self, scene: &Scene, id: ObjectId, compiler: &mut crate::patterns::Compiler<'_>) -> Node {
        let made = match scene.object(id).kind.class() {
            Class::Material => compile_material(scene, id, self, compiler).map(Node::Material),
            Class::Pattern => Pattern::compile(scene, id, compiler).map(Node::Pattern),
            Class::Texture => Texture::compile(scene, id, compiler).map(Node::Texture),
            Class::Mixture => Mixture::compile(scene, id, compiler).map(Node::Mixture),
            Class::Alias | Class::Surface | Class::Volume => Ok(Node::Transparent),
        };
        made.unwrap_or_else(Node::Unusable)
    }

    /// An alias with a target acts as the target with the alias's own modifier; one without is passed over.
    fn alias(&mut self, scene: &Scene, id: ObjectId) -> Link {
        let next = scene.object(id).modifier;
        let target = scene.string_bytes(id, 0).and_then(|name| scene.modifier_before(name, id));
        if let Some(mut t) = target {
            while let (Node::Transparent, _, named) = self.get(t)
                && named != VOID
            {
                t = named;
            }
            Link { next, ..self.links[t as usize] }
        } else {
            self.nodes.push(Node::Transparent);
            Link { node: self.nodes.len() as u32 - 1, definition: id, next }
        }
    }

    /// Finds the opacity class of a chain that starts at `id`; its links are already there.
    fn classify(&mut self, scene: &Scene, id: ObjectId, back_visible: bool) {
        let link = self.links[id as usize];
        self.bends[id as usize] = match &self.nodes[link.node as usize] {
            Node::Material(m) => m.bends(),
            Node::Mixture(m) => [m.sides[0], m.sides[1], link.next].into_iter().any(|id| self.bends(id)),
            _ => self.bends(link.next),
        };
        let (opacity, blocks) = match &self.nodes[link.node as usize] {
            Node::Material(m) => (m.opacity(), m.blocks(back_visible)),
            Node::Mixture(m) if m.sides.iter().any(|&side| self.has_material(side)) => (Opacity::Opaque, false),
            Node::Unusable(_) => match scene.object(link.definition).kind.class() {
                Class::Material | Class::Mixture => (Opacity::Opaque, false),
                _ => self.inherited(link.next),
            },
            Node::Mixture(_) | Node::Pattern(_) | Node::Texture(_) | Node::Transparent => self.inherited(link.next),
        };
        self.opacity[id as usize] = opacity;
        self.has_material[id as usize] = opacity != Opacity::Nothing;
        self.blocks[id as usize] = blocks;
    }

    fn inherited(&self, next: ObjectId) -> (Opacity, bool) {
        if next == VOID { (Opacity::Nothing, false) } else { (self.opacity[next as usize], self.blocks[next as usize]) }
    }

    /// Modifiers named by antimatter may vanish, so they promise nothing to shadow rays.
    fn clear_clipped(&mut self, scene: &Scene) {
        for id in 0..self.links.len() as ObjectId {
            if scene.object(id).kind != Kind::Antimatter {
                continue;
            }
            for name in 0..scene.string_count(id) {
                let Some(name) = scene.string_bytes(id, name) else { continue };
                if let Some(m) = scene.modifier_before(name, id) {
                    self.blocks[m as usize] = false;
                }
            }
        }
    }

    /// True if passes of a calculation by wavelength may differ in any of them.
    pub(crate) fn spectral(&self) -> bool {
        self.nodes.iter().any(|node| matches!(node, Node::Pattern(p) if p.is_spectral()))
    }

    /// True if surfaces of this modifier may send shadow rays off their line, or hide others from them.
    pub(crate) fn bends(&self, id: ObjectId) -> bool {
        id != VOID && self.bends[id as usize]
    }

    /// What a modifier does, the primitive that says so, and the modifier that follows.
    #[inline]
    pub(crate) fn get(&self, id: ObjectId) -> (&Node, ObjectId, ObjectId) {
        let link = self.links[id as usize];
        (&self.nodes[link.node as usize], link.definition, link.next)
    }

    /// The glass that a modifier is, if nothing modifies that.
    #[inline]
    pub(crate) fn plain_glass(&self, id: ObjectId) -> Option<&Glass> {
        match self.links.get(id as usize).map(|link| (&self.nodes[link.node as usize], link.next)) {
            Some((Node::Material(Material::Glass(m)), VOID)) => Some(m),
            _ => None,
        }
    }

    /// The material that the primitive `id` was compiled to.
    pub(crate) fn material_mut(&mut self, id: ObjectId) -> Option<&mut Material> {
        match self.nodes.get_mut(self.links.get(id as usize)?.node as usize)? {
            Node::Material(m) => Some(m),
            _ => None,
        }
    }

    /// Makes a modifier end the calculation of the first ray that needs it.
    pub(crate) fn disable(&mut self, id: ObjectId, error: Error) {
        if let Some(link) = self.links.get(id as usize)
            && let Some(node) = self.nodes.get_mut(link.node as usize)
        {
            *node = Node::Unusable(error);
        }
    }

    /// The first material up the chain from `id`, aliases followed: its node and primitive.
    pub(crate) fn material(&self, mut id: ObjectId) -> Option<(&Material, ObjectId)> {
        while id != VOID {
            let (node, definition, next) = self.get(id);
            match node {
                Node::Material(m) => return Some((m, definition)),
                Node::Mixture(_) | Node::Unusable(_) => return None,
                _ => id = next,
            }
        }
        None
    }

    /// The material that shades surfaces with this modifier, or the mixture that blends materials for them or ends the chain.
    pub(crate) fn shader(&self, mut id: ObjectId) -> ObjectId {
        while id != VOID {
            let (node, definition, next) = self.get(id);
            match node {
                Node::Material(_) => return definition,
                Node::Mixture(m) if m.sides.iter().any(|&side| self.has_material(side)) => return definition,
                Node::Mixture(_) if next == VOID => return definition,
                _ => {}
            }
            id = next;
        }
        VOID
    }

    /// The error of a light-source material that a chain leads to but that cannot be used.
    pub(crate) fn faulty_light(&self, scene: &Scene, mut id: ObjectId) -> Option<Error> {
        while id != VOID {
            let (node, definition, next) = self.get(id);
            match node {
                Node::Unusable(error) => {
                    let kind = scene.object(definition).kind;
                    if matches!(kind, Kind::Light | Kind::Illum | Kind::Glow | Kind::Spotlight) {
                        return Some(error.clone());
                    }
                    if kind.class() == Class::Material {
                        return None;
                    }
                }
                Node::Material(_) | Node::Mixture(_) => return None,
                _ => {}
            }
            id = next;
        }
        None
    }

    /// True if a pattern stands anywhere on the chain from `id`.
    pub(crate) fn patterned(&self, mut id: ObjectId) -> bool {
        while id != VOID {
            let (node, _, next) = self.get(id);
            if matches!(node, Node::Pattern(_) | Node::Mixture(_) | Node::Unusable(_)) {
                return true;
            }
            id = next;
        }
        false
    }

    /// True if a chain leads to a material, be it inside a mixture.
    pub(crate) fn has_material(&self, id: ObjectId) -> bool {
        id != VOID && self.has_material[id as usize]
    }

    /// How surfaces with this immediate modifier take part in ties.
    pub(crate) fn opacity(&self, id: ObjectId) -> Opacity {
        if id == VOID { Opacity::Nothing } else { self.opacity[id as usize] }
    }

    /// True if surfaces with this immediate modifier stop every shadow ray.
    pub(crate) fn blocks(&self, id: ObjectId) -> bool {
        id != VOID && self.blocks[id as usize]
    }
}
