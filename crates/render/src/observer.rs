//! Watching rays as they finish.
//!
//! The walk is generic over its observer, so that nothing of this is left in the code that renders pictures: the observer
//! is `()` there, and empty.

use crate::ray::Ray;
use crate::tracer::{Origin, Tracer};
use ambit_ambient::{Query, SampleRay};

/// Sees every ray of a walk.
pub(crate) trait Observer {
    /// True if every ray must be followed as it is: shadow rays too are then shaded where they end.
    const ACTIVE: bool;

    /// A ray has been shaded, but the medium on its way has not been applied to its value.
    fn finished(&mut self, tracer: &Tracer<'_>, ray: &Ray<'_>);

    /// The hemisphere that was sampled for this question to the cache, if it was and has not been taken before.
    fn take_hemisphere(&mut self, query: &Query<Origin>) -> Option<Vec<SampleRay>>;
}

impl Observer for () {
    const ACTIVE: bool = false;

    #[inline(always)]
    fn finished(&mut self, _: &Tracer<'_>, _: &Ray<'_>) {}

    #[expect(clippy::inline_always, reason = "nothing must be left of it")]
    #[inline(always)]
    fn take_hemisphere(&mut self, _: &Query<Origin>) -> Option<Vec<SampleRay>> {
        None
    }
}
