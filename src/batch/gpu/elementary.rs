//! Many elementary tests on straight paths: what the device proves free, and for the rest a time
//! before which there is no contact.

use super::clock::{Clock, STAGES};
use super::context::{Context, Growing};
use super::layout::{Bound, CLUSTER, ElementaryParams, Query};
use super::shaders::ELEMENTARY;
use super::stage::Stage;
use super::transfer::Transfer;
use crate::elementary::path::LinearPath;
use crate::elementary::test_list::Domain;
use crate::error::GpuError;
use crate::math::lane::Vec3;
use wgpu::BufferUsages;

/// Iterations of the device; what needs more goes to the CPU. A group waits for its slowest thread.
const MAX_ITERATIONS: u32 = 24;

/// Lengths from here, in the user's unit, stay on the CPU: their products would overflow.
const LARGEST: f32 = 1.0e8;

/// Bytes of a query.
const QUERY: usize = size_of::<Query>();

pub(super) struct Elementary {
    /// Cone–cone and sphere–slab.
    stages: Vec<Stage>,
    params: Growing,
    queries: Growing,
    bounds: Growing,
    bound: bool,
}

impl Elementary {
    pub(super) fn new(context: &mut Context) -> Result<Self, GpuError> {
        let mut stages = Stage::all(context, &ELEMENTARY);
        // One of them runs in a submission.
        stages.iter_mut().for_each(|stage| stage.index = 0);
        let storage = BufferUsages::STORAGE;
        Ok(Self {
            stages,
            params: Growing::new(
                context,
                "parameters",
                size_of::<ElementaryParams>() as u64,
                BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            )?,
            queries: Growing::new(context, "queries", 1, storage | BufferUsages::COPY_DST)?,
            bounds: Growing::new(context, "bounds", 1, storage | BufferUsages::COPY_SRC)?,
            bound: false,
        })
    }

    /// One submission and one map. The tolerance counts as contact: what is called separated stays
    /// further apart, from the start of the step to its end.
    /// Returns the seconds of its stage.
    pub(super) async fn run(
        &mut self,
        context: &mut Context,
        [up, down]: [&mut Transfer; 2],
        paths: &[LinearPath<f32>],
        domain: Domain,
        tolerance: f32,
        bounds: &mut Vec<Bound>,
    ) -> Result<[f64; STAGES], GpuError> {
        let mut stages = [0.0; STAGES];
        bounds.clear();
        if paths.is_empty() {
            return Ok(stages);
        }
        let params = ElementaryParams {
            count: paths.len() as u32,
            tolerance,
            max_iterations: MAX_ITERATIONS,
            pad: 0,
        };
        let params = bytemuck::bytes_of(&params);
        let queries = paths.len() * QUERY;
        let answers = paths.len() * size_of::<Bound>();
        let fresh = self.queries.reserve(context, queries as u64)?
            | self.bounds.reserve(context, answers as u64)?;
        if fresh || !self.bound {
            let buffers = [&self.params, &self.queries, &self.bounds];
            let numbered = [0, 1, 2].map(|k| (k as u32, &buffers[k].buffer));
            for stage in &mut self.stages {
                stage.bind(context, &numbered);
            }
            self.bound = true;
        }
        up.begin(context, &[params.len(), queries]).await?;
        let timed = Clock::bytes(context.clock.as_ref());
        down.begin(context, &[answers, timed]).await?;
        let mut encoder = context.device.create_command_encoder(&Default::default());
        up.send(&mut encoder, params, &self.params.buffer, 0)?;
        let packed = paths.iter().map(|path| pack(path, domain, tolerance));
        let packed = packed.map(bytemuck::cast::<Query, [u8; QUERY]>);
        up.send_each(&mut encoder, packed, &self.queries.buffer)?;
        self.stages[usize::from(domain == Domain::Triangle)].run(
            context,
            &mut encoder,
            paths.len().div_ceil(CLUSTER) as u32,
        );
        down.receive(&mut encoder, &self.bounds.buffer, answers);
        if let Some(clock) = &context.clock {
            clock.receive(&mut encoder, down, 1);
        }
        up.hand_over();
        context.queue.submit([encoder.finish()]);
        up.take_back();
        down.take_back();
        bounds.resize(paths.len(), Bound::default());
        let to: &mut [u8] = bytemuck::cast_slice_mut(bounds);
        down.read(context, |bytes| {
            to.copy_from_slice(&bytes[..answers]);
            if let Some(clock) = &context.clock {
                stages = clock.seconds(&bytes[answers..], 1);
            }
        })
        .await?;
        Ok(stages)
    }
}

/// The device proves distances above the tolerance: rounded up, it is part of the radius sums. What
/// is not finite, or too large to square, goes as a contact, for the CPU to judge.
fn pack(path: &LinearPath<f32>, domain: Domain, tolerance: f32) -> Query {
    let with = |v: Vec3<f32>, w: f32| [v.x, v.y, v.z, w];
    // A triangle's last corner stands for the fourth too.
    let last = if domain == Domain::Triangle { 2 } else { 3 };
    let corners = [0, 1, 2, last];
    let query = Query {
        start: corners.map(|k| with(path.start[k], (path.radius[k] + tolerance).next_up())),
        rate: corners.map(|k| with(path.rate[k], 0.0)),
    };
    let numbers = query.start.iter().chain(&query.rate).flatten();
    // Of all, whatever the first says: that is done eight at a time.
    if numbers.fold(true, |sound, x| sound & (x.abs() < LARGEST)) {
        return query;
    }
    Query {
        start: [[0.0, 0.0, 0.0, 1.0]; 4],
        rate: [[0.0; 4]; 4],
    }
}
