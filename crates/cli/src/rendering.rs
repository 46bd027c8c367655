//! Options of the light, which all rendering programs share: `-d* -s* -a* -m* -l* -c*`, `-i -u -bv -f -e`.

use crate::common::{Carries, Common};
use crate::failure::Failure;
use crate::goal::goal_row;
use crate::spectrum::{Spectrum, spectrum_rows};
use crate::systems::system_rows;
use crate::table::{Label, Place, Row};
use ambit_render::{Options, Reuse, Selection};

/// Parameters of the light, and the files that belong to them.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendering {
    /// Parameters of the calculation.
    pub options: Options,
    /// `-af`: the ambient file.
    pub ambient_file: Option<String>,
    /// `--reuse`: what is done with records that the ambient file has; `None` leaves the file alone.
    pub reuse: Option<Reuse>,
    /// `--measured-reuse`: on, off, or `None` for on unless there is an ambient file.
    pub measured_reuse: Option<bool>,
    /// `--stats`: say in the end what the calculation took.
    pub statistics: bool,
    /// Say as much of that as costs hardly anything.
    pub counts: bool,
    /// `--error`: the RMS error that settings are chosen for, relative to the mean, above 0 and up to 1; `None` takes the
    /// settings as they are.
    pub goal: Option<f64>,
    /// `-f FILE` and `-e EXPRESSION`, in order.
    pub functions: Vec<Function>,
    /// `-cs`, `-cw`.
    pub spectrum: Spectrum,
    /// `-ap`, in order.
    pub photon_maps: Vec<PhotonMap>,
    /// `-am`: search radius for photons; 0 for automatic.
    pub photon_radius: f64,
    /// Warnings that reading the options gave rise to.
    pub notices: Vec<String>,
}

/// Definitions that the scene's function files can use.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Function {
    /// A function file.
    File(String),
    /// Text in the language of function files.
    Expression(String),
}

/// A photon map to be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PhotonMap {
    /// File.
    pub file: String,
    /// Least number of photons looked up.
    pub least: i32,
    /// Greatest number of photons looked up.
    pub greatest: i32,
}

/// Photons looked up if `-ap` does not say.
const BANDWIDTH: i32 = 40;

/// Most names that `-ae` or `-ai` take.
const NAME_LIMIT: usize = 512;

impl Rendering {
    /// The defaults that go with a program's own.
    pub fn new(options: Options) -> Self {
        Self {
            options,
            ambient_file: None,
            reuse: Some(Reuse::Auto),
            measured_reuse: None,
            statistics: false,
            counts: false,
            goal: None,
            functions: Vec::new(),
            spectrum: Spectrum::default(),
            photon_maps: Vec::new(),
            photon_radius: 0.0,
            notices: Vec::new(),
        }
    }

    /// Settles on what depends on several options, and refuses what can not be calculated.
    ///
    /// # Errors
    /// Names the option that asks for it.
    pub fn check(&mut self) -> Result<(), Failure> {
        self.options.spectrum = self.spectrum.settled()?;
        self.options.ambient.systems.measured_reuse = self.measured_reuse.unwrap_or(self.ambient_file.is_none());
        if let Some(map) = self.photon_maps.first() {
            return Err(Failure::unsupported(&format!("photon map \"{}\" (-ap) is", map.file)));
        }
        Ok(())
    }

    fn names(&mut self, names: impl IntoIterator<Item = String>, include: bool) -> Result<(), Failure> {
        let selection = &mut self.options.ambient.selection;
        let list = match selection {
            Selection::Include(list) if include => list,
            Selection::Exclude(list) if !include => list,
            other => {
                *other = if include { Selection::Include(Vec::new()) } else { Selection::Exclude(Vec::new()) };
                let (Selection::Include(list) | Selection::Exclude(list)) = other else { return Ok(()) };
                list
            }
        };
        list.extend(names);
        let what = if include { "include" } else { "exclude" };
        if list.len() > NAME_LIMIT {
            return Err(Failure::internal(format!("too many ambient {what} modifiers")));
        }
        Ok(())
    }

    fn photon_map(&mut self, file: String, counts: &[i32]) -> Result<(), Failure> {
        let least = counts.first().copied().unwrap_or(BANDWIDTH);
        let greatest = counts.get(1).copied().unwrap_or(least);
        if greatest < least {
            return Err(Failure::at("-ap"));
        }
        if counts.is_empty() {
            self.notices.push(format!("missing photon lookup bandwidth, defaulting to {BANDWIDTH}"));
        }
        if self.options.ambient.bounces == 0 {
            self.options.ambient.bounces = 1;
        }
        self.photon_maps.push(PhotonMap { file, least, greatest });
        Ok(())
    }
}

/// The rows of the light, in the order of `-defaults`.
pub(crate) fn rendering_rows<S: Carries<Rendering> + Carries<Common>>() -> Vec<Row<S>> {
    fn light<S: Carries<Rendering>>(s: &mut S) -> &mut Rendering {
        s.part()
    }
    let switch = |flag, at, comment, help| Row::new(flag, Place::Switch(at), help).shown(Label::OnOff(comment));
    let real = |flag, at, comment, values, help| {
        Row::new(flag, Place::Real(at), help).shown(Label::Plain(comment)).values(values)
    };
    let integer = |flag, at, comment, values, help| {
        Row::new(flag, Place::Integer(at), help).shown(Label::Plain(comment)).values(values)
    };
    let mut rows: Vec<Row<S>> = vec![
        switch(
            "i",
            |s| &mut light(s).options.irradiance,
            "irradiance calculation",
            "show irradiance: the first surface counts as a white diffuser, times pi",
        ),
        switch("u", |s| &mut light(s).options.uncorrelated, "", "sample at random instead of in strata").shown(
            Label::Own(|s| {
                let (sign, text) = if light(s).options.uncorrelated {
                    ('+', "uncorrelated Monte Carlo sampling")
                } else {
                    ('-', "correlated quasi-Monte Carlo sampling")
                };
                Label::tabs(&format!("-u{sign}"), 4, text)
            }),
        ),
        switch(
            "bv",
            |s| &mut light(s).options.back_visible,
            "back face visibility",
            "surfaces are seen from behind, too",
        ),
        real(
            "dt",
            |s| &mut light(s).options.direct.threshold,
            "direct threshold",
            "FRACTION",
            "leave out shadow tests of what would change the value by less than this fraction",
        ),
        real(
            "dc",
            |s| &mut light(s).options.direct.certainty,
            "direct certainty",
            "CERTAINTY",
            "how sure the threshold -dt must be: 1 for all sources together, 0 for each by itself",
        ),
        real(
            "dj",
            |s| &mut light(s).options.direct.jitter,
            "direct jitter",
            "FRACTION",
            "spread samples over this fraction of a light source, for soft shadows",
        ),
        real(
            "ds",
            |s| &mut light(s).options.direct.sampling,
            "direct sampling",
            "RATIO",
            "divide light sources until width over distance is below this; 0 leaves them whole",
        ),
        integer(
            "dr",
            |s| &mut light(s).options.direct.relays,
            "direct relays",
            "N",
            "follow light over this many mirrors (virtual light sources)",
        ),
        integer(
            "dp",
            |s| &mut light(s).options.direct.pretest,
            "direct pretest density",
            "N",
            "samples per steradian that test if a virtual light source is visible; 0 for none",
        ),
        switch(
            "dv",
            |s| &mut light(s).options.direct.visible,
            "direct visibility",
            "light sources are seen; off, they only light others",
        ),
        real(
            "ss",
            |s| &mut light(s).options.specular.sampling,
            "specular sampling",
            "N",
            "samples of a rough highlight; 0 makes reflections sharp",
        ),
        real(
            "st",
            |s| &mut light(s).options.specular.threshold,
            "specular threshold",
            "FRACTION",
            "treat rough highlights up to this strength as diffuse",
        ),
        Row::new(
            "av",
            Place::Colour(|s| &mut light(s).options.ambient.value),
            "radiance that stands for further bounces",
        )
        .shown(Label::Plain("ambient value"))
        .values("R G B"),
        integer(
            "aw",
            |s| &mut light(s).options.ambient.weight,
            "ambient value weight",
            "N",
            "average computed values into -av, which counts as this many of them; 0 keeps it",
        ),
        integer(
            "ab",
            |s| &mut light(s).options.ambient.bounces,
            "ambient bounces",
            "N",
            "diffuse interreflections; 0 for none",
        ),
        real(
            "aa",
            |s| &mut light(s).options.ambient.accuracy,
            "ambient accuracy",
            "ERROR",
            "error of interpolated irradiance, as a fraction; 0 switches interpolation off",
        ),
        integer(
            "ar",
            |s| &mut light(s).options.ambient.resolution,
            "ambient resolution",
            "N",
            "finest spacing of irradiance values is the scene's size times -aa over this",
        ),
        integer(
            "ad",
            |s| &mut light(s).options.ambient.divisions,
            "ambient divisions",
            "N",
            "samples of a hemisphere; 0 for no interreflection",
        ),
        integer(
            "as",
            |s| &mut light(s).options.ambient.super_samples,
            "ambient super-samples",
            "N",
            "extra samples of a hemisphere, spent where neighbours differ",
        ),
        Row::new(
            "me",
            Place::Colour(|s| &mut light(s).options.medium.extinction),
            "extinction of the air, per unit length",
        )
        .shown(Label::Tiny("mist extinction coefficient"))
        .values("R G B"),
        Row::new("ma", Place::Colour(|s| &mut light(s).options.medium.albedo), "scattering albedo of the air")
            .shown(Label::Plain("mist scattering albedo"))
            .values("R G B"),
        real(
            "mg",
            |s| &mut light(s).options.medium.eccentricity,
            "mist scattering eccentricity",
            "G",
            "Henyey-Greenstein eccentricity of the air: 1 scatters forward, 0 evenly",
        ),
        real(
            "ms",
            |s| &mut light(s).options.medium.sampling,
            "mist sampling distance",
            "DISTANCE",
            "distance between samples of light scattered in the air",
        ),
    ];
    rows.extend(limit_rows());
    rows.extend(file_rows());
    rows.push(goal_row());
    rows.extend(system_rows());
    rows
}

/// `-cs -cw -lr -lw -am`: those of `-defaults` after the light.
fn limit_rows<S: Carries<Rendering>>() -> Vec<Row<S>> {
    let mut rows = spectrum_rows();
    rows.extend(vec![
        Row::new(
            "lr",
            Place::Integer(|s: &mut S| &mut s.part().options.limits.reflections),
            "most reflections of a ray; 0 or less: end rays at random, without bias (and after this many at most)",
        )
        .shown(Label::Own(|s| {
            let n = s.part().options.limits.reflections;
            let roulette = if n <= 0 { " (Russian roulette)" } else { "" };
            Label::tabs(&format!("-lr {n:<9}"), 3, &format!("limit reflection{roulette}"))
        }))
        .values("N"),
        Row::new("lw", Place::Real(|s: &mut S| &mut s.part().options.limits.weight), "least weight of a ray")
            .shown(Label::Tiny("limit weight"))
            .values("WEIGHT"),
        Row::new(
            "am",
            Place::Reals(1, |s: &mut S, v| {
                if v[0] <= 0.0 {
                    return Err(Failure::user("invalid max photon search radius"));
                }
                s.part().photon_radius = v[0];
                Ok(())
            }),
            "greatest radius in which photons are looked for",
        )
        .shown(Label::Own(|s| {
            Label::tabs(&format!("-am {:.1}", s.part().photon_radius), 4, "max photon search radius")
        }))
        .values("RADIUS"),
    ]);
    rows
}

/// Files, names and definitions, which `-defaults` does not print.
fn file_rows<S: Carries<Rendering> + Carries<Common>>() -> Vec<Row<S>> {
    fn light<S: Carries<Rendering>>(s: &mut S) -> &mut Rendering {
        s.part()
    }
    let word = |flag, act, values, help| Row::new(flag, Place::Word(act), help).values(values);
    vec![
        Row::new(
            "af",
            Place::Text(|s: &mut S| &mut light(s).ambient_file),
            "keep irradiance values in this file and use those in it",
        )
        .values("FILE"),
        word(
            "-reuse",
            |s: &mut S, how, _| {
                light(s).reuse = match how.as_str() {
                    "auto" => Some(Reuse::Auto),
                    "strict" => Some(Reuse::Strict),
                    "append" => Some(Reuse::Append),
                    "read-only" => Some(Reuse::ReadOnly),
                    "off" => None,
                    other => {
                        let known = ["auto", "strict", "append", "read-only", "off"];
                        return Err(Failure::choice("--reuse", other, &known));
                    }
                };
                Ok(())
            },
            "HOW",
            "which values of the ambient file count: auto (those of the same scene; another scene's are left alone, with \
             a warning, and a file of its own beside them is used), strict (a difference is an error), append (all), \
             read-only (as auto, and nothing is written), off (the file is neither read nor written)",
        ),
        word(
            "ae",
            |s: &mut S, name, _| light(s).names([name], false),
            "MODIFIER",
            "no interreflection on surfaces of this modifier",
        ),
        word(
            "ai",
            |s: &mut S, name, _| light(s).names([name], true),
            "MODIFIER",
            "interreflection only on surfaces of this modifier",
        ),
        word(
            "aE",
            |s: &mut S, file, outside| light(s).names(outside.list(&file, "ambient exclude")?, false),
            "FILE",
            "as -ae for every word of a file",
        ),
        word(
            "aI",
            |s: &mut S, file, outside| light(s).names(outside.list(&file, "ambient include")?, true),
            "FILE",
            "as -ai for every word of a file",
        ),
        Row::new(
            "ap",
            Place::WordAndIntegers(2, |s: &mut S, file, counts| light(s).photon_map(file, counts)),
            "use a photon map (not supported)",
        )
        .values("FILE"),
        word(
            "f",
            |s: &mut S, file, _| {
                light(s).functions.push(Function::File(file));
                Ok(())
            },
            "FILE",
            "load a function file before the scene's own",
        ),
        word(
            "e",
            |s: &mut S, text, _| {
                if text.contains(['=', ':']) {
                    light(s).functions.push(Function::Expression(text));
                } else {
                    let common: &mut Common = s.part();
                    common.error_file = Some(text);
                }
                Ok(())
            },
            "FILE|EXPRESSION",
            "append messages to a file; or, with = or : in it, define a variable for function files",
        ),
        Row::new(
            "-stats",
            Place::Bare(|s: &mut S| light(s).statistics = true),
            "say in the end what interreflection took: records, look-ups, hemispheres, time, estimated error",
        ),
        Row::new("-seed", Place::Seed(|s: &mut S| &mut light(s).options.seed), "change every random number")
            .values("N"),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_kind_of_list_wins() {
        let mut r = Rendering::new(Options::rpict());
        r.names(["a".into()], false).unwrap();
        r.names(["b".into(), "c".into()], true).unwrap();
        r.names(["d".into()], true).unwrap();
        let names = ["b", "c", "d"].map(String::from).to_vec();
        assert_eq!(r.options.ambient.selection, Selection::Include(names));
        assert!(r.names(vec![String::from("x"); NAME_LIMIT], true).is_err());
    }

    #[test]
    fn what_cannot_be_calculated_is_refused() {
        let mut r = Rendering::new(Options::rpict());
        assert!(r.check().is_ok());
        r.spectrum.samples = 9;
        assert!(r.check().is_ok());
        assert_eq!(r.options.spectrum.bins(), 9);
        r.ambient_file = Some("x.amb".into());
        assert!(r.check().is_ok());
        r.spectrum.samples = 2;
        assert_eq!(r.check().unwrap_err().text, "unsupported spectral sampling");
        let mut r = Rendering::new(Options::rpict());
        r.photon_map("g.pm".into(), &[50]).unwrap();
        assert!(r.check().unwrap_err().text.contains("g.pm"));
        assert_eq!(r.options.ambient.bounces, 1);
    }
}
