//! The medial mesh of a convex polyhedron: its medial axis itself, which is of flat sheets, with radii linear
//! on each, and so exact.
//!
//! The axis is that of the roof over the body (`roof.rs`, `flat_axis.rs`). How short an edge of the roof must be to
//! count as a point is tried, from long to short, until what comes out is exact.

use crate::error::BuildError;
use crate::math::Real;
use crate::meshing::axis::flat_axis::{Axis, ConvexBody};
use crate::meshing::axis::roof::{FIRST, GROUND, roof};
use crate::meshing::draft::Draft;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::geometry::convex::Plane;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::options::{BuildLimits, Hausdorff, Variant};
use crate::meshing::recipe::candidate::Candidate;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::surface::flat_faces::{FLAT, FlatFaces, convex_faces};
use crate::meshing::watch::Watch;

/// Distance (longest side 1) by which a medial mesh that counts as exact may be off anywhere.
pub const EXACT: f64 = 1e-6;

/// Part of [`EXACT`] that the construction may use up (longest side 1); the rest is for the rounding of balls to `f32`.
const EXACT_HERE: f64 = 0.6 * EXACT;

/// Corners of the roof this near are one (longest side 1): tried in order.
const MERGE_DISTANCES: [f64; 7] = [1e-5, 3e-6, 1e-6, 3e-7, 1e-7, 1e-9, 0.0];

/// Orders in which the roof is cut, should rounding spoil it.
const SEEDS: u64 = 4;

/// Corners of the roof for each primitive allowed, at most: boxes and random hulls have .5 to .7.
const CORNERS_PER_PRIMITIVE: usize = 8;

/// The source's triangles and the faces have the same area but for this share, by rounding.
pub const SAME_AREA: f64 = 1e-5;

/// Primitives at most, where no fewer are asked for: faces are compared each with each.
pub const MAX_PRIMITIVES: usize = 2_000;

impl Axis {
    /// The axis as a build returns it, grown if asked to. Its errors are bounds, not samples.
    pub fn candidate(self, limits: &BuildLimits) -> Candidate {
        let Self {
            mut draft,
            growth,
            bulge,
            ..
        } = self;
        let before = known(growth, bulge);
        let count = draft.faces.len();
        let note = format!(
            "a convex polyhedron: its own medial axis has {count} primitives, and is exact"
        );
        let grown = match limits.enclose {
            true => (growth - limits.allow_uncovered).max(0.0),
            false => 0.0,
        };
        draft.balls.iter_mut().for_each(|ball| ball.radius += grown);
        Candidate {
            draft,
            hausdorff: known(growth - grown, bulge + grown),
            before: limits.enclose.then_some(before),
            notes: vec![note],
            variant: Variant::Exact,
            exact_with: None,
        }
    }
}

/// The error of what is known to stick out, and to be stuck out of, by no more than this anywhere.
pub fn known(uncovered: f64, bloat: f64) -> Hausdorff {
    Hausdorff {
        surface_to_envelope: uncovered.max(bloat) as Real,
        envelope_to_surface: uncovered.max(bloat) as Real,
        uncovered: uncovered as Real,
        bloat: bloat as Real,
        sampling: 0.0,
    }
}

/// Faces at most of a convex polyhedron whose axis has so many primitives: three edges or more bound a face, two faces
/// share one, and each has a slab or more.
pub fn faces_of(primitives: usize) -> usize {
    primitives - primitives / 3
}

/// The medial axes of a surface's bodies, of at most `most` primitives together; `None` where one of them is no
/// convex polyhedron, or where its axis has a sheet between faces whose normals differ by less than `angle` (rad).
pub fn polyhedra(
    surface: &Surface,
    tree: &TriangleTree,
    angle: f64,
    most: usize,
    watch: &mut Watch,
) -> Result<Option<Axis>, BuildError> {
    if surface.sheet.contains(&true) {
        return Ok(None);
    }
    let most = most.min(MAX_PRIMITIVES);
    let patches = surface.patch_of.iter().max();
    let mut bodies = vec![Vec::new(); patches.map_or(0, |&p| p as usize + 1)];
    for (t, &patch) in surface.patch_of.iter().enumerate() {
        // Patches that are open or overlap may be pieces of one body.
        let body = if surface.simple { patch } else { 0 };
        bodies[body as usize].push(t);
    }
    bodies.retain(|body| !body.is_empty());
    let mut all = Axis {
        draft: Draft::default(),
        growth: 0.0,
        bulge: 0.0,
        area: 0.0,
    };
    let mut planes = Vec::new();
    for body in bodies {
        let left = most.saturating_sub(all.draft.faces.len());
        let Some(faces) = convex_faces(surface, body, FLAT, faces_of(left), watch)? else {
            return Ok(None);
        };
        let limits = (angle.cos(), EXACT_HERE);
        let Some(axis) = axis(surface, tree, &faces, limits, left, watch)? else {
            return Ok(None);
        };
        all.area += axis.area;
        all.draft = all.draft.and(axis.draft);
        all.growth = all.growth.max(axis.growth);
        all.bulge = all.bulge.max(axis.bulge);
        planes.push(faces.planes);
    }
    // Where not every edge is of two triangles, some of a face may be missing.
    if (all.area - surface.area).abs() > SAME_AREA * surface.area {
        return Ok(None);
    }
    // Triangles without area lie in the bodies.
    let beyond = |p: Point, planes: &Vec<Plane>| {
        let heights = planes.iter().map(|plane| -plane.depth(p));
        heights.fold(0.0, f64::max)
    };
    for p in surface.needle_corners().flatten() {
        let least = planes.iter().map(|planes| beyond(p, planes));
        all.growth = all.growth.max(least.fold(f64::INFINITY, f64::min));
    }
    all.growth += surface.welded;
    Ok((all.growth + all.bulge <= EXACT_HERE).then_some(all))
}

/// The axis of one convex body, of at most `most` primitives and off by at most `close` (longest side 1); none where it
/// has a sheet between faces whose normals have a cosine above `least_cosine`.
pub fn axis(
    surface: &Surface,
    tree: &TriangleTree,
    faces: &FlatFaces,
    (least_cosine, close): (f64, f64),
    most: usize,
    watch: &mut Watch,
) -> Result<Option<Axis>, BuildError> {
    for seed in 0..SEEDS {
        watch.again()?;
        let mut planes = faces.planes.clone();
        let Some(corners) = roof(
            &mut planes,
            CORNERS_PER_PRIMITIVE.saturating_mul(most),
            seed,
        ) else {
            continue;
        };
        let body = ConvexBody::new(surface, faces, planes, corners);
        let polygons = body.polygons();
        let too_blunt = polygons.iter().any(|polygon| {
            let [a, b] = polygon.sides;
            a != GROUND && {
                let [a, b] = [a, b].map(|side| body.planes[(side - FIRST) as usize].normal);
                a.dot(b) > least_cosine
            }
        });
        if too_blunt {
            return Ok(None);
        }
        for same in MERGE_DISTANCES {
            watch.again()?;
            let found = body.axis(&polygons, same, tree);
            let count = found.draft.faces.len();
            if found.growth + found.bulge <= close && count > 0 {
                return Ok((count <= most).then_some(found));
            }
        }
        return Ok(None);
    }
    Ok(None)
}
