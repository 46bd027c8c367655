//! The architecture as ARCHITECTURE.md draws it: which crate may use which, and how long a file may be.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use ambit_tests::programs::root;
use cargo_metadata::{CargoOpt, DependencyKind, MetadataCommand};

/// Every crate and what it may use directly. A crate that is not listed is an error: draw it first.
const MAY_USE: &[(&str, &[&str])] = &[
    ("ambit-base", &[]),
    ("ambit-file", &["ambit-base"]),
    ("ambit-cal", &["ambit-base"]),
    ("ambit-scene", &["ambit-file", "ambit-base"]),
    ("ambit-octree", &["ambit-scene", "ambit-file", "ambit-base"]),
    ("ambit-trace", &["ambit-scene", "ambit-base"]),
    ("ambit-ambient", &["ambit-file", "ambit-base"]),
    (
        "ambit-render",
        &["ambit-trace", "ambit-ambient", "ambit-octree", "ambit-cal", "ambit-scene", "ambit-file", "ambit-base"],
    ),
    ("ambit-cli", &["ambit-render", "ambit-file", "ambit-base"]),
    ("ambit-measure", &["ambit-file", "ambit-base"]),
    (
        "ambit-tools",
        &[
            "ambit-cli",
            "ambit-measure",
            "ambit-render",
            "ambit-octree",
            "ambit-ambient",
            "ambit-scene",
            "ambit-file",
            "ambit-base",
        ],
    ),
    ("ambit-tests", &[]),
];

/// Lines a source file may have before its header must say why it is longer.
const LONGEST: usize = 500;

#[test]
fn crates_use_only_what_lies_below_them() {
    let metadata = MetadataCommand::new().current_dir(root()).features(CargoOpt::AllFeatures).no_deps().exec();
    let metadata = metadata.expect("cargo reads its own manifests");
    let allowed: BTreeMap<&str, BTreeSet<&str>> =
        MAY_USE.iter().map(|(name, uses)| (*name, uses.iter().copied().collect())).collect();
    let mut wrong = Vec::new();
    for package in &metadata.packages {
        let Some(uses) = allowed.get(package.name.as_str()) else {
            wrong.push(format!("{} is not drawn", package.name));
            continue;
        };
        for dependency in package.dependencies.iter().filter(|d| d.name.starts_with("ambit-")) {
            // Tests may borrow from anywhere below; what ships may not.
            if dependency.kind != DependencyKind::Development && !uses.contains(dependency.name.as_str()) {
                wrong.push(format!("{} must not use {}", package.name, dependency.name));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn files_are_short_or_say_why_not() {
    let mut wrong = Vec::new();
    for folder in ["crates", "tools", "tests"] {
        sources(&root().join(folder), &mut |path| {
            let text = std::fs::read_to_string(path).expect("a source file is readable text");
            let lines = text.lines().count();
            // "Long because …" in the module's documentation.
            let reason = text.lines().take_while(|l| l.starts_with("//!")).any(|l| l.contains("Long because"));
            if lines > LONGEST && !reason {
                wrong.push(format!("{}: {lines} lines and no `Long because …` in its header", path.display()));
            }
            if path.ends_with("src/lib.rs") && lines > 80 {
                wrong.push(format!("{}: {lines} lines; a lib.rs holds docs, mods and names only", path.display()));
            }
        });
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Calls `each` for every Rust source file below `folder`.
fn sources(folder: &Path, each: &mut impl FnMut(&Path)) {
    let entries = std::fs::read_dir(folder).expect("a folder of the workspace");
    for path in entries.map(|entry| entry.expect("a readable folder").path()) {
        if path.is_dir() {
            sources(&path, each);
        } else if path.extension().is_some_and(|e| e == "rs") {
            each(&path);
        }
    }
}
