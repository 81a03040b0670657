//! The medial mesh of a convex polyhedron: its medial axis itself, which is of flat sheets, with radii linear
//! on each, and so exact.

use super::clip::creased_mesh;
use super::crease_samples::crease_samples;
use super::creases::Creases;
use super::draft::Draft;
use super::fit::rough_target;
use super::simplify::Simplifier;
use super::surface::Surface;
use super::tangent::Faces;
use super::triangle_tree::TriangleTree;
use super::watch::Watch;
use crate::error::BuildError;

/// A medial mesh is exact when it is nowhere farther off than this (longest side 1).
pub const EXACT: f64 = 1e-6;

/// Samples: the first are enough for faces of about the same size and cost half a second, the last for
/// chamfers of a hundredth of the size.
const SAMPLES: [usize; 2] = [1_500, 6_000];

/// The medial axis of a convex polyhedron with edges of more than `angle` (rad), of at most `most`
/// primitives; `None` where the surface is no such polyhedron, or its axis was not found.
pub fn polyhedron(
    surface: &Surface,
    tree: &TriangleTree,
    angle: f64,
    most: usize,
    watch: &mut Watch,
) -> Result<Option<Draft>, BuildError> {
    if !surface.simple || surface.sheet.contains(&true) {
        return Ok(None);
    }
    watch.begin("samples")?;
    let creases = Creases::new(surface, angle, watch)?;
    // Each edge of a face has a slab or more, and each corner ends three edges.
    let least = creases.corners() + creases.corners() / 2;
    if least == 0 || least > most || !creases.is_polyhedron(surface) {
        return Ok(None);
    }
    let faces = Faces {
        surface,
        tree,
        creases: &creases,
    };
    for count in SAMPLES {
        watch.begin("samples")?;
        let (samples, spacing) = crease_samples(surface, tree, &creases, count, watch)?;
        let mesh = creased_mesh(&faces, &samples, spacing, watch)?;
        watch.begin("simplify")?;
        let mut simplifier = Simplifier::creased(mesh, true, tree, watch)?;
        simplifier.reduce_exactly(watch)?;
        let draft = simplifier.draft();
        let exact = rough_target(surface, tree).largest_below(&draft, EXACT, watch)?;
        if exact.is_some() && draft.primitives().len() <= most {
            return Ok(Some(draft));
        }
    }
    Ok(None)
}
