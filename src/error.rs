//! Every input that can be refused, with the item and its value, and why a GPU was not used.

use std::path::PathBuf;

/// A set of spheres, edges and faces, or a file of them, that is no medial mesh.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// No sphere at all.
    #[error("a medial mesh needs at least one sphere")]
    Empty,
    /// A coordinate or radius is NaN or infinite.
    #[error("sphere {index} is not finite: center {center:?}, radius {radius}")]
    NotFinite {
        /// Index of the sphere.
        index: usize,
        /// Its centre.
        center: [f32; 3],
        /// Its radius.
        radius: f32,
    },
    /// A sphere ends so far from the origin that squares of lengths would be infinite.
    #[error("sphere {index} reaches beyond {most:e}: center {center:?}, radius {radius}")]
    TooFar {
        /// Index of the sphere.
        index: usize,
        /// Its centre.
        center: [f32; 3],
        /// Its radius.
        radius: f32,
        /// Largest coordinate that a sphere may reach.
        most: f32,
    },
    /// A radius below zero.
    #[error("sphere {index} has negative radius {radius}")]
    NegativeRadius {
        /// Index of the sphere.
        index: usize,
        /// Its radius.
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
    /// All spheres are one point of radius zero.
    #[error("the mesh has no size: all {count} spheres are the point {center:?} of radius 0")]
    ZeroSize {
        /// How many spheres there are.
        count: usize,
        /// Where they are.
        center: [f32; 3],
    },
    /// A length, radius or count given to an exact constructor is out of its range.
    #[error("{what} is {value}, must be {must}")]
    Parameter {
        /// Name of the parameter.
        what: &'static str,
        /// What was given.
        value: f64,
        /// What is accepted.
        must: &'static str,
    },
    /// A polygon that crosses, touches or folds back onto itself.
    #[error("edges {edge} and {other} of the polygon meet")]
    PolygonEdgesMeet {
        /// First corner of one edge.
        edge: usize,
        /// First corner of the other.
        other: usize,
    },
    /// A text file that is not in the `.ma` format.
    #[error("{path}, line {line}: {message}")]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Line number, from 1.
        line: usize,
        /// What is wrong, with the offending text.
        message: String,
    },
    /// A file that is no baked asset, or a damaged one.
    #[error("{path}: {source}")]
    Asset {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: AssetError,
    },
    /// A file that cannot be read or written.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
}

/// Bytes that are no baked medial mesh of the version this crate reads, or a damaged one.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AssetError {
    /// Some other file.
    #[error("not a baked medial mesh: it starts with \"{}\"", start.escape_ascii())]
    NotAnAsset {
        /// Its first bytes, at most 8.
        start: Vec<u8>,
    },
    /// Baked by a crate with another layout.
    #[error(
        "baked in version {found} of the format, this crate reads version {reads}: bake it anew"
    )]
    Version {
        /// Its version.
        found: u32,
        /// The only version read.
        reads: u32,
    },
    /// Cut short, or with something added, or counts that were changed.
    #[error("{found} bytes, but {needed} by its counts")]
    Length {
        /// What its counts ask for.
        needed: u64,
        /// How many bytes there are.
        found: u64,
    },
    /// Changed since it was baked.
    #[error("damaged: checksum {computed:016x}, but {stored:016x} when baked")]
    Damaged {
        /// Checksum of the bytes that are there.
        computed: u64,
        /// Checksum that the file carries.
        stored: u64,
    },
    /// A number that no baking writes.
    #[error("{item} {index} is {value}, must be {must}")]
    Content {
        /// What it belongs to.
        item: &'static str,
        /// Which one of these.
        index: usize,
        /// What was found.
        value: String,
        /// What is accepted.
        must: &'static str,
    },
    /// Spheres, edges and faces that are no medial mesh.
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

/// A triangle mesh, or a file of one, that no medial mesh can be built from.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// No triangle at all.
    #[error("the mesh has no triangles ({vertices} vertices)")]
    Empty {
        /// How many vertices there are.
        vertices: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {index} is not finite: {position:?}")]
    NotFinite {
        /// Index of the vertex.
        index: usize,
        /// Its position.
        position: [f32; 3],
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
    /// The triangles have no area, or the mesh no extent.
    #[error("the mesh has no size: {message}")]
    ZeroSize {
        /// Which measure is zero, with its value.
        message: String,
    },
    /// An option is out of its range.
    #[error("option `{option}` is {value}, must be {must}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// What was given.
        value: f64,
        /// What is accepted.
        must: &'static str,
    },
    /// Nothing of the surface encloses a volume, so no ball lies inside.
    #[error("no inside found: {message}")]
    NoInside {
        /// What was found instead.
        message: String,
    },
    /// The progress callback asked to stop.
    #[error("cancelled during {stage}")]
    Cancelled {
        /// The stage that was running.
        stage: &'static str,
    },
    /// The file's ending names no known format.
    #[error(
        "{path}: unknown mesh format {extension:?} (known: obj, stl, ply, off; glb and gltf with feature `gltf`)"
    )]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// Its ending.
        extension: String,
    },
    /// A file that breaks off or breaks its format's rules.
    #[error("{path}, {location}: {message}")]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Line number or byte offset, as `line 7`.
        location: String,
        /// What is wrong, with the offending text.
        message: String,
    },
    /// A file that cannot be read.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// The result is no medial mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// Why a batch, or part of it, was computed on the CPU. Nothing is lost by any of these.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// The crate was built without feature `gpu`.
    #[error("built without feature `gpu`")]
    NotBuilt,
    /// No loader, no driver, or no adapter.
    #[error("no GPU adapter: {message}")]
    NoAdapter {
        /// What the graphics library says.
        message: String,
    },
    /// The only adapter computes on the CPU, which `Backend::Auto` does better itself.
    #[error("adapter {name} is not a GPU")]
    Software {
        /// Its name.
        name: String,
    },
    /// The adapter gives no device with the portable limits.
    #[error("adapter {name} gives no device: {message}")]
    NoDevice {
        /// Name of the adapter.
        name: String,
        /// What it says.
        message: String,
    },
    /// The device is gone; a new one needs a new batch object.
    #[error("GPU device lost: {message}")]
    Lost {
        /// What the driver says.
        message: String,
    },
    /// No memory on the device.
    #[error("out of GPU memory: {message}")]
    OutOfMemory {
        /// What the driver says.
        message: String,
    },
    /// More than one binding of this device holds.
    #[error("{what} take {bytes} bytes, a binding holds {limit}")]
    TooLarge {
        /// What does not fit.
        what: &'static str,
        /// How much it takes.
        bytes: u64,
        /// How much there is.
        limit: u64,
    },
    /// A call that the device refused.
    #[error("GPU call failed: {message}")]
    Refused {
        /// What it says.
        message: String,
    },
}

/// Why a calibration of the GPU cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CalibrationError {
    /// A line that says nothing known.
    #[error(
        "line {number} of the calibration is `{text}`, not `adapter = NAME`, `jobs = N` or `tests = N`"
    )]
    Line {
        /// Number of the line, from 1.
        number: usize,
        /// The line.
        text: String,
    },
    /// A line that is not there.
    #[error("the calibration has no line `{what} = …`")]
    Missing {
        /// How it would start.
        what: &'static str,
    },
}
