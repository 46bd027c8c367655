//! `fprism_val`: where light goes that meets a panel of prisms. Answers function-files.md 7.2.
//!
//! The panel is a sheet whose one side is flat (normal −x) and whose other bears prisms along z, all alike: each rises
//! over a length B along y to a height H and falls over a length A. Faces are numbered 1 (falling) and 2 (rising).
//! Light is followed in beams as wide as what they meet: the cross-section of a prism is a triangle of glass, the valley
//! between two prisms a triangle of air, and a beam that leaves one edge of a triangle meets the two others in two parts.
//! At each surface a beam parts into what is reflected and refracted, by Fresnel's formula for unpolarised light. At the
//! flat side position is forgotten: what returns from there fills the prisms evenly, so that the thickness of the sheet
//! does not matter.
//!
//! All this is what Radiance 6.0a's answers show. Two things were not found out. Light that a face has reflected and
//! that comes to the flat side aslant to the prisms is reflected there more than Fresnel's formula says: up to 14 % less
//! gets out, which is .5 % of all light. And in prisms as steep as 35° and more, light that is reflected to and fro
//! within takes other shares (up to 9 % of all light); what crosses the panel straight, and the directions, agree.

use crate::channel::Channel::{Dx, DxA, Dy, DyA, Dz, DzA};
use crate::channel::{CHANNELS, Channel, ChannelSet};
use crate::error::Fault;

/// Real arguments that are read.
const ARGUMENTS: usize = 10;
/// Directions that one ray can go on in; further ones are lost. Each has at least [`FAINTEST`] of the light.
const EXITS: usize = 64;
/// The faintest beam that is followed. (With a cut-off fraction of 0 Radiance crashes.)
const FAINTEST: f64 = 1e-6;
/// Surfaces that a beam meets one after the other; beyond, less than the cut-off is left unless faces are perfect mirrors.
const SURFACES: u32 = 64;
/// A beam that leaves an edge at a smaller cosine than this runs along it, and its light counts for nothing.
const GRAZING: f64 = 1e-12;

/// What is read of the ray.
pub(crate) const INPUTS: [Channel; 6] = [Dx, Dy, Dz, DxA, DyA, DzA];

/// A direction that light leaves in, and how much of it.
#[derive(Clone, Copy, Debug, Default)]
struct Exit {
    direction: [f64; 3],
    light: f64,
}

impl Exit {
    /// The angle in the plane of the cross-section.
    fn angle(&self) -> f64 {
        self.direction[1].atan2(self.direction[0])
    }
}

/// The last panel and direction, and where its light goes: functions of prism1 and prism2 ask for each number alone.
#[derive(Clone, Debug)]
pub(crate) struct Answer {
    /// Arguments and direction.
    question: [f64; ARGUMENTS + 3],
    /// By falling light.
    exits: [Exit; EXITS],
    count: usize,
}

/// `fprism_val(what, side, rank)`. NaN if an argument is out of its domain.
pub(crate) fn value(
    kept: &mut Option<Box<Answer>>,
    ray: &[f64; CHANNELS],
    reals: &[f64],
    [what, side, rank]: [f64; 3],
) -> Result<f64, Fault> {
    let Some(a) = reals.first_chunk::<ARGUMENTS>() else { return Err(Fault::MissingReal(reals.len() as u64 + 1)) };
    let [what, side, rank] = [what, side, rank].map(|x| (x + 0.5) as i64);
    let Some(panel) = Panel::new(a) else { return Ok(f64::NAN) };
    if !(0..=3).contains(&what) {
        return Ok(f64::NAN);
    }
    let [dx, dy, dz, ax, ay, az] = INPUTS.map(|channel| ray[channel as usize]);
    let mut question = [0.0; ARGUMENTS + 3];
    question[..ARGUMENTS].copy_from_slice(a);
    question[ARGUMENTS..].copy_from_slice(&[dx, dy, dz]);
    let answer = match kept {
        Some(answer) if answer.question == question => answer,
        _ => kept.insert(Box::new(panel.answer(question, [dx, dy, dz]))),
    };
    let exits = &answer.exits[..answer.count];
    let on_side = |exit: &&Exit| side == 0 || (exit.direction[0] * dx > 0.0) == (side > 0);
    let found = if [ax, ay, az] == [0.0; 3] {
        usize::try_from(rank - 1).ok().and_then(|rank| exits.iter().filter(on_side).nth(rank))
    } else {
        let sought = ay.atan2(ax);
        exits.iter().filter(on_side).find(|exit| (exit.angle() - sought).abs() <= a[9])
    };
    // Where nothing goes, prisms need a direction for their coefficient of zero.
    let found = found.copied().unwrap_or(Exit { direction: [1.0, 0.0, 0.0], light: 0.0 });
    Ok(if what == 3 { found.light } else { found.direction[what as usize] })
}

/// The channels of [`INPUTS`].
pub(crate) fn inputs() -> ChannelSet {
    ChannelSet::of(&INPUTS)
}

/// x, the height above the valleys, and y.
type Point = [f64; 2];

/// Edges of either triangle. Faces have their numbers less one.
const MOUTH: usize = 2;

/// An edge of a triangle, with the normal that points out of it.
#[derive(Clone, Copy, Debug)]
struct Edge {
    from: Point,
    to: Point,
    normal: Point,
    /// The edges that share its ends, and the corner between those.
    next: [usize; 2],
    opposite: Point,
}

impl Edge {
    fn at(&self, s: f64) -> Point {
        [0, 1].map(|k| self.from[k] + s * (self.to[k] - self.from[k]))
    }
}

#[derive(Debug)]
struct Panel {
    glass: [Edge; 3],
    air: [Edge; 3],
    index: f64,
    faintest: f64,
    merge: f64,
    /// The face that is coated, and what it reflects.
    coating: Option<(usize, f64)>,
}

/// Light of one direction that leaves a part of an edge, into a triangle.
#[derive(Clone, Copy, Debug)]
struct Beam {
    direction: [f64; 3],
    light: f64,
    in_glass: bool,
    edge: usize,
    part: [f64; 2],
    /// Surfaces met so far.
    surfaces: u32,
}

/// What leaves a panel: exits and their number.
type Exits = ([Exit; EXITS], usize);

fn dot(normal: Point, d: [f64; 3]) -> f64 {
    normal[0] * d[0] + normal[1] * d[1]
}

/// The coordinate across a beam: points of one value lie behind each other.
fn across(d: [f64; 3], point: Point) -> f64 {
    point[1] * d[0] - point[0] * d[1]
}

/// The share of light that is reflected, and both directions, for light that leaves a medium through a surface. `normal`
/// points out of that, `index` is its refractive index relative to the other's.
fn surface(d: [f64; 3], normal: Point, index: f64) -> (f64, [f64; 3], Option<[f64; 3]>) {
    let cos = dot(normal, d);
    let n = [normal[0], normal[1], 0.0];
    let reflected = [0, 1, 2].map(|k| d[k] - 2.0 * cos * n[k]);
    let cos2 = 1.0 - index * index * (1.0 - cos * cos);
    if cos2 <= 0.0 {
        return (1.0, reflected, None);
    }
    let beyond = cos2.sqrt();
    let refracted = [0, 1, 2].map(|k| index * (d[k] - cos * n[k]) + beyond * n[k]);
    let s = (index * cos - beyond) / (index * cos + beyond);
    let p = (cos - index * beyond) / (cos + index * beyond);
    (f64::midpoint(s * s, p * p), reflected, Some(refracted))
}

impl Panel {
    fn new(arguments: &[f64; ARGUMENTS]) -> Option<Self> {
        let [a, b, thickness, h, index, cut, face, coat, merge, source] = *arguments;
        let face = (face + 0.5) as i64;
        let lengths = [a, b, thickness, h].iter().all(|length| *length >= 0.0);
        let shares = (0.0..1.0).contains(&cut) && (0.0..=1.0).contains(&coat);
        if !(lengths && shares && index >= 1.0 && [1, 2, 4].contains(&face) && merge > 0.0 && source >= 0.0) {
            return None;
        }
        let unit = |[x, y]: Point| {
            let length = x.hypot(y);
            if length > 0.0 { [x / length, y / length] } else { [0.0; 2] }
        };
        let (falling, rising) = (unit([a, h]), unit([b, -h]));
        let (top, fall, rise) = ([h, 0.0], [0.0, a], [0.0, -b]);
        let glass = [
            Edge { from: top, to: fall, normal: falling, next: [1, MOUTH], opposite: rise },
            Edge { from: top, to: rise, normal: rising, next: [0, MOUTH], opposite: fall },
            Edge { from: rise, to: fall, normal: [-1.0, 0.0], next: [1, 0], opposite: top },
        ];
        let (valley, before, after) = ([0.0; 2], [h, -a], [h, b]);
        let air = [
            Edge { from: before, to: valley, normal: falling.map(|n| -n), next: [MOUTH, 1], opposite: after },
            Edge { from: after, to: valley, normal: rising.map(|n| -n), next: [MOUTH, 0], opposite: before },
            Edge { from: before, to: after, normal: [1.0, 0.0], next: [0, 1], opposite: valley },
        ];
        let coating = (face < 3).then_some((face as usize - 1, coat));
        Some(Self { glass, air, index, faintest: cut.max(FAINTEST), merge, coating })
    }

    /// Where the light of a ray goes.
    fn answer(&self, question: [f64; ARGUMENTS + 3], direction: [f64; 3]) -> Answer {
        let mut exits: Exits = ([Exit::default(); EXITS], 0);
        let even = Beam { direction, light: 1.0, in_glass: false, edge: MOUTH, part: [0.0, 1.0], surfaces: 0 };
        if direction[0] > 0.0 {
            let (share, reflected, refracted) = surface(direction, [1.0, 0.0], 1.0 / self.index);
            self.leave(&mut exits, reflected, share);
            if let Some(direction) = refracted {
                self.follow(&mut exits, Beam { direction, light: 1.0 - share, in_glass: true, ..even });
            }
        } else {
            self.follow(&mut exits, even);
        }
        let (mut exits, count) = exits;
        exits[..count].sort_by(|a, b| b.light.total_cmp(&a.light));
        Answer { question, exits, count }
    }

    /// Adds what leaves to the first direction that it is near to.
    fn leave(&self, (exits, count): &mut Exits, direction: [f64; 3], light: f64) {
        if light < self.faintest {
            return;
        }
        let exit = Exit { direction, light };
        let angle = exit.angle();
        if let Some(near) = exits[..*count].iter_mut().find(|other| (other.angle() - angle).abs() <= self.merge) {
            near.light += light;
        } else if *count < EXITS {
            exits[*count] = exit;
            *count += 1;
        }
    }

    /// Follows a beam to the other edges of its triangle.
    fn follow(&self, exits: &mut Exits, beam: Beam) {
        if beam.light < self.faintest || beam.surfaces > SURFACES {
            return;
        }
        let d = beam.direction;
        let edges = if beam.in_glass { &self.glass } else { &self.air };
        let start = &edges[beam.edge];
        let ends = [across(d, start.from), across(d, start.to)];
        let width = ends[1] - ends[0];
        if width.abs() <= GRAZING {
            return;
        }
        let [at_from, at_to] = start.next;
        let [to_from, to_to] = start.next.map(|edge| dot(edges[edge].normal, d) > GRAZING);
        let corner = match (to_from, to_to) {
            (true, true) => (across(d, start.opposite) - ends[0]) / width,
            (true, false) => f64::INFINITY,
            (false, true) => f64::NEG_INFINITY,
            (false, false) => return,
        };
        let [begin, end] = beam.part;
        let parts = [(at_from, [begin, end.min(corner)]), (at_to, [begin.max(corner), end])];
        let parts = if at_from < at_to { parts } else { [parts[1], parts[0]] };
        for (edge, part) in parts {
            let share = (part[1] - part[0]) / (end - begin);
            if share > GRAZING {
                // Through the mouth one face may stand in the other's shadow. The other is lit evenly then, all of it.
                let whole = beam.edge == MOUTH && !corner.is_finite();
                let ends = if whole { [edges[edge].from, edges[edge].to] } else { part.map(|s| start.at(s)) };
                let [from, to] = ends.map(|point| across(d, point));
                self.meet(exits, Beam { light: beam.light * share, edge, part: [from, to], ..beam });
            }
        }
    }

    /// What becomes of a beam at an edge. Its part is given as coordinates across it.
    fn meet(&self, exits: &mut Exits, beam: Beam) {
        if beam.light < self.faintest {
            return;
        }
        let Beam { direction: d, light, in_glass, edge, .. } = beam;
        let surfaces = beam.surfaces + 1;
        if edge == MOUTH {
            if !in_glass {
                return self.leave(exits, d, light);
            }
            let (share, direction, refracted) = surface(d, [-1.0, 0.0], self.index);
            self.follow(exits, Beam { direction, light: light * share, part: [0.0, 1.0], surfaces, ..beam });
            if let Some(direction) = refracted {
                self.leave(exits, direction, light * (1.0 - share));
            }
            return;
        }
        let (edges, index) = if in_glass { (&self.glass, self.index) } else { (&self.air, 1.0 / self.index) };
        let face = &edges[edge];
        let (from, to) = (across(d, face.from), across(d, face.to));
        let part = beam.part.map(|u| ((u - from) / (to - from)).clamp(0.0, 1.0));
        let part = if part[0] <= part[1] { part } else { [part[1], part[0]] };
        if part[1] - part[0] <= GRAZING {
            return;
        }
        let (share, direction, refracted) = surface(d, face.normal, index);
        let (share, refracted) = match self.coating {
            Some((coated, share)) if coated == edge => (share, None),
            _ => (share, refracted),
        };
        self.follow(exits, Beam { direction, light: light * share, part, surfaces, ..beam });
        if let Some(direction) = refracted {
            let light = light * (1.0 - share);
            self.follow(exits, Beam { direction, light, part, in_glass: !in_glass, surfaces, ..beam });
        }
    }
}
