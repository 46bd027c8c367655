//! Going on with a picture that was interrupted (`-r`, `-ro`).

use crate::session::{Session, Stop};
use ambit_base::Notify;
use ambit_cli::Failure;
use ambit_file::{Orientation, PictureReader, PixelSpace, View, name_of, os_text, path_of};
use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// What an interrupted picture still has.
pub(crate) struct Recovered {
    /// What the user calls the file.
    called: String,
    /// The file.
    file: PathBuf,
    /// Its lines can be copied, and the file be removed then.
    usable: bool,
    /// Its view, if its header has one.
    pub(crate) view: Option<View>,
    /// Width and height.
    pub(crate) size: (u32, u32),
    /// Scanlines that are whole, from the top.
    pub(crate) lines: Vec<Vec<[u8; 4]>>,
}

impl Recovered {
    /// Gives the file its name back, for another try; what to say if it stays where it was set aside.
    pub(crate) fn give_back(&self) -> Result<(), String> {
        let path = path_of(&self.called);
        if self.file == path {
            return Ok(());
        }
        let stays = |e| format!("the recover file is now \"{}\" ({})", name_of(&self.file), os_text(&e));
        fs::rename(&self.file, path).map_err(stays)
    }

    /// Removes the file, whose lines have been copied.
    pub(crate) fn remove(&self) -> Result<(), Failure> {
        if !self.usable {
            return Ok(());
        }
        fs::remove_file(&self.file)
            .map_err(|e| Failure::system(format!("cannot remove \"{}\"", name_of(&self.file)), &e))
    }

    /// The error of one that is not as large as it must be, and where its file stays if not at its name.
    pub(crate) fn mismatch(&self, stays: Option<String>) -> Failure {
        let failure = Failure::user(format!("resolution mismatch in recover file \"{}\"", self.called));
        Failure { hint: stays, ..failure }
    }
}

/// Moves the file out of the way if the new picture will have its name. Returns its name from now on, `None` if there
/// is no such file.
pub(crate) fn set_aside(session: &Session, file: &str, output: Option<&str>) -> Result<Option<PathBuf>, Stop> {
    let path = path_of(file);
    if output != Some(file) {
        return Ok(Some(path));
    }
    if !path.exists() {
        session.messages.warn(&format!("new output file \"{file}\""));
        return Ok(None);
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let spare = spare_name(folder, std::process::id());
    fs::rename(&path, &spare).map_err(|e| Failure::system(format!("cannot rename \"{file}\""), &e))?;
    Ok(Some(spare))
}

/// A name `rfXXXXXX` that is free in a folder.
fn spare_name(folder: &Path, seed: u32) -> PathBuf {
    const LETTERS: &[u8; 36] = b"abcdefghijklmnopqrstuvwxyz0123456789";
    let mut number = u64::from(seed);
    loop {
        let mut digits = ambit_base::mix(number, 0x7266);
        let mut name = String::from("rf");
        for _ in 0..6 {
            name.push(char::from(LETTERS[(digits % 36) as usize]));
            digits /= 36;
        }
        let path = folder.join(name);
        if !path.exists() {
            return path;
        }
        number += 1;
    }
}

/// Reads what is there, with Radiance's warnings if nothing is.
pub(crate) fn read(session: &Session, called: &str, file: PathBuf, space: PixelSpace) -> Option<Recovered> {
    let called = called.to_owned();
    let name = name_of(&file).into_owned();
    let warn = |text: String| session.messages.warn(&text);
    let Ok(open) = File::open(&file) else {
        warn(format!("cannot recover view parameters from \"{name}\""));
        warn(format!("cannot open recover file \"{name}\""));
        return None;
    };
    let reader = PictureReader::new(BufReader::new(open), &name).ok();
    let mut view = View::default();
    let told = reader.as_ref().is_some_and(|reader| view.apply_header(&reader.header, &session.program) > 0);
    if !told {
        warn(format!("cannot recover view parameters from \"{name}\""));
    }
    let view = told.then_some(view);
    let Some(mut reader) = reader else {
        warn(format!("bad recover file \"{name}\" - not removed"));
        return None;
    };
    let resolution = reader.resolution;
    let size = (resolution.scanline_length(), resolution.scanlines());
    let mut lines = Vec::new();
    if resolution.orientation != Orientation::TEXT || reader.space != space {
        // Turned or mirrored since it was made, or in other colours: its view and its size serve, its lines do not.
        warn(format!("bad recover file \"{name}\" - not removed"));
        return Some(Recovered { called, file, usable: false, view, size, lines });
    }
    // A line that was cut off is no line.
    while let Ok(Some(line)) = reader.next_codes() {
        lines.push(line.to_vec());
    }
    Some(Recovered { called, file, usable: true, view, size, lines })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_does_not_get_its_name_back_is_named() {
        let folder = tempfile::tempdir().expect("a scratch folder can be made");
        let [spare, named] = ["rfabcdef", "p.hdr"].map(|name| folder.path().join(name));
        let called = name_of(&named).into_owned();
        let recovered =
            Recovered { called, file: spare.clone(), usable: true, view: None, size: (1, 1), lines: Vec::new() };
        let stays = recovered.give_back().expect_err("there is no such file");
        assert_eq!(stays, format!("the recover file is now \"{}\" (No such file or directory)", spare.display()));
        assert_eq!(recovered.mismatch(Some(stays.clone())).hint, Some(stays));

        fs::write(&spare, "lines").expect("it can be written");
        assert_eq!(recovered.give_back(), Ok(()));
        assert!(named.exists() && !spare.exists());
        assert_eq!(recovered.mismatch(None).hint, None);
    }
}
