//! The device proposes, the CPU disposes. The device gets what moves and gives back which pairs are
//! proven free and, for the others, primitive pairs and times before which they are free; nothing
//! that it computes reaches the physics. Bounds carry a slack for the rounding of any conforming
//! device ([`crate::math::tolerance::GPU_SLACK_ULPS`]).
//!
//! One submission and one map per batch; nothing is allocated on the device in a step like those
//! before. Whatever goes wrong is a [`GpuError`], and the CPU has the work.

mod clock;
mod context;
mod cull;
mod elementary;
pub mod layout;
mod meshes;
pub mod shaders;
mod stage;
mod sweep;
mod transfer;

pub use context::GpuOptions;
pub use layout::{Bound, Survivor};

use crate::batch::job::Sweep;
use crate::elementary::path::LinearPath;
use crate::elementary::test_list::Domain;
use crate::error::GpuError;
use crate::math::lane::Vec3;
use crate::medial::MedialMesh;
use context::Context;
use cull::{Asked, Cull};
use elementary::Elementary;
use layout::Pair;
use meshes::Meshes;
use transfer::Transfer;

/// Runs of one batch, at most: each of the three lists can overflow once, as each is counted in
/// full only when the one before it had room.
const MOST_RUNS: u32 = 4;

/// Work of the device since it was opened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GpuCounts {
    /// Submissions.
    pub submissions: u64,
    /// Times that answers were mapped and waited for.
    pub maps: u64,
    /// Of these, batches asked for again because a list had no room.
    pub reruns: u64,
    /// Cluster pairs whose bounds meet, in the last batch.
    pub cluster_pairs: u32,
    /// Primitive pairs whose bounds meet, in the last batch.
    pub primitive_pairs: u32,
    /// Primitive pairs that are not proven free, in the last batch.
    pub survivors: u32,
    /// Buffers made since the device was opened: constant in steps like those before.
    pub buffers_made: u64,
    /// Groups of bindings made since then: likewise.
    pub bindings_made: u64,
    /// Meshes on the device.
    pub meshes: usize,
}

/// What the device says of one [`Sweep`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proposal {
    /// Primitive pairs that are not proven free, over all pieces of the step. 0: the two meshes are
    /// free throughout. `None`: the sweep was not fit for the device.
    pub survivors: Option<u32>,
    /// The meshes are free before this fraction of the step.
    pub lower: f32,
}

impl Proposal {
    const UNKNOWN: Self = Self {
        survivors: None,
        lower: 0.0,
    };

    /// Whether the two meshes are proven free in the whole step.
    pub fn is_free(&self) -> bool {
        self.survivors == Some(0)
    }
}

/// A sweep, and the part of its step that a pair on the device stands for.
#[derive(Clone, Copy)]
struct Piece {
    sweep: u32,
    times: [f64; 2],
}

/// A device with the meshes that it holds.
pub struct Gpu {
    context: Context,
    up: Transfer,
    down: Transfer,
    elementary: Elementary,
    cull: Cull,
    meshes: Meshes,
    pairs: Vec<Pair>,
    /// Where each pair comes from.
    asked: Vec<Piece>,
    /// Groups of 64 clusters of first meshes.
    groups: u32,
    /// Mesh pairs asked about and not yet answered, whether or not any of them was fit.
    sweeps: usize,
    /// Whether the device has a batch of which the answers were not read.
    pending: bool,
    survivors: Vec<Survivor>,
    stages: [f64; clock::STAGES],
    counts: GpuCounts,
}

impl Gpu {
    /// Opens a device, builds the pipelines and runs each once: the first dispatch compiles.
    pub async fn open(options: GpuOptions) -> Result<Self, GpuError> {
        let mut context = Context::open(options).await?;
        let mut gpu = Self {
            up: Transfer::upload(&mut context)?,
            down: Transfer::readback(&mut context)?,
            elementary: Elementary::new(&mut context)?,
            cull: Cull::new(&mut context)?,
            meshes: Meshes::default(),
            pairs: Vec::new(),
            asked: Vec::new(),
            groups: 0,
            sweeps: 0,
            pending: false,
            survivors: Vec::new(),
            stages: [0.0; clock::STAGES],
            counts: GpuCounts::default(),
            context,
        };
        gpu.context.check()?;
        gpu.warm_up().await?;
        Ok(gpu)
    }

    async fn warm_up(&mut self) -> Result<(), GpuError> {
        let apart = LinearPath {
            start: [Vec3::new(1.0, 0.0, 0.0); 4],
            rate: [Vec3::zero(); 4],
            radius: [0.0; 4],
        };
        let mut bounds = Vec::new();
        for domain in [Domain::Box, Domain::Triangle] {
            self.bounds(&[apart], domain, 0.0, &mut bounds).await?;
        }
        let ball = crate::medial::MedialSphere::new(crate::math::Vector::ZERO, 1.0);
        let Ok(mesh) = MedialMesh::new(vec![ball], vec![], vec![]) else {
            return Ok(());
        };
        let still = parry3d::query::NonlinearRigidMotion::identity();
        let sweep = Sweep {
            meshes: [&mesh; 2],
            motions: [still; 2],
            seconds: 0.0,
            reach: 0.0,
        };
        self.propose(&[sweep], &mut Vec::new()).await?;
        self.meshes.remove(&mesh);
        self.counts = GpuCounts::default();
        self.down.maps = 0;
        Ok(())
    }

    /// Name of the adapter and of the interface it is reached by.
    pub fn name(&self) -> &str {
        self.context.name()
    }

    /// The driver and its version, as far as it tells.
    pub fn driver(&self) -> &str {
        self.context.driver()
    }

    /// Whether the adapter is more than code on the CPU.
    pub fn is_hardware(&self) -> bool {
        self.context.is_hardware()
    }

    /// Work done so far.
    pub fn counts(&self) -> GpuCounts {
        GpuCounts {
            maps: self.down.maps,
            buffers_made: self.context.buffers_made,
            bindings_made: self.context.bindings_made,
            meshes: self.meshes.len(),
            ..self.counts
        }
    }

    /// Seconds that each stage of the last batch took on the device, in the order of
    /// [`shaders::MODULES`]' stages; zeros without [`GpuOptions::timed`], or where it cannot tell.
    pub fn stage_seconds(&self) -> [f64; 5] {
        self.stages
    }

    /// The first error of the device, if any; after one it is of no more use.
    pub fn check(&self) -> Result<(), GpuError> {
        self.context.check()
    }

    /// Gives the device up, as a driver does that resets it: every later call fails.
    pub fn lose(&self) {
        self.context.lose();
    }

    /// Behaves from now on as if the driver had reported this, to rehearse what no test can bring
    /// about.
    pub fn fail(&self, error: GpuError) {
        self.context.fail(error);
    }

    /// Drops a mesh; returns whether it was there. Not needed for meshes that no one else holds: they
    /// go by themselves.
    pub fn remove(&mut self, mesh: &MedialMesh) -> bool {
        self.meshes.remove(mesh)
    }

    /// Primitive pairs of the last [`Self::propose`] that are not proven free, in no order; `pair` is
    /// the index of the sweep. A step with fast turns is asked in pieces, and a primitive pair
    /// comes once for each in which it is not.
    pub fn survivors(&self) -> &[Survivor] {
        &self.survivors
    }

    /// Proposes for many elementary tests, in their order; paths are over the step `[0, 1]`, and
    /// what comes within the tolerance counts as contact. More than a binding holds is refused.
    pub async fn bounds(
        &mut self,
        paths: &[LinearPath<f32>],
        domain: Domain,
        tolerance: f32,
        bounds: &mut Vec<Bound>,
    ) -> Result<(), GpuError> {
        self.drop_pending().await?;
        let transfers = [&mut self.up, &mut self.down];
        self.counts.submissions += 1;
        self.stages = self
            .elementary
            .run(
                &mut self.context,
                transfers,
                paths,
                domain,
                tolerance,
                bounds,
            )
            .await?;
        Ok(())
    }

    /// Proposes for many mesh pairs, in their order.
    pub async fn propose(
        &mut self,
        sweeps: &[Sweep<'_>],
        proposals: &mut Vec<Proposal>,
    ) -> Result<(), GpuError> {
        self.submit(sweeps).await?;
        self.collect(proposals).await
    }

    /// First half of [`Self::propose`]: sends the mesh pairs off. What was sent before and not collected
    /// is dropped.
    pub async fn submit(&mut self, sweeps: &[Sweep<'_>]) -> Result<(), GpuError> {
        self.drop_pending().await?;
        self.survivors.clear();
        self.sweeps = sweeps.len();
        self.meshes.begin();
        self.gather(sweeps)?;
        if self.pairs.is_empty() {
            return Ok(());
        }
        match self.send([0; 3]).await {
            // Meshes of bodies long gone may fill the device.
            Err(GpuError::TooLarge { .. }) => {
                self.meshes.drop_unused();
                self.gather(sweeps)?;
                self.send([0; 3]).await
            }
            other => other,
        }
    }

    /// Second half of [`Self::propose`]: waits for what the device says of the mesh pairs sent last.
    pub async fn collect(&mut self, proposals: &mut Vec<Proposal>) -> Result<(), GpuError> {
        self.context.check()?;
        proposals.clear();
        proposals.resize(std::mem::take(&mut self.sweeps), Proposal::UNKNOWN);
        for _ in 0..MOST_RUNS {
            if !std::mem::take(&mut self.pending) {
                return Ok(());
            }
            let read = self
                .cull
                .read(&self.context, &self.down, &mut self.survivors);
            let found = read.await?;
            self.stages = found.stages;
            let [tiles, near, survivors] = found.counts;
            self.counts.cluster_pairs = tiles;
            self.counts.primitive_pairs = near;
            self.counts.survivors = survivors;
            if found.complete {
                self.settle(proposals);
                return Ok(());
            }
            self.counts.reruns += 1;
            self.send(found.counts.map(|n| n.saturating_add(n / 2)))
                .await?;
        }
        Err(transfer::refused("lists kept overflowing"))
    }

    /// Sends the pairs gathered, with lists at least that long.
    async fn send(&mut self, lists: [u32; 3]) -> Result<(), GpuError> {
        let asked = Asked {
            pairs: &self.pairs,
            groups: self.groups,
            lists,
        };
        let transfers = [&mut self.up, &mut self.down];
        let (context, meshes) = (&mut self.context, &mut self.meshes);
        self.cull.submit(context, transfers, meshes, asked).await?;
        self.counts.submissions += 1;
        self.pending = true;
        Ok(())
    }

    /// The buffer for answers has to be back before the next submission.
    async fn drop_pending(&mut self) -> Result<(), GpuError> {
        self.context.check()?;
        if std::mem::take(&mut self.pending) {
            self.down.read(&self.context, |_| ()).await?;
        }
        Ok(())
    }

    /// Packs what is fit for the device.
    fn gather(&mut self, sweeps: &[Sweep<'_>]) -> Result<(), GpuError> {
        self.pairs.clear();
        self.asked.clear();
        self.groups = 0;
        let mut cluster_pairs = 0u64;
        for (index, sweep) in sweeps.iter().enumerate() {
            let places = sweep.meshes.map(|mesh| self.meshes.place(mesh));
            let kept = self.pairs.len();
            for times in sweep.pieces() {
                let Some(pair) = sweep.pair(places, times) else {
                    self.pairs.truncate(kept);
                    self.asked.truncate(kept);
                    break;
                };
                self.pairs.push(pair);
                self.asked.push(Piece {
                    sweep: index as u32,
                    times,
                });
            }
            for pair in &mut self.pairs[kept..] {
                // No more than cluster pairs, which are checked.
                pair.first = self.groups;
                self.groups = self
                    .groups
                    .saturating_add(places[0].clusters.div_ceil(layout::CLUSTER as u32));
                cluster_pairs += u64::from(places[0].clusters) * u64::from(places[1].clusters);
            }
        }
        // Their counter must not go round.
        if cluster_pairs > u32::MAX.into() {
            return Err(GpuError::TooLarge {
                what: "cluster pairs",
                bytes: cluster_pairs,
                limit: u32::MAX.into(),
            });
        }
        Ok(())
    }

    fn settle(&mut self, proposals: &mut [Proposal]) {
        for piece in &self.asked {
            proposals[piece.sweep as usize] = Proposal {
                survivors: Some(0),
                lower: 1.0,
            };
        }
        for survivor in &mut self.survivors {
            let Piece { sweep, times } = self.asked[survivor.pair as usize];
            let [start, end] = times;
            // Down, so that rounding keeps the promise.
            let lower = (start + (end - start) * f64::from(survivor.lower)) as f32;
            survivor.lower = lower.next_down().max(0.0);
            survivor.pair = sweep;
            let proposal = &mut proposals[sweep as usize];
            proposal.survivors = proposal.survivors.map(|n| n + 1);
            proposal.lower = proposal.lower.min(survivor.lower);
        }
    }
}
