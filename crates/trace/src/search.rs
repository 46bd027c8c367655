//! One search through a world: leaf by leaf, keeping the best hit, ending early at a surface that stops shadow rays.

use crate::best::{Best, Candidate, Inner, Winner};
use crate::facet::{Facets, Lanes};
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
    pub(crate) ray: Ray,
    pub(crate) entry: Option<Entry>,
    pub(crate) best: Best,
    aim: Aim,
    blocked: Option<ObjectId>,
}

impl<'w> Search<'w> {
    #[inline]
    pub(crate) fn new(world: &'w World, ray: &Ray, aim: Aim) -> Self {
        Self {
            world,
            ray: *ray,
            entry: Entry::new(&world.bounds, world.centre, ray),
            best: Best::new(ray.limit, aim.bound),
            aim,
            blocked: None,
        }
    }

    /// Walks the tree.
    #[inline]
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
        let Some(entry) = self.entry else { return };
        let w = self.world;
        let (o, d) = (self.ray.origin, self.ray.direction);
        walk::<N>(&w.nodes, &entry, self.best.bound(), |word| {
            let index = node::index(word);
            match node::kind(word) {
                TRIANGLES => self.take(word, &w.triangles[index], w.triangles[index].test(o, d, self.best.bound())),
                QUADS => self.take(word, &w.quads[index], w.quads[index].test(o, d, self.best.bound())),
                _ => self.item(word, index),
            }
            self.reach(&entry)
        });
    }

    /// How far the walk still has to go.
    #[inline]
    pub(crate) fn reach(&self, entry: &Entry) -> f32 {
        if self.blocked.is_some() { -1.0 } else { entry.reach(self.best.bound()) }
    }

    /// Takes what a block answered.
    #[inline]
    pub(crate) fn take<const K: usize>(&mut self, word: u32, block: &Facets<K>, lanes: Lanes) {
        let mut mask = lanes.mask;
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize & 3;
            mask &= mask - 1;
            let distance = lanes.distance[lane];
            if distance > self.best.bound() {
                continue;
            }
            let inside = lanes.edge[lane] > 0.0 || block.decide(lane, self.ray.origin, self.ray.direction, distance);
            if inside {
                let front = block.normal(lane).dot(self.ray.direction) < 0.0;
                let place = node::place(word, lane);
                self.offer(Candidate { distance, object: block.object[lane], place, front });
            }
        }
    }

    /// Tests a surface that has a leaf of its own.
    pub(crate) fn item(&mut self, word: u32, index: usize) {
        let item = &self.world.items[index];
        if let Item::Placed(p) = item {
            return self.placed(p);
        }
        let (o, d) = (self.ray.origin, self.ray.direction);
        if let Some((distance, _, cosine)) = item.hit(&self.world.points, o, d, self.best.bound()) {
            let place = node::place(word, 0);
            self.offer(Candidate { distance, object: item.object(), place, front: cosine > 0.0 });
        }
    }

    #[inline]
    fn offer(&mut self, c: Candidate) {
        let world = self.world;
        if c.distance < self.aim.blocked_before && self.aim.all_block.unwrap_or_else(|| world.rank_at(&c).blocks) {
            self.blocked = Some(c.object);
        }
        self.best.offer(c, |c| world.rank_at(c));
    }

    /// Traces through what an instance or mesh places, in its own coordinates and units.
    fn placed(&mut self, p: &Placed) {
        let scale = p.transform.scale().abs();
        let d = self.ray.direction;
        let ray = Ray {
            origin: p.transform.point_back(self.ray.origin),
            direction: p.transform.direction_back(d),
            limit: self.ray.limit / scale,
        };
        let aim = Aim {
            bound: (self.best.bound() / scale).next_up(),
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
    #[inline]
    fn finish(&mut self) -> Found {
        if let Some(object) = self.blocked {
            return Found::Blocked(object);
        }
        let world = self.world;
        let rank = |c: &Candidate| world.rank_at(c);
        match self.best.winner(rank) {
            None => Found::Nothing,
            Some(Winner::Inner(inner)) => Found::Hit(inner.hit, inner.rank),
            Some(Winner::Surface(c)) => {
                let rank = rank(&c);
                let normal = self.normal(&c);
                let hit = Hit {
                    distance: c.distance,
                    object: c.object,
                    modifier: rank.modifier,
                    normal,
                    cosine: -self.ray.direction.dot(normal),
                    placement: None,
                    uv: [0.0; 2],
                    tilt: DVec3::ZERO,
                    mesh_triangle: false,
                };
                Found::Hit(hit, rank)
            }
        }
    }

    fn normal(&self, c: &Candidate) -> DVec3 {
        let (kind, index, lane) = node::split(c.place);
        match kind {
            TRIANGLES => self.world.triangles[index].normal(lane),
            QUADS => self.world.quads[index].normal(lane),
            ITEMS => {
                let (o, d) = (self.ray.origin, self.ray.direction);
                let found = self.world.items[index].hit(&self.world.points, o, d, f64::INFINITY);
                found.map_or(DVec3::ZERO, |f| f.1)
            }
            _ => DVec3::ZERO,
        }
    }
}
