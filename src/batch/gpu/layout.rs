//! The data that the CPU and the shaders exchange. Each struct is written once: a macro makes the Rust type and the
//! WGSL text of it, and a test compares their layouts. Constants for the shaders are generated from Rust too.

use crate::math::lane::Lane;
use crate::math::tolerance;
use crate::math::tolerance::SIMILAR_RADII;
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
    /// One elementary test on straight paths: three corners; a cone pair's fourth follows.
    Query {
        /// Corners at the start, and the radius sum with the distance that counts as contact.
        start: [[f32; 4]; 3] = "array<vec4<f32>, 3>",
        /// Displacement of the corners over the step.
        rate: [[f32; 4]; 3] = "array<vec3<f32>, 3>",
    }
    /// Numbers that hold for a batch of queries.
    ElementaryParams {
        /// How many there are.
        count: u32 = "u32",
        /// Cap of the iterations.
        max_iterations: u32 = "u32",
    }
    /// A node of a mesh's sphere tree, in the body's frame.
    Node {
        /// Centre and radius of its ball.
        bound: [f32; 4] = "vec4<f32>",
        /// Inner: index of the first of two neighbouring children. Leaf: index of its primitive, with
        /// the highest bit set.
        below: u32 = "u32",
        /// Radius of the node's ball once more: whether it is split is asked without its place.
        radius: f32 = "f32",
        /// Nothing.
        pad: [u32; 2] = "vec2<u32>",
    }
    /// A primitive, in the body's frame.
    Primitive {
        /// Spheres of the primitive; unused entries repeat the last.
        spheres: [[f32; 4]; 3] = "array<vec4<f32>, 3>",
    }
    /// One body of a pair.
    Side {
        /// Rows of its placement in the pair's frame at the start.
        start: [[f32; 4]; 3] = "array<vec4<f32>, 3>",
        /// Rows of its placement in the pair's frame at the end.
        end: [[f32; 4]; 3] = "array<vec4<f32>, 3>",
        /// Centre of rotation in the body's frame, and the sagitta per length of lever arm: an eighth
        /// of the squared angle.
        turn: [f32; 4] = "vec4<f32>",
    }
    /// Two bodies over the step, or a piece of it.
    Pair {
        /// Both bodies.
        sides: [Side; 2] = "array<Side, 2>",
        /// Indices of the roots of the meshes' trees.
        roots: [u32; 2] = "vec2<u32>",
        /// Distance that counts as contact, with the slack for rounding.
        reach: f32 = "f32",
        /// 1 where the primitive pairs within reach are to be listed, else 0.
        lists: u32 = "u32",
    }
    /// Numbers that hold for a batch of mesh pairs.
    CullParams {
        /// How many there are.
        pairs: u32 = "u32",
        /// How many meetings there is room for.
        room: u32 = "u32",
        /// How many primitive pairs there is room for on the list.
        near_room: u32 = "u32",
        /// Number of the batch, on every entry of the list.
        stamp: u32 = "u32",
    }
    /// Two primitives that are not proven free.
    Near {
        /// Indices of the two among all primitives.
        primitives: [u32; 2] = "vec2<u32>",
        /// Index of the mesh pair.
        pair: u32 = "u32",
        /// The batch's [`CullParams::stamp`].
        stamp: u32 = "u32",
    }
}

/// A test or a mesh pair that is proven free in the whole step; not 0, which is what no shader has written. For a mesh
/// pair, `FREE + n` says that `n` primitive pairs are not proven free.
pub const FREE: u32 = 1;
/// A test or a mesh pair without a list that is not proven free; or less, by the proofs of other primitive pairs.
pub const OPEN: u32 = 1 << 30;
/// Too much of it meets to be looked at.
pub const GIVEN_UP: u32 = 1 << 31;
/// Threads of a group.
pub const THREADS: usize = 64;
/// Threads of a workgroup that walks down trees. Few, so that the work of a few hundred mesh pairs spreads over more of
/// the device's processors.
pub const WALKS: usize = 8;
/// Texels in a row of the records: with the portable limit of 8,192 rows they hold the portable limit
/// of a binding.
pub const TEXELS: u32 = 1024;
/// Groups in one dimension of a dispatch: the portable limit; wgpu drops what exceeds it.
pub const MAX_GROUPS: u32 = 65_535;

/// Rounds of the search for a direction. Fewer prove less, and nothing wrong.
const GILBERT_ROUNDS: u32 = 6;
/// Pairs of split nodes and primitive pairs that a walk down two trees holds at once. Of primitive pairs it hands on
/// those that it has when that gets too many; a walk with more nodes to split is given up.
pub const WALK_ROOM: u32 = 128;
/// Primitive pairs that a walk finds, about, before it is given up: the CPU has what is that entangled.
pub const WALK_FINDS: u32 = 1024;
/// Node pairs and primitive pairs that a walk takes up before it is given up.
const WALK_LOOKS: u32 = 4096;
/// Node pairs and primitive pairs that a walk for a first contact takes up before it is given up. Fewer than
/// [`WALK_LOOKS`], since the CPU finds first contacts without looking at all that meets, and a part of the CPU's own
/// cap (`MAX_PIECES` in `sweep.rs`).
const FIRST_LOOKS: u32 = 1024;
/// Primitive pairs that a walk for a first contact finds, about, before it is given up.
const FIRST_FINDS: u32 = 128;
/// Node pairs that a walk takes up before it looks whether it is done: less, and the next mesh pair is
/// fetched for one thread at a time; more, and threads that are done wait longer.
const WALK_STRETCH: u32 = 12;
/// Mesh pairs that a thread takes at most: lavapipe ends loops, whatever they do, after 65,535 rounds of
/// all that a thread runs, or that its neighbours run while it waits.
pub const WALK_PAIRS: usize = 4;
const _: () = {
    // Looks, and stretches of them; what it hands on, while neighbours wait, of which each may.
    let handed_on = WALKS as u32 * (WALK_FINDS + 2 * WALK_ROOM);
    let rounds = WALK_LOOKS + 2 * WALK_LOOKS.div_ceil(WALK_STRETCH) + handed_on;
    assert!(WALK_PAIRS as u32 * rounds < 65_535);
};
/// Primitive pairs that a thread proves at most, for the same reason.
pub const PROOFS: usize = 1024;
/// Directions tried in turn, each from where the last proof ends.
const PROOF_ROUNDS: u32 = 6;

/// Most meetings that a batch has room for, 16 bytes each; pairs beyond are given up.
pub const MOST_MEETINGS: usize = 1 << 22;

/// Meetings that a batch has room for, for each mesh pair.
pub const MEETINGS: usize = 256;

/// Primitive pairs that the list of a batch has room for at first, for each mesh pair, and the fewest of all.
pub const LISTED: [usize; 2] = [8, 1 << 10];

/// Texels of a record.
const fn texels<T>() -> u32 {
    assert!(size_of::<T>().is_multiple_of(16));
    size_of::<T>() as u32 / 16
}

/// The constants in WGSL.
pub fn constants() -> String {
    let reals = [
        ("EPSILON", f64::from(f32::EPSILON)),
        ("TINY", <f32 as Lane>::TINY),
        ("HUGE", f64::from(f32::MAX)),
        ("GPU_SLACK_ULPS", tolerance::GPU_SLACK_ULPS),
        ("STEP_ULPS", tolerance::STEP_ULPS),
        ("WALK_SIMILAR", SIMILAR_RADII),
    ];
    let counts = [
        ("FREE", FREE),
        ("OPEN", OPEN),
        ("GIVEN_UP", GIVEN_UP),
        ("THREADS", THREADS as u32),
        ("WALKS", WALKS as u32),
        ("TEXELS", TEXELS),
        ("QUERY", texels::<Query>()),
        ("NODE", texels::<Node>()),
        ("PRIMITIVE", texels::<Primitive>()),
        ("SIDE", texels::<Side>()),
        ("PAIR", texels::<Pair>()),
        ("WALK_ROOM", WALK_ROOM),
        ("WALK_FINDS", WALK_FINDS),
        ("WALK_LOOKS", WALK_LOOKS),
        ("FIRST_LOOKS", FIRST_LOOKS),
        ("FIRST_FINDS", FIRST_FINDS),
        ("WALK_STRETCH", WALK_STRETCH),
        ("WALK_PAIRS", WALK_PAIRS as u32),
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
