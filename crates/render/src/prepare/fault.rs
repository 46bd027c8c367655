//! The first error of a calculation, kept until the batch ends.

use crate::Error;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// A place for one error; rays that meet one go on black until the batch is over.
#[derive(Debug, Default)]
pub(crate) struct Fault {
    raised: AtomicBool,
    error: Mutex<Option<Error>>,
}

impl Fault {
    /// Keeps `error` if it is the first.
    pub(crate) fn set(&self, error: Error) {
        if !self.raised.swap(true, Ordering::AcqRel) {
            *self.error.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
        }
    }

    /// True if there was an error.
    pub(crate) fn is_set(&self) -> bool {
        self.raised.load(Ordering::Acquire)
    }

    /// The error, if there was one.
    pub(crate) fn take(&self) -> Option<Error> {
        if !self.raised.load(Ordering::Acquire) {
            return None;
        }
        self.error.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}
