//! Lists of primitive pairs that may come within reach, against brute force by the oracle: none is left out, and few
//! are listed that do not. What makes a list not whole is found.

use crate::ccd::contact::first_contact;
use crate::ccd::motion::Paths;
use crate::ccd::rng::Rng;
use crate::detailed::{Form, detailed};
use crate::large::{ball, balls_meet};
use crate::scene;
use pollster::block_on;
use rapier3d::parry::query::NonlinearRigidMotion;
use rapier3d_medial::MedialMesh;
use rapier3d_medial::batch::Sweep;
use rapier3d_medial::batch::gpu::layout::{FREE, GIVEN_UP, Near};
use rapier3d_medial::batch::gpu::near::Range;
use rapier3d_medial::batch::gpu::{Proposal, Proposals};
use std::collections::BTreeSet;

/// Length of a step in seconds.
const SECONDS: f32 = 1.0 / 60.0;

/// Two of these bodies near each other, at rest or fast.
fn draw(count: usize, moving: bool) -> Vec<([MedialMesh; 2], [NonlinearRigidMotion; 2], f64)> {
    let mut rng = Rng::new(if moving { 52 } else { 51 });
    let bodies = [
        detailed(Form::Bear, 200),
        detailed(Form::Spider, 200),
        detailed(Form::Ring, 100),
        detailed(Form::Sheet, 200),
        scene::mesh(&mut rng, 90),
    ];
    let speed = if moving { 8.0 } else { 0.0 };
    let draw = |k: usize| {
        let meshes = [&bodies[k % 5], &bodies[k / 5 % 5]].map(MedialMesh::clone);
        let still = scene::motion(&mut rng, 0.0, 0.0, 0.05 * speed);
        let size = |m: &MedialMesh| m.aabb().half_extents().max_element();
        let away = (size(&meshes[0]) + size(&meshes[1])) * [0.6, 0.7, 0.85][k % 3];
        let second = scene::motion(&mut rng, away, speed, 0.5 * speed);
        (meshes, [still, second], [0.01, 0.0, 0.03][k / 3 % 3])
    };
    (0..count).map(draw).collect()
}

/// Asks for all of them, and compares with brute force: how many primitive pairs there are, mesh pairs with a list that
/// has to have something, and mesh pairs without one.
fn judge(moving: bool, count: usize) -> [usize; 3] {
    let Some(mut gpu) = scene::gpu(scene::options()) else {
        return [0; 3];
    };
    let drawn = draw(count, moving);
    let sweeps: Vec<_> = drawn
        .iter()
        .map(|(meshes, motions, reach)| Sweep {
            meshes: [&meshes[0], &meshes[1]],
            motions: *motions,
            seconds: SECONDS,
            reach: *reach,
            lists: true,
        })
        .collect();
    let mut proposals = Proposals::default();
    // The second list has the room that the first one lacked.
    for _ in 0..2 {
        block_on(gpu.propose(&sweeps, &mut proposals)).expect("proposals");
    }
    let (mut all, mut needed, mut open) = (0, 0, 0);
    let mut lengths = Vec::new();
    for (k, (meshes, motions, reach)) in drawn.iter().enumerate() {
        let primitives = [0, 1].map(|i: usize| meshes[i].primitives().collect::<Vec<_>>());
        let balls = [0, 1].map(|i: usize| {
            let balls = primitives[i].iter().map(|p| ball(p, &motions[i], SECONDS));
            balls.collect::<Vec<_>>()
        });
        let listed: BTreeSet<[u32; 2]> = proposals.near(proposals[k]).iter().copied().collect();
        let mut near = 0;
        for (i, a) in (0u32..).zip(&balls[0]) {
            for (j, b) in (0u32..).zip(&balls[1]) {
                all += 1;
                if !balls_meet(a, b, *reach) {
                    continue;
                }
                let both = [&primitives[0][i as usize], &primitives[1][j as usize]];
                let paths = Paths::new(&scene::query(both, [&motions[0], &motions[1]], SECONDS));
                if first_contact(&paths, *reach).contact_at.is_none() {
                    continue;
                }
                near += 1;
                let lists = proposals[k] == Proposal::Open || listed.contains(&[i, j]);
                assert!(lists, "{k}: {i} and {j} come within reach");
            }
        }
        open += usize::from(proposals[k] == Proposal::Open);
        needed += near;
        if near > 0 && proposals[k] != Proposal::Open {
            lengths.push(listed.len() as f64 / f64::from(near as u32));
        }
    }
    lengths.sort_by(f64::total_cmp);
    let median = lengths[lengths.len() / 2];
    println!(
        "{all} primitive pairs, {needed} come within reach; {} lists, {median:.2} times as long as needed in the median, {:.2} at most; {open} without a list",
        lengths.len(),
        lengths[lengths.len() - 1],
    );
    assert!(median <= 4.0, "{median}");
    [all, lengths.len(), open]
}

#[test]
fn no_primitive_pair_near_at_rest_is_left_out() {
    let [all, lists, open] = judge(false, 75);
    assert!(
        all == 0 || all > 1_000_000 && lists > 20 && open < 10,
        "{all} {lists} {open}"
    );
}

#[test]
fn no_primitive_pair_near_in_motion_is_left_out() {
    let [all, lists, open] = judge(true, 75);
    assert!(
        all == 0 || all > 1_000_000 && lists > 12 && open < 35,
        "{all} {lists} {open}"
    );
}

/// Three mesh pairs asked for, the second in two pieces; of each piece the answer, and the entries.
fn taken(answers: [u32; 4], list: &[Near]) -> (Vec<Proposal>, Vec<Vec<[u32; 2]>>) {
    let range = |first, count| Range { first, count };
    let ranges = [[range(0, 5), range(5, 7)]; 4];
    let list: Vec<_> = list.iter().map(|entry| bytemuck::cast(*entry)).collect();
    let mut proposals = Proposals::default();
    proposals.take(3, (&[0, 1, 1, 2], &ranges), &answers, &list, 9);
    let near = |said: &Proposal| proposals.near(*said).to_vec();
    (proposals.to_vec(), proposals.iter().map(near).collect())
}

fn entry(pair: u32, primitives: [u32; 2]) -> Near {
    Near {
        primitives,
        pair,
        stamp: 9,
    }
}

/// In any order; of two pieces one after the other.
#[test]
fn whole_lists_are_taken() {
    let list = [
        entry(2, [4, 11]),
        entry(0, [0, 5]),
        entry(1, [3, 6]),
        entry(2, [1, 5]),
    ];
    let (said, near) = taken([FREE + 1, FREE + 1, FREE + 2, FREE], &list);
    assert!(said[2].is_free());
    assert_eq!(near, [vec![[0, 0]], vec![[3, 1], [4, 6], [1, 0]], vec![]]);
}

/// A driver that ends loops early, or runs a part of what it was given: a proof that is missing, an entry that is, one
/// of a batch before, one too many, one that names nothing. The mesh pair goes to the CPU, and its neighbours keep
/// theirs.
#[test]
fn lists_that_are_not_whole_are_not_taken() {
    let [a, b] = [entry(0, [0, 5]), entry(3, [2, 9])];
    let old = Near {
        stamp: 8,
        ..entry(1, [3, 6])
    };
    let beyond = entry(1, [5, 6]);
    for (answer, entries) in [
        (0, vec![]),
        (GIVEN_UP, vec![]),
        (u32::MAX, vec![]),
        (FREE + 1, vec![]),
        (FREE, vec![entry(1, [3, 6])]),
        (FREE + 1, vec![entry(1, [3, 6]); 2]),
        (FREE + 1, vec![old]),
        (FREE + 1, vec![beyond]),
        (GIVEN_UP - 1, vec![entry(1, [3, 6])]),
    ] {
        for first in [true, false] {
            let mut list = entries.clone();
            list.insert(if first { 0 } else { list.len() }, a);
            let end = if first { list.len() } else { 0 };
            list.insert(end, b);
            let (said, near) = taken([FREE + 1, answer, FREE, FREE + 1], &list);
            assert_eq!(said[1], Proposal::Open, "{answer} {entries:?}");
            assert_eq!(near[0], [[0, 0]]);
            // What one answer gets wrong by far may cost those behind it their lists, never an entry.
            assert!(near[2] == [[2, 4]] || said[2] == Proposal::Open);
            assert!(near[2] == [[2, 4]] || answer == GIVEN_UP - 1);
        }
    }
}
