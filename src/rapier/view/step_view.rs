//! The bodies and colliders of a step that can meet, with their poses before rapier's step and their motions after
//! it: all that the event loop knows of the world.

use crate::math::fast_hash::FastMap;
use crate::math::{Pose, Real, Vector};
use crate::medial::MedialMesh;
use crate::parry::queries::swept_sphere_parts;
use crate::rapier::view::all_joints::for_each_joint;
use crate::rapier::view::link_angles::LinkAngles;
use crate::rapier::view::medial_colliders::Sets;
use crate::rapier::view::motion::{Body, Mobility};
use crate::rapier::view::participants::enabled;
use parry3d::bounding_volume::{Aabb, BoundingSphere, BoundingVolume};
use parry3d::query::NonlinearRigidMotion;
use rapier3d::dynamics::{
    CoefficientCombineRule, GenericJoint, ImpulseJointSet, IntegrationParameters, JointAxesMask,
    Multibody, MultibodyJointSet, MultibodyLink, RigidBodyHandle, RigidBodySet,
};
use rapier3d::geometry::{Collider, ColliderHandle, ColliderSet, SharedShape};

/// Joints that hand an impulse on, the nearest to what is struck. The work goes by them times the square of how many
/// branches they have.
pub const MOST_JOINTS: usize = 128;

/// Turn in a step, in radians, up to which the boxes at both ends, grown by the sagitta, bound it.
const SMALL_TURN: Real = 0.5;

/// A collider as a step sees it: its shape, place, box and thickness.
#[derive(Clone)]
pub struct StepCollider {
    /// Handle of the collider.
    pub handle: ColliderHandle,
    /// Index of its body.
    pub body: usize,
    /// Shape of the collider.
    pub shape: SharedShape,
    /// Pose in the body's frame; in the world's without a body.
    pub offset: Pose,
    /// Box at the start, world frame.
    pub aabb: Aabb,
    /// Sphere round it, in its own frame.
    pub bound: BoundingSphere,
    /// How thin it is, a length: the radius that nearly all of a medial mesh has, or what rapier's
    /// own test of fast bodies goes by. Infinite for surfaces.
    pub thickness: Real,
    /// How thin its thinnest part is.
    pub least: Real,
    /// How far outside its shape it is solid.
    pub skin: Real,
    /// Coefficient of restitution, and how it combines with that of another collider.
    restitution: (Real, CoefficientCombineRule),
}

impl StepCollider {
    /// The medial mesh, if it is one.
    pub fn medial(&self) -> Option<&MedialMesh> {
        self.shape.as_shape::<MedialMesh>()
    }
}

/// All bodies and colliders that can meet a medial one in a step.
#[derive(Clone, Default)]
pub struct StepView {
    /// Bodies; the first stands for no body.
    pub bodies: Vec<Body>,
    /// Colliders that are solid and enabled.
    pub colliders: Vec<StepCollider>,
    /// rapier's length unit.
    pub unit: Real,
    /// Whether the motions are those that rapier's step made.
    pub followed: bool,
    /// Place of each body in `bodies`.
    pub index: FastMap<RigidBodyHandle, usize>,
    /// Whether a collider that does not take part has restitution.
    pub others_bounce: bool,
}

impl StepView {
    /// The world before a step, bodies in the motion that their velocities and forces announce.
    pub fn take(sets: Sets) -> Self {
        let (bodies, joints, multibodies) =
            (sets.bodies, sets.impulse_joints, sets.multibody_joints);
        let mut view = Self {
            bodies: vec![Body::ground()],
            colliders: Vec::new(),
            unit: sets.parameters.length_unit.max(Real::MIN_POSITIVE),
            followed: false,
            index: FastMap::default(),
            others_bounce: sets.participants.is_some_and(|p| p.still().bounce()),
        };
        let add = |view: &mut Self, h: RigidBodyHandle| {
            let body = bodies.get(h)?;
            if let Some(known) = view.index.get(&h) {
                return Some(*known);
            }
            let link = multibodies.rigid_body_link(h);
            let multibody = link.and_then(|l| multibodies.get_multibody(l.multibody));
            let mut new = Body::new(h, body, multibody.is_none_or(gives_way));
            new.predict(body, sets.gravity, sets.parameters.dt);
            let link = link.zip(multibody).and_then(|(l, m)| m.link(l.id));
            new.turned_before = link.map(LinkAngles::of);
            view.bodies.push(new);
            view.index.insert(h, view.bodies.len() - 1);
            Some(view.bodies.len() - 1)
        };
        for (handle, collider) in enabled(bodies, sets.colliders, sets.participants) {
            if collider.is_sensor() {
                continue;
            }
            let index = collider.parent().and_then(|h| add(&mut view, h));
            view.add_part(handle, collider, index.unwrap_or(0));
        }
        // Joints hand impulses on to bodies without colliders too.
        let tied = joints.iter().flat_map(|(_, j)| [j.body1(), j.body2()]);
        let links = multibodies.multibodies().flat_map(|m| m.links());
        for handle in tied.chain(links.map(|l| l.rigid_body_handle())) {
            if let Some(b) = add(&mut view, handle) {
                view.bodies[b].jointed = true;
            }
        }
        for multibody in multibodies.multibodies() {
            let place = |l: &MultibodyLink| view.index.get(&l.rigid_body_handle()).copied();
            let links: Vec<usize> = multibody.links().filter_map(place).collect();
            let turn = |b: &usize| view.bodies[*b].motion.angvel.length();
            let turns = links.iter().map(turn);
            let fastest = turns.fold(0.0, Real::max);
            for b in links {
                view.bodies[b].link_spin = fastest;
            }
        }
        view.find_pivots(joints, multibodies);
        view
    }

    /// Finds the pivots about which joints let bodies turn.
    fn find_pivots(&mut self, joints: &ImpulseJointSet, multibodies: &MultibodyJointSet) {
        let add = |handles: [RigidBodyHandle; 2], joint: &GenericJoint| {
            let [Some(&a), Some(&b)] = handles.map(|h| self.index.get(&h)) else {
                return;
            };
            let held = match [a, b].map(|k| self.bodies[k].mobility) {
                [Mobility::Free, Mobility::Fixed | Mobility::Driven] => (a, joint.local_frame1),
                [Mobility::Fixed | Mobility::Driven, Mobility::Free] => (b, joint.local_frame2),
                _ => return,
            };
            if joint.is_enabled() && joint.locked_axes.contains(JointAxesMask::LIN_AXES) {
                self.bodies[held.0].pivot = Some(held.1.translation);
            }
        };
        for_each_joint(joints, multibodies, add);
    }

    fn add_part(&mut self, handle: ColliderHandle, collider: &Collider, index: usize) {
        let offset = match collider.position_wrt_parent() {
            Some(offset) if index != 0 => *offset,
            _ => *collider.position(),
        };
        let body = &mut self.bodies[index];
        let pose = body.motion.start * offset;
        let shape = collider.shared_shape().clone();
        if !pose.is_finite() {
            return;
        }
        let bound = shape.compute_local_bounding_sphere();
        let arm = offset * bound.center() - body.motion.local_center;
        body.reach = body.reach.max(arm.length() + bound.radius());
        let [thickness, least] = match shape.as_shape::<MedialMesh>() {
            Some(mesh) => [mesh.thickness(), mesh.thicknesses().least()],
            None => [swept_sphere_parts::thickness(&*shape); 2],
        };
        self.colliders.push(StepCollider {
            handle,
            body: index,
            offset,
            aabb: shape.compute_aabb(&pose),
            bound,
            shape,
            thickness,
            least,
            skin: collider.contact_skin(),
            restitution: (collider.restitution(), collider.restitution_combine_rule()),
        });
    }

    /// Replaces the announced motions by those that rapier's step made, of colliders that were in it.
    pub fn follow(
        &mut self,
        parameters: &IntegrationParameters,
        (bodies, colliders): (&RigidBodySet, &ColliderSet),
        multibodies: &MultibodyJointSet,
    ) {
        self.followed = true;
        let enabled = |p: &StepCollider| colliders.get(p.handle).is_some_and(Collider::is_enabled);
        self.colliders.retain(enabled);
        self.find_velocities_by_joints(parameters.dt, bodies, multibodies);
        for body in &mut self.bodies {
            if let Some(b) = body.handle.and_then(|h| bodies.get(h))
                && body.mobility != Mobility::Fixed
            {
                body.moved(b, parameters.num_solver_iterations, parameters.dt);
            }
        }
    }

    /// Copies of bodies and colliders as they were at the start of the step.
    pub fn world_at_start(
        &self,
        bodies: &RigidBodySet,
        colliders: &ColliderSet,
    ) -> (RigidBodySet, ColliderSet) {
        let (mut bodies, mut colliders) = (bodies.clone(), colliders.clone());
        for body in &self.bodies {
            if let Some(b) = body.handle.and_then(|h| bodies.get_mut(h)) {
                b.set_position(body.start, false);
                b.set_linvel(body.velocity_before[0], false);
                b.set_angvel(body.velocity_before[1], false);
            }
        }
        for part in &self.colliders {
            if let Some(collider) = colliders.get_mut(part.handle)
                && part.body != 0
            {
                collider.set_position(self.bodies[part.body].start * part.offset);
            }
        }
        (bodies, colliders)
    }

    /// Motion of a collider from `time` on.
    pub fn motion(&self, part: usize, time: Real) -> NonlinearRigidMotion {
        let part = &self.colliders[part];
        let motion = self.bodies[part.body].motion_from(time);
        NonlinearRigidMotion {
            start: motion.start * part.offset,
            local_center: part.offset.inverse() * motion.local_center,
            ..motion
        }
    }

    /// Pose of a collider at the start of the step.
    pub fn start_pose(&self, part: usize) -> Pose {
        let part = &self.colliders[part];
        self.bodies[part.body].start * part.offset
    }

    /// How thin the thinner of two colliders is as a whole, a length; surfaces do not count.
    pub fn thickness(&self, [i, j]: [usize; 2]) -> Real {
        self.colliders[i].thickness.min(self.colliders[j].thickness)
    }

    /// How thin the thinner of two colliders is where these primitives of theirs are.
    pub fn thickness_at(&self, pair: [usize; 2], primitives: [u32; 2]) -> Real {
        let of = |k: usize| {
            let part = &self.colliders[pair[k]];
            let local = part.medial().map(|mesh| &mesh.thicknesses().primitives);
            let local = local.and_then(|all| all.get(primitives[k] as usize));
            local.copied().unwrap_or(part.thickness)
        };
        of(0).min(of(1))
    }

    /// How thick the thinner of two colliders is that is not medial, a length; infinite where there is
    /// none.
    pub fn foreign_thickness(&self, pair: [usize; 2]) -> Real {
        let parts = pair.map(|k| &self.colliders[k]);
        let foreign = parts.into_iter().filter(|p| p.medial().is_none());
        foreign.map(|p| p.thickness).fold(Real::INFINITY, Real::min)
    }

    /// Whether both are medial meshes of convex pieces (`medial/convex_pieces.rs`), as bodies with flat faces are.
    pub fn are_of_pieces(&self, pair: [usize; 2]) -> bool {
        let medial = pair.map(|k| self.colliders[k].medial());
        medial
            .iter()
            .all(|mesh| mesh.is_some_and(|mesh| !mesh.convex_pieces().is_empty()))
    }

    /// How thin the thinnest collider is as a whole, a length; surfaces do not count.
    pub fn least_thickness(&self) -> Real {
        self.colliders
            .iter()
            .map(|p| p.thickness)
            .fold(Real::INFINITY, Real::min)
    }

    /// How thin the thinnest part of any collider is, a length.
    pub fn thinnest_part(&self) -> Real {
        self.colliders
            .iter()
            .map(|p| p.least)
            .fold(Real::INFINITY, Real::min)
    }

    /// Bound on how far a point of any collider moves in `seconds`.
    pub fn most_travel(&self, seconds: Real) -> Real {
        let speed = |b: &Body| b.motion.linvel.length() + b.motion.angvel.length() * b.reach;
        self.bodies.iter().map(speed).fold(0.0, Real::max) * seconds
    }

    /// Whether a collider of the world has restitution.
    pub fn any_restitution(&self) -> bool {
        self.others_bounce || self.colliders.iter().any(|p| p.restitution.0 > 0.0)
    }

    /// Coefficient of restitution of two colliders, by rapier's combine rules.
    pub fn restitution(&self, pair: [usize; 2]) -> Real {
        let [(a, rule1), (b, rule2)] = pair.map(|k| self.colliders[k].restitution);
        CoefficientCombineRule::combine(a, b, rule1, rule2)
    }

    /// Relative velocity, of the second body of a pair against the first, that gravity and forces of the user add in
    /// the whole step.
    pub fn relative_pull(&self, pair: [usize; 2]) -> Vector {
        let [a, b] = pair.map(|k| self.bodies[self.colliders[k].body].pull());
        b - a
    }

    /// The most that gravity and forces of the user add in the whole step to the speed of a body of the pair.
    pub fn most_pull(&self, pair: [usize; 2]) -> Real {
        let [a, b] = pair.map(|k| self.bodies[self.colliders[k].body].pull().length());
        a.max(b)
    }

    /// Whether something other than contacts may press a pair together: gravity, forces of the user, or a joint, whose
    /// motor or spring acts in the solver only.
    pub fn may_be_pressed(&self, pair: [usize; 2]) -> bool {
        let jointed = pair.map(|k| self.bodies[self.colliders[k].body].jointed);
        self.most_pull(pair) > 0.0 || jointed.contains(&true)
    }

    /// Bound on how far a point of one collider moves relative to the other in `seconds`.
    pub fn travel(&self, [i, j]: [usize; 2], seconds: Real) -> Real {
        let [a, b] = [i, j].map(|k| &self.bodies[self.colliders[k].body]);
        let slide = (a.motion.linvel - b.motion.linvel).length();
        let swing = |body: &Body| body.motion.angvel.length() * body.reach;
        (slide + swing(a) + swing(b)) * seconds
    }

    /// Box that holds a collider from `time` to `end` seconds.
    pub fn swept_aabb(&self, part: usize, time: Real, end: Real) -> Aabb {
        let p = &self.colliders[part];
        let body = &self.bodies[p.body];
        let still = body.motion.linvel == Vector::ZERO && body.motion.angvel == Vector::ZERO;
        if still && body.time == 0.0 {
            return p.aabb;
        }
        let motion = self.motion(part, time);
        let last = motion.position_at_time(end - time);
        let turn = motion.angvel.length() * (end - time);
        let bound = &p.bound;
        // A body carried along by another turns about that one's centre.
        let reach = (bound.center() - motion.local_center).length() + bound.radius();
        if turn <= SMALL_TURN {
            let sagitta = 0.125 * turn * turn * reach;
            let ends = p.shape.compute_aabb(&motion.start);
            return ends.merged(&p.shape.compute_aabb(&last)).loosened(sagitta);
        }
        let center = |pose: &Pose| *pose * motion.local_center;
        let (c0, c1) = (center(&motion.start), center(&last));
        Aabb::new(c0.min(c1), c0.max(c1)).loosened(reach)
    }
}

/// Whether impacts move the links of a multibody: rapier tells the order of the coordinates only where none is
/// driven by the user, couplings between joints are not known here, and an impulse goes through so many joints at most.
fn gives_way(multibody: &Multibody) -> bool {
    let driven = |link: &MultibodyLink| link.joint.kinematic;
    multibody.couplings().is_empty()
        && multibody.num_links() <= MOST_JOINTS
        && !multibody.links().any(driven)
}
