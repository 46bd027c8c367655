//! Locks that cannot be had, and the segments that take the place of the file.

use super::segment::names;
use super::tests::{Folder, Heard, batch, lines, plain};
use super::*;
use ambit_base::{Notify, Silent};
use ambit_file::{FileLock, LockMode};
use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, ChildStdout, Command, Stdio};
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
