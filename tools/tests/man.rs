//! The manual pages in `man/` are what the programs print; write them anew with `PROGRAM --man > man/PROGRAM.1` (`ambrec man`).
//! Those of programs with few options are written by hand.

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

#[test]
fn pages_written_by_hand_tell_of_every_option() {
    for (name, program) in [
        ("oconv", env!("CARGO_BIN_EXE_oconv")),
        ("obj2mesh", env!("CARGO_BIN_EXE_obj2mesh")),
        ("lookamb", env!("CARGO_BIN_EXE_lookamb")),
        ("topng", env!("CARGO_BIN_EXE_topng")),
    ] {
        let help = Command::new(program).arg("--help").output().expect("the program runs").stdout;
        let help = String::from_utf8(help).expect("help is text");
        let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../man").join(format!("{name}.1"));
        let page = std::fs::read_to_string(&page).expect("the page is there").replace('\\', "");
        let mut options = 0;
        for option in help.lines().filter(|l| l.starts_with("  -")).filter_map(|l| l.split_whitespace().next()) {
            assert!(page.contains(&format!("fB{option}fR")), "man/{name}.1 says nothing of {option}");
            options += 1;
        }
        assert!(options >= 3, "{name} --help lists {options} options");
    }
}
