//! Options of calculations by wavelength: `-cs -cw`.

use crate::common::Carries;
use crate::failure::Failure;
use crate::rendering::Rendering;
use crate::table::{Label, Place, Row};

/// How radiation is divided by wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spectrum {
    /// Bins; 3 are the three channels.
    pub samples: i32,
    /// One end, nm.
    pub from: f64,
    /// The other end, nm.
    pub to: f64,
}

impl Default for Spectrum {
    fn default() -> Self {
        Self { samples: 3, from: 380.0, to: 780.0 }
    }
}

impl Spectrum {
    /// The bins that can be calculated.
    ///
    /// # Errors
    /// If there are too few of them, or their limits are too near to each other.
    pub(crate) fn settled(self) -> Result<ambit_render::Spectrum, Failure> {
        ambit_render::Spectrum::new(self.samples, self.from, self.to)
            .ok_or_else(|| Failure::user("unsupported spectral sampling"))
    }
}

/// `-cs -cw`.
pub(crate) fn spectrum_rows<S: Carries<Rendering>>() -> Vec<Row<S>> {
    let spectral: fn(&mut S) -> bool = |s| s.part().spectrum.samples <= 3;
    vec![
        Row::new(
            "cs",
            Place::Integer(|s: &mut S| &mut s.part().spectrum.samples),
            "calculate by so many bins of wavelength (4 to 24); 3 for red, green and blue",
        )
        .shown(Label::Own(|s| {
            Label::tabs(&format!("-cs {:<2}", s.part().spectrum.samples), 4, "number of spectral bins")
        }))
        .hidden_if(spectral)
        .values("N"),
        Row::new(
            "cw",
            Place::Reals(2, |s: &mut S, v| {
                let spectrum = &mut s.part().spectrum;
                (spectrum.from, spectrum.to) = (v[0].min(v[1]), v[0].max(v[1]));
                Ok(())
            }),
            "limits of the spectrum in nm, at least 50 nm apart",
        )
        .shown(Label::Own(|s| {
            let Spectrum { from, to, .. } = s.part().spectrum;
            let [from, to] = [from, to].map(|w| ambit_file::general(w, 6));
            Label::tabs(&format!("-cw {from} {to}"), 3, "wavelength limits (nm)")
        }))
        .hidden_if(spectral)
        .values("FROM TO"),
    ]
}
