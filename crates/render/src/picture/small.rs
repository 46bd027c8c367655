//! Light sources too small for the pixels: the sun, or a lamp far away. Between the samples of a picture they would be
//! missed, or caught once and shown many times too bright. They are drawn by the share of each pixel that they cover.

use super::order::hilbert_index;
use super::sampler::{Band, Pixel};
use crate::request::{Aim, Request};
use ambit_base::{DVec3, EPSILON, FAR, Rgb};
use ambit_file::{Projection, ViewType};

/// Distant sources of at least this radius (of the disk that stands for them, at unit distance) are seen anyway.
const LARGE: f64 = 0.05;

/// A pixel this close to a source's colour, relative to either, shows the source already.
const ALIKE: f32 = 0.07;

/// A source nearer than this share of a pixel's distance is in front of what the pixel shows.
const NEARER: f32 = 0.99;

/// Shares of a pixel below this are not worth a ray.
const LEAST_SHARE: f64 = EPSILON;

/// Answers rays that are aimed at sources, in order.
pub type Aimed<'a, E> = dyn FnMut(&[Request]) -> Result<Vec<Pixel>, E> + 'a;

/// What a light source covers, roughly: the corners of a parallelogram or of a box.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceOutline {
    /// Number of the source, for [`Aim::Source`].
    pub source: u32,
    /// Corners; directions if the source is at infinity.
    pub corners: Vec<DVec3>,
    /// The source is at infinity.
    pub distant: bool,
    /// Half its extent; at unit distance if it is at infinity.
    pub radius: f64,
    /// Centre and normal of an emitter that shines to one side only.
    pub facing: Option<(DVec3, DVec3)>,
}

/// The small sources of a picture.
#[derive(Clone, Debug)]
pub struct SmallSources {
    projection: Projection,
    width: u32,
    height: u32,
    distances: bool,
    /// Number and image polygon in pixels.
    sources: Vec<(u32, Vec<[f64; 2]>)>,
}

/// A share of a pixel that a source covers.
#[derive(Clone, Copy, Debug)]
struct Cover {
    row: usize,
    column: usize,
    share: f32,
}

impl SmallSources {
    /// Those of a picture whose samples are `spacing` pixels apart; `distances` says that distances are kept, too.
    pub fn new(
        outlines: &[SourceOutline],
        projection: Projection,
        (width, height): (u32, u32),
        spacing: u32,
        distances: bool,
    ) -> Self {
        // Both directions count in widths of pixels, also where pixels are not square.
        let tall = projection.aspect() * f64::from(width) / f64::from(height.max(1));
        let mut small = Self { projection, width, height, distances, sources: Vec::new() };
        for outline in outlines {
            if let Some(polygon) = small.polygon(outline)
                && least_width(&polygon.iter().map(|p| [p[0], p[1] * tall]).collect::<Vec<_>>()) <= f64::from(spacing)
            {
                small.sources.push((outline.source, polygon));
            }
        }
        small
    }

    /// The image of an outline in pixels, counter-clockwise; `None` if it is not to be drawn.
    fn polygon(&self, outline: &SourceOutline) -> Option<Vec<[f64; 2]>> {
        let view = &self.projection.view;
        let parallel = view.kind == ViewType::Parallel;
        if outline.distant && (parallel || outline.radius >= LARGE) {
            return None;
        }
        if let Some((centre, normal)) = outline.facing {
            let towards = if parallel { self.projection.direction } else { centre - view.point };
            if towards.dot(normal) >= 0.0 {
                return None;
            }
        }
        let mut points = Vec::new();
        for &corner in &outline.corners {
            let [x, y] = self.projection.locate(if outline.distant { view.point + corner } else { corner })?;
            if !(0.0..=1.0).contains(&x) || !(0.0..=1.0).contains(&y) {
                return None;
            }
            points.push([x * f64::from(self.width), y * f64::from(self.height)]);
        }
        let hull = convex_hull(points);
        (hull.len() >= 3).then_some(hull)
    }

    /// Draws the sources into finished rows. `trace` answers rays that are aimed at sources; its colours are in the
    /// picture's space.
    ///
    /// # Errors
    /// Those of `trace`.
    pub fn draw<E>(&self, band: &mut Band, trace: &mut Aimed<'_, E>) -> Result<(), E> {
        let (mut covers, mut requests) = (Vec::new(), Vec::new());
        for (source, polygon) in &self.sources {
            self.cover(*source, polygon, band, &mut covers, &mut requests);
        }
        if requests.is_empty() {
            return Ok(());
        }
        for (cover, light) in covers.iter().zip(trace(&requests)?) {
            if light.colour.max_element() > EPSILON as f32 {
                self.blend(&mut band.rows[cover.row][cover.column], &light, cover.share);
            }
        }
        Ok(())
    }

    /// Notes all pixels of a band that a source covers, and the rays through what is covered of them.
    fn cover(
        &self,
        source: u32,
        polygon: &[[f64; 2]],
        band: &Band,
        covers: &mut Vec<Cover>,
        requests: &mut Vec<Request>,
    ) {
        let range = |axis: usize, size: u32| {
            let (low, high) =
                polygon.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p[axis]), h.max(p[axis])));
            // A picture is less than 2³² pixels wide; what lies outside is cut off here.
            (low.floor().max(0.0) as u32)..(high.ceil().clamp(0.0, f64::from(size)) as u32)
        };
        let columns = range(0, self.width);
        for y in range(1, self.height) {
            let Some(row) = band.top.checked_sub(y).filter(|&row| (row as usize) < band.rows.len()) else { continue };
            for x in columns.clone() {
                let Some((share, centre)) = overlap(polygon, x, y) else { continue };
                let at = [centre[0] / f64::from(self.width), centre[1] / f64::from(self.height)];
                let Some(ray) = self.projection.ray(at[0], at[1]) else { continue };
                covers.push(Cover { row: row as usize, column: x as usize, share: share as f32 });
                requests.push(Request {
                    origin: ray.origin,
                    direction: ray.direction,
                    limit: if ray.length < FAR { ray.length } else { FAR },
                    index: hilbert_index(x, y, self.width, self.height),
                    aim: Aim::Source(source),
                });
            }
        }
    }

    fn blend(&self, pixel: &mut Pixel, light: &Pixel, share: f32) {
        if self.distances && light.distance < NEARER * pixel.distance {
            pixel.distance = light.distance;
        } else if alike(pixel.colour, light.colour) {
            // Caught by a sample: what is seen beside it is not known and counts as dark.
            pixel.colour *= share;
            return;
        }
        pixel.colour = pixel.colour * (1.0 - share) + light.colour * share;
    }
}

fn alike(a: Rgb, b: Rgb) -> bool {
    (a - b).cmple(b * ALIKE).all() && (b - a).cmple(a * ALIKE).all()
}

/// Andrew's monotone chain, counter-clockwise, without points on edges.
fn convex_hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    let mut hull: Vec<[f64; 2]> = Vec::new();
    let mut chain = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let start = hull.len();
        for p in points {
            while hull.len() >= start + 2 && turn(hull[hull.len() - 2], hull[hull.len() - 1], p) <= 0.0 {
                hull.pop();
            }
            hull.push(p);
        }
        hull.pop();
    };
    chain(&mut points.iter().copied());
    chain(&mut points.iter().rev().copied());
    hull
}

/// Twice the area of a triangle, positive if it turns counter-clockwise.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The least width of a convex polygon: over all edges, the distance of the farthest corner.
fn least_width(polygon: &[[f64; 2]]) -> f64 {
    edges(polygon)
        .map(|(a, b)| {
            let length = (b[0] - a[0]).hypot(b[1] - a[1]);
            polygon.iter().map(|&p| turn(a, b, p)).fold(0.0, f64::max) / length
        })
        .fold(f64::INFINITY, f64::min)
}

fn edges(polygon: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
    (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]))
}

/// Area and centre of what a polygon covers of a pixel (Sutherland & Hodgman 1974, *Reentrant polygon clipping*).
fn overlap(polygon: &[[f64; 2]], x: u32, y: u32) -> Option<(f64, [f64; 2])> {
    let mut clipped = polygon.to_vec();
    for (axis, low) in [(0, f64::from(x)), (1, f64::from(y))] {
        for (side, border) in [(1.0, low), (-1.0, low + 1.0)] {
            let inside = |p: [f64; 2]| (p[axis] - border) * side;
            let mut next = Vec::with_capacity(clipped.len() + 1);
            for (a, b) in edges(&clipped) {
                let (da, db) = (inside(a), inside(b));
                if da >= 0.0 {
                    next.push(a);
                }
                if (da >= 0.0) != (db >= 0.0) {
                    let t = da / (da - db);
                    next.push([a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t]);
                }
            }
            clipped = next;
        }
    }
    let (mut area, mut moment) = (0.0, [0.0; 2]);
    let origin = *clipped.first()?;
    for (a, b) in edges(&clipped) {
        let part = turn(origin, a, b);
        area += part;
        for axis in 0..2 {
            moment[axis] += part * (origin[axis] + a[axis] + b[axis]) / 3.0;
        }
    }
    let share = 0.5 * area;
    (share > LEAST_SHARE).then(|| (share.min(1.0), [moment[0] / area, moment[1] / area]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ambit_file::View;
    use std::convert::Infallible;

    fn square(x: f64, y: f64, size: f64) -> Vec<[f64; 2]> {
        vec![[x, y], [x + size, y], [x + size, y + size], [x, y + size]]
    }

    #[test]
    fn overlaps_are_exact() {
        let (share, centre) = overlap(&square(2.5, 3.0, 1.0), 2, 3).unwrap();
        assert!((share - 0.5).abs() < 1e-12 && (centre[0] - 2.75).abs() < 1e-12 && (centre[1] - 3.5).abs() < 1e-12);
        assert_eq!(overlap(&square(0.0, 0.0, 9.0), 4, 4).unwrap().0, 1.0);
        assert!(overlap(&square(0.0, 0.0, 1.0), 1, 0).is_none());
        let all: f64 =
            (0..9).filter_map(|i| overlap(&[[0.2, 0.1], [2.9, 0.7], [1.1, 2.8]], i % 3, i / 3)).map(|o| o.0).sum();
        assert!((all - 0.5 * turn([0.2, 0.1], [2.9, 0.7], [1.1, 2.8])).abs() < 1e-12);
    }

    #[test]
    fn hulls_and_widths() {
        let mut points = square(0.0, 0.0, 2.0);
        points.extend([[1.0, 1.0], [1.0, 0.0]]);
        assert_eq!(convex_hull(points).len(), 4);
        assert_eq!(least_width(&square(1.0, 1.0, 3.0)), 3.0);
        assert!(convex_hull(vec![[1.0, 1.0]; 4]).len() < 3);
    }

    fn sun(direction: DVec3) -> SourceOutline {
        let half = 0.003;
        let corners = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)]
            .map(|(u, v)| direction + DVec3::X * (u * half) + DVec3::Z * (v * half));
        SourceOutline { source: 7, corners: corners.to_vec(), distant: true, radius: 0.004, facing: None }
    }

    /// What the picture of a sun adds up to, in pixels times radiance.
    fn drawn(outline: &SourceOutline, background: f32) -> (f64, usize) {
        drawn_into(outline, background, (50, 50))
    }

    fn drawn_into(outline: &SourceOutline, background: f32, size: (u32, u32)) -> (f64, usize) {
        let projection = View { horizontal: 60.0, vertical: 60.0, ..View::default() }.set_up().unwrap();
        let small = SmallSources::new(std::slice::from_ref(outline), projection, size, 4, false);
        let pixel = Pixel { colour: Rgb::splat(background), distance: FAR as f32 };
        let mut band = Band { top: size.1 - 1, rows: vec![vec![pixel; size.0 as usize]; size.1 as usize] };
        let mut rays = 0;
        let done: Result<(), Infallible> = small.draw(&mut band, &mut |requests| {
            rays += requests.len();
            assert!(requests.iter().all(|r| r.aim == Aim::Source(7)));
            Ok(vec![Pixel { colour: Rgb::splat(1000.0), distance: FAR as f32 }; requests.len()])
        });
        done.unwrap();
        (band.rows.iter().flatten().map(|p| f64::from(p.colour.x)).sum(), rays)
    }

    #[test]
    fn a_small_sun_keeps_its_energy_wherever_it_stands() {
        // (0.006 / (2 tan 30°) · 50)² pixels.
        let area = (0.006f64 / (2.0 * 30f64.to_radians().tan()) * 50.0).powi(2);
        for at in [[0.0, 0.0], [0.01, 0.02], [0.013, -0.3]] {
            let (sum, rays) = drawn(&sun(DVec3::new(at[0], 1.0, at[1])), 0.0);
            assert!((sum - 1000.0 * area).abs() < 1e-3 * 1000.0 * area, "{sum} {area}");
            assert!((1..=4).contains(&rays));
        }
        let (sum, _) = drawn(&sun(DVec3::new(0.013, 1.0, 0.0)), 2.0);
        assert!((sum - 2.0 * (2500.0 - area) - 1000.0 * area).abs() < 1.0);
    }

    #[test]
    fn smallness_is_measured_in_widths_of_pixels() {
        // 5 columns wide of 1000, and as high as 5 of them.
        let outline = sun(DVec3::Y);
        assert_eq!(drawn_into(&outline, 0.0, (1000, 50)).1, 0);
        // The other way round it is a quarter of a column wide, and across two of them.
        let width = 0.006 / (2.0 * 30f64.to_radians().tan());
        let area = width * 50.0 * width * 1000.0;
        let (sum, rays) = drawn_into(&outline, 0.0, (50, 1000));
        assert!((sum - 1000.0 * area).abs() < 1e-3 * 1000.0 * area, "{sum} {area}");
        assert_eq!(rays, 12);
    }

    #[test]
    fn a_sample_that_caught_the_source_is_scaled_down() {
        let area = (0.006f64 / (2.0 * 30f64.to_radians().tan()) * 50.0).powi(2);
        let (sum, _) = drawn(&sun(DVec3::new(0.01, 1.0, 0.01)), 1000.0);
        assert!((sum - 1000.0 * (2499.0 + area)).abs() < 1.0, "{sum}");
    }

    #[test]
    fn what_is_large_behind_outside_or_turned_away_is_not_drawn() {
        assert_eq!(drawn(&sun(DVec3::new(30f64.to_radians().tan(), 1.0, 0.0)), 0.0).1, 0);
        assert_eq!(drawn(&sun(DVec3::NEG_Y), 0.0).1, 0);
        assert_eq!(drawn(&SourceOutline { radius: 0.05, ..sun(DVec3::Y) }, 0.0).1, 0);
        let away = Some((DVec3::Y * 5.0, DVec3::Y));
        assert_eq!(drawn(&SourceOutline { facing: away, ..sun(DVec3::Y) }, 0.0).1, 0);
    }
}
