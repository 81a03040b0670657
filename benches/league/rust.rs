//! rapier and this crate in the league: rings as compounds of capsules, and as medial meshes of as many cones.

use crate::record::{Run, Trajectory};
use crate::scenes::{Body, League, Shape, World};
use cpu_time::ProcessTime;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Medial,
    Plain,
    Ccd,
    SoftCcd,
}

fn vector(v: [f64; 3]) -> Vector {
    Vector::from_array(v.map(|x| x as Real))
}

fn ends(capsule: &[f64; 7]) -> ([Vector; 2], Real) {
    let [a, b, c, d, e, f, radius] = *capsule;
    ([vector([a, b, c]), vector([d, e, f])], radius as Real)
}

fn medial(shape: &Shape) -> Result<MedialMesh, MeshError> {
    if let Some(half) = shape.half {
        return MedialMesh::cuboid(vector(half));
    }
    let mut spheres: Vec<MedialSphere> = Vec::new();
    let mut edges = Vec::new();
    for capsule in &shape.capsules {
        let (ends, radius) = ends(capsule);
        edges.push(ends.map(|center| {
            let known = spheres.iter().position(|s| s.center == center);
            known.unwrap_or_else(|| {
                spheres.push(MedialSphere::new(center, radius));
                spheres.len() - 1
            }) as u32
        }));
    }
    MedialMesh::new(spheres, edges, vec![])
}

fn rapiers(shape: &Shape) -> SharedShape {
    if let Some(half) = shape.half {
        let half = vector(half);
        return SharedShape::cuboid(half.x, half.y, half.z);
    }
    let capsule = |c| {
        let ([a, b], radius) = ends(c);
        (Pose::IDENTITY, SharedShape::capsule(a, b, radius))
    };
    SharedShape::compound(shape.capsules.iter().map(capsule).collect())
}

impl Kind {
    fn shape(self, shape: &Shape) -> Result<SharedShape, MeshError> {
        Ok(match self {
            Self::Medial => SharedShape::new(medial(shape)?),
            _ => rapiers(shape),
        })
    }

    fn body(self, body: &Body, shape: &Shape) -> RigidBodyBuilder {
        let turn = Rotation::from_array(body.rotation.map(|x| x as Real));
        let (mass, inertia) = (shape.mass as Real, vector(shape.inertia));
        let prediction = if self == Self::SoftCcd { 10.0 } else { 0.0 };
        RigidBodyBuilder::dynamic()
            .pose(Pose::from_parts(vector(body.position), turn))
            .linvel(vector(body.velocity))
            .angvel(vector(body.spin))
            .additional_mass_properties(MassProperties::new(Vector::ZERO, mass, inertia))
            .allow_fast_rotation(true)
            .ccd_enabled(self == Self::Ccd)
            .soft_ccd_prediction(prediction)
            .can_sleep(false)
    }

    fn run(self, world: &World, league: &League, shapes: &[SharedShape]) -> Trajectory {
        let mut physics = PhysicsWorld::new();
        physics.gravity = Vector::Y * world.gravity as Real;
        physics.integration_parameters.dt = world.dt as Real;
        if world.restitution > 0.0 && self != Self::Medial {
            // rapier pushes bodies apart with speeds that elastic ones keep.
            physics
                .integration_parameters
                .normalized_max_corrective_velocity = 0.0;
        }
        let collider = |shape: SharedShape| {
            let collider = ColliderBuilder::new(shape).friction(world.friction as Real);
            collider.restitution(world.restitution as Real).density(0.0)
        };
        for wall in &world.walls {
            let half = vector(wall.half);
            let shape = SharedShape::cuboid(half.x, half.y, half.z);
            let place = vector(wall.center);
            physics.insert_collider(collider(shape).translation(place), None);
        }
        let insert = |b: &Body| {
            let body = self.body(b, &league.shapes[b.shape]);
            physics.insert(body, collider(shapes[b.shape].clone())).0
        };
        let bodies: Vec<_> = world.bodies.iter().map(insert).collect();
        let mut pipeline = MedialPipeline::default();
        let mut trajectory = Trajectory::default();
        for step in 1..=world.steps {
            let clock = ProcessTime::now();
            if self == Self::Medial {
                pipeline.step(&mut physics);
            } else {
                physics.step();
            }
            trajectory.ms.push(1.0e3 * clock.elapsed().as_secs_f64());
            if step % world.every == 0 {
                let state = |h: &RigidBodyHandle| {
                    let body = &physics.bodies[*h];
                    let place = body.translation().to_array().into_iter();
                    let turn = body.rotation().to_array();
                    let speeds = [body.linvel(), body.angvel()].map(|v| v.to_array());
                    place
                        .chain(turn)
                        .chain(speeds.into_iter().flatten())
                        .map(|x| Some(f64::from(x)))
                };
                let frame = bodies.iter().flat_map(|h| state(h).collect::<Vec<_>>());
                trajectory.frames.push(frame.collect());
            }
        }
        trajectory
    }
}

/// Runs all scenes with this crate and with rapier's own settings.
pub fn runs(league: &League) -> Result<Vec<Run>, String> {
    let kinds = [
        (Kind::Medial, "rapier3d-medial", "24 cones"),
        (Kind::Plain, "rapier", "compound"),
        (Kind::Ccd, "rapier", "compound with ccd_enabled"),
        (Kind::SoftCcd, "rapier", "compound with soft CCD of 10 m"),
    ];
    let run = |(kind, engine, setting): (Kind, &str, &str)| {
        let shapes: Result<Vec<_>, _> = league.shapes.iter().map(|s| kind.shape(s)).collect();
        let shapes = shapes.map_err(|e| e.to_string())?;
        let version = match kind {
            Kind::Medial => env!("CARGO_PKG_VERSION"),
            _ => "0.36",
        };
        eprintln!("{engine}, {setting}");
        Ok(Run {
            engine: engine.to_string(),
            version: version.to_string(),
            setting: setting.to_string(),
            is_wasm: false,
            worlds: league
                .worlds
                .iter()
                .map(|w| kind.run(w, league, &shapes))
                .collect(),
        })
    };
    kinds.into_iter().map(run).collect()
}
