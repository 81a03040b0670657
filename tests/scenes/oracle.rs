//! What two bodies in free flight do, found without any collider: each flies alone in a world of its
//! own, and the distance of their spheres is sampled densely on the way. Until they first touch, two
//! bodies that may collide fly the same way.

use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Spheres sampled on each cone.
const PER_CONE: u32 = 10;
/// Moments sampled in each step: at 240 m/s bodies come 4 cm nearer from one to the next.
const PER_STEP: u32 = 100;
/// Distance, in metres, at which each moment is divided further, and into how many: 2 mm.
const NEAR: Real = 0.15;
const FINER: u32 = 20;
/// Steps of a case.
pub const STEPS: usize = 10;

/// How a body flies.
#[derive(Clone, Copy, Debug)]
pub struct Flight {
    pub pose: Pose,
    pub linvel: Vector,
    pub angvel: Vector,
}

impl Flight {
    pub fn body(&self) -> RigidBodyBuilder {
        RigidBodyBuilder::dynamic()
            .pose(self.pose)
            .linvel(self.linvel)
            .angvel(self.angvel)
    }

    /// Poses before each step and after the last.
    fn poses(&self, collider: ColliderBuilder) -> Vec<Pose> {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let handle = world.insert(self.body(), collider).0;
        world.bodies[handle].set_allow_fast_rotation(true);
        let mut poses = vec![self.pose];
        for _ in 0..STEPS {
            world.step();
            poses.push(*world.bodies[handle].position());
        }
        poses
    }
}

/// A body of the test.
#[derive(Clone)]
pub enum Solid {
    Medial(MedialMesh),
    Cuboid(Vector),
    /// A shape of rapier, of which parry's point projections tell the distance.
    Other(SharedShape),
}

impl Solid {
    pub fn collider(&self) -> ColliderBuilder {
        match self {
            Self::Medial(mesh) => ColliderBuilder::medial_mesh(mesh.clone()),
            Self::Cuboid(half) => ColliderBuilder::cuboid(half.x, half.y, half.z),
            Self::Other(shape) => ColliderBuilder::new(shape.clone()),
        }
    }

    fn spheres(mesh: &MedialMesh) -> Vec<(Vector, Real)> {
        let mut spheres = Vec::new();
        for &[i, j] in mesh.edges() {
            let (a, b) = (mesh.spheres()[i as usize], mesh.spheres()[j as usize]);
            for k in 0..=PER_CONE {
                let s = k as Real / PER_CONE as Real;
                let radius = a.radius + (b.radius - a.radius) * s;
                spheres.push((a.center.lerp(b.center, s), radius));
            }
        }
        spheres
    }
}

/// Pose between two, the shorter way round; steps turn by less than half a turn.
fn between(a: &Pose, b: &Pose, s: Real) -> Pose {
    Pose::from_parts(
        a.translation.lerp(b.translation, s),
        a.rotation.slerp(b.rotation, s),
    )
}

/// Smallest sampled distance of a medial body and another in free flight.
pub fn least_distance(solids: [&Solid; 2], flights: [&Flight; 2]) -> Real {
    let paths = [0, 1].map(|k| flights[k].poses(solids[k].collider()));
    let Solid::Medial(first) = solids[0] else {
        panic!("the first is medial");
    };
    let own = Solid::spheres(first);
    let others = match solids[1] {
        Solid::Medial(mesh) => Solid::spheres(mesh),
        _ => vec![],
    };
    let distance = |step: usize, s: Real| {
        let [p, q] = [0, 1].map(|i: usize| between(&paths[i][step], &paths[i][step + 1], s));
        if p.translation.distance(q.translation) > 3.0 {
            return Real::MAX;
        }
        let pos21 = q.inv_mul(&p);
        let to_other = |(center, radius): &(Vector, Real)| {
            let c = pos21 * *center;
            let nearest = match solids[1] {
                Solid::Medial(_) => others
                    .iter()
                    .map(|(other, r)| c.distance(*other) - r)
                    .fold(Real::MAX, Real::min),
                Solid::Cuboid(half) => {
                    let d = c.abs() - *half;
                    d.max(Vector::ZERO).length() + d.max_element().min(0.0)
                }
                Solid::Other(shape) => shape.distance_to_local_point(c, true),
            };
            nearest - radius
        };
        own.iter().map(to_other).fold(Real::MAX, Real::min)
    };
    let mut least = Real::MAX;
    for step in 0..STEPS {
        for k in 0..PER_STEP {
            let at = |fine: u32| (k as Real + fine as Real / FINER as Real) / PER_STEP as Real;
            let coarse = distance(step, at(0));
            least = least.min(coarse);
            if coarse < NEAR {
                let fine = (1..FINER).map(|f| distance(step, at(f)));
                least = fine.fold(least, Real::min);
            }
        }
    }
    least
}

/// Two fast bodies on a course that takes them about each other's way after some steps.
pub fn meeting(random: &mut Random) -> [Flight; 2] {
    let dt = 1.0 / 60.0;
    let speeds = [random.within(10.0, 120.0), random.within(10.0, 120.0)];
    let when = dt * random.within(4.0, 7.0);
    let toward = random.direction();
    let aside = random.direction().cross(toward).normalize_or_zero() * random.within(0.0, 1.4);
    let angle = random.within(-0.5, 0.5);
    let across = toward.cross(random.direction()).normalize_or_zero() * angle;
    let directions = [toward, (-toward + across).normalize()];
    [0, 1].map(|k| {
        let linvel = directions[k] * speeds[k];
        let meet = if k == 0 { Vector::ZERO } else { aside };
        let turn = random.direction() * random.within(0.0, 3.0);
        Flight {
            pose: Pose::new(meet - linvel * when, turn),
            linvel,
            angvel: random.direction() * random.within(0.0, 60.0),
        }
    })
}

/// Relative travel in a sub-step of [`sub_stepped`], in metres.
const SUB_TRAVEL: Real = 2.0e-3;
/// Bound on the size of the bodies: nearer than twice that, and their travel, steps are divided.
const SIZE: Real = 1.0;

/// Velocities of both bodies after each step, by rapier alone in sub-steps of at most 2 mm while they
/// are near. rapier's solver is then the reference for what an impact does.
pub fn sub_stepped(solids: [&Solid; 2], flights: [&Flight; 2]) -> Vec<[Vector; 2]> {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let handles = [0, 1].map(|k| {
        let handle = world.insert(flights[k].body(), solids[k].collider()).0;
        world.bodies[handle].set_allow_fast_rotation(true);
        handle
    });
    let dt = world.integration_parameters.dt;
    let mut velocities = Vec::new();
    for _ in 0..STEPS {
        let [a, b] = handles.map(|h| &world.bodies[h]);
        let swing = (a.angvel().length() + b.angvel().length()) * SIZE;
        let travel = (a.linvel().distance(b.linvel()) + swing) * dt;
        let near = a.translation().distance(b.translation()) < 2.0 * SIZE + travel;
        let parts = if near {
            (travel / SUB_TRAVEL).ceil().max(1.0)
        } else {
            1.0
        };
        world.integration_parameters.dt = dt / parts;
        for _ in 0..parts as u32 {
            world.step();
        }
        velocities.push(handles.map(|h| world.bodies[h].linvel()));
    }
    velocities
}
