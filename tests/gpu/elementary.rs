//! The batch of elementary tests, judged by the oracle: nothing that the device calls free meets.

use crate::ccd::contact::first_contact;
use crate::ccd::families::Family;
use crate::ccd::judge::Truth;
use crate::ccd::motion::{Paths, Query};
use crate::ccd::rng::Rng;
use crate::scene;
use pollster::block_on;
use rapier3d_medial::elementary::path::LinearPath;
use rapier3d_medial::elementary::test_list::{Domain, ElementaryTest};
use rapier3d_medial::math::lane::Vec3;

/// Queries of a family and a domain; `MEDIAL_GPU_QUERIES` asks for more.
fn queries() -> usize {
    let asked = std::env::var("MEDIAL_GPU_QUERIES").ok();
    asked.and_then(|n| n.parse().ok()).unwrap_or(300)
}

/// Differences are formed in double precision and rounded once.
fn path(query: &Query, test: &ElementaryTest) -> LinearPath<f32> {
    let exact = LinearPath::<f64>::new(test, 0.0, |second, i| {
        let ball = &query.balls[usize::from(second)][usize::from(i)];
        let [c, d] = [ball.center, ball.displacement].map(|v| Vec3::new(v.x, v.y, v.z));
        (c, d, ball.radius)
    });
    let vector = |v: Vec3<f64>| Vec3::new(v.x as f32, v.y as f32, v.z as f32);
    LinearPath {
        start: exact.start.map(vector),
        rate: exact.rate.map(vector),
        radius: exact.radius.map(|r| r as f32),
        size: 0.0,
    }
}

/// Every family of hard queries, cones and slabs: none missed. Of those that stay ten
/// tolerances apart most are settled, or the device would be of no use.
#[test]
fn tests_proven_free_by_the_device_are_free() {
    let Some(mut gpu) = scene::gpu(scene::options()) else {
        return;
    };
    let (mut asked, mut apart, mut settled) = (0, 0, 0);
    let mut free = Vec::new();
    for family in Family::ALL.into_iter().chain(Family::EXTREME) {
        let tolerance = 1.0e-4 * family.size();
        for domain in [Domain::Box, Domain::Triangle] {
            let (counts, test) = match domain {
                Domain::Box => ([2, 2], ElementaryTest::cone_cone([0, 1], [0, 1])),
                Domain::Triangle => ([1, 3], ElementaryTest::sphere_slab(0)),
            };
            let mut rng = Rng::new(7100 + family as u64);
            let drawn: Vec<Query> = (0..queries())
                .map(|_| family.query(counts, false, &mut rng))
                .collect();
            let paths: Vec<_> = drawn.iter().map(|q| path(q, &test)).collect();
            block_on(gpu.prove(&paths, domain, tolerance as f32, &mut free)).expect("proposals");
            assert_eq!(free.len(), paths.len());
            for (query, &free) in drawn.iter().zip(&free) {
                let exact = Paths::new(query);
                let contact = Truth::new(query, 0.0).contact.contact_at;
                assert!(!free || contact.is_none(), "{family:?}\n{query:?}");
                if Family::EXTREME.contains(&family) {
                    continue;
                }
                asked += 1;
                if first_contact(&exact, 10.0 * tolerance).free_until >= 1.0 {
                    apart += 1;
                    settled += usize::from(free);
                }
            }
        }
    }
    println!(
        "{asked} asked on {}, {apart} apart, {settled} settled",
        gpu.name()
    );
    assert!(apart > asked / 10 && settled * 10 > apart * 8);
}

/// What is not finite, or whose squares would overflow, is never called free.
#[test]
fn numbers_out_of_range_are_left_to_the_cpu() {
    let Some(mut gpu) = scene::gpu(scene::options()) else {
        return;
    };
    let good = LinearPath {
        start: [Vec3::new(3.0, 0.0, 0.0); 4],
        rate: [Vec3::zero(); 4],
        radius: [0.5; 4],
        size: 0.0,
    };
    let mut paths = vec![good];
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1.0e30] {
        for k in 0..3 {
            let mut path = good;
            match k {
                0 => path.start[1].y = bad,
                1 => path.rate[2].z = bad,
                _ => path.radius[0] = bad,
            }
            paths.push(path);
        }
    }
    let mut free = Vec::new();
    block_on(gpu.prove(&paths, Domain::Box, 1.0e-4, &mut free)).expect("proposals");
    assert!(free[0] && !free[1..].contains(&true), "{free:?}");
}

/// The device is sent three corners: of a path whose fourth does not follow from them nothing is
/// proven, however far that one is.
#[test]
fn a_fourth_corner_elsewhere_is_left_to_the_cpu() {
    let Some(mut gpu) = scene::gpu(scene::options()) else {
        return;
    };
    let apart = LinearPath {
        start: [Vec3::new(3.0, 0.0, 0.0); 4],
        rate: [Vec3::zero(); 4],
        radius: [0.5; 4],
        size: 0.0,
    };
    let mut paths = vec![apart; 5];
    // Meets, at the start, on its way, by its radius; the last is apart all the same.
    paths[1].start[3] = Vec3::zero();
    paths[2].rate[3] = Vec3::new(-4.0, 0.0, 0.0);
    paths[3].radius[3] = 3.5;
    paths[4].start[3] = Vec3::new(3.0, 1.0e-3, 0.0);
    let mut free = Vec::new();
    block_on(gpu.prove(&paths, Domain::Box, 1.0e-4, &mut free)).expect("proposals");
    assert_eq!(free, [true, false, false, false, false]);
    // A slab has no fourth.
    block_on(gpu.prove(&paths, Domain::Triangle, 1.0e-4, &mut free)).expect("proposals");
    assert_eq!(free, [true; 5]);
}

/// More tests than groups of one dimension hold, apart but for a few planted ones.
#[test]
fn large_batches_lose_none() {
    let Some(mut gpu) = scene::gpu(scene::options()) else {
        return;
    };
    let count = 1_000_003;
    let mut paths = vec![
        LinearPath {
            start: [Vec3::new(3.0, 0.0, 0.0); 4],
            rate: [Vec3::new(-1.0, 0.0, 0.0); 4],
            radius: [0.5; 4],
            size: 0.0,
        };
        count
    ];
    let planted = [0, 1, 63, 64, 65_535, 524_287, 999_999, count - 1];
    for k in planted {
        paths[k].rate = [Vec3::new(-4.0, 0.0, 0.0); 4];
    }
    let before = gpu.counts();
    let mut free = Vec::new();
    block_on(gpu.prove(&paths, Domain::Box, 1.0e-4, &mut free)).expect("proposals");
    assert_eq!(gpu.counts().submissions, before.submissions + 1);
    let open: Vec<_> = (0..count).filter(|&k| !free[k]).collect();
    assert_eq!(open, planted);
}
