//! Where auxiliary files are found: function files, data, pictures, fonts, BSDFs, octrees of instances, meshes.
//!
//! A name that begins with `/`, `.` or `~` is used as it is; any other is looked for in the directories of RAYPATH in
//! order and then among the library files built into the program. Octrees, views and scene files of the command line
//! are not searched.

use crate::error::Error;
use crate::native::path_of;
use rustix::fs::{Access, access};
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// The value of RAYPATH if it is not set: the working directory, then the installed library.
pub const DEFAULT_PATH: &str = ":/usr/local/lib/ray";

/// Where users' home directories are listed.
const USERS: &str = "/etc/passwd";

/// The library files that are built into a program.
#[derive(Clone, Copy, Debug)]
pub struct Library(fn(&str) -> Option<&'static [u8]>);

impl Library {
    /// A table of built-in files, asked by name.
    pub const fn new(lookup: fn(&str) -> Option<&'static [u8]>) -> Self {
        Self(lookup)
    }

    /// No built-in files.
    pub const NONE: Self = Self(|_| None);
}

/// A file that was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Found {
    /// On disk.
    Path(PathBuf),
    /// Built into the program.
    Embedded(&'static [u8]),
}

/// The places where auxiliary files are looked for: directories in order, the user's home, built-in files.
#[derive(Clone, Debug)]
pub struct SearchPath {
    directories: Vec<PathBuf>,
    home: Option<PathBuf>,
    library: Library,
}

impl SearchPath {
    /// From the values of RAYPATH ([`DEFAULT_PATH`] if unset) and HOME. Directories are separated by `:`; an empty one
    /// is the working directory, but for an empty last one after others, which means nothing.
    pub fn new(raypath: Option<&str>, home: Option<&str>, library: Library) -> Self {
        let path = raypath.unwrap_or(DEFAULT_PATH);
        let path = path.strip_suffix(':').unwrap_or(path);
        Self { directories: path.split(':').map(path_of).collect(), home: home.map(path_of), library }
    }

    /// The first place that has the file and lets it be read. (A directory of that name counts, as it does for other
    /// programs; reading it fails.)
    pub fn find(&self, name: &str) -> Option<Found> {
        let on_disk = self.find_from(Path::new(""), name).map(Found::Path);
        on_disk.or_else(|| self.direct(name).is_none().then(|| (self.library.0)(name)).flatten().map(Found::Embedded))
    }

    /// As [`SearchPath::find`], on disk alone, for a program that works in `folder`.
    pub fn find_from(&self, folder: &Path, name: &str) -> Option<PathBuf> {
        if let Some(path) = self.direct(name) {
            return Some(folder.join(path)).filter(|path| readable(path));
        }
        let name = Some(path_of(name)).filter(|_| !name.is_empty())?;
        self.directories.iter().map(|d| folder.join(d).join(&name)).find(|path| readable(path))
    }

    /// The place on disk alone, for files that must be opened by name.
    pub fn find_path(&self, name: &str) -> Option<PathBuf> {
        match self.find(name)? {
            Found::Path(path) => Some(path),
            Found::Embedded(_) => None,
        }
    }

    /// The contents of the file. `action` begins the error, like `cannot find function file`.
    pub fn read(&self, name: &str, action: &'static str) -> Result<Cow<'static, [u8]>, Error> {
        match self.find(name) {
            Some(Found::Embedded(bytes)) => Ok(Cow::Borrowed(bytes)),
            Some(Found::Path(path)) => std::fs::read(path).map(Cow::Owned).map_err(|e| Error::io(action, name, e)),
            None => Err(Error::io(action, name, rustix::io::Errno::NOENT.into())),
        }
    }

    /// The path of a name that is not searched for.
    fn direct(&self, name: &str) -> Option<PathBuf> {
        match name.as_bytes().first()? {
            b'/' | b'.' => Some(path_of(name)),
            b'~' => Some(self.home_path(&name[1..]).unwrap_or_else(|| path_of(name))),
            _ => None,
        }
    }

    /// `/x` is in HOME, `user/x` in that user's home directory.
    fn home_path(&self, rest: &str) -> Option<PathBuf> {
        let (user, below) = rest.split_once('/').unwrap_or((rest, ""));
        let home = if user.is_empty() { self.home.clone()? } else { home_of(user)? };
        Some(home.join(path_of(below)))
    }
}

fn readable(path: &Path) -> bool {
    access(path, Access::READ_OK).is_ok()
}

/// A user's home directory: the sixth field of the line that starts with the name.
fn home_of(user: &str) -> Option<PathBuf> {
    let users = std::fs::read(USERS).ok()?;
    users.split(|&b| b == b'\n').find_map(|line| {
        let mut fields = std::str::from_utf8(line).ok()?.split(':');
        (fields.next()? == user).then(|| fields.nth(4).map(PathBuf::from))?
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn library(name: &str) -> Option<&'static [u8]> {
        (name == "rayinit.cal" || name == "a.cal").then_some(b"built in")
    }

    #[test]
    fn directories_come_before_the_library() {
        let dir = tempfile::tempdir().unwrap();
        let (one, two) = (dir.path().join("one"), dir.path().join("two"));
        std::fs::create_dir_all(one.join("sub")).unwrap();
        std::fs::create_dir_all(&two).unwrap();
        for (path, text) in [(one.join("sub/b.cal"), "sub"), (two.join("a.cal"), "two"), (two.join("c.cal"), "two c")] {
            std::fs::write(path, text).unwrap();
        }
        let path = format!("{}:{}:", one.display(), two.display());
        let search = SearchPath::new(Some(&path), Some(one.to_str().unwrap()), Library::new(library));
        assert_eq!(search.directories.len(), 2);
        let text =
            |name: &str| search.read(name, "cannot find function file").map(|b| String::from_utf8(b.into()).unwrap());
        assert_eq!(text("a.cal").unwrap(), "two");
        assert_eq!(text("sub/b.cal").unwrap(), "sub");
        assert_eq!(text("~/sub/b.cal").unwrap(), "sub");
        assert_eq!(text("rayinit.cal").unwrap(), "built in");
        assert_eq!(search.find_path("rayinit.cal"), None);
        assert_eq!(text(two.join("c.cal").to_str().unwrap()).unwrap(), "two c");
        for missing in ["d.cal", "./a.cal", "/a.cal", "~/a.cal", "~nobody-of-that-name/a.cal", ""] {
            let e = text(missing).unwrap_err().to_string();
            assert_eq!(e, format!("cannot find function file \"{missing}\": No such file or directory"));
        }
    }

    #[test]
    fn empty_components_are_the_working_directory() {
        let directories = |path: Option<&str>| {
            let search = SearchPath::new(path, None, Library::NONE);
            search.directories.iter().map(|d| d.to_str().unwrap().to_owned()).collect::<Vec<_>>()
        };
        assert_eq!(directories(None), ["", "/usr/local/lib/ray"]);
        assert_eq!(directories(Some("a:")), ["a"]);
        assert_eq!(directories(Some("a::b")), ["a", "", "b"]);
        assert_eq!(directories(Some(":")), [""]);
        assert_eq!(directories(Some("")), [""]);
        assert_eq!(directories(Some("a::")), ["a", ""]);
        // Tests run in the crate's folder.
        let found = SearchPath::new(Some(":/no"), None, Library::NONE).find("Cargo.toml");
        assert_eq!(found, Some(Found::Path(PathBuf::from("Cargo.toml"))));
        assert_eq!(SearchPath::new(Some("/no"), None, Library::NONE).find("Cargo.toml"), None);
    }

    #[test]
    fn relative_names_and_directories_are_those_of_the_folder() {
        let folder = Path::new("src/picture");
        let from =
            |path: &str, name: &str| SearchPath::new(Some(path), None, Library::new(library)).find_from(folder, name);
        assert_eq!(from(":/no", "mod.rs"), Some(folder.join("mod.rs")));
        assert_eq!(from("/no:..", "search.rs"), Some(folder.join("../search.rs")));
        assert_eq!(from("/no", "../search.rs"), Some(folder.join("../search.rs")));
        for missing in ["search.rs", "Cargo.toml", "rayinit.cal", ""] {
            assert_eq!(from(":/no", missing), None, "{missing}");
        }
    }

    #[test]
    fn other_users_have_homes() {
        assert_eq!(home_of("root"), Some(PathBuf::from("/root")));
        assert_eq!(home_of("no-such-user"), None);
    }
}
