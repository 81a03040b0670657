//! What detail costs, in counts: the same bodies in 50, 200 and 500 primitives, near each other and in motion.

use crate::detailed::{Form, detailed};
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::query::NonlinearRigidMotion;
use rapier3d_medial::pair::first_contact::{Counts, first_contact_counted};
use rapier3d_medial::pair::{contacts, nearest_spheres};
use rapier3d_medial::{InitialContact, MedialMesh, ToiOptions};

/// Pairs of each kind.
const PAIRS: usize = 60;
/// Length of a step in seconds.
const SECONDS: Real = 1.0 / 60.0;
/// Gap between the bodies, a length: as far as contacts are looked for.
const GAP: Real = 0.002;

struct Random(u64);

impl Random {
    fn next(&mut self) -> Real {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((self.0 >> 40) as Real / (1u64 << 24) as Real) * 2.0 - 1.0
    }

    fn vector(&mut self) -> Vector {
        Vector::new(self.next(), self.next(), self.next())
    }
}

/// The second body's pose at which it is `GAP` from the first, on the way to it from far off.
fn beside(mesh: &MedialMesh, random: &mut Random) -> Pose {
    let away = random.vector().normalize_or(Vector::X);
    let mut pose = Pose::new(away * 3.0, random.vector() * 3.0);
    // Along this line the distance falls by no more than the way: it never gets below the gap.
    for _ in 0..60 {
        let (nearest, _) = nearest_spheres(mesh, mesh, &pose, 10.0);
        let distance = nearest.map_or(0.0, |pair| pair.distance);
        if pose.translation.length() < distance {
            break;
        }
        pose.translation -= away * 0.9 * (distance - GAP);
    }
    pose
}

/// Node pairs and elementary tests of a query, in the mean: first contacts in motion, and contacts at rest.
#[derive(Debug)]
struct Work {
    nodes: [f64; 2],
    tests: [f64; 2],
}

fn work(form: Form, primitives: usize) -> Work {
    let mesh = detailed(form, primitives);
    let mut random = Random(7);
    let mut sums = [Counts::default(); 2];
    for _ in 0..PAIRS {
        let pose = beside(&mesh, &mut random);
        let motion = |pose: Pose, random: &mut Random| {
            let (linvel, angvel) = (random.vector() * 2.0, random.vector() * 4.0);
            NonlinearRigidMotion::new(pose, Vector::ZERO, linvel, angvel)
        };
        let first = motion(Pose::IDENTITY, &mut random);
        let second = motion(pose, &mut random);
        let options = ToiOptions {
            target_distance: 5.0e-4,
            tolerance: 1.0e-4,
            initial_contact: InitialContact::Deepen { by: 0.01 },
            ..ToiOptions::default()
        };
        let (_, moving) = first_contact_counted(&mesh, &first, &mesh, &second, SECONDS, &options);
        let (_, resting) = contacts(&mesh, &mesh, &pose, 2.0 * GAP);
        for (sum, counts) in sums.iter_mut().zip([moving, resting]) {
            sum.nodes += counts.nodes;
            sum.tests += counts.tests;
        }
    }
    Work {
        nodes: sums.map(|c| c.nodes as f64 / PAIRS as f64),
        tests: sums.map(|c| c.tests as f64 / PAIRS as f64),
    }
}

/// A quarter above what was counted: of each form in 50, 200 and 500 primitives the node pairs and elementary tests of
/// a first contact, then of contacts.
const MOST: [(Form, [[f64; 3]; 4]); 4] = [
    (
        Form::Ring,
        [
            [58.0, 78.0, 109.0],
            [2.8, 5.6, 18.3],
            [43.0, 145.0, 398.0],
            [10.5, 37.0, 141.0],
        ],
    ),
    (
        Form::Spider,
        [
            [92.0, 123.0, 143.0],
            [3.0, 3.7, 4.0],
            [75.0, 98.0, 139.0],
            [21.2, 8.6, 15.0],
        ],
    ),
    (
        Form::Bear,
        [
            [165.0, 346.0, 565.0],
            [21.7, 21.0, 23.4],
            [60.0, 386.0, 695.0],
            [64.0, 116.0, 180.0],
        ],
    ),
    (
        Form::Sheet,
        [
            [55.0, 82.0, 83.0],
            [1.2, 1.5, 1.8],
            [50.0, 82.0, 86.0],
            [60.0, 32.0, 34.0],
        ],
    ),
];

#[test]
fn queries_of_50_200_and_500_primitives_take_bounded_work() {
    for (form, most) in MOST {
        for (k, primitives) in [50, 200, 500].into_iter().enumerate() {
            let work = work(form, primitives);
            println!("{form:?} of {primitives} primitives: {work:?}");
            let [moving, resting] = [0, 1].map(|i| [work.nodes[i], work.tests[i]]);
            let counted = [moving, resting].concat();
            for (counted, most) in counted.into_iter().zip(most) {
                assert!(
                    counted > 0.0 && counted < most[k],
                    "{form:?} of {primitives} primitives: {work:?}"
                );
            }
        }
    }
}
