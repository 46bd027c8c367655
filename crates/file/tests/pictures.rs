//! Pictures that Radiance 6.0a rendered of `data/own.rad`, a scene of ours (the commands stand in their headers): pixels
//! as pvalue tells them, bytes as rpict wrote them.

use ambit_base::Rgb;
use ambit_file::{
    Header, Orientation, Picture, PictureReader, PictureWriter, PixelSpace, Resolution, encode_flat, encode_pixel,
};
use proptest::prelude::*;

const ROOM: &[u8] = include_bytes!("data/room.hdr");
const ROOM_XYZ: &[u8] = include_bytes!("data/room_xyz.hdr");
/// Fourteen pixels wide, which is too narrow for run-length encoding.
const ROOM_FLAT: &[u8] = include_bytes!("data/room_flat.hdr");

/// The pixel that pvalue gave as these numbers, which are exact in single precision.
fn exact([r, g, b]: [f64; 3]) -> Rgb {
    Rgb::new(r as f32, g as f32, b as f32)
}

#[test]
fn pixels_are_those_that_pvalue_prints() {
    let p = Picture::read(ROOM, "room.hdr").unwrap();
    assert_eq!((p.width, p.height, p.space), (48, 37, PixelSpace::Rgb));
    assert_eq!(p.at(0, 0), Some(exact([0.011199951171875, 0.009552001953125, 0.006744384765625])));
    assert_eq!(p.at(24, 5), Some(exact([0.02178955078125, 0.01861572265625, 0.01300048828125])));
    assert_eq!(p.at(5, 36), Some(Rgb::ZERO));
    assert_eq!((p.at(48, 0), p.at(0, 37)), (None, None));
    let p = Picture::read(ROOM_XYZ, "room_xyz.hdr").unwrap();
    assert_eq!((p.width, p.height, p.space), (40, 31, PixelSpace::Xyz));
    assert_eq!(p.at(0, 0), Some(exact([1.79296875, 1.76953125, 1.29296875])));
    assert_eq!(p.at(24, 5), Some(exact([3.5234375, 3.4765625, 2.5390625])));
    assert_eq!(p.at(39, 15), Some(Rgb::ZERO));
}

#[test]
fn written_again_they_have_the_same_bytes() {
    for bytes in [ROOM, ROOM_XYZ, ROOM_FLAT] {
        let mut out = Vec::new();
        Picture::read(bytes, "p").unwrap().write(&mut out).unwrap();
        assert!(out == bytes);
    }
}

#[test]
fn every_cut_is_an_error_that_names_the_scanline() {
    let body = Header::parse(ROOM, "p").unwrap().1;
    for cut in [0, 10, body, body + 5, body + 23, body + 24, body + 700, ROOM.len() - 1] {
        let e = Picture::read(&ROOM[..cut], "cut.hdr").unwrap_err().to_string();
        assert!(e.starts_with("cut.hdr: "), "{e}");
        assert!(cut < body + 24 || e.contains(": scanline "), "{cut}: {e}");
    }
}

#[test]
fn other_formats_are_refused_by_name() {
    let e = Picture::read(&b"#?RADIANCE\nFORMAT=Radiance_octree\n\n-Y 1 +X 1\n"[..], "a.oct").unwrap_err().to_string();
    assert_eq!(e, "a.oct: FORMAT=Radiance_octree (expected 32-bit_rle_rgbe or 32-bit_rle_xyze)");
    let huge = b"#?RADIANCE\n\n-Y 1 +X 2000000000\n\x01\x02\x03\x04\x01\x01\x01\xff";
    assert!(Picture::read(&huge[..], "huge.hdr").is_err());
}

#[test]
fn what_follows_a_picture_is_left_to_the_caller() {
    let two = [ROOM_FLAT, b"FRAME=2\n"].concat();
    let mut reader = PictureReader::new(two.as_slice(), "two").unwrap();
    while reader.next_codes().unwrap().is_some() {}
    assert_eq!(reader.position(), reader.resolution.scanlines());
    assert_eq!(reader.into_inner(), b"FRAME=2\n");
}

#[test]
fn all_orientations_give_the_same_picture() {
    let (width, height) = (21u32, 18u32);
    let value = |x: u32, y: u32| Rgb::new(x as f32 + 1.0, y as f32 + 1.0, 64.0);
    for orientation in Orientation::all() {
        let resolution = Resolution { width, height, orientation };
        let mut header = Header::new();
        header.push("FORMAT=32-bit_rle_rgbe");
        let (mut rle, mut flat) = (Vec::new(), Vec::new());
        header.write(&mut flat).unwrap();
        flat.extend(format!("{resolution}\n").bytes());
        let mut writer = PictureWriter::new(&mut rle, &header, &resolution).unwrap();
        for i in 0..resolution.scanlines() {
            let line: Vec<Rgb> = (0..resolution.scanline_length())
                .map(|j| {
                    let (x, y) = resolution.pixel(i, j);
                    value(x, y)
                })
                .collect();
            writer.write_pixels(&line).unwrap();
            let codes: Vec<[u8; 4]> = line.iter().map(|&p| encode_pixel(p)).collect();
            encode_flat(&codes, &mut flat);
        }
        for bytes in [rle, flat] {
            let p = Picture::read(bytes.as_slice(), "p").unwrap();
            for (x, y) in [(0, 0), (20, 17), (3, 11), (20, 0)] {
                let stored = p.at(x, y).unwrap();
                assert!((stored - value(x, y)).abs().max_element() <= 0.25, "{orientation:?} {x} {y} {stored}");
            }
        }
    }
}

proptest! {
    #[test]
    fn damaged_pictures_never_panic(at in 0..ROOM.len(), byte: u8, cut in 0..ROOM.len()) {
        let mut bytes = ROOM.to_vec();
        bytes[at] = byte;
        let _ = Picture::read(bytes.as_slice(), "p");
        let _ = Picture::read(&bytes[..cut], "p");
    }

    #[test]
    fn pictures_round_trip(width in 1u32..40, height in 1u32..8, seed: u32) {
        let pixels = (0..width * height)
            .map(|i| {
                let v = ambit_base::mix(u64::from(seed), u64::from(i / 3));
                // Codes, so that writing loses nothing.
                ambit_file::decode_pixel([v as u8, (v >> 8) as u8, 128 | (v >> 16) as u8, 100 + (v >> 24) as u8 / 4])
            })
            .collect();
        let mut header = Header::new();
        header.push("FORMAT=32-bit_rle_xyze");
        let p = Picture { header, width, height, space: PixelSpace::Xyz, pixels };
        let mut out = Vec::new();
        p.write(&mut out).unwrap();
        prop_assert_eq!(Picture::read(out.as_slice(), "p").unwrap(), p);
    }
}
