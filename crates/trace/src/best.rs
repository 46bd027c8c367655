//! The best hit so far, with the ties kept until the end, so that the answer does not depend on the order in which
//! surfaces are tested.
//!
//! Of the hits within ε of the nearest one wins a surface with a material over one without, an opaque one over a
//! transparent one, a front over a back, then the modifier defined later, then the surface defined later. A hit
//! inside an instance or mesh takes part in the order of definition, latest first: it replaces surfaces defined after
//! the instance only if it is strictly nearer, and is held against those defined before by the rule above.

use crate::ray::{Hit, Rank};
use ambit_base::EPSILON;
use ambit_scene::ObjectId;

/// Ties that are kept; more are merged pairwise, latest defined first, which is the order they are judged in anyway.
const SLOTS: usize = 6;

/// A surface hit, not yet judged.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    pub(crate) distance: f64,
    /// Where the surface lies in the world's tables, see [`crate::node::place`].
    pub(crate) place: u32,
}

/// What decides ties: looked up only where there are some.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Standing {
    pub(crate) object: ObjectId,
    pub(crate) rank: Rank,
    pub(crate) front: bool,
}

/// The nearest hit inside an instance or mesh, in the coordinates of the world around it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inner {
    /// The instance or mesh primitive.
    pub(crate) owner: ObjectId,
    pub(crate) rank: Rank,
    pub(crate) hit: Hit,
}

/// The winner.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Winner {
    Surface(Candidate),
    Inner(Inner),
}

pub(crate) struct Best {
    /// Hits beyond this distance are of no interest any more.
    bound: f64,
    /// Distance of the nearest surface or inner hit.
    nearest: f64,
    count: usize,
    ties: [Candidate; SLOTS],
    inner: Option<Inner>,
}

impl Best {
    /// Nothing found; hits at or beyond `limit`, or beyond `bound`, are refused.
    pub(crate) fn new(limit: f64, bound: f64) -> Self {
        let none = Candidate { distance: 0.0, place: 0 };
        Self { bound: bound.min(limit.next_down()), nearest: f64::INFINITY, count: 0, ties: [none; SLOTS], inner: None }
    }

    /// The largest distance that still matters.
    #[inline]
    pub(crate) fn bound(&self) -> f64 {
        self.bound
    }

    /// Takes a surface hit no farther than the bound.
    #[inline(always)]
    pub(crate) fn offer(&mut self, c: Candidate, standing: impl Fn(&Candidate) -> Standing) {
        if c.distance < self.nearest - EPSILON {
            self.ties[0] = c;
            self.count = 1;
            self.nearest = c.distance;
            self.bound = self.bound.min(c.distance + EPSILON);
        } else {
            self.tie(c, standing);
        }
    }

    #[cold]
    fn tie(&mut self, c: Candidate, standing: impl Fn(&Candidate) -> Standing) {
        self.approach(c.distance);
        let far = self.nearest + EPSILON;
        let mut kept = 0;
        for i in 0..self.count {
            if self.ties[i].distance <= far {
                self.ties[kept] = self.ties[i];
                kept += 1;
            }
        }
        if kept == SLOTS {
            self.ties.sort_unstable_by_key(|t| std::cmp::Reverse(standing(t).object));
            if !beats(&standing(&self.ties[0]), &standing(&self.ties[1])) {
                self.ties[0] = self.ties[1];
            }
            self.ties.copy_within(2.., 1);
            kept -= 1;
        }
        self.ties[kept] = c;
        self.count = kept + 1;
    }

    /// Takes the nearest hit inside an instance or mesh.
    pub(crate) fn offer_inner(&mut self, inner: Inner) {
        let t = inner.hit.distance;
        let better = self
            .inner
            .as_ref()
            .is_none_or(|old| t < old.hit.distance || (t == old.hit.distance && inner.owner > old.owner));
        if t <= self.bound && better {
            self.approach(t);
            self.inner = Some(inner);
        }
    }

    fn approach(&mut self, distance: f64) {
        self.nearest = self.nearest.min(distance);
        self.bound = self.bound.min(distance + EPSILON);
    }

    /// Judges the ties.
    #[inline(always)]
    pub(crate) fn winner(&mut self, standing: impl Fn(&Candidate) -> Standing) -> Option<Winner> {
        if self.count == 1 && self.inner.is_none() {
            return Some(Winner::Surface(self.ties[0]));
        }
        if self.count == 0 {
            return self.inner.map(Winner::Inner);
        }
        Some(self.judge(standing))
    }

    #[cold]
    fn judge(&mut self, standing: impl Fn(&Candidate) -> Standing) -> Winner {
        let far = self.nearest + EPSILON;
        let n = self.count;
        self.ties[..n].sort_unstable_by_key(|t| std::cmp::Reverse(standing(t).object));
        let mut inner = self.inner.filter(|i| i.hit.distance <= far);
        let mut best: Option<Winner> = None;
        for t in &self.ties[..n] {
            if t.distance > far {
                continue;
            }
            let own = standing(t);
            if let Some(i) = inner.filter(|i| i.owner > own.object) {
                best = Some(enter(best, i));
                inner = None;
            }
            best = Some(match best {
                Some(Winner::Surface(b)) if beats(&standing(&b), &own) => Winner::Surface(b),
                Some(Winner::Inner(i)) if key(i.rank, i.hit.cosine > 0.0) >= key(own.rank, own.front) => {
                    Winner::Inner(i)
                }
                _ => Winner::Surface(*t),
            });
        }
        match (best, inner) {
            (Some(b), None) => b,
            (b, Some(i)) => enter(b, i),
            // Something is always within ε of the nearest, namely the nearest.
            (None, None) => Winner::Surface(self.ties[0]),
        }
    }
}

/// An instance or mesh comes up: it replaces the best only if strictly nearer.
fn enter(best: Option<Winner>, inner: Inner) -> Winner {
    match best {
        Some(Winner::Surface(b)) if b.distance <= inner.hit.distance => Winner::Surface(b),
        _ => Winner::Inner(inner),
    }
}

fn key(rank: Rank, front: bool) -> (crate::ray::Opacity, bool, ObjectId) {
    (rank.opacity, front, rank.modifier)
}

/// Does `first`, defined later or the same, stay ahead of `second`?
fn beats(first: &Standing, second: &Standing) -> bool {
    key(first.rank, first.front) >= key(second.rank, second.front)
}
