//! A nut on its bolt: let go without friction, turned by a torque, or hammered.

use super::thread::{Part, Thread};
use super::{Kind, Setting};
use rapier3d::glamx::DVec3;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::f64::consts::TAU;
use std::time::Instant;

/// What moves the nut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// Its weight, against so much friction.
    Weight(Real),
    /// A torque about the axis, against friction 0.1.
    Torque,
    /// A blow down the axis every tenth of a second that makes it 1 m/s faster, against friction 0.15.
    Hammer,
}

impl Drive {
    fn friction(self) -> Real {
        match self {
            Self::Weight(friction) => friction,
            Self::Torque => 0.1,
            Self::Hammer => 0.15,
        }
    }
}

/// The torque, of that with which friction 0.1 holds the nut by its weight.
const TORQUE: f64 = 3.0;

/// How a nut went.
#[derive(Clone, Debug, Default)]
pub struct Descent {
    /// Turns down the thread.
    pub turns: f64,
    /// Metres down.
    pub down: f64,
    /// Turns that theory calls for, where it does.
    pub known: Option<f64>,
    /// Most that the nut was off the height that its turns call for, in units of its axial play.
    pub off: f64,
    /// Deepest that a point of the nut's true thread was in the true bolt, metres.
    pub depth: f64,
    /// Most contact points with distance below 0 in a step.
    pub contacts: usize,
    /// Milliseconds of steps: median and worst.
    pub milliseconds: [f64; 2],
    /// Milliseconds of this crate's contacts, median.
    pub contact_milliseconds: f64,
    /// Turns and metres down after each step.
    pub ways: Vec<[f64; 2]>,
    /// Poses of the nut after each step.
    pub poses: Vec<Pose>,
}

impl Descent {
    /// Advance in a turn over the pitch, of a nut that made one more from half a turn on: the slope of the line nearest
    /// to all its ways from there. Its ends alone may be off by its axial play.
    pub fn advance(&self, thread: &Thread) -> Option<f64> {
        let begun = self.ways.iter().position(|[turns, _]| *turns >= 0.5)?;
        let ways = &self.ways[begun..];
        let count = ways.len() as f64;
        let [turns, down] = [0, 1].map(|k| ways.iter().map(|way| way[k]).sum::<f64>() / count);
        let both: f64 = ways.iter().map(|w| (w[0] - turns) * (w[1] - down)).sum();
        let square: f64 = ways.iter().map(|w| (w[0] - turns).powi(2)).sum();
        (self.turns - ways[0][0] >= 1.0).then(|| both / square / thread.pitch)
    }

    /// Whether the nut left its thread.
    pub fn tunnels(&self) -> bool {
        self.off > 2.0 || !self.off.is_finite()
    }
}

/// Colliders of a nut and its bolt.
pub fn colliders(thread: &Thread, kind: Kind) -> Result<[ColliderBuilder; 2], String> {
    let bolt = [-4.0 * thread.pitch - thread.nut[0], thread.nut[0]];
    let nut = thread.nuts_heights();
    let half = 0.5 * thread.nut[0];
    let parts = [(Part::Bolt, bolt, bolt), (Part::Nut, nut, [-half, half])];
    let made = parts.map(|(part, ridge, solid)| {
        if kind == Kind::Medial {
            let mesh = thread.medial(part, ridge).map_err(|e| e.to_string())?;
            return Ok(ColliderBuilder::medial_mesh(mesh));
        }
        let mesh = thread.triangles(part, solid, 48);
        kind.collider(mesh.vertices, mesh.indices)
    });
    let [bolt, nut] = made;
    Ok([bolt?, nut?.mass_properties(steel(&thread.nuts_mass()))])
}

/// Mass properties at the density of steel.
pub fn steel(of: &MassProperties) -> MassProperties {
    let density = 7850.0;
    MassProperties::new(
        of.local_com,
        density / of.inv_mass,
        of.principal_inertia() * density,
    )
}

/// Points of the nut's true thread, metres.
fn samples(thread: &Thread) -> Vec<[f64; 3]> {
    let [low, high] = thread.nuts_heights();
    let turns = (high - low) / thread.pitch;
    let count = (turns * 48.0) as usize;
    let mut points = Vec::new();
    for k in 0..=count {
        let (sin, cos) = (TAU * k as f64 / 48.0).sin_cos();
        for step in -7..=7 {
            // From the middle of the ridge down both flanks.
            let aside = f64::from(step) / 16.0 * thread.pitch;
            let y = low + (k as f64 / 48.0 + 0.5) * thread.pitch;
            let ridge = ((low / thread.pitch).floor() - low / thread.pitch) * thread.pitch;
            let r = thread.surface(Part::Nut, aside.abs());
            points.push([r * cos, y + ridge + aside, -r * sin]);
        }
    }
    points
}

fn deepest(thread: &Thread, points: &[[f64; 3]], pose: &Pose) -> f64 {
    let rotation = pose.rotation.as_dquat();
    let at = pose.translation.as_dvec3();
    let depth = |p: &[f64; 3]| thread.depth_in_bolt((rotation * DVec3::from_array(*p) + at).into());
    points.iter().map(depth).fold(f64::MIN, f64::max)
}

/// Lets a nut go for some seconds.
pub fn turn(
    thread: &Thread,
    [bolt, nut]: &[ColliderBuilder; 2],
    (kind, drive): (Kind, Drive),
    setting: &Setting,
    seconds: f64,
) -> Descent {
    let mut world = setting.world();
    let friction = drive.friction();
    world.insert(RigidBodyBuilder::fixed(), bolt.clone().friction(friction));
    // On the flanks below.
    let start = -0.9 * thread.axial_play();
    let body = RigidBodyBuilder::dynamic()
        .can_sleep(false)
        .translation(Vector::Y * start as Real);
    let (body, collider) = world.insert(body, nut.clone().friction(friction));
    let mut pipeline = MedialPipeline::default();
    let points = samples(thread);
    let mut descent = Descent::default();
    let (mut times, mut batches) = (Vec::new(), Vec::new());
    let steps = (seconds * f64::from(setting.hertz)).round() as usize;
    for step in 0..steps {
        let nut = &mut world.bodies[body];
        match drive {
            Drive::Torque => {
                let mass = f64::from(steel(&thread.nuts_mass()).mass());
                let holds = 0.1 * mass * 9.81 * thread.middle() / 0.75_f64.sqrt();
                nut.reset_torques(true);
                nut.add_torque(Vector::Y * -(TORQUE * holds) as Real, true);
            }
            Drive::Hammer if step % (setting.hertz as usize / 10) == 0 => {
                nut.set_linvel(nut.linvel() - Vector::Y, true);
            }
            _ => {}
        }
        let last = *world.bodies[body].position();
        let clock = Instant::now();
        if kind == Kind::Medial {
            let report = pipeline.step(&mut world);
            batches.push(1.0e3 * report.batch_seconds);
        } else {
            world.step();
        }
        times.push(1.0e3 * clock.elapsed().as_secs_f64());
        let pose = *world.bodies[body].position();
        let turn = pose.rotation * last.rotation.inverse();
        descent.turns -= f64::from(2.0 * turn.y.atan2(turn.w)) / TAU;
        descent.down = start - f64::from(pose.translation.y);
        let off = descent.down - start - descent.turns * thread.pitch;
        descent.off = descent.off.max(off.abs() / thread.axial_play());
        descent.depth = descent.depth.max(deepest(thread, &points, &pose));
        let pairs = world.narrow_phase.contact_pairs_with(collider);
        let touching = pairs.flat_map(|p| p.manifolds()).flat_map(|m| &m.points);
        descent.contacts = descent
            .contacts
            .max(touching.filter(|p| p.dist < 0.0).count());
        descent.poses.push(pose);
        descent.ways.push([descent.turns, descent.down]);
        if descent.off > 20.0 || !descent.off.is_finite() {
            break;
        }
    }
    times.sort_by(f64::total_cmp);
    batches.sort_by(f64::total_cmp);
    descent.milliseconds = [times[times.len() / 2], times[times.len() - 1]];
    descent.contact_milliseconds = batches.get(batches.len() / 2).copied().unwrap_or(f64::NAN);
    let accelerated = |by: f64| 0.5 * by * seconds * seconds;
    descent.known = match drive {
        Drive::Weight(0.0) => Some(accelerated(thread.acceleration()) / thread.pitch),
        _ => None,
    };
    descent
}
