//! Which misses are computed together: in order, each unless one chosen before could answer it.

use crate::params::Limits;
use crate::sampler::Query;

/// The most hemispheres of a round. Part of the result, so it must not depend on the number of threads.
pub(crate) const CAP: usize = 128;

/// The hemispheres of a round.
pub(crate) struct Selection {
    /// Places of the chosen queries.
    pub(crate) picks: Vec<usize>,
    /// True if all open queries were considered.
    pub(crate) maximal: bool,
    /// Queries passed over, and the pick (by number) each was too near to.
    pub(crate) blocked: Vec<(usize, usize)>,
}

/// Chooses from the `open` queries, in order, those that stand at least `apart` from every earlier choice that could
/// serve them. With at most [`CAP`] choices comparing with each is faster than any grid.
pub(crate) fn select<O>(
    limits: &Limits,
    queries: &[Query<O>],
    open: &[usize],
    exempt: &[bool],
    apart: f64,
    most: usize,
) -> Selection {
    let mut picks: Vec<usize> = Vec::with_capacity(CAP);
    let mut weights = Vec::with_capacity(CAP);
    let mut blocked = Vec::new();
    for &at in open {
        if picks.len() == most {
            return Selection { picks, maximal: false, blocked };
        }
        let q = &queries[at];
        let blocker = if exempt[at] {
            None
        } else {
            let least = 0.9 * q.weight;
            let cosine = limits.opened_angle(q.weight).cos();
            picks.iter().zip(&weights).position(|(&p, &weight)| {
                let p = &queries[p];
                weight >= least
                    && (p.position - q.position).length_squared() < apart * apart
                    && p.normal.dot(q.normal) > cosine
            })
        };
        if let Some(pick) = blocker {
            blocked.push((at, pick));
        } else {
            picks.push(at);
            weights.push(limits.record_weight(q.level, q.weight));
        }
    }
    Selection { picks, maximal: true, blocked }
}
