//! The command-line tools of Ambit live in `src/bin`, one program a file.
