//! Batches on a GPU. The GPU gets meshes and motions, and proves primitive pairs not to come within reach. Mesh pairs
//! of which all are proven are free; of the others it returns the list of those that are not, and the CPU computes
//! these alone. Nothing else that it computes reaches the physics. Its bounds carry a slack for the rounding of any
//! device that conforms to WGSL ([`crate::math::tolerance::GPU_SLACK_ULPS`]), so what is not on a list does not come
//! within reach on any.
//!
//! Each batch takes one submission and one map. In steps that are like those before nothing is allocated, neither
//! on the GPU nor by this crate on the CPU. Every failure is a [`GpuError`], after which the CPU does the work.
//!
//! # Files
//! - What is proven: `cull.rs` (mesh pairs), `near.rs` (the list that comes back), `elementary.rs` (elementary tests).
//! - What is sent: `sweep.rs` (motions), `meshes.rs` (trees and primitives), `layout.rs` (twins of the shaders'
//!   structs), `texels.rs` (records in a texture).
//! - The device: `context.rs` (opens it and keeps its errors), `shaders.rs` (their source texts), `stage.rs` (one
//!   compute pipeline), `transfer.rs` (copies there and back), `clock.rs` (how long a shader runs).

mod clock;
mod context;
mod cull;
mod elementary;
pub mod layout;
mod meshes;
pub mod near;
pub mod shaders;
mod stage;
mod sweep;
mod texels;
mod transfer;

pub use context::GpuOptions;
pub use near::Proposals;

use crate::batch::counts::BatchCounts;
use crate::batch::job::Sweep;
use crate::elementary::path::LinearPath;
use crate::elementary::test_list::Domain;
use crate::error::GpuError;
use crate::math::lane::Vec3;
use crate::medial::MedialMesh;
use context::Context;
use cull::{Cull, Received};
use elementary::Elementary;
use layout::Pair;
use meshes::Meshes;
use near::Range;
use transfer::Transfer;

/// Resources that a GPU keeps. None of them grows in steps that are like those before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GpuStock {
    /// Buffers and textures that were made.
    pub buffers_made: u64,
    /// Bytes of these, larger ones that replaced smaller ones included.
    pub bytes_made: u64,
    /// Bind groups that were made.
    pub bindings_made: u64,
    /// Meshes that are kept on the GPU.
    pub meshes: usize,
}

/// The answer of the GPU to one [`Sweep`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proposal {
    /// The two meshes are proven free in the whole step.
    Free,
    /// All primitive pairs but those listed are: [`Proposals::near`].
    Near {
        /// Place of the first on the batch's list.
        first: u32,
        /// How many there are.
        count: u32,
    },
    /// The pair is not proven, and has no list: the CPU has to search it.
    Open,
    /// The GPU could not take the sweep, since a number was not finite or too large.
    Unfit,
}

impl Proposal {
    /// Whether the two meshes are proven free in the whole step.
    pub fn is_free(&self) -> bool {
        *self == Self::Free
    }
}

/// A GPU and the meshes that are kept on it.
pub struct Gpu {
    context: Context,
    up: Transfer,
    down: Transfer,
    elementary: Elementary,
    cull: Cull,
    meshes: Meshes,
    pairs: Vec<Pair>,
    /// The sweep that each pair is a piece of.
    asked: Vec<u32>,
    /// Places of the primitives of each pair.
    ranges: Vec<[Range; 2]>,
    /// Mesh pairs asked about and not yet answered, whether or not any of them was fit.
    sweeps: usize,
    /// Whether the device has a batch of which the answers were not read.
    pending: bool,
    seconds: f64,
    counts: BatchCounts,
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
            ranges: Vec::new(),
            sweeps: 0,
            pending: false,
            seconds: 0.0,
            counts: BatchCounts::default(),
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
            size: 0.0,
        };
        let mut free = Vec::new();
        for domain in [Domain::Box, Domain::Triangle] {
            self.prove(&[apart], domain, 0.0, &mut free).await?;
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
            lists: true,
        };
        self.propose(&[sweep], &mut Proposals::default()).await?;
        self.meshes.remove(&mesh);
        self.counts = BatchCounts::default();
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
    pub fn counts(&self) -> BatchCounts {
        BatchCounts {
            maps: self.down.maps,
            ..self.counts
        }
    }

    /// Resources that it keeps.
    pub fn stock(&self) -> GpuStock {
        GpuStock {
            buffers_made: self.context.buffers_made,
            bytes_made: self.context.bytes_made,
            bindings_made: self.context.bindings_made,
            meshes: self.meshes.len(),
        }
    }

    /// Seconds that the last batch took on the device; zero without [`GpuOptions::timed`], or where it
    /// cannot tell.
    pub fn shader_seconds(&self) -> f64 {
        self.seconds
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

    /// Proposes for many elementary tests, in their order: `free` gets whether each is proven free in the
    /// whole step. Paths are over the step `[0, 1]`, and what comes within the tolerance counts as
    /// contact. More than a binding holds is refused.
    pub async fn prove(
        &mut self,
        paths: &[LinearPath<f32>],
        domain: Domain,
        tolerance: f32,
        free: &mut Vec<bool>,
    ) -> Result<(), GpuError> {
        self.drop_pending().await?;
        let transfers = [&mut self.up, &mut self.down];
        self.counts.submissions += 1;
        self.seconds = self
            .elementary
            .run(&mut self.context, transfers, paths, domain, tolerance, free)
            .await?;
        Ok(())
    }

    /// Proposes for many mesh pairs, in their order.
    pub async fn propose(
        &mut self,
        sweeps: &[Sweep<'_>],
        proposals: &mut Proposals,
    ) -> Result<(), GpuError> {
        self.submit(sweeps).await?;
        self.collect(proposals).await
    }

    /// First half of [`Self::propose`]: sends the mesh pairs off. What was sent before and not collected
    /// is dropped.
    pub async fn submit(&mut self, sweeps: &[Sweep<'_>]) -> Result<(), GpuError> {
        self.drop_pending().await?;
        self.sweeps = sweeps.len();
        self.meshes.begin();
        self.gather(sweeps);
        if self.pairs.is_empty() {
            return Ok(());
        }
        match self.send().await {
            // Meshes of bodies long gone may fill the device.
            Err(GpuError::TooLarge { .. }) => {
                self.meshes.drop_unused();
                self.gather(sweeps);
                self.send().await
            }
            other => other,
        }
    }

    /// Second half of [`Self::propose`]: waits for what the device says of the mesh pairs sent last.
    pub async fn collect(&mut self, proposals: &mut Proposals) -> Result<(), GpuError> {
        proposals.clear();
        self.context.check()?;
        let sweeps = std::mem::take(&mut self.sweeps);
        let pieces = (&self.asked[..], &self.ranges[..]);
        if !std::mem::take(&mut self.pending) {
            proposals.take(sweeps, (&[], &[]), &[], &[], 0);
            return Ok(());
        }
        let mut found = Default::default();
        let take = |r: Received| {
            found = proposals.take(sweeps, pieces, r.answers, r.list, r.stamp);
        };
        self.seconds = self.cull.read(&self.context, &self.down, take).await?;
        self.counts.given_up += found.given_up;
        self.counts.unlisted += found.unlisted;
        Ok(())
    }

    /// Sends the pairs gathered.
    async fn send(&mut self) -> Result<(), GpuError> {
        let transfers = [&mut self.up, &mut self.down];
        let (context, meshes) = (&mut self.context, &mut self.meshes);
        let pairs = &self.pairs;
        self.cull.submit(context, transfers, meshes, pairs).await?;
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
    fn gather(&mut self, sweeps: &[Sweep<'_>]) {
        self.pairs.clear();
        self.asked.clear();
        self.ranges.clear();
        for (index, sweep) in sweeps.iter().enumerate() {
            let places = sweep.meshes.map(|mesh| self.meshes.place(mesh));
            let kept = self.pairs.len();
            for pair in sweep.pairs(places.map(|(root, _)| root)) {
                let Some(pair) = pair else {
                    self.pairs.truncate(kept);
                    self.asked.truncate(kept);
                    self.ranges.truncate(kept);
                    break;
                };
                self.pairs.push(pair);
                self.asked.push(index as u32);
                self.ranges.push(places.map(|(_, range)| range));
            }
        }
    }
}
