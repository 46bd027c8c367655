//! Running a whole table of check cases and saying what came of it.

use std::path::Path;
use std::process::ExitCode;

use crate::cases::{Table, Verdict};
use crate::programs;

/// Runs the cases of `tests/cases/NAME.tsv`; numbers among the program's arguments run these only.
///
/// Prints every case that does not agree and the counts. Passes if all cases agree except those that the table lists
/// as not supported yet (which must be refused with a message that says so) or as different on purpose. A listed case
/// that agrees is an error, too: the lists may only shrink.
///
/// # Panics
/// If the table is not there or not as its head describes.
pub fn run(name: &str) -> ExitCode {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases");
    let table =
        Table::read(&std::fs::read_to_string(folder.join(format!("{name}.tsv"))).expect("the table is checked in"));
    let wanted: Vec<u32> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let files = folder.join("files");
    let (mut agree, mut refused, mut different, mut wrong) = (0, 0, 0, 0);
    for case in table.cases.iter().filter(|c| wanted.is_empty() || wanted.contains(&c.number)) {
        let scratch = tempfile::tempdir().expect("a scratch folder can be made");
        let verdict = case.run(&table.options, &files, scratch.path());
        // Foreign programs support everything: the lists speak of our own only.
        let unsupported = table.unsupported.contains(&case.number) && !programs::foreign();
        let differs = table.different.contains(&case.number) && !programs::foreign();
        let problem = match (&verdict, unsupported, differs) {
            (Verdict::Agrees, false, false) => {
                agree += 1;
                continue;
            }
            (Verdict::Refused(_), true, false) => {
                refused += 1;
                continue;
            }
            (Verdict::Fails(_), false, true) => {
                different += 1;
                continue;
            }
            (Verdict::Agrees, ..) => "agrees now: take it off the table's lists".to_owned(),
            (Verdict::Refused(message), ..) => format!("refused, but not listed as unsupported: {message}"),
            (Verdict::Fails(what), ..) => what.clone(),
        };
        wrong += 1;
        println!("[{}] {}: {problem}", case.number, case.checks);
    }
    println!(
        "{name} cases: {agree} agree, {refused} not supported yet, {different} different on purpose, {wrong} wrong"
    );
    if wrong == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
