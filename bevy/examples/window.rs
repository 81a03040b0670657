//! Rings fall over pegs and onto a bar, in a window of bevy. Space throws another ring.
//!
//! ```text
//! bash bevy/check.sh --window
//! bash bevy/check.sh --window rings.png   # saves a picture after 300 frames, and ends
//! ```

use std::f32::consts::FRAC_PI_2;

use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured, save_to_disk};
use bevy_rapier3d::prelude::*;
use bevy_rapier3d_medial::prelude::*;

const RING: f32 = 0.4;
const WIRE: f32 = 0.08;

fn main() {
    App::new()
        .add_plugins(DefaultPlugins)
        .add_plugins(RapierMedialPlugin::<NoUserData>::default())
        .add_systems(Startup, (look, ground, rings).chain())
        .add_systems(Update, (throw, picture))
        .run();
}

/// What a ring is drawn as, and what it collides as.
#[derive(Resource)]
struct Ring {
    mesh: Handle<Mesh>,
    materials: Vec<Handle<StandardMaterial>>,
    shape: MedialMesh,
}

fn look(mut commands: Commands) {
    commands.spawn((
        Camera3d::default(),
        Transform::from_xyz(0.0, 3.0, 6.0).looking_at(Vec3::Y * 0.9, Vec3::Y),
    ));
    commands.spawn((
        DirectionalLight {
            shadow_maps_enabled: true,
            ..default()
        },
        Transform::from_xyz(3.0, 8.0, 5.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}

fn ground(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) -> Result {
    let grey = materials.add(Color::srgb(0.35, 0.37, 0.4));
    let wood = materials.add(Color::srgb(0.55, 0.4, 0.25));
    commands.spawn((
        Collider::cuboid(20.0, 0.5, 20.0),
        Mesh3d(meshes.add(Cuboid::new(40.0, 1.0, 40.0))),
        MeshMaterial3d(grey),
        Transform::from_xyz(0.0, -0.5, 0.0),
    ));
    // Two pegs, and a bar that rings hang on.
    let (radius, half) = (0.1, 0.6);
    let peg = MedialMesh::capsule(Vec3::NEG_Y * half, Vec3::Y * half, radius)?;
    let drawn = meshes.add(Capsule3d::new(radius, 2.0 * half));
    let lying = Quat::from_rotation_z(FRAC_PI_2);
    for (at, turn) in [
        (Vec3::new(-1.8, half, 0.0), Quat::IDENTITY),
        (Vec3::new(1.8, half, 0.0), Quat::IDENTITY),
        (Vec3::new(0.0, 2.2, 0.0), lying),
    ] {
        commands.spawn((
            MedialCollider::from(peg.clone()),
            Mesh3d(drawn.clone()),
            MeshMaterial3d(wood.clone()),
            Transform::from_translation(at).with_rotation(turn),
        ));
    }
    let colors = [0x3a_7c_a5, 0xe0_7a_3f, 0x81_b2_9a, 0xf2_cc_60, 0xb5_50_5d];
    commands.insert_resource(Ring {
        mesh: meshes.add(Torus::new(RING - WIRE, RING + WIRE)),
        materials: colors
            .map(|rgb: u32| {
                let [_, r, g, b] = rgb.to_be_bytes();
                materials.add(Color::srgb_u8(r, g, b))
            })
            .to_vec(),
        shape: MedialMesh::torus(RING, WIRE, 24)?,
    });
    Ok(())
}

/// A body that is drawn and collides as a ring.
fn body(ring: &Ring, k: usize, at: Transform) -> impl Bundle {
    (
        RigidBody::Dynamic,
        MedialCollider::from(ring.shape.clone()),
        Mesh3d(ring.mesh.clone()),
        MeshMaterial3d(ring.materials[k % ring.materials.len()].clone()),
        at,
    )
}

fn rings(mut commands: Commands, ring: Res<Ring>) {
    let upright = Quat::from_rotation_z(FRAC_PI_2);
    for k in 0..4 {
        let x = 0.3 * (k as f32 - 1.5);
        let at = Transform::from_xyz(x, 1.95, 0.0).with_rotation(upright);
        commands.spawn(body(&ring, k, at));
    }
    for k in 0..8 {
        let side = if k % 2 == 0 { -1.8 } else { 1.8 };
        let at = Transform::from_xyz(side + 0.05, 2.0 + 0.5 * k as f32, 0.02)
            .with_rotation(Quat::from_rotation_x(0.1 * (k as f32 - 3.5)));
        commands.spawn(body(&ring, k, at));
    }
}

/// Throws a ring from the camera when Space is pressed.
fn throw(
    mut commands: Commands,
    keys: Res<ButtonInput<KeyCode>>,
    ring: Res<Ring>,
    mut thrown: Local<usize>,
) {
    if keys.just_pressed(KeyCode::Space) {
        let across = 1.8 * ((*thrown % 3) as f32 - 1.0);
        *thrown += 1;
        commands.spawn((
            body(&ring, *thrown, Transform::from_xyz(0.0, 3.0, 6.0)),
            Velocity::linear(Vec3::new(across, 2.0, -6.0)),
        ));
    }
}

/// Saves a picture to the file that the command line names, after 300 frames, and ends.
fn picture(mut commands: Commands, mut frames: Local<u32>) {
    *frames += 1;
    let Some(file) = std::env::args().nth(1).filter(|_| *frames == 300) else {
        return;
    };
    commands
        .spawn(Screenshot::primary_window())
        .observe(save_to_disk(file))
        .observe(
            |_: On<ScreenshotCaptured>, mut exit: MessageWriter<AppExit>| {
                exit.write(AppExit::Success);
            },
        );
}
