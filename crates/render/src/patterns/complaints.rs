//! Modifiers that had no value on some ray, or no frame: noted from any thread without a lock, told between batches, each once.

use ambit_scene::ObjectId;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};

/// Nothing happened.
const QUIET: u8 = 0;
/// An evaluation failed, and nobody has been told.
const RAISED: u8 = 1;
/// The user knows.
const TOLD: u8 = 2;
/// An up vector was parallel to the normal, and nobody has been told.
const UPRIGHT: u8 = 3;

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
        self.note(id, RAISED);
    }

    /// Notes that the up vector of primitive `id` gives no frame.
    pub(crate) fn raise_orientation(&self, id: ObjectId) {
        self.note(id, UPRIGHT);
    }

    fn note(&self, id: ObjectId, what: u8) {
        let Some(mark) = self.marks.get(id as usize) else { return };
        if mark.load(Ordering::Relaxed) == QUIET {
            mark.store(what, Ordering::Relaxed);
            self.pending.store(true, Ordering::Release);
        }
    }

    /// Calls `tell` with what was raised since the last call, in the order of the scene. No ray may be under way.
    pub(crate) fn drain(&self, mut tell: impl FnMut(&str, ObjectId)) {
        if !self.pending.swap(false, Ordering::AcqRel) {
            return;
        }
        for (id, mark) in (0..).zip(&self.marks) {
            let text = match mark.load(Ordering::Relaxed) {
                RAISED => "compute error",
                UPRIGHT => "Illegal orientation vector",
                _ => continue,
            };
            mark.store(TOLD, Ordering::Relaxed);
            tell(text, id);
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
            complaints.drain(|_, id| ids.push(id));
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
