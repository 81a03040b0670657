//! Mesh pairs that stay free: buffers, and the one submission.

use super::clock::Clock;
use super::context::{Context, Growing};
use super::layout::{CullParams, Node, Pair, Primitive, WALKS};
use super::meshes::Meshes;
use super::shaders::CULL;
use super::stage::Stage;
use super::transfer::{ALIGNMENT, Transfer};
use crate::error::GpuError;
use wgpu::BufferUsages;

/// Indices of the buffers below, as they are bound.
const PARAMS: usize = 0;
const PAIRS: usize = 1;
const NODES: usize = 2;
const PRIMITIVES: usize = 3;
const ANSWERS: usize = 4;

pub(super) struct Cull {
    /// There is one.
    stages: Vec<Stage>,
    buffers: Vec<Growing>,
    bound: bool,
}

impl Cull {
    pub(super) fn new(context: &mut Context) -> Result<Self, GpuError> {
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let uniform = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let all = [
            ("parameters", size_of::<CullParams>(), uniform),
            ("mesh pairs", size_of::<Pair>(), storage),
            ("nodes", size_of::<Node>(), storage),
            ("primitives", size_of::<Primitive>(), storage),
            (
                "answers",
                size_of::<u32>(),
                BufferUsages::STORAGE | BufferUsages::COPY_SRC,
            ),
        ];
        let buffers = all
            .into_iter()
            .map(|(what, bytes, usage)| Growing::new(context, what, bytes as u64, usage))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            stages: Stage::all(context, &CULL),
            buffers,
            bound: false,
        })
    }

    /// Room for meshes, pairs, and their answers.
    fn reserve(
        &mut self,
        context: &mut Context,
        pairs: &[Pair],
        meshes: &mut Meshes,
    ) -> Result<(), GpuError> {
        let mut reserve = |k: usize, bytes| self.buffers[k].reserve(context, bytes as u64);
        let moved = reserve(NODES, size_of_val(&meshes.nodes[..]))?
            | reserve(PRIMITIVES, size_of_val(&meshes.primitives[..]))?;
        if moved {
            meshes.send_again();
        }
        let fresh = reserve(PAIRS, size_of_val(pairs))? | reserve(ANSWERS, answered(pairs))?;
        if moved || fresh || !self.bound {
            let numbered: Vec<_> = (0..)
                .zip(&self.buffers)
                .map(|(k, growing)| (k, &growing.buffer))
                .collect();
            for stage in &mut self.stages {
                stage.bind(context, &numbered);
            }
            self.bound = true;
        }
        Ok(())
    }

    /// One submission, its answers asked for.
    pub(super) async fn submit(
        &mut self,
        context: &mut Context,
        [up, down]: [&mut Transfer; 2],
        meshes: &mut Meshes,
        pairs: &[Pair],
    ) -> Result<(), GpuError> {
        self.reserve(context, pairs, meshes)?;
        let params = CullParams {
            pairs: pairs.len() as u32,
        };
        let (nodes, primitives) = meshes.sent;
        let items: [(&[u8], usize, usize); 4] = [
            (bytemuck::bytes_of(&params), PARAMS, 0),
            (bytemuck::cast_slice(pairs), PAIRS, 0),
            (
                bytemuck::cast_slice(&meshes.nodes[nodes..]),
                NODES,
                nodes * size_of::<Node>(),
            ),
            (
                bytemuck::cast_slice(&meshes.primitives[primitives..]),
                PRIMITIVES,
                primitives * size_of::<Primitive>(),
            ),
        ];
        up.begin(context, &items.map(|i| i.0.len())).await?;
        let timed = Clock::bytes(context.clock.as_ref());
        down.begin(context, &[answered(pairs), timed]).await?;
        let mut encoder = context.device.create_command_encoder(&Default::default());
        for (bytes, k, at) in items {
            up.send(&mut encoder, bytes, &self.buffers[k].buffer, at as u64)?;
        }
        for stage in &self.stages {
            stage.run(context, &mut encoder, pairs.len().div_ceil(WALKS) as u32);
        }
        down.receive(&mut encoder, &self.buffers[ANSWERS].buffer, answered(pairs));
        if let Some(clock) = &context.clock {
            clock.receive(&mut encoder, down);
        }
        up.hand_over();
        context.queue.submit([encoder.finish()]);
        up.take_back();
        down.take_back();
        meshes.sent = (meshes.nodes.len(), meshes.primitives.len());
        Ok(())
    }

    /// Waits for what the last submission found of each pair; returns the seconds of the
    /// shader.
    pub(super) async fn read(
        &self,
        context: &Context,
        down: &Transfer,
        answers: &mut [u32],
    ) -> Result<f64, GpuError> {
        let mut seconds = 0.0;
        down.read(context, |bytes| {
            let to: &mut [u8] = bytemuck::cast_slice_mut(answers);
            let size = to.len();
            to.copy_from_slice(&bytes[..size]);
            if let Some(clock) = &context.clock {
                let at = size.next_multiple_of(ALIGNMENT);
                seconds = clock.seconds(&bytes[at..]);
            }
        })
        .await?;
        Ok(seconds)
    }
}

/// Bytes of the answers that come back.
fn answered(pairs: &[Pair]) -> usize {
    size_of::<u32>() * pairs.len()
}
