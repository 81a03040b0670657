//! The calls of the graphics library that a batch cannot do without, and nothing else: what they
//! allocate is not ours.

use crate::scene;
use rapier3d_medial::batch::gpu::shaders::Module;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use wgpu::*;

/// A device with a batch's stages and buffers, all zero: there is nothing to compute.
pub struct Bare {
    device: Device,
    queue: Queue,
    stages: Vec<(ComputePipeline, BindGroup)>,
    buffers: Vec<Buffer>,
    up: Buffer,
    down: Buffer,
    mapped: Arc<AtomicBool>,
}

/// Bytes of a buffer, and of a copy.
const BYTES: [u64; 2] = [4096, 64];

impl Bare {
    /// The first stages of a module. `None`, and says so, without an adapter.
    pub async fn open(module: &Module, stages: usize) -> Option<Self> {
        scene::gpu(scene::options())?;
        let mut descriptor = InstanceDescriptor::new_without_display_handle();
        descriptor.backends = Backends::PRIMARY;
        let instance = Instance::new(descriptor);
        let adapter = instance.request_adapter(&RequestAdapterOptions::default());
        let adapter = adapter.await.expect("an adapter");
        let opened = adapter.request_device(&DeviceDescriptor::default()).await;
        let (device, queue) = opened.expect("a device");
        let buffer = |usage| {
            device.create_buffer(&BufferDescriptor {
                label: Some("bare"),
                size: BYTES[0],
                usage,
                mapped_at_creation: usage.contains(BufferUsages::MAP_WRITE),
            })
        };
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
        let uniform = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let bindings = module.stages.iter().flat_map(|s| s.1).max().expect("some");
        let kind = |k| if k == 0 { uniform } else { storage };
        let buffers: Vec<_> = (0..=*bindings).map(|k| buffer(kind(k))).collect();
        let shader = device.create_shader_module(ShaderModuleDescriptor {
            label: Some(module.name),
            source: ShaderSource::Wgsl(module.source().into()),
        });
        let stage = |&(name, uses): &(&'static str, &[usize])| {
            let pipeline = device.create_compute_pipeline(&ComputePipelineDescriptor {
                label: Some(name),
                layout: None,
                module: &shader,
                entry_point: Some(name),
                compilation_options: PipelineCompilationOptions::default(),
                cache: None,
            });
            let entry = |&k: &usize| BindGroupEntry {
                binding: k as u32,
                resource: buffers[k].as_entire_binding(),
            };
            let entries: Vec<_> = uses.iter().map(entry).collect();
            let group = device.create_bind_group(&BindGroupDescriptor {
                label: None,
                layout: &pipeline.get_bind_group_layout(0),
                entries: &entries,
            });
            (pipeline, group)
        };
        Some(Self {
            stages: module.stages.iter().take(stages).map(stage).collect(),
            up: buffer(BufferUsages::MAP_WRITE | BufferUsages::COPY_SRC),
            down: buffer(BufferUsages::MAP_READ | BufferUsages::COPY_DST),
            mapped: Arc::default(),
            buffers,
            device,
            queue,
        })
    }

    fn wait(&self) {
        let polled = self.device.poll(PollType::wait_indefinitely());
        polled.expect("the device works");
    }

    /// Copies to these bindings, the stages, and the copy of the answers, which are the last binding. More
    /// groups keep the device busy.
    pub fn submit(&self, copies: &[usize], groups: u32) {
        self.wait();
        let mut encoder = self.device.create_command_encoder(&Default::default());
        for (from, &to) in (0..).step_by(BYTES[1] as usize).zip(copies) {
            let view = self.up.get_mapped_range_mut(from..from + BYTES[1]);
            view.expect("mapped").slice(..).fill(0);
            encoder.copy_buffer_to_buffer(&self.up, from, &self.buffers[to], 0, BYTES[1]);
        }
        let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor::default());
        for (pipeline, group) in &self.stages {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.dispatch_workgroups(groups, 1, 1);
        }
        drop(pass);
        let answers = &self.buffers[self.buffers.len() - 1];
        encoder.copy_buffer_to_buffer(answers, 0, &self.down, 0, BYTES[1]);
        self.up.unmap();
        self.queue.submit([encoder.finish()]);
        for (buffer, mode) in [(&self.up, MapMode::Write), (&self.down, MapMode::Read)] {
            // Whoever waits for a map has to be told; the library boxes what tells it.
            let mapped = self.mapped.clone();
            let done = move |result: Result<(), _>| mapped.store(result.is_ok(), Ordering::Relaxed);
            buffer.map_async(mode, .., done);
        }
    }

    /// Waits for the answers and reads them.
    pub fn collect(&self) {
        self.wait();
        assert!(self.mapped.swap(false, Ordering::Relaxed));
        let view = self.down.get_mapped_range(..).expect("mapped");
        assert_eq!(view[BYTES[1] as usize], 0);
        drop(view);
        self.down.unmap();
    }
}
