//! Files of the same light, of another, and of unknown origin.

use super::tests::{Folder, Heard, RGB, SPLITS, batch, lines};
use super::*;
use ambit_base::{DVec3, Silent};
use std::fs;

fn print(scene: &str, divisions: &str) -> Fingerprint {
    let mark = |line, key, label, value: &str, gravity| Mark { line, key, label, value: value.to_owned(), gravity };
    Fingerprint {
        marks: vec![
            mark(MarkLine::Scene, "materials", "materials", scene, Gravity::Decisive),
            mark(MarkLine::Options, "ad", "-ad", divisions, Gravity::Accuracy),
        ],
    }
}

/// Opens with a fingerprint, adds records, and gives back what was there and the warnings.
fn run(
    folder: &Folder,
    print: &Fingerprint,
    reuse: Reuse,
    added: std::ops::Range<u32>,
) -> Result<(Vec<u32>, String), FileError> {
    let heard = Heard::default();
    let header = lines();
    let opening = Opening {
        header: &header,
        components: &RGB,
        splits: SPLITS,
        observer: |_| DVec3::ONE,
        fingerprint: Some(print),
        reuse,
        patience: PATIENCE,
        owner: "test-1",
    };
    let Opened { records, file, .. } = AmbientFile::open(&folder.file(), &opening, &heard)?;
    if let Some(mut file) = file {
        file.append(&batch(added.start, added.len() as u32), &Silent)?;
        file.sync(&Silent)?;
    }
    Ok((records.iter().map(|r| r.corral).collect(), heard.all()))
}

#[test]
fn records_of_the_same_scene_are_used() {
    let folder = Folder::new();
    run(&folder, &print("1", "64"), Reuse::Auto, 0..3).unwrap();
    for reuse in [Reuse::Auto, Reuse::Strict, Reuse::Append, Reuse::ReadOnly] {
        assert_eq!(run(&folder, &print("1", "64"), reuse, 0..0).unwrap(), (vec![0, 1, 2], String::new()));
    }
    let text = String::from_utf8_lossy(&fs::read(folder.file()).unwrap()).into_owned();
    assert!(text.contains("\nAMBIT_SCENE= materials=1\nAMBIT_OPTIONS= ad=64\nWAVELENGTH_SPLITS="), "{text}");
}

#[test]
fn records_of_another_scene_are_left_alone() {
    let folder = Folder::new();
    run(&folder, &print("1", "64"), Reuse::Auto, 0..3).unwrap();
    let before = fs::read(folder.file()).unwrap();
    let other = print("2", "64");
    let (found, heard) = run(&folder, &other, Reuse::Auto, 10..12).unwrap();
    assert_eq!(found, [0u32; 0]);
    assert!(heard.contains("does not fit: other materials; its 3 values are not used"), "{heard}");
    assert!(heard.contains(&format!("a.amb.{}\" is used instead", other.short_name())), "{heard}");
    // The second run of the other scene finds the first one's records, and both scenes keep theirs.
    assert_eq!(run(&folder, &other, Reuse::Auto, 0..0).unwrap().0, [10, 11]);
    assert_eq!(fs::read(folder.file()).unwrap(), before);
    assert_eq!(run(&folder, &print("1", "64"), Reuse::Auto, 0..0).unwrap(), (vec![0, 1, 2], String::new()));
}

#[test]
fn a_torn_file_of_another_scene_is_not_repaired() {
    let folder = Folder::new();
    run(&folder, &print("1", "64"), Reuse::Auto, 0..3).unwrap();
    let bytes = fs::read(folder.file()).unwrap();
    fs::write(folder.file(), &bytes[..bytes.len() - 5]).unwrap();
    run(&folder, &print("2", "64"), Reuse::Auto, 10..12).unwrap();
    assert_eq!(fs::read(folder.file()).unwrap(), &bytes[..bytes.len() - 5]);
}

#[test]
fn other_accuracy_is_told_and_used() {
    let folder = Folder::new();
    run(&folder, &print("1", "64"), Reuse::Auto, 0..3).unwrap();
    let (found, heard) = run(&folder, &print("1", "128"), Reuse::Auto, 0..0).unwrap();
    assert_eq!(found, [0, 1, 2]);
    assert!(heard.contains("other parameters: -ad (64 there, 128 here); its values are used"), "{heard}");
}

#[test]
fn strict_refuses_every_difference_and_the_unknown() {
    let folder = Folder::new();
    run(&folder, &print("1", "64"), Reuse::Auto, 0..3).unwrap();
    for (print, problem) in [(print("2", "64"), "other materials"), (print("1", "65"), "-ad (64 there, 65 here)")] {
        let error = run(&folder, &print, Reuse::Strict, 0..0).unwrap_err();
        assert!(matches!(error, FileError::Unfit { .. }) && error.to_string().contains(problem), "{error}");
    }
    let unmarked = Folder::filled(3);
    let error = run(&unmarked, &print("1", "64"), Reuse::Strict, 0..0).unwrap_err().to_string();
    assert!(error.contains("no fingerprint"), "{error}");
    // Scripts that share files with Radiance go on as before.
    assert_eq!(run(&unmarked, &print("1", "64"), Reuse::Auto, 5..6).unwrap(), (vec![0, 1, 2], String::new()));
    assert_eq!(run(&unmarked, &print("2", "64"), Reuse::Auto, 0..0).unwrap(), (vec![0, 1, 2, 5], String::new()));
}

#[test]
fn append_takes_everything_and_read_only_writes_nothing() {
    let folder = Folder::new();
    run(&folder, &print("1", "64"), Reuse::Auto, 0..3).unwrap();
    assert_eq!(run(&folder, &print("2", "64"), Reuse::Append, 3..4).unwrap(), (vec![0, 1, 2], String::new()));
    let before = fs::read(folder.file()).unwrap();
    assert_eq!(run(&folder, &print("1", "64"), Reuse::ReadOnly, 7..9).unwrap(), (vec![0, 1, 2, 3], String::new()));
    let (found, heard) = run(&folder, &print("2", "64"), Reuse::ReadOnly, 7..9).unwrap();
    assert!(found.is_empty() && heard.contains("other materials; its 4 values are not used"), "{heard}");
    assert_eq!(fs::read(folder.file()).unwrap(), before);
    assert_eq!(fs::read_dir(folder.file().parent().unwrap()).unwrap().count(), 1);
    let none = Folder::new();
    let error = run(&none, &print("1", "64"), Reuse::ReadOnly, 0..0).unwrap_err().to_string();
    assert!(error.contains("No such file"), "{error}");
}
