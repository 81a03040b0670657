//! Copies data to the GPU and back, through one buffer each way that is kept from step to step and mapped while the CPU
//! uses it. `Queue::write_buffer` would allocate a buffer at every call.

use super::context::{Context, Growing, refused};
use super::layout::TEXELS;
use super::texels::{ROW, Texels};
use crate::error::GpuError;
use std::future::poll_fn;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Poll, Waker};
use wgpu::{
    Buffer, BufferUsages, CommandEncoder, Extent3d, MapMode, Origin3d, TexelCopyBufferInfo,
    TexelCopyBufferLayout, TexelCopyTextureInfo,
};

/// Start of the next item in the upload buffer: what copies have to be aligned to.
pub(super) const ALIGNMENT: usize = 16;

/// Set by the device's callback, awaited by the host.
#[derive(Clone, Default)]
struct Signal(Arc<Mutex<(Option<bool>, Option<Waker>)>>);

impl Signal {
    fn reset(&self) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).0 = None;
    }
    fn set(&self, succeeded: bool) {
        let mut state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        state.0 = Some(succeeded);
        if let Some(waker) = state.1.take() {
            waker.wake();
        }
    }
    async fn wait(&self) -> bool {
        poll_fn(|context| {
            let mut state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            match state.0 {
                Some(succeeded) => Poll::Ready(succeeded),
                None => {
                    state.1 = Some(context.waker().clone());
                    Poll::Pending
                }
            }
        })
        .await
    }
}

/// Place that an item of the upload buffer is copied to.
#[derive(Clone, Copy)]
pub(super) enum CopyTarget<'a> {
    /// A buffer, from this byte on.
    Buffer(&'a Buffer, u64),
    /// A texture, from this row on.
    Rows(&'a Texels, usize),
}

impl CopyTarget<'_> {
    /// Bytes that an item of so many bytes takes of the upload buffer: whole rows are copied to a texture.
    pub(super) fn room(&self, bytes: usize) -> usize {
        bytes.next_multiple_of(match self {
            Self::Buffer(..) => ALIGNMENT,
            Self::Rows(..) => ROW,
        })
    }

    fn copy(&self, encoder: &mut CommandEncoder, from: &Buffer, at: u64, bytes: usize) {
        match *self {
            Self::Buffer(to, start) => {
                encoder.copy_buffer_to_buffer(from, at, to, start, bytes as u64);
            }
            Self::Rows(to, row) => {
                let layout = TexelCopyBufferLayout {
                    offset: at,
                    bytes_per_row: Some(ROW as u32),
                    rows_per_image: None,
                };
                let from = TexelCopyBufferInfo {
                    buffer: from,
                    layout,
                };
                let origin = Origin3d {
                    y: row as u32,
                    ..Origin3d::ZERO
                };
                let to = TexelCopyTextureInfo {
                    origin,
                    ..to.texture.as_image_copy()
                };
                let size = Extent3d {
                    width: TEXELS,
                    height: bytes.div_ceil(ROW) as u32,
                    depth_or_array_layers: 1,
                };
                encoder.copy_buffer_to_texture(from, to, size);
            }
        }
    }
}

/// A buffer that the host writes and the device copies from, or the other way round.
pub(super) struct Transfer {
    room: Growing,
    mode: MapMode,
    signal: Signal,
    used: usize,
    /// Times that the host asked for it back.
    pub(super) maps: u64,
}

impl Transfer {
    /// A transfer from the host to the device.
    pub(super) fn upload(context: &mut Context) -> Result<Self, GpuError> {
        let usage = BufferUsages::MAP_WRITE | BufferUsages::COPY_SRC;
        let signal = Signal::default();
        signal.set(true);
        Ok(Self {
            room: Growing::new(context, "uploads", 1 << 12, usage)?,
            mode: MapMode::Write,
            signal,
            used: 0,
            maps: 0,
        })
    }

    /// A transfer from the device to the host.
    pub(super) fn readback(context: &mut Context) -> Result<Self, GpuError> {
        let usage = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
        Ok(Self {
            room: Growing::new(context, "answers", 1 << 12, usage)?,
            mode: MapMode::Read,
            signal: Signal::default(),
            used: 0,
            maps: 0,
        })
    }

    /// Makes room for all items of a step; sizes in bytes, those to send as [`CopyTarget::room`] has them.
    pub(super) async fn begin(
        &mut self,
        context: &mut Context,
        sizes: &[usize],
    ) -> Result<(), GpuError> {
        let total: usize = sizes.iter().map(|s| s.next_multiple_of(ALIGNMENT)).sum();
        if self.mode == MapMode::Write {
            context.poll()?;
            if !self.signal.wait().await {
                return Err(refused("the upload buffer was not mapped"));
            }
        }
        self.used = 0;
        self.room.reserve(context, total as u64)?;
        Ok(())
    }

    /// Writes an item and has it copied.
    pub(super) fn send(
        &mut self,
        encoder: &mut CommandEncoder,
        bytes: &[u8],
        to: CopyTarget<'_>,
    ) -> Result<(), GpuError> {
        if bytes.is_empty() {
            return Ok(());
        }
        let from = self.used as u64;
        let range = from..from + bytes.len() as u64;
        let mut view = self.room.buffer.get_mapped_range_mut(range).map_err(of)?;
        view.slice(..).copy_from_slice(bytes);
        to.copy(encoder, &self.room.buffer, from, bytes.len());
        self.used += to.room(bytes.len());
        Ok(())
    }

    /// Does the same as [`Self::send`] for many items as they are made: to where the device copies from and nowhere
    /// else in between.
    pub(super) fn send_each<const N: usize>(
        &mut self,
        encoder: &mut CommandEncoder,
        items: impl ExactSizeIterator<Item = [u8; N]>,
        to: CopyTarget<'_>,
    ) -> Result<(), GpuError> {
        let (from, bytes) = (self.used as u64, items.len() * N);
        let range = from..from + bytes as u64;
        let mut view = self.room.buffer.get_mapped_range_mut(range).map_err(of)?;
        view.slice(..).into_chunks::<N>().0.write_iter(items);
        to.copy(encoder, &self.room.buffer, from, bytes);
        self.used += to.room(bytes);
        Ok(())
    }

    /// Copies the start of a buffer of the device, `bytes` long.
    pub(super) fn receive(&mut self, encoder: &mut CommandEncoder, from: &Buffer, bytes: usize) {
        let at = self.used as u64;
        encoder.copy_buffer_to_buffer(from, 0, &self.room.buffer, at, bytes as u64);
        self.used += bytes.next_multiple_of(ALIGNMENT);
    }

    /// Gives the buffer to the device, before the submission.
    pub(super) fn hand_over(&self) {
        self.room.buffer.unmap();
    }

    /// Asks for the buffer back, after the submission.
    pub(super) fn take_back(&mut self) {
        self.maps += 1;
        self.signal.reset();
        let signal = self.signal.clone();
        let done = move |result: Result<(), _>| signal.set(result.is_ok());
        self.room.buffer.map_async(self.mode, .., done);
    }

    /// Waits for the answers of a step and reads them, items in the order they were received in.
    pub(super) async fn read(
        &self,
        context: &Context,
        mut take: impl FnMut(&[u8]),
    ) -> Result<(), GpuError> {
        context.poll()?;
        if !self.signal.wait().await {
            context.check()?;
            return Err(refused("the answers were not mapped"));
        }
        let view = self.room.buffer.get_mapped_range(..).map_err(of)?;
        take(&view);
        drop(view);
        self.room.buffer.unmap();
        context.check()
    }
}

fn of(error: impl std::fmt::Display) -> GpuError {
    refused(&error.to_string())
}
