//! The convex parts between which contacts are computed: of a medial mesh its convex pieces and lone primitives, of
//! another shape itself or, of a compound, its children.

use crate::math::tolerance::HEIGHT_ROUNDING;
use crate::math::{Pose, Real, Vector};
use crate::medial::convex_pieces::ConvexPiece;
use crate::medial::{MedialMesh, MedialPrimitive, MedialSphere};
use parry3d::shape::{Compound, Shape, TypedShape};

/// Tilt of parry's (GJK) normals that is allowed for between a compound's children, a slope. Of rings on tiles one in a
/// hundred is off by more than 6e-5, one in seven thousand by more than 2e-4; what is off by more keeps its ghost.
const TILT: Real = 1.0e-4;

/// Tilt that is allowed for between a mesh's own parts, a slope. Of boxes on slabs parry's normals are off by up to
/// 4e-4 (scenes `medial_floors`).
const TILT_OF_PARTS: Real = 5.0e-4;

/// Bound of the slack that these tilts give, in units of the other body's size: steps that are higher than this are
/// never taken for level.
const MAX_STEP: Real = 1.0e-3;

/// A convex part of a mesh.
pub enum ConvexPart<'a> {
    Piece(&'a ConvexPiece),
    Primitive(MedialPrimitive),
}

impl<'a> ConvexPart<'a> {
    /// The one that a primitive of a mesh belongs to.
    pub fn of(mesh: &'a MedialMesh, primitive: u32) -> Self {
        let pieces = mesh.convex_pieces();
        let piece = pieces.node_of(primitive);
        match piece.and_then(|node| pieces.of_node(node)) {
            Some(piece) => Self::Piece(piece),
            None => Self::Primitive(mesh.primitive(primitive as usize)),
        }
    }

    /// The spheres of whose hull it is.
    fn spheres(&self) -> &[MedialSphere] {
        match self {
            Self::Piece(piece) => &piece.spheres,
            Self::Primitive(primitive) => primitive.spheres(),
        }
    }

    /// How far it reaches along a unit direction, a length.
    pub fn reach(&self, n: Vector) -> Real {
        let heights = self.spheres().iter().map(|s| n.dot(s.center) + s.radius);
        heights.fold(Real::MIN, Real::max)
    }

    /// Outward unit normals of a piece's flat faces; of a lone primitive none.
    pub fn flat_normals(&self) -> impl Iterator<Item = Vector> {
        let faces = match self {
            Self::Piece(piece) => &piece.faces[..],
            Self::Primitive(_) => &[],
        };
        faces.iter().map(|face| face.normal)
    }
}

/// A number of the convex part that a primitive of a mesh belongs to.
pub fn part_number(mesh: &MedialMesh, primitive: u32) -> u32 {
    let node = mesh.convex_pieces().node_of(primitive);
    node.map_or(primitive, |node| mesh.primitive_count() as u32 + node)
}

/// The child of a compound that a subshape of a manifold is, and its pose, or the shape itself.
pub fn child_of<'a>(
    (shape, pose): (&'a dyn Shape, &Pose),
    subshape: u32,
) -> Option<(&'a dyn Shape, Pose)> {
    match shape.as_typed_shape() {
        TypedShape::Compound(compound) => {
            let (own, child) = compound.shapes().get(subshape as usize)?;
            Some((&**child, *pose * *own))
        }
        _ => Some((shape, *pose)),
    }
}

/// How far a child of a compound reaches along a unit direction of the compound's frame, a length; infinitely far where
/// no support map tells.
pub fn child_reach(compound: &Compound, child: u32, n: Vector) -> Real {
    let support = compound.shapes().get(child as usize);
    let support = support.and_then(|(pose, shape)| Some((pose, shape.as_support_map()?)));
    support.map_or(Real::MAX, |(pose, map)| n.dot(map.support_point(pose, n)))
}

/// Slack of heights of a mesh's parts beside another shape, a length, where the other is at `pose` in the mesh's frame
/// and normals are parry's.
pub fn slack_of_parts(
    mesh: &MedialMesh,
    (other, pose): (&dyn Shape, &Pose),
) -> impl Fn(u32) -> Real {
    let low = MAX_STEP * other.compute_local_aabb().extents().max_element();
    let of_all = slack(mesh, pose);
    move |primitive| {
        let part = ConvexPart::of(mesh, primitive);
        let size = |n: Vector| part.reach(n) + part.reach(-n);
        let size = [Vector::X, Vector::Y, Vector::Z].map(size);
        let size = size.into_iter().fold(0.0, Real::max);
        of_all + low.min(TILT_OF_PARTS * size)
    }
}

/// Slack of heights of a compound's child beside a mesh, a length.
pub fn slack_of(compound: &Compound, child: u32, mesh: &MedialMesh) -> Real {
    let bounds = compound.local_aabb();
    let own = compound.aabbs().get(child as usize);
    let size = own.map_or(0.0, |own| own.extents().max_element());
    let low = MAX_STEP * mesh.aabb().extents().max_element();
    low.min(TILT * size) + HEIGHT_ROUNDING * bounds.mins.abs().max(bounds.maxs.abs()).max_element()
}

/// Slack of heights of a mesh's parts, a length, where the other shape is at `pose` in the mesh's frame.
pub fn slack(mesh: &MedialMesh, pose: &Pose) -> Real {
    HEIGHT_ROUNDING * (mesh.aabb().extents().max_element() + pose.translation.abs().max_element())
}

#[cfg(test)]
mod tests {
    use super::*;
    use parry3d::shape::SharedShape;

    #[test]
    fn the_slack_of_a_large_child_is_low_for_the_body_and_is_its_own() {
        let tile = |half: Real| (Pose::IDENTITY, SharedShape::cuboid(half, half, half));
        let compound = Compound::new(vec![tile(500.0), tile(0.1)]);
        let mesh = MedialMesh::ball(0.05).expect("a ball");
        let [floor, step] = [0, 1].map(|child| slack_of(&compound, child, &mesh));
        // Eight ulps of 500 m, and a thousandth of the body.
        assert!((floor - 6.0e-4).abs() < 1.0e-6, "{floor}");
        assert!((step - 5.2e-4).abs() < 1.0e-6, "{step}");
    }
}
