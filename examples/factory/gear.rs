//! Spur gears with involute teeth of module 2 mm and a pressure angle of 20°, in a row on fixed axles. A tooth is a
//! strip of slabs along its middle: the spheres there that touch both flanks.

use super::Setting;
use super::nut::steel;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::f64::consts::TAU;
use std::time::Instant;

/// Module, half the width of a gear, and how much thinner a tooth is at the pitch circle, metres.
const MODULE: f64 = 2.0e-3;
const WIDTH: f64 = 4.0e-3;
const BACKLASH: f64 = 0.1e-3;
/// Slabs from a tooth's root to its tip.
const SLABS: usize = 3;
/// Teeth of the three gears.
pub const TEETH: [usize; 3] = [20, 30, 24];
/// Speed of the first, rad/s.
pub const DRIVEN: f64 = 5.0;

fn pitch_radius(teeth: usize) -> f64 {
    0.5 * MODULE * teeth as f64
}

/// Distance from the axis, and radius, of a sphere that touches both flanks of a tooth where the string that draws the
/// involute is unwound by an angle.
fn sphere(teeth: usize, unwound: f64) -> [f64; 2] {
    let base = pitch_radius(teeth) * 20.0_f64.to_radians().cos();
    let involute = |pressure: f64| pressure.tan() - pressure;
    let thinner = 0.5 * BACKLASH / pitch_radius(teeth);
    let half = 0.25 * TAU / teeth as f64 + involute(20.0_f64.to_radians()) - thinner;
    // The flank's normal touches the base circle at this angle from the tooth's middle, which it meets at `far`.
    let touches = half - unwound;
    let far = base / touches.cos();
    [far, (base * (unwound + touches.tan())).abs()]
}

/// A gear about the y axis, a tooth at angle 0.
pub fn gear(teeth: usize) -> Result<MedialMesh, MeshError> {
    let tip = pitch_radius(teeth) + MODULE;
    let reaches = |unwound: f64| {
        let [far, radius] = sphere(teeth, unwound);
        far + radius
    };
    // The outermost sphere ends at the tip circle.
    let (mut low, mut high) = (0.0, 1.5);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if reaches(middle) < tip {
            low = middle;
        } else {
            high = middle;
        }
    }
    let (mut spheres, mut faces) = (Vec::new(), Vec::new());
    let mut put = |far: f64, radius: f64, angle: f64, y: f64| {
        let center = [far * angle.cos(), y, -far * angle.sin()].map(|c| c as Real);
        spheres.push(MedialSphere::new(
            Vector::from_array(center),
            radius as Real,
        ));
        spheres.len() as u32 - 1
    };
    let half = WIDTH - 1.5e-3;
    for tooth in 0..teeth {
        let angle = TAU * tooth as f64 / teeth as f64;
        let mut last: Option<[u32; 2]> = None;
        for k in 0..=SLABS {
            let [far, radius] = sphere(teeth, low * k as f64 / SLABS as f64);
            let now = [-half, half].map(|y| put(far, radius, angle, y));
            if let Some([a, b]) = last {
                faces.extend([[a, b, now[0]], [b, now[1], now[0]]]);
            }
            last = Some(now);
        }
    }
    // The body: a rim within the roots.
    let rim = pitch_radius(teeth) - 1.25 * MODULE - 1.5e-3;
    let ring: Vec<u32> = (0..teeth)
        .map(|k| put(rim, 1.5e-3, TAU * k as f64 / teeth as f64, 0.0))
        .collect();
    let edges = (0..teeth)
        .map(|k| [ring[k], ring[(k + 1) % teeth]])
        .collect();
    let mesh = MedialMesh::new(spheres, edges, faces)?;
    let (radius, height) = (pitch_radius(teeth), 2.0 * WIDTH);
    let mass = 0.5 * TAU * radius * radius * height;
    let about = 0.5 * mass * radius * radius;
    let across = 0.5 * about + mass * height * height / 12.0;
    let inertia = [across, about, across].map(|i| i as Real);
    Ok(mesh.with_mass_properties(MassProperties::new(
        Vector::ZERO,
        mass as Real,
        Vector::from_array(inertia),
    )))
}

/// How the gears went.
pub struct Drive {
    /// Angles turned, rad.
    pub angles: [f64; 3],
    /// Primitives of the three.
    pub primitives: [usize; 3],
    /// Milliseconds of steps: median and worst.
    pub milliseconds: [f64; 2],
    /// Poses of all after each step.
    pub poses: Vec<[Pose; 3]>,
}

impl Drive {
    /// Ratio of the speeds of a gear and the first over that of their teeth, less 1.
    pub fn error(&self, gear: usize) -> f64 {
        let known = TEETH[0] as f64 / TEETH[gear] as f64;
        (self.angles[gear] / self.angles[0]).abs() / known - 1.0
    }
}

/// Drives the first gear for some seconds.
pub fn drive(setting: &Setting, seconds: f64) -> Result<Drive, String> {
    let mut world = setting.world();
    world.gravity = Vector::ZERO;
    let mut x = 0.0;
    let mut bodies = Vec::new();
    let mut primitives = [0; 3];
    for (k, teeth) in TEETH.into_iter().enumerate() {
        if k > 0 {
            x += pitch_radius(TEETH[k - 1]) + pitch_radius(teeth);
        }
        let mesh = gear(teeth).map_err(|e| e.to_string())?;
        primitives[k] = mesh.primitive_count();
        let mass = steel(&mesh.mass_properties(1.0));
        let at = Vector::X * x as Real;
        // A gap of the second meets the tooth of the first, and so on.
        let angle = if k == 1 {
            0.5 * TAU / teeth as f64
        } else {
            0.0
        };
        let body = match k {
            0 => RigidBodyBuilder::kinematic_velocity_based().angvel(Vector::Y * DRIVEN as Real),
            _ => RigidBodyBuilder::dynamic().can_sleep(false),
        };
        let body = body.translation(at).rotation(Vector::Y * angle as Real);
        let collider = ColliderBuilder::medial_mesh(mesh)
            .mass_properties(mass)
            .friction(0.1);
        let (body, _) = world.insert(body, collider);
        if k > 0 {
            let (axle, _) = world.insert(
                RigidBodyBuilder::fixed().translation(at),
                ColliderBuilder::ball(1.0e-4).sensor(true),
            );
            world.insert_impulse_joint(axle, body, RevoluteJointBuilder::new(Vector::Y));
        }
        bodies.push(body);
    }
    let mut pipeline = MedialPipeline::default();
    let mut drive = Drive {
        angles: [0.0; 3],
        primitives,
        milliseconds: [0.0; 2],
        poses: Vec::new(),
    };
    let mut times = Vec::new();
    let pose = |world: &PhysicsWorld, k: usize| *world.bodies[bodies[k]].position();
    for _ in 0..(seconds * f64::from(setting.hertz)) as usize {
        let before = [0, 1, 2].map(|k| pose(&world, k));
        let clock = Instant::now();
        pipeline.step(&mut world);
        times.push(1.0e3 * clock.elapsed().as_secs_f64());
        let after = [0, 1, 2].map(|k| pose(&world, k));
        for k in 0..3 {
            let turn = after[k].rotation * before[k].rotation.inverse();
            drive.angles[k] += f64::from(2.0 * turn.y.atan2(turn.w));
        }
        drive.poses.push(after);
    }
    times.sort_by(f64::total_cmp);
    drive.milliseconds = [times[times.len() / 2], times[times.len() - 1]];
    Ok(drive)
}
