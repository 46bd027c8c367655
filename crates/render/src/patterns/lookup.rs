//! Interpolated data: coordinates that expressions give, tables or a picture, and functions of the values found.

use super::compiler::{Compiler, Functions, Recipe};
use super::evaluate::{Failure, check, finite};
use super::image::Image;
use crate::Error;
use crate::observer::Observer;
use crate::ray::Ray;
use crate::walk::Walk;
use ambit_cal::Pass;
use ambit_scene::{DataTable, MAX_DIMENSIONS, ObjectId, Scene};
use std::sync::Arc;

/// A compiled lookup.
#[derive(Debug)]
pub(crate) struct Lookup {
    /// The coordinates' expressions, then the functions of the values.
    functions: Functions,
    data: Data,
    /// For each function what it is called with.
    feeds: Box<[Feed]>,
}

/// Where values come from.
#[derive(Debug)]
enum Data {
    /// One value each.
    Tables(Box<[Arc<DataTable>]>),
    /// Three values.
    Image(Arc<Image>),
}

/// The arguments of a function of values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Feed {
    /// All three.
    All,
    /// Its own.
    Own,
}

/// Where the parts of a primitive stand among its strings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layout {
    /// The first of the functions' names.
    pub(crate) first_function: usize,
    /// One function or three.
    pub(crate) functions: usize,
    /// The first data file, or the picture. The function file comes after the last one, the coordinates after that.
    pub(crate) first_file: usize,
    /// Number of data files; 0 for a picture.
    pub(crate) tables: usize,
}

impl Layout {
    const fn new(first_function: usize, functions: usize, first_file: usize, tables: usize) -> Self {
        Self { first_function, functions, first_file, tables }
    }

    pub(crate) const BRIGHTDATA: Self = Self::new(0, 1, 1, 1);
    pub(crate) const COLORDATA: Self = Self::new(0, 3, 3, 3);
    pub(crate) const COLORPICT: Self = Self::new(0, 3, 3, 0);
    pub(crate) const TEXDATA: Self = Self::COLORDATA;
    pub(crate) const MIXDATA: Self = Self::new(2, 1, 3, 1);
    pub(crate) const MIXPICT: Self = Self::new(2, 1, 3, 0);
}

/// Coordinates of a picture.
const PICTURE_DIMENSIONS: usize = 2;

impl Lookup {
    /// Compiles the lookup of primitive `id`. With `whole` every function is called with all three values; otherwise
    /// the second and third only if they declare three parameters.
    pub(crate) fn compile(
        scene: &Scene,
        id: ObjectId,
        compiler: &mut Compiler<'_>,
        layout: Layout,
        whole: bool,
    ) -> Result<Self, Error> {
        let name = |i: usize| scene.string(id, i).ok_or_else(|| Error::primitive(scene, id, "bad # arguments"));
        let (data, dimensions) = if layout.tables == 0 {
            let image = compiler.files.image(scene, id, &name(layout.first_file)?)?;
            (Data::Image(image), PICTURE_DIMENSIONS)
        } else {
            let mut tables = Vec::with_capacity(layout.tables);
            for i in 0..layout.tables {
                tables.push(compiler.files.table(scene, id, &name(layout.first_file + i)?)?);
            }
            let dimensions = tables[0].axes().len();
            if tables.iter().any(|t| t.axes().len() != dimensions) {
                return Err(Error::primitive(scene, id, "dimension error"));
            }
            (Data::Tables(tables.into()), dimensions)
        };
        let file = layout.first_file + layout.tables.max(1);
        let coordinates = file + 1;
        if scene.string_count(id) < coordinates + dimensions {
            return Err(Error::primitive(scene, id, "too few string arguments"));
        }
        let single = matches!(data, Data::Tables(_)) && layout.tables == 1;
        let mut feeds = Vec::with_capacity(layout.functions);
        let mut functions = Vec::with_capacity(layout.functions);
        for i in 0..layout.functions {
            let string = layout.first_function + i;
            let all = !single && (whole || i == 0 || compiler.parameters(scene, id, string, file)? >= Some(3));
            feeds.push(if all { Feed::All } else { Feed::Own });
            functions.push((string, if all { 3 } else { 1 }));
        }
        let expressions: Vec<usize> = (coordinates..coordinates + dimensions).collect();
        let recipe =
            Recipe { expressions: &expressions, functions: &functions, file, transform: coordinates + dimensions };
        let functions = compiler.assemble(scene, id, &recipe)?.without_material()?;
        Ok(Self { functions, data, feeds: feeds.into() })
    }

    /// The functions with the frame they are evaluated in.
    pub(crate) fn functions(&self) -> &Functions {
        &self.functions
    }

    fn evaluate(&self, pass: &mut Pass<'_>) -> Result<[f64; 3], Failure> {
        let coordinates = self.functions.programs.len() - self.feeds.len();
        let (coordinates, functions) = self.functions.programs.split_at(coordinates);
        let point = point(pass, coordinates)?;
        let values = match &self.data {
            Data::Image(image) => image.sample(point[0], point[1]),
            Data::Tables(tables) => {
                let mut values = [0.0; 3];
                for (value, table) in values.iter_mut().zip(tables) {
                    *value = table.interpolate(&point);
                }
                values
            }
        };
        let mut results = [0.0; 3];
        for (i, (function, feed)) in functions.iter().zip(&self.feeds).enumerate() {
            results[i] = match feed {
                Feed::All => pass.call(function, &values)?,
                Feed::Own => pass.call(function, &values[i..=i])?,
            };
            check(pass)?;
        }
        finite(results)
    }
}

/// The values of coordinates.
pub(crate) fn point(
    pass: &mut Pass<'_>,
    coordinates: &[Arc<ambit_cal::Program>],
) -> Result<[f64; MAX_DIMENSIONS], Failure> {
    let mut point = [0.0; MAX_DIMENSIONS];
    for (p, program) in point.iter_mut().zip(coordinates) {
        *p = pass.eval(program)?;
        check(pass)?;
        if !p.is_finite() {
            return Err(Failure::NoValue);
        }
    }
    Ok(point)
}

impl<O: Observer> Walk<'_, O> {
    /// Results of the functions of a lookup, as many as it has; None where they have no value.
    pub(crate) fn look_up(&mut self, ray: &Ray<'_>, lookup: &Lookup) -> Option<[f64; 3]> {
        self.evaluate_with(ray, &lookup.functions, |pass| lookup.evaluate(pass))
    }
}
