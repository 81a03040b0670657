//! A bolt and its nut, with round threads: wires wound on a helix round the y axis, as closed meshes.

use super::isosurface::isosurface;
use super::mesh::Mesh;
use super::skeleton::{Bone, Skeleton};
use rapier3d::prelude::{Real, Vector};
use std::f32::consts::{FRAC_PI_3, PI, TAU};
use std::ops::Range;

/// How far the thread rises in a turn, in metres.
pub const PITCH: Real = 1.2;
/// Half the height of the nut's body, in metres.
pub const NUT_HALF: Real = 1.3;
/// From the ground to the upper side of the bolt's head, and to the bolt's end, in metres.
pub const BOLT: (Real, Real) = (0.8, 7.6);

/// How far a nut of the true shape may be moved along the axis either way, in pitches: to where the
/// wires' centres are 2 · `WIRE` apart.
pub fn play() -> Real {
    let across = HELICES[1] - HELICES[0];
    0.5 - (4.0 * WIRE * WIRE - across * across).sqrt() / PITCH
}

/// Radius of the wires.
const WIRE: Real = 0.25;
/// Radii of the helices that the two wires follow: they overlap by 2 · `WIRE` − 0.3.
const HELICES: [Real; 2] = [1.0, 1.3];
/// Radii of the bolt's core and of the nut's bore.
const CORE: Real = 0.85;
const BORE: Real = 1.48;
/// From the axis to a flat of the hexagons, and the rounding of their edges.
const FLAT: Real = 1.85;
const ROUND: Real = 0.12;
/// Straight pieces in a turn of a helix.
const PIECES: Real = 24.0;
/// Side of the grid's cubes.
const CELL: Real = 0.09;

/// The bolt stands on the ground on its head. Its thread passes (1, 0, 0) at y = 0, were it so long.
pub fn bolt() -> (Mesh, Skeleton) {
    let thread = helix(HELICES[0], 1.3 / PITCH..(BOLT.1 - 0.5) / PITCH, 0.0);
    let core = Bone {
        ends: [Vector::Y * CORE, Vector::Y * (BOLT.1 - CORE)],
        radii: [CORE; 2],
    };
    let middle = BOLT.0 / 2.0;
    let field = |p: Vector| {
        let head = rounded(hexagon(p), (p.y - middle).abs() - middle);
        head.min(core.signed_distance(p)).min(nearest(&thread, p))
    };
    let mesh = meshed(field, -0.2..BOLT.1 + 0.2);
    let bones = [core].into_iter().chain(thread.iter().copied());
    (mesh, Skeleton::new(bones.collect()))
}

/// The nut, its centre at the origin. Its thread runs half a pitch above the bolt's, were the bolt's
/// so long: so it still does after each rise by a pitch with a whole turn to the left.
pub fn nut() -> (Mesh, Skeleton) {
    let half = (NUT_HALF - WIRE) / PITCH;
    let thread = helix(HELICES[1], -half..half, PI);
    let field = |p: Vector| {
        let wall = hexagon(p).max(BORE - p.x.hypot(p.z));
        rounded(wall, p.y.abs() - NUT_HALF).min(nearest(&thread, p))
    };
    let mesh = meshed(field, -NUT_HALF - 0.2..NUT_HALF + 0.2);
    (mesh, Skeleton::new(thread))
}

/// A wire round the y axis over some turns; `ahead` turns it to the left against the rise.
fn helix(radius: Real, turns: Range<Real>, ahead: Real) -> Vec<Bone> {
    let count = ((turns.end - turns.start) * PIECES).ceil();
    let point = |k: usize| {
        let turn = turns.start + (turns.end - turns.start) * k as Real / count;
        let (sin, cos) = (TAU * turn + ahead).sin_cos();
        Vector::new(radius * cos, PITCH * turn, -radius * sin)
    };
    let bone = |k: usize| Bone {
        ends: [point(k), point(k + 1)],
        radii: [WIRE; 2],
    };
    (0..count as usize).map(bone).collect()
}

fn nearest(bones: &[Bone], p: Vector) -> Real {
    let distances = bones.iter().map(|bone| bone.signed_distance(p));
    distances.fold(Real::MAX, Real::min)
}

/// Signed distance to the flats of an upright hexagonal prism.
fn hexagon(p: Vector) -> Real {
    let flat = |k: u8| {
        let (sin, cos) = (FRAC_PI_3 * Real::from(k)).sin_cos();
        (p.x * cos + p.z * sin).abs()
    };
    flat(0).max(flat(1)).max(flat(2)) - FLAT
}

/// What two fields have in common, the edge between them rounded.
fn rounded(a: Real, b: Real) -> Real {
    let (a, b) = (a + ROUND, b + ROUND);
    a.max(0.0).hypot(b.max(0.0)) + a.max(b).min(0.0) - ROUND
}

fn meshed(field: impl Fn(Vector) -> Real, heights: Range<Real>) -> Mesh {
    let reach = FLAT / FRAC_PI_3.sin() + 0.2;
    let low = Vector::new(-reach, heights.start, -reach);
    let size = Vector::new(2.0 * reach, heights.end - heights.start, 2.0 * reach);
    let cells = (size / CELL).ceil().to_array().map(|n| n as usize);
    isosurface(field, low, cells, CELL)
}
