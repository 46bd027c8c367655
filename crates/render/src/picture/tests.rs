//! Whole pictures against those of Radiance, which are recorded beside this file.

use super::sampler::{Band, Order, Pixel, PixelRequest, Sampler};
use ambit_base::{FAR, Rgb};
use ambit_file::{PictureReader, encode_pixel};
use std::collections::HashSet;
use std::convert::Infallible;

/// A recorded picture: size, and pixel codes from the top down.
fn codes(bytes: &[u8]) -> (u32, u32, Vec<[u8; 4]>) {
    let mut reader = PictureReader::new(bytes, "recorded").unwrap();
    let (width, height) = (reader.resolution.width, reader.resolution.height);
    let mut all = Vec::new();
    while let Some(line) = reader.next_codes().unwrap() {
        all.extend_from_slice(line);
    }
    (width, height, all)
}

/// The value that was encoded, for values of at most eight significant bits.
fn exact(code: [u8; 4]) -> Rgb {
    let [r, g, b, e] = code;
    Rgb::new(f32::from(r), f32::from(g), f32::from(b)) * 2f32.powi(i32::from(e) - 136)
}

fn distances(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect()
}

/// All rows of a picture from the top down, and the batches that were traced.
fn sampled(sampler: &Sampler, truth: &dyn Fn(u32, u32) -> Pixel) -> (Vec<Pixel>, Vec<Vec<PixelRequest>>) {
    let (mut rows, mut batches) = (Vec::new(), Vec::new());
    let mut next = sampler.rows;
    let done: Result<(), Infallible> = sampler.run(
        &mut |requests| {
            batches.push(requests.to_vec());
            Ok(requests.iter().map(|r| truth(r.x, r.y)).collect())
        },
        &mut |Band { top, rows: band }| {
            assert_eq!(top + 1, next);
            next -= band.len() as u32;
            rows.extend(band.into_iter().flatten());
            Ok(())
        },
    );
    done.unwrap();
    assert_eq!(next, 0);
    (rows, batches)
}

macro_rules! recorded {
    ($name:literal) => {
        include_bytes!(concat!("recorded/", $name))
    };
}

#[test]
fn a_pattern_is_sampled_as_rpict_does() {
    let (width, height, all) = codes(recorded!("pattern-1-0.hdr"));
    let truth =
        |x: u32, y: u32| Pixel { colour: exact(all[((height - 1 - y) * width + x) as usize]), distance: FAR as f32 };
    for (spacing, threshold, bytes) in [
        (1, 0.0, &recorded!("pattern-1-0.hdr")[..]),
        (2, 0.05, recorded!("pattern-2-05.hdr")),
        (3, 0.05, recorded!("pattern-3-05.hdr")),
        (4, 0.05, recorded!("pattern-4-05.hdr")),
        (4, 0.2, recorded!("pattern-4-2.hdr")),
        (8, 0.02, recorded!("pattern-8-02.hdr")),
        (8, 1e6, recorded!("pattern-8-1000000.hdr")),
        (16, 0.1, recorded!("pattern-16-1.hdr")),
    ] {
        let wanted = codes(bytes).2;
        for order in [Order::TopDown, Order::CoarseToFine] {
            let sampler = Sampler { width, rows: height, height, spacing, threshold, distances: false, order };
            let made = sampled(&sampler, &truth).0;
            let wrong = made.iter().zip(&wanted).filter(|(p, w)| encode_pixel(p.colour) != **w).count();
            assert_eq!(wrong, 0, "{spacing} {threshold} {order:?}: {wrong} of {}", wanted.len());
        }
    }
}

#[test]
fn distances_count_if_they_are_wanted() {
    let (width, height, all) = codes(recorded!("balls-1-0.hdr"));
    let depths = distances(recorded!("balls-1-0.zbf"));
    let truth = |x: u32, y: u32| {
        let at = ((height - 1 - y) * width + x) as usize;
        Pixel { colour: exact(all[at]), distance: depths[at] }
    };
    for (spacing, threshold, picture, depths) in [
        (4, 0.05, &recorded!("balls-4-05.hdr")[..], &recorded!("balls-4-05.zbf")[..]),
        (8, 0.2, recorded!("balls-8-2.hdr"), recorded!("balls-8-2.zbf")),
    ] {
        let sampler =
            Sampler { width, rows: height, height, spacing, threshold, distances: true, order: Order::TopDown };
        let made = sampled(&sampler, &truth).0;
        for ((pixel, code), depth) in made.iter().zip(codes(picture).2).zip(distances(depths)) {
            assert_eq!(encode_pixel(pixel.colour), code);
            assert!((pixel.distance - depth).abs() <= 1e-6 * depth, "{} {depth}", pixel.distance);
        }
    }
}

/// A hard checkerboard, for pictures of any size.
fn checks(x: u32, y: u32) -> Pixel {
    let light = (x / 7 + y / 5).is_multiple_of(2);
    Pixel { colour: Rgb::splat(if light { 1.0 } else { 0.1 }), distance: 1.0 }
}

#[test]
fn no_pixel_is_traced_twice_and_batches_grow() {
    for order in [Order::TopDown, Order::CoarseToFine] {
        let sampler =
            Sampler { width: 211, rows: 150, height: 150, spacing: 4, threshold: 0.05, distances: false, order };
        let (rows, batches) = sampled(&sampler, &checks);
        assert_eq!(rows.len(), 211 * 150);
        let all: Vec<(u32, u32)> = batches.iter().flatten().map(|r| (r.x, r.y)).collect();
        assert_eq!(all.iter().collect::<HashSet<_>>().len(), all.len());
        assert!(batches.iter().all(|b| !b.is_empty() && b.len() <= 4096));
        assert_eq!(batches[..5].iter().map(Vec::len).collect::<Vec<_>>(), [1, 1, 2, 4, 8]);
    }
}

#[test]
fn odd_sizes_work() {
    for (width, rows) in [(0, 5), (5, 0), (1, 1), (2, 1), (1, 9), (3, 2), (17, 2), (40, 1)] {
        for spacing in [1, 2, 4, 16] {
            for order in [Order::TopDown, Order::CoarseToFine] {
                let sampler =
                    Sampler { width, rows, height: rows + 3, spacing, threshold: 0.05, distances: false, order };
                if width > 0 && rows > 0 {
                    assert_eq!(sampled(&sampler, &checks).0.len(), (width * rows) as usize);
                }
            }
        }
    }
}
