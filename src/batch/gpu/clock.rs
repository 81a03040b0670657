//! How long each stage takes on the device, where it can tell and is asked to.

use super::context::Context;
use super::transfer::Transfer;
use crate::error::GpuError;
use wgpu::{
    Buffer, BufferUsages, CommandEncoder, ComputePassTimestampWrites, QuerySet, QuerySetDescriptor,
    QueryType,
};

/// Most stages of a module.
pub(super) const STAGES: usize = 5;

/// Two marks of eight bytes for each stage.
const BYTES: usize = 16 * STAGES;

/// Marks before and after each stage.
pub(super) struct Clock {
    marks: QuerySet,
    read: Buffer,
    /// Nanoseconds of a tick.
    period: f64,
}

impl Clock {
    pub(super) fn new(context: &mut Context) -> Result<Self, GpuError> {
        let usage = BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC;
        let read = context.buffer("stage times", BYTES as u64, usage)?;
        Ok(Self {
            marks: context.device.create_query_set(&QuerySetDescriptor {
                label: Some("stage times"),
                ty: QueryType::Timestamp,
                count: 2 * STAGES as u32,
            }),
            read,
            period: context.queue.get_timestamp_period().into(),
        })
    }

    /// What a stage writes.
    pub(super) fn writes(&self, stage: u32) -> ComputePassTimestampWrites<'_> {
        ComputePassTimestampWrites {
            query_set: &self.marks,
            beginning_of_pass_write_index: Some(2 * stage),
            end_of_pass_write_index: Some(2 * stage + 1),
        }
    }

    /// Room that the times of a module take among the answers.
    pub(super) fn bytes(clock: Option<&Self>) -> usize {
        clock.map_or(0, |_| BYTES)
    }

    /// Has the times sent after the other answers.
    pub(super) fn receive(&self, encoder: &mut CommandEncoder, down: &mut Transfer, stages: u32) {
        encoder.resolve_query_set(&self.marks, 0..2 * stages, &self.read, 0);
        down.receive(encoder, &self.read, BYTES);
    }

    /// Seconds of each stage, from the bytes received.
    pub(super) fn seconds(&self, bytes: &[u8], stages: usize) -> [f64; STAGES] {
        let mut seconds = [0.0; STAGES];
        let mut marks = bytes.chunks_exact(8).map(|b| {
            let mut word = [0; 8];
            word.copy_from_slice(b);
            u64::from_le_bytes(word)
        });
        for stage in &mut seconds[..stages] {
            if let (Some(start), Some(end)) = (marks.next(), marks.next()) {
                *stage = end.saturating_sub(start) as f64 * self.period * 1.0e-9;
            }
        }
        seconds
    }
}
