//! Patterns: factors on the colour.

use super::compiler::{Compiler, Functions};
use crate::Error;
use crate::materials::Finish;
use crate::ray::Ray;
use crate::walk::Walk;
use ambit_base::Rgb;
use ambit_cal::Inputs;
use ambit_scene::{Kind, ObjectId, Scene};

/// A compiled pattern.
#[derive(Debug)]
pub(crate) enum Pattern {
    /// brightfunc, colorfunc: one expression for all channels, or one for each.
    Function(Functions),
}

impl Pattern {
    pub(crate) fn compile(scene: &Scene, id: ObjectId, compiler: &mut Compiler<'_>) -> Result<Self, Error> {
        match scene.object(id).kind {
            Kind::BrightFunc => Ok(Self::Function(compiler.functions(scene, id, &[0], 1)?)),
            Kind::ColorFunc => Ok(Self::Function(compiler.functions(scene, id, &[0, 1, 2], 3)?)),
            _ => Err(Error::unsupported(scene, id)),
        }
    }
}

impl Walk<'_> {
    /// Multiplies the colour by a pattern; one that has no value here leaves it alone.
    pub(crate) fn apply_pattern(&mut self, ray: &Ray<'_>, pattern: &Pattern, finish: &mut Finish) {
        match pattern {
            Pattern::Function(functions) => {
                if let Some([r, g, b]) = self.three(ray, functions) {
                    finish.pattern *= Rgb::new(r as f32, g as f32, b as f32);
                }
            }
        }
    }

    /// Values of three expressions, or of one expression three times; None where one is undefined.
    pub(crate) fn three(&mut self, ray: &Ray<'_>, functions: &Functions) -> Option<[f64; 3]> {
        let channels = self.channels(ray, functions);
        let mut pass = self.work.cal.pass(Inputs { channels: &channels, reals: &functions.reals });
        let mut values = [0.0; 3];
        let mut fault = None;
        for (value, program) in values.iter_mut().zip(&functions.programs) {
            match pass.eval(program) {
                Ok(v) if v.is_finite() => *value = v,
                Ok(_) => return None,
                Err(f) => {
                    fault = Some(f);
                    break;
                }
            }
        }
        if let Some(f) = fault {
            self.evaluation_failed(&f);
            return None;
        }
        if functions.programs.len() == 1 {
            values = [values[0]; 3];
        }
        Some(values)
    }

    /// A fault that ends the calculation, unless it is one that only leaves the modifier without effect.
    pub(crate) fn evaluation_failed(&self, fault: &ambit_cal::Fault) {
        self.fail(Error::user(fault.to_string()));
    }
}
