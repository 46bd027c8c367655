//! Views: what a user says about the camera, and how options change it. Set-up and rays are in [`Projection`].
//!
//! Angles are degrees, lengths scene units, shift and lift units of the whole image.

mod fit;
mod projection;
mod text;

pub use fit::{Fit, fit_resolution};
pub use projection::{Projection, ViewError, ViewRay};
pub use text::is_view_line;

use ambit_base::DVec3;

/// How directions are laid out on the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewType {
    /// `v`: perspective.
    Perspective,
    /// `l`: parallel.
    Parallel,
    /// `c`: cylindrical panorama, perspective in the vertical.
    Cylinder,
    /// `h`: hemispherical fisheye, distances from the centre are sines.
    Hemisphere,
    /// `a`: angular fisheye, distances from the centre are angles.
    Angular,
    /// `s`: planispheric (stereographic) fisheye.
    Planisphere,
    /// Another letter, which set-up refuses.
    Unknown(char),
}

impl ViewType {
    /// The type that a letter stands for.
    pub fn from_letter(letter: char) -> Self {
        match letter {
            'v' => Self::Perspective,
            'l' => Self::Parallel,
            'c' => Self::Cylinder,
            'h' => Self::Hemisphere,
            'a' => Self::Angular,
            's' => Self::Planisphere,
            other => Self::Unknown(other),
        }
    }

    /// The letter.
    pub fn letter(self) -> char {
        match self {
            Self::Perspective => 'v',
            Self::Parallel => 'l',
            Self::Cylinder => 'c',
            Self::Hemisphere => 'h',
            Self::Angular => 'a',
            Self::Planisphere => 's',
            Self::Unknown(letter) => letter,
        }
    }
}

/// One view option, without its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewOption {
    /// `-vtT`
    Type(ViewType),
    /// `-vp x y z`
    Point,
    /// `-vd x y z`
    Direction,
    /// `-vu x y z`
    Up,
    /// `-vh h`
    Horizontal,
    /// `-vv v`
    Vertical,
    /// `-vo f`
    Fore,
    /// `-va a`
    Aft,
    /// `-vs s`
    Shift,
    /// `-vl l`
    Lift,
}

impl ViewOption {
    /// The option that a word spells, if any (`-vf` is none: it names a file).
    pub fn parse(word: &str) -> Option<Self> {
        match word.strip_prefix("-v")? {
            "p" => Some(Self::Point),
            "d" => Some(Self::Direction),
            "u" => Some(Self::Up),
            "h" => Some(Self::Horizontal),
            "v" => Some(Self::Vertical),
            "o" => Some(Self::Fore),
            "a" => Some(Self::Aft),
            "s" => Some(Self::Shift),
            "l" => Some(Self::Lift),
            kind => {
                let mut letters = kind.strip_prefix('t')?.chars();
                let letter = letters.next()?;
                letters.next().is_none().then_some(Self::Type(ViewType::from_letter(letter)))
            }
        }
    }

    /// How many numbers follow.
    pub fn numbers(self) -> usize {
        match self {
            Self::Type(_) => 0,
            Self::Point | Self::Direction | Self::Up => 3,
            _ => 1,
        }
    }
}

/// The parameters of a view, as written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// How directions are laid out.
    pub kind: ViewType,
    /// View point.
    pub point: DVec3,
    /// View direction; its length is the focal distance.
    pub direction: DVec3,
    /// Up, of any length.
    pub up: DVec3,
    /// Horizontal size: degrees, or scene units if parallel.
    pub horizontal: f64,
    /// Vertical size: degrees, or scene units if parallel.
    pub vertical: f64,
    /// Distance of the fore clipping surface, 0 for none.
    pub fore: f64,
    /// Distance of the aft clipping surface, 0 for none.
    pub aft: f64,
    /// Shift to the right, in image widths.
    pub shift: f64,
    /// Lift, in image heights.
    pub lift: f64,
}

impl Default for View {
    fn default() -> Self {
        Self {
            kind: ViewType::Perspective,
            point: DVec3::ZERO,
            direction: DVec3::Y,
            up: DVec3::Z,
            horizontal: 45.0,
            vertical: 45.0,
            fore: 0.0,
            aft: 0.0,
            shift: 0.0,
            lift: 0.0,
        }
    }
}

impl View {
    /// Applies an option with its numbers. Returns false, and changes nothing, if their count is wrong or one of them
    /// is not finite.
    pub fn apply(&mut self, option: ViewOption, numbers: &[f64]) -> bool {
        if numbers.len() != option.numbers() || !numbers.iter().all(|n| n.is_finite()) {
            return false;
        }
        match (option, numbers) {
            (ViewOption::Type(kind), _) => self.kind = kind,
            (ViewOption::Point, &[x, y, z]) => self.point = DVec3::new(x, y, z),
            (ViewOption::Direction, &[x, y, z]) => self.direction = DVec3::new(x, y, z),
            (ViewOption::Up, &[x, y, z]) => self.up = DVec3::new(x, y, z),
            (ViewOption::Horizontal, &[h]) => self.horizontal = h,
            (ViewOption::Vertical, &[v]) => self.vertical = v,
            (ViewOption::Fore, &[f]) => self.fore = f,
            (ViewOption::Aft, &[a]) => self.aft = a,
            (ViewOption::Shift, &[s]) => self.shift = s,
            (ViewOption::Lift, &[l]) => self.lift = l,
            _ => return false,
        }
        true
    }
}
