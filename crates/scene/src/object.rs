//! Primitives as records in flat tables: one small struct an object, its words and numbers in shared arrays, so that a
//! million polygons cost little more than their coordinates.

use crate::Kind;
use crate::names::Names;
use ambit_base::Location;
use ambit_file::text_of;

/// Number of a primitive in reading order, over all files of a scene and everything it instances.
pub type ObjectId = u32;

/// The modifier `void`.
pub const VOID: ObjectId = ObjectId::MAX;

/// One primitive.
#[derive(Clone, Copy, Debug)]
pub struct Object {
    /// Its type.
    pub kind: Kind,
    /// The primitive that modifies it, or [`VOID`].
    pub modifier: ObjectId,
    pub(crate) name: Span,
    pub(crate) strings: Span,
    pub(crate) reals: Span,
    /// Index into the scene's table of files.
    pub(crate) file: u32,
    /// Line on which it begins, from 1.
    pub(crate) line: u32,
}

/// A run of entries in one of the scene's arrays.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Span {
    pub(crate) start: u32,
    pub(crate) len: u32,
}

impl Span {
    fn range(self) -> std::ops::Range<usize> {
        self.start as usize..self.start as usize + self.len as usize
    }
}

/// All primitives of a scene, in reading order.
#[derive(Debug, Default)]
pub struct Scene {
    objects: Vec<Object>,
    /// Bytes of every name and string argument.
    text: Vec<u8>,
    /// One span of `text` for each string argument.
    strings: Vec<Span>,
    reals: Vec<f64>,
    files: Vec<String>,
    /// Modifiers by name.
    names: Names,
}

/// What [`Scene::push`] takes: a primitive with its parts in the caller's hands.
#[derive(Clone, Copy, Debug)]
pub struct NewObject<'a> {
    /// Its type.
    pub kind: Kind,
    /// Its modifier, or [`VOID`].
    pub modifier: ObjectId,
    /// Its identifier, any bytes.
    pub name: &'a [u8],
    /// String arguments.
    pub strings: &'a [&'a [u8]],
    /// Real arguments.
    pub reals: &'a [f64],
    /// Index from [`Scene::add_file`].
    pub file: u32,
    /// Line on which it begins, from 1; 0 if unknown.
    pub line: u32,
}

impl Scene {
    /// An empty scene.
    pub fn new() -> Self {
        Self::default()
    }

    /// Names a file (or command) that objects come from; gives its index.
    pub fn add_file(&mut self, name: &str) -> u32 {
        self.files.push(name.to_owned());
        self.files.len() as u32 - 1
    }

    /// Which of the scene's tables has no room for a primitive; `None` if all have.
    pub fn full(&self, new: &NewObject<'_>) -> Option<&'static str> {
        let limit = u32::MAX as usize;
        let text = new.name.len() + new.strings.iter().map(|s| s.len()).sum::<usize>();
        if self.objects.len() + 1 >= limit {
            Some("too many objects")
        } else if self.text.len() + text >= limit || self.strings.len() + new.strings.len() >= limit {
            Some("too much text")
        } else if self.reals.len() + new.reals.len() >= limit {
            Some("too many numbers")
        } else {
            None
        }
    }

    /// Appends a primitive and gives its number. Modifiers can be found by name from then on; but one that repeats the
    /// present definition of its name ([`Scene::modifier`]) leaves that one in its place.
    ///
    /// # Panics
    /// If one of the tables is full; see [`Scene::full`].
    pub fn push(&mut self, new: NewObject<'_>) -> ObjectId {
        assert_eq!(self.full(&new), None, "the caller asks for room first");
        let name = self.add_text(new.name);
        let strings = Span { start: self.strings.len() as u32, len: new.strings.len() as u32 };
        for s in new.strings {
            let span = self.add_text(s);
            self.strings.push(span);
        }
        let reals = Span { start: self.reals.len() as u32, len: new.reals.len() as u32 };
        self.reals.extend_from_slice(new.reals);
        let id = self.objects.len() as ObjectId;
        self.objects.push(Object {
            kind: new.kind,
            modifier: new.modifier,
            name,
            strings,
            reals,
            file: new.file,
            line: new.line,
        });
        if new.kind.is_modifier() {
            let present = self.names.latest(new.name);
            if !present.is_some_and(|old| self.is_repeated(id, old)) {
                self.names.insert(new.name, id);
            }
        }
        id
    }

    fn add_text(&mut self, bytes: &[u8]) -> Span {
        let start = self.text.len() as u32;
        self.text.extend_from_slice(bytes);
        Span { start, len: bytes.len() as u32 }
    }

    /// Number of primitives of every kind.
    pub fn len(&self) -> usize {
        self.objects.len()
    }

    /// True if there is no primitive.
    pub fn is_empty(&self) -> bool {
        self.objects.is_empty()
    }

    /// The primitive of that number.
    #[inline]
    pub fn object(&self, id: ObjectId) -> &Object {
        &self.objects[id as usize]
    }

    /// For corrections of type or modifier after reading.
    pub fn object_mut(&mut self, id: ObjectId) -> &mut Object {
        &mut self.objects[id as usize]
    }

    /// Numbers of all primitives, in order.
    pub fn ids(&self) -> std::ops::Range<ObjectId> {
        0..self.objects.len() as ObjectId
    }

    /// Identifier, as bytes.
    pub fn name_bytes(&self, id: ObjectId) -> &[u8] {
        &self.text[self.object(id).name.range()]
    }

    /// Identifier, as text ([`text_of`]).
    pub fn name(&self, id: ObjectId) -> std::borrow::Cow<'_, str> {
        text_of(self.name_bytes(id))
    }

    /// Number of string arguments.
    pub fn string_count(&self, id: ObjectId) -> usize {
        self.object(id).strings.len as usize
    }

    /// String argument `i` (from 0), as bytes.
    pub fn string_bytes(&self, id: ObjectId, i: usize) -> Option<&[u8]> {
        let span = self.strings[self.object(id).strings.range()].get(i)?;
        Some(&self.text[span.range()])
    }

    /// String argument `i` (from 0), as text ([`text_of`]).
    pub fn string(&self, id: ObjectId, i: usize) -> Option<std::borrow::Cow<'_, str>> {
        self.string_bytes(id, i).map(text_of)
    }

    /// All string arguments.
    pub fn strings(&self, id: ObjectId) -> impl ExactSizeIterator<Item = std::borrow::Cow<'_, str>> {
        self.strings[self.object(id).strings.range()].iter().map(|s| text_of(&self.text[s.range()]))
    }

    /// All string arguments, as bytes.
    pub fn strings_bytes(&self, id: ObjectId) -> impl ExactSizeIterator<Item = &[u8]> {
        self.strings[self.object(id).strings.range()].iter().map(|s| &self.text[s.range()])
    }

    /// Real arguments.
    #[inline]
    pub fn reals(&self, id: ObjectId) -> &[f64] {
        &self.reals[self.object(id).reals.range()]
    }

    /// Replaces the real arguments of an object by no more numbers than it has.
    ///
    /// # Panics
    /// If `new` is longer than the present list.
    pub fn shrink_reals(&mut self, id: ObjectId, new: &[f64]) {
        let span = self.object(id).reals;
        assert!(new.len() <= span.len as usize, "an object's numbers only shrink");
        self.reals[span.start as usize..][..new.len()].copy_from_slice(new);
        self.object_mut(id).reals.len = new.len() as u32;
    }

    /// Where a primitive was defined.
    pub fn location(&self, id: ObjectId) -> Location {
        let o = self.object(id);
        let file = self.files.get(o.file as usize).cloned().unwrap_or_default();
        Location { file, line: o.line, column: 0 }
    }

    /// `TYPE "identifier"`, as diagnostics name a primitive.
    pub fn describe(&self, id: ObjectId) -> String {
        format!("{} \"{}\"", self.object(id).kind.name(), self.name(id))
    }

    /// What a modifier called `name` denotes now: its latest definition, or an older one that the latest only repeats.
    pub fn modifier(&self, name: &[u8]) -> Option<ObjectId> {
        self.names.latest(name)
    }

    /// What a modifier called `name` denoted when object `before` was defined. This is how names among string arguments
    /// are resolved.
    pub fn modifier_before(&self, name: &[u8], before: ObjectId) -> Option<ObjectId> {
        self.names.before(name, before)
    }

    /// Gives back memory that was reserved for growth.
    pub fn shrink_to_fit(&mut self) {
        self.objects.shrink_to_fit();
        self.text.shrink_to_fit();
        self.strings.shrink_to_fit();
        self.reals.shrink_to_fit();
    }
}
