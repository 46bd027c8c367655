//! One search through a world: leaf by leaf, keeping the best hit, ending early at a surface that stops shadow rays.

use crate::best::{Best, Candidate, Inner, Standing, Winner};
use crate::block::Block;
use crate::item::{Content, Item, Placed};
use crate::node::{self, ITEMS, QUADS, TRIANGLES};
use crate::ray::{Hit, Rank, Ray};
use crate::walk::{DEEP_STACK, Entry, STACK, walk};
use crate::world::World;
use ambit_base::DVec3;
use ambit_scene::ObjectId;

/// What a search is for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aim {
    /// Hits beyond this distance do not matter.
    pub(crate) bound: f64,
    /// A surface that stops shadow rays ends the search if it is nearer than this; −∞ if none does.
    pub(crate) blocked_before: f64,
    /// Whether all surfaces stop shadow rays, where an instance's modifier replaces theirs.
    pub(crate) all_block: Option<bool>,
}

/// Surfaces that end a search.
#[derive(Clone, Copy, Debug)]
pub(crate) struct End {
    /// Those nearer than this that stop shadow rays; −∞ if none does.
    pub(crate) before: f64,
    /// All count as such.
    pub(crate) all: bool,
}

impl Aim {
    #[inline]
    fn before(&self, ray: &Ray) -> f64 {
        if self.all_block == Some(false) { f64::NEG_INFINITY } else { self.blocked_before.min(ray.limit) }
    }

    #[inline]
    pub(crate) fn end(&self, ray: &Ray) -> End {
        End { before: self.before(ray), all: self.all_block == Some(true) }
    }
}

/// What a search found.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Found {
    Nothing,
    Blocked(ObjectId),
    Hit(Hit, Rank),
}

/// The state of a search.
pub(crate) struct Search<'w> {
    pub(crate) world: &'w World,
    pub(crate) ray: &'w Ray,
    pub(crate) best: Best,
    aim: Aim,
    blocked: Option<ObjectId>,
}

impl<'w> Search<'w> {
    #[inline]
    pub(crate) fn new(world: &'w World, ray: &'w Ray, aim: Aim) -> Self {
        Self { world, ray, best: Best::new(ray.limit, aim.bound), aim, blocked: None }
    }

    /// Walks the tree.
    #[inline(always)]
    pub(crate) fn run(&mut self) -> Found {
        if let Some(vector) = self.world.vector {
            vector.search(self);
        } else if self.world.deep {
            self.scalar::<DEEP_STACK>();
        } else {
            self.scalar::<STACK>();
        }
        self.finish()
    }

    fn scalar<const N: usize>(&mut self) {
        let Some(entry) = Entry::new(&self.world.gate, self.ray) else { return };
        let w = self.world;
        walk::<N>(&w.nodes, &entry, self.best.bound(), |word| {
            let index = node::index(word);
            match node::kind(word) {
                TRIANGLES => self.all(TRIANGLES, &w.triangles.blocks[index]),
                QUADS => self.all(QUADS, &w.quads.blocks[index]),
                _ => self.item(index, f64::INFINITY),
            }
            self.reach(&entry)
        });
    }

    /// How far the walk still has to go.
    #[inline]
    pub(crate) fn reach(&self, entry: &Entry) -> f32 {
        if self.blocked.is_some() { -1.0 } else { entry.reach(self.best.bound()) }
    }

    /// What ends the search.
    #[inline]
    pub(crate) fn end(&self) -> End {
        self.aim.end(self.ray)
    }

    /// Ends the search at an object that stops shadow rays.
    #[inline]
    pub(crate) fn block(&mut self, object: ObjectId) {
        self.blocked = Some(object);
    }

    /// Tests all facets of a block.
    fn all(&mut self, kind: u32, block: &Block) {
        for number in block.first..block.first + block.used().count_ones() {
            self.test(node::place(kind, number));
        }
    }

    /// Tests a facet. True if it is hit.
    #[inline(always)]
    pub(crate) fn test(&mut self, place: u32) -> bool {
        let (o, d, bound) = (self.ray.origin, self.ray.direction, self.best.bound());
        let (kind, number) = node::split(place);
        let distance = match kind {
            TRIANGLES => self.world.triangles.list[number].hit(o, d, bound),
            _ => self.world.quads.list[number].hit(o, d, bound),
        };
        if let Some(distance) = distance {
            self.offer(Candidate { distance, place });
        }
        distance.is_some()
    }

    /// Tests a surface that has a leaf of its own; what is farther than `bound` does not matter.
    pub(crate) fn item(&mut self, index: usize, bound: f64) {
        let item = &self.world.items[index];
        let bound = self.best.bound().min(bound);
        if let Item::Placed(p) = item {
            return self.placed(p, bound);
        }
        let (o, d) = (self.ray.origin, self.ray.direction);
        if let Some(distance) = item.hit(&self.world.points, o, d, bound) {
            self.offer(Candidate { distance, place: node::place(ITEMS, index as u32) });
        }
    }

    #[inline(always)]
    fn offer(&mut self, c: Candidate) {
        let (world, ray) = (self.world, self.ray);
        if c.distance < self.aim.blocked_before && self.aim.all_block.unwrap_or_else(|| world.rank(c.place).blocks) {
            self.blocked = Some(world.object(c.place));
        }
        self.best.offer(c, |c| standing(world, ray, c));
    }

    /// Traces through what an instance or mesh places, in its own coordinates and units.
    fn placed(&mut self, p: &Placed, bound: f64) {
        let scale = p.transform.scale().abs();
        let d = self.ray.direction;
        let ray = Ray {
            origin: p.transform.point_back(self.ray.origin),
            direction: p.transform.direction_back(d),
            limit: self.ray.limit / scale,
        };
        let aim = Aim {
            bound: (bound / scale).next_up(),
            blocked_before: self.aim.blocked_before / scale,
            all_block: self.aim.all_block.or(p.over.map(|r| r.blocks)),
        };
        let found = match &p.content {
            Content::World(w) => Search::new(w, &ray, aim).run(),
            Content::Mesh(m) => m.search(&ray, aim),
        };
        let (hit, mut rank) = match found {
            Found::Nothing => return,
            Found::Blocked(object) => {
                let inner = p.over.is_none() && matches!(p.content, Content::World(_));
                self.blocked = Some(if inner { object } else { p.object });
                return;
            }
            Found::Hit(hit, rank) => (hit, rank),
        };
        let normal = p.transform.direction(hit.normal);
        let mut hit = Hit {
            distance: hit.distance * scale,
            normal,
            cosine: -d.dot(normal),
            tilt: p.transform.direction(hit.tilt),
            placement: Some(p.placement + hit.placement.map_or(0, |i| i + 1)),
            ..hit
        };
        if let Some(over) = p.over {
            (hit.modifier, hit.object, hit.placement) = (over.modifier, p.object, None);
            rank = over;
        } else if hit.mesh_triangle && matches!(p.content, Content::Mesh(_)) {
            hit.object = p.object;
        }
        self.best.offer_inner(Inner { owner: p.object, rank, hit });
    }

    /// Judges ties and describes the winner.
    #[inline(always)]
    fn finish(&mut self) -> Found {
        if let Some(object) = self.blocked {
            return Found::Blocked(object);
        }
        let (world, ray) = (self.world, self.ray);
        match self.best.winner(|c| standing(world, ray, c)) {
            None => Found::Nothing,
            Some(Winner::Inner(inner)) => Found::Hit(inner.hit, inner.rank),
            Some(Winner::Surface(c)) => {
                let rank = world.rank(c.place);
                let normal = world.normal(c.place, ray);
                let hit = Hit {
                    distance: c.distance,
                    object: world.object(c.place),
                    modifier: rank.modifier,
                    normal,
                    cosine: -ray.direction.dot(normal),
                    placement: None,
                    uv: [0.0; 2],
                    tilt: DVec3::ZERO,
                    mesh_triangle: false,
                };
                Found::Hit(hit, rank)
            }
        }
    }
}

fn standing(world: &World, ray: &Ray, c: &Candidate) -> Standing {
    let front = world.normal(c.place, ray).dot(ray.direction) < 0.0;
    Standing { object: world.object(c.place), rank: world.rank(c.place), front }
}
