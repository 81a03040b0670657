//! Writes the poses and velocities that impacts gave to links of multibodies back to rapier. rapier computes them from
//! the coordinates of the joints, so these coordinates are what has to be written.

use super::motion::shortest;
use super::snapshot::Snapshot;
use crate::math::{Pose, Real, Vector};
use rapier3d::dynamics::{
    Multibody, MultibodyJointSet, MultibodyLink, RigidBodyHandle, RigidBodySet,
};

/// Pose, centre of mass in the world, linear and angular velocity of a link.
#[derive(Clone, Copy)]
struct State {
    pose: Pose,
    center: Vector,
    velocity: [Vector; 2],
}

/// Sets all multibodies of which a link changed: `changed` has indices in the snapshot, and whether the velocity did.
pub fn write_back(
    snapshot: &Snapshot,
    changed: &[(usize, bool)],
    bodies: &mut RigidBodySet,
    multibodies: &mut MultibodyJointSet,
) {
    let mut seen = Vec::new();
    for (index, _) in changed {
        let link = snapshot.bodies[*index]
            .handle
            .and_then(|h| multibodies.rigid_body_link(h));
        if let Some(multibody) = link.map(|l| l.multibody)
            && !seen.contains(&multibody)
        {
            seen.push(multibody);
        }
    }
    for multibody in seen {
        if let Some(multibody) = multibodies.get_multibody_mut(multibody) {
            set(snapshot, changed, bodies, multibody);
        }
    }
}

fn set(
    snapshot: &Snapshot,
    changed: &[(usize, bool)],
    bodies: &mut RigidBodySet,
    multibody: &mut Multibody,
) {
    let state = |handle: RigidBodyHandle| {
        let body = &bodies[handle];
        let moved = snapshot.index.get(&handle);
        let moved = moved.and_then(|i| changed.iter().find(|(b, _)| b == i));
        let ours = moved.map(|(b, _)| &snapshot.bodies[*b]);
        let pose = ours.map_or(*body.position(), |b| b.motion.start);
        let struck = ours.filter(|_| moved.is_some_and(|(_, struck)| *struck));
        State {
            pose,
            center: pose * body.mass_properties().local_mprops.local_com,
            velocity: struck.map_or([body.linvel(), body.angvel()], |b| b.velocity),
        }
    };
    let links: Vec<MultibodyLink> = multibody.links().copied().collect();
    let states: Vec<State> = links.iter().map(|l| state(l.rigid_body_handle())).collect();
    if states.iter().any(|s| !s.pose.is_finite()) {
        return;
    }
    let mut moves: Vec<Real> = Vec::new();
    let mut speeds: Vec<Real> = Vec::new();
    for (link, state) in links.iter().zip(&states) {
        let parent = link.parent_id().map(|id| states[id]);
        let [way, speed] = coordinates(link, parent, state);
        moves.extend(way);
        speeds.extend(speed);
    }
    // The pose of the root is read from its body.
    for (link, state) in links.iter().zip(&states).take(1) {
        if let Some(root) = bodies.get_mut(link.rigid_body_handle())
            && root.is_dynamic()
        {
            root.set_position(state.pose, false);
        }
    }
    multibody.apply_displacements(&moves);
    for (own, speed) in multibody.generalized_velocity_mut().iter_mut().zip(speeds) {
        *own = speed;
    }
    multibody.forward_kinematics(bodies, true);
    multibody.update_rigid_bodies(bodies, true);
    for (link, state) in multibody.links().zip(&states) {
        if let Some(body) = bodies.get_mut(link.rigid_body_handle())
            && body.is_dynamic()
        {
            body.set_position(*link.local_to_world(), true);
            body.set_linvel(state.velocity[0], true);
            body.set_angvel(state.velocity[1], true);
        }
    }
}

/// How far a joint's free coordinates are to go from where they are, and their velocities: linear ones first, as
/// rapier orders them. A free root has its world velocities.
fn coordinates(link: &MultibodyLink, parent: Option<State>, own: &State) -> [Vec<Real>; 2] {
    let joint = &link.joint;
    let data = &joint.data;
    let locked = data.locked_axes.bits();
    let (mut way, mut speed) = (Vec::new(), Vec::new());
    let base = parent.map_or(Pose::IDENTITY, |p| p.pose) * data.local_frame1;
    let between = base.inverse() * own.pose * data.local_frame2;
    let [linear, angular] = match parent {
        None => own.velocity,
        Some(p) => {
            let turn = own.velocity[1] - p.velocity[1];
            let arm = own.center - own.pose * data.local_frame2.translation;
            let carried = p.velocity[1].cross(own.center - p.center);
            let slide = own.velocity[0] - p.velocity[0] - carried - turn.cross(arm);
            [slide, turn].map(|v| base.rotation.inverse() * v)
        }
    };
    let coords = joint.coords();
    for i in (0..3).filter(|i| locked & (1 << i) == 0) {
        way.push(between.translation[i] - coords[i]);
        speed.push(linear[i]);
    }
    let turn = shortest(between.rotation * joint.joint_rot().inverse()).to_scaled_axis();
    for i in (0..3).filter(|i| locked & (1 << (i + 3)) == 0) {
        way.push(turn[i]);
        speed.push(angular[i]);
    }
    [way, speed]
}
