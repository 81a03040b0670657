//! Worlds with many colliders that stand still, of which a step looks at those near what moves: they go on bit by bit
//! as if it looked at all.

use crate::bodies::bits;
use crate::rng::Rng;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use rapier3d_medial::rapier::Tuning;

/// Bodies in a row of the field, and rows; every seventh is fixed.
const FIELD: [usize; 2] = [16, 8];

/// A world, and the pipeline that steps it.
struct Stepped {
    world: PhysicsWorld,
    pipeline: MedialPipeline,
}

impl Stepped {
    fn new(world: PhysicsWorld, least_still: [usize; 2]) -> Self {
        let mut pipeline = MedialPipeline::default();
        let tuning = Tuning {
            least_still,
            ..Tuning::default()
        };
        pipeline.set_tuning(tuning);
        Self { world, pipeline }
    }
}

/// From this seed on only the fixed ones of a field are medial.
const FEW: usize = 3;

/// A collider of one of five kinds, and how high its centre lies on the ground.
fn collider(kind: usize) -> (ColliderBuilder, Real) {
    let ring = || MedialMesh::torus(0.25, 0.06, 12).expect("a ring");
    let block = || MedialMesh::cuboid(Vector::new(0.1, 0.2, 0.15)).expect("a block");
    match kind % 5 {
        0 | 1 => (ColliderBuilder::medial_mesh(ring()), 0.06),
        2 => (ColliderBuilder::medial_mesh(block()), 0.2),
        3 => (ColliderBuilder::cuboid(0.15, 0.1, 0.15), 0.1),
        _ => (ColliderBuilder::ball(0.15), 0.15),
    }
}

/// A field of bodies on the ground, some on top of others; still colliders are left out of a step from `least_still`
/// on.
fn field(least_still: [usize; 2], seed: usize) -> Stepped {
    let mut world = PhysicsWorld::new();
    let ground = ColliderBuilder::cuboid(40.0, 0.1, 40.0).translation(Vector::Y * -0.1);
    world.insert_collider(ground, None);
    for i in 0..FIELD[0] * FIELD[1] {
        let (collider, height) = collider(match seed < FEW {
            true => i + seed,
            false if i % 7 == 3 => i % 3,
            false => 3 + i % 2,
        });
        let x = (i % FIELD[0]) as Real * 0.62 - 5.0;
        let at = Vector::new(x, height, (i / FIELD[0]) as Real * 0.62 - 2.5);
        if i % 7 == 3 {
            world.insert_collider(collider.translation(at), None);
            continue;
        }
        let body = RigidBodyBuilder::dynamic().translation(at);
        world.insert(body.clone(), collider.clone());
        if i % 11 == 0 {
            let above = Vector::Y * (2.0 * height + 0.01);
            world.insert(body.translation(at + above), collider);
        }
    }
    Stepped::new(world, least_still)
}

#[test]
fn what_nothing_gets_to_is_left_out_and_no_bit_changes() {
    for seed in 0..2 * FEW {
        let mut both = [[usize::MAX, 0], [0, 0]].map(|least| field(least, seed));
        let mut rng = Rng::new(seed as u64 + 7);
        let mut least = usize::MAX;
        for step in 0..420 {
            if step >= 120 && step % 12 == 0 {
                let mut shot = Shot::random(&mut rng);
                if seed >= FEW {
                    shot.kind = 3 + shot.kind % 2;
                }
                both.iter_mut().for_each(|one| shot.fire(&mut one.world));
            }
            let reports = both.each_mut().map(|one| one.pipeline.step(&mut one.world));
            let [all, some] = reports;
            assert_eq!(all.completed, 0);
            assert!(some.participants <= all.participants);
            // Before that everything falls.
            if step >= 120 && some.participants > 0 {
                least = least.min(some.participants);
            }
            // A bit of the hooks makes rapier compute contacts anew.
            let hooks = |one: &Stepped| -> Vec<u32> {
                let colliders = one.world.colliders.iter();
                colliders.map(|(_, c)| c.active_hooks().bits()).collect()
            };
            let [all, some] = both.each_ref().map(|one| (bits(&one.world), hooks(one)));
            assert!(all == some, "seed {seed}, step {step}");
        }
        assert!(least < 20, "{least} colliders at least");
    }
}

/// A heavy ball strikes a light one that sleeps in a circle of fixed posts, off its middle.
fn circle(least_still: [usize; 2], aside: Real) -> Stepped {
    let ball = |radius| {
        MedialMesh::new(
            vec![MedialSphere::new(Vector::ZERO, radius)],
            vec![],
            vec![],
        )
    };
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    for k in 0..90 {
        let (z, x) = (k as Real * std::f32::consts::TAU / 90.0).sin_cos();
        let post =
            ColliderBuilder::capsule_y(0.5, 0.02).translation(Vector::new(0.6 * x, 0.0, 0.6 * z));
        world.insert_collider(post, None);
    }
    let light = RigidBodyBuilder::dynamic().sleeping(true);
    let mesh = ball(0.1).expect("a light ball");
    world.insert(light, ColliderBuilder::medial_mesh(mesh).density(1.0));
    let heavy = RigidBodyBuilder::dynamic().translation(Vector::new(0.0, 13.0, aside));
    let mesh = ball(0.2).expect("a heavy ball");
    let heavy = heavy.linvel(Vector::Y * -150.0);
    world.insert(heavy, ColliderBuilder::medial_mesh(mesh).density(1000.0));
    Stepped::new(world, least_still)
}

#[test]
fn what_is_flung_at_what_was_left_out_meets_it() {
    let mut completed = 0;
    for aside in [0.05, 0.1, 0.15, 0.2, 0.24, 0.27] {
        let mut both = [[usize::MAX, 0], [0, 0]].map(|least| circle(least, aside));
        for step in 0..12 {
            let reports = both.each_mut().map(|one| one.pipeline.step(&mut one.world));
            assert_eq!(reports[0].completed, 0);
            completed += reports[1].completed;
            let [all, some] = both.each_ref().map(|one| bits(&one.world));
            assert!(all == some, "{aside} aside, step {step}");
        }
    }
    assert!(completed > 0, "nothing got to what was left out");
}

/// A body thrown into the field, and one that is taken away.
struct Shot {
    kind: usize,
    from: Vector,
    velocity: Vector,
    spin: Vector,
    removed: Option<Real>,
}

impl Shot {
    fn random(rng: &mut Rng) -> Self {
        let mut side = || rng.range(-1.0, 1.0) as Real;
        let mut vector = || Vector::new(side(), side(), side());
        let [place, way, spin] = [vector(), vector(), vector()];
        let speed = [1.0, 5.0, 20.0, 80.0][rng.below(4)];
        Self {
            kind: rng.below(5),
            from: Vector::new(6.0 * place.x, 1.3 + place.y, 4.0 * place.z),
            velocity: Vector::new(way.x, -0.3 * way.y.abs(), way.z).normalize() * speed,
            spin: spin * 20.0,
            removed: (rng.below(3) == 0).then(|| rng.range(0.0, 1.0) as Real),
        }
    }

    fn fire(&self, world: &mut PhysicsWorld) {
        let body = RigidBodyBuilder::dynamic().translation(self.from);
        let body = body.linvel(self.velocity).angvel(self.spin);
        world.insert(body, collider(self.kind).0);
        if let Some(share) = self.removed {
            let bodies: Vec<RigidBodyHandle> = world.bodies.iter().map(|(h, _)| h).collect();
            world.remove_body(bodies[(share * (bodies.len() - 1) as Real) as usize]);
        }
    }
}
