//! A compute pipeline and what is bound to it.

use super::context::Context;
use super::layout::MAX_GROUPS;
use super::shaders::Module;
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, Buffer, CommandEncoder, ComputePipeline,
    ComputePipelineDescriptor, PipelineCompilationOptions, ShaderModuleDescriptor, ShaderSource,
};

/// One entry point of a shader.
pub(super) struct Stage {
    pipeline: ComputePipeline,
    /// Its place among those that are timed together.
    pub(super) index: u32,
    bound: Option<BindGroup>,
}

impl Stage {
    /// All entry points of a module.
    pub(super) fn all(context: &Context, module: &Module) -> Vec<Self> {
        let shader = context.device.create_shader_module(ShaderModuleDescriptor {
            label: Some(module.name),
            source: ShaderSource::Wgsl(module.source().into()),
        });
        let stage = |(index, name): (usize, &&'static str)| Self {
            index: index as u32,
            pipeline: context
                .device
                .create_compute_pipeline(&ComputePipelineDescriptor {
                    label: Some(name),
                    layout: None,
                    module: &shader,
                    entry_point: Some(name),
                    // Groups write what they read.
                    compilation_options: PipelineCompilationOptions {
                        zero_initialize_workgroup_memory: false,
                        ..Default::default()
                    },
                    cache: None,
                }),
            bound: None,
        };
        module.stages.iter().enumerate().map(stage).collect()
    }

    /// Binds buffers; they stay bound until the next call.
    pub(super) fn bind(&mut self, context: &mut Context, buffers: &[(u32, &Buffer)]) {
        let entries: Vec<_> = buffers
            .iter()
            .map(|&(binding, buffer)| BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        let group = context.device.create_bind_group(&BindGroupDescriptor {
            label: None,
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        context.bindings_made += 1;
        self.bound = Some(group);
    }

    /// Runs it over so many groups, folded into two dimensions.
    pub(super) fn run(&self, context: &Context, encoder: &mut CommandEncoder, groups: u32) {
        let x = groups.min(MAX_GROUPS);
        self.record(context, encoder, |pass| {
            pass.dispatch_workgroups(x, groups.div_ceil(x.max(1)), 1);
        });
    }

    /// Runs it over as many groups as a buffer says, `at` bytes in.
    pub(super) fn run_indirect(
        &self,
        context: &Context,
        encoder: &mut CommandEncoder,
        groups: &Buffer,
        at: u64,
    ) {
        self.record(context, encoder, |pass| {
            pass.dispatch_workgroups_indirect(groups, at)
        });
    }

    fn record(
        &self,
        context: &Context,
        encoder: &mut CommandEncoder,
        run: impl FnOnce(&mut wgpu::ComputePass<'_>),
    ) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: None,
            timestamp_writes: context.clock.as_ref().map(|c| c.writes(self.index)),
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, self.bound.as_ref(), &[]);
        run(&mut pass);
    }
}
