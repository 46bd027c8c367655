//! Fonts, and what their glyphs cover.
#![no_main]

use ambit_scene::Font;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    match Font::parse("fuzz.fnt", data) {
        Ok(font) => {
            let _ = font.mean_width();
            for glyph in (0..=255).filter_map(|code| font.glyph(code)) {
                let _ = (glyph.is_blank(), glyph.left(), glyph.right());
                for i in 0..16 {
                    let _ = glyph.covers(f64::from(i) * 16.5, f64::from(i) * 15.5);
                }
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
