//! Medial colliders in rapier's debug renderer, seen by a backend that records.

use crate::bodies::*;
use rapier3d::pipeline::{
    DebugColor, DebugRenderBackend, DebugRenderMode, DebugRenderObject, DebugRenderPipeline,
};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use rapier3d_medial::rapier::MedialDebugRender;

#[derive(Default)]
struct Recorder {
    lines: Vec<(Vector, Vector, DebugColor)>,
    hidden: Option<ColliderHandle>,
}

impl DebugRenderBackend for Recorder {
    fn filter_object(&self, object: DebugRenderObject) -> bool {
        !matches!(object, DebugRenderObject::Collider(h, _) if Some(h) == self.hidden)
    }
    fn draw_line(&mut self, _: DebugRenderObject, a: Vector, b: Vector, color: DebugColor) {
        self.lines.push((a, b, color));
    }
}

fn draw(
    render: &mut MedialDebugRender,
    pipeline: &DebugRenderPipeline,
    world: &PhysicsWorld,
    hidden: Option<ColliderHandle>,
) -> Vec<(Vector, Vector, DebugColor)> {
    let mut recorder = Recorder {
        hidden,
        ..Default::default()
    };
    let (bodies, colliders) = (&world.bodies, &world.colliders);
    render.render(
        pipeline,
        &mut recorder,
        bodies,
        colliders,
        &world.narrow_phase,
    );
    recorder.lines
}

/// Distance of a point to the circle of `n` chords that is a ring's medial axis, less the tube's radius.
fn off_ring(n: u32, pose: &Pose, point: Vector) -> Real {
    let p = pose.inverse_transform_point(point);
    let corner = |i: u32| {
        let angle = i as f64 / f64::from(n) * std::f64::consts::TAU;
        [
            f64::from(MAJOR) * angle.cos(),
            f64::from(MAJOR) * angle.sin(),
        ]
    };
    let (px, py, pz) = (f64::from(p.x), f64::from(p.y), f64::from(p.z));
    let to_chord = |i: u32| {
        let ([ax, az], [bx, bz]) = (corner(i), corner(i + 1));
        let (ux, uz) = (bx - ax, bz - az);
        let t = ((px - ax) * ux + (pz - az) * uz) / (ux * ux + uz * uz);
        let t = t.clamp(0.0, 1.0);
        let (dx, dz) = (px - ax - t * ux, pz - az - t * uz);
        (dx * dx + py * py + dz * dz).sqrt()
    };
    let nearest = (0..n).map(to_chord).fold(f64::MAX, f64::min);
    (nearest - f64::from(MINOR)) as Real
}

#[test]
fn lines_end_on_the_surface_and_follow_the_body() {
    let mut world = PhysicsWorld::new();
    let pose = Pose::new(Vector::new(3.0, -2.0, 1.0), Vector::new(0.4, 1.1, -0.3));
    add_ring(&mut world, As::Medial, pose);
    world.detect_collisions(&(), &());
    let pipeline = DebugRenderPipeline::default();
    let mut render = MedialDebugRender::default();
    render.medial_mesh = false;
    let lines = draw(&mut render, &pipeline, &world, None);
    assert!(lines.len() > 1000, "{} lines", lines.len());
    for (a, b, _) in &lines {
        for p in [a, b] {
            let off = off_ring(27, &pose, *p).abs();
            assert!(off < 1.0e-5, "{p} is {off} off");
        }
    }
    render.envelope = false;
    render.medial_mesh = true;
    let axis = draw(&mut render, &pipeline, &world, None);
    assert_eq!(axis.len(), 27);
    for (a, _, _) in &axis {
        assert!((off_ring(27, &pose, *a) + MINOR).abs() < 1.0e-5);
    }
}

#[test]
fn mode_filter_and_colours_are_as_rapier_has_them() {
    let mut world = PhysicsWorld::new();
    let ring = add_ring(&mut world, As::Medial, Pose::IDENTITY);
    let handle = world.bodies[ring].colliders()[0];
    // A ball on a body in the same state: rapier itself draws it.
    let ball = world
        .insert(RigidBodyBuilder::dynamic(), ColliderBuilder::ball(0.1))
        .1;
    let mut pipeline = DebugRenderPipeline::default();
    pipeline.mode = DebugRenderMode::COLLIDER_SHAPES;
    let mut render = MedialDebugRender::default();
    render.medial_mesh = false;
    let drawn = draw(&mut render, &pipeline, &world, None);
    assert!(draw(&mut render, &pipeline, &world, Some(handle)).is_empty());
    pipeline.mode = DebugRenderMode::IMPULSE_JOINTS;
    assert!(draw(&mut render, &pipeline, &world, None).is_empty());

    pipeline.mode = DebugRenderMode::COLLIDER_SHAPES;
    let mut both = |change: &dyn Fn(&mut PhysicsWorld)| {
        change(&mut world);
        let ours = draw(&mut render, &pipeline, &world, None)[0].2;
        let mut recorder = Recorder::default();
        pipeline.render_colliders(&mut recorder, &world.bodies, &world.colliders);
        assert_eq!(recorder.lines[0].2, ours);
        ours
    };
    let colors = [
        both(&|_| ()),
        both(&|w| w.bodies.iter_mut().for_each(|(_, b)| b.sleep())),
        both(&|w| {
            [handle, ball]
                .iter()
                .for_each(|h| w.colliders[*h].set_enabled(false))
        }),
        both(&|w| {
            [handle, ball]
                .iter()
                .for_each(|h| w.colliders[*h].set_enabled(true));
            let fix = |b: &mut RigidBody| b.set_body_type(RigidBodyType::Fixed, true);
            w.bodies.iter_mut().for_each(|(_, b)| fix(b));
        }),
    ];
    for i in 0..4 {
        for j in 0..i {
            assert_ne!(colors[i], colors[j], "states {i} and {j} look alike");
        }
    }
    assert!(!drawn.is_empty());
}

#[test]
fn lines_are_computed_once_for_shared_data_and_dropped_with_it() {
    let mut world = PhysicsWorld::new();
    let mesh = ring(27, MAJOR, MINOR);
    let handles: Vec<_> = (0..3)
        .map(|_| {
            let collider = ColliderBuilder::medial_mesh(mesh.clone());
            world.insert(RigidBodyBuilder::dynamic(), collider).0
        })
        .collect();
    let pipeline = DebugRenderPipeline::default();
    let mut render = MedialDebugRender::default();
    draw(&mut render, &pipeline, &world, None);
    assert_eq!(render.stored(), 1);
    for h in handles {
        world.remove_body(h);
    }
    draw(&mut render, &pipeline, &world, None);
    assert_eq!(render.stored(), 0);
}

#[test]
fn sphere_pairs_are_drawn_on_request() {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let lower = add_ring(&mut world, As::Medial, Pose::IDENTITY);
    let above = Pose::from_translation(Vector::new(0.0, 1.9 * MINOR, 0.0));
    add_ring(&mut world, As::Medial, above);
    let mut pipeline = attached(&mut world);
    pipeline.step(&mut world);
    let mut style = DebugRenderPipeline::default();
    style.mode = DebugRenderMode::CONTACTS;
    let mut render = MedialDebugRender::default();
    assert!(draw(&mut render, &style, &world, None).is_empty());
    render.sphere_pairs = true;
    let lines = draw(&mut render, &style, &world, None);
    let normals: Vec<_> = lines
        .iter()
        .filter(|l| l.2 == style.style.contact_normal_color)
        .collect();
    assert!(normals.len() >= 3, "{} normals", normals.len());
    let lower = world.bodies[lower].position();
    for (a, b, _) in &normals {
        let along = (*b - *a).normalize();
        assert!(along.y.abs() > 0.99, "{along}");
        assert!(off_ring(27, lower, *a).abs() < 1.0e-4, "{a}");
    }
    // The circles lie on the spheres: a tube's radius from the axis.
    let circles = lines
        .iter()
        .filter(|l| l.2 != style.style.contact_normal_color);
    let radii: Vec<Real> = circles.map(|l| (l.1 - l.0).length()).collect();
    let chord = 2.0 * MINOR * (std::f32::consts::PI / 24.0).sin();
    assert!(radii.iter().all(|r| (r - chord).abs() < 1.0e-4));
}
