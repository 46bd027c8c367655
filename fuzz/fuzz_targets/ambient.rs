//! Ambient files.
#![no_main]

use ambit_ambient::scan;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    match scan(data, "fuzz.amb") {
        Ok(contents) => assert!(contents.records.len() * 67 <= data.len()),
        Err(error) => assert!(!error.is_empty()),
    }
});
