//! Records: the fields of an answer in the format that is wanted.

use crate::colour::Conversion;
use crate::quantity::push_exponent;
use ambit_base::{DVec3, FAR, Rgb};
use ambit_cli::{Field, OutputFormat};
use ambit_file::encode_pixel;
use ambit_render::{Answer, Names};
use ambit_scene::VOID;

/// Writes records.
pub(crate) struct RecordWriter<'a> {
    fields: &'a [Field],
    conversion: Conversion,
    format: OutputFormat,
}

impl<'a> RecordWriter<'a> {
    /// Records of these fields.
    pub(crate) fn new(fields: &'a [Field], conversion: Conversion, format: OutputFormat) -> Self {
        Self { fields, conversion, format }
    }

    /// Appends the record of an answer.
    pub(crate) fn write(&self, out: &mut Vec<u8>, answer: &Answer, names: Names<'_>) {
        self.write_with(out, answer, answer.value, names);
    }

    /// As [`Self::write`], for a ray that brings `contribution` to the primary ray.
    pub(crate) fn write_with(&self, out: &mut Vec<u8>, answer: &Answer, contribution: Rgb, names: Names<'_>) {
        // A ray that met nothing has no names; a surface without a modifier has a void one.
        let name = |out: &mut Vec<u8>, id| {
            if answer.surface == VOID {
                out.push(b'*');
            } else {
                out.extend_from_slice(names(id).as_bytes());
            }
            out.push(b'\t');
        };
        for field in self.fields {
            match field {
                Field::Origin => self.vector(out, answer.origin),
                Field::Direction => self.vector(out, answer.direction),
                Field::Value => self.colour(out, answer.value),
                Field::Contribution => self.colour(out, contribution),
                Field::Weight => self.number(out, f64::from(answer.weight)),
                Field::Coefficient => self.colour(out, answer.coefficient),
                Field::Length => self.number(out, answer.length),
                Field::FirstLength => self.number(out, answer.first_length),
                Field::Coordinates => answer.uv.iter().for_each(|&x| self.number(out, x)),
                Field::Point => self.vector(out, answer.point),
                Field::Normal => self.vector(out, answer.normal),
                Field::GeometricNormal => self.vector(out, answer.geometric_normal),
                Field::Surface => name(out, answer.surface),
                Field::Modifier => name(out, answer.modifier),
                Field::Material => name(out, answer.material),
                Field::Mirrored => self.colour(out, answer.mirrored),
                Field::Unmirrored => self.colour(out, answer.value - answer.mirrored),
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
        self.write(out, &Answer::nothing(origin, direction), names);
    }

    fn vector(&self, out: &mut Vec<u8>, v: DVec3) {
        for x in v.to_array() {
            self.number(out, x);
        }
    }

    fn colour(&self, out: &mut Vec<u8>, colour: Rgb) {
        let c = self.conversion.apply(colour);
        if self.format == OutputFormat::Colour {
            out.extend_from_slice(&encode_pixel(c));
            return;
        }
        for &x in &c.to_array()[..self.conversion.channels()] {
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
