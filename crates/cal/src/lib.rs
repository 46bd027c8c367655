//! Radiance's function-file language: what `.cal` files and the expressions of scene arguments mean.
//!
//! A [`Library`] takes definitions (files, `-e` texts, the prelude `rayinit.cal`) and compiles expressions and function
//! names to [`Program`]s. A program knows which inputs it reads ([`Program::channels`]), so that a renderer computes no
//! others, and runs on any thread: everything that changes lives in a [`Scratch`] of that thread.
//!
//! ```
//! use ambit_cal::{CHANNELS, Channel, Context, Host, Inputs, Library, Scratch};
//! let mut library = Library::renderer().unwrap();
//! library.load_file("stripes.cal", "lib/stripes.cal", b"stripe = if(mod(Px, A1) - A1/2, 1, .2);").unwrap();
//! let program = library.compile("stripe", &Context::of_file("stripes.cal"), "brightfunc \"pat\"").unwrap();
//! assert!(program.channels().contains(Channel::Px));
//! let mut channels = [0.0; CHANNELS];
//! channels[Channel::Px as usize] = 2.7;
//! let mut scratch = Scratch::new();
//! let mut pass = scratch.pass(Inputs { channels: &channels, reals: &[1.0] });
//! assert_eq!(pass.eval(&program).unwrap(), 1.0);
//! ```
//!
//! The text goes through four steps, each a module: `parse` (nom grammar to a raw tree), `bind` (names to entries and
//! constant folding, in the order of the text, because lookup depends on what was mentioned before), `emit` (tree to
//! flat code: calls inlined or made subroutines, arguments by need) and `run` (the machine).

mod bind;
mod builtin;
mod call;
mod calm;
mod channel;
mod embedded;
mod emit;
mod error;
mod expr;
mod flow;
mod fold;
mod fractal;
mod lex;
mod library;
mod names;
mod noise;
mod op;
mod panel;
mod parse;
mod program;
mod run;
mod scratch;
mod source;
mod special;

pub use channel::{CHANNELS, Channel, ChannelSet};
pub use embedded::{EMBEDDED, embedded};
pub use error::{CompileError, Fault, Flag, Problem, Warning};
pub use fractal::fnoise3;
pub use library::{Host, Library};
pub use names::Context;
pub use noise::{noise3, noise3x, noise3y, noise3z};
pub use program::Program;
pub use scratch::{Inputs, Pass, Scratch};
pub use special::rand;
