//! Manifolds of a medial mesh and another shape that parry computes, between their convex parts. It is parry's way
//! from bodies to parts; two parts come back to [`MedialDispatcher`], which asks parry about them at a scale at which
//! its tolerances are small ([`crate::parry::contacts::scaled_contact`]).

use super::dispatcher::MedialDispatcher;
use crate::math::{Pose, Real};
use crate::medial::MedialMesh;
use crate::parry::contacts::scaled_contact;
use parry3d::query::details::{
    NormalConstraints, contact_manifolds_composite_shape_composite_shape,
    contact_manifolds_composite_shape_shape, contact_manifolds_heightfield_composite_shape,
    contact_manifolds_voxels_composite_shape_shapes,
};
use parry3d::query::{
    ContactManifold, ContactManifoldsWorkspace, DefaultQueryDispatcher, PersistentQueryDispatcher,
    Unsupported,
};
use parry3d::shape::{Shape, ShapeType, TypedShape};

/// The manifolds of a mesh, which is body `side` (0 or 1), and another shape. `pos12` is the pose of the second body in
/// the frame of the first.
pub fn write_manifolds<M, C>(
    dispatcher: &MedialDispatcher,
    (mesh, side): (&MedialMesh, usize),
    (other, pos12): (&dyn Shape, &Pose),
    prediction: Real,
    manifolds: &mut Vec<ContactManifold<M, C>>,
    workspace: &mut Option<ContactManifoldsWorkspace>,
) where
    DefaultQueryDispatcher: PersistentQueryDispatcher<M, C>,
    M: Default + Clone + Send + Sync,
    C: Default + Copy + Send + Sync,
{
    let is_second = side == 1;
    // The pose of each in the frame of the other.
    let [other_in_mesh, mesh_in_other] = match side {
        0 => [*pos12, pos12.inverse()],
        _ => [pos12.inverse(), *pos12],
    };
    if let Some(composite) = other.as_composite_shape() {
        let (first, second) = if is_second {
            (composite, mesh as _)
        } else {
            (mesh as _, composite)
        };
        contact_manifolds_composite_shape_composite_shape(
            dispatcher, pos12, first, second, prediction, manifolds, workspace,
        );
        return;
    }
    match other.as_typed_shape() {
        TypedShape::HeightField(field) => contact_manifolds_heightfield_composite_shape(
            dispatcher,
            &mesh_in_other,
            &other_in_mesh,
            field,
            mesh,
            prediction,
            manifolds,
            workspace,
            !is_second,
        ),
        TypedShape::Voxels(_) => {
            let [first, second] = if is_second {
                [other, mesh]
            } else {
                [mesh, other]
            };
            contact_manifolds_voxels_composite_shape_shapes(
                dispatcher, pos12, first, second, prediction, manifolds, workspace,
            );
        }
        _ => contact_manifolds_composite_shape_shape(
            dispatcher,
            &other_in_mesh,
            mesh,
            other,
            prediction,
            manifolds,
            workspace,
            is_second,
        ),
    }
}

/// Whether parry computes the manifold of two convex shapes in closed form, without tolerances.
fn is_closed_form(types: [ShapeType; 2]) -> bool {
    use ShapeType::{Ball, Capsule, Cuboid, HalfSpace, Triangle};
    matches!(
        types,
        [Ball | HalfSpace, _]
            | [_, Ball | HalfSpace]
            | [Capsule, Capsule]
            | [Cuboid, Cuboid | Triangle]
            | [Triangle, Cuboid]
    )
}

/// The manifold of two convex shapes.
pub fn write_manifold<M, C>(
    pos12: &Pose,
    [g1, g2]: [&dyn Shape; 2],
    constraints: [Option<&dyn NormalConstraints>; 2],
    prediction: Real,
    manifold: &mut ContactManifold<M, C>,
) -> Result<(), Unsupported>
where
    DefaultQueryDispatcher: PersistentQueryDispatcher<M, C>,
    M: Default,
    C: Default + Copy,
{
    let maps = [g1, g2].map(|g| g.as_polygonal_feature_map());
    match maps {
        [Some(map1), Some(map2)] if !is_closed_form([g1, g2].map(|g| g.shape_type())) => {
            let bounds = [g1, g2].map(|g| g.compute_local_aabb());
            let (maps, bounds) = ([map1, map2], bounds.each_ref());
            scaled_contact::write_manifold(pos12, maps, bounds, constraints, prediction, manifold);
            Ok(())
        }
        _ => {
            let ([of_g1, of_g2], parry) = (constraints, DefaultQueryDispatcher);
            parry.contact_manifold_convex_convex(pos12, g1, g2, of_g1, of_g2, prediction, manifold)
        }
    }
}
