//! A spiky creature, half spider and half scorpion: eight legs with raised knees, a crown of
//! spikes on its back, horns, and a tail curled forwards. It stands on the ground y = 0, faces +z
//! and is about 4 m wide.

use super::mesh::Mesh;
use super::skeleton::Skeleton;
use super::skin::{Limb, skin};
use rapier3d::prelude::Real;

/// Side of the grid's cubes, in metres: under half of the thinnest spike, so the mesh is manifold.
const CELL: Real = 0.075;

/// The creature: one closed mesh, and the bones that it grew on.
pub fn creature() -> (Mesh, Skeleton) {
    creature_with_cells(CELL)
}

/// The same with cubes of another side, in metres, at most [`CELL`].
pub fn creature_with_cells(cell: Real) -> (Mesh, Skeleton) {
    skin(&limbs(), cell)
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
