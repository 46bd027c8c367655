//! What the words of an `xform` command ask for.

use super::primitive::is_simple;
use crate::grammar::integer;
use ambit_base::Transform;
use ambit_file::text_of;

/// Arrays within arrays, beyond which a command is left to the program.
const MOST_ARRAYS: usize = 16;
/// Digits that always fit 32 bits.
const MOST_DIGITS: usize = 9;

/// An `xform` command.
pub(super) struct Request {
    /// What names of surfaces get in front of them (`-n`).
    pub(super) name: Option<Vec<u8>>,
    /// What surfaces are modified by instead (`-m`).
    pub(super) modifier: Option<Vec<u8>>,
    /// Surfaces face the other way (`-I`).
    pub(super) invert: bool,
    pub(super) files: Vec<Vec<u8>>,
    /// The transform, which has `-i 0` in place of each array.
    transform: Vec<Vec<u8>>,
    /// For each array (`-a`), where its count stands in the transform, and how many places it has.
    arrays: Vec<(usize, i32)>,
}

/// One place that primitives are put in.
pub(super) struct Placed {
    /// What names of surfaces get in front of them.
    pub(super) name: Option<Vec<u8>>,
    /// The transform as words, and what it is.
    pub(super) words: Vec<Vec<u8>>,
    pub(super) transform: Transform,
}

impl Request {
    /// Understands the words of a command, its name among them; `None` if it is out of the ordinary.
    pub(super) fn parse(words: Vec<Vec<u8>>) -> Option<Self> {
        let mut request =
            Self { name: None, modifier: None, invert: false, files: vec![], transform: vec![], arrays: vec![] };
        let mut words = words.into_iter().skip(1).peekable();
        let mut names = 0;
        while let Some(word) = words.next_if(|w| matches!(&w[..], b"-n" | b"-m" | b"-I" | b"-e")) {
            match word[1] {
                b'n' => {
                    names += 1;
                    let name = words.next().filter(|w| is_simple(w))?;
                    request.name = Some(joined(request.name.take(), &name));
                }
                b'm' => {
                    let modifier = words.next().filter(|w| is_simple(w))?;
                    request.modifier.get_or_insert(modifier);
                }
                b'I' => request.invert = !request.invert,
                _ => (),
            }
        }
        while let Some(word) = words.next_if(|w| w.first() == Some(&b'-')) {
            let numbers = match &word[..] {
                b"-a" => {
                    let count = integer(&words.next()?).filter(|&n| n > 0)?;
                    request.transform.push(b"-i".into());
                    request.arrays.push((request.transform.len(), count));
                    request.transform.push(b"0".into());
                    continue;
                }
                b"-mx" | b"-my" | b"-mz" => 0,
                b"-i" | b"-rx" | b"-ry" | b"-rz" | b"-s" => 1,
                b"-t" => 3,
                _ => return None,
            };
            // Counts beyond 32 bits are wrapped.
            if word == b"-i" && words.peek()?.len() > MOST_DIGITS {
                return None;
            }
            request.transform.push(word);
            for _ in 0..numbers {
                request.transform.push(words.next()?);
            }
        }
        request.files = words.collect();
        let arrays = request.arrays.len();
        (arrays == 0 || arrays <= MOST_ARRAYS && names <= 1).then_some(request)
    }

    /// The places in order, the last array's going by fastest; `None` for one whose transform is malformed.
    pub(super) fn places(&self) -> impl Iterator<Item = Option<Placed>> {
        let count: usize = self.arrays.iter().map(|a| a.1 as usize).fold(1, usize::saturating_mul);
        (0..count).map(move |mut place| {
            let mut words = self.transform.clone();
            let mut indices = Vec::new();
            for &(at, count) in self.arrays.iter().rev() {
                let index = (place % count as usize).to_string();
                place /= count as usize;
                words[at] = index.clone().into();
                indices.push(index);
            }
            let name = match indices.pop() {
                None => self.name.clone(),
                Some(first) => {
                    let first = match &self.name {
                        Some(name) => joined(Some(name.clone()), first.as_bytes()),
                        None => [b"a", first.as_bytes()].concat(),
                    };
                    Some(indices.iter().rev().fold(first, |name, index| joined(Some(name), index.as_bytes())))
                }
            };
            let texts: Vec<_> = words.iter().map(|w| text_of(w)).collect();
            let transform = Transform::parse(&texts).ok()?;
            Some(Placed { name, words, transform })
        })
    }
}

/// Names with a point between them.
pub(super) fn joined(name: Option<Vec<u8>>, next: &[u8]) -> Vec<u8> {
    match name {
        Some(name) => [&name, &b"."[..], next].concat(),
        None => next.to_vec(),
    }
}
