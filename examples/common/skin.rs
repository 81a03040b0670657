//! One closed skin over limbs that are chains of spheres.

use super::isosurface::isosurface;
use super::mesh::Mesh;
use super::skeleton::{Bone, Skeleton};
use rapier3d::prelude::{Real, Vector};

/// Where two limbs meet, their surfaces blend over about this length, in metres.
const BLEND: Real = 0.12;

/// A chain of spheres (x, y, z, radius), each joined to the next by a tapered capsule.
pub type Limb = Vec<[Real; 4]>;

/// The skin as a mesh, and the bones under it. `cell`, the side of the grid's cubes in metres, must
/// be under half of the thinnest limb, so that the mesh is manifold.
pub fn skin(limbs: &[Limb], cell: Real) -> (Mesh, Skeleton) {
    let limbs: Vec<Vec<Bone>> = limbs.iter().map(bones_of).collect();
    let skeleton = Skeleton::new(limbs.concat());
    let ends = skeleton.bones().iter().flat_map(|b| b.ends);
    let (low, high) = ends.fold((Vector::ZERO, Vector::ZERO), |(low, high), p| {
        (low.min(p), high.max(p))
    });
    let margin = Vector::splat(0.6);
    let cells = ((high - low + margin * 2.0) / cell).ceil();
    let cells = cells.to_array().map(|n| n as usize);
    let mesh = isosurface(|p| signed_distance(&limbs, p), low - margin, cells, cell);
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
