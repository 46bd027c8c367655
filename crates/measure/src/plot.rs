//! Error against time, both on logarithmic axes: a line through the sensible settings of each program, bounds of error
//! and extremes of time as whiskers, and the least error that the reference can show.

use crate::error::Error;
use crate::report::{Report, SideRow};
use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters::style::register_font;
use std::ops::Range;

/// Pixels (of SVG: user units) of a plot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlotSize {
    /// In x.
    pub width: u32,
    /// In y.
    pub height: u32,
}

impl Default for PlotSize {
    fn default() -> Self {
        Self { width: 900, height: 600 }
    }
}

/// The programs' colours, which differ for the colour-blind, too (Okabe & Ito 2008): blue, vermilion.
const COLOURS: [RGBColor; 2] = [RGBColor(0, 114, 178), RGBColor(213, 94, 0)];

/// Space around the points, as a factor of time and of error.
const ROOM: f64 = 1.35;

/// The plot as SVG text.
pub fn svg(report: &Report, size: PlotSize) -> Result<String, Error> {
    let mut text = String::new();
    draw(report, &SVGBackend::with_string(&mut text, (size.width, size.height)).into_drawing_area())?;
    Ok(text)
}

/// The plot as the bytes of a PNG file.
pub fn png(report: &Report, size: PlotSize) -> Result<Vec<u8>, Error> {
    let mut pixels = vec![255; size.width as usize * size.height as usize * 3];
    draw(report, &BitMapBackend::with_buffer(&mut pixels, (size.width, size.height)).into_drawing_area())?;
    let mut out = std::io::Cursor::new(Vec::new());
    let image = image::RgbImage::from_raw(size.width, size.height, pixels).ok_or_else(|| failed("no pixels"))?;
    image.write_to(&mut out, image::ImageFormat::Png).map_err(|e| failed(&e.to_string()))?;
    Ok(out.into_inner())
}

fn failed(problem: &str) -> Error {
    Error::Write { what: "plot", problem: problem.to_owned() }
}

/// A logarithmic axis with marks at 1, 2 and 5 of each decade.
struct LogAxis(Range<f64>);

impl LogAxis {
    /// Around these positive numbers, with room.
    fn around(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = values.fold((f64::INFINITY, 0.0), |(l, h): (f64, f64), v| (l.min(v), h.max(v)));
        if low.is_finite() { Self(low / ROOM..high * ROOM) } else { Self(0.1..1.0) }
    }
}

impl Ranged for LogAxis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (start, end): (i32, i32)) -> i32 {
        let part = (value.max(f64::MIN_POSITIVE) / self.0.start).ln() / (self.0.end / self.0.start).ln();
        // Beyond the frame by a frame's width at most, so that no point leaves the integers.
        start + (f64::from(end - start) * part.clamp(-1.0, 2.0)).round() as i32
    }

    fn key_points<H: KeyPointHint>(&self, hint: H) -> Vec<f64> {
        let (first, last) = (self.0.start.log10().floor() as i32, self.0.end.log10().ceil() as i32);
        let marks = |of: &[f64]| -> Vec<f64> {
            let all = (first..=last).flat_map(|d| of.iter().map(move |m| m * 10.0_f64.powi(d)));
            all.filter(|v| self.0.contains(v)).collect()
        };
        // Few marks in each decade if there are many decades, all of them if there are few.
        let choices: [&[f64]; 4] =
            [&[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0], &[1.0, 2.0, 5.0], &[1.0, 3.0], &[1.0]];
        let fitting = choices.iter().map(|c| marks(c)).find(|m| m.len() <= hint.max_num_points());
        fitting.unwrap_or_default()
    }

    fn range(&self) -> Range<f64> {
        self.0.clone()
    }
}

impl ValueFormatter<f64> for LogAxis {
    fn format(value: &f64) -> String {
        // Marks have two digits at most; rounding takes off what powers of ten add.
        format!("{}", (value * 1e9).round() / 1e9)
    }
}

/// A row as a point with whiskers: time, error in per cent.
struct Mark {
    time: [f64; 3],
    error: [f64; 3],
    on_curve: bool,
}

fn marks(report: &Report, side: usize) -> Vec<Mark> {
    let curve = report.curve(side);
    let rows = report.rows.iter().filter_map(|r| r.sides.get(side)).filter(|s: &&SideRow| s.visible);
    rows.map(|s| Mark {
        time: [s.wall.least, s.wall.median, s.wall.most],
        error: [s.score.rms.low, s.score.rms.value, s.score.rms.high].map(|e| 100.0 * e),
        on_curve: curve.points().contains(&s.point()),
    })
    .collect()
}

fn draw<B: DrawingBackend>(report: &Report, area: &DrawingArea<B, Shift>) -> Result<(), Error> {
    // Registered again each time, which costs nothing much; there is no other place for a font.
    register_font("sans-serif", FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT)
        .map_err(|_| failed("the font can not be read"))?;
    inner(report, area).map_err(|e| failed(&e.to_string()))
}

fn inner<B: DrawingBackend>(
    report: &Report,
    area: &DrawingArea<B, Shift>,
) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
    area.fill(&WHITE)?;
    let all: Vec<Vec<Mark>> = (0..report.programs.len()).map(|i| marks(report, i)).collect();
    let floor = report.reference.noise.map(|n| 100.0 * n.floor);
    let times = LogAxis::around(all.iter().flatten().flat_map(|m| m.time));
    let errors = LogAxis::around(all.iter().flatten().flat_map(|m| m.error));
    let (times_range, errors_range) = (times.range(), errors.range());
    let mut chart = ChartBuilder::on(area)
        .caption(&report.title, ("sans-serif", 24))
        .margin(14)
        .x_label_area_size(52)
        .y_label_area_size(68)
        .build_cartesian_2d(times, errors)?;
    chart
        .configure_mesh()
        .x_labels(14)
        .y_labels(12)
        .x_desc("wall-clock time, s")
        .y_desc("RMS error, % of the mean")
        .axis_desc_style(("sans-serif", 18))
        .label_style(("sans-serif", 16))
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .draw()?;
    for (i, marks) in all.iter().enumerate() {
        let colour = COLOURS[i % COLOURS.len()];
        let on = marks.iter().filter(|m| m.on_curve);
        let mut points: Vec<(f64, f64)> = on.map(|m| (m.time[1], m.error[1])).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        chart
            .draw_series(LineSeries::new(points, colour.stroke_width(2)))?
            .label(report.programs[i].name.clone())
            .legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 24, y)], colour.stroke_width(2)));
        chart.draw_series(marks.iter().flat_map(|m| {
            [
                PathElement::new(vec![(m.time[1], m.error[0]), (m.time[1], m.error[2])], colour.mix(0.6)),
                PathElement::new(vec![(m.time[0], m.error[1]), (m.time[2], m.error[1])], colour.mix(0.6)),
            ]
        }))?;
        // What is on no curve is hollow.
        chart.draw_series(marks.iter().map(|m| {
            let style = if m.on_curve { colour.filled() } else { colour.stroke_width(1) };
            Circle::new((m.time[1], m.error[1]), 4, style)
        }))?;
    }
    if let Some(floor) = floor.filter(|f| errors_range.contains(f)) {
        let line = (0..=40)
            .map(|i| (times_range.start * (times_range.end / times_range.start).powf(f64::from(i) / 40.0), floor));
        chart
            .draw_series(DashedLineSeries::new(line, 6, 5, BLACK.mix(0.5).into()))?
            .label("least error that the reference shows")
            .legend(|(x, y)| PathElement::new(vec![(x, y), (x + 24, y)], BLACK.mix(0.5)));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.3))
        .label_font(("sans-serif", 17))
        .draw()?;
    area.present()
}
