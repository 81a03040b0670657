//! A spiky creature, half spider and half scorpion: eight legs with raised knees, a crown of
//! spikes on its back, horns, and a tail curled forwards. It stands on the ground y = 0, faces +z
//! and is about 4 m wide.

use super::isosurface::isosurface;
use super::mesh::Mesh;
use super::skeleton::{Bone, Skeleton};
use rapier3d::prelude::{Real, Vector};

/// Where two limbs meet, their surfaces blend over about this length, in metres.
const BLEND: Real = 0.12;
/// Side of the grid's cubes, in metres: under half of the thinnest spike, so the mesh is manifold.
const CELL: Real = 0.075;

/// A chain of spheres (x, y, z, radius), each joined to the next by a tapered capsule.
type Limb = Vec<[Real; 4]>;

/// The creature: one closed mesh, and the bones that it grew on.
pub fn creature() -> (Mesh, Skeleton) {
    let limbs: Vec<Vec<Bone>> = limbs().iter().map(bones_of).collect();
    let skeleton = Skeleton::new(limbs.concat());
    let ends = skeleton.bones().iter().flat_map(|b| b.ends);
    let (low, high) = ends.fold((Vector::ZERO, Vector::ZERO), |(low, high), p| {
        (low.min(p), high.max(p))
    });
    let margin = Vector::splat(0.6);
    let cells = ((high - low + margin * 2.0) / CELL).ceil();
    let cells = cells.to_array().map(|n| n as usize);
    let mesh = isosurface(|p| signed_distance(&limbs, p), low - margin, cells, CELL);
    (mesh, skeleton)
}

/// Signed distance to the skin: the limbs' distances, blended where limbs meet.
fn signed_distance(limbs: &[Vec<Bone>], p: Vector) -> Real {
    let of_limb = |limb: &Vec<Bone>| {
        let distances = limb.iter().map(|bone| bone.signed_distance(p));
        distances.fold(Real::MAX, Real::min)
    };
    limbs.iter().map(of_limb).fold(Real::MAX, smooth_min)
}

/// The smaller of two values, rounded off where they differ by less than `BLEND`.
fn smooth_min(a: Real, b: Real) -> Real {
    let near = (1.0 - (a - b).abs() / BLEND).max(0.0);
    a.min(b) - near * near * BLEND / 4.0
}

fn bones_of(limb: &Limb) -> Vec<Bone> {
    let point = |s: &[Real; 4]| Vector::new(s[0], s[1], s[2]);
    let bone = |pair: &[[Real; 4]]| Bone {
        ends: [point(&pair[0]), point(&pair[1])],
        radii: [pair[0][3], pair[1][3]],
    };
    limb.windows(2).map(bone).collect()
}

fn limbs() -> Vec<Limb> {
    // Along the middle: head, chest and abdomen in one, the tail, two spikes on the back.
    let mut limbs = vec![
        vec![
            [0.0, 0.90, 0.88, 0.18],
            [0.0, 0.98, 0.45, 0.29],
            [0.0, 0.98, 0.05, 0.29],
            [0.0, 1.05, -0.50, 0.40],
            [0.0, 1.08, -0.90, 0.30],
        ],
        vec![
            [0.0, 1.10, -1.00, 0.24],
            [0.0, 1.30, -1.55, 0.16],
            [0.0, 1.85, -1.85, 0.13],
            [0.0, 2.28, -1.62, 0.10],
            [0.0, 2.30, -1.28, 0.06],
        ],
        vec![[0.0, 1.20, 0.22, 0.15], [0.0, 2.30, 0.34, 0.06]],
        vec![[0.0, 1.35, -0.62, 0.16], [0.0, 2.35, -0.68, 0.06]],
    ];
    // On either side: horns, claws, four legs, and a tall spike on the first and the last knee.
    for side in [-1.0, 1.0] {
        let mut pair = |limb: &[[Real; 4]]| {
            let mirrored = limb.iter().map(|[x, y, z, r]| [side * x, *y, *z, *r]);
            limbs.push(mirrored.collect());
        };
        pair(&[
            [0.10, 1.00, 0.78, 0.10],
            [0.30, 1.32, 1.02, 0.08],
            [0.36, 1.62, 1.00, 0.05],
        ]);
        pair(&[
            [0.10, 0.82, 0.85, 0.10],
            [0.48, 0.60, 1.30, 0.09],
            [0.26, 0.52, 1.66, 0.06],
        ]);
        for (root, [x, y, z], [foot_x, foot_z]) in [
            (0.48, [1.10, 1.30, 0.98], [1.60, 1.55]),
            (0.20, [1.28, 1.42, 0.28], [2.00, 0.50]),
            (-0.15, [1.28, 1.42, -0.38], [2.00, -0.62]),
            (-0.60, [1.10, 1.30, -1.15], [1.60, -1.80]),
        ] {
            pair(&[
                [0.12, 0.98, root, 0.14],
                [x, y, z, 0.10],
                [foot_x, 0.065, foot_z, 0.065],
            ]);
            if z.abs() > 0.5 {
                pair(&[[x, y, z, 0.11], [1.2 * x, 2.25, 1.15 * z, 0.055]]);
            }
        }
    }
    limbs
}
