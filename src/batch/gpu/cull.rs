//! Has the GPU prove (`shaders/cull.wgsl`, `swept.wgsl`) which pairs of meshes do not meet in a step, and list the
//! primitive pairs of the others that may: its buffers, and the one submission of a batch.

use super::clock::Clock;
use super::context::{Context, Growing};
use super::layout::{
    CullParams, LISTED, MEETINGS, MOST_MEETINGS, Near, Node, PROOFS, Pair, Primitive, WALK_FINDS,
    WALK_PAIRS, WALKS,
};
use super::meshes::Meshes;
use super::shaders::CULL;
use super::stage::Stage;
use super::texels::{ROW, Texels};
use super::transfer::{ALIGNMENT, CopyTarget, Transfer};
use crate::error::GpuError;
use wgpu::BufferUsages;

/// Words after the answers: meetings found, pairs taken, and primitive pairs listed.
const COUNTERS: usize = 3;

/// Bytes of a meeting.
const MEETING: usize = 16;

/// The two stages that prove mesh pairs free or list their primitive pairs, with their buffers.
pub(super) struct Cull {
    /// Walk and proof.
    stages: Vec<Stage>,
    params: Growing,
    pairs: Texels,
    nodes: Texels,
    primitives: Texels,
    meetings: Growing,
    near: Growing,
    answers: Growing,
    bound: bool,
    /// Sizes of the last submission.
    sent: Sent,
    /// Primitive pairs that the last list had, or would have had with more room.
    listed: usize,
    /// The answers that came back last, and what is counted after them.
    words: Vec<u32>,
}

/// Sizes of what is to come back of a submission.
#[derive(Clone, Copy, Debug, Default)]
struct Sent {
    pairs: usize,
    near_room: usize,
    stamp: u32,
}

/// Answers that have come back of a submission.
pub(super) struct Received<'a> {
    /// An answer for each mesh pair.
    pub(super) answers: &'a [u32],
    /// The list as far as it has room, with entries of batches before.
    pub(super) list: &'a [[u8; size_of::<Near>()]],
    /// Number that the entries of this batch bear.
    pub(super) stamp: u32,
}

impl Cull {
    pub(super) fn new(context: &mut Context) -> Result<Self, GpuError> {
        let params = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let meetings = BufferUsages::STORAGE;
        let near = meetings | BufferUsages::COPY_SRC;
        let answers = near | BufferUsages::COPY_DST;
        let bytes = size_of::<CullParams>() as u64;
        Ok(Self {
            stages: Stage::all(context, &CULL),
            params: Growing::new(context, "parameters", bytes, params)?,
            pairs: Texels::new(context, "mesh pairs")?,
            nodes: Texels::new(context, "nodes")?,
            primitives: Texels::new(context, "primitives")?,
            meetings: Growing::new(context, "meetings", 1, meetings)?,
            near: Growing::new(context, "near primitives", 1, near)?,
            answers: Growing::new(context, "answers", 1, answers)?,
            bound: false,
            sent: Sent::default(),
            listed: 0,
            words: Vec::new(),
        })
    }

    /// Room for meshes, pairs, and their answers.
    fn reserve(
        &mut self,
        context: &mut Context,
        pairs: &[Pair],
        meshes: &mut Meshes,
    ) -> Result<(), GpuError> {
        // The flag stays false if this fails: some buffers may be replaced before there is no room for the rest.
        let bound = std::mem::replace(&mut self.bound, false);
        let (nodes, primitives) = (&meshes.nodes[..], &meshes.primitives[..]);
        let moved = self.nodes.reserve(context, size_of_val(nodes))?
            | self.primitives.reserve(context, size_of_val(primitives))?;
        if moved {
            meshes.send_again();
        }
        let meetings = room(context, pairs) * MEETING;
        let answers = answered(pairs.len());
        let near = self.sent.near_room * size_of::<Near>();
        let fresh = self.pairs.reserve(context, size_of_val(pairs))?
            | self.meetings.reserve(context, meetings as u64)?
            | self.near.reserve(context, near as u64)?
            | self.answers.reserve(context, answers as u64)?;
        if moved || fresh || !bound {
            // In the order of the shader's bindings.
            let resources = [
                self.params.bound(),
                self.pairs.bound(),
                self.nodes.bound(),
                self.primitives.bound(),
                self.meetings.bound(),
                self.near.bound(),
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
        self.sent = Sent {
            pairs: pairs.len(),
            near_room: self.near_room(context, pairs),
            stamp: self.sent.stamp.wrapping_add(1),
        };
        self.reserve(context, pairs, meshes)?;
        let params = CullParams {
            pairs: pairs.len() as u32,
            room: room(context, pairs) as u32,
            near_room: self.sent.near_room as u32,
            stamp: self.sent.stamp,
        };
        let (nodes, primitives) = meshes.sent;
        let (nodes, nodes_from) = unsent(&meshes.nodes, nodes * size_of::<Node>());
        let sent = primitives * size_of::<Primitive>();
        let (primitives, primitives_from) = unsent(&meshes.primitives, sent);
        let items: [(&[u8], CopyTarget<'_>); 4] = [
            (
                bytemuck::bytes_of(&params),
                CopyTarget::Buffer(&self.params.buffer, 0),
            ),
            (
                bytemuck::cast_slice(pairs),
                CopyTarget::Rows(&self.pairs, 0),
            ),
            (nodes, CopyTarget::Rows(&self.nodes, nodes_from)),
            (
                primitives,
                CopyTarget::Rows(&self.primitives, primitives_from),
            ),
        ];
        let sizes = items.map(|(bytes, to)| to.room(bytes.len()));
        up.begin(context, &sizes).await?;
        let timed = Clock::bytes(context.clock.as_ref());
        let answers = answered(pairs.len());
        let near = self.sent.near_room * size_of::<Near>();
        down.begin(context, &[answers, near, timed]).await?;
        let mut encoder = context.device.create_command_encoder(&Default::default());
        for (bytes, to) in items {
            up.send(&mut encoder, bytes, to)?;
        }
        // A pair that was not looked at is not free, whatever the batch before said.
        encoder.clear_buffer(&self.answers.buffer, 0, Some(answers as u64));
        // No more threads than it has, as far as they may take all: the next mesh pair goes to whichever
        // is done with one.
        let groups = |tasks: usize, each: usize| {
            let threads = context.threads.max(tasks.div_ceil(each));
            tasks.min(threads).div_ceil(WALKS)
        };
        let [walk, prove] = [0, 1].map(|k| &self.stages[k]);
        let stages = [
            (walk, groups(pairs.len(), WALK_PAIRS)),
            (prove, groups(room(context, pairs), PROOFS)),
        ];
        Stage::run(context, &mut encoder, &stages);
        down.receive(&mut encoder, &self.answers.buffer, answers);
        down.receive(&mut encoder, &self.near.buffer, near);
        if let Some(clock) = &context.clock {
            let marks = clock.resolve(&mut encoder);
            down.receive(&mut encoder, marks, Clock::BYTES);
        }
        up.hand_over();
        context.queue.submit([encoder.finish()]);
        up.take_back();
        down.take_back();
        meshes.sent = (meshes.nodes.len(), meshes.primitives.len());
        Ok(())
    }

    /// Room for a list: for what the last one had and half as much again, so that a list that grows has it.
    fn near_room(&self, context: &Context, pairs: &[Pair]) -> usize {
        let [each, least] = LISTED;
        let expected = (each * pairs.len()).max(self.listed + self.listed / 2);
        expected.max(least).min(room(context, pairs))
    }

    /// Waits for the results of the last submission and hands them over; returns the seconds that the shader took.
    pub(super) async fn read(
        &mut self,
        context: &Context,
        down: &Transfer,
        take: impl FnOnce(Received),
    ) -> Result<f64, GpuError> {
        let Sent {
            pairs,
            near_room,
            stamp,
        } = self.sent;
        let (mut seconds, mut listed) = (0.0, 0);
        let mut take = Some(take);
        let to = &mut self.words;
        to.clear();
        down.read(context, |bytes| {
            let (words, bytes) = bytes.split_at(answered(pairs).next_multiple_of(ALIGNMENT));
            // Word by word: where the answers lie need not be aligned.
            to.extend(
                bytemuck::cast_slice(words)
                    .iter()
                    .copied()
                    .map(u32::from_le_bytes),
            );
            let (list, bytes) = bytes.split_at(near_room * size_of::<Near>());
            listed = (to[pairs + COUNTERS - 1] as usize).min(MOST_MEETINGS);
            let list: &[[u8; size_of::<Near>()]] = bytemuck::cast_slice(list);
            if let Some(take) = take.take() {
                take(Received {
                    answers: &to[..pairs],
                    list: &list[..listed.min(near_room)],
                    stamp,
                });
            }
            if let Some(clock) = &context.clock {
                seconds = clock.seconds(bytes);
            }
        })
        .await?;
        self.listed = listed;
        Ok(seconds)
    }
}

/// Rest of a list of which so many bytes have been sent, and the row that it starts in: a row that was sent in part
/// goes once more.
fn unsent<T: bytemuck::NoUninit>(list: &[T], sent: usize) -> (&[u8], usize) {
    let bytes: &[u8] = bytemuck::cast_slice(list);
    let from = match sent < bytes.len() {
        true => sent / ROW * ROW,
        false => bytes.len(),
    };
    (&bytes[from..], from / ROW)
}

/// Bytes of the answers to so many mesh pairs, and of what is counted after them.
fn answered(pairs: usize) -> usize {
    size_of::<u32>() * (pairs + COUNTERS)
}

/// How many meetings there is room for: of few mesh pairs each may have all that a walk finds.
fn room(context: &Context, pairs: &[Pair]) -> usize {
    let most = context.options.binding_bytes as usize / MEETING;
    let expected = 2 * WALK_FINDS as usize + MEETINGS * pairs.len();
    expected.min(MOST_MEETINGS).min(most)
}
