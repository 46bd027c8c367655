//! The manual pages in `man/` are what the programs print; write them anew with `PROGRAM --man > man/PROGRAM.1` (`ambrec man`).

use std::path::Path;
use std::process::Command;

#[test]
fn manual_pages_are_up_to_date() {
    for (name, program, option) in [
        ("rpict", env!("CARGO_BIN_EXE_rpict"), "--man"),
        ("rtrace", env!("CARGO_BIN_EXE_rtrace"), "--man"),
        ("ambrec", env!("CARGO_BIN_EXE_ambrec"), "man"),
    ] {
        let printed = Command::new(program).arg(option).output().expect("the program runs").stdout;
        let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../man").join(format!("{name}.1"));
        let kept = std::fs::read(&page).expect("the page is there");
        assert!(!printed.is_empty() && printed == kept, "man/{name}.1 differs from {name} {option}");
    }
}
