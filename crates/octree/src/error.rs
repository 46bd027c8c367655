//! What may be wrong with an octree or mesh file, or with what is to go into one.

use crate::BuildError;
use ambit_file::os_text;
use ambit_scene::ErrorClass;
use std::io;

/// An octree or mesh that can not be read, built or written. The wording is that of Radiance.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The operating system refused to open or read a file, or to run a command.
    #[error("{action} \"{name}\": {}", os_text(.source))]
    Open {
        /// What was tried, as in `cannot open octree file`.
        action: &'static str,
        /// The file or command as the user named it.
        name: String,
        /// Why it failed.
        source: io::Error,
    },
    /// A file on the search path does not exist.
    #[error("cannot find {what} file \"{name}\": No such file or directory")]
    NotFound {
        /// `octree` or `mesh`.
        what: &'static str,
        /// The name that was looked for.
        name: String,
    },
    /// The contents of a file are not what they should be.
    #[error("({name}): {problem}")]
    Content {
        /// The file or command as the user named it.
        name: String,
        /// What is wrong.
        problem: Problem,
    },
    /// A frozen octree or a mesh ends within an object.
    #[error("unexpected EOF in getobj ({name})")]
    FrozenEnd {
        /// The file or command as the user named it.
        name: String,
    },
    /// A frozen object has a type that nobody knows.
    #[error("reference to unknown type ({name})")]
    UnknownType {
        /// The file or command as the user named it.
        name: String,
    },
    /// The scene or one of its objects.
    #[error(transparent)]
    Scene(#[from] ambit_scene::Error),
    /// An instance or mesh with arguments that make no sense.
    #[error("{problem} for {primitive}")]
    Volume {
        /// What is wrong.
        problem: &'static str,
        /// Type and identifier.
        primitive: String,
    },
    /// The tree could not be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// Some surface is outside the cube that was asked for.
    #[error("boundary does not encompass scene")]
    Outside,
    /// An object has more arguments than a frozen octree can count.
    #[error("too many arguments to freeze {primitive} (at most 32767)")]
    Unfreezable {
        /// Type and identifier.
        primitive: String,
    },
    /// A statement of a Wavefront OBJ file.
    #[error("{name}: Wavefront syntax error near line {line}: {problem}")]
    Obj {
        /// The file.
        name: String,
        /// Its line.
        line: usize,
        /// What is wrong.
        problem: ObjProblem,
    },
    /// A face of a material that is not there.
    #[error("{file}: undefined modifier \"{material}\"")]
    UndefinedMaterial {
        /// The OBJ file.
        file: String,
        /// The name that it uses.
        material: String,
    },
    /// A mesh without a triangle.
    #[error("no polygons in mesh")]
    NoPolygons,
    /// A mesh that can not be made.
    #[error("{0}")]
    Mesh(Problem),
    /// The octree could not be written.
    #[error("output error in writeoct: {}", os_text(.0))]
    Write(#[source] io::Error),
}

/// What is wrong with the contents of a file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// The header is no header, or says that the file is something else.
    #[error("not an octree{0}")]
    NotAnOctree(Instead),
    /// Not the number every octree begins with.
    #[error("incompatible octree format{0}")]
    IncompatibleOctree(Instead),
    /// The file ends too early.
    #[error("truncated octree")]
    TruncatedOctree,
    /// A node is none of the three kinds, or a cube is not finite.
    #[error("damaged octree")]
    DamagedOctree,
    /// A leaf with more objects than one can have.
    #[error("bad set in getfullnode")]
    BadSet,
    /// The scene files have changed.
    #[error("bad object count; octree stale?")]
    BadCount,
    /// The scene files have changed.
    #[error("modifier in tree; octree stale?")]
    ModifierInTree,
    /// The tree names an object that does not exist.
    #[error("tree refers to object {object} of {count}; octree damaged?")]
    StrayObject {
        /// Number in the tree, from 0.
        object: u32,
        /// Number of objects in the file.
        count: usize,
    },
    /// A frozen object is modified by something that is not an earlier modifier.
    #[error("bad modifier {modifier} for {primitive}; expected an earlier modifier")]
    BadModifier {
        /// Number of the modifier in the file.
        modifier: i64,
        /// Type and identifier of the object.
        primitive: String,
    },
    /// A frozen object with a negative number of arguments.
    #[error("negative argument count for {primitive}")]
    NegativeCount {
        /// Type and identifier of the object.
        primitive: String,
    },
    /// More objects than can be numbered.
    #[error("too many objects")]
    TooManyObjects,
    /// Not the number every mesh begins with.
    #[error("incompatible mesh format")]
    IncompatibleMesh,
    /// The file ends too early.
    #[error("truncated mesh file")]
    TruncatedMesh,
    /// A node is none of the three kinds.
    #[error("damaged mesh octree")]
    DamagedMesh,
    /// The cube has no size.
    #[error("illegal octree bounds in mesh")]
    MeshBounds,
    /// Texture coordinates without a range.
    #[error("unreferenced uv coordinates")]
    UnreferencedUv,
    /// Vertices without positions, or with parts nobody knows.
    #[error("bad patch flags")]
    PatchFlags,
    /// A count out of range.
    #[error("bad number of {0}")]
    PatchCount(&'static str),
    /// An index out of range, in a triangle of the kind given first.
    #[error("bad {0} triangle {1}")]
    Triangle(&'static str, &'static str),
    /// A surface among the materials of a mesh.
    #[error("non-modifier in mesh ({0})")]
    NonModifier(String),
    /// More vertices than can be numbered.
    #[error("mesh too large")]
    MeshTooLarge,
}

/// What a file seems to be that should be an octree; prints as an addition to what is wrong.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Instead {
    /// There is not a byte, as where the program failed that should have made it.
    #[error(" (nothing in it)")]
    Nothing,
    /// A directory.
    #[error(" (a directory)")]
    Directory,
    /// Text without a header, as scene files are.
    #[error(" (no header; oconv makes octrees of scene files)")]
    Text,
    /// What its header says it is.
    #[error(" (FORMAT={0})")]
    Format(String),
    /// Nothing that could be told.
    #[error("")]
    Unknown,
}

impl Instead {
    /// What bytes begin like that are not an octree.
    pub(crate) fn of(bytes: &[u8]) -> Self {
        match bytes.first() {
            None => Self::Nothing,
            Some(b' '..=b'~' | b'\t' | b'\r' | b'\n') if !bytes.starts_with(b"#?") => Self::Text,
            Some(_) => Self::Unknown,
        }
    }
}

/// What is wrong with a statement of an OBJ file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ObjProblem {
    /// A position that is not three numbers.
    #[error("bad vertex")]
    Vertex,
    /// A normal that is not three numbers.
    #[error("bad normal")]
    Normal,
    /// A normal without length.
    #[error("zero normal")]
    ZeroNormal,
    /// A face with fewer than three corners.
    #[error("too few vertices")]
    TooFewVertices,
    /// A face of three corners, one of which refers to nothing.
    #[error("bad triangle")]
    Triangle,
    /// A face of more corners, one of which refers to nothing.
    #[error("bad face")]
    Face,
}

impl Problem {
    /// The problem of a file.
    pub(crate) fn of(self, name: &str) -> Error {
        Error::Content { name: name.to_owned(), problem: self }
    }
}

impl Error {
    /// Whose fault it is, which decides on class word and exit status.
    pub fn class(&self) -> ErrorClass {
        match self {
            Self::Open { .. } | Self::NotFound { .. } | Self::FrozenEnd { .. } | Self::Write(_) => ErrorClass::System,
            Self::Build(BuildError::SetOverflow { .. }) => ErrorClass::Internal,
            Self::Scene(e) => e.class(),
            _ => ErrorClass::User,
        }
    }
}
