//! Whole-file fcntl record locks: what Radiance's programs take on ambient files they share. Locks of another kind
//! (flock) would not be seen by them.
//!
//! A process holds one such lock a file, whatever number of descriptors it has: locks exclude processes, not threads,
//! and **closing any descriptor of the file drops the lock**.

use rustix::fs::{FlockOperation, fcntl_lock};
use rustix::io::{Errno, retry_on_intr};
use std::fs::File;
use std::io;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// Who may hold the lock at the same time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LockMode {
    /// Any number of readers; the file must be open for reading.
    Shared,
    /// One writer; the file must be open for writing.
    Exclusive,
}

/// Why a file could not be locked.
#[derive(Debug, thiserror::Error)]
pub enum LockError {
    /// The file system does not have locks, now or ever (`ENOTSUP`, `ENOSYS`, `EINVAL`).
    #[error("record locks are not supported by the file system")]
    Unsupported(#[source] io::Error),
    /// The system has run out of locks, or its lock service does not answer (`ENOLCK`).
    #[error("no record locks available")]
    Unavailable(#[source] io::Error),
    /// Another process holds a lock that waits for one of ours (`EDEADLK`).
    #[error("waiting for the lock would never end")]
    Deadlock(#[source] io::Error),
    /// Anything else.
    #[error("cannot lock: {}", crate::error::os_text(.0))]
    Other(#[source] io::Error),
}

/// A lock on a file, released when dropped.
#[derive(Debug)]
#[must_use = "the lock ends with this value"]
pub struct FileLock<'f> {
    file: &'f File,
}

impl<'f> FileLock<'f> {
    /// Waits until the lock is granted; interruptions by signals do not end the wait.
    pub fn acquire(file: &'f File, mode: LockMode) -> Result<Self, LockError> {
        request(file, operation(mode)).map(|()| Self { file })
    }

    /// Takes the lock if no other process stands in the way; `None` if one does.
    pub fn try_acquire(file: &'f File, mode: LockMode) -> Result<Option<Self>, LockError> {
        let operation = match mode {
            LockMode::Shared => FlockOperation::NonBlockingLockShared,
            LockMode::Exclusive => FlockOperation::NonBlockingLockExclusive,
        };
        match retry_on_intr(|| fcntl_lock(file, operation)) {
            Ok(()) => Ok(Some(Self { file })),
            Err(Errno::AGAIN | Errno::ACCESS) => Ok(None),
            Err(e) => Err(classify(e)),
        }
    }

    /// Releases the lock and tells if that failed, which on network file systems may mean that data was lost.
    pub fn release(self) -> Result<(), LockError> {
        let file = self.file;
        std::mem::forget(self);
        request(file, FlockOperation::Unlock)
    }
}

impl Drop for FileLock<'_> {
    fn drop(&mut self) {
        // Nothing can be done about a failure here; `release` reports it.
        let _ = request(self.file, FlockOperation::Unlock);
    }
}

/// What waits for a lock.
fn operation(mode: LockMode) -> FlockOperation {
    match mode {
        LockMode::Shared => FlockOperation::LockShared,
        LockMode::Exclusive => FlockOperation::LockExclusive,
    }
}

fn request(file: &File, operation: FlockOperation) -> Result<(), LockError> {
    retry_on_intr(|| fcntl_lock(file, operation)).map_err(classify)
}

fn classify(error: Errno) -> LockError {
    let source = io::Error::from(error);
    match error {
        Errno::NOTSUP | Errno::NOSYS | Errno::INVAL => LockError::Unsupported(source),
        Errno::NOLCK => LockError::Unavailable(source),
        Errno::DEADLK => LockError::Deadlock(source),
        _ => LockError::Other(source),
    }
}

/// How a request for a lock stands between the thread that makes it and the one that waits.
#[derive(Debug)]
enum Request {
    Pending,
    Answered(Result<(), LockError>),
    /// Nobody waits any more: a lock granted now is given back.
    Abandoned,
}

impl<'f> FileLock<'f> {
    /// Waits for the lock, but no longer than `patience`; `None` if the time has run out.
    ///
    /// The request is made in a thread of its own: on a network file system whose lock service is gone even requests
    /// that should not wait do. That thread is left behind if it hangs, with the file open; should the lock be granted
    /// after all, it is released at once. Do not ask for locks of this file again after `None`.
    pub fn acquire_within(file: &'f Arc<File>, mode: LockMode, patience: Duration) -> Result<Option<Self>, LockError> {
        let operation = operation(mode);
        Ok(wait_for(file, patience, move |file| request(file, operation))?.map(|()| Self { file }))
    }
}

/// Makes a request in a thread of its own and waits for its end.
fn wait_for(
    file: &Arc<File>,
    patience: Duration,
    ask: impl FnOnce(&File) -> Result<(), LockError> + Send + 'static,
) -> Result<Option<()>, LockError> {
    let state = Arc::new((Mutex::new(Request::Pending), Condvar::new()));
    let (shared, theirs) = (Arc::clone(file), Arc::clone(&state));
    let work = move || {
        let outcome = ask(&shared);
        let mut state = theirs.0.lock().unwrap_or_else(PoisonError::into_inner);
        if matches!(*state, Request::Abandoned) {
            if outcome.is_ok() {
                let _ = request(&shared, FlockOperation::Unlock);
            }
        } else {
            *state = Request::Answered(outcome);
            theirs.1.notify_one();
        }
    };
    thread::Builder::new().name("lock".into()).spawn(work).map_err(LockError::Other)?;
    let guard = state.0.lock().unwrap_or_else(PoisonError::into_inner);
    let waiting = |state: &mut Request| matches!(state, Request::Pending);
    let (mut guard, _) = state.1.wait_timeout_while(guard, patience, waiting).unwrap_or_else(PoisonError::into_inner);
    match std::mem::replace(&mut *guard, Request::Abandoned) {
        Request::Answered(outcome) => outcome.map(Some),
        Request::Pending | Request::Abandoned => Ok(None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::Command;

    const NAME: &str = "AMBIT_LOCK_TEST_FILE";

    /// What another process finds when it tries the locks of the file: this test binary, run again for one test.
    fn seen_by_another_process(path: &std::path::Path) -> String {
        let out = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "lock::tests::try_in_a_child", "--nocapture", "--ignored"])
            .env(NAME, path)
            .output()
            .unwrap();
        let text = String::from_utf8(out.stdout).unwrap();
        text.lines().find_map(|l| Some(l.split_once("locks: ")?.1.to_owned())).expect(&text)
    }

    #[test]
    #[ignore = "run by the other tests in a process of its own"]
    fn try_in_a_child() {
        let Some(path) = std::env::var_os(NAME) else { return };
        let file = File::options().read(true).write(true).open(path).unwrap();
        let free = |mode| FileLock::try_acquire(&file, mode).unwrap().is_some();
        println!("\nlocks: shared {} exclusive {}", free(LockMode::Shared), free(LockMode::Exclusive));
    }

    #[test]
    fn other_processes_are_excluded_until_release() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let lock = FileLock::acquire(file.as_file(), LockMode::Exclusive).unwrap();
        assert_eq!(seen_by_another_process(file.path()), "shared false exclusive false");
        lock.release().unwrap();
        assert_eq!(seen_by_another_process(file.path()), "shared true exclusive true");
        let lock = FileLock::acquire(file.as_file(), LockMode::Shared).unwrap();
        assert_eq!(seen_by_another_process(file.path()), "shared true exclusive false");
        drop(lock);
        assert_eq!(seen_by_another_process(file.path()), "shared true exclusive true");
    }

    #[test]
    fn waiting_ends_with_patience_and_a_late_grant_is_given_back() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let shared = Arc::new(file.reopen().unwrap());
        let lock = FileLock::acquire_within(&shared, LockMode::Exclusive, Duration::from_secs(60)).unwrap();
        assert_eq!(seen_by_another_process(file.path()), "shared false exclusive false");
        drop(lock.expect("nobody else wants it"));
        // A request that hangs, and is granted after all.
        let (go, wait) = std::sync::mpsc::channel::<()>();
        let outcome = wait_for(&shared, Duration::from_millis(50), move |file| {
            let _ = wait.recv();
            request(file, FlockOperation::LockExclusive)
        });
        assert!(matches!(outcome, Ok(None)));
        drop(go);
        while Arc::strong_count(&shared) > 1 {
            thread::sleep(Duration::from_millis(5));
        }
        assert_eq!(seen_by_another_process(file.path()), "shared true exclusive true");
        let refused = wait_for(&shared, Duration::from_secs(60), |_| Err(classify(Errno::NOLCK)));
        assert!(matches!(refused, Err(LockError::Unavailable(_))));
    }

    #[test]
    fn kinds_of_failure_are_told_apart() {
        assert!(matches!(classify(Errno::NOLCK), LockError::Unavailable(_)));
        assert!(matches!(classify(Errno::OPNOTSUPP), LockError::Unsupported(_)));
        // A descriptor that may not write can not hold an exclusive lock.
        let file = tempfile::NamedTempFile::new().unwrap();
        let read_only = File::open(file.path()).unwrap();
        let refused = FileLock::acquire(&read_only, LockMode::Exclusive).unwrap_err();
        assert!(matches!(&refused, LockError::Other(e) if e.raw_os_error() == Some(Errno::BADF.raw_os_error())));
    }
}
