//! Mesh pairs to primitive pairs: stages, lists and their growth. A list that overflows is never
//! cut: it is made as long as its counter says, and the step is asked for again.

use super::clock::{Clock, STAGES};
use super::context::{Context, Growing};
use super::layout::{
    CLUSTER, COUNTERS, Cluster, CullParams, NEAR, Pair, Primitive, SURVIVORS, Survivor, TILES, Tile,
};
use super::meshes::Meshes;
use super::shaders::CULL;
use super::stage::Stage;
use super::transfer::Transfer;
use crate::error::GpuError;
use wgpu::{Buffer, BufferUsages};

/// Bindings of each stage, in the order of the module's.
const BINDINGS: [&[u32]; 5] = [
    &[0, 1, 2, 4, 5],
    &[0, 4, 8],
    &[0, 1, 2, 3, 4, 5, 6],
    &[0, 4, 8],
    &[0, 1, 3, 4, 6, 7],
];

/// Indices of the buffers below.
const PARAMS: usize = 0;
const PAIRS: usize = 1;
const CLUSTERS: usize = 2;
const PRIMITIVES: usize = 3;
const COUNTS: usize = 4;
const LISTS: [usize; 3] = [5, 6, 7];
const GROUPS: usize = 8;

pub(super) struct Cull {
    stages: Vec<Stage>,
    buffers: Vec<Growing>,
    /// Entries that there is room for, in the order of the counters.
    room: [u32; 3],
    bound: bool,
}

/// What one run is asked.
pub(super) struct Asked<'a> {
    pub(super) pairs: &'a [Pair],
    /// Groups of all of them.
    pub(super) groups: u32,
    /// How long the lists have to be at least.
    pub(super) lists: [u32; 3],
}

/// What one run found.
pub(super) struct Found {
    /// Entries of the three lists, whether they had room or not.
    pub(super) counts: [u32; 3],
    /// Whether all had room.
    pub(super) complete: bool,
    /// Seconds of each stage.
    pub(super) stages: [f64; STAGES],
}

const ENTRY: [usize; 3] = [size_of::<Tile>(), size_of::<Tile>(), size_of::<Survivor>()];

impl Cull {
    pub(super) fn new(context: &mut Context) -> Result<Self, GpuError> {
        let stages = Stage::all(context, &CULL);
        let room = [context.options.list_capacity.max(1); 3];
        let (storage, dst) = (BufferUsages::STORAGE, BufferUsages::COPY_DST);
        let src = BufferUsages::COPY_SRC;
        let list = |k: usize| u64::from(room[k]) * ENTRY[k] as u64;
        let all = [
            (
                "parameters",
                size_of::<CullParams>() as u64,
                BufferUsages::UNIFORM | dst,
            ),
            ("mesh pairs", size_of::<Pair>() as u64, storage | dst),
            ("clusters", size_of::<Cluster>() as u64, storage | dst),
            ("primitives", size_of::<Primitive>() as u64, storage | dst),
            ("counters", 4 * COUNTERS as u64, storage | dst | src),
            ("cluster pairs", list(TILES), storage),
            ("primitive pairs", list(NEAR), storage),
            ("survivors", list(SURVIVORS), storage | src),
            ("groups", 24, storage | BufferUsages::INDIRECT),
        ];
        let buffers = all
            .into_iter()
            .map(|(what, bytes, usage)| Growing::new(context, what, bytes, usage))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            stages,
            buffers,
            room,
            bound: false,
        })
    }

    fn buffer(&self, k: usize) -> &Buffer {
        &self.buffers[k].buffer
    }

    /// Room for meshes, pairs, and lists at least as long as `lists`.
    fn reserve(
        &mut self,
        context: &mut Context,
        pairs: &[Pair],
        meshes: &mut Meshes,
        lists: [u32; 3],
    ) -> Result<(), GpuError> {
        let mut fresh = self.buffers[PAIRS].reserve(context, size_of_val(pairs) as u64)?;
        let clusters = size_of_val(&meshes.clusters[..]) as u64;
        let primitives = size_of_val(&meshes.primitives[..]) as u64;
        let moved = self.buffers[CLUSTERS].reserve(context, clusters)?
            | self.buffers[PRIMITIVES].reserve(context, primitives)?;
        if moved {
            meshes.send_again();
        }
        fresh |= moved;
        for (k, wanted) in lists.into_iter().enumerate() {
            if wanted > self.room[k] {
                let bytes = u64::from(wanted) * ENTRY[k] as u64;
                fresh |= self.buffers[LISTS[k]].reserve(context, bytes)?;
                self.room[k] = wanted;
            }
        }
        if fresh || !self.bound {
            for (stage, bindings) in self.stages.iter_mut().zip(BINDINGS) {
                let numbered: Vec<_> = bindings
                    .iter()
                    .map(|&k| (k, &self.buffers[k as usize].buffer))
                    .collect();
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
        asked: Asked<'_>,
    ) -> Result<(), GpuError> {
        let Asked {
            pairs,
            groups,
            lists,
        } = asked;
        self.reserve(context, pairs, meshes, lists)?;
        let params = CullParams {
            pairs: pairs.len() as u32,
            groups,
            tile_capacity: self.room[TILES],
            near_capacity: self.room[NEAR],
            survivor_capacity: self.room[SURVIVORS],
        };
        let (clusters, primitives) = meshes.sent;
        let items: [(&[u8], usize, usize); 4] = [
            (bytemuck::bytes_of(&params), PARAMS, 0),
            (bytemuck::cast_slice(pairs), PAIRS, 0),
            (
                bytemuck::cast_slice(&meshes.clusters[clusters..]),
                CLUSTERS,
                clusters * size_of::<Cluster>(),
            ),
            (
                bytemuck::cast_slice(&meshes.primitives[primitives..]),
                PRIMITIVES,
                primitives * size_of::<Primitive>(),
            ),
        ];
        let (counted, listed) = self.answered();
        up.begin(context, &items.map(|i| i.0.len())).await?;
        let timed = Clock::bytes(context.clock.as_ref());
        down.begin(context, &[counted, listed, timed]).await?;
        let mut encoder = context.device.create_command_encoder(&Default::default());
        for (bytes, buffer, at) in items {
            up.send(&mut encoder, bytes, self.buffer(buffer), at as u64)?;
        }
        encoder.clear_buffer(self.buffer(COUNTS), 0, None);
        let counted_groups = self.buffer(GROUPS);
        self.stages[0].run(context, &mut encoder, groups);
        self.stages[1].run(context, &mut encoder, 1);
        self.stages[2].run_indirect(context, &mut encoder, counted_groups, 0);
        self.stages[3].run(context, &mut encoder, 1);
        self.stages[4].run_indirect(context, &mut encoder, counted_groups, 12);
        down.receive(&mut encoder, self.buffer(COUNTS), counted);
        down.receive(&mut encoder, self.buffer(LISTS[SURVIVORS]), listed);
        if let Some(clock) = &context.clock {
            clock.receive(&mut encoder, down, STAGES as u32);
        }
        up.hand_over();
        context.queue.submit([encoder.finish()]);
        up.take_back();
        down.take_back();
        meshes.sent = (meshes.clusters.len(), meshes.primitives.len());
        Ok(())
    }

    /// Bytes of the counters and of the list that come back.
    fn answered(&self) -> (usize, usize) {
        let listed = self.room[SURVIVORS] as usize * ENTRY[SURVIVORS];
        (4 * COUNTERS, listed)
    }

    /// Waits for what the last submission found.
    pub(super) async fn read(
        &self,
        context: &Context,
        down: &Transfer,
        survivors: &mut Vec<Survivor>,
    ) -> Result<Found, GpuError> {
        survivors.clear();
        let (counted, listed) = self.answered();
        let (mut counts, mut stages) = ([0u32; COUNTERS], [0.0; STAGES]);
        down.read(context, |bytes| {
            let (head, list) = bytes.split_at(counted);
            bytemuck::bytes_of_mut(&mut counts).copy_from_slice(head);
            let found = counts[SURVIVORS].min(self.room[SURVIVORS]) as usize;
            survivors.resize(found, Survivor::default());
            let to: &mut [u8] = bytemuck::cast_slice_mut(survivors);
            let size = to.len();
            to.copy_from_slice(&list[..size]);
            if let Some(clock) = &context.clock {
                stages = clock.seconds(&list[listed..], STAGES);
            }
        })
        .await?;
        let counts = [counts[TILES], counts[NEAR], counts[SURVIVORS]];
        // Beyond this many the next counter may have gone round.
        let most = u32::MAX / (CLUSTER * CLUSTER) as u32;
        if counts[0] > most {
            return Err(GpuError::TooLarge {
                what: "cluster pairs that meet",
                bytes: counts[0].into(),
                limit: most.into(),
            });
        }
        let complete = (0..3).all(|k| counts[k] <= self.room[k]);
        Ok(Found {
            counts,
            complete,
            stages,
        })
    }
}
