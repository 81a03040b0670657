//! Writes the poses and velocities that impacts gave to links of multibodies back to rapier. rapier computes them from
//! the coordinates of the joints, so these coordinates are what has to be written.

use crate::math::{Pose, Real, Vector};
use crate::rapier::view::link_angles::LinkAngles;
use crate::rapier::view::step_view::StepView;
use rapier3d::dynamics::{Multibody, MultibodyJointSet, MultibodyLink, RigidBodySet};

/// Pose, centre of mass in the world, linear and angular velocity of a link.
#[derive(Clone, Copy)]
struct LinkState {
    pose: Pose,
    center: Vector,
    velocity: [Vector; 2],
    /// Angles from which its own go on.
    turned: LinkAngles,
}

/// Sets all multibodies of which a link changed: `changed` has indices in the view, and whether the velocity did.
pub fn write_back(
    view: &StepView,
    changed: &[(usize, bool)],
    bodies: &mut RigidBodySet,
    multibodies: &mut MultibodyJointSet,
) {
    let mut seen = Vec::new();
    for (index, _) in changed {
        let link = view.bodies[*index]
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
            set(view, changed, bodies, multibody);
        }
    }
}

fn set(
    view: &StepView,
    changed: &[(usize, bool)],
    bodies: &mut RigidBodySet,
    multibody: &mut Multibody,
) {
    let state = |link: &MultibodyLink| {
        let handle = link.rigid_body_handle();
        let body = &bodies[handle];
        let place = view.index.get(&handle);
        let moved = place.and_then(|i| changed.iter().find(|(b, _)| b == i));
        let ours = moved.map(|(b, _)| &view.bodies[*b]);
        let pose = ours.map_or(*body.position(), |b| b.motion.start);
        let by_joints = place.and_then(|i| view.bodies[*i].by_joints);
        let struck = ours.filter(|_| moved.is_some_and(|(_, struck)| *struck));
        LinkState {
            pose,
            center: pose * body.mass_properties().local_mprops.local_com,
            velocity: match (struck, by_joints) {
                (Some(body), _) => body.velocity,
                (None, Some(velocity)) => velocity,
                (None, None) => [body.linvel(), body.angvel()],
            },
            turned: ours.map_or_else(|| LinkAngles::of(link), |b| b.turned(link)),
        }
    };
    let links: Vec<MultibodyLink> = multibody.links().copied().collect();
    let states: Vec<LinkState> = links.iter().map(state).collect();
    if states.iter().any(|s| !s.pose.is_finite()) {
        return;
    }
    let mut moves: [Vec<Real>; 3] = Default::default();
    let mut speeds: Vec<Real> = Vec::new();
    for (link, state) in links.iter().zip(&states) {
        let parent = link.parent_id().map(|id| states[id]);
        let (ways, speed) = coordinates(link, parent, state);
        for (moves, way) in moves.iter_mut().zip(ways) {
            moves.extend(way);
        }
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
    for moves in moves.iter().filter(|m| m.iter().any(|x| *x != 0.0)) {
        multibody.apply_displacements(moves);
    }
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

/// How far a joint's free coordinates are to go from where they are, one after the other, and their velocities: linear
/// ones first, as rapier orders them. A free root has its world velocities.
fn coordinates(
    link: &MultibodyLink,
    parent: Option<LinkState>,
    own: &LinkState,
) -> ([Vec<Real>; 3], Vec<Real>) {
    let joint = &link.joint;
    let data = &joint.data;
    let locked = data.locked_axes.bits();
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
    let free = |from: usize| (0..3).filter(move |i| locked & (1 << (i + from)) == 0);
    let coords = joint.coords();
    let mut ways: [Vec<Real>; 3] = Default::default();
    for i in free(0) {
        // Back to zero first: so it ends exactly where it is to go, however far rapier's step took it.
        let [first, second, last] = &mut ways;
        first.push(-coords[i]);
        second.push(0.0);
        last.push(between.translation[i]);
    }
    let mut turns = free(3);
    let hinge = turns.next().filter(|_| turns.next().is_none());
    let now = LinkAngles::of(link);
    let turns = own.turned.displacements_to(&now, between.rotation, hinge);
    for (way, turn) in ways.iter_mut().zip(turns) {
        way.extend(free(3).map(|i| turn[i]));
    }
    let speed = free(0).map(|i| linear[i]);
    (ways, speed.chain(free(3).map(|i| angular[i])).collect())
}
