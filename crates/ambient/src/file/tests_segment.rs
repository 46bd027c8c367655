//! Locks that cannot be had, and the segments that take the place of the file.

use super::segment::names;
use super::tests::{Folder, Heard, batch, lines, plain};
use super::*;
use crate::components::Components;
use crate::record::Record;
use ambit_base::{Notify, Rgb, Silent};
use ambit_file::{FileLock, LockMode};
use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::LazyLock;
use std::time::{Duration, Instant};

const NAME: &str = "AMBIT_SEGMENT_TEST_FILE";

/// Another process that holds the lock of a file and does not let go.
struct Holder(Child, #[expect(dead_code, reason = "kept open, so that the child may print")] BufReader<ChildStdout>);

impl Holder {
    fn of(folder: &Folder) -> Self {
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "file::tests_segment::hold_in_a_child", "--ignored", "--nocapture"])
            .env(NAME, folder.file())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut out = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        while !line.contains("held") {
            line.clear();
            assert!(out.read_line(&mut line).unwrap() > 0, "the child takes the lock");
        }
        Self(child, out)
    }
}

impl Drop for Holder {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
#[ignore = "run by the other tests in a process of its own"]
fn hold_in_a_child() {
    let Some(path) = std::env::var_os(NAME) else { return };
    let file = fs::File::options().read(true).write(true).open(path).unwrap();
    let _lock = FileLock::acquire(&file, LockMode::Exclusive).unwrap();
    println!("\nheld");
    let _ = std::io::stdin().read(&mut [0]);
}

fn impatient<'a>(header: &'a [String], owner: &'a str) -> Opening<'a> {
    Opening { patience: Duration::from_millis(100), owner, ..plain(header) }
}

fn open(folder: &Folder, owner: &str, notify: &dyn Notify) -> Opened {
    AmbientFile::open(&folder.file(), &impatient(&lines(), owner), notify).unwrap()
}

#[test]
fn a_lock_that_hangs_loses_nothing() {
    let folder = Folder::filled(5);
    let mut file = open(&folder, "host-1", &Silent).file.unwrap();
    let before = fs::read(folder.file()).unwrap();
    let holder = Holder::of(&folder);
    let heard = Heard::default();
    let start = Instant::now();
    file.append(&batch(10, 130), &heard).unwrap();
    file.append(&batch(140, 3), &heard).unwrap();
    assert_eq!(file.sync(&heard).unwrap(), []);
    assert!(start.elapsed() < Duration::from_secs(20), "it is waited for once");
    assert!(heard.all().contains("its lock was not granted in 0.1 seconds"), "{}", heard.all());
    assert!(heard.all().contains("a.amb.seg-host-1\", and to"), "{}", heard.all());
    // One that starts now sees both files, and has a segment of its own.
    let mut second = open(&folder, "host-2", &Silent);
    assert_eq!(second.records, [batch(0, 5), batch(10, 133)].concat());
    let second = second.file.as_mut().unwrap();
    second.append(&batch(300, 2), &Silent).unwrap();
    second.sync(&Silent).unwrap();
    assert_eq!(fs::read(folder.file()).unwrap(), before, "nobody writes to a file that others may be writing to");
    drop(holder);
    file.close();
    // The second one was killed: its segment is merged, but may still grow.
    let heard = Heard::default();
    let all = [batch(0, 5), batch(10, 133), batch(300, 2)].concat();
    assert_eq!(open(&folder, "host-3", &heard).records, all);
    assert!(heard.all().contains("merged 135 values of 2 segments"), "{}", heard.all());
    assert_eq!(names(&folder.file()).len(), 1);
    // Merged again, nothing is twice.
    let heard = Heard::default();
    assert_eq!(open(&folder, "host-4", &heard).records, all);
    assert_eq!(heard.all(), "");
    let contents = scan(&fs::read(folder.file()).unwrap(), "a.amb").unwrap();
    assert_eq!((contents.records, contents.torn), (all, 0));
}

#[test]
fn segments_of_other_scenes_are_not_merged() {
    let folder = Folder::filled(2);
    let other = Folder::filled(3);
    let text = fs::read(other.file()).unwrap();
    let at = text.windows(10).position(|w| w == b"WAVELENGTH").unwrap();
    let marked = [&text[..at], b"AMBIT_SCENE= geometry=1\n", &text[at..]].concat();
    let segment = folder.file().with_file_name("a.amb.seg-host-9.done");
    fs::write(&segment, marked).unwrap();
    let heard = Heard::default();
    assert_eq!(open(&folder, "host-1", &heard).records, batch(0, 2));
    assert!(heard.all().contains("of another scene, and not used"), "{}", heard.all());
    assert!(segment.exists());
}

/// Six bins, as one would open them whose sampling is the file's own.
static SIX: LazyLock<Components> = LazyLock::new(|| Components::in_order(6));

/// Records of six bins.
fn spectra(from: u32, count: u32) -> Vec<Record> {
    let further = |r: &Record| [Rgb::new(0.25, 0.5, 2.0) * r.corral as f32].into();
    batch(from, count).into_iter().map(|r| Record { further: further(&r), ..r }.quantised(&SIX)).collect()
}

/// A run in red, green and blue goes on with a file of six bins: its segment is of six bins, too, and only a run in six
/// bins merges it, as values that are converted to and fro are not what they were.
#[test]
fn segments_of_converted_files_are_of_the_file_s_own_bins() {
    let header = lines();
    let six = |folder: &Folder, notify: &dyn Notify| {
        let opening = Opening { components: &SIX, ..impatient(&header, "host-6") };
        AmbientFile::open(&folder.file(), &opening, notify).unwrap()
    };
    let folder = Folder::new();
    let mut file = six(&folder, &Silent).file.unwrap();
    file.append(&spectra(1, 4), &Silent).unwrap();
    file.sync(&Silent).unwrap();
    let before = fs::read(folder.file()).unwrap();
    let opened = open(&folder, "host-1", &Silent);
    let (first, mut file) = (opened.records, opened.file.unwrap());
    assert!(first.len() == 4 && first.iter().all(|r| r.further.is_empty()));
    let holder = Holder::of(&folder);
    file.append(&batch(10, 3), &Silent).unwrap();
    file.sync(&Silent).unwrap();
    file.close();
    drop(holder);
    let [segment] = &names(&folder.file())[..] else { panic!("one segment") };
    let bytes = fs::read(segment).unwrap();
    let written = scan(&bytes, "segment").unwrap();
    assert_eq!((written.header.components(), written.records.len()), (6, 3));
    // Each of three bins covers two of six.
    let [red, green, blue] = batch(10, 1)[0].value.to_array();
    let bins: Vec<f32> = written.components.of(&written.records[0]).collect();
    assert!(bins.iter().zip([red, red, green, green, blue, blue]).all(|(a, b)| (a - b).abs() <= b / 128.0), "{bins:?}");
    // Runs of three bins use it, again and again, and leave it where it is.
    let mut converted = Vec::new();
    for owner in ["host-2", "host-3"] {
        let heard = Heard::default();
        converted = open(&folder, owner, &heard).records;
        assert_eq!(heard.all().matches("different ambient file wavelength sampling").count(), 1, "{}", heard.all());
        assert!(!heard.all().contains("segment") && segment.exists(), "{}", heard.all());
        assert_eq!((converted.len(), &converted[..4]), (7, &first[..]));
        assert_eq!(fs::read(folder.file()).unwrap(), before);
    }
    // The first of six bins merges it.
    let heard = Heard::default();
    assert_eq!(six(&folder, &heard).records, [spectra(1, 4), written.records].concat());
    assert!(heard.all().contains("merged 3 values of 1 segment into"), "{}", heard.all());
    assert!(names(&folder.file()).is_empty());
    assert_eq!(fs::read(folder.file()).unwrap(), [&before[..], &bytes[written.start..]].concat());
    assert_eq!(open(&folder, "host-4", &Silent).records, converted, "merging changes nothing");
    assert_eq!(
        converted[4..].iter().map(|r| r.position).collect::<Vec<_>>(),
        batch(10, 3).iter().map(|r| r.position).collect::<Vec<_>>()
    );
}

#[test]
fn a_file_that_others_cut_off_goes_on_in_a_segment() {
    let folder = Folder::filled(3);
    let mut file = open(&folder, "host-1", &Silent).file.unwrap();
    fs::write(folder.file(), b"#?R").unwrap();
    let heard = Heard::default();
    file.append(&batch(10, 2), &heard).unwrap();
    file.sync(&heard).unwrap();
    assert!(heard.all().contains("truncated by another program"), "{}", heard.all());
    assert_eq!(fs::read(folder.file()).unwrap(), b"#?R");
    assert_eq!(names(&folder.file()).len(), 1);
}
