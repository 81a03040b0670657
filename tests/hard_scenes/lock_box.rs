//! A lock box (a fixture of Rigid-IPC): a key with a wide head hangs in the slot of a plate. It can leave only through
//! the opening at the slot's far end, after three turns; no blow brings it out elsewhere. Beside it stand rapier's own
//! shapes.

use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Half the plate's thickness, metres; its front is at this z.
const HALF: Real = 0.03;
/// Where the slot turns, from the key's place at the start to the opening.
const WAY: [[Real; 2]; 4] = [[0.0, 0.0], [0.4, 0.0], [0.4, 0.4], [0.0, 0.4]];
/// The plate without its slot of 0.1 and its opening of 0.26: x and y from and to.
const PLATE: [[Real; 4]; 8] = [
    [-0.3, -0.3, 0.7, -0.05],
    [-0.3, -0.05, -0.05, 0.05],
    [0.45, -0.05, 0.7, 0.53],
    [-0.3, 0.05, 0.35, 0.27],
    [0.13, 0.27, 0.35, 0.35],
    [-0.3, 0.27, -0.13, 0.53],
    [0.13, 0.45, 0.45, 0.53],
    [-0.3, 0.53, 0.7, 0.8],
];

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Medial,
    Rapiers,
    RapiersCcd,
}

/// The key's shaft goes through the plate; its head behind it is twice as wide as the slot.
const SHAFT: [(Vector, Real); 2] = [(HEAD.0, 0.04), (Vector::new(0.0, 0.0, 0.3), 0.04)];
const HEAD: (Vector, Real) = (Vector::new(0.0, 0.0, -0.14), 0.1);

struct LockBox {
    world: PhysicsWorld,
    pipeline: MedialPipeline,
    key: RigidBodyHandle,
    kind: Kind,
}

impl LockBox {
    fn new(kind: Kind) -> Self {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let block = |half: Vector| match kind {
            Kind::Medial => {
                ColliderBuilder::medial_mesh(MedialMesh::cuboid(half).expect("a block"))
            }
            _ => ColliderBuilder::cuboid(half.x, half.y, half.z),
        };
        for [x, y, to_x, to_y] in PLATE {
            let half = Vector::new(0.5 * (to_x - x), 0.5 * (to_y - y), HALF);
            let at = Vector::new(0.5 * (x + to_x), 0.5 * (y + to_y), 0.0);
            world.insert_collider(block(half).translation(at).friction(0.1), None);
        }
        // The back and the four sides of the box.
        let middle = Vector::new(0.2, 0.25, -0.18);
        let half = Vector::new(0.5, 0.55, 0.15);
        let sides = [Vector::X, -Vector::X, Vector::Y, -Vector::Y, -Vector::Z];
        for side in sides {
            let at = middle + side * (half + Vector::splat(HALF));
            let size = half * (Vector::ONE - side.abs()) + Vector::splat(HALF);
            world.insert_collider(block(size).translation(at).friction(0.1), None);
        }
        let shape = match kind {
            Kind::Medial => {
                let spheres = [SHAFT[0], SHAFT[1], HEAD].map(|(at, r)| MedialSphere::new(at, r));
                let mesh = MedialMesh::new(spheres.to_vec(), vec![[0, 1]], vec![]);
                ColliderBuilder::medial_mesh(mesh.expect("a key"))
            }
            _ => {
                let shaft = SharedShape::capsule(SHAFT[0].0, SHAFT[1].0, SHAFT[0].1);
                let head = (Pose::from_translation(HEAD.0), SharedShape::ball(HEAD.1));
                ColliderBuilder::compound(vec![(Pose::IDENTITY, shaft), head])
            }
        };
        let body = RigidBodyBuilder::dynamic()
            .ccd_enabled(kind == Kind::RapiersCcd)
            .can_sleep(false);
        let (key, _) = world.insert(body, shape.friction(0.1).density(1000.0));
        Self {
            world,
            pipeline: MedialPipeline::default(),
            key,
            kind,
        }
    }

    fn step(&mut self) {
        if self.kind == Kind::Medial {
            self.pipeline.step(&mut self.world);
        } else {
            self.world.step();
        }
    }

    fn at(&self) -> Vector {
        self.world.bodies[self.key].translation()
    }

    /// The middle of the key's head.
    fn head(&self) -> Vector {
        *self.world.bodies[self.key].position() * HEAD.0
    }

    /// Moves the key towards a place for two seconds at up to 1 m/s, upright; false if it did not come within 3 cm.
    fn lead(&mut self, to: Vector) -> bool {
        for _ in 0..120 {
            let body = &mut self.world.bodies[self.key];
            let way = (to - body.translation()) * 10.0;
            let turn = body.rotation().to_scaled_axis();
            body.set_linvel(way.clamp_length_max(1.0), true);
            body.set_angvel(turn * -10.0, true);
            self.step();
        }
        self.at().distance(to) < 0.03
    }

    /// Strikes the key outwards from its place, again and again; the blows after which its head was inside.
    fn strike(&mut self, blows: usize, speed: Real) -> usize {
        let mut random = Random(77);
        let mut held = 0;
        for _ in 0..blows {
            let body = &mut self.world.bodies[self.key];
            body.set_position(Pose::IDENTITY, true);
            body.set_linvel(Vector::Z * speed + random.direction() * (0.2 * speed), true);
            body.set_angvel(random.direction() * 10.0, true);
            // Too short for the way to the opening.
            for _ in 0..8 {
                self.step();
            }
            let head = self.head();
            let is_over = (-0.3..0.7).contains(&head.x) && (-0.3..0.8).contains(&head.y);
            held += usize::from(is_over && (-0.3..-HALF).contains(&head.z));
        }
        held
    }
}

/// The key goes out along the slot, and on no other way.
#[test]
fn a_key_leaves_its_lock_on_one_way_only() {
    let place = |[x, y]: [Real; 2]| Vector::new(x, y, 0.0);
    for kind in [Kind::Medial, Kind::Rapiers, Kind::RapiersCcd] {
        let mut slot = LockBox::new(kind);
        let turns = WAY.map(|at| slot.lead(place(at)));
        let is_out = slot.lead(place(WAY[3]) + Vector::Z);
        // Straight to the opening there is the plate.
        let mut short = LockBox::new(kind);
        let through = short.lead(place(WAY[3]));
        let out = short.lead(Vector::Z * 0.5);
        let held = [5.0, 20.0, 60.0].map(|speed| LockBox::new(kind).strike(20, speed));
        println!(
            "{kind:?}: turns {turns:?}, out {is_out}; through the plate {through}, out of the slot {out}; \
            of 20 blows held at 5, 20, 60 m/s: {held:?}"
        );
        if kind == Kind::Medial {
            assert!(turns.iter().all(|t| *t) && is_out, "{turns:?}, {is_out}");
            assert!(!through && !out);
            assert_eq!(held, [20; 3]);
        }
    }
}
