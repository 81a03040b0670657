//! Rings hang on a bar in bevy, without a window: ten seconds of the world's time, then where they are.
//!
//! ```text
//! bash bevy/check.sh --run
//! ```
//! Fails unless all rings hang.

use bevy::app::ScheduleRunnerPlugin;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d_medial::prelude::*;

const STEPS: u32 = 600;

fn main() -> AppExit {
    App::new()
        .add_plugins((
            MinimalPlugins.set(ScheduleRunnerPlugin::run_loop(Default::default())),
            TransformPlugin,
            RapierMedialPlugin::<NoUserData>::default(),
        ))
        .insert_resource(TimestepMode::Fixed {
            dt: 1.0 / 60.0,
            substeps: 1,
        })
        .add_systems(Startup, spawn)
        .add_systems(Last, report)
        .run()
}

fn spawn(mut commands: Commands) -> Result {
    commands.spawn((
        Collider::cuboid(20.0, 0.5, 20.0),
        Transform::from_xyz(0.0, -0.5, 0.0),
    ));
    let bar = MedialMesh::capsule(Vec3::NEG_X * 2.0, Vec3::X * 2.0, 0.08)?;
    commands.spawn((
        MedialCollider::from(bar),
        Transform::from_xyz(0.0, 2.0, 0.0),
    ));
    let ring = MedialMesh::torus(0.5, 0.1, 24)?;
    for k in 0..5 {
        let upright = Quat::from_rotation_z(std::f32::consts::FRAC_PI_2);
        commands.spawn((
            RigidBody::Dynamic,
            MedialCollider::from(ring.clone()),
            Transform::from_xyz(0.6 * (k as f32 - 2.0), 1.75, 0.0).with_rotation(upright),
        ));
    }
    Ok(())
}

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
