//! Values and messages as `rtrace` printed them.

use super::*;

fn table(text: &str) -> DataTable {
    DataTable::parse("d.dat", "./d.dat", text.as_bytes()).unwrap_or_else(|e| panic!("{text}: {e}"))
}

fn close(text: &str, cases: &[(&[f64], f64)]) {
    let table = table(text);
    for &(point, expected) in cases {
        let value = table.interpolate(point);
        assert!((value - expected).abs() <= 1e-6 * expected.abs().max(1.0), "{text:?} {point:?}: {value} {expected}");
    }
}

#[test]
fn even_axes() {
    // Radiance 6.0a, brightdata with noop.
    close(
        "1\n0 2 3\n10 20 40\n",
        &[
            (&[-1.0], 0.0),
            (&[0.0], 10.0),
            (&[0.5], 15.0),
            (&[2.5], 50.0),
            (&[3.0], 60.0),
            (&[3.001], 19.99334),
            (&[4.0], 15.0),
            (&[5.0], 12.0),
            (&[9.0], 6.666667),
        ],
    );
    close(
        "1\n0 1 2\n10 12\n",
        &[
            (&[-4.0], 2.0),
            (&[-2.0], 4.0),
            (&[-1.001], 7.992008),
            (&[-1.0], 8.0),
            (&[2.0], 14.0),
            (&[2.001], 4.665112),
            (&[3.0], 3.5),
        ],
    );
    // Falling.
    close("1\n2 0 3\n10 20 40\n", &[(&[-1.001], 19.99334), (&[-1.0], 60.0), (&[0.5], 30.0), (&[2.5], 5.0)]);
}

#[test]
fn uneven_axes() {
    for text in ["1\n0 0 3 0 1 4\n10 20 40", "1\n5 5 3 0 1 4\n10 20 40", "1\n1 1.00000001 3 0 1 4\n10 20 40"] {
        close(
            text,
            &[
                (&[-1.0], 0.0),
                (&[0.5], 15.0),
                (&[1.5], 23.33333),
                (&[4.0], 40.0),
                (&[5.0], 46.66667),
                (&[9.0], 16.36364),
            ],
        );
    }
    close(
        "1\n0 0 3 4 1 0\n10 20 40\n",
        &[(&[-1.0], 60.0), (&[-1.001], 19.99334), (&[2.0], 16.66667), (&[5.0], 6.666667)],
    );
    close(
        "1\n0 0 4 0 1 4 9\n10 20 40 10",
        &[(&[-3.0], 0.0), (&[2.0], 26.66667), (&[6.0], 28.0), (&[13.0], -14.0), (&[20.0], -4.761905)],
    );
}

#[test]
fn more_dimensions() {
    close(
        "2\n0 0 3 0 1 4\n0 1 2\n1 2 3 4 5 6",
        &[
            (&[-1.0, -2.0], -1.0),
            (&[-1.0, 0.25], -0.75),
            (&[-1.0, 3.0], 0.25),
            (&[0.5, -2.0], 0.5),
            (&[0.5, 0.25], 2.25),
            (&[0.5, 3.0], 1.0),
            (&[2.0, -2.0], 1.333333),
            (&[9.0, 0.25], 1.977273),
            (&[2.0, 0.5], 4.166667),
            (&[4.0, 1.0], 6.0),
            (&[5.0, 0.5], 6.166667),
        ],
    );
    close("1\n0 4 5\n1 2 4 8 16", &[(&[5.0], 24.0), (&[5.5], 6.857143), (&[9.0], 3.428571), (&[4.5], 20.0)]);
    // Every corner of six dimensions is its own value.
    let text = format!("6 {} {}", "0 1 2 ".repeat(6), (0..64).map(|i| i.to_string()).collect::<Vec<_>>().join(" "));
    let six = table(&text);
    for i in 0..64usize {
        let point: Vec<f64> = (0..6).map(|d| f64::from(u8::from(i >> (5 - d) & 1 == 1))).collect();
        assert_eq!(six.interpolate(&point), i as f64);
    }
}

#[test]
fn results_are_finite() {
    let t = table("1 0 1 2 3 4");
    for p in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e300, -1e300] {
        assert!(t.interpolate(&[p]).is_finite());
    }
    assert!(DataTable::new(vec![Axis::even(0.0, 0.0, 1)], vec![7.0]).unwrap().interpolate(&[3.0]) == 7.0);
    assert!(DataTable::new(vec![Axis::even(0.0, 0.0, 2)], vec![7.0, 8.0]).is_none());
    assert!(DataTable::new(vec![Axis::even(0.0, 1.0, 2)], vec![7.0]).is_none());
}

#[test]
fn faults_are_worded() {
    let dimensions = "bad number of dimensions for \"d.dat\"";
    let format = "bad format in data file \"./d.dat\"";
    let ends = "unexpected EOF in data file \"./d.dat\"";
    for (text, message) in [
        ("0\n", dimensions),
        ("7\n", dimensions),
        ("-1\n", dimensions),
        ("1", ends),
        ("x", ends),
        ("", ends),
        ("1.0\n0 1 2\n1 2", format),
        ("1\n0 1 1\n1", format),
        ("1\n0 1 2.0\n1 2", format),
        ("1\n0 1 2\n1", ends),
        ("1\n0 1 2\n1 x", ends),
        ("1\n0 1 2 1,2", ends),
        ("1\n0 1 2 x 2", format),
        ("1\n0 1 2 nan 2", format),
        ("1\n0 1 2 1e 2", format),
        ("1\n0 1 2 \"1\" 2", format),
        ("1\n0 1 -2\n", format),
        ("1\n0 1 2000000000\n1", ends),
        ("2\n0 1 70000\n0 1 70000\n1", ends),
        ("1\n0 0 3 0 1 .5\n1 2 3", format),
        ("1\n0 0 3 0 1 1\n1 2 3", format),
        ("1\n0 0 3 0 0 1\n1 2 3", format),
        ("1\n0 1e-50 2 1 2", ends),
    ] {
        let error = DataTable::parse("d.dat", "./d.dat", text.as_bytes()).expect_err(text);
        assert_eq!(error.to_string(), message, "{text:?}");
    }
    let long = |zeros: usize| format!("1\n0 1 2\n{}1 2\n", "0".repeat(zeros));
    assert_eq!(table(&long(62)).values(), [1.0, 2.0]);
    let error = DataTable::parse("d.dat", "./d.dat", long(63).as_bytes()).unwrap_err();
    assert_eq!((error.to_string().as_str(), error.location().to_string().as_str()), (format, "./d.dat:3:1"));
    assert_eq!(table("+1 0 1#c\n +2 1#d\r\n2 and more").values(), [1.0, 2.0]);
}
