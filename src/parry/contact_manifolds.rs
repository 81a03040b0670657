//! Contact manifolds with medial meshes, as parry asks for them from step to step: the entry. It takes those of two
//! meshes from the batch's answers (`manifolds.rs`), those of a mesh and a flat face from our own code
//! (`flat_face.rs`), and leaves a mesh and any other shape to parry. A muted pair has none.

use super::by_parry;
use super::dispatcher::{MedialDispatcher, medial};
use crate::batch::PairJob;
use crate::math::{Pose, Real, Vector};
use crate::medial::MedialMesh;
use crate::pair::ghost_contacts::{PartContact, ghosts};
use crate::parry::contacts::contact_reduction::{self, Load};
use crate::parry::contacts::convex_parts::{
    ConvexPart, child_reach, part_number, slack, slack_of, slack_of_parts,
};
use crate::parry::contacts::flat_face;
use crate::parry::contacts::manifold_points;
use crate::parry::contacts::manifolds::{self, ensure_workspace, write_one_point};
use crate::parry::contacts::previous_contacts::{self, PreviousContact};
use crate::parry::corrections::deep_pieces;
use crate::parry::corrections::false_contacts;
use crate::parry::corrections::inward_contacts;
use crate::parry::corrections::touching_normals;
use crate::parry::corrections::voxel_normals;
use parry3d::query::details::NormalConstraints;
use parry3d::query::{
    ContactManifold, ContactManifoldsWorkspace, DefaultQueryDispatcher, PersistentQueryDispatcher,
    Unsupported,
};
use parry3d::shape::{Compound, Shape, TypedShape};

impl MedialDispatcher {
    fn count_manifolds(&self, manifolds: usize) {
        self.exchange
            .note(|tally| tally.counts.manifolds += manifolds as u64);
    }

    /// The manifolds of two shapes, of which one at least is medial.
    fn write_manifolds<M, C>(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
        manifolds: &mut Vec<ContactManifold<M, C>>,
        workspace: &mut Option<ContactManifoldsWorkspace>,
    ) -> Result<(), Unsupported>
    where
        DefaultQueryDispatcher: PersistentQueryDispatcher<M, C>,
        M: Default + Clone + Send + Sync,
        C: Default + Copy + Send + Sync,
    {
        let plan = self.exchange.plan();
        if plan.is_muted(g1, g2, pos12) {
            // parry's workspace holds indices into the list that is emptied here.
            *workspace = None;
            ensure_workspace::<M, C>(g1, g2, workspace);
            manifolds.clear();
            return Ok(());
        }
        let meshes = (medial(g1), medial(g2));
        if plan.has_single_point(g1, g2) {
            let deepest = self.deepest(pos12, g1, g2, prediction)?;
            // It, too, holds indices into the list that is emptied here.
            *workspace = None;
            ensure_workspace::<M, C>(g1, g2, workspace);
            write_one_point(deepest, pos12, manifolds);
            self.count_manifolds(manifolds.len());
            return Ok(());
        }
        // Every place where a soft surface touches has a load of its own.
        let soft = |g: &dyn Shape| g.as_composite_shape().is_some_and(|c| c.is_deformable());
        if soft(g1) || soft(g2) {
            return Err(Unsupported);
        }
        // The body that bears the load of the other: of two medial meshes the lighter lies on the heavier. (Masses are
        // known; the volume of a solid would have to be measured first.)
        let weight = |mesh: &MedialMesh| mesh.unit_mass_properties().mass();
        let (side, mesh) = match meshes {
            (Some(mesh1), Some(mesh2)) if weight(mesh1) > weight(mesh2) => (1, mesh2),
            (Some(mesh1), _) => (0, mesh1),
            (None, Some(mesh2)) => (1, mesh2),
            (None, None) => return Err(Unsupported),
        };
        let center = mesh.unit_mass_properties().local_com;
        let center = if side == 0 { center } else { pos12 * center };
        let load = |turn| Load {
            center,
            prediction,
            turn,
        };
        let previous = previous_contacts::previous(manifolds, side);
        let (Some(mesh1), Some(mesh2)) = meshes else {
            let pair = ((mesh, side), pos12, [g1, g2]);
            let load = load(plan.turn(mesh));
            write_with_other(self, pair, &load, &previous, manifolds, workspace);
            return Ok(());
        };
        ensure_workspace::<M, C>(mesh1, mesh2, workspace);
        let meshes = [mesh1, mesh2];
        let job = PairJob::of(meshes, pos12, prediction);
        self.exchange.contacts(job, |found| {
            manifolds::write_manifolds(meshes, found, pos12, prediction, manifolds);
        });
        let load = load(None);
        contact_reduction::choose(manifolds, pos12, &load, &previous, side);
        self.count_manifolds(manifolds.len());
        Ok(())
    }
}

/// The manifolds of a medial mesh and a shape that is not medial.
fn write_with_other<M, C>(
    dispatcher: &MedialDispatcher,
    pair: Pair,
    load: &Load,
    previous: &[PreviousContact<C>],
    manifolds: &mut Vec<ContactManifold<M, C>>,
    workspace: &mut Option<ContactManifoldsWorkspace>,
) where
    DefaultQueryDispatcher: PersistentQueryDispatcher<M, C>,
    M: Default + Clone + Send + Sync,
    C: Default + Copy + Send + Sync,
{
    let (((_, side), pos12, _), prediction) = (pair, load.prediction);
    let continues_previous = write_on_flat(pair, prediction, manifolds, workspace);
    if continues_previous.is_none() {
        write_by_parry(dispatcher, pair, prediction, manifolds, workspace);
    }
    correct(pair, (continues_previous.is_none(), prediction), manifolds);
    if continues_previous != Some(true) {
        previous_contacts::transfer_impulses(manifolds, previous, prediction, side);
    }
    contact_reduction::choose(manifolds, pos12, load, previous, side);
    if continues_previous.is_some() {
        manifolds.retain(|m| !m.points.is_empty());
    }
}

/// Turns or leaves out what is wrong in the contacts of a mesh with another shape, whether they are parry's or not.
fn correct<M, C>(
    ((mesh, side), pos12, [g1, g2]): Pair,
    (is_parrys, prediction): (bool, Real),
    manifolds: &mut [ContactManifold<M, C>],
) where
    M: Default + Clone,
    C: Default + Copy,
{
    let other = [g2, g1][side];
    let pose = [*pos12, pos12.inverse()][side];
    match other.as_typed_shape() {
        TypedShape::TriMesh(_) | TypedShape::HeightField(_) => {
            false_contacts::correct(manifolds, (mesh, side), (other, &pose), prediction);
            inward_contacts::leave_out(manifolds, (mesh, side), (other, &pose), prediction);
            leave_out_ghosts(manifolds, (mesh, side), &pose);
        }
        TypedShape::Voxels(voxels) => {
            voxel_normals::correct(manifolds, (mesh, side), (voxels, &pose), prediction);
            leave_out_ghosts(manifolds, (mesh, side), &pose);
        }
        _ if is_parrys => {
            // First, so that none is turned to the normal of one that it is a ghost of.
            let reach = |part, n| ConvexPart::of(mesh, part).reach(n);
            let slack = slack_of_parts(mesh, (other, &pose));
            leave_out_ghosts_of(manifolds, (side, reach), |child| child, slack);
            touching_normals::correct(manifolds, (mesh, side), (other, &pose), prediction);
            if let TypedShape::Compound(compound) = other.as_typed_shape() {
                leave_out_childrens_ghosts(manifolds, (mesh, side), (compound, &pose));
            }
            deep_pieces::leave_out(manifolds, (mesh, side), (other, &pose));
        }
        _ => {}
    }
}

/// Leaves out ghost contacts of the mesh's parts. The mesh is body `side` of the manifolds, and the other shape at
/// `pose` in its frame.
fn leave_out_ghosts<M, C>(
    manifolds: &mut [ContactManifold<M, C>],
    (mesh, side): (&MedialMesh, usize),
    pose: &Pose,
) {
    let reach = |part, n| ConvexPart::of(mesh, part).reach(n);
    let slack = slack(mesh, pose);
    leave_out_ghosts_of(manifolds, (side, reach), |child| child, |_| slack);
}

/// Leaves out ghost contacts of a compound's children, as [`leave_out_ghosts`] does of the mesh's parts. Call it once
/// normals are corrected: wrong ones hide that neighbours are level.
fn leave_out_childrens_ghosts<M, C>(
    manifolds: &mut [ContactManifold<M, C>],
    (mesh, side): (&MedialMesh, usize),
    (compound, pose): (&Compound, &Pose),
) {
    let reach = |child, n| child_reach(compound, child, n);
    let number = |primitive| part_number(mesh, primitive);
    let of_mesh = slack(mesh, pose);
    let slack = |child| of_mesh + slack_of(compound, child, mesh);
    leave_out_ghosts_of(manifolds, (1 - side, reach), number, slack);
}

/// Leaves out ghost contacts of the parts of body `side`, which reach as far as `reach` tells, up to their `slack`;
/// `number` is that of the other shape's convex part.
fn leave_out_ghosts_of<M, C>(
    manifolds: &mut [ContactManifold<M, C>],
    (side, reach): (usize, impl Fn(u32, Vector) -> Real),
    number: impl Fn(u32) -> u32,
    slack: impl Fn(u32) -> Real,
) {
    let seen = |m: &ContactManifold<M, C>, i: usize| {
        let parts = [m.subshape1, m.subshape2];
        PartContact {
            part: parts[side],
            other: number(parts[1 - side]),
            place: manifold_points::places(m, i)[side],
            normal: manifold_points::normals(m)[side],
            gap: m.points[i].dist,
        }
    };
    let all = manifolds.iter();
    let all = all.flat_map(|m| (0..m.points.len()).map(move |i| seen(m, i)));
    let mut ghosts = ghosts(&all.collect::<Vec<_>>(), reach, slack).into_iter();
    for m in manifolds {
        m.points.retain(|_| ghosts.next() != Some(true));
    }
}

/// A mesh and which of the two shapes it is, the pose of the second shape in the frame of the first, and both shapes.
type Pair<'a> = ((&'a MedialMesh, usize), &'a Pose, [&'a dyn Shape; 2]);

/// The manifolds of a mesh and a shape with a flat face under it, if it has one, and whether they go on from those of
/// the step before: manifolds of parry's have to hand their impulses on.
fn write_on_flat<M, C>(
    ((mesh, side), pos12, [g1, g2]): Pair,
    prediction: Real,
    manifolds: &mut Vec<ContactManifold<M, C>>,
    workspace: &mut Option<ContactManifoldsWorkspace>,
) -> Option<bool>
where
    DefaultQueryDispatcher: PersistentQueryDispatcher<M, C>,
    M: Default + Clone,
    C: Default + Copy,
{
    let (other, pose) = if side == 0 {
        (g2, *pos12)
    } else {
        (g1, pos12.inverse())
    };
    let face = flat_face::face(mesh, other, &pose, prediction)?;
    let continues_previous = flat_face::wrote(manifolds);
    if !continues_previous {
        // parry's workspace holds indices into the list that is written anew here.
        *workspace = None;
    }
    ensure_workspace::<M, C>(g1, g2, workspace);
    flat_face::write_manifolds(mesh, &face, &pose, side, prediction, manifolds);
    Some(continues_previous)
}

/// parry's manifolds of a mesh and another shape. It knows its own again; those of a flat face it would begin anew,
/// without what the user's hooks keep in them.
fn write_by_parry<M, C>(
    dispatcher: &MedialDispatcher,
    ((mesh, side), pos12, [g1, g2]): Pair,
    prediction: Real,
    manifolds: &mut Vec<ContactManifold<M, C>>,
    workspace: &mut Option<ContactManifoldsWorkspace>,
) where
    DefaultQueryDispatcher: PersistentQueryDispatcher<M, C>,
    M: Default + Clone + Send + Sync,
    C: Default + Copy + Send + Sync,
{
    previous_contacts::force_full_update(manifolds);
    let flat = if !manifolds.is_empty() && flat_face::wrote(manifolds) {
        manifolds.clone()
    } else {
        Vec::new()
    };
    let mesh = mesh.with_any_normals();
    let other = ([g2, g1][side], pos12);
    by_parry::write_manifolds(
        dispatcher,
        (&mesh, side),
        other,
        prediction,
        manifolds,
        workspace,
    );
    for manifold in manifolds.iter_mut() {
        let ids = |m: &ContactManifold<M, C>| [m.subshape1, m.subshape2];
        if let Some(before) = flat.iter().find(|m| ids(m) == ids(manifold)) {
            manifold.data = before.data.clone();
        }
    }
}

impl<M, C> PersistentQueryDispatcher<M, C> for MedialDispatcher
where
    DefaultQueryDispatcher: PersistentQueryDispatcher<M, C>,
    M: Default + Clone + Send + Sync,
    C: Default + Copy + Send + Sync,
{
    fn contact_manifolds(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
        manifolds: &mut Vec<ContactManifold<M, C>>,
        workspace: &mut Option<ContactManifoldsWorkspace>,
    ) -> Result<(), Unsupported> {
        if medial(g1).is_none() && medial(g2).is_none() {
            return Err(Unsupported);
        }
        let written = self.write_manifolds(pos12, g1, g2, prediction, manifolds, workspace);
        let points = manifolds.iter().flat_map(|m| &m.points);
        let depth = points.map(|p| -p.dist).fold(0.0, Real::max);
        // The depth of contacts that another dispatcher will write is unknown.
        let depth = written.map_or(Real::MAX, |()| depth);
        self.exchange
            .note(|tally| tally.depth = tally.depth.max(depth));
        if let Some(bodies) = &self.exchange.plan().locked_bodies {
            let side = usize::from(medial(g1).is_none());
            bodies.take_from_solver([g1, g2], side, pos12, manifolds);
        }
        written
    }

    /// parry's manifold of any two convex shapes, at a scale at which its tolerances are small.
    fn contact_manifold_convex_convex(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        constraints1: Option<&dyn NormalConstraints>,
        constraints2: Option<&dyn NormalConstraints>,
        prediction: Real,
        manifold: &mut ContactManifold<M, C>,
    ) -> Result<(), Unsupported> {
        let constraints = [constraints1, constraints2];
        by_parry::write_manifold(pos12, [g1, g2], constraints, prediction, manifold)
    }
}
