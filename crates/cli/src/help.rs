//! Help for people: `--help`, the man page and completions for shells, all made by clap from the table of options.
//!
//! clap knows no options of one dash and several letters, so the texts are made with two and corrected afterwards.

use crate::table::{Place, Row};
use clap::{Arg, ArgAction, Command};

/// What is said of a program besides its options.
#[derive(Clone, Copy, Debug)]
pub struct About {
    /// Its name.
    pub name: &'static str,
    /// What it does, in a line.
    pub summary: &'static str,
    /// What follows the name in its synopsis.
    pub synopsis: &'static str,
    /// What is said after the options.
    pub notes: &'static str,
}

const FORMS: &str = "Options are read from left to right; the last of several equal ones counts. A switch alone \
    toggles; with + or 1 right after it, it is on, with - or 0 off. @FILE and $NAME stand for the words of a file or of \
    an environment variable.";

/// A command that has the table's options, for clap's generators.
pub fn command<S>(about: &About, table: &[Row<S>]) -> Command {
    let mut command = Command::new(about.name)
        .version(env!("CARGO_PKG_VERSION"))
        .about(about.summary)
        .override_usage(format!("{} {}", about.name, about.synopsis))
        .after_help(format!("{FORMS}\n\n{}", about.notes))
        .disable_help_flag(true)
        .disable_version_flag(true)
        .next_line_help(false);
    for row in table {
        command = command.arg(argument(row));
    }
    let own = [
        ("defaults", "print the options as set by those before this one"),
        ("version", "print the version"),
        ("features", "print what this program can do (only as the first argument)"),
        ("help", "print this help"),
        ("man", "print the manual page"),
    ];
    for (name, help) in own {
        command = command.arg(Arg::new(format!("own {name}")).long(name).help(help).action(ArgAction::SetTrue));
    }
    let shells = "print completions for bash, zsh or fish";
    command.arg(Arg::new("own completions").long("completions").value_name("SHELL").help(shells))
}

fn argument<S>(row: &Row<S>) -> Arg {
    let help = row.help;
    let glued = matches!(row.place, Place::Glued(..));
    let long = row.flag.trim_start_matches('-').to_owned() + if glued { row.values } else { "" };
    let arg = Arg::new(long.clone()).long(long).help(help).help_heading(heading(row.flag));
    if row.values.is_empty() || glued {
        return arg.action(ArgAction::SetTrue);
    }
    let names: Vec<&str> = row.values.split(' ').collect();
    arg.num_args(names.len()).value_names(names).action(ArgAction::Append).allow_hyphen_values(true)
}

/// The group of an option.
fn heading(flag: &str) -> &'static str {
    match flag {
        "i" | "u" | "bv" | "-seed" => "General",
        "pRGB" | "pXYZ" | "pc" | "pY" | "pS" | "pM" | "pA" | "co" | "fIO" | "o" | "h" | "ro" | "r" | "z" | "S" => {
            "Output"
        }
        "-error" => "Quality",
        "-reuse" | "-stats" | "-unbiased" | "-unbounded-bounces" | "-exact-textures" | "-actual-weights"
        | "-bounces" | "-neighbor-clamping" | "-measured-reuse" | "-overlap" | "-smoothing" | "-interpolation"
        | "-spacing" | "-step-test" => "Interreflection",
        _ => match flag.as_bytes()[0] {
            b'v' => "View",
            b'd' => "Direct light",
            b's' => "Highlights",
            b'a' => "Interreflection",
            b'm' => "Air",
            b'l' if flag != "ld" => "Limits",
            b'p' => "Pixels",
            b't' if flag != "t" => "Output",
            b'c' => "Spectrum",
            _ => "Run",
        },
    }
}

/// The text of `--help`.
pub fn long_help<S>(about: &About, table: &[Row<S>]) -> String {
    // A blank in place of the dash keeps the columns.
    single_dashes(&command(about, table).render_help().to_string(), "--", " -", table)
}

/// The man page, in roff.
pub fn man_page<S>(about: &About, table: &[Row<S>]) -> Vec<u8> {
    let mut page = Vec::new();
    // Writing to memory does not fail.
    let _ = clap_mangen::Man::new(command(about, table)).render(&mut page);
    let text = String::from_utf8_lossy(&page).replace("\\-\\-", "--");
    single_dashes(&text, "--", "\\-", table).into_bytes()
}

/// Completions for `bash`, `zsh` or `fish`; `None` for another shell.
pub fn completions<S>(about: &About, table: &[Row<S>], shell: &str) -> Option<Vec<u8>> {
    let shell: clap_complete::Shell = shell.parse().ok()?;
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut command(about, table), about.name, &mut script);
    let text = String::from_utf8_lossy(&script).into_owned();
    // Values follow as words of their own, and options have one dash.
    let text = match shell {
        clap_complete::Shell::Fish => text.replace(" -l ", " -o "),
        clap_complete::Shell::Zsh => text.replace("=[", "["),
        _ => text,
    };
    Some(single_dashes(&text, "--", "-", table).into_bytes())
}

/// Replaces the two dashes before every option of the table that has only one.
fn single_dashes<S>(text: &str, two: &str, one: &str, table: &[Row<S>]) -> String {
    let is_ours = |name: &str| {
        let glued =
            |row: &Row<S>| matches!(row.place, Place::Glued(..)) && name == format!("{}{}", row.flag, row.values);
        table.iter().any(|row| row.flag == name || glued(row)) || matches!(name, "defaults" | "features" | "version")
    };
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find(two) {
        let (before, after) = (&rest[..at], &rest[at + two.len()..]);
        let end = after.find(|c: char| !c.is_ascii_alphanumeric()).unwrap_or(after.len());
        out.push_str(before);
        out.push_str(if is_ours(&after[..end]) { one } else { two });
        out.push_str(&after[..end]);
        rest = &after[end..];
    }
    out + rest
}
