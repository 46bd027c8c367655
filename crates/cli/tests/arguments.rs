//! Command lines and what Radiance 6.0a answered to them.

use ambit_cli::{Failure, Outside, PictureOptions, RayOptions, Scan, defaults, picture_table, ray_table, scan};
use ambit_file::View;
use std::io;

/// A world with one variable, one argument file, one list and one view file.
struct World;

impl Outside for World {
    fn variable(&self, name: &str) -> Option<String> {
        match name {
            "OPTIONS" => Some(" -ab 2\n@more -aa .3".into()),
            "NOTHING" => Some(String::new()),
            _ => None,
        }
    }

    fn words(&self, file: &str) -> Result<Vec<String>, Failure> {
        match file {
            "more" => Ok(["-ad", "99"].map(String::from).to_vec()),
            "octree" => Ok(vec!["-ab".into(), "1".into(), "scene.oct".into()]),
            "itself" => Ok(vec!["@itself".into(); 2]),
            "four" => Ok(vec!["4".into()]),
            _ => Err(Failure::system(format!("cannot expand '@{file}'"), &io::Error::from_raw_os_error(2))),
        }
    }

    fn list(&self, file: &str, what: &str) -> Result<Vec<String>, Failure> {
        match file {
            "names" => Ok(["one", "two"].map(String::from).to_vec()),
            _ => Err(Failure::system(format!("cannot open {what} file \"{file}\""), &io::Error::from_raw_os_error(2))),
        }
    }

    fn view(&self, view: &mut View, file: &str) -> Result<(), Failure> {
        assert_eq!(file, "v.vf");
        view.horizontal = 60.0;
        Ok(())
    }
}

fn words(line: &str) -> Vec<String> {
    line.split_whitespace().map(|w| w.replace("''", "")).collect()
}

fn rpict(line: &str) -> (PictureOptions, Result<Scan, Failure>) {
    let mut options = PictureOptions::new(2);
    let result = scan(words(line), &picture_table(), &mut options, &World);
    (options, result)
}

fn rtrace(line: &str) -> (RayOptions, Result<Scan, Failure>) {
    let mut options = RayOptions::new(2);
    let result = scan(words(line), &ray_table(), &mut options, &World);
    (options, result)
}

/// The word at which both programs find an error (`~`: neither does; two words: `rpict`'s, then `rtrace`'s).
const ERRORS: &[(&str, &str)] = &[
    ("-ab1", "-ab1"),
    ("-ab 1.5", "-ab"),
    ("-ab 1e1", "-ab"),
    ("-ab +3", "~"),
    ("-ab -3", "~"),
    ("-ab", "-ab"),
    ("-ab +", "-ab"),
    ("-ab 0x1", "-ab"),
    ("-ar 1e3", "-ar"),
    ("-dt 0x2", "-dt"),
    ("-dt .5", "~"),
    ("-dt 1.", "~"),
    ("-dt +.5", "~"),
    ("-dt -1e-2", "~"),
    ("-dt .", "-dt"),
    ("-dt 1e", "-dt"),
    ("-dt 1e+", "-dt"),
    ("-dt inf", "-dt"),
    ("-dt 1.2.3", "-dt"),
    ("-dt 1e2.0", "-dt"),
    ("-iy", "-iy"),
    ("-i2", "-i2"),
    ("-ix", "-ix"),
    ("-i+x", "~"),
    ("-i0", "~"),
    ("-bv2", "-bv2"),
    ("-w2", "-w2"),
    ("-w+3", "~"),
    ("-u+1", "~"),
    ("-vtx", "~ -vtx"),
    ("-vt", "-vt"),
    ("-vtvl", "-vtvl"),
    ("-vp 1 2", "-vp"),
    ("-vpx 1 2 3", "-vpx"),
    ("-vf v.vf", "~ -vf"),
    ("-av 1", "-av"),
    ("-av 1 2 x", "-av"),
    ("-ap foo 3 1", "-ap"),
    ("-b", "-b"),
    ("-", "-"),
    ("--", "--"),
    ("-e", "-e"),
    ("-e ''", "-e"),
    ("-temod", "-temod"),
    ("-te mod", "-te ~"),
    ("-pc 1 2 3", "-pc"),
    ("-fc", "-fc"),
    ("-fb", "-fb"),
    ("-fax", "-fax"),
    ("-faxx", "-faxx"),
    ("-faf", "-faf ~"),
    ("-t 1.5", "-t"),
    ("-ld", "-ld ~"),
    ("-ldx", "-ldx"),
    ("-h", "-h ~"),
    ("-hx", "-hx"),
    ("-pRGBx", "-pRGBx"),
    ("-pR", "-pR"),
    ("-pX", "-pX"),
    ("-pY", "-pY ~"),
    ("-psx", "-psx"),
    ("-ps 0", "~ -ps"),
    ("-S", "-S"),
    ("-S x", "-S"),
    ("-S -1", "~ -S"),
    ("-ro x", "~ -ro"),
    ("-rx", "-rx"),
    ("-versionx", "-versionx"),
    ("-vers", "-vers"),
    ("-helpx", "-helpx"),
    ("-defaults1", "-defaults1"),
    ("-def", "-def"),
    ("-ab 1 -features", "-features"),
    ("-x @four", "-x"),
    ("-co", "-co ~"),
    ("-cox", "-cox"),
    ("-cs 9 -co-", "-co- ~"),
    ("-lrx", "-lrx"),
    ("-sj 1.0", "-sj"),
    ("-de .1", "-de"),
    ("-ab 1 scene.oct", "~"),
];

#[test]
fn errors_are_found_where_radiance_finds_them() {
    for &(line, expected) in ERRORS {
        let mut at = expected.split(' ');
        let for_rpict = at.next().unwrap();
        let for_rtrace = at.next().unwrap_or(for_rpict);
        for (name, result, at) in [("rpict", rpict(line).1, for_rpict), ("rtrace", rtrace(line).1, for_rtrace)] {
            let text = result.err().map(|e| e.to_string());
            let wanted = (at != "~").then(|| format!("fatal - command line error at '{at}'"));
            assert_eq!(text, wanted, "{name} {line}");
        }
    }
}

#[test]
fn other_errors_have_their_own_words() {
    for (line, text) in [
        ("@nofile", "system - cannot expand '@nofile': No such file or directory"),
        ("$NOVAR", "system - cannot expand '$NOVAR': No such file or directory"),
        ("-aE no", "system - cannot open ambient exclude file \"no\": No such file or directory"),
        ("-aI no", "system - cannot open ambient include file \"no\": No such file or directory"),
        ("-tI no", "system - cannot open trace include file \"no\": No such file or directory"),
        ("-am 0", "fatal - invalid max photon search radius"),
        ("-pc 1 1 1 1 1 1 1 1", "fatal - illegal primary chromaticities"),
        ("-pc .6 .3 .3 .6 .1 .1 .3 0", "fatal - illegal primary chromaticities"),
        ("-n 0", "fatal - bad number of processes"),
    ] {
        assert_eq!(rtrace(line).1.unwrap_err().to_string(), text);
    }
}

#[test]
fn words_are_expanded_where_options_stand() {
    let (options, result) = rtrace("$OPTIONS $NOTHING -te @four room.oct");
    let Ok(Scan::Run { octree, words, .. }) = result else { panic!("{result:?}") };
    assert_eq!(octree.as_deref(), Some("room.oct"));
    assert_eq!(words.join(" "), "-ab 2 -ad 99 -aa .3 -te @four");
    let ambient = &options.rendering.options.ambient;
    assert_eq!((ambient.bounces, ambient.divisions, ambient.accuracy), (2, 99, 0.3));
    let read = Scan::Run { octree: None, words: words_of("-te room.oct"), flags: vec!["te"], excess: Vec::new() };
    assert_eq!(rtrace("-te room.oct").1.unwrap(), read);
}

#[test]
fn what_follows_the_octree_is_left_for_the_error_file() {
    for (line, after) in [("scene.oct -ab 1", "-ab 1"), ("scene.oct b.oct", "b.oct"), ("@octree -h", "-h")] {
        let Ok(Scan::Run { octree, excess, .. }) = rtrace(line).1 else { panic!("{line}") };
        assert_eq!((octree.as_deref(), excess.join(" ").as_str()), (Some("scene.oct"), after));
    }
}

#[test]
fn words_that_stand_for_themselves_are_named() {
    let text = rtrace("@itself room.oct").1.unwrap_err().to_string();
    assert!(text.starts_with("fatal - '@itself' stands for itself"), "{text}");
}

fn words_of(line: &str) -> Vec<String> {
    words(line)
}

#[test]
fn switches_toggle() {
    assert!(!rtrace("-h").0.header);
    assert!(rtrace("-h -h").0.header);
    assert!(!rtrace("-u").0.rendering.options.uncorrelated);
    assert!(rpict("-u").0.rendering.options.uncorrelated);
    assert!(rtrace("-i+x").0.rendering.options.irradiance);
    assert!(!rtrace("-i -i0").0.rendering.options.irradiance);
}

#[test]
fn views_come_from_files_and_options_in_order() {
    assert_eq!(rpict("-vh 20 -vf v.vf -vv 10").0.view.horizontal, 60.0);
    assert_eq!(rpict("-vf v.vf -vh 20").0.view.horizontal, 20.0);
}

#[test]
fn defaults_are_those_of_radiance() {
    let text = |line: &str, rtrace_too: bool| {
        if rtrace_too {
            let (mut options, result) = rtrace(line);
            assert_eq!(result.unwrap(), Scan::Defaults);
            defaults(&ray_table(), &mut options)
        } else {
            let (mut options, result) = rpict(line);
            assert_eq!(result.unwrap(), Scan::Defaults);
            defaults(&picture_table(), &mut options)
        }
    };
    assert_eq!(text("-defaults -ab 7", false), include_str!("recorded/rpict-defaults.txt"));
    // Two processors: as `rtrace -n 2`.
    assert_eq!(text("-help", true), include_str!("recorded/rtrace-defaults.txt"));
    let all = "-w- -n 12 -x 3 -y 2 -ld+ -h- -ffd -odvVwWlLcpnNsmMrxRX~ -pXYZ -I -u -i -lr 0 -cs 9 -cw 700 400 \
               -me 1e-5 2 3 -am 1.5 -defaults";
    assert_eq!(text(all, true), include_str!("recorded/rtrace-defaults-all.txt"));
    let some = "-vtl -vp 1 2 3 -vs .4 -w -t 5 -ps 20 -x 1234567890 -pc .6 .3 .2 .6 .1 .05 .3 .3 -ab 100 -bv- -lr -3 \
                -lw 2.5e-7 -defaults";
    assert_eq!(text(some, false), include_str!("recorded/rpict-defaults-some.txt"));
}

#[test]
fn help_and_man_page_show_options_as_they_are_written() {
    let about =
        ambit_cli::About { name: "rpict", summary: "render", synopsis: "[options] [octree]", notes: "See rtrace." };
    let help = ambit_cli::long_help(&about, &picture_table());
    for part in ["  -ab <N>", "  -vtTYPE ", " --seed <N>", " -av <R> <G> <B>", " -defaults"] {
        assert!(help.contains(part), "{part} is missing in\n{help}");
    }
    assert!(!help.contains("--ab"));
    let page = String::from_utf8(ambit_cli::man_page(&about, &picture_table())).unwrap();
    assert!(page.contains("\\-ab") && !page.contains("-\\-ab") && !page.contains("--ab"), "{page}");
    for shell in ["bash", "zsh", "fish"] {
        let script = ambit_cli::completions(&about, &picture_table(), shell).unwrap();
        assert!(!String::from_utf8(script).unwrap().contains("--ab"));
    }
    assert!(ambit_cli::completions(&about, &picture_table(), "tcsh").is_none());
}

#[test]
fn blanks_around_numbers_do_not_matter() {
    let mut options = RayOptions::new(2);
    let line = ["-ab", " 2", "-aa", ".5 ", "-av", " 1", "2 ", " 3 "].map(String::from);
    scan(line, &ray_table(), &mut options, &World).unwrap();
    let ambient = options.rendering.options.ambient.clone();
    assert_eq!((ambient.bounces, ambient.accuracy, ambient.value.to_array()), (2, 0.5, [1.0, 2.0, 3.0]));
    let inside = ["-aa", "1 2"].map(String::from);
    assert_eq!(scan(inside, &ray_table(), &mut options, &World).unwrap_err().text, Failure::at("-aa").text);
}

#[test]
fn options_with_a_choice_say_which() {
    let about = ambit_cli::About { name: "rtrace", summary: "", synopsis: "", notes: "" };
    let help = ambit_cli::long_help(&about, &ray_table());
    for (option, choice) in [
        ("--reuse", &["auto", "strict", "append", "read-only", "off"][..]),
        ("--measured-reuse", &["auto", "on", "off"]),
        ("--bounces", &["apart", "mixed"]),
        ("--spacing", &["hessian", "classical"]),
        ("--step-test", &["on", "off"]),
        ("--overlap", &["0", "0.9"]),
    ] {
        for failure in [rtrace(&format!("{option} 7")).1.unwrap_err(), rpict(&format!("{option} 7")).1.unwrap_err()] {
            let start = format!("command line error at '{option}': ");
            assert!(failure.text.starts_with(&start), "{}", failure.text);
            for word in choice {
                assert!(failure.text.contains(word), "{word} is not in: {}", failure.text);
            }
        }
        let described = help.split(option).nth(1).expect("the option is in the help");
        let described = described.split("\n      --").next().unwrap_or_default();
        for word in choice {
            assert!(described.contains(word), "{word} is not in the help of {option}: {described}");
            assert!(option == "--overlap" || rtrace(&format!("{option} {word} o")).1.is_ok(), "{option} {word}");
        }
    }
}
