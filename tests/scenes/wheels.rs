//! Wheels of cones that roll freely on rapier's grounds.

use super::bodies::capsules;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// A kind of rapier's ground, level at height 0.
#[derive(Clone, Copy, Debug)]
pub enum Ground {
    Cuboid,
    HalfSpace,
    Tiles,
}

impl Ground {
    fn collider(self) -> ColliderBuilder {
        let tile = |x: i32, z: i32| {
            let at = Vector::new(x as Real + 0.5, -0.2, z as Real + 0.5);
            (
                Pose::from_translation(at),
                SharedShape::cuboid(0.5, 0.2, 0.5),
            )
        };
        match self {
            Self::Cuboid => ColliderBuilder::cuboid(20.0, 0.5, 20.0).translation(Vector::Y * -0.5),
            Self::HalfSpace => ColliderBuilder::new(SharedShape::halfspace(Vector::Y)),
            Self::Tiles => {
                let rows = (-20..20).flat_map(|x| [tile(x, -1), tile(x, 0)]);
                ColliderBuilder::compound(rows.collect())
            }
        }
    }
}

/// Speed after three seconds of a wheel that begins to roll at `speed` without slip, in metres per second, in the mean over
/// four starts: a torus of `cones` cones, 25 cm high at its axle, or rapier's capsules in its place.
pub fn rolled(is_medial: bool, ground: Ground, cones: u32, speed: Real) -> Real {
    let mesh = MedialMesh::torus(0.15, 0.1, cones as usize).expect("a wheel");
    let mass = mesh.mass_properties(1000.0);
    let starts = [0.0, 0.1e-3, 0.2e-3, 0.3e-3];
    let rolled = |gap: Real| {
        let mut world = PhysicsWorld::new();
        world.insert_collider(ground.collider().friction(1.0), None);
        let collider = match is_medial {
            true => ColliderBuilder::medial_mesh(mesh.clone()),
            false => capsules(&mesh),
        };
        let upright = Vector::X * std::f32::consts::FRAC_PI_2;
        let body = RigidBodyBuilder::dynamic()
            .pose(Pose::new(Vector::new(-8.0, 0.25 + gap, 0.0), upright))
            .linvel(Vector::X * speed)
            .angvel(Vector::NEG_Z * speed / 0.25)
            .can_sleep(false);
        let (wheel, _) = world.insert(body, collider.mass_properties(mass).friction(1.0));
        let mut pipeline = MedialPipeline::default();
        for _ in 0..180 {
            match is_medial {
                true => drop(pipeline.step(&mut world)),
                false => world.step(),
            }
        }
        world.bodies[wheel].linvel().x
    };
    starts.map(rolled).iter().sum::<Real>() / starts.len() as Real
}

/// What comes down ahead of a wheel's axle would stop it. On a half-space the wheel's top, which moves at twice its speed,
/// does not meet the ground.
#[test]
fn wheels_keep_as_much_speed_as_rapiers_own() {
    for ground in [Ground::Cuboid, Ground::HalfSpace, Ground::Tiles] {
        for (cones, speed) in [
            (32, 1.0),
            (32, 3.0),
            (96, 0.3),
            (96, 1.0),
            (96, 3.0),
            (300, 1.0),
        ] {
            let [own, ours] = [false, true].map(|m| rolled(m, ground, cones, speed));
            println!("{ground:?}, {cones} cones, {speed} m/s: {ours:.3} left, own {own:.3}");
            let case = format!("{ground:?}, {cones} cones: {ours} of {speed} m/s, own {own}");
            assert!(ours > own - 0.06 * speed, "{case}");
            assert!(ours < 1.01 * speed, "{case}");
        }
    }
}
