//! Measures how long a shader runs on the GPU, if this is asked for and the GPU can measure it.

use wgpu::{
    Buffer, BufferUsages, CommandEncoder, ComputePassTimestampWrites, Device, QuerySet,
    QuerySetDescriptor, QueryType, Queue,
};

/// Marks before and after the shader.
pub(super) struct Clock {
    marks: QuerySet,
    read: Buffer,
    /// Nanoseconds of a tick.
    period: f64,
}

impl Clock {
    /// Bytes of its two marks.
    pub(super) const BYTES: usize = 16;

    /// How the buffer is used to which it resolves its marks.
    pub(super) const USAGE: BufferUsages =
        BufferUsages::QUERY_RESOLVE.union(BufferUsages::COPY_SRC);

    /// A clock with a buffer of [`Self::BYTES`].
    pub(super) fn new(device: &Device, queue: &Queue, read: Buffer) -> Self {
        Self {
            marks: device.create_query_set(&QuerySetDescriptor {
                label: Some("shader time"),
                ty: QueryType::Timestamp,
                count: 2,
            }),
            read,
            period: queue.get_timestamp_period().into(),
        }
    }

    /// Time stamps that the shader's pass writes.
    pub(super) fn writes(&self) -> ComputePassTimestampWrites<'_> {
        ComputePassTimestampWrites {
            query_set: &self.marks,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        }
    }

    /// Room that the marks take among the answers.
    pub(super) fn bytes(clock: Option<&Self>) -> usize {
        clock.map_or(0, |_| Self::BYTES)
    }

    /// Resolves the marks into a buffer of [`Self::BYTES`], to be sent after the other answers.
    pub(super) fn resolve(&self, encoder: &mut CommandEncoder) -> &Buffer {
        encoder.resolve_query_set(&self.marks, 0..2, &self.read, 0);
        &self.read
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
