//! Batches: an answer is that of the single call, to the bit, whatever the number of threads.

use crate::ccd::rng::Rng;
use crate::meshes::{mesh, motion, vector};
use rapier3d_medial::batch::{PairJob, ToiJob, ToiResult, cpu};
use rapier3d_medial::elementary::{InitialContact, Toi, ToiOptions, ToiStatus};
use rapier3d_medial::math::{Pose, Real};
use rapier3d_medial::pair::{contacts, first_contact};

fn toi_jobs() -> Vec<ToiJob> {
    let mut rng = Rng::new(91);
    (0..300)
        .map(|k| {
            let mut options = ToiOptions::default();
            if k % 5 == 0 {
                options.initial_contact = InitialContact::Deepen { by: 1.0e-3 };
            }
            ToiJob {
                mesh1: mesh(&mut rng),
                motion1: motion(&mut rng, 0.0, 0.0, (k % 4) as Real),
                mesh2: mesh(&mut rng),
                motion2: motion(&mut rng, 0.6 + (k % 7) as Real * 0.4, 2.0, (k % 5) as Real),
                seconds: 1.0,
                options,
            }
        })
        .collect()
}

/// Every number of an answer, as bits: -0.0 is not 0.0 here.
fn bits(t: &Toi) -> Vec<u32> {
    let mut reals = vec![t.lower, t.upper, t.tolerance];
    for v in [t.normal, t.points[0], t.points[1]] {
        reals.extend(v.to_array());
    }
    for s in &t.spheres {
        reals.extend(s.center.to_array());
        reals.push(s.radius);
    }
    let mut bits: Vec<u32> = reals.into_iter().map(Real::to_bits).collect();
    bits.extend([t.status as u32, t.iterations]);
    bits.extend(t.primitives);
    bits
}

fn assert_same(a: &[ToiResult], b: &[ToiResult]) {
    assert_eq!(a.len(), b.len());
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        assert_eq!(bits(&a.toi), bits(&b.toi), "{k}: {a:?} {b:?}");
        assert_eq!(a.counts, b.counts, "{k}");
    }
}

#[test]
fn first_contacts_are_those_of_single_calls() {
    let jobs = toi_jobs();
    let answers = cpu::run(&jobs);
    assert_eq!(answers.len(), jobs.len());
    let mut hits = 0;
    for (j, answer) in jobs.iter().zip(&answers) {
        let single = first_contact(
            &j.mesh1, &j.motion1, &j.mesh2, &j.motion2, j.seconds, &j.options,
        );
        assert_eq!(bits(&single), bits(&answer.toi));
        hits += usize::from(single.status != ToiStatus::Separated);
    }
    assert!((90..=270).contains(&hits), "{hits} of 300 meet");
    assert_same(&cpu::run(&jobs), &answers);
    assert!(cpu::run::<ToiJob>(&[]).is_empty());
}

#[test]
fn contacts_are_those_of_single_calls() {
    let mut rng = Rng::new(92);
    let jobs: Vec<PairJob> = (0..200)
        .map(|k| PairJob {
            mesh1: mesh(&mut rng),
            mesh2: mesh(&mut rng),
            pos12: Pose::new(vector(&mut rng) * (0.01 * k as Real), vector(&mut rng)),
            prediction: 0.02,
        })
        .collect();
    let mut touching = 0;
    for (j, answer) in jobs.iter().zip(cpu::run(&jobs)) {
        let single = contacts(&j.mesh1, &j.mesh2, &j.pos12, j.prediction);
        assert_eq!((answer.contacts, answer.counts), single);
        touching += usize::from(!single.0.is_empty());
    }
    assert!((60..=190).contains(&touching), "{touching} of 200 touch");
}

#[cfg(feature = "parallel")]
#[test]
fn threads_do_not_change_a_bit() {
    let jobs = toi_jobs();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a thread pool").install(|| cpu::run(&jobs))
    };
    let one = on(1);
    for threads in [1, 2, 2, 3] {
        assert_same(&one, &on(threads));
    }
}
