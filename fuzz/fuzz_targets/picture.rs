//! Radiance pictures, compressed or not.
#![no_main]

use ambit_file::Picture;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    match Picture::read(data, "fuzz.hdr") {
        Ok(picture) => {
            let _ = picture.at(0, 0);
            let _ = picture.rows().count();
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
