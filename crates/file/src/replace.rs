//! Files that appear whole or not at all: written beside their destination under another name, renamed when complete.

use std::fs::{File, Permissions};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Mode of new files, before the process's umask.
const MODE: u32 = 0o666;

/// A file being written. Dropping it without [`Replacement::commit`] leaves the destination as it was.
///
/// Destinations that are no regular files (devices, pipes) are written directly, since replacing them would be wrong.
#[derive(Debug)]
pub struct Replacement {
    out: BufWriter<Target>,
}

#[derive(Debug)]
enum Target {
    Beside { file: NamedTempFile, destination: PathBuf },
    Direct(File),
}

impl Replacement {
    /// Starts a file that will take the place of `path`. An existing file's mode is kept, symbolic links are followed.
    pub fn create(path: &Path) -> io::Result<Self> {
        let (destination, permissions) = match std::fs::metadata(path) {
            Ok(found) if !found.is_file() => {
                let file = File::options().write(true).open(path)?;
                return Ok(Self { out: BufWriter::new(Target::Direct(file)) });
            }
            Ok(found) => (path.canonicalize()?, Some(found.permissions())),
            Err(e) if e.kind() == io::ErrorKind::NotFound => (path.to_owned(), None),
            Err(e) => return Err(e),
        };
        let folder = match destination.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let mut builder = tempfile::Builder::new();
        let file = builder.prefix(".ambit").permissions(Permissions::from_mode(MODE)).tempfile_in(folder)?;
        if let Some(kept) = permissions {
            file.as_file().set_permissions(kept)?;
        }
        Ok(Self { out: BufWriter::new(Target::Beside { file, destination }) })
    }

    /// Completes the file and puts it in its place.
    pub fn commit(self) -> io::Result<()> {
        match self.out.into_inner().map_err(io::IntoInnerError::into_error)? {
            Target::Direct(_) => Ok(()),
            Target::Beside { file, destination } => {
                // Before the name points to it, so that a crash does not leave an empty file behind the name.
                file.as_file().sync_all()?;
                file.persist(destination).map_err(|e| e.error)?;
                Ok(())
            }
        }
    }
}

impl Target {
    fn file(&mut self) -> &mut File {
        match self {
            Self::Beside { file, .. } => file.as_file_mut(),
            Self::Direct(file) => file,
        }
    }
}

impl Write for Target {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file().flush()
    }
}

impl Seek for Target {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file().seek(to)
    }
}

impl Write for Replacement {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

impl Seek for Replacement {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.out.seek(to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn the_destination_changes_only_when_all_is_written() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.oct");
        let mut new = Replacement::create(&path).unwrap();
        new.write_all(b"first").unwrap();
        assert!(!path.exists());
        new.commit().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"first");
        let mut abandoned = Replacement::create(&path).unwrap();
        abandoned.write_all(b"half").unwrap();
        drop(abandoned);
        assert_eq!(fs::read(&path).unwrap(), b"first");
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
    }

    #[test]
    fn modes_and_links_are_kept() {
        let dir = tempfile::tempdir().unwrap();
        let (path, link) = (dir.path().join("a"), dir.path().join("b"));
        fs::write(&path, "old").unwrap();
        fs::set_permissions(&path, Permissions::from_mode(0o640)).unwrap();
        std::os::unix::fs::symlink(&path, &link).unwrap();
        let mut new = Replacement::create(&link).unwrap();
        new.write_all(b"new").unwrap();
        new.commit().unwrap();
        assert!(link.is_symlink());
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
    }

    #[test]
    fn new_files_have_the_mode_of_any_new_file() {
        let dir = tempfile::tempdir().unwrap();
        let (ours, plain) = (dir.path().join("a"), dir.path().join("b"));
        Replacement::create(&ours).unwrap().commit().unwrap();
        File::create(&plain).unwrap();
        let mode = |p| fs::metadata(p).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }

    #[test]
    fn devices_are_written_not_replaced() {
        let mut null = Replacement::create(Path::new("/dev/null")).unwrap();
        null.write_all(b"gone").unwrap();
        null.commit().unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
        assert!(Replacement::create(Path::new("/no/such/folder/x")).is_err());
    }
}
