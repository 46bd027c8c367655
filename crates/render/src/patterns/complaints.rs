//! Modifiers that had no value on some ray: noted from any thread without a lock, told between batches, each once.

use ambit_scene::ObjectId;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};

/// Nothing happened.
const QUIET: u8 = 0;
/// An evaluation failed, and nobody has been told.
const RAISED: u8 = 1;
/// The user knows.
const TOLD: u8 = 2;

/// One mark for each primitive.
#[derive(Debug, Default)]
pub(crate) struct Complaints {
    marks: Box<[AtomicU8]>,
    pending: AtomicBool,
}

impl Complaints {
    /// Marks for `count` primitives.
    pub(crate) fn new(count: usize) -> Self {
        Self { marks: (0..count).map(|_| AtomicU8::new(QUIET)).collect(), pending: AtomicBool::new(false) }
    }

    /// Notes that primitive `id` had no value.
    pub(crate) fn raise(&self, id: ObjectId) {
        let Some(mark) = self.marks.get(id as usize) else { return };
        if mark.load(Ordering::Relaxed) == QUIET {
            mark.store(RAISED, Ordering::Relaxed);
            self.pending.store(true, Ordering::Release);
        }
    }

    /// Calls `tell` for those raised since the last call, in the order of the scene. No ray may be under way.
    pub(crate) fn drain(&self, mut tell: impl FnMut(ObjectId)) {
        if !self.pending.swap(false, Ordering::AcqRel) {
            return;
        }
        for (id, mark) in (0..).zip(&self.marks) {
            if mark.load(Ordering::Relaxed) == RAISED {
                mark.store(TOLD, Ordering::Relaxed);
                tell(id);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_told_once_and_in_order() {
        let complaints = Complaints::new(4);
        let told = || {
            let mut ids = Vec::new();
            complaints.drain(|id| ids.push(id));
            ids
        };
        assert!(told().is_empty());
        for id in [3, 1, 3, 9] {
            complaints.raise(id);
        }
        assert_eq!(told(), [1, 3]);
        complaints.raise(1);
        complaints.raise(0);
        assert_eq!(told(), [0]);
        assert!(told().is_empty());
    }
}
