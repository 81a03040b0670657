//! Euler's disc: a ring that rolls on its edge while its axis goes round, ever flatter and faster, until it lies.

use super::bodies::{capsules, ring};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Radii of Euler's disc, a ring, metres, and its cones.
const RING: [Real; 2] = [0.3, 0.03];
const CONES: u32 = 64;

/// Rate, in rad/s, at which the ring's axis goes round while its centre rests and its lowest point rolls, at a tilt of
/// the ring's plane against the ground: Ω² = m g R / (sin α (I_t − I_a r sin α / (R + r sin α))). Of a thin ring it is
/// 2 g / (R sin α).
fn precession(tilt: Real) -> Real {
    let ([big, small], sin) = (RING, tilt.sin());
    let about_axis = big * big + 0.75 * small * small;
    let across = 0.5 * big * big + 0.625 * small * small;
    let share = small * sin / (big + small * sin);
    (9.81 * big / (sin * (across - about_axis * share))).sqrt()
}

/// How Euler's disc went.
#[derive(Default)]
pub struct Disc {
    /// The measured rate over that of theory, of each time that the axis went round.
    pub rates: Vec<Real>,
    /// Largest gain of energy in a step, of the height that it may fall by.
    pub gain: Real,
    /// Seconds until it sleeps.
    pub rests: Option<Real>,
    /// Tilt in the end, rad.
    pub tilt: Real,
}

impl Disc {
    /// Mean of the rates over that of theory.
    pub fn mean(&self) -> Real {
        self.rates.iter().sum::<Real>() / self.rates.len() as Real
    }
}

/// A world in which the ring rolls steadily at a tilt, on rough ground. Its own capsules are rapier's.
fn rolling_ring(is_medial: bool, hertz: Real, tilt: Real) -> (PhysicsWorld, RigidBodyHandle) {
    let mut world = PhysicsWorld::new();
    world.integration_parameters.dt = 1.0 / hertz;
    let ground = ColliderBuilder::cuboid(2.0, 0.5, 2.0).translation(Vector::Y * -0.5);
    world.insert_collider(ground.friction(1.0), None);
    let mesh = ring(CONES, RING[0], RING[1]);
    let mass = mesh.mass_properties(1000.0);
    let collider = if is_medial {
        ColliderBuilder::medial_mesh(mesh)
    } else {
        capsules(&mesh)
    };
    // The ring's axis leans to X, where its lowest point is.
    let rotation = Rotation::from_rotation_z(-tilt);
    let [big, small] = RING;
    let arm = rotation * Vector::X * big - Vector::Y * small;
    let spin = arm * (-precession(tilt) * tilt.sin() / (big + small * tilt.sin()));
    let body = RigidBodyBuilder::dynamic()
        .translation(Vector::Y * (big * tilt.sin() + small))
        .rotation(rotation.to_scaled_axis())
        .angvel(spin);
    let collider = collider.friction(1.0).mass_properties(mass);
    let (body, _) = world.insert(body, collider);
    (world, body)
}

/// Lets the ring roll for at most ten seconds.
pub fn euler(is_medial: bool, hertz: Real, tilt: Real) -> Disc {
    let (mut world, body) = rolling_ring(is_medial, hertz, tilt);
    let mut pipeline = MedialPipeline::default();
    let energy =
        |body: &RigidBody| body.kinetic_energy() + body.mass() * 9.81 * body.translation().y;
    let mut disc = Disc::default();
    let [mut turned, mut tilts, mut steps] = [0.0; 3];
    let mut axes = [Vector::X * tilt.sin(); 2];
    for step in 0..(10.0 * hertz) as usize {
        let before = energy(&world.bodies[body]);
        if is_medial {
            pipeline.step(&mut world);
        } else {
            world.step();
        }
        let ring = &world.bodies[body];
        if step > 0 {
            let falls = ring.mass() * 9.81 * RING[0] * tilt.sin();
            disc.gain = disc.gain.max((energy(ring) - before) / falls);
        }
        let up = *ring.rotation() * Vector::Y;
        let flat = Vector::new(up.x, 0.0, up.z);
        axes = [axes[1], flat];
        turned += axes[0].cross(flat).length().atan2(axes[0].dot(flat));
        disc.tilt = flat.length().atan2(up.y);
        tilts += disc.tilt;
        steps += 1.0;
        if turned > std::f32::consts::TAU {
            let known = precession(tilts / steps) * steps / hertz;
            disc.rates.push(turned / known);
            [turned, tilts, steps] = [0.0; 3];
        }
        if ring.is_sleeping() {
            disc.rests = Some((step + 1) as Real / hertz);
            break;
        }
    }
    disc
}
