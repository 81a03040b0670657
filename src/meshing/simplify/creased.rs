//! Bodies with sharp convex edges: from the surface to a medial mesh that keeps them, as a simplifier.

use crate::error::BuildError;
use crate::meshing::axis::clip::creased_mesh;
use crate::meshing::axis::crease_samples::crease_samples;
use crate::meshing::axis::crease_splits::refine;
use crate::meshing::axis::tangent::Faces;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::simplify::collapse::Simplifier;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::surface::creases::SharpEdges;
use crate::meshing::watch::Watch;

/// A surface of which more than this share of the sharp edges end alone, within a face, is smooth, and they are
/// of its tessellation. Measured at 25°: animals of 6,000 to 30,000 triangles .34 to 1.05, machine parts 0 to .002.
const MOST_ENDS: f64 = 0.1;

/// A medial mesh that runs into creases, and those.
pub struct Creased<'a> {
    /// The medial mesh made from all samples.
    pub simplifier: Simplifier<'a>,
    /// The convex creases.
    pub creases: Vec<[Point; 2]>,
}

/// The medial mesh of a surface with convex edges of more than `angle` (rad), from about `count` samples; `None`
/// where it has none, or where they are of its tessellation.
pub fn creased<'a>(
    surface: &Surface,
    tree: &'a TriangleTree,
    angle: f64,
    count: usize,
    watch: &mut Watch,
) -> Result<Option<Creased<'a>>, BuildError> {
    watch.begin("samples")?;
    let creases = SharpEdges::new(surface, angle, watch)?;
    if creases.convex.is_empty()
        || creases.ends_alone() as f64 > MOST_ENDS * creases.convex.len() as f64
    {
        return Ok(None);
    }
    let faces = Faces {
        surface,
        tree,
        creases: &creases,
    };
    let samples = crease_samples(surface, tree, &creases, count, watch)?;
    let mut mesh = creased_mesh(&faces, &samples, watch)?;
    let spacing = samples.spacing;
    refine(&mut mesh, &faces, spacing, watch)?;
    watch.begin("simplify")?;
    let simplifier = Simplifier::creased(mesh, false, tree, watch)?.touching(spacing);
    let at = |v: u32| surface.vertices[v as usize];
    let segments = creases.convex.iter().map(|edge| edge.vertices.map(at));
    Ok(Some(Creased {
        simplifier,
        creases: segments.collect(),
    }))
}
