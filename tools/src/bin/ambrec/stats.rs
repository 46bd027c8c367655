//! What is in an ambient file, by level.

use crate::store::{Failure, Told, contents, print as write};
use ambit_ambient::{Contents, Layout, Record, fingerprint_lines, segments};
use ambit_base::{Colour, DVec3};
use ambit_file::{bytes_of, text_of};
use std::collections::{HashMap, HashSet};
use std::fmt::Write;
use std::path::Path;

/// Records whose normals differ by more than this cosine are not neighbours.
const FACING: f64 = 0.5;
/// How often the cells in which neighbours are looked for are doubled.
const DOUBLINGS: u32 = 12;

/// Records by place.
pub(crate) struct Grid<'a> {
    cell: f64,
    records: HashMap<[i64; 3], Vec<&'a Record>>,
}

impl<'a> Grid<'a> {
    /// A grid of cells of this edge.
    pub(crate) fn new(records: &'a [Record], cell: f64) -> Self {
        let mut grid = Self { cell, records: HashMap::new() };
        for r in records {
            grid.records.entry(grid.place(r.position)).or_default().push(r);
        }
        grid
    }

    fn place(&self, p: DVec3) -> [i64; 3] {
        (p / self.cell).floor().to_array().map(|c| c as i64)
    }

    /// The nearest record that will do, not the given one itself, if it is within a cell's edge; and its distance.
    pub(crate) fn nearest(&self, from: &Record, will_do: impl Fn(&Record) -> bool) -> Option<(&'a Record, f64)> {
        let [x, y, z] = self.place(from.position);
        let mut best: Option<(&Record, f64)> = None;
        for k in 0..27 {
            let place = [x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1];
            for &r in self.records.get(&place).into_iter().flatten() {
                let d = r.position.distance(from.position);
                if !std::ptr::eq(r, from) && d <= self.cell && best.is_none_or(|(_, b)| d < b) && will_do(r) {
                    best = Some((r, d));
                }
            }
        }
        best
    }
}

/// Least, median and largest of some numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Spread {
    least: f64,
    median: f64,
    largest: f64,
}

impl Spread {
    fn of(numbers: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut all: Vec<f64> = numbers.into_iter().collect();
        all.sort_by(f64::total_cmp);
        let (&least, &largest) = (all.first()?, all.last()?);
        Some(Self { least, median: all[all.len() / 2], largest })
    }

    fn json(of: Option<Self>) -> String {
        of.map_or("null".to_owned(), |s| format!("[{}, {}, {}]", s.least, s.median, s.largest))
    }

    fn text(of: Option<Self>) -> String {
        of.map_or("-".to_owned(), |s| format!("{:.4} {:.4} {:.4}", s.least, s.median, s.largest))
    }
}

/// The records of one level.
struct Level {
    number: u8,
    count: usize,
    weights: Option<Spread>,
    radii: Option<Spread>,
    spacing: Option<Spread>,
    values: Option<Spread>,
    corralled: usize,
}

impl Level {
    fn of(number: u8, all: &[Record]) -> Self {
        let records: Vec<Record> = all.iter().filter(|r| r.level == number).cloned().collect();
        let each = |f: fn(&Record) -> f64| Spread::of(records.iter().map(f));
        Self {
            number,
            count: records.len(),
            weights: each(|r| f64::from(r.weight)),
            radii: each(|r| f64::from(r.radii[0] * r.radii[1]).sqrt()),
            spacing: Spread::of(spacing(&records)),
            values: each(|r| f64::from(r.value.mean())),
            corralled: records.iter().filter(|r| r.corral != 0).count(),
        }
    }
}

/// The distance of every record to its nearest neighbour that faces the same way, if there is one.
fn spacing(records: &[Record]) -> Vec<f64> {
    let Some(radii) = Spread::of(records.iter().map(|r| f64::from(r.radii[0]))) else { return Vec::new() };
    let mut found = Vec::new();
    let mut cell = 0.05 * radii.median;
    let mut open: Vec<&Record> = records.iter().collect();
    for _ in 0..DOUBLINGS {
        if open.is_empty() {
            break;
        }
        let grid = Grid::new(records, cell);
        open.retain(|r| match grid.nearest(r, |o| o.normal.dot(r.normal) > FACING) {
            Some((_, distance)) => {
                found.push(distance);
                false
            }
            None => true,
        });
        cell *= 2.0;
    }
    found
}

/// Prints what is in a file.
pub(crate) fn print(path: &Path, json: bool) -> Result<(), Failure> {
    let contents = contents(path)?;
    let parts = segments(path, &contents, &Told);
    let levels: Vec<u8> = (0..=255).filter(|&l| contents.records.iter().any(|r| r.level == l)).collect();
    let levels: Vec<Level> = levels.into_iter().map(|l| Level::of(l, &contents.records)).collect();
    let encode = |r: &Record| Layout::CURRENT.encode(r, &contents.components);
    let distinct: HashSet<_> = contents.records.iter().map(encode).collect();
    let summary = Summary {
        contents: &contents,
        segments: parts.len(),
        repeated: contents.records.len() - distinct.len(),
        low: contents.records.iter().fold(DVec3::INFINITY, |b, r| b.min(r.position)),
        high: contents.records.iter().fold(DVec3::NEG_INFINITY, |b, r| b.max(r.position)),
    };
    let text = if json { summary.json(&levels) } else { summary.text(&levels) };
    write(&bytes_of(&text))
}

struct Summary<'a> {
    contents: &'a Contents,
    segments: usize,
    repeated: usize,
    low: DVec3,
    high: DVec3,
}

impl Summary<'_> {
    fn text(&self, levels: &[Level]) -> String {
        let c = self.contents;
        let mut text = String::new();
        // Writing to memory does not fail.
        let mut say = |name: &str, value: String| {
            let _ = writeln!(text, "{name:<10} {value}");
        };
        for line in c.header.lines().skip(1).take(1).chain(fingerprint_lines(&c.header)) {
            say("header", text_of(line).into_owned());
        }
        say("layout", format!("{}, {} channels", c.layout.magic(), c.header.components()));
        say("records", format!("{}", c.records.len()));
        for (name, count) in
            [("damaged", c.damaged), ("torn bytes", c.torn), ("repeated", self.repeated), ("segments", self.segments)]
        {
            if count > 0 {
                say(name, count.to_string());
            }
        }
        if c.records.is_empty() {
            return text;
        }
        say("extent", format!("{} to {}", point(self.low), point(self.high)));
        for l in levels {
            let share = 100.0 * l.count as f64 / c.records.len() as f64;
            say(
                &format!("level {}", l.number),
                format!("{} records, {share:.1} %; {} corralled", l.count, l.corralled),
            );
            say("  weight", Spread::text(l.weights));
            say("  radius", Spread::text(l.radii));
            say("  spacing", Spread::text(l.spacing));
            say("  value", Spread::text(l.values));
        }
        text += "(three numbers are the least, the median and the largest)\n";
        text
    }

    fn json(&self, levels: &[Level]) -> String {
        let c = self.contents;
        let vector = |v: DVec3| if v.is_finite() { format!("[{}, {}, {}]", v.x, v.y, v.z) } else { "null".to_owned() };
        let quoted = |line: &[u8]| {
            let text = String::from_utf8_lossy(line).replace('\\', "\\\\").replace('"', "\\\"");
            let plain: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
            format!("\"{plain}\"")
        };
        let header: Vec<String> = c.header.lines().map(quoted).collect();
        let levels: Vec<String> = levels
            .iter()
            .map(|l| {
                format!(
                    "    {{\"level\": {}, \"records\": {}, \"corralled\": {}, \"weight\": {}, \"radius\": {}, \
                     \"spacing\": {}, \"value\": {}}}",
                    l.number,
                    l.count,
                    l.corralled,
                    Spread::json(l.weights),
                    Spread::json(l.radii),
                    Spread::json(l.spacing),
                    Spread::json(l.values)
                )
            })
            .collect();
        format!(
            "{{\n  \"header\": [{}],\n  \"layout\": {},\n  \"records\": {},\n  \"damaged\": {},\n  \"torn_bytes\": {},\n  \
             \"repeated\": {},\n  \"segments\": {},\n  \"low\": {},\n  \"high\": {},\n  \"levels\": [\n{}\n  ]\n}}\n",
            header.join(", "),
            c.layout.magic(),
            c.records.len(),
            c.damaged,
            c.torn,
            self.repeated,
            self.segments,
            vector(self.low),
            vector(self.high),
            levels.join(",\n")
        )
    }
}

fn point(p: DVec3) -> String {
    format!("({} {} {})", p.x, p.y, p.z)
}
