//! What a rendering program does around its work: reading the command line, messages, signals, the exit status.

use ambit_cli::{
    About, Common, ConsoleMessages, Failure, Features, Outside, Process, Progress, Row, Scan, Signals, VERSION, answer,
    attach_error_file, broken_pipes_end, completions, defaults, long_help, man_page, scan,
};
use ambit_file::{
    Library, SearchPath, Zone, base_name, bytes_of, capture_lines, command_line, text_of, variable, word_of,
};
use std::ffi::OsString;
use std::io::{self, Write};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::SystemTime;

/// Why a program ends before its work is done.
#[derive(Debug)]
pub(crate) enum Stop {
    /// An error.
    Failure(Failure),
    /// A signal, of which the watcher has told already.
    Signal,
    /// Nobody reads the output any more.
    BrokenPipe,
}

impl From<Failure> for Stop {
    fn from(failure: Failure) -> Self {
        Self::Failure(failure)
    }
}

impl Stop {
    /// An error of writing; `what` as in `write error`.
    pub(crate) fn writing(what: &str, error: &io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe && broken_pipes_end() {
            Self::BrokenPipe
        } else {
            Self::Failure(Failure::system(what, error))
        }
    }
}

/// How far the work is, for reports from any thread.
#[derive(Debug)]
pub(crate) struct Meter {
    progress: Progress,
    rays: AtomicU64,
    /// Percentage × 2³².
    percent: AtomicU64,
}

impl Meter {
    const ONE: f64 = 4294967296.0;

    /// Sets the number of rays.
    pub(crate) fn set_rays(&self, rays: u64) {
        self.rays.store(rays, Ordering::Relaxed);
    }

    /// Sets the percentage.
    pub(crate) fn set_percent(&self, percent: f64) {
        self.percent.store((percent * Self::ONE) as u64, Ordering::Relaxed);
    }

    /// The report as of now.
    pub(crate) fn line(&self) -> String {
        self.progress.line(self.rays.load(Ordering::Relaxed), self.percent())
    }

    /// The percentage.
    pub(crate) fn percent(&self) -> f64 {
        self.percent.load(Ordering::Relaxed) as f64 / Self::ONE
    }

    /// Seconds since the start.
    pub(crate) fn seconds(&self) -> f64 {
        self.progress.elapsed().as_secs_f64()
    }

    /// Prints the report on standard error.
    pub(crate) fn report(&self) {
        let _ = writeln!(io::stderr(), "{}", self.line());
    }
}

/// What a program is called by.
pub(crate) struct Tool<S: 'static> {
    pub(crate) about: About,
    pub(crate) features: Features,
    pub(crate) table: Vec<Row<S>>,
}

/// A running program.
pub(crate) struct Session {
    /// Name as called, without folders.
    pub(crate) program: String,
    /// Options after expansion.
    pub(crate) words: Vec<String>,
    /// Flags of the options that were given.
    pub(crate) flags: Vec<&'static str>,
    /// Octree argument.
    pub(crate) octree: Option<String>,
    /// What follows it.
    excess: Vec<String>,
    /// Where auxiliary files are.
    pub(crate) search: SearchPath,
    /// Prints messages.
    pub(crate) messages: ConsoleMessages,
    /// For reports.
    pub(crate) meter: Arc<Meter>,
    stop: Arc<AtomicBool>,
    signals: Option<Signals>,
}

/// The name and the words of a command line; bytes that are no text are kept ([`ambit_file::text_of`]).
pub(crate) fn split(mut arguments: impl Iterator<Item = OsString>) -> (String, Vec<String>) {
    let text = |word: OsString| word_of(&word);
    let called = arguments.next().map(text).unwrap_or_default();
    let program = text_of(base_name(&bytes_of(&called))).into_owned();
    (program, arguments.map(text).collect())
}

/// Where auxiliary files are, as the environment says.
pub fn search_path() -> SearchPath {
    SearchPath::new(variable("RAYPATH").as_deref(), variable("HOME").as_deref(), Library::NONE)
}

impl Session {
    /// A session that knows nothing but its name.
    pub(crate) fn new(program: String, reports: bool) -> Self {
        let search = search_path();
        let meter = Meter { progress: Progress::start(&program), rays: AtomicU64::new(0), percent: AtomicU64::new(0) };
        let mut session = Self {
            messages: ConsoleMessages { program: program.clone(), warnings: true },
            program,
            words: Vec::new(),
            flags: Vec::new(),
            octree: None,
            excess: Vec::new(),
            search,
            meter: Arc::new(meter),
            stop: Arc::new(AtomicBool::new(false)),
            signals: None,
        };
        session.watch(reports);
        session
    }

    fn watch(&mut self, reports: bool) {
        let (messages, stop, meter) = (self.messages.clone(), Arc::clone(&self.stop), Arc::clone(&self.meter));
        let on_end = move |signal: ambit_cli::Caught| {
            messages.print(format_args!("signal - {}", signal.name()));
            stop.store(true, Ordering::Release);
        };
        let on_report = move || {
            if reports {
                meter.report();
            }
        };
        // Without them the program does its work all the same.
        self.signals = Signals::watch(on_end, on_report).ok();
    }

    /// Reads the command line. Returns false if it was answered and there is nothing left to do.
    pub(crate) fn read<S>(&mut self, words: Vec<String>, tool: &Tool<S>, settings: &mut S) -> Result<bool, Stop>
    where
        S: ambit_cli::Carries<ambit_cli::Rendering> + ambit_cli::Carries<Common>,
    {
        if words.first().is_some_and(|w| w == "-features") {
            let (text, missing) = tool.features.answer(&words[1..]);
            answer(text.as_bytes());
            return match missing {
                None => Ok(false),
                Some(text) => {
                    // No class word here.
                    self.messages.print(text);
                    Err(Failure::user("").into())
                }
            };
        }
        let search = &self.search;
        let read = |name: &str| {
            let found = search.find_path(name).ok_or_else(|| io::Error::from_raw_os_error(NO_SUCH_FILE))?;
            std::fs::read(found)
        };
        let outside: &dyn Outside = &Process { program: &self.program, read: &read };
        let result = scan(words, &tool.table, settings, outside);
        let common: &mut Common = settings.part();
        self.messages.warnings = common.warnings;
        let rendering: &mut ambit_cli::Rendering = settings.part();
        for notice in rendering.notices.drain(..) {
            ambit_base::Notify::warn(&self.messages, &notice);
        }
        match result? {
            Scan::Run { octree, words, flags, excess } => {
                (self.octree, self.words, self.flags, self.excess) = (octree, words, flags, excess);
                return Ok(true);
            }
            Scan::Version => answer(format!("{VERSION}\n").as_bytes()),
            Scan::Defaults => answer(defaults(&tool.table, settings).as_bytes()),
            Scan::Help => answer(long_help(&tool.about, &tool.table).as_bytes()),
            Scan::Man => answer(&man_page(&tool.about, &tool.table)),
            Scan::Completions(shell) => {
                let script = completions(&tool.about, &tool.table, &shell)
                    .ok_or_else(|| Failure::user(format!("no completions for shell '{shell}' (bash, zsh, fish)")))?;
                answer(&script);
            }
        }
        Ok(false)
    }

    /// Opens the error file, which takes all messages from here on: those about values of options and about the view
    /// come before, those about what does not go together after it.
    pub(crate) fn attach(&self, common: &Common) -> Result<(), Stop> {
        if let Some(file) = &common.error_file {
            let words = self.words.iter().chain(&self.octree).chain(&self.excess).map(|w| bytes_of(w));
            let command = command_line(&bytes_of(&self.program), words);
            // Radiance ends without a word.
            attach_error_file(file, &command)
                .map_err(|e| Failure::system(format!("cannot open error file \"{file}\""), &e))?;
        }
        match (&self.octree, self.excess.first()) {
            (Some(octree), Some(word)) => {
                let hint = if word.starts_with('-') { "options come before it" } else { "nothing may follow it" };
                Err(Failure::at(octree).hint(format!("'{octree}' is taken for the octree, and {hint}")).into())
            }
            _ => Ok(()),
        }
    }

    /// Refuses to attach to a program that stays behind: there is none, every run renders by itself.
    pub(crate) fn refuse_attachment(&self, common: &Common) -> Result<(), Failure> {
        if common.persist.is_some() && self.octree.is_none() {
            return Err(Failure::unsupported("persist mode (-P, -PP) without an octree is"));
        }
        Ok(())
    }

    /// From here on there are files to close: a signal leaves time for that.
    pub(crate) fn begin_work(&self) {
        if let Some(signals) = &self.signals {
            signals.begin_work();
        }
    }

    /// Set once a signal has asked the work to stop.
    pub(crate) fn stop(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop)
    }

    /// An error if a signal has asked the work to stop.
    pub(crate) fn check(&self) -> Result<(), Stop> {
        if self.stop.load(Ordering::Acquire) { Err(Stop::Signal) } else { Ok(()) }
    }

    /// Header lines of this command: itself and the software.
    pub(crate) fn command_lines(&self) -> [Vec<u8>; 2] {
        [
            command_line(&bytes_of(&self.program), self.words.iter().map(|w| bytes_of(w))),
            format!("SOFTWARE= {VERSION}").into_bytes(),
        ]
    }

    /// Header lines of the time.
    pub(crate) fn time_lines() -> [String; 2] {
        capture_lines(SystemTime::now(), &Zone::from_variable(variable("TZ").as_deref()))
    }

    /// Tells how it ended and returns the status.
    pub(crate) fn end(&self, result: Result<(), Stop>) -> ExitCode {
        if let Some(signals) = &self.signals {
            signals.finish();
        }
        match result {
            Ok(()) => ExitCode::SUCCESS,
            Err(Stop::Signal) => ExitCode::from(3),
            Err(Stop::BrokenPipe) => {
                self.messages.print("signal - Broken pipe");
                ExitCode::from(3)
            }
            Err(Stop::Failure(failure)) => {
                if !failure.text.is_empty() {
                    self.messages.fail(&failure);
                }
                ExitCode::from(failure.class.status())
            }
        }
    }
}

/// The system's number for "No such file or directory".
const NO_SUCH_FILE: i32 = 2;
