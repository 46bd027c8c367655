//! Options that both rendering programs have besides those of the light: warnings, threads, colour of the output,
//! error file.

use crate::failure::Failure;
use crate::table::{Label, Place, Row};
use ambit_base::LUMINOUS_EFFICACY;

/// Access to one part of a program's parameters, so that programs share rows of the table.
pub trait Carries<T> {
    /// The part.
    fn part(&mut self) -> &mut T;
}

/// Parameters of the process rather than of the light.
#[derive(Clone, Debug, PartialEq)]
pub struct Common {
    /// `-w`: warnings are printed.
    pub warnings: bool,
    /// `-e FILE`: where messages go instead of standard error.
    pub error_file: Option<String>,
    /// `-n`: threads; 0 for as many as [`Common::processors`].
    pub threads: usize,
    /// Threads unless `-n` says otherwise: processors that there are, if the user wants no fewer.
    pub processors: usize,
    /// `-P`, `-PP`: a persist file.
    pub persist: Option<String>,
    /// `-p…`: the colours that are written.
    pub output: Output,
}

impl Common {
    /// The defaults on a machine with that many processors.
    pub fn new(processors: usize) -> Self {
        Self { warnings: true, error_file: None, threads: 0, processors, persist: None, output: Output::Rgb }
    }

    /// How many threads to use.
    pub fn threads(&self) -> usize {
        if self.threads == 0 { self.processors } else { self.threads }
    }
}

/// What is written for a colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Output {
    /// `-pRGB`: red, green, blue of the standard primaries.
    Rgb,
    /// `-pXYZ`: CIE XYZ × 179.
    Xyz,
    /// `-pc`: red, green, blue of other primaries (x and y of each, then of white).
    Primaries([f64; 8]),
    /// `-pY`: photopic, cd/m² or lux.
    Photopic,
    /// `-pS`: scotopic.
    Scotopic,
    /// `-pM`: melanopic.
    Melanopic,
    /// `-pA`: the mean of the channels.
    Average,
    /// `-co`: after it, what is calculated, times the factor of the output that it took the place of: all bins of the
    /// spectrum, or (`-co-`) red, green and blue.
    Calculated {
        /// All bins.
        bins: bool,
        /// What they are multiplied by.
        factor: f32,
    },
}

/// Red, green, blue and white of Radiance's standard RGB.
const STANDARD: [f64; 8] = [0.64, 0.33, 0.29, 0.6, 0.15, 0.06, 1.0 / 3.0, 1.0 / 3.0];

/// Lumens in a watt of scotopic light as Radiance counts them.
pub const SCOTOPIC_EFFICACY: f32 = 412.0;

/// How far chromaticities may be off the standard and still count as it.
const STANDARD_TOLERANCE: f64 = 0.001;

/// Chromaticities nearer to zero, and determinants of primaries, make a set that spans no colours.
const DEGENERATE: f64 = 1e-6;

impl Output {
    /// The output of `-pc`.
    fn primaries(v: [f64; 8]) -> Result<Self, Failure> {
        if v.iter().zip(STANDARD).all(|(a, b)| (a - b).abs() <= STANDARD_TOLERANCE) {
            return Ok(Self::Rgb);
        }
        let [rx, ry, gx, gy, bx, by, wx, wy] = v;
        let spanned = (rx - bx) * (gy - by) - (gx - bx) * (ry - by);
        if wx <= DEGENERATE || wy <= DEGENERATE || spanned.abs() <= DEGENERATE {
            return Err(Failure::user("illegal primary chromaticities"));
        }
        Ok(Self::Primaries(v))
    }

    /// The output of `-co+` or `-co-` after this one. Where no bins were to be written, `-co-` changes nothing.
    pub(crate) fn calculated(self, bins: bool) -> Self {
        match self {
            Self::Calculated { .. } => Self::Calculated { bins, factor: self.efficacy() },
            _ if bins => Self::Calculated { bins, factor: self.efficacy() },
            _ => self,
        }
    }

    /// Lumens in a watt, where the output is in lumens; what is no light (shares of it) is not multiplied by that.
    pub fn efficacy(self) -> f32 {
        match self {
            Self::Xyz | Self::Photopic | Self::Melanopic => LUMINOUS_EFFICACY,
            Self::Scotopic => SCOTOPIC_EFFICACY,
            Self::Rgb | Self::Primaries(_) | Self::Average => 1.0,
            Self::Calculated { factor, .. } => factor,
        }
    }

    /// True if all bins of the spectrum are written.
    pub fn bins(self) -> bool {
        matches!(self, Self::Calculated { bins: true, .. })
    }

    /// True if three numbers of a colour are written.
    pub(crate) fn coloured(self) -> bool {
        matches!(self, Self::Rgb | Self::Xyz | Self::Primaries(_) | Self::Calculated { bins: false, .. })
    }

    /// The primaries to record in a header, if they are red, green and blue at all.
    pub fn recorded(self) -> Option<[f64; 8]> {
        match self {
            Self::Rgb => Some(STANDARD),
            Self::Primaries(v) => Some(v),
            _ => None,
        }
    }

    fn shown(self) -> String {
        match self {
            Self::Rgb | Self::Average | Self::Calculated { .. } => Label::tabs("-pRGB", 4, "standard RGB color output"),
            Self::Xyz => Label::tabs("-pXYZ", 4, "CIE XYZ color output"),
            Self::Primaries(v) => {
                let numbers: Vec<String> = v.iter().map(|x| format!("{x:.4}")).collect();
                Label::tabs(&format!("-pc {}", numbers.join(" ")), 1, "output color primaries and white point")
            }
            Self::Photopic => Label::tabs("-pY", 4, "photopic output"),
            Self::Scotopic => Label::tabs("-pS", 4, "scotopic output"),
            Self::Melanopic => Label::tabs("-pM", 4, "melanopic output"),
        }
    }
}

/// `-pRGB -pXYZ -pc`, the first of which prints for all in `-defaults` unless `hides` says otherwise.
pub(crate) fn colour_rows<S: Carries<Common>>(hides: fn(&mut S) -> bool) -> Vec<Row<S>> {
    vec![
        Row::new("pRGB", Place::Bare(|s: &mut S| s.part().output = Output::Rgb), "write red, green and blue")
            .shown(Label::Own(|s| s.part().output.shown()))
            .hidden_if(hides),
        Row::new("pXYZ", Place::Bare(|s: &mut S| s.part().output = Output::Xyz), "write CIE XYZ, Y in cd/m² or lux"),
        Row::new(
            "pc",
            Place::Reals(8, |s: &mut S, v| {
                let v = v.try_into().map_err(|_| Failure::at("-pc"))?;
                s.part().output = Output::primaries(v)?;
                Ok(())
            }),
            "write RGB of these primaries and white point",
        )
        .values("RX RY GX GY BX BY WX WY"),
    ]
}

/// `-w`.
pub(crate) fn warning_row<S: Carries<Common>>() -> Row<S> {
    Row::new("w", Place::Switch(|s: &mut S| &mut s.part().warnings), "print warnings")
        .shown(Label::OnOff("warning messages"))
}

/// `-n`.
pub(crate) fn thread_row<S: Carries<Common>>() -> Row<S> {
    Row::new(
        "n",
        Place::Whole(|s: &mut S, n| {
            if n < 1 {
                return Err(Failure::user("bad number of processes"));
            }
            s.part().threads = n as usize;
            Ok(())
        }),
        "use this many threads (default: what AMBIT_THREADS says, or one a processor); results do not depend on it",
    )
    .values("THREADS")
}

/// `-P` and `-PP`.
pub(crate) fn persist_rows<S: Carries<Common>>() -> Vec<Row<S>> {
    ["P", "PP"]
        .map(|flag| {
            Row::new(
                flag,
                Place::Word(|s: &mut S, file, _| {
                    s.part().persist = Some(file);
                    Ok(())
                }),
                "taken for rad's sake: every run renders by itself, and none stays in the background",
            )
            .values("FILE")
        })
        .into()
}
