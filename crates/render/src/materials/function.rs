//! plasfunc, metfunc, transfunc and their data types: the specular lobe is a function of the direction to the light, and
//! of measured data. It counts for direct light only; opaque to shadow rays.

use super::{Finish, NormalKind};
use crate::Error;
use crate::observer::Observer;
use crate::patterns::{Compiler, Functions, Recipe};
use crate::ray::Ray;
use crate::walk::Walk;
use ambit_base::{EPSILON, Rgb};
use ambit_scene::{DataTable, Kind, MAX_DIMENSIONS, ObjectId, Scene};
use std::f64::consts::PI;
use std::sync::Arc;

/// Arguments of a material with a lobe by function.
#[derive(Debug)]
pub(crate) struct FunctionMaterial {
    kind: NormalKind,
    colour: Rgb,
    specular: f64,
    transmission: f64,
    transmitted_specular: f64,
    /// The lobe, then the table's coordinates.
    functions: Functions,
    table: Option<Arc<DataTable>>,
}

impl FunctionMaterial {
    pub(crate) fn compile(scene: &Scene, id: ObjectId, compiler: &mut Compiler<'_>) -> Result<Self, Error> {
        use NormalKind::{Metal, Plastic, Trans};
        scene.check_arguments(id)?;
        let (kind, by_data) = match scene.object(id).kind {
            Kind::PlasFunc => (Plastic, false),
            Kind::MetFunc => (Metal, false),
            Kind::TransFunc => (Trans, false),
            Kind::PlasData => (Plastic, true),
            Kind::MetData => (Metal, true),
            _ => (Trans, true),
        };
        let r = scene.reals(id);
        let file = if by_data { 2 } else { 1 };
        let mut called = vec![(0, if by_data { 5 } else { 4 })];
        let table = if by_data {
            Some(compiler.files.table(scene, id, &scene.string(id, 1).unwrap_or_default())?)
        } else {
            None
        };
        if let Some(table) = &table {
            let first = file + 1;
            let last = first + table.axes().len();
            if scene.string_count(id) < last {
                return Err(Error::primitive(scene, id, "bad # arguments"));
            }
            called.extend((first..last).map(|i| (i, 4)));
        }
        let recipe = Recipe { expressions: &[], functions: &called, file, transform: file + called.len() };
        let functions = compiler.assemble(scene, id, &recipe)?;
        let trans = |i: usize| if kind == Trans { r[i] } else { 0.0 };
        Ok(Self {
            kind,
            colour: Rgb::new(r[0] as f32, r[1] as f32, r[2] as f32),
            specular: r[3],
            transmission: trans(4),
            transmitted_specular: trans(5),
            functions,
            table,
        })
    }
}

impl<O: Observer> Walk<'_, O> {
    pub(crate) fn function_material(&mut self, ray: &mut Ray<'_>, m: &FunctionMaterial, finish: Finish) -> bool {
        if ray.is_shadow() {
            return true;
        }
        let Some(facing) = self.visible_side(ray, finish.tilt) else { return false };
        let colour = m.colour * finish.pattern;
        let through = m.transmission * (1.0 - m.specular);
        let through_specular = m.transmitted_specular * through;
        let through_diffuse = through - through_specular;
        let diffuse = 1.0 - through - m.specular;
        self.ambient(ray, colour * (1.0 - through).max(0.0) as f32, facing.normal);
        if through > EPSILON {
            self.ambient(ray, colour * through as f32, -facing.normal);
        }

        let functions = &m.functions;
        let channels = self.turned_channels(ray, functions, &facing, colour);
        let frame = self.function_frame(ray, &functions.placement);
        self.direct_with(ray, None, |walk, l, omega| {
            let lambda = facing.normal.dot(l);
            let behind = lambda < 0.0;
            if lambda.abs() <= EPSILON || (behind && through <= EPSILON) || (!behind && through >= 1.0 - EPSILON) {
                return Rgb::ZERO;
            }
            let (spread, lobe, tinted) = if behind {
                (through_diffuse, through_specular, m.kind == NormalKind::Trans)
            } else {
                (diffuse, m.specular, m.kind == NormalKind::Metal)
            };
            let reach = lambda.abs() * omega;
            let mut sum = Rgb::ZERO;
            if spread > EPSILON {
                sum += colour * (spread * reach / PI) as f32;
            }
            if lobe > EPSILON {
                let at = frame.direction_back(l);
                let arguments = [at.x, at.y, at.z, omega];
                let value = walk.run(&channels, functions, |pass| {
                    let Some(table) = &m.table else { return Ok([pass.call(&functions.programs[0], &arguments)?]) };
                    let mut point = [0.0; MAX_DIMENSIONS];
                    for (x, program) in point.iter_mut().zip(&functions.programs[1..]) {
                        *x = pass.call(program, &arguments)?;
                    }
                    let data = table.interpolate(&point);
                    Ok([pass.call(&functions.programs[0], &[data, at.x, at.y, at.z, omega])?])
                });
                if let Some([value]) = value
                    && value > EPSILON
                {
                    let tint = if tinted { colour } else { Rgb::ONE };
                    sum += tint * (value * lobe * reach) as f32;
                }
            }
            sum
        });
        true
    }
}
