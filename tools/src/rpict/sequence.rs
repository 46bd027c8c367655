//! Sequences of views from standard input (`-S`).

use super::frame::{Frame, Picture, set_up};
use super::output;
use super::recover;
use crate::light::Scene;
use crate::session::Stop;
use ambit_base::Notify;
use ambit_cli::{Failure, PictureOptions};
use ambit_file::{View, integer, is_view_line};
use std::io::{BufRead, Read};

/// Longest line of views, in bytes; what follows counts as a line of its own.
const LONGEST_LINE: usize = 255;

/// The frame to recover, if the options ask for one and may.
fn recover_frame(options: &PictureOptions) -> Result<Option<i32>, Failure> {
    let Some(text) = &options.recover else { return Ok(None) };
    let Some(frame) = integer(text).filter(|_| text.bytes().all(|b| b.is_ascii_digit())) else {
        return Err(Failure::user(format!("bad recover frame \"{text}\"")));
    };
    if frame < options.sequence {
        return Err(Failure::user("recover frame less than start frame"));
    }
    if options.output.is_none() {
        return Err(Failure::user("missing output file specification"));
    }
    Ok(Some(frame))
}

/// Refuses options that do not go together.
pub(crate) fn check(options: &PictureOptions) -> Result<(), Failure> {
    recover_frame(options).map(|_| ())
}

/// Makes a picture of every view.
pub(crate) fn run(picture: &Picture<'_>, scene: &mut Scene<'_>, mut views: impl BufRead) -> Result<(), Stop> {
    let options = picture.options;
    let recovering = recover_frame(options)?;
    let mut view = options.view;
    let mut number = options.sequence;
    let mut previous = if number > 1 { Some(set_up(&options.view)?) } else { None };
    let mut made = false;
    if options.output.is_none() {
        // Once for all pictures on the stream, and even if there is none.
        output::begin(&picture.preamble(&scene.header))?;
    }
    while next_view(&mut views, &mut view, &picture.session.program)? {
        let projection = set_up(&view)?;
        let skipped = recovering.is_some_and(|k| number < k);
        if !skipped {
            let mut frame = plan(picture, projection, number, recovering == Some(number))?;
            frame.previous = previous.filter(|_| options.motion > 0.0);
            made |= picture.make(&frame, scene)?;
        }
        previous = Some(projection);
        number += 1;
    }
    // The frame after the last one was not begun: there is nothing to go on with, and nothing wrong.
    if recovering.is_some_and(|k| number < k) {
        return Err(Failure::user("unexpected EOF on view input").into());
    }
    if !made {
        picture.session.messages.warn("no output produced");
    }
    Ok(())
}

/// The frame of a view.
fn plan(picture: &Picture<'_>, view: ambit_file::Projection, number: i32, recovers: bool) -> Result<Frame, Stop> {
    let options = picture.options;
    let mut frame = Frame::new(view, options);
    frame.number = Some(number);
    frame.distances = options.distances.as_ref().map(|pattern| numbered(pattern, number));
    if let Some(pattern) = &options.output {
        let name = numbered(pattern, number);
        if recovers {
            let aside = recover::set_aside(picture.session, &name, Some(&name))?;
            frame.take_over(aside.and_then(|path| recover::read(picture.session, &name, path, picture.space)))?;
        } else {
            frame.shared = name != *pattern;
        }
        frame.output = Some(name);
    }
    Ok(frame)
}

/// Applies the next line that changes the view; false at the end.
fn next_view(views: &mut impl BufRead, view: &mut View, program: &str) -> Result<bool, Stop> {
    loop {
        let mut line = Vec::new();
        let failed = |e: std::io::Error| Failure::system("cannot read views", &e);
        if (&mut *views).take(LONGEST_LINE as u64).read_until(b'\n', &mut line).map_err(failed)? == 0 {
            return Ok(false);
        }
        if is_view_line(&line, program) && view.apply_line(&line) > 0 {
            return Ok(true);
        }
    }
}

/// A pattern with its number, as `printf` writes it: the first `%d`, `%4d` or `%04d`; `%%` is a `%`.
pub(super) fn numbered(pattern: &str, number: i32) -> String {
    let mut out = String::new();
    let mut rest = pattern;
    let mut used = false;
    while let Some(at) = rest.find('%') {
        let (before, after) = rest.split_at(at);
        out.push_str(before);
        let letter = after[1..].find(|c: char| !c.is_ascii_digit()).map_or(after.len(), |n| n + 1);
        let width = &after[1..letter];
        let count = width.trim_start_matches('0').parse().unwrap_or(0usize).min(64);
        let end = match after.as_bytes().get(letter) {
            Some(b'%') if width.is_empty() => {
                out.push('%');
                letter + 1
            }
            Some(b'd' | b'i') if !used => {
                used = true;
                let zeros = width.starts_with('0');
                let digits = if zeros { format!("{number:0count$}") } else { format!("{number:count$}") };
                out.push_str(&digits);
                letter + 1
            }
            _ => {
                out.push('%');
                1
            }
        };
        rest = &after[end..];
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_numbered_as_printf_does() {
        for (pattern, name) in [
            ("frame%03d.hdr", "frame007.hdr"),
            ("f%d", "f7"),
            ("f%4d", "f   7"),
            ("100%%_%d%%", "100%_7%"),
            ("plain", "plain"),
            ("odd%", "odd%"),
            ("%s%d", "%s7"),
        ] {
            assert_eq!(numbered(pattern, 7), name);
        }
    }

    #[test]
    fn views_accumulate() {
        let mut input = &b"junk\nVIEW= -vp 1 2 3\n-vh 3\nrview -vh 60 -q\nVIEW= nothing\n"[..];
        let mut view = View::default();
        assert!(next_view(&mut input, &mut view, "rpict").unwrap());
        assert!(next_view(&mut input, &mut view, "rpict").unwrap());
        assert_eq!((view.point.y, view.horizontal), (2.0, 60.0));
        assert!(!next_view(&mut input, &mut view, "rpict").unwrap());
    }

    #[test]
    fn recovering_needs_a_frame_and_a_file() {
        let mut options = PictureOptions::new(1);
        options.sequence = 5;
        assert!(check(&options).is_ok());
        options.recover = Some("4".into());
        assert_eq!(check(&options).unwrap_err().text, "recover frame less than start frame");
        options.recover = Some("6".into());
        assert_eq!(check(&options).unwrap_err().text, "missing output file specification");
        options.output = Some("f%d".into());
        assert_eq!(recover_frame(&options).unwrap(), Some(6));
    }
}
