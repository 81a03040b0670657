//! A row of dominoes, of which the first is pushed.

use super::bodies::{attached, world_with_ground};
use rapier3d::prelude::*;

/// The step in which the last of a row of dominoes lies flat or leans; node pairs and elementary tests of all that was
/// asked; and the work of the searches for first contacts, in which a look at two pieces counts as 16 tests.
pub fn dominoes(
    collider: &ColliderBuilder,
    spacing: Real,
    is_medial: bool,
) -> (Option<usize>, [u64; 2]) {
    let mut world = world_with_ground();
    let mut row = Vec::new();
    for k in 0..20 {
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::new(spacing * k as Real, 0.5, 0.0))
            .angvel(Vector::Z * if k == 0 { -2.0 } else { 0.0 });
        row.push(world.insert(body, collider.clone()).0);
    }
    let mut pipeline = attached(&mut world);
    let (mut fallen, mut work) = (None, [0; 2]);
    for step in 0..300 {
        if is_medial {
            let report = pipeline.step(&mut world);
            assert_eq!(report.frozen, 0, "step {step}");
            work[0] += report.culled_nodes + report.elementary_tests;
            work[1] += report.spent;
        } else {
            world.step();
        }
        let leans = |domino: &RigidBodyHandle| world.bodies[*domino].translation().y < 0.4;
        if fallen.is_none() && row.last().is_some_and(leans) {
            fallen = Some(step);
        }
    }
    (fallen, work)
}
