//! Leaves out the faces that two parts share where they touch: triangles of the same corners that face opposite ways, with
//! matter on both sides. They bound nothing.
//!
//! Two such triangles add nothing to the winding number, so that of all others tells what is around them. Where it is no
//! matter they are the two sides of a sheet, of which one stays.

use crate::error::BuildError;
use crate::meshing::findings::Findings;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::surface::checked_surface::corners;
use crate::meshing::surface::weld::Welded;
use crate::meshing::watch::Watch;

/// Winding number from which there is matter: by the middle of an opening that a box lacks one side for it is ½.
const INSIDE: f64 = 0.75;

/// Leaves out of a welded mesh those triangles, each with a repeat that faces the other way, that have matter on both sides.
pub fn leave_out_shared(
    welded: &mut Welded,
    findings: &mut Findings,
    watch: &mut Watch,
) -> Result<(), BuildError> {
    let places = std::mem::take(&mut welded.against);
    let mut is_shared = vec![false; welded.triangles.len()];
    places.iter().for_each(|&t| is_shared[t] = true);
    let others = (0..is_shared.len()).filter(|&t| !is_shared[t]);
    let others: Vec<usize> = others.collect();
    if places.is_empty() || others.is_empty() {
        return Ok(());
    }
    let corners_of = |t: usize| corners(&welded.vertices, &welded.triangles[t]);
    let tree = TriangleTree::new(others.len(), |i| corners_of(others[i]), watch)?;
    for (i, &t) in places.iter().enumerate() {
        if i % 64 == 0 {
            watch.again()?;
        }
        let [a, b, c] = corners_of(t);
        // Below −¾ where all faces inward.
        is_shared[t] = tree.winding((a + b + c) * (1.0 / 3.0)).abs() > INSIDE;
    }
    let mut place = 0;
    welded.triangles.retain(|_| {
        place += 1;
        !is_shared[place - 1]
    });
    findings.triangles_shared = is_shared.iter().filter(|shared| **shared).count();
    welded.leave_out_unused();
    Ok(())
}
