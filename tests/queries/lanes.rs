//! Eight lanes at once give the bits of the scalar kernel, on either path, whatever the others in
//! their group do.

use crate::ccd::families::Family;
use crate::ccd::rng::Rng;
use rapier3d_medial::elementary::bracket::{Bracket, Limits, bracket};
use rapier3d_medial::elementary::many::{Lanes, brackets};
use rapier3d_medial::elementary::path::LinearPath;
use rapier3d_medial::elementary::test_list::{Domain, ElementaryTest};
use rapier3d_medial::math::lane::Vec3;

/// One test of each straight query of the family that has spheres enough for it.
fn paths(family: Family, domain: Domain) -> Vec<LinearPath<f32>> {
    let mut rng = Rng::new(4000 + family as u64);
    let (counts, test) = match domain {
        Domain::Box => ([2, 2], ElementaryTest::cone_cone([0, 1], [0, 1])),
        Domain::Triangle => ([1, 3], ElementaryTest::sphere_slab(0)),
    };
    (0..203)
        .map(|_| {
            let query = family.query(counts, false, &mut rng);
            LinearPath::new(&test, 0.0, |second, i| {
                let ball = &query.balls[usize::from(second)][usize::from(i)];
                let [c, d] = [ball.center, ball.displacement]
                    .map(|v| Vec3::new(v.x as f32, v.y as f32, v.z as f32));
                (c, d, ball.radius as f32)
            })
        })
        .collect()
}

fn bits(b: &Bracket<f32>) -> (u32, u32, bool, bool, u32, u32) {
    let Bracket { lower, upper, .. } = *b;
    (
        lower.to_bits(),
        upper.to_bits(),
        b.contact,
        b.separated,
        b.nearest.distance.to_bits(),
        b.iterations,
    )
}

#[test]
fn lanes_give_the_bits_of_the_scalar_kernel() {
    let limits = Limits {
        tolerance: 1.0e-5,
        time_tolerance: 1.0e-6,
        start: 0.0,
        horizon: 1.0,
        max_iterations: 64,
    };
    let (mut contacts, mut separated) = (0, 0);
    for family in Family::ALL {
        for domain in [Domain::Box, Domain::Triangle] {
            let paths = paths(family, domain);
            let alone: Vec<_> = paths.iter().map(|p| bracket(p, domain, &limits)).collect();
            contacts += alone.iter().filter(|b| b.contact).count();
            separated += alone.iter().filter(|b| b.separated).count();
            for lanes in [Lanes::Baseline, Lanes::Fastest] {
                let together = brackets(&paths, domain, &limits, lanes);
                assert_eq!(together.len(), alone.len());
                for (k, (a, b)) in alone.iter().zip(&together).enumerate() {
                    assert_eq!(bits(a), bits(b), "{family:?} {domain:?} {lanes:?} {k}");
                }
            }
        }
    }
    assert!(
        contacts > 2000 && separated > 2000,
        "{contacts} {separated}"
    );
    assert!(brackets(&[], Domain::Box, &limits, Lanes::Fastest).is_empty());
}
