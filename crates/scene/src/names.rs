//! Modifiers by name, and when a definition merely repeats an older one.

use crate::{Class, Kind, ObjectId, Scene, VOID};
use ambit_base::EPSILON;
use std::collections::{HashMap, HashSet};

/// How many pairs of primitives are compared before two chains of modifiers are called different. The answer only moves
/// a tie-break between coincident surfaces, and no scene but a hostile one has chains as long.
const MAX_COMPARED: usize = 4096;

/// For each name the definitions that count, in reading order.
#[derive(Debug, Default)]
pub(crate) struct Names {
    definitions: HashMap<Box<[u8]>, Vec<ObjectId>>,
}

impl Names {
    /// The definition that counts now.
    pub(crate) fn latest(&self, name: &[u8]) -> Option<ObjectId> {
        self.definitions.get(name)?.last().copied()
    }

    /// The definition that counted when object `before` was read.
    pub(crate) fn before(&self, name: &[u8], before: ObjectId) -> Option<ObjectId> {
        let ids = self.definitions.get(name)?;
        let earlier = ids.partition_point(|&id| id < before);
        earlier.checked_sub(1).map(|i| ids[i])
    }

    /// Adds a definition; objects come in ascending order.
    pub(crate) fn insert(&mut self, name: &[u8], id: ObjectId) {
        match self.definitions.get_mut(name) {
            Some(ids) => ids.push(id),
            None => {
                self.definitions.insert(name.into(), vec![id]);
            }
        }
    }
}

impl Scene {
    /// True if modifier `new` says the same as `old`: same type, same strings, equal numbers and equal modifiers all the
    /// way up, where names among the strings are compared by what they denote. The names themselves do not matter.
    pub(crate) fn is_repeated(&self, new: ObjectId, old: ObjectId) -> bool {
        let mut seen = HashSet::new();
        let mut open = vec![(new, old)];
        while let Some((a, b)) = open.pop() {
            if a == b || !seen.insert((a, b)) {
                continue;
            }
            if a == VOID || b == VOID || seen.len() > MAX_COMPARED {
                return false;
            }
            let (x, y) = (self.object(a), self.object(b));
            let same_counts = self.string_count(a) == self.string_count(b);
            if x.kind != y.kind || !same_counts || !equal_numbers(self.reals(a), self.reals(b)) {
                return false;
            }
            let references = reference_count(x.kind, self.string_count(a));
            for (i, (s, t)) in self.strings_bytes(a).zip(self.strings_bytes(b)).enumerate() {
                if i < references {
                    let denoted = |name, id| self.modifier_before(name, id).unwrap_or(VOID);
                    open.push((denoted(s, a), denoted(t, b)));
                } else if s != t {
                    return false;
                }
            }
            open.push((x.modifier, y.modifier));
        }
        true
    }
}

/// How many of the leading string arguments are names of modifiers.
fn reference_count(kind: Kind, strings: usize) -> usize {
    match kind {
        Kind::Antimatter => strings,
        Kind::Alias | Kind::Illum | Kind::Mirror => 1,
        _ if kind.class() == Class::Mixture => 2,
        _ => 0,
    }
}

/// Equal to a relative [`EPSILON`] of the old number; where that is zero, to an absolute one.
fn equal_numbers(new: &[f64], old: &[f64]) -> bool {
    let equal =
        |(&a, &b): (&f64, &f64)| a == b || if b == 0.0 { a.abs() <= EPSILON } else { (1.0 - a / b).abs() <= EPSILON };
    new.len() == old.len() && new.iter().zip(old).all(equal)
}
