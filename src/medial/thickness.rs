//! How thin a medial mesh is: as a whole, and at each primitive.
//!
//! Whether one body can pass through another depends on how thin they are where they meet: an antenna is
//! thin, even if it stands on something thick. So each primitive has a thickness of its own, and each node of the
//! tree has the smallest thickness below it.

use super::hidden_tips;
use super::simplex::Simplex;
use super::sphere::MedialSphere;
use super::tree::{NodeKind, SphereTree};
use crate::math::{Real, Vector};

/// Way, in units of the radius, in which a blunt tip grows from nothing to that radius: a tip whose radius
/// grows more slowly is slender. What of a blunt tip is thinner than `ρ` reaches `4 ρ` at most, so that
/// what passes it has missed the body; the edges of a box are blunt, and the box is thick. Smaller, and
/// needles count as thick as where they begin; larger, and sharp edges count as sheets.
const BLUNT: Real = 4.0;

/// Thickness of a primitive of one to three spheres, a length: the smallest radius `ρ` for which the part that is
/// thinner than `ρ` extends farther than `4 ρ`, or the largest radius if there is none. It is 0 for a primitive
/// that tapers to radius 0 slowly, or has radius 0 throughout: sheets, fins, needles.
pub fn of_primitive(spheres: &[MedialSphere]) -> Real {
    let radii = spheres.iter().map(|s| s.radius);
    let (least, most) = radii.fold((Real::MAX, 0.0), |(least, most), r| {
        (Real::min(least, r), Real::max(most, r))
    });
    let steep = BLUNT * slope(spheres);
    if steep >= 1.0 || least >= most {
        return most;
    }
    (least / (1.0 - steep)).min(most)
}

/// How fast the radius of a tip has to grow for what it ends to be kept apart by its thickness alone: that of an edge
/// of 60 degrees, across which what is thinner than `ρ` reaches `2 ρ`.
const TIP: Real = 0.49;

/// Whether a primitive has no tips, or none that are sharper than an edge of 60 degrees: nowhere less than half as
/// thick as where it is thickest, or else growing that fast.
pub fn is_blunt(spheres: &[MedialSphere]) -> bool {
    let radii = spheres.iter().map(|s| s.radius);
    let (least, most) = radii.fold((Real::MAX, 0.0), |(least, most), r| {
        (Real::min(least, r), Real::max(most, r))
    });
    2.0 * least >= most || slope(spheres) >= TIP
}

/// How fast the radius grows along the medial axis of a primitive, in lengths per length.
fn slope(spheres: &[MedialSphere]) -> Real {
    let along = |a: &MedialSphere, b: &MedialSphere| {
        let way = a.center.distance(b.center);
        (a.radius - b.radius).abs() / way.max(Real::MIN_POSITIVE)
    };
    match spheres {
        [a, b] => along(a, b),
        [a, b, c] => {
            let (e, f): (Vector, Vector) = (b.center - a.center, c.center - a.center);
            let (de, df) = (b.radius - a.radius, c.radius - a.radius);
            let square = e.cross(f).length_squared();
            if square > 0.0 {
                // The gradient of the radius, whose products with both edges are `de` and `df`.
                (e * df - f * de).length() / square.sqrt()
            } else {
                along(a, b).max(along(b, c)).max(along(c, a))
            }
        }
        _ => 0.0,
    }
}

/// The thickness of each primitive, and the smallest one below each node of the tree.
#[derive(Clone, Debug)]
pub struct Thicknesses {
    /// Thickness of each primitive, a length.
    pub primitives: Vec<Real>,
    /// Smallest thickness below each node, a length.
    pub nodes: Vec<Real>,
}

impl Thicknesses {
    /// The thicknesses of a mesh with these parts. `groups`: its connected parts, if all of them are convex.
    pub(super) fn new(
        spheres: &[MedialSphere],
        simplices: &[Simplex],
        tree: &SphereTree,
        groups: &[Vec<u32>],
    ) -> Self {
        let primitive = |s: &Simplex| {
            let spheres = s.vertices.map(|v| spheres[v as usize]);
            of_primitive(&spheres[..usize::from(s.len).clamp(1, 3)])
        };
        let mut primitives: Vec<Real> = simplices.iter().map(primitive).collect();
        hidden_tips::raise(&mut primitives, spheres, simplices, groups);
        let mut nodes = vec![0.0; tree.nodes().len()];
        // Children come after their parents.
        for (k, node) in tree.nodes().iter().enumerate().rev() {
            nodes[k] = match node.kind() {
                NodeKind::Primitive(p) => primitives[p as usize],
                NodeKind::Nodes(i, j) => Real::min(nodes[i as usize], nodes[j as usize]),
            };
        }
        Self { primitives, nodes }
    }

    /// Smallest thickness of the whole mesh, a length.
    pub fn least(&self) -> Real {
        self.nodes.first().copied().unwrap_or(0.0)
    }
}

/// Weighted 5th percentile of the mean radius of each primitive or, where that is larger, its thickness; see
/// [`super::MedialMesh::thickness`].
pub(super) fn typical(spheres: &[MedialSphere], primitives: &[Simplex]) -> Real {
    let mut local: Vec<(Real, Real)> = primitives
        .iter()
        .map(|p| {
            let [a, b, c] = p.vertices.map(|v| spheres[v as usize]);
            let mean = (a.radius + b.radius + c.radius) / 3.0;
            let (ab, ac): (Vector, Vector) = (b.center - a.center, c.center - a.center);
            // A cone counts as a strip as wide as itself, a lone sphere as its own section.
            let area = match p.len {
                3 => 0.5 * ab.cross(ac).length(),
                2 => ab.length() * (a.radius + b.radius),
                _ => a.radius * a.radius,
            };
            let mean = if p.len == 2 {
                0.5 * (a.radius + b.radius)
            } else {
                mean
            };
            // Blunt tips count as the parts they end, as they do where bodies meet.
            let used = usize::from(p.len).clamp(1, 3);
            (mean.max(of_primitive(&[a, b, c][..used])), area)
        })
        .collect();
    local.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: Real = local.iter().map(|l| l.1).sum();
    let mut passed = 0.0;
    for &(radius, area) in &local {
        passed += area;
        if passed >= 0.05 * total {
            return radius;
        }
    }
    local.last().map_or(0.0, |l| l.0)
}
