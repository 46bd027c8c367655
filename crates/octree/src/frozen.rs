//! The scene section of frozen octrees and meshes: a table of type names, then every object with its type, modifier,
//! name and arguments, then the byte FF.

use crate::Error;
use crate::error::Problem;
use ambit_base::Notify;
use ambit_file::{Cursor, PortableWrite, text_of};
use ambit_scene::{KINDS, Kind, NewObject, ObjectId, Scene, VOID};
use std::io::{self, Write};
use std::ops::Range;

/// What stands in place of a type after the last object.
const END: u8 = 0xff;

/// Most arguments of one kind that the two-byte counts can tell.
const MOST_ARGUMENTS: usize = 32767;

/// Reads the section and appends its objects to the scene; object numbers of the file are `width` bytes long and
/// relative to the first of them. Gives how many there are.
pub(crate) fn read(
    input: &mut Cursor<'_>,
    width: usize,
    name: &str,
    scene: &mut Scene,
    notify: &dyn Notify,
) -> Result<usize, Error> {
    let ends = || Error::FrozenEnd { name: name.to_owned() };
    let mut kinds = Vec::new();
    loop {
        let word = input.string().ok_or_else(ends)?;
        if word.is_empty() {
            break;
        }
        let kind = Kind::from_name(word);
        if kind.is_none() {
            notify.warn(&format!("unknown object type \"{}\"", text_of(word)));
        }
        kinds.push(kind);
    }
    let file = scene.add_file(name);
    let first = scene.len();
    let mut strings = Vec::new();
    let mut reals = Vec::new();
    loop {
        // Like Radiance, take the end of the file for the end of the list.
        let number = input.byte().unwrap_or(END);
        if number == END {
            return Ok(scene.len() - first);
        }
        let kind = kinds
            .get(number as usize)
            .copied()
            .flatten()
            .ok_or_else(|| Error::UnknownType { name: name.to_owned() })?;
        let modifier = input.int(width).ok_or_else(ends)?;
        let identifier = input.string().ok_or_else(ends)?;
        let primitive = || format!("{} \"{}\"", kind.name(), text_of(identifier));
        let count = |input: &mut Cursor<'_>| {
            let n = input.int(2).ok_or_else(ends)?;
            usize::try_from(n).map_err(|_| Problem::NegativeCount { primitive: primitive() }.of(name))
        };
        strings.clear();
        for _ in 0..count(input)? {
            strings.push(input.string().ok_or_else(ends)?);
        }
        reals.clear();
        for _ in 0..count(input)? {
            reals.push(input.float().ok_or_else(ends)?);
        }
        let modifier = if modifier == -1 {
            VOID
        } else {
            usize::try_from(modifier)
                .ok()
                .filter(|m| *m < scene.len() - first)
                .map(|m| (first + m) as ObjectId)
                .filter(|&m| scene.object(m).kind.is_modifier())
                .ok_or_else(|| Problem::BadModifier { modifier, primitive: primitive() }.of(name))?
        };
        let new = NewObject { kind, modifier, name: identifier, strings: &strings, reals: &reals, file, line: 0 };
        if scene.len() >= crate::MOST_OBJECTS || scene.full(&new).is_some() {
            return Err(Problem::TooManyObjects.of(name));
        }
        scene.push(new);
    }
}

/// Makes sure that a run of objects can be written.
pub(crate) fn check(scene: &Scene, mut objects: Range<ObjectId>) -> Result<(), Error> {
    match objects.find(|&id| scene.string_count(id).max(scene.reals(id).len()) > MOST_ARGUMENTS) {
        Some(id) => Err(Error::Unfreezable { primitive: scene.describe(id) }),
        None => Ok(()),
    }
}

/// Writes the section for a run of objects; numbers are four bytes long and relative to the first.
pub(crate) fn write(out: &mut impl Write, scene: &Scene, objects: Range<ObjectId>) -> io::Result<()> {
    let first = objects.start;
    for (_, name, _) in KINDS {
        out.write_string(name.as_bytes())?;
    }
    out.write_string(b"")?;
    for id in objects {
        let object = scene.object(id);
        let (strings, reals) = (scene.string_count(id), scene.reals(id));
        out.write_int(1, object.kind as i64)?;
        out.write_int(4, if object.modifier == VOID { -1 } else { (object.modifier - first) as i64 })?;
        out.write_string(scene.name_bytes(id))?;
        out.write_int(2, strings as i64)?;
        scene.strings_bytes(id).try_for_each(|s| out.write_string(s))?;
        out.write_int(2, reals.len() as i64)?;
        reals.iter().try_for_each(|&x| out.write_float(x))?;
    }
    out.write_int(1, END as i64)
}
