//! Spectral patterns: spectrum and specfile, which are the same everywhere, and specfunc, specdata
//! and specpict, whose spectra a function file shapes.

use super::compiler::{Compiler, Functions, Recipe};
use super::evaluate::{Failure, check};
use super::folding::{Folding, Layout, MAX_BANDS};
use super::lookup::point;
use super::pattern::Pattern;
use super::spectral_image::SpectralImage;
use crate::Error;
use crate::observer::Observer;
use crate::ray::Ray;
use crate::walk::Walk;
use ambit_base::Rgb;
use ambit_cal::Pass;
use ambit_scene::{Axis, DataTable, Kind, ObjectId, Scene};
use std::sync::Arc;

/// A spectrum that varies.
#[derive(Debug)]
pub(crate) struct Spectral {
    /// Coordinates, then the function of (value and) wavelength.
    functions: Functions,
    /// One a pass.
    foldings: Box<[Folding]>,
    data: Data,
}

/// Where the function's values come from.
#[derive(Debug)]
enum Data {
    /// specfunc: nowhere; the wavelengths.
    None(Box<[f64]>),
    /// specdata: a table whose last axis is the wavelength, and the points of that axis.
    Table(Arc<DataTable>, Box<[f64]>),
    /// specpict.
    Image(Arc<SpectralImage>),
}

/// spectrum: its values stand in the scene.
pub(crate) fn spectrum(scene: &Scene, id: ObjectId, compiler: &Compiler<'_>) -> Result<Pattern, Error> {
    let [first, last, values @ ..] = scene.reals(id) else {
        return Err(Error::primitive(scene, id, "bad # arguments"));
    };
    // Below 0 nm, too, as ranges that end there are only far too wide.
    if first == last {
        return Err(Error::primitive(scene, id, "bad wavelength limits"));
    }
    Ok(constant(&Layout::even(*first, *last, values.len()), values, compiler))
}

/// specfile: its values stand in a data file.
pub(crate) fn specfile(scene: &Scene, id: ObjectId, compiler: &mut Compiler<'_>) -> Result<Pattern, Error> {
    let name = scene.string(id, 0).unwrap_or_default();
    let table = compiler.files.table(scene, id, &name)?;
    let [axis] = table.axes() else {
        return Err(Error::primitive(scene, id, "data file must be 1-dimensional"));
    };
    let values: Vec<f64> = table.values().iter().map(|&v| f64::from(v)).collect();
    Ok(constant(&axis_layout(axis), &values, compiler))
}

/// A spectrum that is the same everywhere.
fn constant(layout: &Layout, values: &[f64], compiler: &Compiler<'_>) -> Pattern {
    let fold = |folding: &Folding| folding.fold(values.iter().copied());
    match &*layout.foldings(&compiler.spectrum) {
        [one] => Pattern::Constant(fold(one)),
        passes => Pattern::Constants(passes.iter().map(fold).collect()),
    }
}

/// Where values at the points of a wavelength axis lie.
fn axis_layout(axis: &Axis) -> Layout {
    match &axis.points {
        None => Layout::even(f64::from(axis.begin), f64::from(axis.end), axis.count),
        Some(points) => Layout::uneven(&points.iter().map(|&p| f64::from(p)).collect::<Vec<_>>()),
    }
}

/// Wavelengths at which a table is looked up along its last axis: as many as it has points, but evenly spaced whatever
/// these are. So Radiance does.
fn sampled_axis(axis: &Axis) -> (Layout, Box<[f64]>) {
    let (a, b) = (f64::from(axis.begin), f64::from(axis.end));
    let wavelengths = (0..axis.count).map(|i| a + (b - a) * (i as f64 / (axis.count - 1) as f64)).collect();
    (Layout::even(a, b, axis.count), wavelengths)
}

impl Spectral {
    /// Compiles specfunc, specdata or specpict.
    pub(crate) fn compile(scene: &Scene, id: ObjectId, compiler: &mut Compiler<'_>) -> Result<Pattern, Error> {
        let spectrum = compiler.spectrum;
        let (coordinates, file, layout, data) = match scene.object(id).kind {
            Kind::SpecFunc => {
                let r = scene.reals(id);
                let (shortest, longest) = (r[0].min(r[1]), r[0].max(r[1]));
                let [red, .., blue] = spectrum.limits();
                if !(shortest < red && longest > blue && longest > shortest) {
                    compiler.warn(&format!("incompatible wavelength sampling for {}", scene.describe(id)));
                    return Ok(Pattern::Constant(Rgb::ONE));
                }
                let (layout, wavelengths) = Layout::sampled(longest.min(red), shortest.max(blue), &spectrum);
                (0, 1, layout, Data::None(wavelengths))
            }
            Kind::SpecData => {
                let table = compiler.files.table(scene, id, &scene.string(id, 1).unwrap_or_default())?;
                let axes = table.axes();
                let [_, .., last] = axes else {
                    return Err(Error::primitive(scene, id, "need at least 2-dimensional data"));
                };
                let (layout, wavelengths) = sampled_axis(last);
                (axes.len() - 1, 2, layout, Data::Table(table, wavelengths))
            }
            _ => {
                let image = compiler.files.spectral_image(scene, id, &scene.string(id, 1).unwrap_or_default())?;
                (2, 2, image.layout(), Data::Image(image))
            }
        };
        if scene.string_count(id) < file + 1 + coordinates {
            return Err(Error::primitive(scene, id, "too few string arguments"));
        }
        let expressions: Vec<usize> = (file + 1..file + 1 + coordinates).collect();
        let arguments = if matches!(data, Data::None(_)) { 1 } else { 2 };
        let recipe =
            Recipe { expressions: &expressions, functions: &[(0, arguments)], file, transform: file + 1 + coordinates };
        let functions = compiler.assemble(scene, id, &recipe)?.without_material()?;
        Ok(Pattern::Spectral(Self { functions, foldings: layout.foldings(&spectrum), data }.into()))
    }

    fn evaluate(&self, folding: &Folding, pass: &mut Pass<'_>) -> Result<Rgb, Failure> {
        let Some((function, coordinates)) = self.functions.programs.split_last() else {
            return Err(Failure::NoValue);
        };
        let mut point = point(pass, coordinates)?;
        let mut failure = None;
        let mut call = |arguments: &[f64]| match pass.call(function, arguments) {
            Ok(value) => {
                if let Err(e) = check(pass) {
                    failure = Some(e);
                }
                value
            }
            Err(fault) => {
                failure = Some(fault.into());
                0.0
            }
        };
        let folded = match &self.data {
            Data::None(wavelengths) => folding.fold(wavelengths.iter().map(|&nm| call(&[nm]))),
            Data::Table(table, wavelengths) => folding.fold(wavelengths.iter().map(|&nm| {
                point[coordinates.len()] = nm;
                call(&[table.interpolate(&point), nm])
            })),
            Data::Image(image) => {
                let mut values = [0.0; MAX_BANDS];
                image.sample(point[0], point[1], &mut values);
                let bands = values.iter().enumerate().take(image.bands());
                folding.fold(bands.map(|(i, &v)| call(&[v, image.wavelength(i)])))
            }
        };
        match failure {
            Some(failure) => Err(failure),
            None if folded.is_finite() => Ok(folded),
            None => Err(Failure::NoValue),
        }
    }
}

impl<O: Observer> Walk<'_, O> {
    /// The three channels of a spectral pattern in this pass; None where it has no value.
    pub(crate) fn spectral(&mut self, ray: &Ray<'_>, spectral: &Spectral) -> Option<Rgb> {
        let folding = &spectral.foldings[usize::from(self.pass)];
        self.evaluate_with(ray, &spectral.functions, |pass| spectral.evaluate(folding, pass))
    }
}
