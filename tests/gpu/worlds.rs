//! Worlds stepped with batches on the GPU end as those on the CPU do, bit by bit.

use crate::detailed::{Form, detailed};
use crate::scene::{gpu, options};
use rapier3d::prelude::*;
use rapier3d_medial::batch::Batch;
use rapier3d_medial::prelude::*;

const STEPS: usize = 600;

/// Rings and frames that fall on each other, some fast, beside balls and a sleeping one far away.
fn mixed_world() -> PhysicsWorld {
    let mut world = PhysicsWorld::new();
    world.insert_collider(ColliderBuilder::cuboid(20.0, 0.5, 20.0), None);
    let ring = MedialMesh::torus(0.5, 0.1, 16).expect("a ring");
    let frame = MedialMesh::rectangle_frame(0.4, 0.3, 0.06).expect("a frame");
    for i in 0..14 {
        let x = 0.17 * (i % 3) as Real;
        let at = Vector::new(x, 1.0 + 0.45 * i as Real, -0.11 * (i % 4) as Real);
        let turn = Vector::new(0.4 * i as Real, 0.1, 0.7 * (i % 2) as Real);
        let mesh = if i % 3 == 0 { &frame } else { &ring };
        let body = RigidBodyBuilder::dynamic().pose(Pose::new(at, turn));
        let body = body.linvel(Vector::new(0.0, -(i as Real), 0.0));
        world.insert(body, ColliderBuilder::medial_mesh(mesh.clone()));
    }
    for i in 0..4 {
        let at = Vector::new(0.2 * i as Real, 9.0 + i as Real, 0.0);
        let body = RigidBodyBuilder::dynamic().translation(at);
        world.insert(body, ColliderBuilder::ball(0.2));
    }
    for side in [-1.0, 1.0] {
        let at = Vector::new(6.0 * side, 3.0, 0.0);
        let body = RigidBodyBuilder::dynamic().translation(at);
        let body = body.linvel(Vector::new(-120.0 * side, 0.0, 0.0));
        world.insert(body, ColliderBuilder::medial_mesh(ring.clone()));
    }
    world
}

fn bits(world: &PhysicsWorld) -> Vec<u32> {
    let each = |b: &RigidBody| {
        let (t, r, v, w) = (b.translation(), b.rotation(), b.linvel(), b.angvel());
        let all = [
            t.x, t.y, t.z, r.x, r.y, r.z, r.w, v.x, v.y, v.z, w.x, w.y, w.z,
        ];
        all.map(Real::to_bits)
    };
    world.bodies.iter().flat_map(|(_, b)| each(b)).collect()
}

#[test]
fn worlds_are_the_same_on_either_backend() {
    if gpu(options()).is_none() {
        return;
    }
    let [mut on_cpu, mut on_gpu] = [mixed_world(), mixed_world()];
    let pipeline = |backend| {
        let mut options = MedialOptions::default();
        options.backend = backend;
        MedialPipeline::new(options)
    };
    let [mut cpu, mut device] = [Backend::Cpu, Backend::Gpu].map(pipeline);
    cpu.attach(&mut on_cpu);
    device.attach(&mut on_gpu);
    let (mut jobs, mut first_contacts, mut settled, mut events) = (0, 0, 0, 0);
    let (mut contacts, mut early, mut made) = (0, 0, (0, 0));
    let mut unsent = 0;
    for step in 0..STEPS {
        let report = cpu.step(&mut on_cpu);
        assert_eq!(
            (report.batch.settled_by_gpu, report.batch.fallbacks),
            (0, 0)
        );
        let report = device.step(&mut on_gpu);
        assert_eq!(
            report.batch.fallbacks,
            0,
            "{:?}",
            device.batch().report().error
        );
        // One submission and one map a batch, two batches a step: the first contacts of this step and
        // the contacts of the next; the first step has its own to ask as well.
        assert_eq!(report.batch.submissions, report.batch.maps);
        let none_sent = u64::from(report.jobs > 0 && report.batch.sent_early == 0);
        unsent += none_sent;
        assert!(report.batch.submissions <= 2 + none_sent, "{report:?}");
        contacts += report.jobs as u64;
        early += report.batch.sent_early;
        if step == STEPS / 2 {
            let stock = device.batch().gpu_stock();
            made = (stock.buffers_made, stock.bindings_made);
        }
        // What the user changes between two steps was not sent.
        if step % 100 == 99 {
            for world in [&mut on_cpu, &mut on_gpu] {
                for (_, body) in world.bodies.iter_mut().skip(3).take(2) {
                    body.set_translation(Vector::new(0.1, 4.0, 0.2), true);
                }
            }
        }
        jobs += report.jobs + report.continuous_jobs;
        first_contacts += report.continuous_jobs;
        settled += report.batch.settled_by_gpu;
        events += report.events;
        assert!(bits(&on_cpu) == bits(&on_gpu), "step {step}");
    }
    // The first, and those after a change.
    assert!(unsent <= 6, "{unsent}");
    let gpu = device.batch().gpu_counts();
    let stock = device.batch().gpu_stock();
    assert_eq!((stock.meshes, gpu.submissions), (2, gpu.maps));
    let all = (stock.buffers_made, stock.bindings_made);
    assert_eq!(all, made, "after warm-up");
    assert!(early * 20 > contacts * 19, "{early} of {contacts}");
    println!("{early} of {contacts} jobs sent early");
    let listed = device.batch().report().counts.listed;
    println!("{listed} jobs with lists");
    assert!(listed > 1000, "{listed}");
    println!("{jobs} jobs, {settled} settled by the GPU, {events} events, {gpu:?}");
    assert!(
        jobs > 1000 && first_contacts > 10 && settled > 100 && events > 0,
        "{jobs} {first_contacts} {settled} {events}"
    );
}

/// As a browser does it: what a step is going to ask is awaited before the step.
#[test]
fn worlds_prepared_between_steps_are_the_same() {
    if gpu(options()).is_none() {
        return;
    }
    let [mut on_cpu, mut on_gpu] = [mixed_world(), mixed_world()];
    let batch = Batch::new(Backend::Gpu);
    let mut device = MedialPipeline::with_batch(MedialOptions::default(), batch);
    let mut cpu = MedialPipeline::new(MedialOptions::default());
    cpu.attach(&mut on_cpu);
    device.attach(&mut on_gpu);
    let (mut contacts, mut early) = (0, 0);
    for step in 0..90 {
        cpu.step(&mut on_cpu);
        pollster::block_on(device.prepare(&on_gpu));
        let maps = device.batch().report().counts.maps;
        let report = device.step(&mut on_gpu);
        let own = u64::from(report.continuous_jobs > 0);
        let next = device.batch().report().counts.maps - maps - own;
        // Nothing is waited for in the step but first contacts, and the next step's jobs are sent.
        assert!(next <= 1 || step == 0, "{report:?}");
        contacts += report.jobs as u64;
        early += report.batch.sent_early;
        assert!(bits(&on_cpu) == bits(&on_gpu), "step {step}");
    }
    assert!(
        contacts > 300 && early * 10 > contacts * 9,
        "{early} of {contacts}"
    );
}

/// Worlds of their own, each with a pipeline without a device: one submission a step serves all, until the device is
/// lost.
#[test]
fn worlds_that_share_a_device_are_the_same() {
    if gpu(options()).is_none() {
        return;
    }
    let ring = MedialMesh::torus(0.5, 0.1, 12).expect("a ring");
    let world = |number: usize| {
        let mut world = PhysicsWorld::new();
        world.insert_collider(ColliderBuilder::cuboid(20.0, 0.5, 20.0), None);
        for k in 0..3 + number % 3 {
            let turn = Vector::new(0.3 * number as Real, 0.7 * k as Real, 0.1);
            let at = Vector::new(0.1 * k as Real, 0.8 + 0.3 * k as Real, 0.0);
            let body = RigidBodyBuilder::dynamic().pose(Pose::new(at, turn));
            world.insert(body, ColliderBuilder::medial_mesh(ring.clone()));
        }
        world
    };
    // One without any body besides.
    let mut worlds: Vec<_> = (0..40).map(|n| [world(n), world(n)]).collect();
    worlds.push([PhysicsWorld::new(), PhysicsWorld::new()]);
    let pipelines = worlds
        .iter()
        .map(|_| [(); 2].map(|()| MedialPipeline::default()));
    let mut pipelines: Vec<_> = pipelines.collect();
    let mut batch = Batch::new(Backend::Gpu);
    let (mut jobs, mut early) = (0, 0);
    for step in 0..120 {
        let submissions = batch.report().counts.submissions;
        let all = pipelines.iter_mut().zip(&worlds);
        let all = all.map(|([shared, _], [world, _])| (shared, world));
        pollster::block_on(MedialPipeline::prepare_many(&mut batch, all));
        assert_eq!(
            batch.report().counts.submissions - submissions,
            u64::from(step < 90)
        );
        for (k, (pipelines, worlds)) in pipelines.iter_mut().zip(&mut worlds).enumerate() {
            let [shared, alone] = pipelines;
            let report = shared.step(&mut worlds[0]);
            assert_eq!((report.batch.submissions, report.batch.maps), (0, 0));
            assert_eq!(alone.step(&mut worlds[1]).batch.sent_early, 0);
            let [a, b] = &*worlds;
            assert!(bits(a) == bits(b), "world {k}, step {step}");
            if step < 90 {
                jobs += report.jobs as u64;
                early += report.batch.sent_early;
            }
        }
        if step == 89 {
            batch.gpu().expect("a device").lose();
        }
    }
    let of = |[shared, _]: &[MedialPipeline; 2]| shared.batch().report().counts.listed;
    let listed: u64 = pipelines.iter().map(of).sum();
    println!("{early} of {jobs} jobs sent early, {listed} with lists");
    assert!(
        jobs > 2000 && early == jobs && listed > 500,
        "{jobs} {early} {listed}"
    );
    assert_eq!(batch.report().counts.fallbacks, 1);
}

/// Bodies of slabs and cones in a heap, some of radius 0: bears, spiders, rings and sheets.
#[test]
fn heaps_of_detailed_bodies_are_the_same_on_either_backend() {
    if gpu(options()).is_none() {
        return;
    }
    let forms = [Form::Bear, Form::Spider, Form::Ring, Form::Sheet];
    let meshes = forms.map(|form| detailed(form, 60));
    let world = || {
        let mut world = PhysicsWorld::new();
        world.insert_collider(ColliderBuilder::cuboid(20.0, 0.5, 20.0), None);
        for k in 0..12 {
            let at = Vector::new(0.2 * (k % 3) as Real, 1.5 + 0.9 * k as Real, 0.1);
            let turn = Vector::new(0.5 * k as Real, 0.2, 0.3 * (k % 2) as Real);
            let body = RigidBodyBuilder::dynamic().pose(Pose::new(at, turn));
            let mesh = meshes[k % 4].clone();
            world.insert(body, ColliderBuilder::medial_mesh(mesh));
        }
        world
    };
    let [mut on_cpu, mut on_gpu] = [world(), world()];
    let mut cpu = MedialPipeline::default();
    let mut device = MedialPipeline::with_batch(MedialOptions::default(), Batch::new(Backend::Gpu));
    for step in 0..200 {
        cpu.step(&mut on_cpu);
        device.step(&mut on_gpu);
        assert!(bits(&on_cpu) == bits(&on_gpu), "step {step}");
    }
    let report = device.batch().report();
    println!("{report:?}");
    assert!(
        report.counts.listed > 300 && report.counts.settled_by_gpu > 300,
        "{report:?}"
    );
}

#[test]
fn a_world_goes_on_when_the_device_is_lost() {
    if gpu(options()).is_none() {
        return;
    }
    let [mut on_cpu, mut on_gpu] = [mixed_world(), mixed_world()];
    let batch = Batch::new(Backend::Gpu);
    let mut device = MedialPipeline::with_batch(MedialOptions::default(), batch);
    let mut cpu = MedialPipeline::new(MedialOptions::default());
    cpu.attach(&mut on_cpu);
    device.attach(&mut on_gpu);
    let mut fallbacks = 0;
    for step in 0..120 {
        if step == 60
            && let Some(gpu) = device.batch().gpu()
        {
            gpu.lose();
        }
        cpu.step(&mut on_cpu);
        fallbacks += device.step(&mut on_gpu).batch.fallbacks;
        assert_eq!(bits(&on_cpu), bits(&on_gpu), "step {step}");
    }
    assert!(fallbacks > 0 && device.batch().report().error.is_some());
}
