//! Mesh pairs that stay free: buffers, and the one submission.

use super::clock::Clock;
use super::context::{Context, Growing};
use super::layout::{CullParams, Meeting, Node, Pair, Primitive, WALK_ROOM, WALKS};
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
const MEETINGS: usize = 4;
const ANSWERS: usize = 5;

/// Words after the answers: meetings found, and pairs taken.
const COUNTERS: usize = 2;

/// Most meetings that a batch has room for, 16 bytes each; pairs beyond are given up.
const MOST_MEETINGS: usize = 1 << 20;

pub(super) struct Cull {
    /// Walk and proof.
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
            ("meetings", size_of::<Meeting>(), storage),
            (
                "answers",
                size_of::<u32>(),
                storage | BufferUsages::COPY_SRC,
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
        let fresh = reserve(PAIRS, size_of_val(pairs))?
            | reserve(MEETINGS, room(pairs) * size_of::<Meeting>())?
            | reserve(ANSWERS, answered(pairs) + COUNTERS * size_of::<u32>())?;
        if moved || fresh || !self.bound {
            let buffers: Vec<_> = self.buffers.iter().map(|b| &b.buffer).collect();
            for stage in &mut self.stages {
                stage.bind(context, &buffers);
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
            room: room(pairs) as u32,
        };
        let none = [0_u32; COUNTERS];
        let (nodes, primitives) = meshes.sent;
        let items: [(&[u8], usize, usize); 5] = [
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
            (bytemuck::bytes_of(&none), ANSWERS, answered(pairs)),
        ];
        up.begin(context, &items.map(|i| i.0.len())).await?;
        let timed = Clock::bytes(context.clock.as_ref());
        down.begin(context, &[answered(pairs), timed]).await?;
        let mut encoder = context.device.create_command_encoder(&Default::default());
        for (bytes, k, at) in items {
            up.send(&mut encoder, bytes, &self.buffers[k].buffer, at as u64)?;
        }
        // No more threads than it has: the next mesh pair goes to whichever is done with one.
        let groups = |threads: usize| threads.min(context.threads).div_ceil(WALKS);
        let [walk, prove] = [0, 1].map(|k| &self.stages[k]);
        let stages = [(walk, groups(pairs.len())), (prove, groups(room(pairs)))];
        Stage::run(context, &mut encoder, &stages);
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

/// How many meetings there is room for: a walk holds so many at most.
fn room(pairs: &[Pair]) -> usize {
    (WALK_ROOM as usize * pairs.len()).min(MOST_MEETINGS)
}
