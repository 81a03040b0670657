//! Whether two colliders have parts that may meet in this step and move fast for how thin they are: only such pairs can
//! pass through each other, and are searched for their first contact.
//!
//! While two primitives overlap, their depth grows no faster than the bodies move against each other in any point of
//! the line between their nearest spheres, of which one lies in both primitives. So what counts is the relative
//! velocity where they are, not that of the bodies' far ends: two bodies that tumble together hardly move against each
//! other where they touch. It is `u(x) = v1 + ω1 × (x − c1) − v2 − ω2 × (x − c2)`, with the centres `c` about which the
//! bodies turn.

use crate::math::tolerance::FEW_OPERATIONS;
use crate::math::{Pose, Real, Vector};
use crate::medial::MedialMesh;
use crate::medial::tree::{Node, NodeKind};
use crate::rapier::view::step_view::{StepCollider, StepView};
use parry3d::bounding_volume::Aabb;
use parry3d::query::NonlinearRigidMotion;

/// Nodes, or pairs of them, that are looked at for one pair of colliders: beyond, fast parts count as near.
/// Larger, and pairs in a thicket of thin parts cost more than the search they may be spared; smaller,
/// and more of them are searched for nothing.
const MAX_NODE_LOOKS: usize = 256;

/// Limits from which a part counts as fast, and up to which one counts as near.
#[derive(Clone, Copy)]
pub struct FastParts {
    /// Seconds in which a fast part moves by its thickness against what it meets.
    pub seconds: Real,
    /// Distance, a length, of the surfaces of two parts at the start, beyond which they do not meet in this step.
    pub reach: Real,
    /// Distance, a length, from which the surfaces of two parts count as in contact.
    pub contact: Real,
}

/// The motions of two colliders against each other from some time of the step on.
struct RelativeMotion {
    motions: [NonlinearRigidMotion; 2],
    /// From the centre about which the first turns to that of the second.
    between: Vector,
    /// Bound, a length per second, on how much the relative velocity in a place that moves with the centre of either
    /// body changes in the rest of the step.
    drift: [Real; 2],
    /// The angles in radians by which both turn in the rest of the step.
    turns: [Real; 2],
    /// Rounding of positions, a length.
    rounding: Real,
}

impl RelativeMotion {
    fn new(motions: [NonlinearRigidMotion; 2], seconds: Real) -> Self {
        let centers = motions.each_ref().map(|m| m.start * m.local_center);
        let slide = motions[1].linvel - motions[0].linvel;
        let drift = [1, 0].map(|other| motions[other].angvel.cross(slide).length() * seconds);
        let size: Real = motions
            .iter()
            .map(|m| m.start.translation.abs().max_element() + m.local_center.length())
            .sum();
        Self {
            motions,
            between: centers[1] - centers[0],
            drift,
            turns: motions.map(|m| m.angvel.length() * seconds),
            rounding: FEW_OPERATIONS * size,
        }
    }

    /// Bound on the relative speed, a length per second, in all places that are within `radius` of a point of one of
    /// the bodies at any time in the rest of the step.
    fn speed_near(&self, side: usize, local: Vector, radius: Real) -> Real {
        let [first, second] = &self.motions;
        let m = &self.motions[side];
        let arm = m.start.rotation * (local - m.local_center);
        let [from_first, from_second] = match side {
            0 => [arm, arm - self.between],
            _ => [arm + self.between, arm],
        };
        let velocity = first.linvel + first.angvel.cross(from_first)
            - second.linvel
            - second.angvel.cross(from_second);
        let spin = (first.angvel - second.angvel).length();
        let around = radius + self.turns[side] * arm.length() + self.rounding;
        velocity.length() + spin * around + self.drift[side]
    }
}

impl FastParts {
    /// Whether there are such parts of two colliders from `time` to `end` (seconds into the step); where that is not
    /// known, it says so too.
    pub fn may_meet(&self, view: &StepView, pair: [usize; 2], [time, end]: [Real; 2]) -> bool {
        let parts = pair.map(|k| &view.colliders[k]);
        let motion = RelativeMotion::new(pair.map(|k| view.motion(k, time)), end - time);
        let reach = self.reach * (1.0 + FEW_OPERATIONS) + motion.rounding;
        let wanted = Self { reach, ..*self };
        match parts.map(StepCollider::medial) {
            [Some(a), Some(b)] => wanted.of_meshes(a, b, &motion),
            [Some(mesh), None] => wanted.of_mesh(mesh, parts[1], &motion, 0),
            [None, Some(mesh)] => wanted.of_mesh(mesh, parts[0], &motion, 1),
            [None, None] => false,
        }
    }

    /// Whether a part of this thickness, which lies in the ball of a node, may be fast.
    fn is_fast(&self, motion: &RelativeMotion, side: usize, node: &Node, thickness: Real) -> bool {
        let speed = motion.speed_near(side, node.center, node.radius + self.contact);
        speed * self.seconds * (1.0 + FEW_OPERATIONS) > thickness
    }

    fn of_meshes(&self, a: &MedialMesh, b: &MedialMesh, motion: &RelativeMotion) -> bool {
        let thickness = [a, b].map(|mesh| &mesh.thicknesses().nodes);
        let (nodes_a, nodes_b) = (a.tree().nodes(), b.tree().nodes());
        let pos12 = motion.motions[0].start.inv_mul(&motion.motions[1].start);
        let mut open = vec![(0, 0)];
        let mut looked = 0;
        while let Some((i, j)) = open.pop() {
            let (p, q) = (&nodes_a[i as usize], &nodes_b[j as usize]);
            let thinner = thickness[0][i as usize].min(thickness[1][j as usize]);
            let apart = p.center.distance(pos12 * q.center) - p.radius - q.radius;
            let (side, smaller) = if p.radius <= q.radius { (0, p) } else { (1, q) };
            if apart > self.reach || !self.is_fast(motion, side, smaller, thinner) {
                continue;
            }
            looked += 1;
            match (p.kind(), q.kind()) {
                _ if looked > MAX_NODE_LOOKS => return true,
                (NodeKind::Primitive(_), NodeKind::Primitive(_)) => return true,
                (NodeKind::Nodes(c, d), NodeKind::Primitive(_)) => open.extend([(c, j), (d, j)]),
                (NodeKind::Primitive(_), NodeKind::Nodes(c, d)) => open.extend([(i, c), (i, d)]),
                (NodeKind::Nodes(c, d), NodeKind::Nodes(..)) if p.radius >= q.radius => {
                    open.extend([(c, j), (d, j)]);
                }
                (NodeKind::Nodes(..), NodeKind::Nodes(c, d)) => open.extend([(i, c), (i, d)]),
            }
        }
        false
    }

    /// Fast parts of a mesh, which is the collider `side` of the pair, near the box of another shape.
    fn of_mesh(
        &self,
        mesh: &MedialMesh,
        other: &StepCollider,
        motion: &RelativeMotion,
        side: usize,
    ) -> bool {
        let aabb = other.shape.compute_local_aabb();
        // The box of a half-space is the whole world.
        let plane = other.shape.as_halfspace();
        let starts = [side, 1 - side].map(|k| &motion.motions[k].start);
        let pos21: Pose = starts[1].inv_mul(starts[0]);
        let nodes = mesh.tree().nodes();
        let mut open = vec![0];
        while let Some(i) = open.pop() {
            let node = &nodes[i as usize];
            let center = pos21 * node.center;
            let apart = match plane {
                Some(plane) => plane.normal.dot(center),
                None => distance(&aabb, center),
            };
            let apart = apart - node.radius;
            let thinner = mesh.thicknesses().nodes[i as usize].min(other.thickness);
            if apart > self.reach || !self.is_fast(motion, side, node, thinner) {
                continue;
            }
            match node.kind() {
                NodeKind::Primitive(_) => return true,
                NodeKind::Nodes(c, d) => open.extend([c, d]),
            }
        }
        false
    }
}

/// Distance of a point from a box, 0 inside.
fn distance(aabb: &Aabb, p: Vector) -> Real {
    (aabb.mins - p)
        .max(p - aabb.maxs)
        .max(Vector::ZERO)
        .length()
}
