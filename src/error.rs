//! The errors of this crate. Each names the item that was refused and its value.

use std::path::PathBuf;

/// Why spheres, edges and faces, or a file of them, are not a medial mesh. Lengths are in the user's unit.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The mesh has no sphere.
    #[error("a medial mesh needs at least one sphere")]
    Empty,
    /// A coordinate or radius is NaN or infinite.
    #[error("sphere {index} is not finite: center {center:?}, radius {radius}")]
    NotFinite {
        /// Index of the sphere.
        index: usize,
        /// Centre of the sphere.
        center: [f32; 3],
        /// Radius of the sphere.
        radius: f32,
    },
    /// A sphere reaches so far from the origin that the squares of lengths would be infinite.
    #[error("sphere {index} reaches beyond {most:e}: center {center:?}, radius {radius}")]
    TooFar {
        /// Index of the sphere.
        index: usize,
        /// Centre of the sphere.
        center: [f32; 3],
        /// Radius of the sphere.
        radius: f32,
        /// Largest coordinate that a sphere may reach.
        most: f32,
    },
    /// A radius is negative.
    #[error("sphere {index} has negative radius {radius}")]
    NegativeRadius {
        /// Index of the sphere.
        index: usize,
        /// Radius of the sphere.
        radius: f32,
    },
    /// An edge or face names a sphere that is not there.
    #[error("{element} {index} names sphere {value}, but there are {count} spheres")]
    IndexOutOfRange {
        /// `"edge"` or `"face"`.
        element: &'static str,
        /// Index of the edge or face.
        index: usize,
        /// The sphere it names.
        value: u64,
        /// How many spheres there are.
        count: usize,
    },
    /// An edge or face names the same sphere twice.
    #[error("{element} {index} names sphere {value} twice")]
    RepeatedIndex {
        /// `"edge"` or `"face"`.
        element: &'static str,
        /// Index of the edge or face.
        index: usize,
        /// The sphere named twice.
        value: u32,
    },
    /// All spheres are the same point, with radius 0.
    #[error("the mesh has no size: all {count} spheres are the point {center:?} of radius 0")]
    ZeroSize {
        /// How many spheres there are.
        count: usize,
        /// The point, in the user's unit.
        center: [f32; 3],
    },
    /// A length, radius or number given to a constructor of a simple solid is out of its range.
    #[error("{what} is {value}, must be {must}")]
    Parameter {
        /// Name of the parameter.
        what: &'static str,
        /// The value that was given.
        value: f64,
        /// Which values are accepted.
        must: &'static str,
    },
    /// The outline of a polygon crosses, touches or folds back onto itself.
    #[error("edges {edge} and {other} of the polygon meet")]
    PolygonEdgesMeet {
        /// Index of the first corner of one edge.
        edge: usize,
        /// Index of the first corner of the other edge.
        other: usize,
    },
    /// A text file ends early or breaks the rules of the `.ma` format.
    #[error("{path}, line {line}: {message}")]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Line number, from 1.
        line: usize,
        /// Description of the fault, with the offending text.
        message: String,
    },
    /// A file is not a baked medial mesh, or is damaged.
    #[error("{path}: {source}")]
    Asset {
        /// The file.
        path: PathBuf,
        /// Fault of the asset.
        source: AssetError,
    },
    /// A file cannot be read or written.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
}

/// Why bytes cannot be loaded as a baked medial mesh.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AssetError {
    /// The bytes do not begin like a baked mesh.
    #[error("not a baked medial mesh: it starts with \"{}\"", start.escape_ascii())]
    NotAnAsset {
        /// The first bytes, at most 8.
        start: Vec<u8>,
    },
    /// The mesh was baked in another version of the format.
    #[error(
        "baked in version {found} of the format, this crate reads version {reads}: bake it anew"
    )]
    Version {
        /// Version of the bytes.
        found: u32,
        /// The version that this crate reads.
        reads: u32,
    },
    /// The bytes are too few or too many for the numbers of spheres, edges, faces and primitives that they announce.
    #[error("{found} bytes, but {needed} by its counts")]
    Length {
        /// How many bytes are needed.
        needed: u64,
        /// How many bytes there are.
        found: u64,
    },
    /// The bytes were changed since the mesh was baked: the checksum is wrong.
    #[error("damaged: checksum {computed:016x}, but {stored:016x} when baked")]
    Damaged {
        /// Checksum of the bytes that are there.
        computed: u64,
        /// Checksum that was stored when the mesh was baked.
        stored: u64,
    },
    /// The checksum is right, but a number is one that baking never writes.
    #[error("{item} {index} is {value}, must be {must}")]
    Content {
        /// Kind of the item that the number belongs to.
        item: &'static str,
        /// Index of the item among those of its kind.
        index: usize,
        /// The number that was found.
        value: String,
        /// Which numbers are accepted.
        must: &'static str,
    },
    /// The spheres, edges and faces are not a medial mesh.
    #[error(transparent)]
    Mesh(Box<MeshError>),
}

impl AssetError {
    pub(crate) fn content(
        item: &'static str,
        index: usize,
        value: impl ToString,
        must: &'static str,
    ) -> Self {
        Self::Content {
            item,
            index,
            value: value.to_string(),
            must,
        }
    }
}

/// Why no medial mesh can be built from a triangle mesh, or a file of one. Lengths are in the user's unit.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// The mesh has no triangle.
    #[error("the mesh has no triangles ({vertices} vertices)")]
    Empty {
        /// How many vertices there are.
        vertices: usize,
    },
    /// A coordinate of a vertex is NaN or infinite.
    #[error("vertex {index} is not finite: {position:?}")]
    NotFinite {
        /// Index of the vertex.
        index: usize,
        /// Position of the vertex.
        position: [f32; 3],
    },
    /// A vertex that a triangle uses is so far from the origin that the squares of lengths would be infinite.
    #[error("vertex {index} is too far from the origin: {position:?}, must be within {most:e}")]
    TooFar {
        /// Index of the vertex.
        index: usize,
        /// Position of the vertex.
        position: [f32; 3],
        /// Largest coordinate that a vertex may have.
        most: f32,
    },
    /// A triangle names a vertex that is not there.
    #[error("triangle {index} names vertex {value}, but there are {count} vertices")]
    IndexOutOfRange {
        /// Index of the triangle.
        index: usize,
        /// The vertex it names.
        value: u64,
        /// How many vertices there are.
        count: usize,
    },
    /// All triangles lie in one point, or none of them has an area.
    #[error("the mesh has no size: {message}")]
    ZeroSize {
        /// Which of the two, with the values.
        message: String,
    },
    /// An option of the build is out of its range.
    #[error("option `{option}` is {value}, must be {must}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// The value that was given.
        value: f64,
        /// Which values are accepted.
        must: &'static str,
    },
    /// The progress callback returned `Break`.
    #[error("cancelled during {stage}")]
    Cancelled {
        /// The stage that was running.
        stage: &'static str,
    },
    /// The ending of the file's name is that of no known format.
    #[error(
        "{path}: {} (known: obj, stl, ply, off; glb and gltf with feature `gltf`)",
        unknown_format(extension)
    )]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// Ending of the file's name; empty if it has none.
        extension: String,
    },
    /// A file ends early or breaks the rules of its format.
    #[error("{path}, {location}: {message}")]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Line number or byte offset, like `line 7` or `byte 84`.
        location: String,
        /// Description of the fault, with the offending text.
        message: String,
    },
    /// A file cannot be read.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// The result is not a medial mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// Why a batch of pairs, or part of one, was computed on the CPU instead of a GPU. The answers are the same.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// The crate was built without feature `gpu`.
    #[error("built without feature `gpu`")]
    NotBuilt,
    /// No graphics driver was found, or no GPU (adapter).
    #[error("no GPU adapter: {message}")]
    NoAdapter {
        /// The message of the graphics library.
        message: String,
    },
    /// The only adapter is a program on the CPU, which is slower than this crate's own code for the CPU.
    #[error("adapter {name} is not a GPU")]
    Software {
        /// Name of the adapter.
        name: String,
    },
    /// The adapter cannot be opened with the limits that WebGPU guarantees.
    #[error("adapter {name} gives no device: {message}")]
    NoDevice {
        /// Name of the adapter.
        name: String,
        /// Message of the driver.
        message: String,
    },
    /// The GPU was lost (unplugged, reset). To use one again, open a new [`Batch`](crate::batch::Batch).
    #[error("GPU device lost: {message}")]
    Lost {
        /// The message of the driver.
        message: String,
    },
    /// The GPU has not enough memory.
    #[error("out of GPU memory: {message}")]
    OutOfMemory {
        /// The message of the driver.
        message: String,
    },
    /// The data is larger than a buffer of this GPU may be.
    #[error("{what} take {bytes} bytes, a binding holds {limit}")]
    TooLarge {
        /// The data that does not fit.
        what: &'static str,
        /// Size in bytes.
        bytes: u64,
        /// The largest size in bytes.
        limit: u64,
    },
    /// The GPU refused a call.
    #[error("GPU call failed: {message}")]
    Refused {
        /// Message of the driver.
        message: String,
    },
}

/// What is said of a file's name whose ending is that of no known format.
fn unknown_format(extension: &str) -> String {
    match extension {
        "" => "the name has no ending, which would tell the mesh format".into(),
        _ => format!("unknown mesh format {extension:?}"),
    }
}

/// Why a saved calibration of the GPU ([`Calibration`](crate::batch)) cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CalibrationError {
    /// A line is none of those that a calibration has.
    #[error(
        "line {number} of the calibration is `{text}`, not `adapter = NAME`, `jobs = N` or `tests = N`"
    )]
    Line {
        /// Number of the line, from 1.
        number: usize,
        /// Text of the line.
        text: String,
    },
    /// A line is missing.
    #[error("the calibration has no line `{what} = …`")]
    Missing {
        /// How the line would begin.
        what: &'static str,
    },
}
