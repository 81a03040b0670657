//! Colliders from files, and from render meshes in the background.

use super::*;
use bevy::asset::{AssetPlugin, RenderAssetUsages};
use bevy::mesh::{Indices, PrimitiveTopology};

/// Waits for background work, thirty seconds at most.
fn until(app: &mut App, done: impl Fn(&World) -> bool) {
    for _ in 0..3000 {
        app.update();
        if done(app.world()) {
            return;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    panic!("background work has not ended");
}

#[derive(Resource, Default)]
struct Told(Vec<(Entity, Result<f32, String>)>);

fn hear(mut told: ResMut<Told>, mut built: MessageReader<MedialBuilt>) {
    for MedialBuilt { entity, outcome } in built.read() {
        let off = outcome.as_ref().map(|r| r.hausdorff.bound());
        told.0.push((*entity, off.map_err(String::clone)));
    }
}

/// A frame of square section: a cuboid with a square hole through it, along z.
fn frame() -> Mesh {
    let (mut corners, mut triangles) = (Vec::new(), Vec::new());
    for z in [-0.1f32, 0.1] {
        for r in [0.5f32, 0.3] {
            corners.extend([[-r, -r, z], [r, -r, z], [r, r, z], [-r, r, z]]);
        }
    }
    let mut quad = |a: u32, b: u32, c: u32, d: u32| triangles.extend([a, b, c, a, c, d]);
    for k in 0..4 {
        let n = (k + 1) % 4;
        quad(k, k + 4, n + 4, n); // below
        quad(k + 8, n + 8, n + 12, k + 12); // above
        quad(k, n, n + 8, k + 8); // outside
        quad(k + 4, k + 12, n + 12, n + 4); // inside
    }
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, corners)
    .with_inserted_indices(Indices::U32(triangles))
}

#[test]
fn render_meshes_are_built_in_the_background_once_for_all_who_ask() {
    let mut app = app(RapierMedialPlugin::<NoUserData>::default());
    app.add_plugins(AssetPlugin::default()).init_asset::<Mesh>();
    app.init_resource::<Told>().add_systems(Last, hear);
    app.finish();
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    let [good, lines] = [
        frame(),
        Mesh::new(PrimitiveTopology::LineList, RenderAssetUsages::default()),
    ]
    .map(|mesh| meshes.add(mesh));
    let options = BuildOptions {
        primitives: Some(20),
        quality: Quality::Fast,
        ..Default::default()
    };
    app.world_mut().spawn(ground());
    let mut spawn = |mesh: &Handle<Mesh>, height| {
        let build = MedialBuild {
            mesh: mesh.clone(),
            options: options.clone(),
        };
        let at =
            Transform::from_xyz(0.0, height, 0.0).with_rotation(Quat::from_rotation_x(FRAC_PI_2));
        app.world_mut()
            .spawn((
                RigidBody::Dynamic,
                GravityScale(0.0),
                Sleeping::disabled(),
                MedialCollider::Build(build),
                at,
            ))
            .id()
    };
    let [a, b, bad] = [spawn(&good, 1.0), spawn(&good, 2.0), spawn(&lines, 3.0)];
    until(&mut app, |world| world.resource::<Told>().0.len() == 3);
    let told = &app.world().resource::<Told>().0;
    let of = |entity| &told.iter().find(|(e, _)| *e == entity).expect("told").1;
    let Ok(off) = *of(a) else { panic!("{told:?}") };
    assert!(of(a) == of(b) && off < 0.2, "{told:?}");
    assert!(
        matches!(of(bad), Err(why) if why.contains("triangles")),
        "{told:?}"
    );
    for entity in [a, b] {
        app.world_mut().entity_mut(entity).insert(GravityScale(1.0));
    }
    run(&mut app, 300);
    let height = |e| {
        app.world()
            .get::<Transform>(e)
            .expect("a frame")
            .translation
            .y
    };
    let [low, high] = [height(a) - 0.1, height(b) - 0.3];
    assert!(
        (-0.01..off + 0.01).contains(&low),
        "too high by {low}, its surface is off by {off}"
    );
    assert!(
        (-0.01..3.0 * off + 0.01).contains(&high),
        "on it: too high by {high}, off by {off}"
    );
}

#[test]
fn medial_files_are_assets() {
    let folder = std::env::temp_dir().join(format!("bevy_rapier3d_medial_{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let ball = MedialMesh::ball(0.25).expect("a ball");
    std::fs::write(folder.join("ball.medial"), ball.to_bytes()).expect("a file");
    let mut app = app(RapierMedialPlugin::<NoUserData>::default());
    app.add_plugins(AssetPlugin {
        file_path: folder.display().to_string(),
        ..default()
    });
    app.finish();
    let file = app.world().resource::<AssetServer>().load("ball.medial");
    app.world_mut().spawn(ground());
    let at = Transform::from_xyz(0.0, 1.0, 0.0);
    let body = (
        RigidBody::Dynamic,
        GravityScale(0.0),
        Sleeping::disabled(),
        MedialCollider::Asset(file),
        at,
    );
    let body = app.world_mut().spawn(body).id();
    until(&mut app, |world| world.get::<Collider>(body).is_some());
    app.world_mut().entity_mut(body).insert(GravityScale(1.0));
    run(&mut app, 120);
    let height = app
        .world()
        .get::<Transform>(body)
        .expect("the ball")
        .translation
        .y;
    assert!((height - 0.25).abs() < 0.01, "it rests at {height}");
    std::fs::remove_dir_all(&folder).expect("removed");
}
