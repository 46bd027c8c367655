//! What can be wrong with a scene: one error type, worded as Radiance words it, with the place beside the text.

use ambit_base::Location;
use ambit_file::bytes_of;

/// Whose fault an error is; the tools turn it into the class word and the exit status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorClass {
    /// The input is wrong (`fatal`, exit status 1).
    User,
    /// The operating system refused something (`system`, exit status 2).
    System,
    /// A limit or an impossible state (`internal`, exit status 3).
    Internal,
}

/// An error with its place. `Display` gives Radiance's text alone; [`Error::location`] the file, line and column.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{kind}")]
pub struct Error {
    kind: Box<ErrorKind>,
    location: Location,
}

/// What is wrong.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A file of scene text cannot be read.
    #[error("cannot open scene file \"{file}\": {reason}")]
    CannotOpen {
        /// As the user named it.
        file: String,
        /// The system's words.
        reason: String,
    },
    /// A `!command` cannot be started.
    #[error("cannot execute \"{command}\": {reason}")]
    CannotExecute {
        /// The command with its `!`.
        command: String,
        /// The system's words.
        reason: String,
    },
    /// Reading stopped in the middle of a file or command.
    #[error("({file}): read error: {reason}")]
    ReadFailed {
        /// File or command.
        file: String,
        /// The system's words.
        reason: String,
    },
    /// A tab inside a quoted modifier or identifier.
    #[error("({file}): illegal tab in {part} \"{word}\"")]
    IllegalTab {
        /// File or command.
        file: String,
        /// `modifier` or `identifier`.
        part: &'static str,
        /// The word.
        word: String,
    },
    /// A modifier that was not defined before its use.
    #[error("({file}): undefined modifier \"{word}\"{}", mark(word))]
    UndefinedModifier {
        /// File or command.
        file: String,
        /// The name.
        word: String,
    },
    /// A word that names no primitive type.
    #[error("({file}): unknown type \"{word}\"")]
    UnknownType {
        /// File or command.
        file: String,
        /// The word; empty at the end of the file.
        word: String,
    },
    /// A modifier called `void` or `inherit`.
    #[error("({file}): illegal modifier name \"{word}\"")]
    IllegalModifierName {
        /// File or command.
        file: String,
        /// The name.
        word: String,
    },
    /// A malformed or missing count or argument.
    #[error("({file}): bad arguments for {primitive}")]
    MalformedArguments {
        /// File or command.
        file: String,
        /// `TYPE "identifier"`.
        primitive: String,
    },
    /// An alias to nothing that can be referred to.
    #[error("({file}): bad reference \"{word}\" for {primitive}")]
    BadReference {
        /// File or command.
        file: String,
        /// The reference.
        word: String,
        /// `alias "identifier"`.
        primitive: String,
    },
    /// `inherit` as the modifier of something other than an alias.
    #[error("({file}): inappropriate use of 'inherit' modifier for {primitive}")]
    InappropriateInherit {
        /// File or command.
        file: String,
        /// `TYPE "identifier"`.
        primitive: String,
    },
    /// More text, numbers or objects than the scene's tables can number.
    #[error("({file}): scene too large: {what}")]
    TooLarge {
        /// File or command.
        file: String,
        /// Which table is full.
        what: &'static str,
    },
    /// A well-formed primitive whose arguments make no sense for its type.
    #[error("{problem} for {primitive}")]
    Primitive {
        /// What is wrong with it.
        problem: Problem,
        /// `TYPE "identifier"`.
        primitive: String,
    },
    /// An auxiliary file (data, font) that cannot be read as what it should be.
    #[error("{0}")]
    Auxiliary(AuxiliaryProblem),
}

/// What to say of a word that begins with the mark of an encoding: editors put it before the first word of a file, where
/// nobody sees it.
fn mark(word: &str) -> &'static str {
    let bytes = bytes_of(word);
    if bytes.starts_with(b"\xef\xbb\xbf") {
        " (begins with a byte order mark: save the file as UTF-8 without one)"
    } else if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        " (UTF-16: save the file as UTF-8 without a byte order mark)"
    } else {
        ""
    }
}

/// What is wrong with an auxiliary file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AuxiliaryProblem {
    /// A data file's first number is not 1 … 6.
    #[error("bad number of dimensions for \"{0}\"")]
    Dimensions(String),
    /// A malformed number, count or order of coordinates in a data file.
    #[error("bad format in data file \"{0}\"")]
    DataFormat(String),
    /// A data file ends before its last value.
    #[error("unexpected EOF in data file \"{0}\"")]
    DataEnds(String),
    /// A malformed font file.
    #[error("{0} in font file \"{1}\"")]
    Font(FontProblem, String),
}

/// What is wrong in a font file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FontProblem {
    /// Something other than a number.
    #[error("non-integer")]
    NotInteger,
    /// A character code outside 1 … 255.
    #[error("illegal character ({0})")]
    Character(i32),
    /// A second glyph for a character.
    #[error("duplicate character ({0})")]
    Duplicate(u8),
    /// A missing or impossible number of vertices.
    #[error("bad # vertices for character ({0})")]
    VertexCount(u8),
    /// A missing coordinate, or one outside 0 … 255.
    #[error("bad vertex for character ({0})")]
    Vertex(u8),
}

/// What is wrong with the arguments of a primitive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// Wrong count, in the words of some types.
    #[error("bad arguments")]
    BadArguments,
    /// Wrong count, in the words of others.
    #[error("bad # arguments")]
    BadArgumentCount,
    /// Wrong count, in the words of instance and mesh.
    #[error("bad # of arguments")]
    BadCountOfArguments,
    /// Wrong count, in the words of the plain materials.
    #[error("bad number of arguments")]
    BadNumberOfArguments,
    /// Wrong count of reals, in the words of the anisotropic materials.
    #[error("bad number of real arguments")]
    BadNumberOfRealArguments,
    /// Wrong count of strings, in the words of some function types.
    #[error("too few string arguments")]
    TooFewStrings,
    /// Trailing words that form no transform.
    #[error("bad transform")]
    BadTransform,
    /// A source without direction.
    #[error("zero direction")]
    ZeroDirection,
    /// A source without size.
    #[error("zero size")]
    ZeroSize,
    /// The two motion vectors of a text are parallel.
    #[error("illegal motion vector")]
    IllegalMotion,
    /// Geometry was asked of something that has none of its own.
    #[error("no geometry")]
    NoGeometry,
}

impl Error {
    /// An error of that kind at that place.
    pub fn new(kind: ErrorKind, location: Location) -> Self {
        Self { kind: Box::new(kind), location }
    }

    /// What is wrong.
    pub fn kind(&self) -> &ErrorKind {
        &self.kind
    }

    /// Where: file, line and, for malformed text, the column of the offending word.
    pub fn location(&self) -> &Location {
        &self.location
    }

    /// Whose fault it is.
    pub fn class(&self) -> ErrorClass {
        match *self.kind {
            ErrorKind::CannotOpen { .. } | ErrorKind::CannotExecute { .. } | ErrorKind::ReadFailed { .. } => {
                ErrorClass::System
            }
            ErrorKind::TooLarge { .. } => ErrorClass::Internal,
            _ => ErrorClass::User,
        }
    }
}
