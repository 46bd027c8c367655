//! Damage: found and repaired.
//!
//! A record is 67 bytes long, and what makes no sense as a record is damage. Where programs have written over each
//! other, whole records follow that begin at other places: behind damage the next place is looked for from which several
//! records in a row make sense.

use crate::store::{Failure, Output, PATIENCE, Told, bytes, file, tell};
use ambit_ambient::{Components, Layout, Record, missing, remove_done, scan, segments};
use ambit_file::{FileLock, LockMode, bytes_of, name_of, os_text};
use std::collections::HashSet;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// So many records in a row are no accident.
const RUN: usize = 2;
/// What stands in the records' part of a file.
#[derive(Debug, Default, PartialEq)]
struct Found {
    records: Vec<Record>,
    /// Their bytes as they stand, one after the other.
    kept: Vec<u8>,
    /// Records that do not begin at a multiple of their length.
    displaced: usize,
    /// Records that another is equal to.
    repeated: usize,
    /// Bytes that belong to no record, before the last one.
    damaged: usize,
    /// Bytes after it.
    torn: usize,
}

impl Found {
    fn of(bytes: &[u8], layout: Layout, components: &Components) -> Self {
        let size = layout.record_bytes(components);
        let mut found = Self::default();
        let mut known = HashSet::new();
        let (mut at, mut end) = (0, 0);
        let record = |at: usize| {
            let bytes = bytes.get(at..at + size)?;
            let record = layout.decode(bytes, components);
            (record.is_plausible() && is_written(&layout.encode(&record, components), bytes)).then_some((record, bytes))
        };
        while at + size <= bytes.len() {
            // In step with the one before a single record is believed.
            let in_step = at == end || at % size == 0;
            let run = if in_step { 1 } else { RUN.min((bytes.len() - at) / size) };
            match record(at).filter(|_| (1..run).all(|k| record(at + k * size).is_some())) {
                Some((r, own)) => {
                    found.damaged += at - end;
                    found.displaced += usize::from(at % size != 0);
                    if known.insert(own) {
                        found.records.push(r);
                        found.kept.extend(own);
                    } else {
                        found.repeated += 1;
                    }
                    at += size;
                    end = at;
                }
                None => at += 1,
            }
        }
        found.torn = bytes.len() - end;
        found
    }

    fn sound(&self) -> bool {
        self.displaced == 0 && self.damaged == 0 && self.torn == 0
    }
}

/// True if a record whose bytes are `own` would be written as `again`, but for its directions: several codes mean
/// nearly the same (a component stored as zero has lost its sign, two may tie for the largest).
fn is_written(again: &[u8], own: &[u8]) -> bool {
    let Range { start, end } = Layout::DIRECTIONS;
    again[..start] == own[..start] && again[end..] == own[end..]
}

/// Tells of every file whether it is sound.
pub(crate) fn print(files: &[PathBuf]) -> Result<bool, Failure> {
    let mut fine = true;
    for path in files {
        let name = name_of(path).into_owned();
        let bytes = bytes(path)?;
        let (text, sound) = match scan(&bytes, &name) {
            Err(problem) => (problem, false),
            Ok(contents) => {
                let f = Found::of(&bytes[contents.start..], contents.layout, &contents.components);
                let parts = segments(path, &contents, &Told).len();
                let mut text = format!("{} records", f.records.len());
                for (count, what) in [
                    (f.repeated, "repeated"),
                    (f.displaced, "displaced records"),
                    (f.damaged, "damaged bytes"),
                    (f.torn, "bytes of an incomplete record"),
                    (parts, "segments not merged"),
                ] {
                    if count > 0 {
                        // Writing to memory does not fail.
                        let _ = write!(text, ", {count} {what}");
                    }
                }
                (text, f.sound())
            }
        };
        fine &= sound;
        let word = if sound { "sound" } else { "DAMAGED" };
        crate::store::print(&bytes_of(&format!("{name}: {word}: {text}\n")))?;
    }
    Ok(fine)
}

/// Keeps all that makes sense.
pub(crate) fn repair(path: &Path, output: &Output) -> Result<(), Failure> {
    let name = name_of(path).into_owned();
    let failed = |e: io::Error| Failure(format!("cannot repair \"{name}\": {}", os_text(&e)));
    let in_place = output.output.is_none();
    let handle = Arc::new(File::options().read(true).write(in_place).open(path).map_err(failed)?);
    let mode = if in_place { LockMode::Exclusive } else { LockMode::Shared };
    let lock = FileLock::acquire_within(&handle, mode, PATIENCE);
    if in_place && !matches!(lock, Ok(Some(_))) {
        return Err(format!("\"{name}\" cannot be locked; repair it into another file (-o)").into());
    }
    let mut bytes = Vec::new();
    (&*handle).read_to_end(&mut bytes).map_err(failed)?;
    let mut contents = scan(&bytes, &name)?;
    let (layout, components, start) = (contents.layout, contents.components.clone(), contents.start);
    let found = Found::of(&bytes[start..], layout, &components);
    contents.records = found.records;
    let parts = segments(path, &contents, &Told);
    let (_, more) = missing(&contents, &parts);
    let mut records = found.kept;
    records.extend(more);
    let (kept, dropped) = (records.len() / layout.record_bytes(&components), found.damaged + found.torn);
    tell(&format!("{name}: {kept} records kept, {} repeated ones and {dropped} bytes dropped", found.repeated));
    if !in_place {
        return output.write(&[file(&contents.header, layout, &components, &[]), records].concat());
    }
    if records != bytes[start..] {
        let mut out = &*handle;
        out.seek(SeekFrom::Start(start as u64)).map_err(failed)?;
        out.write_all(&records).map_err(failed)?;
        out.set_len((start + records.len()) as u64).map_err(failed)?;
        out.sync_data().map_err(failed)?;
    }
    remove_done(&parts);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use ambit_ambient::RECORD_BYTES;
    use ambit_base::{DVec3, Rgb};

    fn record(k: u32) -> Record {
        Record {
            position: DVec3::new(f64::from(k), 0.5, 3.0),
            normal: DVec3::Z,
            u: DVec3::X,
            level: 1,
            weight: 0.5,
            radii: [0.5, 1.0],
            gradient: [0.25; 2],
            rotation: [0.125; 2],
            corral: k,
            value: Rgb::ONE,
            further: Box::default(),
            late: Box::default(),
        }
        .quantised(&Components::default())
    }

    fn encoded(numbers: std::ops::Range<u32>) -> Vec<u8> {
        numbers.flat_map(|k| Layout::V561.encode(&record(k), &Components::default())).collect()
    }

    fn numbers(found: &Found) -> Vec<u32> {
        found.records.iter().map(|r| r.corral).collect()
    }

    #[test]
    fn a_sound_file_is_sound() {
        let found = Found::of(&encoded(1..6), Layout::V561, &Components::default());
        assert!(found.sound());
        assert_eq!(numbers(&found), [1, 2, 3, 4, 5]);
    }

    #[test]
    fn codes_of_directions_that_are_not_written_again_are_sound() {
        // A negative component that is stored as zero: decoded it has no sign.
        let mut bytes = encoded(1..4);
        let at = RECORD_BYTES + Layout::DIRECTIONS.start;
        assert_eq!(bytes[at..at + 4], [0, 0, 0, 8]);
        bytes[at + 3] = 9;
        let found = Found::of(&bytes, Layout::V561, &Components::default());
        assert!(found.sound());
        assert_eq!(numbers(&found), [1, 2, 3]);
        assert_eq!(found.kept, bytes);
    }

    #[test]
    fn displaced_records_are_found_behind_the_damage() {
        // A block written 37 bytes too late over what was there.
        let mut bytes = encoded(1..10);
        let block = encoded(20..24);
        let at = 3 * RECORD_BYTES + 37;
        bytes.splice(at.., block);
        bytes.extend([1, 2, 3]);
        let found = Found::of(&bytes, Layout::V561, &Components::default());
        assert_eq!(numbers(&found), [1, 2, 3, 20, 21, 22, 23]);
        assert_eq!((found.displaced, found.damaged, found.torn), (4, 37, 3));
        assert!(!found.sound());
    }

    #[test]
    fn a_damaged_record_and_a_repeated_one_cost_themselves() {
        let mut bytes = [encoded(1..5), encoded(2..3)].concat();
        bytes[RECORD_BYTES * 2..RECORD_BYTES * 3].fill(0xff);
        let found = Found::of(&bytes, Layout::V561, &Components::default());
        assert_eq!(numbers(&found), [1, 2, 4]);
        assert_eq!((found.damaged, found.repeated, found.displaced), (RECORD_BYTES, 1, 0));
    }
}
