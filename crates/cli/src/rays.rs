//! Options of `rtrace`.

use crate::common::{Carries, Common, Output, colour_rows, persist_rows, thread_row, warning_row};
use crate::failure::Failure;
use crate::rendering::{Rendering, rendering_rows};
use crate::spec::spec_words;
use crate::table::{Label, Place, Row};
use ambit_render::{Options, Selection};

/// How rays come in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputFormat {
    /// `a`: words.
    Ascii,
    /// `f`: native 4-byte reals.
    Float,
    /// `d`: native 8-byte reals.
    Double,
}

/// How records go out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputFormat {
    /// `a`: numbers and tabs, a line a record.
    Ascii,
    /// `f`: native 4-byte reals.
    Float,
    /// `d`: native 8-byte reals.
    Double,
    /// `c`: pixels with a common exponent.
    Colour,
}

/// Every parameter of a run of `rtrace`.
#[derive(Clone, Debug, PartialEq)]
pub struct RayOptions {
    /// Parameters of the light.
    pub rendering: Rendering,
    /// Parameters of the process.
    pub common: Common,
    /// `-f`: input.
    pub input: InputFormat,
    /// `-f`: output.
    pub format: OutputFormat,
    /// `-o`: letters of the output fields.
    pub fields: String,
    /// `-h`: write a header.
    pub header: bool,
    /// `-x`: flush interval, or width.
    pub width: i32,
    /// `-y`: height, or number of rays.
    pub height: i32,
    /// `-I`: rays are points with orientations whose irradiance is wanted.
    pub immediate: bool,
    /// `-ld`: rays reach no farther than their direction's length.
    pub limited: bool,
    /// `-te`, `-ti`: rays of the tree that are written.
    pub tree: Selection,
}

impl RayOptions {
    /// The defaults on a machine with that many processors.
    pub fn new(processors: usize) -> Self {
        Self {
            rendering: Rendering::new(Options::rtrace()),
            common: Common::new(processors),
            input: InputFormat::Ascii,
            format: OutputFormat::Ascii,
            fields: "v".into(),
            header: true,
            width: 0,
            height: 0,
            immediate: false,
            limited: false,
            tree: Selection::All,
        }
    }

    fn tree_names(&mut self, names: impl IntoIterator<Item = String>, include: bool) {
        let list = match &mut self.tree {
            Selection::Include(list) if include => list,
            Selection::Exclude(list) if !include => list,
            other => {
                *other = if include {
                    Selection::Include(names.into_iter().collect())
                } else {
                    Selection::Exclude(names.into_iter().collect())
                };
                return;
            }
        };
        list.extend(names);
    }
}

impl Carries<Rendering> for RayOptions {
    fn part(&mut self) -> &mut Rendering {
        &mut self.rendering
    }
}

impl Carries<Common> for RayOptions {
    fn part(&mut self) -> &mut Common {
        &mut self.common
    }
}

/// The options of `rtrace`, in the order of `-defaults`.
pub fn ray_table() -> Vec<Row<RayOptions>> {
    let mut rows = vec![
        warning_row(),
        Row::new(
            "I",
            Place::Switch(|s: &mut RayOptions| &mut s.immediate),
            "rays are points and orientations; show the irradiance there",
        )
        .shown(Label::OnOff("immediate irradiance"))
        .hidden_if(|s| !s.immediate),
        thread_row().shown(Label::Own(|s: &mut RayOptions| {
            Label::tabs(&format!("-n {:<2}", s.common.threads()), 4, "number of rendering processes")
        })),
        Row::new(
            "x",
            Place::Integer(|s: &mut RayOptions| &mut s.width),
            "flush output after every so many rays; with -y, the width of a picture",
        )
        .shown(Label::Own(|s| {
            let comment = if s.width > 0 && s.height > 0 { "x resolution" } else { "flush interval" };
            Label::tabs(&format!("-x {:<9}", s.width), 3, comment)
        }))
        .values("N"),
        Row::new(
            "y",
            Place::Integer(|s: &mut RayOptions| &mut s.height),
            "stop after so many rays; with -x, after so many lines of a picture",
        )
        .shown(Label::Plain("y resolution"))
        .values("N"),
        Row::new(
            "ld",
            Place::Switch(|s: &mut RayOptions| &mut s.limited),
            "rays reach no farther than the length of their direction",
        )
        .shown(Label::OnOff("limit distance")),
        Row::new("h", Place::Switch(|s: &mut RayOptions| &mut s.header), "write an information header").shown(
            Label::Own(|s| {
                let (sign, comment) = if s.header { ('+', "output header") } else { ('-', "no header") };
                Label::tabs(&format!("-h{sign}"), 4, comment)
            }),
        ),
    ];
    rows.extend(format_rows());
    rows.extend(colour_rows(|s: &mut RayOptions| s.common.output.bins()));
    rows.extend(scalar_rows());
    rows.extend(rendering_rows());
    rows.extend(tree_rows());
    rows.extend(persist_rows());
    rows
}

/// `-fIO` and `-oSPEC`.
fn format_rows() -> Vec<Row<RayOptions>> {
    vec![
        Row::new(
            "f",
            Place::Glued(
                |tail| formats(tail).is_some(),
                |s: &mut RayOptions, tail| {
                    (s.input, s.format) = formats(tail).ok_or_else(|| Failure::at(&format!("-f{tail}")))?;
                    Ok(())
                },
            ),
            "formats of input (a, f, d: text, 4- and 8-byte reals) and output (a, f, d, c: pixels)",
        )
        .values("IO")
        .shown(Label::Own(|s| {
            let (i, input) = match s.input {
                InputFormat::Ascii => ('a', "ascii"),
                InputFormat::Float => ('f', "float"),
                InputFormat::Double => ('d', "double"),
            };
            let (o, output) = s.format.letter_and_name();
            Label::tabs(&format!("-f{i}{o}"), 4, &format!("format input/output = {input}/{output}"))
        })),
        Row::new(
            "o",
            Place::Glued(
                |_| true,
                |s: &mut RayOptions, tail| {
                    tail.clone_into(&mut s.fields);
                    Ok(())
                },
            ),
            "what to write of a ray: o origin, d direction, v value, V contribution, w weight, W coefficient, l length, \
             L first length, c coordinates, p point, n normal, N true normal, s surface, m modifier, M material, \
             r and x mirrored and other part of the value, R and X their distances, ~ a tilde; t: what follows is written \
             of every ray of the tree as it finishes, T: of shadow rays, too",
        )
        .values("FIELDS")
        .shown(Label::Own(|s| Label::tabs(&format!("-o{:<9}", s.fields), 3, &format!("output{}", spec_words(&s.fields))))),
    ]
}

impl OutputFormat {
    fn letter_and_name(self) -> (char, &'static str) {
        match self {
            Self::Ascii => ('a', "ascii"),
            Self::Float => ('f', "float"),
            Self::Double => ('d', "double"),
            Self::Colour => ('c', "32-bit_rle_rgbe"),
        }
    }
}

/// The formats that one or two letters stand for.
fn formats(tail: &str) -> Option<(InputFormat, OutputFormat)> {
    let mut letters = tail.chars();
    let (input, same) = match letters.next()? {
        'a' => (InputFormat::Ascii, OutputFormat::Ascii),
        'f' => (InputFormat::Float, OutputFormat::Float),
        'd' => (InputFormat::Double, OutputFormat::Double),
        _ => return None,
    };
    let output = match letters.next() {
        None => same,
        Some('a') => OutputFormat::Ascii,
        Some('f') => OutputFormat::Float,
        Some('d') => OutputFormat::Double,
        Some('c') => OutputFormat::Colour,
        Some(_) => return None,
    };
    letters.next().is_none().then_some((input, output))
}

/// `-pY -pS -pM -pA -co`.
fn scalar_rows() -> Vec<Row<RayOptions>> {
    let bare = |flag, act, help| Row::new(flag, Place::Bare(act), help);
    vec![
        bare("pY", |s: &mut RayOptions| s.common.output = Output::Photopic, "write luminance or illuminance"),
        bare("pS", |s| s.common.output = Output::Scotopic, "write scotopic luminance or illuminance"),
        bare("pM", |s| s.common.output = Output::Melanopic, "write melanopic luminance or illuminance"),
        bare("pA", |s| s.common.output = Output::Average, "write the mean of the channels"),
        Row::new(
            "co",
            Place::Toggle(|s: &RayOptions| s.common.output.bins(), |s, on| {
                s.common.output = s.common.output.calculated(on);
            }),
            "write all bins of the spectrum (with -cs above 3) instead of a colour; of this and -p…, the last one counts",
        )
        .shown(Label::Own(|s| {
            let on = s.common.output.bins();
            let (sign, comment) = if on { ('+', "output spectral values") } else { ('-', "output tristimulus colors") };
            Label::tabs(&format!("-co{sign}"), 4, comment)
        }))
        .hidden_if(|s| {
            let output = s.common.output;
            s.rendering.spectrum.samples <= 3 || !output.bins() && !output.coloured()
        }),
    ]
}

/// `-te -ti -tE -tI`.
fn tree_rows() -> Vec<Row<RayOptions>> {
    let word = |flag, act, values, help| Row::new(flag, Place::Word(act), help).values(values);
    vec![
        word(
            "te",
            |s: &mut RayOptions, name, _| {
                s.tree_names([name], false);
                Ok(())
            },
            "MODIFIER",
            "leave rays that hit this modifier out of ray trees",
        ),
        word(
            "ti",
            |s, name, _| {
                s.tree_names([name], true);
                Ok(())
            },
            "MODIFIER",
            "leave all other rays out of ray trees",
        ),
        word(
            "tE",
            |s, file, outside| {
                s.tree_names(outside.list(&file, "trace exclude")?, false);
                Ok(())
            },
            "FILE",
            "as -te for every word of a file",
        ),
        word(
            "tI",
            |s, file, outside| {
                s.tree_names(outside.list(&file, "trace include")?, true);
                Ok(())
            },
            "FILE",
            "as -ti for every word of a file",
        ),
    ]
}
