//! What host and shaders exchange, each struct written once: the macro gives the Rust type and the
//! WGSL text; a test compares the two layouts. Constants go the same way, from their one home.

use crate::math::lane::Lane;
use crate::math::tolerance;
use bytemuck::{Pod, Zeroable};

/// Offset and size of a field on the host, in bytes.
pub type Field = (&'static str, usize, usize);

/// Layout of one struct on the host: name, size, fields.
pub type Layout = (&'static str, usize, &'static [Field]);

macro_rules! twins {
    ($($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident: $ty:ty = $wgsl:literal,)* })*) => {
        $(
            $(#[$doc])*
            #[repr(C)]
            #[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
            pub struct $name { $($(#[$field_doc])* pub $field: $ty,)* }
        )*
        /// The structs in WGSL.
        pub const STRUCTS: &str = concat!($(
            "struct ", stringify!($name), " { ", $(stringify!($field), ": ", $wgsl, ", ",)* "}\n",
        )*);
        /// The structs on the host.
        pub const LAYOUTS: &[Layout] = &[$((
            stringify!($name),
            size_of::<$name>(),
            &[$((
                stringify!($field),
                std::mem::offset_of!($name, $field),
                size_of::<$ty>(),
            ),)*],
        ),)*];
    };
}

twins! {
    /// One elementary test on straight paths.
    Query {
        /// Corners at the start, and the radius sum with the distance that counts as contact.
        start: [[f32; 4]; 4] = "array<vec4<f32>, 4>",
        /// Their displacement over the step.
        rate: [[f32; 4]; 4] = "array<vec4<f32>, 4>",
    }
    /// What a device proposes for a [`Query`].
    Bound {
        /// No contact before, as a fraction of the step.
        lower: f32 = "f32",
        /// [`SEPARATED`] or [`UNSETTLED`].
        status: u32 = "u32",
        /// Iterations it took.
        iterations: u32 = "u32",
        /// Nothing.
        pad: u32 = "u32",
    }
    /// Of a batch of queries.
    ElementaryParams {
        /// How many there are.
        count: u32 = "u32",
        /// Distance under which a query is left to the CPU.
        tolerance: f32 = "f32",
        /// Cap of the iterations.
        max_iterations: u32 = "u32",
        /// Nothing.
        pad: u32 = "u32",
    }
    /// Up to 64 primitives that follow each other, in the body's frame.
    Cluster {
        /// Centre and radius of a ball round them.
        bound: [f32; 4] = "vec4<f32>",
        /// Index of the first.
        first: u32 = "u32",
        /// How many.
        count: u32 = "u32",
        /// Nothing.
        pad: [u32; 2] = "vec2<u32>",
    }
    /// A primitive, in the body's frame.
    Primitive {
        /// Centre and radius of a ball round it.
        bound: [f32; 4] = "vec4<f32>",
        /// Its spheres; unused entries repeat the last.
        spheres: [[f32; 4]; 3] = "array<vec4<f32>, 3>",
        /// Its index in the mesh.
        index: u32 = "u32",
        /// How many spheres it has.
        count: u32 = "u32",
        /// Nothing.
        pad: [u32; 2] = "vec2<u32>",
    }
    /// One body of a pair.
    Side {
        /// Rows of its placement in the pair's frame at the start.
        start: [[f32; 4]; 3] = "array<vec4<f32>, 3>",
        /// And at the end.
        end: [[f32; 4]; 3] = "array<vec4<f32>, 3>",
        /// Centre of rotation in the body's frame, and the sagitta per length of lever arm: an eighth
        /// of the squared angle.
        turn: [f32; 4] = "vec4<f32>",
        /// Centre and radius of a ball round the mesh, in the body's frame.
        bound: [f32; 4] = "vec4<f32>",
        /// Index of the mesh's first cluster.
        first_cluster: u32 = "u32",
        /// How many it has.
        clusters: u32 = "u32",
        /// Nothing.
        pad: [u32; 2] = "vec2<u32>",
    }
    /// Two bodies over the step, or a piece of it.
    Pair {
        /// Both.
        sides: [Side; 2] = "array<Side, 2>",
        /// Distance that counts as contact, with the slack for rounding.
        reach: f32 = "f32",
        /// Number of its first group in the batch: there is one for each 64 clusters of the first body.
        first: u32 = "u32",
        /// Nothing.
        pad: [u32; 2] = "vec2<u32>",
    }
    /// Two clusters, or two primitives, of a pair.
    Tile {
        /// Index of the pair.
        pair: u32 = "u32",
        /// Of the first mesh.
        a: u32 = "u32",
        /// Of the second mesh.
        b: u32 = "u32",
    }
    /// Two primitives that are not proven free.
    Survivor {
        /// Index of the pair.
        pair: u32 = "u32",
        /// Primitive of the first mesh.
        a: u32 = "u32",
        /// Primitive of the second mesh.
        b: u32 = "u32",
        /// They are free before, as a fraction of the piece on the device, of the step after it.
        lower: f32 = "f32",
    }
    /// Of a batch of mesh pairs.
    CullParams {
        /// How many there are.
        pairs: u32 = "u32",
        /// Groups of all of them.
        groups: u32 = "u32",
        /// Room in the list of cluster pairs.
        tile_capacity: u32 = "u32",
        /// Room in the list of primitive pairs.
        near_capacity: u32 = "u32",
        /// Room in the list of survivors.
        survivor_capacity: u32 = "u32",
    }
}

/// Proven free in the whole step.
pub const SEPARATED: u32 = 0;
/// Left to the CPU.
pub const UNSETTLED: u32 = 1;
/// Counter of cluster pairs.
pub const TILES: usize = 0;
/// Counter of primitive pairs.
pub const NEAR: usize = 1;
/// Counter of survivors.
pub const SURVIVORS: usize = 2;
/// How many counters there are.
pub const COUNTERS: usize = 4;
/// Primitives of a cluster, and threads of a group.
pub const CLUSTER: usize = 64;
/// Groups in one dimension of a dispatch: the portable limit; wgpu drops what exceeds it.
pub const MAX_GROUPS: u32 = 65_535;

/// Rounds of the search for a direction. Fewer leave more survivors, never a wrong proof.
const GILBERT_ROUNDS: u32 = 6;
/// Directions tried in turn, each from where the last proof ends.
const PROOF_ROUNDS: u32 = 6;

/// The constants in WGSL.
pub fn constants() -> String {
    let reals = [
        ("EPSILON", f64::from(f32::EPSILON)),
        ("TINY", <f32 as Lane>::TINY),
        ("HUGE", f64::from(f32::MAX)),
        ("NEVER", tolerance::NEVER),
        ("GPU_SLACK_ULPS", tolerance::GPU_SLACK_ULPS),
        ("TOLERANCE_PER_SLACK", tolerance::TOLERANCE_PER_SLACK),
        ("STEP_ULPS", tolerance::STEP_ULPS),
        ("PARALLEL_ULPS", tolerance::PARALLEL_ULPS),
        ("TURNING_REGULARISATION", tolerance::TURNING_REGULARISATION),
    ];
    let counts = [
        ("SEPARATED", SEPARATED),
        ("UNSETTLED", UNSETTLED),
        ("TILES", TILES as u32),
        ("NEAR", NEAR as u32),
        ("SURVIVORS", SURVIVORS as u32),
        ("MAX_GROUPS", MAX_GROUPS),
        ("GILBERT_ROUNDS", GILBERT_ROUNDS),
        ("PROOF_ROUNDS", PROOF_ROUNDS),
    ];
    // All digits: browsers refuse the shortest ones of the largest number, which are above it.
    let exact = |value: f64| f64::from(value as f32);
    let reals = reals.map(|(name, value)| format!("const {name}: f32 = {:e}f;\n", exact(value)));
    let counts = counts.map(|(name, value)| format!("const {name}: u32 = {value}u;\n"));
    reals.concat() + &counts.concat()
}
