//! Between the programs and the renderer: loading, the ambient file, and answers to batches of rays.

use crate::session::{Session, Stop};
use crate::spectral::{Channels, SpectralConversion};
use ambit_base::{EPSILON, Rgb};
use ambit_cli::{Class, Failure, Function, Output, Rendering};
use ambit_file::{Header, general, path_of};
use ambit_octree::Source;
use ambit_render::picture::SourceOutline;
use ambit_render::{
    Answer, Definition, Environment, Options, Rays, Renderer, Request, SceneFingerprint, Seen, Spectra, Store, Visit,
    load,
};
use ambit_scene::{Commands, ErrorClass, ObjectId};

/// What answers rays: the renderer, or a stand-in for tests.
pub(crate) trait Light {
    /// Answers a batch, in order; the answers replace what is in `answers`.
    fn trace(&mut self, requests: &[Request], answers: &mut Vec<Answer>) -> Result<(), Stop>;
    /// What a picture needs of the answers to a batch, in order; it replaces what is in `seen`.
    fn see(&mut self, rays: &dyn Rays, seen: &mut Vec<Seen>) -> Result<(), Stop>;
    /// Answers one ray, and shows all that follow from it as they finish.
    fn trace_tree(&mut self, request: &Request, visit: Visit<'_>) -> Result<Answer, Stop>;
    /// An error if a signal has asked the work to stop.
    fn check(&self) -> Result<(), Stop> {
        Ok(())
    }
    /// Spectra of the last batch, if the calculation is by wavelength.
    fn spectra(&self) -> Option<&Spectra> {
        None
    }
    /// The name of an object.
    fn name(&self, id: ObjectId, modifier: ObjectId) -> &[u8];
}

/// A scene that is lit.
pub(crate) struct Scene<'a> {
    session: &'a Session,
    renderer: Renderer,
    /// Of a calculation by wavelength.
    spectrum: Option<Spectral>,
    /// Of the scene, until the ambient file is opened, if there is one.
    fingerprint: Option<SceneFingerprint>,
    /// The statistics have been printed.
    told: bool,
    /// The octree's header.
    pub(crate) header: Header,
}

/// What is kept of a calculation by wavelength.
struct Spectral {
    /// Spectra of the last batch.
    spectra: Option<Spectra>,
    /// What answers are converted to.
    conversion: SpectralConversion,
}

impl Spectral {
    /// What answer `i` is converted to.
    fn colour(&self, spectra: &Spectra, i: usize) -> Rgb {
        let mut channels = Channels::default();
        self.conversion.apply(spectra.bins(i).value, &mut channels);
        Rgb::from_slice(&channels)
    }
}

impl<'a> Scene<'a> {
    /// Loads the octree and prepares the calculation, which [`Scene::begin`] begins.
    ///
    /// `casting` says that rays are only cast, so that the ambient file stays closed. Values of answers are red, green
    /// and blue, or, in a calculation by wavelength, the channels of `output`.
    pub(crate) fn open(
        session: &'a Session,
        source: Source,
        rendering: &Rendering,
        casting: bool,
        output: Output,
    ) -> Result<Self, Stop> {
        let find = |name: &str| session.search.find_path(name);
        let definitions: Vec<Definition> = rendering
            .functions
            .iter()
            .map(|f| match f {
                Function::File(name) => Definition::File(name.clone()),
                Function::Expression(text) => Definition::Text(text.clone()),
            })
            .collect();
        let commands = Commands::new(&session.search);
        let environment = Environment { find: &find, commands, notify: &session.messages, definitions: &definitions };
        let loaded = load(source, &environment).map_err(failed)?;
        let header = loaded.header().clone();
        // Where nothing asks for records, a file without them would only be in the way of runs that do.
        let ambient = rendering.ambient_file.as_ref().filter(|_| !casting && rendering.options.ambient.asks());
        let fingerprint = ambient.map(|_| loaded.fingerprint(&environment));
        let options = Options { casting, ..rendering.options.clone() };
        let mut renderer = Renderer::new(loaded, options, &environment).map_err(failed)?;
        // What is estimated beforehand must be as what the file allows.
        if let (Some(_), Some(file), Some(reuse), Some(scene)) =
            (rendering.goal, ambient, rendering.reuse, &fingerprint)
        {
            let fingerprint = &scene.clone().with(&rendering.options);
            renderer.foresee(&Store { path: &path_of(file), header: &[], fingerprint, reuse, owner: "" });
        }
        let spectrum = &rendering.options.spectrum;
        let spectrum = (!spectrum.is_rgb())
            .then(|| Spectral { spectra: None, conversion: SpectralConversion::new(output, spectrum) });
        Ok(Self { session, renderer, spectrum, fingerprint, told: false, header })
    }

    /// Begins anew with an empty cache, the seed of `settings`, and what of them trades time for error.
    pub(crate) fn restart(&mut self, settings: &Options) {
        self.renderer.restart(settings);
    }

    /// Opens the ambient file and begins to measure. From here on settings stay; `name` is the octree's.
    pub(crate) fn begin(&mut self, name: &str, rendering: &Rendering) -> Result<(), Stop> {
        let messages = &self.session.messages;
        let scene = self.fingerprint.take();
        let ambient = rendering.ambient_file.as_ref().zip(rendering.reuse).zip(scene);
        if let Some(((file, reuse), scene)) = ambient {
            let ambient = &rendering.options.ambient;
            if ambient.accuracy > EPSILON {
                let (header, owner) = (ambient_header(&self.session.program, rendering, name), owner());
                let fingerprint = &scene.with(&rendering.options);
                let store = Store { path: &path_of(file), header: &header, fingerprint, reuse, owner: &owner };
                self.renderer.share(&store, messages).map_err(failed)?;
            } else {
                let text = format!("zero ambient accuracy so \"{file}\" not opened");
                ambit_base::Notify::warn(messages, &text);
            }
        }
        if rendering.counts || rendering.statistics {
            self.renderer.measure(crate::statistics::clock);
        }
        if rendering.statistics {
            self.renderer.time_steps(crate::statistics::clock, crate::statistics::own);
        }
        self.session.begin_work();
        Ok(())
    }

    /// Outlines of the light sources.
    pub(crate) fn outlines(&self) -> Vec<SourceOutline> {
        self.renderer.source_outlines()
    }

    /// Closes the ambient file; call it whatever happened.
    pub(crate) fn close(mut self) -> Result<(), Stop> {
        let result = self.renderer.finish(&self.session.messages).map_err(failed);
        self.tell();
        result
    }

    /// Prints the statistics, unless that has been done.
    pub(crate) fn tell(&mut self) {
        if std::mem::replace(&mut self.told, true) {
            return;
        }
        if let Some(report) = self.renderer.report() {
            for line in crate::statistics::lines(&report, self.session.meter.seconds()) {
                self.session.messages.print(format_args!("statistics - {line}"));
            }
        }
    }
}

impl Light for Scene<'_> {
    fn trace(&mut self, requests: &[Request], answers: &mut Vec<Answer>) -> Result<(), Stop> {
        let notify = &self.session.messages;
        match &mut self.spectrum {
            None => self.renderer.trace(requests, notify, answers).map_err(failed)?,
            Some(spectral) => {
                let spectra;
                (*answers, spectra) = self.renderer.trace_spectra(requests, notify).map_err(failed)?;
                for (i, answer) in answers.iter_mut().enumerate() {
                    answer.value = spectral.colour(&spectra, i);
                }
                spectral.spectra = Some(spectra);
            }
        }
        self.session.meter.set_rays(self.renderer.rays());
        Ok(())
    }

    fn see(&mut self, rays: &dyn Rays, seen: &mut Vec<Seen>) -> Result<(), Stop> {
        if self.spectrum.is_none() {
            self.renderer.see(rays, &self.session.messages, seen).map_err(failed)?;
            self.session.meter.set_rays(self.renderer.rays());
            return Ok(());
        }
        // Spectra are made of whole answers.
        let (places, requests): (Vec<usize>, Vec<Request>) =
            (0..rays.count()).filter_map(|k| Some((k, rays.ray(k)?))).unzip();
        let mut answers = Vec::new();
        self.trace(&requests, &mut answers)?;
        seen.clear();
        seen.resize(rays.count(), Seen::default());
        for (place, answer) in places.into_iter().zip(answers) {
            seen[place] = Seen::from(&answer);
        }
        Ok(())
    }

    fn trace_tree(&mut self, request: &Request, visit: Visit<'_>) -> Result<Answer, Stop> {
        let (mut answer, spectra) = self.renderer.trace_tree(request, &self.session.messages, visit).map_err(failed)?;
        if let (Some(spectral), Some(spectra)) = (&mut self.spectrum, spectra) {
            answer.value = spectral.colour(&spectra, 0);
            spectral.spectra = Some(spectra);
        }
        self.session.meter.set_rays(self.renderer.rays());
        Ok(answer)
    }

    fn check(&self) -> Result<(), Stop> {
        self.session.check()
    }

    fn spectra(&self) -> Option<&Spectra> {
        self.spectrum.as_ref()?.spectra.as_ref()
    }

    fn name(&self, id: ObjectId, modifier: ObjectId) -> &[u8] {
        self.renderer.name(id, modifier)
    }
}

/// The octree of this name, which may be a `!command`.
pub(crate) fn octree(name: &str, session: &Session) -> Result<Source, Stop> {
    Source::open(name, &mut Commands::new(&session.search)).map_err(|e| failed(e.into()))
}

#[expect(clippy::needless_pass_by_value, reason = "it is what map_err hands over")]
fn failed(error: ambit_render::Error) -> Stop {
    let class = match error.class() {
        ErrorClass::User => Class::User,
        ErrorClass::System => Class::System,
        ErrorClass::Internal => Class::Internal,
    };
    let place = error.location();
    // The text is Radiance's; the place comes after it, as scripts look at the beginning.
    let text = if place.line > 0 { format!("{error} ({place})") } else { error.to_string() };
    Stop::Failure(Failure::new(class, text))
}

/// A name for this process among all that share a file system.
fn owner() -> String {
    let host = rustix::system::uname().nodename().to_string_lossy().replace(|c: char| !c.is_ascii_alphanumeric(), "_");
    format!("{host}-{}", std::process::id())
}

/// The header lines of a new ambient file: the options that its values depend on, in Radiance's order.
fn ambient_header(program: &str, rendering: &Rendering, octree: &str) -> Vec<String> {
    let o = &rendering.options;
    let g = |x: f64| general(x, 6);
    let f = |x: f32| general(f64::from(x), 6);
    let (a, d, s) = (&o.ambient, &o.direct, &o.specular);
    let flag = |name: &str, on: bool, usual: bool| {
        if on == usual { String::new() } else { format!(" -{name}{}", if on { '+' } else { '-' }) }
    };
    let medium = o.medium;
    let [longest, .., shortest] = o.spectrum.limits();
    let mist = if medium.extinction.max_element() > 0.0 {
        let (e, m) = (medium.extinction, medium.albedo);
        format!(
            " -me {} {} {} -ma {} {} {} -mg {} -ms {}",
            f(e.x),
            f(e.y),
            f(e.z),
            f(m.x),
            f(m.y),
            f(m.z),
            g(medium.eccentricity),
            g(medium.sampling)
        )
    } else {
        String::new()
    };
    let line = format!(
        "{program} -av {} {} {} -aw {} -ab {} -aa {} -ad {} -as {} -ar {}{mist}{}{} -dr {} -ds {} -dt {} -dc {} -ss {} -st {} \
         -lr {} -lw {} -cw {} {} -cs {} {octree}",
        f(a.value.x),
        f(a.value.y),
        f(a.value.z),
        a.weight,
        a.bounces,
        g(a.accuracy),
        a.divisions,
        a.super_samples,
        a.resolution,
        flag("bv", o.back_visible, true),
        flag("dv", d.visible, true),
        d.relays,
        g(d.sampling),
        g(d.threshold),
        g(d.certainty),
        g(s.sampling),
        g(s.threshold),
        o.limits.reflections,
        g(o.limits.weight),
        g(shortest),
        g(longest),
        o.spectrum.bins()
    );
    let [date, gmt] = Session::time_lines();
    vec![line, format!("SOFTWARE= {}", ambit_cli::VERSION), date, gmt]
}
