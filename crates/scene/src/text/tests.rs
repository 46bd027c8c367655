//! Where `rtrace` saw ink, in glyph units along a line through the middle of the characters.

use super::*;

/// A font of solid bars: code, left, right.
fn bars(bars: &[(char, u8, u8)]) -> Arc<Font> {
    let bar = |&(c, a, b): &(char, u8, u8)| format!("{} 4 {a} 0 {b} 0 {b} 255 {a} 255\n", c as u32);
    let text: String = bars.iter().map(bar).collect();
    Arc::new(Font::parse("f.fnt", (text + "32 0").as_bytes()).unwrap())
}

fn wide() -> Arc<Font> {
    bars(&[('A', 0, 128), ('B', 0, 200), ('C', 28, 128), ('D', 128, 228)])
}

fn narrow() -> Arc<Font> {
    bars(&[('A', 20, 120), ('B', 0, 127), ('C', 50, 100)])
}

/// Left and right ends of the stretches of ink.
fn ink(font: &Arc<Font>, text: &str, spacing: Option<f64>) -> Vec<(i64, i64)> {
    let block = TextBlock::new(font.clone(), [text], DVec3::ZERO, DVec3::X, DVec3::NEG_Y, spacing).unwrap();
    let units = spacing.map_or(255.0, |s| font.mean_width() as f64 + 255.0 * s.abs());
    let mut runs: Vec<(i64, i64)> = Vec::new();
    for i in -10..(300 * text.len() as i64 + 1000) {
        if !block.covers(DVec3::new((i as f64 + 0.5) / units, -0.5, 0.0)) {
            continue;
        }
        match runs.last_mut() {
            Some(last) if last.1 == i => last.1 = i + 1,
            _ => runs.push((i, i + 1)),
        }
    }
    runs
}

fn starts(font: &Arc<Font>, text: &str, spacing: f64) -> Vec<i64> {
    ink(font, text, Some(spacing)).iter().map(|r| r.0).collect()
}

#[test]
fn characters_are_squares_without_spacing() {
    let font = narrow();
    assert_eq!(ink(&font, "ABC", None), [(20, 120), (255, 382), (560, 610)]);
    assert_eq!(ink(&font, "CZC", None), [(50, 100), (305, 355)]);
    // An explicit zero, or next to it, scales but does not move.
    for s in [0.0, 0.001, -0.001] {
        assert_eq!(ink(&font, "ABC", Some(s)), [(20, 120), (255, 382), (560, 610)]);
    }
}

#[test]
fn negative_spacing_is_proportional() {
    let font = narrow();
    assert_eq!(ink(&font, "ABC", Some(-0.1)), [(24, 124), (156, 283), (308, 358)]);
    for (text, last) in
        [("A", 24), (" A", 128), ("A A", 260), ("A  A", 364), ("    A", 440), ("A    B", 572), ("AZB", 156)]
    {
        assert_eq!(starts(&font, text, -0.1).last(), Some(&last), "{text:?}");
    }
    let font = wide();
    assert_eq!(starts(&font, "ACA", -0.0079), [2, 132, 234]);
    assert_eq!(starts(&font, "ACA", -2.0), [510, 1148, 1758]);
}

#[test]
fn positive_spacing_fills_cells() {
    let font = wide();
    for (text, expected) in [
        ("AA", &[50, 233][..]),
        ("CC", &[50, 219]),
        ("AB", &[50, 197]),
        ("BA", &[50, 269]),
        ("CCC", &[50, 223, 397]),
        ("ACACA", &[50, 244, 410, 604, 770]),
        ("ABABA", &[50, 205, 431, 585, 811]),
        ("CCCCCCCC", &[50, 229, 408, 587, 766, 946, 1126, 1306]),
        ("CC ", &[50, 229]),
        ("CC  ", &[50, 235]),
        ("CC     ", &[50, 241]),
        ("A A A", &[50, 406, 763]),
        ("C C C", &[50, 400, 752]),
        (" A", &[197]),
        ("   A", &[545]),
    ] {
        assert_eq!(starts(&font, text, 0.2), expected, "{text:?}");
    }
    assert_eq!(starts(&font, "ACA", 1.5), [382, 905, 1400]);
    assert_eq!(starts(&narrow(), "ABC", 0.1), [24, 150, 296]);
}

#[test]
fn blanks_in_a_row_bring_columns_in_line() {
    let font = wide();
    for (text, expected) in [
        ("    A", &[757][..]),
        ("      A", &[1123]),
        ("    C", &[785]),
        ("A   A", &[50, 782]),
        ("C      C", &[50, 1331]),
        ("A    A    A", &[50, 965, 1880]),
        ("CC    CC", &[50, 245, 1148, 1317]),
        ("CCC     CCC", &[50, 244, 438, 1514, 1687, 1861]),
        ("   C   C", &[592, 1334]),
        ("    CC    C", &[785, 980, 1883]),
    ] {
        assert_eq!(starts(&font, text, 0.2), expected, "{text:?}");
    }
}

#[test]
fn unknown_characters_take_no_room_but_share_the_gaps() {
    let font = wide();
    for (text, expected) in [
        ("AZA", &[50, 234][..]),
        ("AZZA", &[50, 235]),
        ("ZA", &[28]),
        ("ZZA", &[20]),
        ("CCZ", &[50, 212]),
        ("C  Z C", &[50, 755]),
        ("C  Z  C", &[50, 935]),
        ("C   ZC", &[50, 783]),
        ("CZ   C", &[50, 755]),
        ("ZC   C", &[82, 760]),
        ("Z   C", &[554]),
        ("Z    C", &[760]),
        ("  Z  C", &[754]),
        ("   ZC", &[574]),
    ] {
        assert_eq!(starts(&font, text, 0.2), expected, "{text:?}");
    }
}

#[test]
fn squeezed_glyphs_overlap() {
    let font = bars(&[('A', 0, 60), ('B', 0, 250), ('E', 0, 60), ('F', 0, 60), ('G', 0, 60), ('H', 0, 60)]);
    for (text, expected) in [
        ("AB", &[(4, 64), (96, 310)][..]),
        ("BA", &[(4, 278)]),
        ("ABB", &[(4, 64), (76, 463)]),
        ("BAB", &[(4, 258), (270, 463)]),
        ("BAAA", &[(4, 309), (372, 432), (494, 554)]),
        ("AZB", &[(4, 64), (108, 310)]),
        ("BZA", &[(4, 265)]),
        ("BZZA", &[(4, 258)]),
    ] {
        let seen: Vec<_> = ink(&font, text, Some(0.02));
        let near = |a: &(i64, i64), b: &(i64, i64)| (a.0 - b.0).abs() <= 1 && (a.1 - b.1).abs() <= 1;
        assert!(seen.len() == expected.len() && seen.iter().zip(expected).all(|(a, b)| near(a, b)), "{text}: {seen:?}");
    }
}

#[test]
fn lines_go_down_and_planes_slant() {
    let lines = [&b"A"[..], b"", b"C\r", b" B"];
    let block = TextBlock::new(wide(), lines, DVec3::ZERO, DVec3::X, DVec3::NEG_Y, None).unwrap();
    let at = |x: f64, y: f64| block.covers(DVec3::new(x / 255.0, -y, 7.0));
    assert!(at(10.5, 0.5) && !at(10.5, 1.5) && at(30.5, 2.5) && !at(10.5, 2.5) && at(300.5, 3.5));
    assert!(!at(10.5, 4.5) && !at(10.5, -0.5) && !at(-1.0, 0.5));
    let (r, d) = (DVec3::new(0.5, 0.2, 0.3), DVec3::new(0.1, -1.0, 0.2));
    let block = TextBlock::new(wide(), ["AC"], DVec3::ONE, r, d, None).unwrap();
    let at = |x: f64, y: f64| block.covers(DVec3::ONE + x * r + y * d + 3.0 * r.cross(d));
    assert!(at(0.2, 0.5) && at(1.2, 0.5) && !at(0.9, 0.5) && !at(1.05, 0.5));
    let error = TextBlock::new(wide(), ["A"], DVec3::ZERO, r, 3.0 * r, None).unwrap_err();
    assert_eq!(error.to_string(), "illegal motion vector");
}

/// `brighttext` with a font of two squares, as `rtrace` shaded it.
#[test]
fn a_small_square_fills_a_quarter() {
    let font =
        Font::parse("box.fnt", b"65 4\n0 0\n255 0\n255 255\n0 255\n66 4\n0 0\n127 0\n127 127\n0 127\n32 0\n").unwrap();
    let block = TextBlock::new(Arc::new(font), ["AB"], DVec3::Y, DVec3::X, DVec3::NEG_Y, None).unwrap();
    for (x, y, covered) in [(1.25, 0.25, true), (1.75, 0.25, false), (1.25, 0.75, false), (0.75, 0.75, true)] {
        assert_eq!(block.covers(DVec3::new(x, y, 0.0)), covered, "{x} {y}");
    }
}

#[test]
fn absurd_spacing_does_no_harm() {
    for s in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e300] {
        let block = TextBlock::new(wide(), ["A A   B"], DVec3::ZERO, DVec3::X, DVec3::NEG_Y, Some(s)).unwrap();
        assert!(!block.covers(DVec3::new(-0.5, -0.5, 0.0)));
    }
}
