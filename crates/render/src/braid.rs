//! The ray trees of all passes as one.
//!
//! Passes follow the same rays, but for those that bring nothing in their bins: the tree has the rays of all, each where
//! it finishes, and what a pass has not followed is black in its bins.

use crate::request::Answer;
use crate::tree::TreeRay;
use ambit_base::{Rgb, hash_bits, hash_point};
use std::collections::{HashMap, VecDeque};

/// One ray, as each pass has followed it.
type Strand = Vec<Option<TreeRay>>;

/// What a ray is known by in the trees of other passes.
fn key(ray: &TreeRay) -> u64 {
    hash_bits(&[ray.depth as u64, hash_point(ray.answer.origin), hash_point(ray.answer.direction)])
}

/// The rays of all passes in the order in which they finish: lists of equal length, one a pass, and one of what is said of
/// rays whose bins are elsewhere, whose weights are the largest of all passes.
pub(crate) fn braid(passes: Vec<Vec<TreeRay>>) -> (Vec<TreeRay>, Vec<Vec<TreeRay>>) {
    let count = passes.len();
    let mut strands = Vec::new();
    for (pass, rays) in passes.into_iter().enumerate() {
        strands = add(strands, rays, pass, count);
    }
    let mut lists: Vec<Vec<TreeRay>> = (0..count).map(|_| Vec::with_capacity(strands.len())).collect();
    let mut known = Vec::with_capacity(strands.len());
    for strand in strands {
        let Some(&first) = strand.iter().flatten().next() else { continue };
        let weight = strand.iter().flatten().fold(0f32, |w, ray| w.max(ray.answer.weight));
        let black = Answer { value: Rgb::ZERO, mirrored: Rgb::ZERO, coefficient: Rgb::ZERO, ..first.answer };
        let unfollowed = TreeRay { answer: black, contribution: Rgb::ZERO, ..first };
        lists.iter_mut().zip(strand).for_each(|(list, ray)| list.push(ray.unwrap_or(unfollowed)));
        known.push(TreeRay { answer: Answer { weight, ..first.answer }, ..first });
    }
    (known, lists)
}

/// Lays the rays of a pass beside those of the ones before it.
fn add(strands: Vec<Strand>, rays: Vec<TreeRay>, pass: usize, count: usize) -> Vec<Strand> {
    let mut places: HashMap<u64, VecDeque<usize>> = HashMap::new();
    for (place, strand) in strands.iter().enumerate() {
        if let Some(ray) = strand.iter().flatten().next() {
            places.entry(key(ray)).or_default().push_back(place);
        }
    }
    let mut laid = Vec::with_capacity(strands.len().max(rays.len()));
    let mut rest = strands.into_iter().enumerate();
    let mut next = 0;
    for ray in rays {
        let found = places.get_mut(&key(&ray)).and_then(|at| {
            at.retain(|&place| place >= next);
            at.pop_front()
        });
        let mut own = vec![None; count];
        if let Some(found) = found {
            for (place, strand) in rest.by_ref() {
                if place == found {
                    own = strand;
                    break;
                }
                laid.push(strand);
            }
            next = found + 1;
        }
        own[pass] = Some(ray);
        laid.push(own);
    }
    laid.extend(rest.map(|(_, strand)| strand));
    laid
}

#[cfg(test)]
mod tests {
    use super::*;
    use ambit_base::DVec3;

    fn rays(names: &str, value: f32) -> Vec<TreeRay> {
        let ray = |name: char| {
            let mut answer = Answer::nothing(DVec3::splat(f64::from(u32::from(name))), DVec3::Z);
            answer.value = Rgb::splat(value);
            answer.weight = value;
            TreeRay { depth: 1, answer, contribution: Rgb::splat(value), clear_shadow: false }
        };
        names.chars().map(ray).collect()
    }

    /// Names of the rays, and their values in each pass.
    fn braided(passes: &[&str]) -> (String, Vec<String>) {
        let passes = passes.iter().enumerate().map(|(k, names)| rays(names, k as f32 + 1.0)).collect();
        let (known, lists) = braid(passes);
        let name = |ray: &TreeRay| char::from_u32(ray.answer.origin.x as u32).unwrap();
        let values = |list: &Vec<TreeRay>| list.iter().map(|r| r.answer.value.x.to_string()).collect();
        (known.iter().map(name).collect(), lists.iter().map(values).collect())
    }

    #[test]
    fn what_passes_share_is_one_ray() {
        assert_eq!(braided(&["abcd", "abcd"]), ("abcd".into(), vec!["1111".into(), "2222".into()]));
        assert_eq!(braided(&["abd", "acd"]), ("acbd".into(), vec!["1011".into(), "2202".into()]));
        assert_eq!(braided(&["", "ab"]), ("ab".into(), vec!["00".into(), "22".into()]));
        // Rays that come twice stay two.
        assert_eq!(braided(&["aab", "aac"]), ("aacb".into(), vec!["1101".into(), "2220".into()]));
        let (known, _) = braid(vec![rays("a", 0.5), rays("a", 0.75)]);
        assert_eq!(known[0].answer.weight, 0.75);
    }
}
