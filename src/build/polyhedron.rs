//! The medial mesh of a convex polyhedron: its medial axis itself, which is of flat sheets, with radii linear
//! on each, and so exact.

use super::clip::creased_mesh;
use super::crease_samples::crease_samples;
use super::creases::Creases;
use super::draft::Draft;
use super::fit::rough_target;
use super::simplify::Simplifier;
use super::subdivide::longest_edge_sq;
use super::surface::Surface;
use super::tangent::Faces;
use super::triangle_tree::TriangleTree;
use super::watch::Watch;
use crate::error::BuildError;

/// A medial mesh is exact when it is nowhere farther off than this (longest side 1).
pub const EXACT: f64 = 1e-6;

/// Height of a slab over its longest edge below which its squared sine is lost in `f32`.
const FLATTEST: f64 = 1e-3;

/// Samples: the first are enough for faces of about the same size and cost half a second, the last for
/// chamfers of a hundredth of the size.
const SAMPLES: [usize; 2] = [1_500, 6_000];

/// More samples are no use where the first give more than this many times the primitives allowed.
const HOPELESS: usize = 4;

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
    // Two faces that share an edge have a sheet between them.
    let least = creases.pairs();
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
        if !simplifier.reduce_exactly(watch)? {
            return Ok(None);
        }
        let draft = simplifier.draft();
        let count = draft.primitives().len();
        if count == 0 || count > most.saturating_mul(HOPELESS) {
            return Ok(None);
        }
        let exact = rough_target(surface, tree).largest_below(&draft, EXACT, watch)?;
        if exact.is_some() && count <= most && !has_needles(&draft) {
            return Ok(Some(draft));
        }
    }
    Ok(None)
}

/// Whether a slab of a size that matters is so flat that queries in `f32` see its edges only.
fn has_needles(draft: &Draft) -> bool {
    draft.faces.iter().any(|face| {
        let [a, b, c] = draft.balls_of(*face).map(|ball| ball.center);
        let longest = longest_edge_sq(&[a, b, c]).sqrt();
        let height = (b - a).cross(c - a).length() / longest.max(f64::MIN_POSITIVE);
        height > EXACT && height < FLATTEST * longest
    })
}
