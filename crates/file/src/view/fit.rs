//! Picture sizes that suit a view, and views of a part of a picture.

use super::{View, ViewType};
use ambit_base::EPSILON;

/// A resolution and the shape of its pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Pixels in x.
    pub width: u32,
    /// Pixels in y.
    pub height: u32,
    /// Height over width of a pixel.
    pub pixel_aspect: f64,
}

/// Reduces a maximum resolution to the view's aspect (height over width) for pixels of the given aspect. A pixel
/// aspect of 0 or less keeps the resolution and is replaced by the one that results.
pub fn fit_resolution(view_aspect: f64, pixel_aspect: f64, width: u32, height: u32) -> Fit {
    let (x, y) = (f64::from(width), f64::from(height));
    if pixel_aspect <= EPSILON {
        let shape = if width == 0 || height == 0 { 1.0 } else { view_aspect * x / y };
        Fit { width, height, pixel_aspect: shape }
    } else if view_aspect * x > pixel_aspect * y {
        Fit { width: (y / view_aspect * pixel_aspect + 0.5) as u32, height, pixel_aspect }
    } else {
        Fit { width, height: (x * view_aspect / pixel_aspect + 0.5) as u32, pixel_aspect }
    }
}

impl View {
    /// The view of the part of the image between two corners given as locations.
    pub fn part(&self, [x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) -> Self {
        let (wide, high) = (x1 - x0, y1 - y0);
        let tangent = |size: f64, part: f64| 2.0 * (part * (size / 2.0).to_radians().tan()).atan().to_degrees();
        let sine = |size: f64, part: f64| 2.0 * (part * (size / 2.0).to_radians().sin()).asin().to_degrees();
        let quarter = |size: f64, part: f64| 4.0 * (part * (size / 4.0).to_radians().tan()).atan().to_degrees();
        let plain = |size: f64, part: f64| size * part;
        let (h, v) = (self.horizontal, self.vertical);
        let (horizontal, vertical) = match self.kind {
            ViewType::Perspective => (tangent(h, wide), tangent(v, high)),
            ViewType::Cylinder => (plain(h, wide), tangent(v, high)),
            ViewType::Hemisphere => (sine(h, wide), sine(v, high)),
            ViewType::Planisphere => (quarter(h, wide), quarter(v, high)),
            ViewType::Parallel | ViewType::Angular | ViewType::Unknown(_) => (plain(h, wide), plain(v, high)),
        };
        Self {
            horizontal,
            vertical,
            shift: (f64::midpoint(x0, x1) - 0.5 + self.shift) / wide,
            lift: (f64::midpoint(y0, y1) - 0.5 + self.lift) / high,
            ..*self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resolutions_fit_as_rpict_fits_them() {
        let view = View { horizontal: 90.0, vertical: 75.0, ..View::default() };
        let aspect = view.set_up().unwrap().aspect();
        for (p, max, expected) in
            [(1.0, (40, 30), (39, 30)), (1.0, (64, 64), (64, 49)), (2.0, (64, 64), (64, 25)), (1.0, (0, 9), (0, 0))]
        {
            let fit = fit_resolution(aspect, p, max.0, max.1);
            assert_eq!((fit.width, fit.height), expected);
            assert_eq!(fit.pixel_aspect, p);
        }
        let free = fit_resolution(aspect, 0.0, 64, 64);
        assert_eq!((free.width, free.height), (64, 64));
        assert!((free.pixel_aspect - 0.767327).abs() < 1e-6);
        assert!(fit_resolution(aspect, 0.0, 64, 0).pixel_aspect.is_finite());
    }

    #[test]
    fn a_part_shows_the_same_rays() {
        for letter in "vlchas".chars() {
            let whole = View {
                kind: ViewType::from_letter(letter),
                horizontal: 100.0,
                vertical: 80.0,
                shift: 0.1,
                lift: -0.05,
                ..View::default()
            };
            let part = whole.part([0.25, 0.5], [0.5, 1.0]).set_up().unwrap();
            let whole = whole.set_up().unwrap();
            for (x, y) in [(0.0, 0.0), (0.3, 0.9), (1.0, 0.5)] {
                let (a, b) = (part.ray(x, y).unwrap(), whole.ray(0.25 + x * 0.25, 0.5 + y * 0.5).unwrap());
                assert!(a.direction.distance(b.direction) + a.origin.distance(b.origin) < 1e-12, "{letter} {x} {y}");
            }
        }
    }
}
