//! Culling on the device against brute force by the oracle: no primitive pair that comes within
//! reach is lost, whatever the lists' room, and not many more survive.

use crate::ccd::contact::first_contact;
use crate::ccd::motion::Paths;
use crate::ccd::rng::Rng;
use crate::scene;
use pollster::block_on;
use rapier3d::parry::query::NonlinearRigidMotion;
use rapier3d_medial::batch::Sweep;
use rapier3d_medial::batch::gpu::{Gpu, GpuOptions};
use rapier3d_medial::math::{Pose, Vector};
use rapier3d_medial::{MedialMesh, MedialSphere};
use std::collections::HashMap;

struct Drawn {
    meshes: [MedialMesh; 2],
    motions: [NonlinearRigidMotion; 2],
    reach: f64,
}

/// Still and moving, slow and fast turns, near and far, from 1 to several clusters.
fn draw(count: usize) -> Vec<Drawn> {
    let mut rng = Rng::new(41);
    (0..count)
        .map(|k| {
            let links = [4, 20, 90][k % 3];
            let meshes = [scene::mesh(&mut rng, links), scene::mesh(&mut rng, 12)];
            let spin = [0.0, 0.3, 2.0, 7.0][k % 4];
            let speed = if k % 5 == 0 { 0.0 } else { 1.5 };
            let still = scene::motion(&mut rng, 0.0, 0.0, spin);
            let away = 0.5 + (k % 6) as f32 * 0.4;
            let moving = scene::motion(&mut rng, away, speed, spin);
            let reach = [0.0, 0.05, -0.01][k % 3];
            let motions = [still, moving];
            Drawn {
                meshes,
                motions,
                reach,
            }
        })
        .collect()
}

fn sweeps(drawn: &[Drawn]) -> Vec<Sweep<'_>> {
    drawn
        .iter()
        .map(|d| Sweep {
            meshes: [&d.meshes[0], &d.meshes[1]],
            motions: d.motions,
            seconds: 1.0,
            reach: d.reach,
        })
        .collect()
}

/// Survivors as `(pair, a, b)`, and the bound of each.
fn propose(gpu: &mut Gpu, drawn: &[Drawn]) -> HashMap<(u32, u32, u32), f32> {
    let mut proposals = Vec::new();
    block_on(gpu.propose(&sweeps(drawn), &mut proposals)).expect("proposals");
    assert_eq!(proposals.len(), drawn.len());
    let mut counts = vec![0; drawn.len()];
    let mut found = HashMap::new();
    for s in gpu.survivors() {
        counts[s.pair as usize] += 1;
        assert!(s.lower >= proposals[s.pair as usize].lower);
        // A fast turn is asked about in pieces: the first counts.
        let first = found.entry((s.pair, s.a, s.b)).or_insert(s.lower);
        *first = first.min(s.lower);
    }
    let said: Vec<_> = proposals.iter().map(|p| p.survivors).collect();
    assert_eq!(said, counts.into_iter().map(Some).collect::<Vec<_>>());
    found
}

#[test]
fn no_pair_within_reach_is_lost() {
    let Some(mut gpu) = scene::gpu(scene::options()) else {
        return;
    };
    let drawn = draw(60);
    let survivors = propose(&mut gpu, &drawn);
    let (mut all, mut meeting) = (0, 0);
    for (k, d) in drawn.iter().enumerate() {
        let motions = [&d.motions[0], &d.motions[1]];
        for (i, a) in d.meshes[0].primitives().enumerate() {
            for (j, b) in d.meshes[1].primitives().enumerate() {
                all += 1;
                let exact = Paths::new(&scene::query([&a, &b], motions, 1.0));
                let contact = first_contact(&exact, d.reach).contact_at;
                let key = (k as u32, i as u32, j as u32);
                let Some(time) = contact else { continue };
                meeting += 1;
                let lower = survivors.get(&key);
                let lower = lower.unwrap_or_else(|| panic!("{key:?} lost: meets at {time}"));
                assert!(f64::from(*lower) <= time, "{key:?}: {lower}, {time}");
            }
        }
    }
    let counts = gpu.counts();
    println!("{all} pairs, {meeting} meet; {counts:?}");
    assert!(meeting > 300, "only {meeting} of {all} meet");
    let survivors = survivors.len();
    assert!(
        survivors < 3 * meeting,
        "{survivors} survive, {meeting} meet"
    );
}

/// Planted, in a chain of more clusters than a group has threads, as the first mesh and as the second:
/// a ball in the middle of a link finds that link. The chain finds each of its own links.
#[test]
fn long_meshes_lose_no_link() {
    let Some(mut gpu) = scene::gpu(scene::options()) else {
        return;
    };
    let links = 6000;
    let knot = |k: u32| {
        let x = 0.1 * k as f32;
        MedialSphere::new(Vector::new(x, (0.05 * k as f32).sin(), 0.0), 0.03)
    };
    let spheres = (0..=links).map(knot).collect();
    let edges = (0..links).map(|k| [k, k + 1]).collect();
    let chain = MedialMesh::new(spheres, edges, vec![]).expect("a chain");
    let ball = MedialSphere::new(Vector::ZERO, 0.01);
    let ball = MedialMesh::new(vec![ball], vec![], vec![]).expect("a ball");
    let middle = |k: usize| {
        let link = chain.primitive(k);
        let [a, b] = [0, 1].map(|i| link.spheres()[i].center);
        Pose::from_translation((a + b) / 2.0)
    };
    let asked: Vec<usize> = (0..40).map(|k| k * 5999 / 39).collect();
    let mut drawn = Vec::new();
    for &k in &asked {
        let poses = [Pose::IDENTITY, middle(k)];
        let motions = poses.map(NonlinearRigidMotion::constant_position);
        let [chained, balled] = motions;
        drawn.push(Drawn {
            meshes: [chain.clone(), ball.clone()],
            motions: [chained, balled],
            reach: 0.0,
        });
        drawn.push(Drawn {
            meshes: [ball.clone(), chain.clone()],
            motions: [balled, chained],
            reach: 0.0,
        });
    }
    let still = NonlinearRigidMotion::identity();
    drawn.push(Drawn {
        meshes: [chain.clone(), chain.clone()],
        motions: [still; 2],
        reach: 0.0,
    });
    let found = propose(&mut gpu, &drawn);
    for (n, &k) in asked.iter().enumerate() {
        let (pair, link) = (2 * n as u32, k as u32);
        assert!(found.contains_key(&(pair, link, 0)), "{link}");
        assert!(found.contains_key(&(pair + 1, 0, link)), "{link}");
    }
    let last = 2 * asked.len() as u32;
    assert!((0..links).all(|k| found.contains_key(&(last, k, k))));
    // Neighbours come too, and no more.
    let most = 3 * (2 * asked.len() + links as usize);
    assert!(found.len() <= most, "{} of {most}", found.len());
}

/// Lists of one entry overflow at every stage: they grow, the runs are counted, nothing is lost.
#[test]
fn overflowing_lists_grow() {
    let Some(mut roomy) = scene::gpu(scene::options()) else {
        return;
    };
    let tight = GpuOptions {
        list_capacity: 1,
        ..scene::options()
    };
    let Some(mut gpu) = scene::gpu(tight) else {
        return;
    };
    let drawn = draw(30);
    let expected = propose(&mut roomy, &drawn);
    assert!(expected.len() > 100);
    assert_eq!(roomy.counts().reruns, 0);
    assert_eq!(propose(&mut gpu, &drawn), expected);
    let after_growth = gpu.counts();
    assert_eq!(after_growth.reruns, 3);
    // In the same step again there is room, and nothing is made.
    assert_eq!(propose(&mut gpu, &drawn), expected);
    let again = gpu.counts();
    assert_eq!(again.reruns, 3);
    assert_eq!(again.submissions, after_growth.submissions + 1);
    assert_eq!(again.buffers_made, after_growth.buffers_made);
}

/// Meshes are sent once, shared by their bodies, dropped on request, and found again.
#[test]
fn meshes_stay_and_go() {
    let Some(mut gpu) = scene::gpu(scene::options()) else {
        return;
    };
    let drawn = draw(6);
    let expected = propose(&mut gpu, &drawn);
    assert_eq!(gpu.counts().meshes, 12);
    for instance in [drawn[0].meshes[0].clone(), drawn[0].meshes[0].instance()] {
        let sweep = Sweep {
            meshes: [&instance, &drawn[1].meshes[0]],
            ..sweeps(&drawn)[0]
        };
        block_on(gpu.propose(&[sweep], &mut Vec::new())).expect("proposals");
    }
    assert_eq!(gpu.counts().meshes, 12);
    assert!(gpu.remove(&drawn[0].meshes[0]) && !gpu.remove(&drawn[0].meshes[0]));
    assert!(gpu.remove(&drawn[3].meshes[1]));
    assert_eq!(gpu.counts().meshes, 10);
    assert_eq!(propose(&mut gpu, &drawn), expected);
    assert_eq!(gpu.counts().meshes, 12);
}

/// Far from the origin the answer is that near it: positions are subtracted before they are rounded.
#[test]
fn large_coordinates_cost_nothing() {
    let Some(mut gpu) = scene::gpu(scene::options()) else {
        return;
    };
    let mut drawn = draw(20);
    // Exactly representable there and here.
    for motion in drawn.iter_mut().flat_map(|d| &mut d.motions) {
        let t = &mut motion.start.translation;
        *t = (*t * 64.0).round() / 64.0;
    }
    let near = propose(&mut gpu, &drawn);
    for motion in drawn.iter_mut().flat_map(|d| &mut d.motions) {
        motion.start.translation.x += 8192.0;
    }
    assert_eq!(propose(&mut gpu, &drawn), near);
}
