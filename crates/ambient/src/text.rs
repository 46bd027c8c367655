//! Records as text, as `lookamb` prints and reads them: one line of 21 numbers, or eight labelled lines.

use crate::record::Record;
use ambit_base::{DVec3, Rgb};
use ambit_file::{exponent, fixed};
use std::fmt::Write;

/// Decimals of every number.
const DECIMALS: usize = 6;
/// Numbers of a record on one line.
const COLUMNS: usize = 21;
/// Labels of the eight lines and how many numbers follow each.
const LABELS: [(&str, usize); 8] = [
    ("Position:", 3),
    ("Normal:", 3),
    ("Uvector:", 3),
    ("Lvl,Wt,UVrad:", 4),
    ("Value:", 3),
    ("Pos.Grad:", 2),
    ("Dir.Grad:", 2),
    ("Corral:", 1),
];

/// The ways to write records as text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextForm {
    /// Eight lines with labels, and an empty one.
    Labelled,
    /// One line of numbers separated by tabs.
    Tabular,
}

impl TextForm {
    /// The text of a record, with its last newline. Positions are rounded to 32 bits as Radiance holds them.
    pub fn write(self, record: &Record) -> String {
        let words = words(record);
        let mut text = String::new();
        match self {
            Self::Tabular => {
                text = words.join("\t");
                write!(text, "\t{}", record.corral).expect("a string takes everything");
            }
            Self::Labelled => {
                let mut words = words.iter();
                for (label, count) in LABELS {
                    let gap = match label {
                        "Normal:" | "Value:" | "Corral:" => "\t\t",
                        _ => "\t",
                    };
                    text.push_str(label);
                    text.push_str(gap);
                    let part: Vec<&str> = words.by_ref().take(count).map(String::as_str).collect();
                    match label {
                        "Corral:" => write!(text, "{:8X}", record.corral).expect("a string takes everything"),
                        "Lvl,Wt,UVrad:" => {
                            text.push_str(part[0]);
                            text.push_str("\t\t");
                            text.push_str(&part[1..].join("\t"));
                        }
                        _ => text.push_str(&part.join("\t")),
                    }
                    text.push('\n');
                }
            }
        }
        text.push('\n');
        text
    }

    /// Reads the next record; `None` at the end. An incomplete or malformed record is an error that tells what was found.
    ///
    /// Directions need not be of unit length here; the caller checks what it needs.
    pub fn read<'a>(self, words: &mut impl Iterator<Item = &'a str>) -> Option<Result<Record, String>> {
        let first = words.next()?;
        Some(self.record(&mut std::iter::once(first).chain(words)))
    }

    fn record<'a>(self, words: &mut impl Iterator<Item = &'a str>) -> Result<Record, String> {
        let mut next = || words.next().ok_or_else(|| "an incomplete record".to_owned());
        let mut numbers = [0.0f64; COLUMNS - 1];
        let corral;
        match self {
            Self::Tabular => {
                for x in &mut numbers {
                    *x = number(next()?)?;
                }
                let word = next()?;
                corral = word.parse().map_err(|_| format!("'{word}' (expected corral bits)"))?;
            }
            Self::Labelled => {
                let mut at = 0;
                for (label, count) in &LABELS[..LABELS.len() - 1] {
                    expect(next()?, label)?;
                    for x in &mut numbers[at..at + count] {
                        *x = number(next()?)?;
                    }
                    at += count;
                }
                expect(next()?, LABELS[7].0)?;
                let word = next()?;
                corral = u32::from_str_radix(word, 16).map_err(|_| format!("'{word}' (expected corral bits)"))?;
            }
        }
        let vector = |k: usize| DVec3::from_array([0, 1, 2].map(|i| f64::from(numbers[k + i] as f32)));
        let pair = |k: usize| [numbers[k] as f32, numbers[k + 1] as f32];
        let level = numbers[9];
        if !(0.0..=255.0).contains(&level) {
            return Err(format!("level {level} (expected 0 to 255)"));
        }
        Ok(Record {
            position: vector(0),
            normal: vector(3),
            u: vector(6),
            level: level as u8,
            weight: numbers[10] as f32,
            radii: pair(11),
            further: Box::default(),
            late: Box::default(),
            value: Rgb::new(numbers[13] as f32, numbers[14] as f32, numbers[15] as f32),
            gradient: pair(16),
            rotation: pair(18),
            corral,
        })
    }
}

/// All numbers but the corral, in the order of columns.
fn words(r: &Record) -> Vec<String> {
    let mut words = Vec::with_capacity(COLUMNS);
    let mut real = |x: f64| words.push(fixed(x, DECIMALS));
    r.position.to_array().iter().for_each(|&x| real(f64::from(x as f32)));
    r.normal.to_array().into_iter().for_each(&mut real);
    r.u.to_array().into_iter().for_each(&mut real);
    let level = [r.level.to_string()];
    let rest = [r.weight, r.radii[0], r.radii[1]].map(|x| fixed(f64::from(x), DECIMALS));
    let value = r.value.to_array().map(|x| exponent(f64::from(x), DECIMALS));
    let gradients = r.gradient.iter().chain(&r.rotation).map(|&x| fixed(f64::from(x), DECIMALS));
    words.into_iter().chain(level).chain(rest).chain(value).chain(gradients).collect()
}

fn number(word: &str) -> Result<f64, String> {
    word.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(|| format!("'{word}' (expected a number)"))
}

fn expect(word: &str, label: &str) -> Result<(), String> {
    if word == label { Ok(()) } else { Err(format!("'{word}' (expected '{label}')")) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codec::{Layout, RECORD_BYTES};
    use crate::components::Components;

    /// Three records of a file of Radiance 6.0a and what its `lookamb` printed.
    #[rustfmt::skip]
    const BYTES: [[u8; RECORD_BYTES]; 3] = [
        [
            0x01, 0x3f, 0xff, 0xff, 0xff, 0x00, 0x54, 0x64, 0xdd, 0xff, 0x01, 0x5f, 0xff, 0xff, 0xff, 0x02, 0x7f,
            0xd8, 0x5a, 0xff, 0x01, 0x00, 0x00, 0x00, 0x1a, 0x43, 0x0c, 0x00, 0x04, 0x66, 0x66, 0x87, 0xff, 0x00,
            0x66, 0x66, 0x87, 0xff, 0x00, 0x70, 0x7a, 0xcf, 0x7f, 0xfe, 0x94, 0x23, 0x5f, 0x81, 0xfe, 0x79, 0xa1,
            0xd8, 0x7f, 0xff, 0x5c, 0x89, 0xc1, 0xff, 0x00, 0x00, 0x00, 0x00, 0x00, 0x9d, 0x7d, 0x5e, 0x7d,
        ],
        [
            0x00, 0x3f, 0xff, 0xff, 0xff, 0x01, 0x7b, 0x85, 0x1e, 0xff, 0x02, 0x47, 0x0a, 0x3d, 0x7f, 0x02, 0x4f,
            0xff, 0xff, 0xff, 0x02, 0x00, 0x00, 0x00, 0x0c, 0x00, 0x00, 0xa6, 0x31, 0x66, 0x66, 0x87, 0xff, 0x00,
            0x66, 0x66, 0x87, 0xff, 0x00, 0x67, 0x19, 0xa4, 0xff, 0x00, 0xbb, 0x15, 0x52, 0x81, 0xff, 0x65, 0x84,
            0x97, 0x7f, 0xfe, 0x4d, 0x96, 0xec, 0xff, 0x00, 0x00, 0x0f, 0xf8, 0x00, 0xc9, 0x95, 0x68, 0x7d,
        ],
        [
            0x00, 0x3f, 0xff, 0xff, 0xff, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x4b, 0xaa, 0x1d, 0xff, 0x02, 0x4f,
            0x7b, 0xde, 0xff, 0x02, 0x00, 0x00, 0x00, 0x10, 0x05, 0xc4, 0x00, 0x08, 0x41, 0x74, 0x77, 0x7f, 0xff,
            0x72, 0x64, 0x66, 0x7f, 0xff, 0x82, 0xe7, 0xd6, 0x01, 0x02, 0xb8, 0xd0, 0x89, 0x81, 0xfd, 0x86, 0xd0,
            0xb0, 0x01, 0xfc, 0xb0, 0x98, 0x52, 0x01, 0x00, 0x7f, 0x00, 0x01, 0xff, 0xbf, 0x8c, 0x5f, 0x7d,
        ],
    ];
    #[rustfmt::skip]
    const TABULAR: &str = concat!(
        "1.318656\t3.000000\t1.997580\t0.000000\t-1.000000\t0.000000\t0.370409\t0.000000\t-0.928869\t1\t0.500000\t0.800004\t0.800004\t7.690430e-02\t6.127930e-02\t4.614258e-02\t0.219687\t-0.210668\t0.475126\t0.722954\t0\n",
        "3.860000\t2.220000\t2.500000\t0.000000\t0.000000\t-1.000000\t-0.993398\t0.114722\t0.000000\t0\t1.000000\t0.800004\t0.800004\t9.838867e-02\t7.299805e-02\t5.102539e-02\t0.805470\t-0.269206\t0.198277\t0.606168\t1046528\n",
        "0.000000\t2.364516\t2.483871\t1.000000\t0.000000\t0.000000\t0.000000\t0.031853\t0.999493\t0\t1.000000\t0.255683\t0.446844\t9.350586e-02\t6.860352e-02\t4.663086e-02\t-3.909200\t-0.069517\t-0.059172\t-0.620352\t2130706943\n",
    );
    #[rustfmt::skip]
    const LABELLED: &str = concat!(
        "Position:\t1.318656\t3.000000\t1.997580\n",
        "Normal:\t\t0.000000\t-1.000000\t0.000000\n",
        "Uvector:\t0.370409\t0.000000\t-0.928869\n",
        "Lvl,Wt,UVrad:\t1\t\t0.500000\t0.800004\t0.800004\n",
        "Value:\t\t7.690430e-02\t6.127930e-02\t4.614258e-02\n",
        "Pos.Grad:\t0.219687\t-0.210668\n",
        "Dir.Grad:\t0.475126\t0.722954\n",
        "Corral:\t\t       0\n",
        "\n",
        "Position:\t3.860000\t2.220000\t2.500000\n",
        "Normal:\t\t0.000000\t0.000000\t-1.000000\n",
        "Uvector:\t-0.993398\t0.114722\t0.000000\n",
        "Lvl,Wt,UVrad:\t0\t\t1.000000\t0.800004\t0.800004\n",
        "Value:\t\t9.838867e-02\t7.299805e-02\t5.102539e-02\n",
        "Pos.Grad:\t0.805470\t-0.269206\n",
        "Dir.Grad:\t0.198277\t0.606168\n",
        "Corral:\t\t   FF800\n",
        "\n",
        "Position:\t0.000000\t2.364516\t2.483871\n",
        "Normal:\t\t1.000000\t0.000000\t0.000000\n",
        "Uvector:\t0.000000\t0.031853\t0.999493\n",
        "Lvl,Wt,UVrad:\t0\t\t1.000000\t0.255683\t0.446844\n",
        "Value:\t\t9.350586e-02\t6.860352e-02\t4.663086e-02\n",
        "Pos.Grad:\t-3.909200\t-0.069517\n",
        "Dir.Grad:\t-0.059172\t-0.620352\n",
        "Corral:\t\t7F0001FF\n",
        "\n",
    );

    #[test]
    fn the_text_is_that_of_radiance() {
        let text = |form: TextForm| -> String {
            BYTES.iter().map(|b| form.write(&Layout::V561.decode(b, &Components::default()))).collect()
        };
        assert_eq!(text(TextForm::Tabular), TABULAR);
        assert_eq!(text(TextForm::Labelled), LABELLED);
    }

    #[test]
    fn text_of_any_kind_is_read_or_refused() {
        let read = |form: TextForm, text: &str| form.read(&mut text.split_ascii_whitespace());
        assert_eq!(read(TextForm::Tabular, "  "), None);
        for text in ["1 2 3", "1 2 x", "Position: 1 2 3 Uvector:"] {
            for form in [TextForm::Tabular, TextForm::Labelled] {
                assert!(read(form, text).is_some_and(|r| r.is_err()), "{text}");
            }
        }
        let level = "1 2 3 0 0 1 1 0 0 300 1 .5 .5 1 1 1 0 0 0 0 0";
        assert_eq!(read(TextForm::Tabular, level), Some(Err("level 300 (expected 0 to 255)".to_owned())));
    }

    #[test]
    fn reading_what_was_written_gives_the_same_bytes() {
        for bytes in BYTES {
            let record = Layout::V561.decode(&bytes, &Components::default());
            for form in [TextForm::Labelled, TextForm::Tabular] {
                let text = form.write(&record);
                let mut words = text.split_ascii_whitespace();
                let again = form.read(&mut words).unwrap().unwrap();
                assert_eq!(form.write(&again), text);
                assert!(form.read(&mut words).is_none());
            }
        }
    }
}
