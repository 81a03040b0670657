//! Has the GPU prove which pairs of meshes do not meet in a step: its buffers, and the one submission of a batch.

use super::clock::Clock;
use super::context::{Context, Growing};
use super::layout::{
    CullParams, MOST_MEETINGS, Node, PROOFS, Pair, Primitive, WALK_PAIRS, WALK_ROOM, WALKS,
};
use super::meshes::Meshes;
use super::shaders::CULL;
use super::stage::Stage;
use super::texels::{ROW, Texels};
use super::transfer::{ALIGNMENT, Target, Transfer};
use crate::error::GpuError;
use wgpu::BufferUsages;

/// Words after the answers: meetings found, and pairs taken.
const COUNTERS: usize = 2;

/// Bytes of a meeting.
const MEETING: usize = 16;

pub(super) struct Cull {
    /// Walk and proof.
    stages: Vec<Stage>,
    params: Growing,
    pairs: Texels,
    nodes: Texels,
    primitives: Texels,
    meetings: Growing,
    answers: Growing,
    bound: bool,
}

impl Cull {
    pub(super) fn new(context: &mut Context) -> Result<Self, GpuError> {
        let params = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let meetings = BufferUsages::STORAGE;
        let answers = meetings | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
        let bytes = size_of::<CullParams>() as u64;
        Ok(Self {
            stages: Stage::all(context, &CULL),
            params: Growing::new(context, "parameters", bytes, params)?,
            pairs: Texels::new(context, "mesh pairs")?,
            nodes: Texels::new(context, "nodes")?,
            primitives: Texels::new(context, "primitives")?,
            meetings: Growing::new(context, "meetings", 1, meetings)?,
            answers: Growing::new(context, "answers", 1, answers)?,
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
        // Of what may be replaced some may be, before there is no room for the rest.
        let bound = std::mem::replace(&mut self.bound, false);
        let (nodes, primitives) = (&meshes.nodes[..], &meshes.primitives[..]);
        let moved = self.nodes.reserve(context, size_of_val(nodes))?
            | self.primitives.reserve(context, size_of_val(primitives))?;
        if moved {
            meshes.send_again();
        }
        let meetings = room(pairs) * MEETING;
        let answers = answered(pairs) + COUNTERS * size_of::<u32>();
        let fresh = self.pairs.reserve(context, size_of_val(pairs))?
            | self.meetings.reserve(context, meetings as u64)?
            | self.answers.reserve(context, answers as u64)?;
        if moved || fresh || !bound {
            // As they are bound.
            let resources = [
                self.params.bound(),
                self.pairs.bound(),
                self.nodes.bound(),
                self.primitives.bound(),
                self.meetings.bound(),
                self.answers.bound(),
            ];
            for stage in &mut self.stages {
                stage.bind(context, &resources);
            }
        }
        self.bound = true;
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
        let (nodes, primitives) = meshes.sent;
        let (nodes, nodes_from) = unsent(&meshes.nodes, nodes * size_of::<Node>());
        let sent = primitives * size_of::<Primitive>();
        let (primitives, primitives_from) = unsent(&meshes.primitives, sent);
        let items: [(&[u8], Target<'_>); 4] = [
            (
                bytemuck::bytes_of(&params),
                Target::Buffer(&self.params.buffer, 0),
            ),
            (bytemuck::cast_slice(pairs), Target::Rows(&self.pairs, 0)),
            (nodes, Target::Rows(&self.nodes, nodes_from)),
            (primitives, Target::Rows(&self.primitives, primitives_from)),
        ];
        let sizes = items.map(|(bytes, to)| to.room(bytes.len()));
        up.begin(context, &sizes).await?;
        let timed = Clock::bytes(context.clock.as_ref());
        down.begin(context, &[answered(pairs), timed]).await?;
        let mut encoder = context.device.create_command_encoder(&Default::default());
        for (bytes, to) in items {
            up.send(&mut encoder, bytes, to)?;
        }
        // What was not looked at is not free, whatever the batch before said.
        let words = (answered(pairs) + COUNTERS * size_of::<u32>()) as u64;
        encoder.clear_buffer(&self.answers.buffer, 0, Some(words));
        // No more threads than it has, as far as they may take all: the next mesh pair goes to whichever
        // is done with one.
        let groups = |tasks: usize, each: usize| {
            let threads = context.threads.max(tasks.div_ceil(each));
            tasks.min(threads).div_ceil(WALKS)
        };
        let [walk, prove] = [0, 1].map(|k| &self.stages[k]);
        let stages = [
            (walk, groups(pairs.len(), WALK_PAIRS)),
            (prove, groups(room(pairs), PROOFS)),
        ];
        Stage::run(context, &mut encoder, &stages);
        down.receive(&mut encoder, &self.answers.buffer, answered(pairs));
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

/// What has not been sent of a list of which so many bytes have been, and the row that it starts in: a row
/// that was sent in part goes once more.
fn unsent<T: bytemuck::NoUninit>(list: &[T], sent: usize) -> (&[u8], usize) {
    let bytes: &[u8] = bytemuck::cast_slice(list);
    let from = match sent < bytes.len() {
        true => sent / ROW * ROW,
        false => bytes.len(),
    };
    (&bytes[from..], from / ROW)
}

/// Bytes of the answers that come back.
fn answered(pairs: &[Pair]) -> usize {
    size_of::<u32>() * pairs.len()
}

/// How many meetings there is room for: a walk holds so many at most.
fn room(pairs: &[Pair]) -> usize {
    (WALK_ROOM as usize * pairs.len()).min(MOST_MEETINGS)
}
