//! Has the GPU prove which of many elementary tests on straight paths find no contact. The maths is in
//! `shaders/elementary.wgsl`: the fixed direction of `src/elementary/certificate.rs`.

use super::clock::Clock;
use super::context::{Context, Growing};
use super::layout::{ElementaryParams, FREE, Query, THREADS};
use super::shaders::ELEMENTARY;
use super::stage::Stage;
use super::texels::Texels;
use super::transfer::{ALIGNMENT, CopyTarget, Transfer};
use crate::elementary::path::LinearPath;
use crate::elementary::test_list::Domain;
use crate::error::GpuError;
use crate::math::lane::Vec3;
use wgpu::BufferUsages;

/// Iterations of the device; what needs more goes to the CPU. A group waits for its slowest thread.
const MAX_ITERATIONS: u32 = 24;

/// Lengths from here, in the user's unit, stay on the CPU: their products would overflow.
const MAX_LENGTH: f32 = 1.0e8;

/// How far the fourth corner may be from where the others put it, as a fraction of all four: what
/// rounding of the corners makes of it is below 3 ulps. Larger and the device's slack, 32 ulps of the
/// largest, would not cover it; smaller and sound paths stay on the CPU.
const FOLLOWS: f32 = 4.0 * f32::EPSILON;

/// Bytes of a query.
const QUERY: usize = size_of::<Query>();

/// The stage that proves elementary tests free, with its buffers.
pub(super) struct Elementary {
    /// Cone–cone and sphere–slab.
    stages: Vec<Stage>,
    params: Growing,
    queries: Texels,
    answers: Growing,
    bound: bool,
}

impl Elementary {
    pub(super) fn new(context: &mut Context) -> Result<Self, GpuError> {
        let storage = BufferUsages::STORAGE;
        Ok(Self {
            stages: Stage::all(context, &ELEMENTARY),
            params: Growing::new(
                context,
                "parameters",
                size_of::<ElementaryParams>() as u64,
                BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            )?,
            queries: Texels::new(context, "queries")?,
            answers: Growing::new(context, "answers", 1, storage | BufferUsages::COPY_SRC)?,
            bound: false,
        })
    }

    /// One submission and one map. The tolerance counts as contact: what is called free stays further
    /// apart, from the start of the step to its end.
    /// Returns the seconds of its shader.
    pub(super) async fn run(
        &mut self,
        context: &mut Context,
        [up, down]: [&mut Transfer; 2],
        paths: &[LinearPath<f32>],
        domain: Domain,
        tolerance: f32,
        free: &mut Vec<bool>,
    ) -> Result<f64, GpuError> {
        let mut seconds = 0.0;
        free.clear();
        if paths.is_empty() {
            return Ok(seconds);
        }
        let params = ElementaryParams {
            count: paths.len() as u32,
            max_iterations: MAX_ITERATIONS,
        };
        let params = bytemuck::bytes_of(&params);
        let queries = paths.len() * QUERY;
        let answers = paths.len() * size_of::<u32>();
        // Stays false if this fails, as for mesh pairs.
        let bound = std::mem::replace(&mut self.bound, false);
        let fresh = self.queries.reserve(context, queries)?
            | self.answers.reserve(context, answers as u64)?;
        if fresh || !bound {
            let [params, answers] = [&self.params, &self.answers].map(Growing::bound);
            let resources = [params, self.queries.bound(), answers];
            for stage in &mut self.stages {
                stage.bind(context, &resources);
            }
        }
        self.bound = true;
        let to_params = CopyTarget::Buffer(&self.params.buffer, 0);
        let to_queries = CopyTarget::Rows(&self.queries, 0);
        let sizes = [to_params.room(params.len()), to_queries.room(queries)];
        up.begin(context, &sizes).await?;
        let timed = Clock::bytes(context.clock.as_ref());
        down.begin(context, &[answers, timed]).await?;
        let mut encoder = context.device.create_command_encoder(&Default::default());
        up.send(&mut encoder, params, to_params)?;
        let packed = paths.iter().map(|path| pack(path, domain, tolerance));
        let packed = packed.map(bytemuck::cast::<Query, [u8; QUERY]>);
        up.send_each(&mut encoder, packed, to_queries)?;
        let stage = &self.stages[usize::from(domain == Domain::Triangle)];
        let groups = paths.len().div_ceil(THREADS);
        Stage::run(context, &mut encoder, &[(stage, groups)]);
        down.receive(&mut encoder, &self.answers.buffer, answers);
        if let Some(clock) = &context.clock {
            let marks = clock.resolve(&mut encoder);
            down.receive(&mut encoder, marks, Clock::BYTES);
        }
        up.hand_over();
        context.queue.submit([encoder.finish()]);
        up.take_back();
        down.take_back();
        down.read(context, |bytes| {
            let words: &[[u8; 4]] = bytemuck::cast_slice(&bytes[..answers]);
            free.extend(words.iter().map(|&w| u32::from_le_bytes(w) == FREE));
            if let Some(clock) = &context.clock {
                seconds = clock.seconds(&bytes[answers.next_multiple_of(ALIGNMENT)..]);
            }
        })
        .await?;
        Ok(seconds)
    }
}

/// The device proves distances above the tolerance: rounded up, it is part of the radius sums. What
/// is not finite, or too large to square, or of which the fourth corner does not follow from the others,
/// goes as a contact, for the CPU to judge.
fn pack(path: &LinearPath<f32>, domain: Domain, tolerance: f32) -> Query {
    let with = |v: Vec3<f32>, w: f32| [v.x, v.y, v.z, w];
    let start = [0, 1, 2, 3].map(|k| {
        with(
            path.start[k],
            up(path.radius[k] + tolerance + path.size * (4.0 * f32::EPSILON)),
        )
    });
    let rate = [0, 1, 2, 3].map(|k| with(path.rate[k], 0.0));
    let fourth = match domain {
        Domain::Box => 1.0,
        // A slab's family ends with the third.
        Domain::Triangle => 0.0,
    };
    let mut sound = true;
    for corners in [&start, &rate] {
        // All of them, whatever the first says: that is done four at a time.
        for k in 0..4 {
            let [a, b, c, d] = corners.map(|corner| corner[k]);
            let size = a.abs() + b.abs() + c.abs() + fourth * d.abs();
            let off = fourth * (b + c - a - d).abs();
            sound &= (size < MAX_LENGTH) & (off <= FOLLOWS * size);
        }
    }
    if !sound {
        return Query {
            start: [[0.0, 0.0, 0.0, 1.0]; 3],
            rate: [[0.0; 4]; 3],
        };
    }
    Query {
        start: [start[0], start[1], start[2]],
        rate: [rate[0], rate[1], rate[2]],
    }
}

/// The next number above, at least: without the branches of `next_up`.
fn up(x: f32) -> f32 {
    x + x.abs() * f32::EPSILON
}
