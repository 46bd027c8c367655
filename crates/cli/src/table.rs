//! One row a option: its flag, what follows it, where the value goes, what `-defaults` prints, and its help text.
//!
//! Rows are generic over the parameters `S` of a program; a part that programs share is reached through
//! [`Carries`](crate::Carries).

use crate::failure::Failure;
use crate::outside::Outside;
use ambit_base::{DVec3, Rgb};
use ambit_file::exponent;

/// An option.
pub struct Row<S> {
    /// The flag without its dash.
    pub flag: &'static str,
    /// What follows, and where it goes.
    pub place: Place<S>,
    /// What `-defaults` prints.
    pub label: Label<S>,
    /// True if `-defaults` leaves it out at present.
    pub hidden: fn(&mut S) -> bool,
    /// Names of the values, for `--help`.
    pub values: &'static str,
    /// What it is for, for `--help`.
    pub help: &'static str,
}

/// What follows a flag, and where it goes.
pub enum Place<S> {
    /// Nothing.
    Bare(fn(&mut S)),
    /// Nothing, or glued to it `+ 1 - 0`; alone it toggles.
    Switch(fn(&mut S) -> &mut bool),
    /// The same, kept otherwise: how it stands, and how it is set.
    Toggle(fn(&S) -> bool, fn(&mut S, bool)),
    /// A word glued to it that the first function accepts.
    Glued(fn(&str) -> bool, fn(&mut S, &str) -> Result<(), Failure>),
    /// An integer.
    Integer(fn(&mut S) -> &mut i32),
    /// An integer that is looked at.
    Whole(fn(&mut S, i32) -> Result<(), Failure>),
    /// A number of 64 bits (`--seed`).
    Seed(fn(&mut S) -> &mut u64),
    /// A real number.
    Real(fn(&mut S) -> &mut f64),
    /// Three real numbers.
    Vector(fn(&mut S) -> &mut DVec3),
    /// Three real numbers, a colour.
    Colour(fn(&mut S) -> &mut Rgb),
    /// Several real numbers that are looked at.
    Reals(usize, fn(&mut S, &[f64]) -> Result<(), Failure>),
    /// A word.
    Text(fn(&mut S) -> &mut Option<String>),
    /// A word that is looked at.
    Word(fn(&mut S, String, &dyn Outside) -> Result<(), Failure>),
    /// A word and up to so many integers.
    WordAndIntegers(usize, fn(&mut S, String, &[i32]) -> Result<(), Failure>),
}

/// What `-defaults` prints for an option: the value, padded by tabs to the fifth stop, and a comment.
pub enum Label<S = ()> {
    /// Nothing.
    Absent,
    /// The value as its kind prints, and this comment; a switch adds ` on` or ` off`.
    OnOff(&'static str),
    /// The value as its kind prints, and this comment.
    Plain(&'static str),
    /// As `Plain`, with two blanks after the flag.
    Wide(&'static str),
    /// As `Plain`, in exponential form.
    Tiny(&'static str),
    /// A line of its own.
    Own(fn(&mut S) -> String),
}

impl Label {
    /// A text, so many tabs, and a comment.
    pub(crate) fn tabs(text: &str, tabs: usize, comment: &str) -> String {
        format!("{text}{}# {comment}", "\t".repeat(tabs))
    }
}

impl<S> Row<S> {
    /// A row that `-defaults` does not print.
    pub const fn new(flag: &'static str, place: Place<S>, help: &'static str) -> Self {
        Self { flag, place, label: Label::Absent, hidden: |_| false, values: "", help }
    }

    /// What `-defaults` prints.
    #[must_use]
    pub fn shown(self, label: Label<S>) -> Self {
        Self { label, ..self }
    }

    /// When `-defaults` does not print it after all.
    #[must_use]
    pub fn hidden_if(self, hidden: fn(&mut S) -> bool) -> Self {
        Self { hidden, ..self }
    }

    /// Names the values.
    #[must_use]
    pub fn values(self, values: &'static str) -> Self {
        Self { values, ..self }
    }

    /// The line of `-defaults`, without newline.
    pub fn line(&self, settings: &mut S) -> Option<String> {
        if (self.hidden)(settings) {
            return None;
        }
        let (gap, comment, tiny) = match self.label {
            Label::Absent => return None,
            Label::Own(line) => return Some(line(settings)),
            Label::OnOff(comment) | Label::Plain(comment) => (" ", comment, false),
            Label::Wide(comment) => ("  ", comment, false),
            Label::Tiny(comment) => (" ", comment, true),
        };
        let flag = self.flag;
        let number = |x: f64| if tiny { exponent(x, 2) } else { ambit_file::fixed(x, 6) };
        let triple = |v: DVec3| format!("-{flag}{gap}{} {} {}", number(v.x), number(v.y), number(v.z));
        Some(match self.place {
            Place::Switch(at) => {
                let on = *at(settings);
                let (sign, word) = if on { ('+', "on") } else { ('-', "off") };
                Label::tabs(&format!("-{flag}{sign}"), 4, &format!("{comment} {word}"))
            }
            Place::Integer(at) => Label::tabs(&format!("-{flag}{gap}{:<9}", at(settings)), 3, comment),
            Place::Real(at) => Label::tabs(&format!("-{flag}{gap}{}", number(*at(settings))), 3, comment),
            Place::Vector(at) => Label::tabs(&triple(*at(settings)), 1, comment),
            Place::Colour(at) => Label::tabs(&triple(at(settings).as_dvec3()), 1, comment),
            _ => return None,
        })
    }
}
