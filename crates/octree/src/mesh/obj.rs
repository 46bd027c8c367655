//! Wavefront OBJ text to triangles: `v`, `vt`, `vn`, `f`, `usemtl` and `g`; `o` and `usemap` are read over, and all other
//! statements are counted and left out. Positions are lengths of the file's own units.

use super::ear::triangulate;
use crate::{Error, error::ObjProblem};
use ambit_base::{DVec3, Notify};
use glam::DVec2;
use nom::branch::alt;
use nom::bytes::complete::{tag, take_till1, take_while, take_while1};
use nom::combinator::opt;
use nom::multi::fold_many0;
use nom::sequence::{preceded, terminated};
use nom::{IResult, Parser};

/// A corner of a face: indices of its position and, if it has them, texture coordinates and normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Corner {
    pub(super) position: u32,
    pub(super) uv: Option<u32>,
    pub(super) normal: Option<u32>,
}

/// A triangle, counter-clockwise seen from the front.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Triangle {
    pub(super) corners: [Corner; 3],
    /// Index into [`Obj::materials`].
    pub(super) material: Option<u32>,
}

/// What a file says.
#[derive(Debug, Default)]
pub(super) struct Obj {
    pub(super) positions: Vec<DVec3>,
    pub(super) uv: Vec<DVec2>,
    pub(super) normals: Vec<DVec3>,
    pub(super) triangles: Vec<Triangle>,
    /// Names of materials or groups, each once in a row.
    pub(super) materials: Vec<Vec<u8>>,
}

/// Normals no longer than this have no direction.
const SHORTEST: f64 = 1e-30;

impl Obj {
    /// Reads a whole file; `name` is what errors call it.
    pub(super) fn read(text: &[u8], name: &str, notify: &dyn Notify) -> Result<Self, Error> {
        let mut reader =
            Reader { obj: Self::default(), notify, material: Vec::new(), group: Vec::new(), current: None };
        let (mut rest, mut line, mut strange, mut all) = (text, 0, 0, 0);
        let mut words = Vec::new();
        while !rest.is_empty() {
            words.clear();
            let (after, ()) = statement(rest, &mut words).unwrap_or((&[], ()));
            let read = &rest[..rest.len() - after.len()];
            line += read.split(|b| *b == b'\n').count() - usize::from(read.ends_with(b"\n"));
            rest = after;
            let Some(first) = words.first() else { continue };
            // Comments count as statements, too.
            all += 1;
            if first.starts_with(b"#") {
                continue;
            }
            let known = reader.statement(&words);
            strange += usize::from(!known.map_err(|problem| Error::Obj { name: name.to_owned(), line, problem })?);
        }
        if strange > 0 {
            notify.warn(&format!("{strange} of {all} statements unrecognized"));
        }
        Ok(reader.obj)
    }
}

type Parsed<'a, T> = IResult<&'a [u8], T, ()>;

/// A line with its continuation lines, as words. A backslash counts as white space, and makes the end of a line count so.
fn statement<'a>(text: &'a [u8], words: &mut Vec<&'a [u8]>) -> Parsed<'a, ()> {
    let blank = |b: u8| matches!(b, b' ' | b'\t' | b'\r' | b'\x0b' | b'\x0c');
    let gap = || fold_many0(alt((tag("\\\r\n"), tag("\\\n"), tag("\\"), take_while1(blank))), || (), |(), _| ());
    let word = take_till1(move |b| blank(b) || b == b'\n' || b == b'\\');
    let line = preceded(gap(), fold_many0(terminated(word, gap()), || (), |(), w| words.push(w)));
    terminated(line, opt(tag("\n"))).parse(text)
}

/// A corner as written: `position`, `position/uv`, `position//normal` or `position/uv/normal`; 0 stands for none.
fn reference(word: &[u8]) -> Option<[i64; 3]> {
    let mut parts = word.split(|b| *b == b'/');
    let numbers = [0; 3].map(|_: i64| parts.next().map_or(0, leading_integer));
    parts.next().is_none().then_some(numbers)
}

/// The integer that a word begins with, as C's `atoi` takes it; 0 if there is none.
fn leading_integer(word: &[u8]) -> i64 {
    let sign = |text| -> Parsed<'_, Option<&[u8]>> { opt(alt((tag("-"), tag("+")))).parse(text) };
    let digits = |text| -> Parsed<'_, &[u8]> { take_while(|b: u8| b.is_ascii_digit()).parse(text) };
    let Ok((_, (sign, digits))) = (sign, digits).parse(word) else { return 0 };
    let size = digits.iter().fold(0i64, |n, d| n.saturating_mul(10).saturating_add(i64::from(d - b'0')));
    if sign == Some(b"-") { -size } else { size }
}

/// The number of an item among `count`: from 1 on, or from −1 backwards.
fn index(reference: i64, count: usize) -> Option<u32> {
    let count = i64::try_from(count).ok()?;
    let index = if reference > 0 { reference - 1 } else { count + reference };
    (reference != 0 && (0..count).contains(&index)).then_some(index as u32)
}

struct Reader<'a> {
    obj: Obj,
    notify: &'a dyn Notify,
    material: Vec<u8>,
    group: Vec<u8>,
    /// Index of the name that applies, once a face has used it.
    current: Option<u32>,
}

impl Reader<'_> {
    /// Takes a statement; false if it means nothing here.
    fn statement(&mut self, words: &[&[u8]]) -> Result<bool, ObjProblem> {
        let real = |i: usize| words.get(i).and_then(|w| ambit_scene::parse_real(w));
        match words[0] {
            b"v" => {
                let position = || Some(DVec3::new(real(1)?, real(2)?, real(3)?));
                self.obj.positions.push(position().filter(|p| p.is_finite()).ok_or(ObjProblem::Vertex)?);
            }
            b"vt" => {
                let (Some(u), Some(v)) = (real(1), real(2)) else { return Ok(false) };
                self.obj.uv.push(DVec2::new(u, v));
            }
            b"vn" => {
                let normal = || Some(DVec3::new(real(1)?, real(2)?, real(3)?));
                let normal = normal().filter(|n| n.is_finite()).ok_or(ObjProblem::Normal)?;
                if normal.length() <= SHORTEST {
                    return Err(ObjProblem::ZeroNormal);
                }
                self.obj.normals.push(normal.normalize());
            }
            b"f" => self.face(&words[1..])?,
            b"usemtl" | b"g" => {
                let name = words.get(1).copied().unwrap_or_default().to_vec();
                *(if words[0] == b"g" { &mut self.group } else { &mut self.material }) = name;
                self.current = None;
            }
            b"o" | b"usemap" => {}
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn face(&mut self, words: &[&[u8]]) -> Result<(), ObjProblem> {
        if words.len() < 3 {
            return Err(ObjProblem::TooFewVertices);
        }
        let bad = if words.len() == 3 { ObjProblem::Triangle } else { ObjProblem::Face };
        let corners: Option<Vec<Corner>> = words.iter().map(|w| self.corner(w)).collect();
        let Some(corners) = corners else {
            self.notify.warn("bad vertex reference");
            return Err(bad);
        };
        let material = self.name();
        if let [a, b, c] = corners[..] {
            self.obj.triangles.push(Triangle { corners: [a, b, c], material });
            return Ok(());
        }
        let positions: Vec<DVec3> = corners.iter().map(|c| self.obj.positions[c.position as usize]).collect();
        let whole = triangulate(&positions, |ear| {
            self.obj.triangles.push(Triangle { corners: ear.map(|i| corners[i]), material });
        });
        if !whole {
            self.notify.warn(&format!("self-intersecting face with {} vertices", corners.len()));
        }
        Ok(())
    }

    fn corner(&self, word: &[u8]) -> Option<Corner> {
        let [position, uv, normal] = reference(word)?;
        let optional = |r: i64, count| if r == 0 { Some(None) } else { index(r, count).map(Some) };
        Some(Corner {
            position: index(position, self.obj.positions.len())?,
            uv: optional(uv, self.obj.uv.len())?,
            normal: optional(normal, self.obj.normals.len())?,
        })
    }

    /// The material's name, or the group's where there is none.
    fn name(&mut self) -> Option<u32> {
        let name = if self.material.is_empty() { &self.group } else { &self.material };
        if name.is_empty() {
            return None;
        }
        if self.current.is_none() {
            self.obj.materials.push(name.clone());
            self.current = Some(self.obj.materials.len() as u32 - 1);
        }
        self.current
    }
}
