//! Memory for the tables that rays jump about in: lists that ask the system for large pages, where it has them.
//!
//! A table of 100 MB takes 25 000 pages of 4 kB, far more than a processor remembers the places of, so that
//! every other step of a diffuse ray would first look up a page. Pages of 2 MB are few enough.
#![allow(unsafe_code)]

/// Below this large pages gain nothing.
const WORTH: usize = 4 << 20;

/// An empty list with room for `capacity` values, on large pages if it is large. To be called before the memory is
/// used: pages that are there already stay as they are.
pub(crate) fn list<T>(capacity: usize) -> Vec<T> {
    let list: Vec<T> = Vec::with_capacity(capacity);
    let bytes = list.capacity() * size_of::<T>();
    if bytes >= WORTH {
        advise(list.as_ptr().cast::<u8>(), bytes);
    }
    list
}

#[cfg(target_os = "linux")]
fn advise(start: *const u8, bytes: usize) {
    use rustix::mm::{Advice, madvise};
    // The pages that lie wholly inside.
    let page = rustix::param::page_size();
    let skip = start.align_offset(page);
    let whole = bytes.saturating_sub(skip) / page * page;
    // SAFETY: the range lies in an allocation of this process, and the advice changes neither what it holds nor how it
    // may be used. A refusal is of no consequence.
    let _ = unsafe { madvise(start.wrapping_add(skip).cast_mut().cast(), whole, Advice::LinuxHugepage) };
}

#[cfg(not(target_os = "linux"))]
fn advise(_: *const u8, _: usize) {}
