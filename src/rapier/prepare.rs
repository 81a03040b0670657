//! Sends the contacts of the next step to a GPU between two steps: in a browser, where no step can wait for one, and
//! for many worlds at once.

use crate::batch::{Batch, PairJob};
use crate::rapier::contacts::candidates;
use crate::rapier::pipeline::MedialPipeline;
use crate::rapier::view::medial_colliders::Sets;
use rapier3d::pipeline::PhysicsWorld;

impl MedialPipeline {
    /// Sends the contacts of the next step to a GPU in a browser, and waits for its answers without blocking the page.
    /// Await it between two steps, after your changes to the world: pairs that change later are computed on the CPU.
    /// Outside browsers each step does this by itself.
    pub async fn prepare(&mut self, world: &PhysicsWorld) {
        let next = self.expected(world);
        self.state.batch.submit_async(&next).await;
        self.state.batch.ready().await;
    }

    /// Does the same as [`Self::prepare`] for many worlds in one submission to one GPU, that of `batch`. The
    /// pipelines themselves need no GPU. Await it between two steps. Each world goes on as it would by itself, bit by
    /// bit. All other work of the steps is done on the CPU, as everything is without a GPU.
    pub async fn prepare_many<'a>(
        batch: &mut Batch,
        worlds: impl IntoIterator<Item = (&'a mut Self, &'a PhysicsWorld)>,
    ) {
        let part = |(pipeline, world): (&'a mut Self, &'a PhysicsWorld)| {
            let next = pipeline.expected(world);
            (&mut pipeline.state.batch, next)
        };
        let mut parts: Vec<_> = worlds.into_iter().map(part).collect();
        batch.share(&mut parts).await;
    }

    /// The contacts that the next step will compute, if nothing is changed until then.
    fn expected(&self, world: &PhysicsWorld) -> Vec<PairJob> {
        candidates::expect(Sets::of(world), &self.state.recycled)
    }
}
