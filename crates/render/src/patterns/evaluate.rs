//! Runs the programs of a modifier on a ray. Arithmetic that fails leaves a modifier without effect on this ray and is
//! told once; what Radiance ends the run for is an error.

use super::compiler::Functions;
use crate::Error;
use crate::observer::Observer;
use crate::ray::Ray;
use crate::walk::Walk;
use ambit_cal::{Fault, Flag, Inputs, Pass};
use ambit_scene::ObjectId;

/// Why a modifier has no value here.
#[derive(Debug)]
pub(crate) enum Failure {
    /// An operation failed, or the result is not finite.
    NoValue,
    /// The run ends.
    Fault(Fault),
}

impl From<Fault> for Failure {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

/// [`Failure::NoValue`] if the last operations failed.
pub(crate) fn check(pass: &Pass<'_>) -> Result<(), Failure> {
    if pass.flag() == Flag::Clear { Ok(()) } else { Err(Failure::NoValue) }
}

impl<O: Observer> Walk<'_, O> {
    /// Evaluates programs of `functions` at the hit of `ray` as `f` says; None where there is no value.
    pub(crate) fn evaluate_with<R>(
        &mut self,
        ray: &Ray<'_>,
        functions: &Functions,
        f: impl FnOnce(&mut Pass<'_>) -> Result<R, Failure>,
    ) -> Option<R> {
        let channels = self.channels(ray, functions);
        let mut pass = self.work.cal.pass(Inputs { channels: &channels, reals: &functions.reals });
        let made = f(&mut pass).and_then(|value| check(&pass).map(|()| value));
        match made {
            Ok(value) => Some(value),
            Err(Failure::NoValue) => {
                self.tracer.scene.complaints.raise(functions.owner);
                None
            }
            Err(Failure::Fault(fault)) => {
                self.evaluation_failed(&fault, functions.owner);
                None
            }
        }
    }

    /// Values of three expressions, or of one expression three times; None where they have none. They are evaluated
    /// from the last to the first and only what the last operation leaves is looked at, as in Radiance.
    pub(crate) fn three(&mut self, ray: &Ray<'_>, functions: &Functions) -> Option<[f64; 3]> {
        self.evaluate_with(ray, functions, |pass| {
            let mut values = [0.0; 3];
            for (value, program) in values.iter_mut().zip(&functions.programs).rev() {
                *value = pass.eval(program)?;
            }
            if functions.programs.len() == 1 {
                values = [values[0]; 3];
            }
            finite(values)
        })
    }

    /// Values of three expressions of which none may fail.
    pub(crate) fn vector(&mut self, ray: &Ray<'_>, functions: &Functions) -> Option<[f64; 3]> {
        self.evaluate_with(ray, functions, |pass| {
            let mut values = [0.0; 3];
            for (value, program) in values.iter_mut().zip(&functions.programs) {
                *value = pass.eval(program)?;
                check(pass)?;
            }
            finite(values)
        })
    }

    /// Ends the run for a fault in the functions of primitive `id`.
    pub(crate) fn evaluation_failed(&self, fault: &Fault, id: ObjectId) {
        let scene = &self.tracer.scene.objects;
        self.fail(match fault {
            Fault::MissingReal(_) | Fault::MissingReals => Error::primitive(scene, id, &fault.to_string()),
            _ => Error::at(scene, id, fault.to_string()),
        });
    }
}

/// Keeps infinities and what is no number out of colours and normals.
pub(crate) fn finite(values: [f64; 3]) -> Result<[f64; 3], Failure> {
    if values.iter().all(|v| v.is_finite()) { Ok(values) } else { Err(Failure::NoValue) }
}
