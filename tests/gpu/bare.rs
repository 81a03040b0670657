//! The calls of the graphics library that a batch cannot do without, and nothing else: what they
//! allocate is not ours.

use crate::scene;
use rapier3d_medial::batch::gpu::shaders::Module;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use wgpu::*;

/// What a stage uses.
enum Bound {
    Buffer(Buffer),
    Texture(Texture),
}

/// A device with a batch's stages, buffers and textures, all zero: there is nothing to compute.
pub struct Bare {
    device: Device,
    queue: Queue,
    stages: Vec<(ComputePipeline, BindGroup)>,
    bound: Vec<Bound>,
    up: Buffer,
    down: Buffer,
    mapped: Arc<AtomicBool>,
}

/// Bytes of a buffer, and of a copy.
const BYTES: [u64; 2] = [4096, 64];

/// Texels of a copy.
const SIZE: Extent3d = Extent3d {
    width: 4,
    height: 1,
    depth_or_array_layers: 1,
};

/// Which bindings of a module are textures.
fn textures(module: &Module) -> Vec<bool> {
    let parsed = naga::front::wgsl::parse_str(&module.source()).expect("a shader");
    let all = parsed.global_variables.iter().filter_map(|(_, variable)| {
        let is_texture = variable.space == naga::AddressSpace::Handle;
        Some((variable.binding?.binding, is_texture))
    });
    let mut all: Vec<_> = all.collect();
    all.sort_unstable();
    all.into_iter().map(|(_, is_texture)| is_texture).collect()
}

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
        let texture = || {
            device.create_texture(&TextureDescriptor {
                label: Some("bare"),
                size: SIZE,
                mip_level_count: 1,
                sample_count: 1,
                dimension: TextureDimension::D2,
                format: TextureFormat::Rgba32Uint,
                usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
                view_formats: &[],
            })
        };
        let kind = |(k, is_texture): (usize, bool)| match (k, is_texture) {
            (_, true) => Bound::Texture(texture()),
            (0, _) => Bound::Buffer(buffer(uniform)),
            _ => Bound::Buffer(buffer(storage)),
        };
        let bound: Vec<_> = textures(module).into_iter().enumerate().map(kind).collect();
        let views: Vec<_> = bound
            .iter()
            .map(|bound| match bound {
                Bound::Buffer(_) => None,
                Bound::Texture(texture) => Some(texture.create_view(&Default::default())),
            })
            .collect();
        let resource = |k: usize| match (&bound[k], &views[k]) {
            (Bound::Buffer(buffer), _) => buffer.as_entire_binding(),
            (_, view) => BindingResource::TextureView(view.as_ref().expect("a view")),
        };
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
                resource: resource(k),
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
            bound,
            device,
            queue,
        })
    }

    fn wait(&self) {
        let polled = self.device.poll(PollType::wait_indefinitely());
        polled.expect("the device works");
    }

    /// Copies to these bindings, the answers cleared where they are to be, the stages, and the copy of the
    /// answers, which are the last binding. More groups keep the device busy.
    pub fn submit(&self, copies: &[usize], cleared: bool, groups: u32) {
        self.wait();
        let mut encoder = self.device.create_command_encoder(&Default::default());
        for (from, &to) in (0..).step_by(BYTES[1] as usize).zip(copies) {
            let view = self.up.get_mapped_range_mut(from..from + BYTES[1]);
            view.expect("mapped").slice(..).fill(0);
            match &self.bound[to] {
                Bound::Buffer(to) => {
                    encoder.copy_buffer_to_buffer(&self.up, from, to, 0, BYTES[1]);
                }
                Bound::Texture(to) => {
                    let layout = TexelCopyBufferLayout {
                        offset: from,
                        bytes_per_row: None,
                        rows_per_image: None,
                    };
                    let from = TexelCopyBufferInfo {
                        buffer: &self.up,
                        layout,
                    };
                    encoder.copy_buffer_to_texture(from, to.as_image_copy(), SIZE);
                }
            }
        }
        let Some(Bound::Buffer(answers)) = self.bound.last() else {
            panic!("answers are in a buffer");
        };
        if cleared {
            encoder.clear_buffer(answers, 0, Some(BYTES[1]));
        }
        let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor::default());
        for (pipeline, group) in &self.stages {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.dispatch_workgroups(groups, 1, 1);
        }
        drop(pass);
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
