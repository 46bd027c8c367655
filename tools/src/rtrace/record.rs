//! Records: the fields of an answer in the format that is wanted.

use crate::quantity::push_exponent;
use crate::spectral::{Channels, Converter};
use ambit_base::{DVec3, FAR, Rgb};
use ambit_cli::{Field, OutputFormat, RayOptions};
use ambit_file::encode_spectrum;
use ambit_render::{Answer, Bins, Names, Spectra, Spectrum};
use ambit_scene::VOID;

/// Writes records.
pub(crate) struct RecordWriter<'a> {
    fields: &'a [Field],
    conversion: &'a Converter,
    /// Of shares of light (`W`).
    shares: Converter,
    format: OutputFormat,
}

impl<'a> RecordWriter<'a> {
    /// Records of these fields.
    pub(crate) fn new(fields: &'a [Field], conversion: &'a Converter, options: &RayOptions) -> Self {
        Self { fields, conversion, shares: conversion.of_shares(options.common.output), format: options.format }
    }

    /// Appends the records of a batch, with its spectra if the calculation is by wavelength.
    pub(crate) fn write_all(&self, out: &mut Vec<u8>, answers: &[Answer], spectra: Option<&Spectra>, names: Names<'_>) {
        for (i, answer) in answers.iter().enumerate() {
            self.write_bins(out, answer, answer.value, spectra.map(|s| s.bins(i)), names);
        }
    }

    /// Appends the record of a ray that brings `contribution` to the primary ray, or its bins if the calculation is by
    /// wavelength.
    pub(crate) fn write_bins(
        &self,
        out: &mut Vec<u8>,
        answer: &Answer,
        contribution: Rgb,
        bins: Option<Bins<'_>>,
        names: Names<'_>,
    ) {
        // A ray that met nothing has no names; a surface without a modifier has a void one.
        let name = |out: &mut Vec<u8>, id| {
            if answer.surface == VOID {
                out.push(b'*');
            } else {
                out.extend_from_slice(names(id, answer.modifier));
            }
            out.push(b'\t');
        };
        for field in self.fields {
            match field {
                Field::Origin => self.vector(out, answer.origin),
                Field::Direction => self.vector(out, answer.direction),
                Field::Value => self.light(out, answer.value, bins.map(|b| b.value)),
                Field::Contribution => self.light(out, contribution, bins.map(|b| b.contribution)),
                Field::Weight => self.number(out, f64::from(answer.weight)),
                Field::Coefficient => {
                    self.colour(out, &self.shares, answer.coefficient, bins.map(|b| b.coefficient));
                }
                Field::Length => self.number(out, answer.length),
                Field::FirstLength => self.number(out, answer.first_length),
                Field::Coordinates => answer.uv.iter().for_each(|&x| self.number(out, x)),
                Field::Point => self.vector(out, answer.point),
                Field::Normal => self.vector(out, answer.normal),
                Field::GeometricNormal => self.vector(out, answer.geometric_normal),
                Field::Surface => name(out, answer.surface),
                Field::Modifier => name(out, answer.modifier),
                Field::Material => name(out, answer.material),
                Field::Mirrored => self.light(out, answer.mirrored, bins.map(|b| b.mirrored)),
                Field::Unmirrored => match bins {
                    Some(b) => {
                        let mut rest = Channels::default();
                        rest.iter_mut().zip(b.value.iter().zip(b.mirrored)).for_each(|(r, (v, m))| *r = v - m);
                        self.light(out, Rgb::ZERO, Some(&rest[..b.value.len()]));
                    }
                    None => self.light(out, answer.value - answer.mirrored, None),
                },
                Field::MirroredLength => self.number(out, answer.mirrored_length),
                Field::UnmirroredLength => self.number(out, answer.unmirrored_length),
                Field::Tilde => out.extend_from_slice(b"~\t"),
            }
        }
        if self.format == OutputFormat::Ascii && !self.fields.is_empty() {
            out.push(b'\n');
        }
    }

    /// The record that stands for a ray without direction: black and nowhere, but for the ray before it.
    pub(crate) fn write_bogus(&self, out: &mut Vec<u8>, (origin, direction): (DVec3, DVec3), names: Names<'_>) {
        let (zero, one) = ([0.0; Spectrum::MOST], [1.0; Spectrum::MOST]);
        let bins = match self.conversion {
            Converter::Rgb(_) => None,
            Converter::Spectral(_) => {
                Some(Bins { value: &zero, contribution: &zero, mirrored: &zero, coefficient: &one })
            }
        };
        let answer = Answer::nothing(origin, direction);
        self.write_bins(out, &answer, answer.value, bins, names);
    }

    fn vector(&self, out: &mut Vec<u8>, v: DVec3) {
        for x in v.to_array() {
            self.number(out, x);
        }
    }

    /// Light, or in a calculation by wavelength its `bins`.
    fn light(&self, out: &mut Vec<u8>, colour: Rgb, bins: Option<&[f32]>) {
        self.colour(out, self.conversion, colour, bins);
    }

    /// A colour as it is written.
    fn colour(&self, out: &mut Vec<u8>, conversion: &Converter, colour: Rgb, bins: Option<&[f32]>) {
        let mut made = Channels::default();
        let count = match (conversion, bins) {
            (Converter::Spectral(conversion), Some(bins)) => conversion.apply(bins, &mut made).len(),
            (Converter::Rgb(conversion), _) => {
                made[..3].copy_from_slice(&conversion.apply(colour).to_array());
                conversion.channels()
            }
            (Converter::Spectral(_), None) => 0,
        };
        self.channels(out, &made[..count]);
    }

    fn channels(&self, out: &mut Vec<u8>, channels: &[f32]) {
        if self.format == OutputFormat::Colour {
            let start = out.len();
            out.resize(start + channels.len() + 1, 0);
            encode_spectrum(channels, &mut out[start..]);
            return;
        }
        for &x in channels {
            self.number(out, f64::from(x));
        }
    }

    fn number(&self, out: &mut Vec<u8>, x: f64) {
        let x = if x.is_finite() { x } else { FAR };
        match self.format {
            OutputFormat::Ascii => {
                push_exponent(out, x);
                out.push(b'\t');
            }
            OutputFormat::Double => out.extend_from_slice(&x.to_ne_bytes()),
            OutputFormat::Float | OutputFormat::Colour => out.extend_from_slice(&(x as f32).to_ne_bytes()),
        }
    }
}
