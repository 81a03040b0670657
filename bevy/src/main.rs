//! Medial meshes in bevy: rings hang on a bar, stepped by this crate inside bevy_rapier's schedule.
//!
//! ```text
//! bash bevy/check.sh --run
//! ```
//! The plugin keeps its systems before and after the step; the one between is replaced by
//! [`step`], which calls [`MedialPipeline::step_sets`] with the sets that bevy_rapier holds. No window: the
//! program steps for ten seconds of the world's time, prints where the rings are, and fails unless all
//! hang.
//!
//! Not forwarded, since bevy_rapier keeps them to itself: its collision and contact force messages,
//! and its interpolation between steps.

use bevy::app::ScheduleRunnerPlugin;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::geometry::SharedShape;
use rapier3d_medial::MedialMesh;
use rapier3d_medial::prelude::*;

const STEPS: u32 = 600;

/// The pipeline of the one world.
#[derive(Resource)]
struct Medial(MedialPipeline);

fn main() {
    let physics = RapierPhysicsPlugin::<NoUserData>::default().with_physics_sets_systems(
        [PhysicsSet::SyncBackend, PhysicsSet::Writeback]
            .into_iter()
            .collect(),
    );
    App::new()
        .add_plugins((
            MinimalPlugins.set(ScheduleRunnerPlugin::run_loop(Default::default())),
            TransformPlugin,
            physics,
        ))
        .insert_resource(Medial(MedialPipeline::new(MedialOptions::default())))
        .add_systems(Startup, (attach, spawn).chain())
        .add_systems(PostUpdate, step.in_set(PhysicsSet::StepSimulation))
        .add_systems(Last, report)
        .run();
}

/// Before any collider is there: the narrow phase asks the pipeline.
fn attach(mut medial: ResMut<Medial>, mut context: Single<&mut RapierContextSimulation>) {
    let context = &mut **context;
    let (parameters, narrow_phase) = (
        &mut context.integration_parameters,
        &mut context.narrow_phase,
    );
    medial.0.attach_sets(parameters, narrow_phase);
}

fn spawn(mut commands: Commands) -> Result {
    commands.spawn((
        Collider::cuboid(20.0, 0.5, 20.0),
        Transform::from_xyz(0.0, -0.5, 0.0),
    ));
    // A bar to hang on.
    let bar = MedialMesh::capsule(Vec3::NEG_X * 2.0, Vec3::X * 2.0, 0.08)?;
    commands.spawn((
        Collider::from(SharedShape::medial_mesh(bar)),
        Transform::from_xyz(0.0, 2.0, 0.0),
    ));
    let ring = MedialMesh::torus(0.5, 0.1, 24)?;
    for k in 0..5 {
        let upright = Quat::from_rotation_z(std::f32::consts::FRAC_PI_2);
        commands.spawn((
            RigidBody::Dynamic,
            Collider::from(SharedShape::medial_mesh(ring.clone())),
            Transform::from_xyz(0.6 * (k as f32 - 2.0), 1.75, 0.0).with_rotation(upright),
        ));
    }
    Ok(())
}

type Sets = (
    &'static mut RapierContextSimulation,
    &'static mut RapierContextColliders,
    &'static mut RapierContextJoints,
    &'static mut RapierRigidBodySet,
    &'static RapierConfiguration,
);

/// In the place of bevy_rapier's own step: a sixtieth of a second each frame.
fn step(mut medial: ResMut<Medial>, world: Single<Sets>) {
    let (mut context, mut colliders, mut joints, mut bodies, settings) = world.into_inner();
    let (context, joints, bodies) = (&mut *context, &mut *joints, &mut *bodies);
    context.integration_parameters.dt = 1.0 / 60.0;
    medial.0.step_sets(
        &mut context.pipeline,
        settings.gravity,
        &context.integration_parameters,
        &mut context.islands,
        &mut context.broad_phase,
        &mut context.narrow_phase,
        &mut bodies.bodies,
        &mut colliders.colliders,
        &mut joints.impulse_joints,
        &mut joints.multibody_joints,
        &mut bodies.soft_bodies,
        &mut context.ccd_solver,
        &(),
        &(),
    );
}

/// After the last step: all rings hang on the bar, or the program fails.
fn report(
    mut steps: Local<u32>,
    rings: Query<&Transform, With<RigidBody>>,
    mut exit: MessageWriter<AppExit>,
) {
    *steps += 1;
    if *steps < STEPS {
        return;
    }
    let heights: Vec<f32> = rings.iter().map(|ring| ring.translation.y).collect();
    println!("heights of the rings after {STEPS} steps: {heights:.3?}");
    let hang = heights.len() == 5 && heights.iter().all(|y| (1.2..1.9).contains(y));
    exit.write(if hang {
        AppExit::Success
    } else {
        AppExit::error()
    });
}
