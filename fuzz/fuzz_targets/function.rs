//! Function files: read, compiled, and their outputs evaluated.
#![no_main]

use ambit_cal::{CHANNELS, Context, Inputs, Library, Scratch};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let mut library = Library::renderer().expect("the library is right");
    let loaded = library.load_file("fuzz.cal", "fuzz.cal", data);
    if let Err(error) = &loaded {
        assert!(!error.to_string().is_empty());
    }
    let context = Context::of_file("fuzz.cal");
    let mut programs = Vec::new();
    for name in ["a", "b", "f(a,b)", "f(1)", "Px"] {
        programs.extend(library.compile(name, &context, "fuzz"));
    }
    programs.extend(library.compile(&String::from_utf8_lossy(data), &context, "fuzz"));
    programs.extend(library.outputs().into_iter().map(|(_, program)| program));
    let channels = [0.5; CHANNELS];
    let mut scratch = Scratch::new();
    let mut pass = scratch.pass(Inputs { channels: &channels, reals: &[1.0, 2.0] });
    for program in &programs {
        let _ = pass.eval(program);
    }
});
