//! Whether two colliders have parts near each other that are thin enough to pass each other in this step. Most
//! bodies are thicker than the way they move in a step, so few pairs are asked this, and most are answered at the
//! root of both trees.

use crate::math::{Pose, Real, Vector};
use crate::medial::MedialMesh;
use crate::medial::tree::NodeKind;
use crate::rapier::view::step_view::{Part, StepView};
use parry3d::bounding_volume::Aabb;

/// Nodes, or pairs of them, that are looked at for one pair of colliders: beyond, thin parts count as near.
/// Larger, and pairs in a thicket of thin parts cost more than the search they may be spared; smaller,
/// and more of them are searched for nothing.
const MOST: usize = 256;

/// Condition that is looked for: parts thinner than `thickness` that are within `reach` of each other, both lengths.
#[derive(Clone, Copy)]
pub struct Thin {
    /// Thickness of the thinner of two parts.
    pub thickness: Real,
    /// Between the surfaces of both.
    pub reach: Real,
}

impl Thin {
    /// Whether there are such parts of two colliders at `time`; where that is not known, it says so too.
    pub fn may_meet(&self, view: &StepView, pair: [usize; 2], time: Real) -> bool {
        let parts = pair.map(|k| &view.parts[k]);
        let least = parts.map(|p| p.least);
        if least[0].min(least[1]) >= self.thickness {
            return false;
        }
        let poses = pair.map(|k| view.motion(k, time).start);
        // Rounding of the positions.
        let size: Real = poses
            .iter()
            .map(|p| p.translation.abs().max_element())
            .sum();
        let reach = self.reach * (1.0 + 16.0 * Real::EPSILON) + 16.0 * Real::EPSILON * size;
        let wanted = Self { reach, ..*self };
        match parts.map(Part::medial) {
            [Some(a), Some(b)] => wanted.of_meshes(a, b, &poses[0].inv_mul(&poses[1])),
            [Some(mesh), None] => wanted.of_mesh(mesh, parts[1], &poses[1].inv_mul(&poses[0])),
            [None, Some(mesh)] => wanted.of_mesh(mesh, parts[0], &poses[0].inv_mul(&poses[1])),
            [None, None] => false,
        }
    }

    fn of_meshes(&self, a: &MedialMesh, b: &MedialMesh, pos12: &Pose) -> bool {
        let thickness = [a, b].map(|mesh| &mesh.thicknesses().nodes);
        let (nodes_a, nodes_b) = (a.tree().nodes(), b.tree().nodes());
        let mut open = vec![(0, 0)];
        let mut looked = 0;
        while let Some((i, j)) = open.pop() {
            let (p, q) = (&nodes_a[i as usize], &nodes_b[j as usize]);
            let thinner = thickness[0][i as usize].min(thickness[1][j as usize]);
            let apart = p.center.distance(pos12 * q.center) - p.radius - q.radius;
            if thinner >= self.thickness || apart > self.reach {
                continue;
            }
            looked += 1;
            match (p.kind(), q.kind()) {
                _ if looked > MOST => return true,
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

    /// Thin parts of a mesh near the box of another shape, which is not thinner; `pos21` is the mesh's
    /// pose in the shape's frame.
    fn of_mesh(&self, mesh: &MedialMesh, other: &Part, pos21: &Pose) -> bool {
        let aabb = other.shape.compute_local_aabb();
        let nodes = mesh.tree().nodes();
        let mut open = vec![0];
        while let Some(i) = open.pop() {
            let node = &nodes[i as usize];
            let apart = distance(&aabb, pos21 * node.center) - node.radius;
            if mesh.thicknesses().nodes[i as usize] >= self.thickness || apart > self.reach {
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
