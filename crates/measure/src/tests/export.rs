use super::*;
use crate::curve::Curve;
use crate::ladder::Ladder;
use crate::page::{Entry, page};
use crate::parts::Part;
use crate::plot::{PlotSize, png, svg};
use crate::ratio::compare;
use crate::reference::Noise;
use crate::report::{Program, ReferenceInfo, Row, Run, SideRow, Spread};
use crate::score::{Bounded, Score};
use crate::table::table;

/// Error 0.1/√time for the first program, twice that for the second; the third rung of the first is below the noise.
fn report() -> Report {
    let bounded = |value: f64| Bounded { value, low: value * 0.9, high: value * 1.1 };
    let side = |time: f64, error: f64| SideRow {
        wall: Spread { median: time, least: time * 0.95, most: time * 1.2 },
        cpu: Spread { median: time, least: time, most: time },
        peak: 5 << 20,
        records: Some(12),
        rays: None,
        score: Score { rms: bounded(error), raw: error * 1.01, bias: bounded(0.001), p99: bounded(error * 3.0) },
        visible: error > 0.0,
        runs: vec![Run { views: vec![time, time / 8.0], cpu: time, rms: error, bias: 0.001 }],
    };
    let rungs = Ladder::parse("-ad 1\n-ad 4\n-ad 16", "t").unwrap().rungs;
    let rows: Vec<Row> = (0..)
        .zip(rungs)
        .map(|(i, rung)| {
            let time = 4.0_f64.powi(i);
            let first = if i == 2 { 0.0 } else { 0.1 / time.sqrt() };
            Row { rung, sides: vec![side(time, first), side(time, 0.2 / time.sqrt())] }
        })
        .collect();
    let curve = |i: usize| Curve::new(rows.iter().map(|r| r.sides[i].point()));
    let comparison = Some(compare(["ours", "theirs"], &curve(0), &curve(1), &[(curve(0), curve(1))]));
    let program = |name: &str| Program {
        name: name.to_owned(),
        path: "/bin/rpict".to_owned(),
        version: "1".to_owned(),
        words: "-n 1".to_owned(),
    };
    let noise = Some(Noise { rms: 0.01, floor: 0.04 });
    Report {
        title: "a room, \"lit\"".to_owned(),
        date: "today".to_owned(),
        machine: "one".to_owned(),
        software: "raderr".to_owned(),
        scene: vec!["scene.oct".to_owned()],
        views: vec!["-vf a.vf".to_owned(), "-vf b.vf".to_owned()],
        common: "-ab 2".to_owned(),
        programs: vec![program("ours"), program("theirs")],
        reference: ReferenceInfo { lines: vec!["PASSES=4".to_owned()], mean: 1.0, noise, left_out: None },
        parts: vec![Part { width: 4, height: 4 }; 2],
        cell: 1,
        rows,
        comparison,
    }
}

#[test]
fn json_comes_back_whole() {
    let text = to_json(&report()).unwrap();
    assert_eq!(Report::from_json(&text, "r.json").unwrap(), report());
    assert!(Report::from_json("{}", "r.json").unwrap_err().to_string().starts_with("r.json: "));
}

#[test]
fn csv_has_a_line_for_each_program_and_rung() {
    let text = to_csv(&report()).unwrap();
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let heads = reader.headers().unwrap().clone();
    let at = |name: &str| heads.iter().position(|h| h == name).unwrap();
    let rows: Vec<_> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 6);
    assert_eq!((&rows[3][at("program")], &rows[3][at("rms")], &rows[3][at("rays")]), ("theirs", "0.1", ""));
    assert_eq!((&rows[3][at("title")], &rows[3][at("options")]), ("a room, \"lit\"", "-ad 4"));
}

#[test]
fn the_table_says_what_was_found() {
    let text = table(&report());
    // Both reach 5 to 10 %; the second needs four times as long.
    assert!(text.contains("5.00 to 10.00 %: theirs takes 4.00 times as long as ours"), "{text}");
    assert!(text.contains("ours, rungs 3: the error is too small for this reference"), "{text}");
    assert!(text.contains("took 12 % of the first view's time"), "{text}");
    assert!(text.contains("sqrt(mean of (x-a)(x-b)) / m"), "{text}");
}

#[test]
fn the_page_has_plot_summary_and_circumstances() {
    let text = page(&[Entry { report: report(), plot: "plots/room.svg".to_owned() }], "tools/bench/curves");
    for part in ["](plots/room.svg)", "| **4.00** |", "PASSES=4", "tools/bench/curves", "| `-ad 4` | theirs |"] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

#[test]
fn plots_show_marks_for_all_points() {
    let text = svg(&report(), PlotSize::default()).unwrap();
    // Two of the first program (the third is below the noise), three of the second.
    assert_eq!(text.matches("<circle").count(), 5, "{text}");
    assert!(text.contains("RMS error") && text.contains("theirs"));
    let size = PlotSize { width: 450, height: 300 };
    let bytes = png(&report(), size).unwrap();
    let image = image::load_from_memory(&bytes).unwrap().to_rgb8();
    assert_eq!((image.width(), image.height()), (size.width, size.height));
    for colour in [[0, 114, 178], [213, 94, 0]] {
        // Rounding of what is drawn over white.
        let near = |p: &image::Rgb<u8>| p.0.iter().zip(colour).all(|(a, b): (&u8, u8)| a.abs_diff(b) <= 3);
        assert!(image.pixels().any(near), "no {colour:?}");
    }
}

#[test]
fn a_report_of_nothing_visible_is_still_drawn() {
    let mut empty = report();
    empty.rows.clear();
    empty.programs.truncate(1);
    assert!(svg(&empty, PlotSize::default()).unwrap().contains("</svg>"));
}
