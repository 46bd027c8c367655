//! Names and contexts: which entry a written name means. Answers function-files.md section 4 and scene.md section 5.
//!
//! Lookup finds any name already *mentioned*, defined or not, so its outcome depends on the order of the texts; entries
//! are therefore only ever added, and everything later refers to them by number.

use std::collections::HashMap;
use std::sync::Arc;

use crate::builtin::Builtin;
use crate::channel::local_channel;
use crate::expr::{Definition, Expr};
use crate::library::Host;

/// The mark between a name and its context.
const MARK: char = '`';

/// The name space an expression is read in: that of a function file, or the global one.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Context(String);

impl Context {
    /// The context of prelude, `-e` definitions and scene primitives that name `.` as their file.
    pub const GLOBAL: Self = Self(String::new());

    /// The context of a function file as a scene names it; `.` is the global context. Files whose names differ only in
    /// a final `.cal` or in characters that names cannot hold share a context, as they do in Radiance.
    pub fn of_file(name: &str) -> Self {
        if name == "." {
            return Self::GLOBAL;
        }
        let stem = match name.len().checked_sub(4).and_then(|at| name.split_at_checked(at)) {
            Some((stem, suffix)) if suffix.eq_ignore_ascii_case(".cal") => stem,
            _ => name,
        };
        let mut mark = String::from(MARK);
        mark.extend(stem.trim_start_matches(MARK).bytes().map(|byte| match byte {
            b'_' | b'.' | b'`' => char::from(byte),
            _ if byte.is_ascii_alphanumeric() => char::from(byte),
            _ => '_',
        }));
        Self(mark)
    }

    /// The context with its marks; empty if global.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// Number of an entry, and of the memory of its value in a scratch.
pub(crate) type EntryId = u32;

/// One qualified name.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub(crate) name: Arc<str>,
    pub(crate) definition: Option<Definition>,
    /// The library function of this name, if the entry is global.
    pub(crate) builtin: Option<Builtin>,
}

/// Every name mentioned so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Names {
    entries: Vec<Entry>,
    index: HashMap<Arc<str>, EntryId>,
}

impl Names {
    pub(crate) fn entry(&self, id: EntryId) -> &Entry {
        &self.entries[id as usize]
    }

    pub(crate) fn entry_mut(&mut self, id: EntryId) -> &mut Entry {
        &mut self.entries[id as usize]
    }

    pub(crate) fn count(&self) -> u32 {
        self.entries.len() as u32
    }

    /// The entry of an exact qualified name, made if need be.
    pub(crate) fn exact(&mut self, name: &str, host: Host) -> EntryId {
        if let Some(id) = self.index.get(name) {
            return *id;
        }
        let id = self.count();
        let name: Arc<str> = name.into();
        let builtin = Builtin::named(&name, host);
        self.entries.push(Entry { name: name.clone(), definition: None, builtin });
        self.index.insert(name, id);
        id
    }

    /// The entry a definition of `written` in `context` defines.
    pub(crate) fn defined(&mut self, written: &str, context: &Context, host: Host) -> EntryId {
        let name = written.strip_prefix(MARK).unwrap_or(written);
        match name.strip_suffix(MARK) {
            Some(global) => self.exact(global, host),
            None => self.exact(&format!("{name}{}", context.0), host),
        }
    }

    /// The entry that `written` means in an expression of `context`, made if the name is new.
    pub(crate) fn mentioned(&mut self, written: &str, context: &Context, host: Host) -> EntryId {
        if let Some(id) = self.known(written, context) {
            return id;
        }
        let local = !written.starts_with(MARK) && !written.ends_with(MARK);
        if local && Builtin::named(written, host).is_some() {
            return self.exact(written, host);
        }
        let id = self.defined(written, context, host);
        if host == Host::Renderer
            && let Some(channel) = local_channel(written)
        {
            self.entry_mut(id).definition = Some(Definition::variable(Expr::Channel(channel)));
        }
        id
    }

    /// As [`Self::mentioned`], but only what is there already.
    pub(crate) fn known(&self, written: &str, context: &Context) -> Option<EntryId> {
        let find = |name: &str| self.index.get(name).copied();
        if let Some(name) = written.strip_prefix(MARK) {
            let name = name.strip_suffix(MARK).unwrap_or(name);
            return find(&format!("{name}{}", context.0));
        }
        if let Some(global) = written.strip_suffix(MARK) {
            return find(global);
        }
        let mut context = context.0.as_str();
        loop {
            if let Some(id) = find(&format!("{written}{context}")) {
                return Some(id);
            }
            if context.is_empty() {
                return None;
            }
            context = context[1..].find(MARK).map_or("", |at| &context[at + 1..]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_give_contexts() {
        for (file, context) in [
            ("lib/my-pat.cal", "`lib_my_pat"),
            ("./a.cal", "`._a"),
            ("a", "`a"),
            ("a.CAL", "`a"),
            ("``q.cal", "`q"),
            (".", ""),
            ("é.cal", "`__"),
        ] {
            assert_eq!(Context::of_file(file).as_str(), context, "{file}");
        }
        assert_eq!(Context::of_file("sub/z-1.cal"), Context::of_file("sub_z_1.cal"));
    }

    #[test]
    fn lookup_goes_from_the_inner_context_outwards() {
        let mut names = Names::default();
        let host = Host::Renderer;
        let nested = Context("`inner`outer".into());
        let global = names.exact("v", host);
        assert_eq!(names.known("v", &nested), Some(global));
        let outer = names.exact("v`outer", host);
        assert_eq!(names.known("v", &nested), Some(outer));
        let inner = names.defined("v", &nested, host);
        assert_eq!(names.known("v", &nested), Some(inner));
        assert_eq!(names.known("v`", &nested), Some(global));
        assert_eq!(names.known("`v", &nested), Some(inner));
        assert_eq!(names.known("v`outer", &nested), Some(outer));
        assert_eq!(names.known("v`outer`", &nested), Some(outer));
        assert_eq!(names.known("w", &nested), None);
        assert_eq!(names.defined("v`", &nested, host), global);
    }

    #[test]
    fn new_names_are_local_but_library_functions_global() {
        let mut names = Names::default();
        let file = Context::of_file("a.cal");
        let sine = names.mentioned("sin", &file, Host::Renderer);
        assert_eq!(&*names.entry(sine).name, "sin");
        let other = names.mentioned("sine", &file, Host::Renderer);
        assert_eq!(&*names.entry(other).name, "sine`a");
        let local = names.mentioned("`cos", &file, Host::Renderer);
        assert_eq!(&*names.entry(local).name, "cos`a");
        assert!(names.entry(local).builtin.is_none());
    }
}
