//! Culling on the device against brute force by the oracle: no mesh pair that comes within reach is
//! called free, and most of the others are.

use crate::ccd::contact::first_contact;
use crate::ccd::families::Family;
use crate::ccd::judge::Truth;
use crate::ccd::motion::Paths;
use crate::ccd::rng::Rng;
use crate::ccd::subject::meshes;
use crate::scene;
use pollster::block_on;
use rapier3d::parry::query::NonlinearRigidMotion;
use rapier3d_medial::batch::Sweep;
use rapier3d_medial::batch::gpu::layout::MOST_MEETINGS;
use rapier3d_medial::batch::gpu::{Gpu, GpuOptions, Proposal, Proposals};
use rapier3d_medial::error::GpuError;
use rapier3d_medial::math::{Pose, Real, Vector};
use rapier3d_medial::{MedialMesh, MedialPrimitive, MedialSphere};

struct Drawn {
    meshes: [MedialMesh; 2],
    motions: [NonlinearRigidMotion; 2],
    reach: f64,
}

/// Still and moving, slow and fast turns, near and far, small trees and deep ones.
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
            lists: true,
        })
        .collect()
}

fn propose(gpu: &mut Gpu, drawn: &[Drawn]) -> Proposals {
    let mut proposals = Proposals::default();
    block_on(gpu.propose(&sweeps(drawn), &mut proposals)).expect("proposals");
    assert_eq!(proposals.len(), drawn.len());
    proposals
}

fn meets(d: &Drawn, a: &MedialPrimitive, b: &MedialPrimitive) -> bool {
    let motions = [&d.motions[0], &d.motions[1]];
    let exact = Paths::new(&scene::query([a, b], motions, 1.0));
    first_contact(&exact, d.reach).contact_at.is_some()
}

#[test]
fn no_mesh_within_reach_is_free() {
    let Some(mut gpu) = scene::gpu(scene::options()) else {
        return;
    };
    let drawn = draw(120);
    let proposals = propose(&mut gpu, &drawn);
    let (mut apart, mut free) = (0, 0);
    for (k, d) in drawn.iter().enumerate() {
        let others: Vec<_> = d.meshes[1].primitives().collect();
        let meeting = d.meshes[0]
            .primitives()
            .any(|a| others.iter().any(|b| meets(d, &a, b)));
        assert!(!meeting || !proposals[k].is_free(), "{k} meets");
        apart += usize::from(!meeting);
        free += usize::from(proposals[k].is_free());
    }
    println!("{apart} of {} apart, {free} free", drawn.len());
    assert!((36..84).contains(&apart), "{apart} of {}", drawn.len());
    assert!(10 * free > 9 * apart, "{free} of {apart}");
}

/// A mesh of one primitive.
fn lone(p: &MedialPrimitive) -> MedialMesh {
    let spheres = p.spheres().to_vec();
    let (edges, faces) = match spheres.len() {
        1 => (vec![], vec![]),
        2 => (vec![[0, 1]], vec![]),
        _ => (vec![], vec![[0, 1, 2]]),
    };
    MedialMesh::new(spheres, edges, faces).expect("a primitive")
}

/// Each primitive pair asked for by itself, so that none hides behind another that meets sooner.
#[test]
fn no_primitive_within_reach_is_free() {
    let Some(mut gpu) = scene::gpu(scene::options()) else {
        return;
    };
    let (mut lones, mut meeting) = (Vec::new(), Vec::new());
    for d in draw(40) {
        let [first, second] = [0, 1].map(|k: usize| {
            let all = d.meshes[k].primitives();
            all.map(|p| (p, lone(&p))).collect::<Vec<_>>()
        });
        // A part of the large ones.
        for (a, lone_a) in first.iter().step_by(first.len().div_ceil(12)) {
            for (b, lone_b) in &second {
                meeting.push(meets(&d, a, b));
                lones.push(Drawn {
                    meshes: [lone_a.clone(), lone_b.clone()],
                    ..d
                });
            }
        }
    }
    let proposals = propose(&mut gpu, &lones);
    let wrong = (0..lones.len()).find(|&k| meeting[k] && proposals[k].is_free());
    assert_eq!(wrong, None, "meets");
    let meet = meeting.iter().filter(|m| **m).count();
    let free = proposals.iter().filter(|p| p.is_free()).count();
    let all = lones.len();
    println!("{all} pairs, {meet} meet, {free} free");
    assert!(meet > 150, "only {meet} of {all} meet");
    assert!(100 * free > 95 * (all - meet), "{free} of {}", all - meet);
}

fn chain(links: u32) -> MedialMesh {
    let knot = |k: u32| {
        let x = 0.1 * k as f32;
        MedialSphere::new(Vector::new(x, (0.05 * k as f32).sin(), 0.0), 0.03)
    };
    let spheres = (0..=links).map(knot).collect();
    let edges = (0..links).map(|k| [k, k + 1]).collect();
    MedialMesh::new(spheres, edges, vec![]).expect("a chain")
}

fn at_rest(meshes: [&MedialMesh; 2], poses: [Pose; 2]) -> Drawn {
    Drawn {
        meshes: meshes.map(Clone::clone),
        motions: poses.map(NonlinearRigidMotion::constant_position),
        reach: 0.0,
    }
}

/// Planted, in a long chain, as the first mesh and as the second: a ball in the middle of a link
/// finds that link, and nothing where it is moved aside.
#[test]
fn long_meshes_lose_no_link() {
    let Some(mut gpu) = scene::gpu(scene::options()) else {
        return;
    };
    let chain = chain(6000);
    let ball = MedialSphere::new(Vector::ZERO, 0.01);
    let ball = MedialMesh::new(vec![ball], vec![], vec![]).expect("a ball");
    let mut drawn = Vec::new();
    for k in (0..200).map(|k| k * 5999 / 199) {
        let link = chain.primitive(k);
        let [a, b] = [0, 1].map(|i| link.spheres()[i].center);
        let middle = (a + b) / 2.0;
        // By more than the slack of numbers as large as the chain.
        let aside = middle + Vector::Z * 0.1;
        let [middle, aside] = [middle, aside].map(Pose::from_translation);
        drawn.push(at_rest([&chain, &ball], [Pose::IDENTITY, middle]));
        drawn.push(at_rest([&ball, &chain], [middle, Pose::IDENTITY]));
        drawn.push(at_rest([&chain, &ball], [Pose::IDENTITY, aside]));
    }
    let found = propose(&mut gpu, &drawn);
    for (n, said) in found.chunks(3).enumerate() {
        let listed = |k: usize| found.near(said[k]).to_vec();
        let link = (n * 5999 / 199) as u32;
        assert!(
            listed(0).contains(&[link, 0]) && listed(1).contains(&[0, link]),
            "{n}"
        );
        assert!(said[2].is_free(), "{n}");
    }
    assert_eq!(gpu.counts().given_up, 0);
}

/// More meets than a walk has room for: given up and counted, though nothing touches; the CPU knows.
#[test]
fn entangled_meshes_are_given_up() {
    let Some(mut gpu) = scene::gpu(scene::options()) else {
        return;
    };
    let [short, long] = [chain(20), chain(2000)];
    let beside = Pose::from_translation(Vector::Z * 0.07);
    let poses = [Pose::IDENTITY, beside];
    let drawn = [
        at_rest([&short, &short], poses),
        at_rest([&long, &long], poses),
        at_rest([&long, &short], poses),
    ];
    let expected = [Proposal::Free, Proposal::Open, Proposal::Free];
    assert_eq!(*propose(&mut gpu, &drawn), expected);
    assert_eq!(gpu.counts().given_up, 1);
}

/// More primitive pairs than a batch has room for, of mesh pairs that all meet: those that find none are
/// given up, or left without a list, and none is called free for want of them.
#[test]
fn pairs_that_find_no_room_are_given_up() {
    let Some(mut gpu) = scene::gpu(scene::options()) else {
        return;
    };
    let ball = |k: usize| MedialSphere::new(Vector::X * (0.01 * k as f32), 1.0);
    let cluster = |size| MedialMesh::new((0..size).map(ball).collect(), vec![], vec![]);
    let meshes = [10, 11].map(|size| cluster(size).expect("balls"));
    let sweep = Sweep {
        meshes: [&meshes[0], &meshes[1]],
        motions: [NonlinearRigidMotion::identity(); 2],
        seconds: 0.0,
        reach: 0.0,
        lists: true,
    };
    // All balls of one meet all of the other.
    let fit = MOST_MEETINGS / 110;
    let sweeps = vec![sweep; fit + 500];
    let mut proposals = Proposals::default();
    let mut ask = |asked: &[Sweep]| {
        let before = gpu.counts();
        block_on(gpu.propose(asked, &mut proposals)).expect("proposals");
        let after = gpu.counts();
        let open = proposals.iter().filter(|p| **p == Proposal::Open).count() as u64;
        assert_eq!(proposals.iter().filter(|p| p.is_free()).count(), 0);
        for said in proposals.iter().filter(|p| **p != Proposal::Open) {
            assert_eq!(proposals.near(*said).len(), 110);
        }
        let [given_up, unlisted] = [
            after.given_up - before.given_up,
            after.unlisted - before.unlisted,
        ];
        assert_eq!(open, given_up + unlisted);
        [given_up, unlisted]
    };
    // The list is too short for what nobody expects, and then has its length.
    let [given_up, unlisted] = ask(&sweeps[..fit]);
    assert!(given_up == 0 && unlisted as usize > fit / 2, "{unlisted}");
    assert_eq!(ask(&sweeps[..fit]), [0, 0]);
    assert_eq!(ask(&sweeps), [500, 0]);
}

/// Meshes are sent once, shared by their bodies, dropped on request, and found again.
#[test]
fn meshes_stay_and_go() {
    let Some(mut gpu) = scene::gpu(scene::options()) else {
        return;
    };
    let drawn = draw(6);
    let expected = propose(&mut gpu, &drawn);
    assert_eq!(gpu.stock().meshes, 12);
    for instance in [drawn[0].meshes[0].clone(), drawn[0].meshes[0].instance()] {
        let sweep = Sweep {
            meshes: [&instance, &drawn[1].meshes[0]],
            ..sweeps(&drawn)[0]
        };
        block_on(gpu.propose(&[sweep], &mut Proposals::default())).expect("proposals");
    }
    assert_eq!(gpu.stock().meshes, 12);
    assert!(gpu.remove(&drawn[0].meshes[0]) && !gpu.remove(&drawn[0].meshes[0]));
    assert!(gpu.remove(&drawn[3].meshes[1]));
    assert_eq!(gpu.stock().meshes, 10);
    assert_eq!(*propose(&mut gpu, &drawn), *expected);
    assert_eq!(gpu.stock().meshes, 12);
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
    assert_eq!(*propose(&mut gpu, &drawn), *near);
}

/// A batch that is too large, whose meshes made the nodes' texture grow, and then one that fits: it is told of
/// its own meshes.
#[test]
fn buffers_grown_for_a_failed_batch_serve_the_next() {
    let options = GpuOptions {
        binding_bytes: 1 << 17,
        ..scene::options()
    };
    let Some(mut gpu) = scene::gpu(options) else {
        return;
    };
    let balls = |count: u16, apart: Real, radius: Real| {
        let ball = |k| MedialSphere::new(Vector::X * (apart * Real::from(k)), radius);
        MedialMesh::new((0..count).map(ball).collect(), vec![], vec![]).expect("balls")
    };
    let (small, large) = (balls(3, 10.0, 0.01), balls(600, 0.01, 1.0));
    let beside = NonlinearRigidMotion::constant_position(Pose::from_translation(Vector::Y * 0.5));
    let sweep = |mesh| Sweep {
        meshes: [mesh, mesh],
        motions: [NonlinearRigidMotion::identity(), beside],
        seconds: 0.0,
        reach: 0.0,
        lists: true,
    };
    let mut said = Proposals::default();
    block_on(gpu.propose(&[sweep(&small)], &mut said)).expect("proposals");
    assert_eq!(*said, [Proposal::Free]);
    let many = vec![sweep(&large); 600];
    let refused = block_on(gpu.propose(&many, &mut said));
    assert!(
        matches!(refused, Err(GpuError::TooLarge { .. })),
        "{refused:?}"
    );
    block_on(gpu.propose(&many[..1], &mut said)).expect("proposals");
    assert_ne!(*said, [Proposal::Free]);
}

/// The families made to break a certificate: what the device calls free stays apart, by the oracle.
#[test]
fn extreme_pairs_that_the_device_calls_free_stay_apart() {
    let Some(mut gpu) = scene::gpu(scene::options()) else {
        return;
    };
    for family in Family::EXTREME {
        let mut rng = Rng::new(7300 + family as u64);
        let draw = |k: usize| family.query([1 + k % 3, 1 + k / 3 % 3], true, &mut rng);
        let queries: Vec<_> = (0..270).map(draw).collect();
        let drawn = queries.iter().filter_map(|q| Some((q, meshes(q)?)));
        let drawn: Vec<_> = drawn.collect();
        let sweeps: Vec<_> = drawn
            .iter()
            .map(|(_, ([a, b], motions, seconds))| Sweep {
                meshes: [a, b],
                motions: *motions,
                seconds: *seconds,
                reach: 0.0,
                lists: true,
            })
            .collect();
        let mut proposals = Proposals::default();
        block_on(gpu.propose(&sweeps, &mut proposals)).expect("proposals");
        let free = proposals.iter().filter(|p| p.is_free()).count();
        println!("{family:?}: {free} of {} free", drawn.len());
        for ((query, _), proposal) in drawn.iter().zip(proposals.iter()) {
            let contact = Truth::new(query, 0.0).contact.contact_at;
            let right = !proposal.is_free() || contact.is_none();
            assert!(right, "{family:?}\n{query:?}");
        }
    }
}
