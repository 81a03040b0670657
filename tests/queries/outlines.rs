//! Outlines: what they call free is free, judged by spheres sampled densely on both bodies and in time,
//! which share no code with them; and they are of use.

use crate::ccd::rng::Rng;
use crate::creature::creature;
use crate::meshes::{mesh, motion, vector};
use nalgebra::Vector3;
use rapier3d::parry::query::NonlinearRigidMotion;
use rapier3d_medial::elementary::{InitialContact, ToiOptions, ToiStatus};
use rapier3d_medial::math::{Pose, Real, Vector};
use rapier3d_medial::medial::proxy_hull::ProxyHull;
use rapier3d_medial::medial::tree::NodeKind;
use rapier3d_medial::pair::first_contact::{Query, first_contact_counted};
use rapier3d_medial::pair::outline::{ActivePrimitives, Outline, apart_until};
use rapier3d_medial::{MedialMesh, MedialSphere};
use std::sync::Arc;

/// Spheres on a body in its frame, with the primitive that each is on.
type Sampled = Vec<(usize, Vector3<f64>, f64)>;

fn wide(v: Vector) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z).map(f64::from)
}

/// Steps along each edge.
const STEPS: usize = 4;

fn sampled(mesh: &MedialMesh) -> Sampled {
    let steps = STEPS;
    let mut all = Vec::new();
    for (index, primitive) in mesh.primitives().enumerate() {
        let s = primitive.spheres();
        let [a, b, c] = [0, 1, 2].map(|k| &s[k.min(s.len() - 1)]);
        for i in 0..=steps {
            for j in 0..=(if s.len() == 3 { steps - i } else { 0 }) {
                let (u, v) = (i as f64 / steps as f64, j as f64 / steps as f64);
                let mix = |[a, b, c]: [f64; 3]| a + (b - a) * u + (c - a) * v;
                let center = [0, 1, 2].map(|x| mix([a, b, c].map(|s| wide(s.center)[x])));
                let radius = mix([a, b, c].map(|s| f64::from(s.radius)));
                all.push((index, Vector3::from(center), radius));
            }
        }
    }
    all
}

fn placed(spheres: &Sampled, motion: &NonlinearRigidMotion, time: Real) -> Sampled {
    let pose = motion.position_at_time(time);
    let turn = pose.rotation;
    let [w, x, y, z] = [turn.w, turn.x, turn.y, turn.z].map(f64::from);
    let turn = nalgebra::Quaternion::new(w, x, y, z);
    let turn = nalgebra::UnitQuaternion::new_normalize(turn);
    let at = wide(pose.translation);
    let place = |(k, c, r): &(usize, Vector3<f64>, f64)| (*k, turn * c + at, *r);
    spheres.iter().map(place).collect()
}

/// The same motion, told from a later time on.
fn later(motion: &NonlinearRigidMotion, time: Real) -> NonlinearRigidMotion {
    NonlinearRigidMotion {
        start: motion.position_at_time(time),
        ..*motion
    }
}

fn holds(mesh: &MedialMesh, left: &ActivePrimitives, primitive: usize) -> bool {
    let nodes = mesh.tree().nodes();
    let leaf = |n: u32| nodes[n as usize].kind() == NodeKind::Primitive(primitive as u32);
    let leaf = (0..nodes.len() as u32).find(|n| leaf(*n));
    left.meets(leaf.expect("a leaf of each primitive"))
}

fn proxy_hull(mesh: &MedialMesh) -> Arc<ProxyHull> {
    Arc::new(ProxyHull::of_mesh(
        mesh.spheres(),
        mesh.simplices(),
        mesh.tree(),
    ))
}

/// Judges two meshes from `from` to 1 s at each `each`-th sample of them, the first told from the start and the second
/// from `from` on. Returns what was said (0 apart, 1 apart for a while, 2 not), and whether less than all is left.
fn judge(
    meshes: [&MedialMesh; 2],
    motions: [&NonlinearRigidMotion; 2],
    [from, target]: [Real; 2],
    each: usize,
    what: &str,
) -> (usize, bool) {
    let proxies = meshes.map(proxy_hull);
    let a = Outline::new(&proxies[0], motions[0], [0.0, 1.0]);
    let b = Outline::new(&proxies[1], &later(motions[1], from), [from, 1.0]);
    let apart = apart_until(&a, &b, from, target);
    let some = |m| sampled(m).into_iter().step_by(each).collect();
    let spheres: [Sampled; 2] = meshes.map(some);
    // Poses of the samples are rounded to f32.
    let reach = f64::from(target) - 1.0e-5;
    for n in 0..=40 {
        let time = from + (1.0 - from) * n as Real / 40.0;
        let [pa, pb] = [0, 1].map(|k| placed(&spheres[k], motions[k], time));
        for (i, p, r) in &pa {
            for (j, q, s) in &pb {
                if (p - q).norm() - r - s >= reach {
                    continue;
                }
                let said = apart.as_ref();
                let said = said.unwrap_or_else(|| panic!("{what}: they meet at {time}"));
                assert!(said.until <= time, "{what}: {time}, not {}", said.until);
                for (k, primitive) in [(0, *i), (1, *j)] {
                    let held = holds(meshes[k], &said.left[k], primitive);
                    assert!(held, "{what}: {primitive} of {k} at {time}");
                }
            }
        }
    }
    let Some(apart) = apart else {
        return (0, true);
    };
    let all = |k: usize| {
        let count = meshes[k].primitive_count();
        (0..count).all(|p| holds(meshes[k], &apart.left[k], p))
    };
    let verdict = if apart.until > from { 1 } else { 2 };
    (verdict, !(all(0) && all(1)))
}

#[test]
fn pairs_called_free_by_outlines_are_free() {
    let mut rng = Rng::new(4411);
    let (mut verdicts, mut fewer) = ([0; 3], 0);
    for k in 0..150 {
        let (a, b) = (mesh(&mut rng), mesh(&mut rng));
        let still = motion(&mut rng, 0.0, 0.5, (k % 4) as Real * 0.3);
        let distance = 0.4 + (k % 6) as Real * 0.3;
        let mut moving = motion(&mut rng, distance, 1.5, (k % 5) as Real * 0.4);
        if k % 4 == 0 {
            // Past it.
            moving.linvel = moving.linvel.cross(vector(&mut rng));
        }
        let from = [0.0, 0.4][k % 2];
        let target = [0.0, 0.05, -0.03][k % 3];
        let what = format!("case {k}");
        let (verdict, some) = judge([&a, &b], [&still, &moving], [from, target], 1, &what);
        verdicts[verdict] += 1;
        fewer += usize::from(some && verdict > 0);
    }
    assert!(
        verdicts.iter().all(|n| *n > 15) && fewer > 60,
        "{verdicts:?}, {fewer}"
    );
}

/// Larger than a mask: by nodes of the tree.
#[test]
fn outlines_of_large_meshes_call_free_what_is_free() {
    let mesh = creature();
    let mut rng = Rng::new(4412);
    let mut verdicts = [0; 3];
    for k in 0..12 {
        let still = motion(&mut rng, 0.0, 0.0, 0.2);
        let moving = motion(&mut rng, 1.2 + 0.1 * k as Real, 0.8, 0.3);
        let what = format!("case {k}");
        let (verdict, _) = judge([&mesh; 2], [&still, &moving], [0.2, 0.01], 37, &what);
        verdicts[verdict] += 1;
    }
    assert!(
        verdicts[0] > 0 && verdicts[1] + verdicts[2] > 0,
        "{verdicts:?}"
    );
}

/// However often a query pauses, and told what is left: the same bits, and what it says in between holds.
#[test]
fn a_query_that_pauses_gives_the_same_answer() {
    let mut rng = Rng::new(4413);
    let (mut pauses, mut less) = (0, 0);
    for k in 0..400 {
        let (a, b) = (mesh(&mut rng), mesh(&mut rng));
        let still = motion(&mut rng, 0.0, 0.0, (k % 3) as Real * 0.4);
        let moving = motion(&mut rng, 0.5 + (k % 7) as Real * 0.2, 2.0, (k % 5) as Real);
        let initial_contact = match k % 2 {
            0 => InitialContact::Stop,
            _ => InitialContact::Deepen { by: 0.02 },
        };
        let options = ToiOptions {
            target_distance: [0.0, 0.02, -0.03][k % 3],
            initial_contact,
            ..Default::default()
        };
        let (whole, all) = first_contact_counted(&a, &still, &b, &moving, 1.0, &options);
        let outline = |m, motion| Outline::new(&proxy_hull(m), motion, [0.0, 1.0]);
        let target = options.target_distance.max(0.0) + options.tolerance;
        let apart = apart_until(&outline(&a, &still), &outline(&b, &moving), 0.0, target);
        for left in [None, apart.map(|apart| apart.left)] {
            let told = left.is_some();
            let mut query = Query::new([&still, &moving], (&a, &b), 1.0, &options, left);
            let mut until = 0.0;
            while let Some(free) = query.search(until) {
                assert!(free <= whole.upper, "{k}: {free}, {whole:?}");
                pauses += 1;
                until += rng.range(0.0, 0.2);
            }
            let toi = query.toi();
            if told {
                assert!(query.counts().nodes <= all.nodes, "{k}");
                less += usize::from(query.counts().nodes < all.nodes);
                assert_eq!(
                    (toi.status, toi.lower, toi.upper),
                    (whole.status, whole.lower, whole.upper),
                    "{k}"
                );
                assert_eq!(
                    (toi.normal, toi.points),
                    (whole.normal, whole.points),
                    "{k}"
                );
            } else {
                assert_eq!((toi, query.counts()), (whole, all), "{k}");
            }
        }
    }
    println!("{pauses} pauses, {less} looked at less");
    assert!(pauses > 800 && less > 20, "{pauses}, {less}");
}

/// A sheet of slabs with bumps, so many spheres wide.
fn sheet(wide: u32) -> MedialMesh {
    let (mut spheres, mut slabs) = (Vec::new(), Vec::new());
    for i in 0..wide {
        for j in 0..wide {
            let bump = 0.2 * ((i * 7 + j * 13) % 5) as Real;
            let center = Vector::new(i as Real, j as Real, bump) * 0.02;
            spheres.push(MedialSphere::new(center, 0.001));
            if i + 1 < wide && j + 1 < wide {
                let k = i * wide + j;
                slabs.push([k, k + 1, k + wide]);
                slabs.push([k + 1, k + wide, k + wide + 1]);
            }
        }
    }
    MedialMesh::new(spheres, vec![], slabs).expect("a sheet")
}

/// A sheet that spins above another uses up all work: where a pause falls does not matter, and nothing
/// told free is taken back.
#[test]
fn a_query_that_pauses_gives_up_where_it_would_have() {
    let mesh = sheet(20);
    let still = NonlinearRigidMotion::constant_position(Pose::IDENTITY);
    for speed in [0.5, 1.0] {
        let start = Pose::translation(0.0, 0.003, 0.02);
        let moving = NonlinearRigidMotion {
            angvel: Vector::Z * 1.0e6 * speed,
            ..NonlinearRigidMotion::constant_position(start)
        };
        let options = ToiOptions {
            initial_contact: InitialContact::Deepen { by: 0.001 },
            ..Default::default()
        };
        let (whole, all) = first_contact_counted(&mesh, &still, &mesh, &moving, 1.0, &options);
        assert_eq!(whole.status, ToiStatus::Unresolved);
        let mut query = Query::new([&still, &moving], (&mesh, &mesh), 1.0, &options, None);
        let mut told = 0.0;
        while let Some(free) = query.search(told.into()) {
            assert!(free >= told, "{speed}: {told}, then {free}");
            told = free;
        }
        assert!(told <= whole.lower, "{speed}: {told}, {whole:?}");
        assert_eq!((query.toi(), query.counts()), (whole, all), "{speed}");
    }
}
