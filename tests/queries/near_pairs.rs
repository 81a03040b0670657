//! Searches that go through a list of near primitive pairs: the answer is that of the search without one, bit by bit,
//! on all motions for which the list says that it holds; and they look at fewer nodes.

use crate::ccd::rng::Rng;
use crate::creature::creature;
use crate::meshes::{mesh, vector};
use rapier3d::parry::query::NonlinearRigidMotion;
use rapier3d_medial::MedialMesh;
use rapier3d_medial::elementary::{Cores, InitialContact, Toi, ToiOptions, ToiStatus};
use rapier3d_medial::math::{Real, Vector};
use rapier3d_medial::pair::first_contact::{Query, ToiResult};
use rapier3d_medial::pair::near_pairs::NearPairs;

/// Seconds of the motions that are listed for.
const SECONDS: Real = 0.02;

/// What is asked: as worlds ask it, for all of the bodies or for their cores, or for the first touch.
fn asked(case: u32) -> ToiOptions {
    let cores = |share| Cores {
        share,
        at_most: Real::INFINITY,
        tips: 0.2,
    };
    ToiOptions {
        target_distance: if case % 3 == 2 { 0.0 } else { 1.0e-3 },
        tolerance: 1.0e-4,
        initial_contact: match case % 3 {
            2 => InitialContact::Stop,
            _ => InitialContact::Deepen { by: 2.0e-3 },
        },
        cores: match case % 3 {
            0 => Some(cores(0.0)),
            1 => Some(cores(0.5)),
            _ => None,
        },
        ..ToiOptions::default()
    }
}

/// A motion from a place where the two bodies of a case are near each other or touch.
fn motion(rng: &mut Rng, at: Vector, speed: Real) -> NonlinearRigidMotion {
    NonlinearRigidMotion {
        start: rapier3d_medial::math::Pose::new(at, vector(rng) * 2.0),
        local_center: vector(rng) * 0.1,
        linvel: vector(rng) * speed,
        angvel: vector(rng) * speed,
    }
}

/// What an impact after some time makes of a motion: where the body is then, and velocities that differ by some share.
fn struck(
    rng: &mut Rng,
    old: &NonlinearRigidMotion,
    time: Real,
    share: Real,
) -> NonlinearRigidMotion {
    let by = share * (old.linvel.length() + old.angvel.length());
    NonlinearRigidMotion {
        start: old.position_at_time(time),
        linvel: old.linvel + vector(rng) * by,
        angvel: old.angvel + vector(rng) * by,
        ..*old
    }
}

/// Largest distance of a point of a mesh from the centre of rotation.
fn arm(mesh: &MedialMesh, center: Vector) -> f64 {
    let arm = |s: &rapier3d_medial::MedialSphere| (s.center - center).length() + s.radius;
    f64::from(mesh.spheres().iter().map(arm).fold(0.0, Real::max)) * 1.000_001
}

fn same(a: &Toi, b: &Toi) -> bool {
    let numbers = |t: &Toi| [t.lower, t.upper, t.tolerance].map(Real::to_bits);
    let places = |t: &Toi| (t.normal, t.points, t.spheres, t.primitives);
    a.status == b.status && numbers(a) == numbers(b) && places(a) == places(b)
}

/// One query of two meshes, with the list of what was near before an impact.
struct Asked {
    holds: bool,
    plain: ToiResult,
    listed: ToiResult,
}

/// `None` where too much is near for a list.
fn ask(rng: &mut Rng, meshes: [&MedialMesh; 2], case: u32) -> Option<Asked> {
    let reach = (arm(meshes[0], Vector::ZERO) + arm(meshes[1], Vector::ZERO)) as Real;
    let speed = rng.log_range(0.02, 3.0) as Real;
    let far = vector(rng).normalize_or_zero() * rng.range(0.2, 0.8) as Real * reach;
    let old = [Vector::ZERO, far].map(|at| motion(rng, at, speed));
    let time = rng.range(0.0, 0.8) as Real * SECONDS;
    let share = rng.log_range(0.01, 10.0) as Real;
    let new = [0, 1].map(|k| struck(rng, &old[k], time, share));
    let options = asked(case);
    let within = f64::from(options.target_distance) + f64::from(options.tolerance);
    let arms = [0, 1].map(|k| arm(meshes[k], old[k].local_center));
    let slide = f64::from((old[0].linvel - old[1].linvel).length());
    let swing = |k: usize| arms[k] * f64::from(old[k].angvel.length());
    let margin = 0.5 * (slide + swing(0) + swing(1)) * f64::from(SECONDS);
    let of = (meshes[0], meshes[1]);
    let near = NearPairs::new(of, &old, SECONDS, [within, margin], None)?;
    let left = SECONDS - time;
    let query = || Query::new(new.each_ref(), of, left, &options, None);
    Some(Asked {
        holds: near.holds_for(&new, left, arms, within),
        plain: query().settle(),
        listed: query().among(Some(near.pairs())).settle(),
    })
}

/// Of random meshes and of creatures, touching and apart; half of the impacts change the motions by less than the
/// margin. Where a list does not hold, some answers are others, so the bound is needed.
#[test]
fn a_list_answers_as_the_whole_search_does() {
    let mut rng = Rng::new(24);
    let creature = creature();
    let (mut held, mut contacts, mut deep, mut wrong) = (0, 0, 0, 0);
    for case in 0..3000 {
        let meshes = [0, 1].map(|_| mesh(&mut rng));
        let of = match case % 10 {
            0 => [&creature; 2],
            _ => meshes.each_ref(),
        };
        let Some(asked) = ask(&mut rng, of, case / 10) else {
            continue;
        };
        let is_same = same(&asked.plain.toi, &asked.listed.toi)
            && asked.plain.met == asked.listed.met
            && asked.plain.deepest.to_bits() == asked.listed.deepest.to_bits();
        if !asked.holds {
            wrong += u32::from(!is_same);
            continue;
        }
        assert!(is_same, "{case}: {:?}\n{:?}", asked.plain, asked.listed);
        held += 1;
        let hits = asked.plain.toi.status != ToiStatus::Separated;
        contacts += u32::from(hits);
        deep += u32::from(asked.plain.deepest.is_finite());
        assert!(asked.listed.counts.nodes <= asked.plain.counts.nodes);
        assert!(asked.listed.counts.tests <= asked.plain.counts.tests);
    }
    println!(
        "{held} held, {contacts} contacts, {deep} touch at the start, {wrong} wrong without the bound"
    );
    assert!(held > 1000 && contacts > 200 && deep > 200);
    assert!(wrong > 0);
}

/// Creatures that have met and are struck again: a list that is made once spares most of what each search looks at.
#[test]
fn a_list_spares_most_node_pairs() {
    let mut rng = Rng::new(25);
    let mesh = creature();
    let (mut plain, mut listed, mut listing, mut queries) = (0, 0, 0, 0);
    for _ in 0..40 {
        let away = vector(&mut rng).normalize_or_zero();
        let mut old = [Vector::ZERO, away * 3.0].map(|at| motion(&mut rng, at, 0.1));
        old[1].linvel = away * -3.0;
        let met = Query::new(old.each_ref(), (&mesh, &mesh), 1.0, &asked(0), None).settle();
        if met.toi.status != ToiStatus::Contact {
            continue;
        }
        old = old.map(|m| NonlinearRigidMotion {
            start: m.position_at_time(met.toi.lower),
            linvel: vector(&mut rng) * 0.5,
            ..m
        });
        let options = asked(0);
        let within = f64::from(options.target_distance) + f64::from(options.tolerance);
        let arms = old.map(|m| arm(&mesh, m.local_center));
        let of = (&mesh, &mesh);
        let near = NearPairs::new(of, &old, SECONDS, [within, 0.01], None).expect("slow turns");
        listing += near.nodes();
        for k in 0..10 {
            let time = 0.05 * k as Real * SECONDS;
            let new = [0, 1].map(|k| struck(&mut rng, &old[k], time, 0.3));
            if !near.holds_for(&new, SECONDS - time, arms, within) {
                continue;
            }
            queries += 1;
            let query = || Query::new(new.each_ref(), of, SECONDS - time, &options, None);
            plain += query().settle().counts.nodes;
            listed += query().among(Some(near.pairs())).settle().counts.nodes;
        }
    }
    println!("{queries} queries: {plain} node pairs, {listed} with lists that took {listing}");
    assert!(queries > 100);
    assert!(3 * listed < plain);
}
