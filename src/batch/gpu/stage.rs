//! One stage of the work on the GPU: a compute pipeline and the buffers that are bound to it.

use super::context::Context;
use super::layout::MAX_GROUPS;
use super::shaders::Module;
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindingResource, CommandEncoder,
    ComputePipeline, ComputePipelineDescriptor, PipelineCompilationOptions, ShaderModuleDescriptor,
    ShaderSource,
};

/// One entry point of a shader.
pub(super) struct Stage {
    pipeline: ComputePipeline,
    /// Which of its module's bindings it uses.
    uses: &'static [usize],
    bound: Option<BindGroup>,
}

impl Stage {
    /// All entry points of a module.
    pub(super) fn all(context: &Context, module: &Module) -> Vec<Self> {
        let shader = context.device.create_shader_module(ShaderModuleDescriptor {
            label: Some(module.name),
            source: ShaderSource::Wgsl(module.source().into()),
        });
        let stage = |&(name, uses): &(&'static str, _)| Self {
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
            uses,
            bound: None,
        };
        module.stages.iter().map(stage).collect()
    }

    /// Binds what it uses of its module's resources; they stay bound until the next call.
    pub(super) fn bind(&mut self, context: &mut Context, resources: &[BindingResource]) {
        let entry = |&binding: &usize| BindGroupEntry {
            binding: binding as u32,
            resource: resources[binding].clone(),
        };
        let entries: Vec<_> = self.uses.iter().map(entry).collect();
        let group = context.device.create_bind_group(&BindGroupDescriptor {
            label: None,
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        context.bindings_made += 1;
        self.bound = Some(group);
    }

    /// Runs stages one after the other, each over so many groups, folded into two dimensions.
    pub(super) fn run(context: &Context, encoder: &mut CommandEncoder, stages: &[(&Self, usize)]) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: None,
            timestamp_writes: context.clock.as_ref().map(|c| c.writes()),
        });
        for (stage, groups) in stages {
            let groups = *groups as u32;
            let x = groups.min(MAX_GROUPS);
            pass.set_pipeline(&stage.pipeline);
            pass.set_bind_group(0, stage.bound.as_ref(), &[]);
            pass.dispatch_workgroups(x, groups.div_ceil(x.max(1)), 1);
        }
    }
}
