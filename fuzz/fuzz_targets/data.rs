//! Data files, and looking up in them.
#![no_main]

use ambit_scene::{DataTable, MAX_DIMENSIONS};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    match DataTable::parse("fuzz.dat", "fuzz.dat", data) {
        Ok(table) => {
            for x in [-1e30, -1.0, 0.0, 0.5, 1.0, 7.25, 1e30] {
                let _ = table.interpolate(&[x; MAX_DIMENSIONS]);
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
