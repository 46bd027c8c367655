//! Files as they come: new, shared, cut, damaged, empty, garbage, read-only, full.

use super::*;
use crate::codec::{Layout, RECORD_BYTES};
use crate::components::Components;
use crate::record::Record;
use ambit_base::{DVec3, Notify, Rgb, Silent};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{LazyLock, Mutex};

/// Components and wavelengths of most files.
pub(super) static RGB: LazyLock<Components> = LazyLock::new(Components::default);
pub(super) const SPLITS: [f64; 4] = [780.0, 588.0, 480.0, 380.0];

/// Keeps the warnings.
#[derive(Default)]
pub(super) struct Heard(Mutex<Vec<String>>);

impl Notify for Heard {
    fn warn(&self, text: &str) {
        self.0.lock().unwrap().push(text.to_owned());
    }
}

impl Heard {
    pub(super) fn all(&self) -> String {
        self.0.lock().unwrap().join("\n")
    }
}

fn record(number: u32) -> Record {
    Record {
        position: DVec3::new(f64::from(number), 1.5, -2.0),
        normal: DVec3::Z,
        u: DVec3::X,
        level: (number % 3) as u8,
        weight: 0.5,
        radii: [0.25, 0.5],
        gradient: [0.1, -0.2],
        rotation: [0.0, 0.3],
        corral: number,
        value: Rgb::new(1.0, 0.5, 0.25),
        further: Box::default(),
        late: Box::default(),
    }
    .quantised(&RGB)
}

pub(super) fn batch(from: u32, count: u32) -> Vec<Record> {
    (from..from + count).map(record).collect()
}

pub(super) fn lines() -> Vec<String> {
    ["rtrace -ab 1 room.oct", "SOFTWARE= AMBIT", "CAPDATE= 2026:01:02 03:04:05", "GMT= 2026:01:02 03:04:05"]
        .map(str::to_owned)
        .to_vec()
}

pub(super) struct Folder(tempfile::TempDir);

impl Folder {
    pub(super) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(super) fn file(&self) -> PathBuf {
        self.0.path().join("a.amb")
    }

    /// A file of `count` records.
    pub(super) fn filled(count: u32) -> Self {
        let folder = Self::new();
        let mut file = open(&folder.file()).file.unwrap();
        file.append(&batch(0, count), &Silent).unwrap();
        file.sync(&Silent).unwrap();
        folder
    }
}

/// An opening without fingerprint.
pub(super) fn plain(header: &[String]) -> Opening<'_> {
    Opening {
        header,
        components: &RGB,
        splits: SPLITS,
        observer: |_| DVec3::ONE,
        fingerprint: None,
        reuse: Reuse::Auto,
        patience: PATIENCE,
        owner: "test-1",
    }
}

fn try_open(path: &Path, notify: &dyn Notify) -> Result<Opened, FileError> {
    AmbientFile::open(path, &plain(&lines()), notify)
}

fn open(path: &Path) -> Opened {
    try_open(path, &Silent).unwrap()
}

#[test]
fn a_new_file_has_the_header_that_radiance_writes() {
    let folder = Folder::new();
    let opened = open(&folder.file());
    assert!(opened.records.is_empty() && opened.file.is_some());
    let expected = "#?RADIANCE\nrtrace -ab 1 room.oct\nSOFTWARE= AMBIT\nCAPDATE= 2026:01:02 03:04:05\n\
        GMT= 2026:01:02 03:04:05\nWAVELENGTH_SPLITS= 780 588 480 380\nNCOMP=3\nFORMAT=Radiance_ambval\n\n\x02\x31";
    assert_eq!(fs::read(folder.file()).unwrap(), expected.as_bytes());
    let missing = folder.0.path().join("no/a.amb");
    let error = try_open(&missing, &Silent).unwrap_err().to_string();
    assert!(
        error.starts_with("cannot open ambient file \"") && error.ends_with("No such file or directory"),
        "{error}"
    );
}

#[test]
fn records_are_written_in_blocks_and_read_again() {
    let folder = Folder::new();
    let mut file = open(&folder.file()).file.unwrap();
    let header = fs::metadata(folder.file()).unwrap().len();
    file.append(&batch(0, 121), &Silent).unwrap();
    assert_eq!(fs::metadata(folder.file()).unwrap().len(), header);
    file.append(&batch(121, 1), &Silent).unwrap();
    assert_eq!(fs::metadata(folder.file()).unwrap().len(), header + 122 * RECORD_BYTES as u64);
    file.append(&batch(122, 3), &Silent).unwrap();
    assert!(file.sync(&Silent).unwrap().is_empty(), "one's own records do not come back");
    assert_eq!(open(&folder.file()).records, batch(0, 125));
}

#[test]
fn two_writers_see_each_other() {
    let folder = Folder::new();
    let mut a = open(&folder.file()).file.unwrap();
    let mut b = open(&folder.file()).file.unwrap();
    assert!(a.append(&batch(0, 130), &Silent).unwrap().is_empty());
    assert_eq!(b.append(&batch(200, 150), &Silent).unwrap(), batch(0, 130));
    assert_eq!(a.sync(&Silent).unwrap(), batch(200, 150));
    assert!(a.sync(&Silent).unwrap().is_empty() && b.sync(&Silent).unwrap().is_empty());
    assert_eq!(open(&folder.file()).records, [batch(0, 130), batch(200, 150)].concat());
}

#[test]
fn a_cut_tail_is_removed_and_appending_goes_on_at_a_boundary() {
    let folder = Folder::filled(10);
    let bytes = fs::read(folder.file()).unwrap();
    fs::write(folder.file(), &bytes[..bytes.len() - 30]).unwrap();
    let heard = Heard::default();
    let opened = try_open(&folder.file(), &heard).unwrap();
    assert_eq!(opened.records, batch(0, 9));
    assert!(heard.all().contains("the last 37 bytes"), "{}", heard.all());
    assert_eq!(fs::metadata(folder.file()).unwrap().len() as usize, bytes.len() - RECORD_BYTES);
    let mut file = opened.file.unwrap();
    file.append(&batch(50, 5), &Silent).unwrap();
    file.sync(&Silent).unwrap();
    assert_eq!(open(&folder.file()).records, [batch(0, 9), batch(50, 5)].concat());
}

#[test]
fn what_a_killed_writer_left_is_overwritten() {
    let folder = Folder::filled(4);
    let mut file = open(&folder.file()).file.unwrap();
    let mut bytes = fs::read(folder.file()).unwrap();
    bytes.extend(Layout::CURRENT.encode(&record(77), &RGB));
    bytes.extend(&Layout::CURRENT.encode(&record(78), &RGB)[..20]);
    fs::write(folder.file(), &bytes).unwrap();
    let heard = Heard::default();
    file.append(&batch(90, 1), &heard).unwrap();
    assert_eq!(file.sync(&heard).unwrap(), batch(77, 1));
    assert!(heard.all().contains("the last 20 bytes"), "{}", heard.all());
    assert_eq!(open(&folder.file()).records, [batch(0, 4), batch(77, 1), batch(90, 1)].concat());
}

#[test]
fn a_damaged_record_costs_only_itself() {
    let folder = Folder::filled(10);
    let mut bytes = fs::read(folder.file()).unwrap();
    let at = bytes.len() - 6 * RECORD_BYTES;
    bytes[at..at + RECORD_BYTES].fill(0xff);
    fs::write(folder.file(), &bytes).unwrap();
    let heard = Heard::default();
    let opened = try_open(&folder.file(), &heard).unwrap();
    assert_eq!(opened.records, [batch(0, 4), batch(5, 5)].concat());
    assert!(heard.all().contains("ignoring 1 values"), "{}", heard.all());
    assert_eq!(fs::read(folder.file()).unwrap(), bytes, "nothing is cut");
}

#[test]
fn garbage_is_refused_and_left_alone() {
    let folder = Folder::filled(1);
    let good = fs::read(folder.file()).unwrap();
    let text = String::from_utf8_lossy(&good).into_owned();
    let header = text.find("\n\n").unwrap() + 2;
    let mut old = good.clone();
    old[header + 1] = 0x2d;
    let spectral = text.replace("NCOMP=3", "NCOMP=2").into_bytes();
    let picture = text.replace(FORMAT, "32-bit_rle_rgbe").into_bytes();
    for (bytes, problem) in [
        (b"garbage".to_vec(), "bad header"),
        (vec![0; 500], "bad header"),
        (good[..header].to_vec(), "ends after its header"),
        (old, "magic number 557"),
        (spectral, "NCOMP=2"),
        (text.replace("SPLITS= 780 588 480 380", "SPLITS= 0 0 0 0").into_bytes(), "WAVELENGTH_SPLITS"),
        (picture, "FORMAT=32-bit_rle_rgbe"),
    ] {
        fs::write(folder.file(), &bytes).unwrap();
        let error = try_open(&folder.file(), &Silent).unwrap_err();
        assert!(matches!(error, FileError::Incompatible { .. }));
        assert!(error.to_string().contains(problem), "{error}");
        assert_eq!(fs::read(folder.file()).unwrap(), bytes);
    }
}

#[test]
fn an_empty_file_is_waited_for() {
    let folder = Folder::filled(3);
    let bytes = fs::read(folder.file()).unwrap();
    fs::write(folder.file(), b"").unwrap();
    let path = folder.file();
    let waiting = std::thread::spawn(move || open(&path).records);
    std::thread::sleep(std::time::Duration::from_millis(300));
    // As its creator would, in one piece: written aside and moved there.
    let aside = folder.0.path().join("b.amb");
    fs::write(&aside, &bytes).unwrap();
    fs::rename(aside, folder.file()).unwrap();
    assert_eq!(waiting.join().unwrap(), batch(0, 3));
    // Its creator was killed: the file begins anew.
    fs::write(folder.file(), b"").unwrap();
    let mut file = open(&folder.file()).file.unwrap();
    file.append(&batch(7, 1), &Silent).unwrap();
    file.sync(&Silent).unwrap();
    assert_eq!(open(&folder.file()).records, batch(7, 1));
}

#[test]
fn a_read_only_file_is_used_with_a_warning() {
    let folder = Folder::filled(5);
    let file = fs::File::open(folder.file()).unwrap().into();
    let heard = Heard::default();
    // Permissions do not stop the superuser, so the way after the refusal is taken directly.
    let opened = AmbientFile::open_read_only(&file, &plain(&[]), &heard).unwrap();
    assert_eq!(opened.records, batch(0, 5));
    assert!(opened.file.is_none());
    assert_eq!(heard.all(), "loaded 5 values from read-only ambient file");
}

#[test]
fn files_of_radiance_5_are_read_and_continued_in_their_layout() {
    let folder = Folder::new();
    let mut bytes = b"#?RADIANCE\nrtrace room.oct\nFORMAT=Radiance_ambval\n\n\x02\x2f".to_vec();
    for r in batch(0, 3) {
        bytes.extend(Layout::V559.encode(&r, &RGB));
    }
    fs::write(folder.file(), &bytes).unwrap();
    let opened = open(&folder.file());
    assert_eq!(opened.records, batch(0, 3));
    let mut file = opened.file.unwrap();
    file.append(&batch(3, 1), &Silent).unwrap();
    file.sync(&Silent).unwrap();
    bytes.extend(Layout::V559.encode(&record(3), &RGB));
    assert_eq!(fs::read(folder.file()).unwrap(), bytes);
}

#[test]
fn a_full_disk_loses_nothing() {
    let full = Path::new("/dev/full");
    if !full.exists() {
        return;
    }
    let folder = Folder::filled(2);
    let mut file = open(&folder.file()).file.unwrap();
    file.waiting = batch(10, 3);
    let disk = std::mem::replace(&mut file.file, fs::File::options().write(true).open(full).unwrap().into());
    let error = file.write(0, false).unwrap_err();
    assert_eq!(error.kind(), std::io::ErrorKind::StorageFull);
    // A descriptor that cannot be written fails in the same place; the records wait.
    file.file = fs::File::open(folder.file()).unwrap().into();
    file.locks = super::share::Locks::Alone;
    let error = file.sync(&Silent).unwrap_err().to_string();
    assert!(error.starts_with("cannot write 3 records to ambient file"), "{error}");
    file.file = disk;
    file.sync(&Silent).unwrap();
    assert_eq!(open(&folder.file()).records, [batch(0, 2), batch(10, 3)].concat());
}

const NAME: &str = "AMBIT_AMBIENT_TEST_FILE";
const NUMBER: &str = "AMBIT_AMBIENT_TEST_NUMBER";

#[test]
#[ignore = "run by the next test in processes of its own"]
fn write_in_a_child() {
    let (Some(path), Ok(number)) = (std::env::var_os(NAME), std::env::var(NUMBER)) else { return };
    let number: u32 = number.parse().unwrap();
    let opened = open(Path::new(&path));
    let mut known = opened.records.len();
    let mut file = opened.file.unwrap();
    for k in 0..20 {
        known += file.append(&batch(number * 10_000 + k * 50, 50), &Silent).unwrap().len();
    }
    known += file.sync(&Silent).unwrap().len();
    assert!(known <= 3000);
}

#[test]
fn a_file_that_another_has_taken_the_place_of_is_noticed() {
    let folder = Folder::new();
    let path = folder.file();
    let own = fs::File::create(&path).unwrap();
    assert!(super::open::is_at(&own, &path));
    // A second file is made before the first one's place is free, so that they differ.
    let other = path.with_extension("other");
    fs::write(&other, b"").unwrap();
    fs::rename(&other, &path).unwrap();
    assert!(!super::open::is_at(&own, &path));
    fs::remove_file(&path).unwrap();
    assert!(!super::open::is_at(&own, &path));
}

#[test]
fn processes_share_a_file_without_losing_records() {
    let folder = Folder::new();
    let children: Vec<_> = (0..4)
        .map(|number| {
            Command::new(std::env::current_exe().unwrap())
                .args(["--exact", "file::tests::write_in_a_child", "--ignored"])
                .env(NAME, folder.file())
                .env(NUMBER, number.to_string())
                .stdout(std::process::Stdio::piped())
                .spawn()
                .unwrap()
        })
        .collect();
    for child in children {
        let done = child.wait_with_output().unwrap();
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stdout));
    }
    let heard = Heard::default();
    let mut found: Vec<u32> = try_open(&folder.file(), &heard).unwrap().records.iter().map(|r| r.corral).collect();
    assert_eq!(heard.all(), "");
    found.sort_unstable();
    let expected: Vec<u32> = (0..4).flat_map(|n| n * 10_000..n * 10_000 + 1000).collect();
    assert_eq!(found, expected);
}
