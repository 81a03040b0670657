//! Measures how long a shader runs on the GPU, if this is asked for and the GPU can measure it.

use super::context::Context;
use super::transfer::Transfer;
use crate::error::GpuError;
use wgpu::{
    Buffer, BufferUsages, CommandEncoder, ComputePassTimestampWrites, QuerySet, QuerySetDescriptor,
    QueryType,
};

/// Two marks of eight bytes.
const BYTES: usize = 16;

/// Marks before and after the shader.
pub(super) struct Clock {
    marks: QuerySet,
    read: Buffer,
    /// Nanoseconds of a tick.
    period: f64,
}

impl Clock {
    pub(super) fn new(context: &mut Context) -> Result<Self, GpuError> {
        let usage = BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC;
        let read = context.buffer("shader time", BYTES as u64, usage)?;
        Ok(Self {
            marks: context.device.create_query_set(&QuerySetDescriptor {
                label: Some("shader time"),
                ty: QueryType::Timestamp,
                count: 2,
            }),
            read,
            period: context.queue.get_timestamp_period().into(),
        })
    }

    /// What the shader's pass writes.
    pub(super) fn writes(&self) -> ComputePassTimestampWrites<'_> {
        ComputePassTimestampWrites {
            query_set: &self.marks,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        }
    }

    /// Room that the marks take among the answers.
    pub(super) fn bytes(clock: Option<&Self>) -> usize {
        clock.map_or(0, |_| BYTES)
    }

    /// Has the marks sent after the other answers.
    pub(super) fn receive(&self, encoder: &mut CommandEncoder, down: &mut Transfer) {
        encoder.resolve_query_set(&self.marks, 0..2, &self.read, 0);
        down.receive(encoder, &self.read, BYTES);
    }

    /// Seconds that the shader took, from the bytes received.
    pub(super) fn seconds(&self, bytes: &[u8]) -> f64 {
        let mark = |at: usize| {
            let mut word = [0; 8];
            word.copy_from_slice(&bytes[at..at + 8]);
            u64::from_le_bytes(word)
        };
        mark(8).saturating_sub(mark(0)) as f64 * self.period * 1.0e-9
    }
}
