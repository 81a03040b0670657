//! Opens a GPU and keeps its errors. No call panics: an error that the graphics library reports at any time is
//! kept, and returned by the next check.

use super::clock::Clock;
use crate::error::GpuError;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::available_parallelism;
use wgpu::{
    Backends, BindingResource, Buffer, BufferUsages, Device, DeviceDescriptor, DeviceType, Error,
    Features, Instance, InstanceDescriptor, Limits, PollType, PowerPreference, Queue,
    RequestAdapterOptions,
};

/// Choice of the device and of how much of it is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GpuOptions {
    /// Whether an adapter that computes on the CPU will do.
    pub software: bool,
    /// Most bytes of a buffer or a texture that shaders see, beyond a texture's first row of 16 KiB; what
    /// the device allows if that is less.
    pub binding_bytes: u64,
    /// Whether shaders are timed, where the device can; the marks take time of their own.
    pub timed: bool,
}

impl Default for GpuOptions {
    fn default() -> Self {
        Self {
            software: false,
            timed: false,
            // The portable limit.
            binding_bytes: 128 << 20,
        }
    }
}

/// Threads that a GPU runs at once, at the most; more wait for their turn.
const GPU_THREADS: usize = 1 << 16;

/// Threads for each core of an adapter that computes on the CPU: two of its vectors of eight, so that
/// cores that are interrupted leave some to others.
const CORE_THREADS: usize = 16;

/// The first thing that went wrong.
#[derive(Clone, Debug, Default)]
struct Fault(Arc<Mutex<Option<GpuError>>>);

impl Fault {
    fn set(&self, error: GpuError) {
        let mut first = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        first.get_or_insert(error);
    }
    fn get(&self) -> Option<GpuError> {
        let first = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        first.clone()
    }
}

/// A device with its queue.
pub struct Context {
    pub(super) device: Device,
    pub(super) queue: Queue,
    /// Clock for shaders, where they are timed.
    pub(super) clock: Option<Clock>,
    pub(super) options: GpuOptions,
    fault: Fault,
    /// Buffers made so far: none are in a step like those before.
    pub(super) buffers_made: u64,
    /// Bytes of these.
    pub(super) bytes_made: u64,
    /// Groups of bindings made so far, likewise.
    pub(super) bindings_made: u64,
    name: String,
    driver: String,
    hardware: bool,
    /// Threads that it runs at once, about.
    pub(super) threads: usize,
}

impl Context {
    /// Opens the fastest adapter, with the limits that every one has.
    pub async fn open(options: GpuOptions) -> Result<Self, GpuError> {
        let mut descriptor = InstanceDescriptor::new_without_display_handle();
        descriptor.backends = Backends::PRIMARY;
        let instance = Instance::new(descriptor);
        let request = RequestAdapterOptions {
            power_preference: PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = instance.request_adapter(&request).await;
        let adapter = adapter.map_err(|e| GpuError::NoAdapter {
            message: e.to_string(),
        })?;
        let info = adapter.get_info();
        let hardware = info.device_type != DeviceType::Cpu;
        if !hardware && !options.software {
            return Err(GpuError::Software { name: info.name });
        }
        let clock = Features::TIMESTAMP_QUERY;
        let timed = options.timed && adapter.features().contains(clock);
        let descriptor = DeviceDescriptor {
            required_features: if timed { clock } else { Features::empty() },
            required_limits: Limits::default(),
            ..Default::default()
        };
        let opened = adapter.request_device(&descriptor).await;
        let (device, queue) = opened.map_err(|e| GpuError::NoDevice {
            name: info.name.clone(),
            message: e.to_string(),
        })?;
        let limits = device.limits();
        let most = limits
            .max_storage_buffer_binding_size
            .min(limits.max_buffer_size);
        let fault = Fault::default();
        let (lost, refused) = (fault.clone(), fault.clone());
        device.set_device_lost_callback(move |_, message| lost.set(GpuError::Lost { message }));
        device.on_uncaptured_error(Arc::new(move |error: Error| {
            let message = error.to_string();
            refused.set(match error {
                Error::OutOfMemory { .. } => GpuError::OutOfMemory { message },
                _ => GpuError::Refused { message },
            });
        }));
        let mut context = Self {
            device,
            queue,
            clock: None,
            options: GpuOptions {
                binding_bytes: options.binding_bytes.min(most),
                timed,
                ..options
            },
            fault,
            buffers_made: 0,
            bytes_made: 0,
            bindings_made: 0,
            name: format!("{} ({:?})", info.name, info.backend),
            driver: format!("{} {}", info.driver, info.driver_info),
            hardware,
            threads: match hardware {
                true => GPU_THREADS,
                false => CORE_THREADS * available_parallelism().map_or(1, usize::from),
            },
        };
        if timed {
            let read = context.buffer("shader time", Clock::BYTES as u64, Clock::USAGE)?;
            context.clock = Some(Clock::new(&context.device, &context.queue, read));
        }
        Ok(context)
    }

    /// Name of the adapter and of the interface it is reached by.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The driver and its version.
    pub fn driver(&self) -> &str {
        &self.driver
    }

    /// Whether the adapter is more than code on the CPU.
    pub fn is_hardware(&self) -> bool {
        self.hardware
    }

    /// The first error there was, if any. It stays: what follows an error is not to be trusted.
    pub fn check(&self) -> Result<(), GpuError> {
        self.fault.get().map_or(Ok(()), Err)
    }

    /// Waits until the device has done all it was given; on WebGPU it does nothing, there the event
    /// loop calls back.
    pub(super) fn poll(&self) -> Result<(), GpuError> {
        let done = self.device.poll(PollType::wait_indefinitely());
        self.check()?;
        done.map_err(|e| refused(&e.to_string()))?;
        Ok(())
    }

    /// Loses the device, as when a driver resets it.
    pub fn lose(&self) {
        self.device.destroy();
        self.fault.set(GpuError::Lost {
            message: "given up".to_owned(),
        });
    }

    /// Takes an error as if it had been reported.
    pub fn fail(&self, error: GpuError) {
        self.fault.set(error);
    }

    /// Most bytes of a buffer: those that are only copied need not fit a binding.
    fn limit(&self, usage: BufferUsages) -> u64 {
        if usage.intersects(BufferUsages::MAP_READ | BufferUsages::MAP_WRITE) {
            return self.device.limits().max_buffer_size;
        }
        self.options.binding_bytes
    }

    pub(super) fn buffer(
        &mut self,
        what: &'static str,
        bytes: u64,
        usage: BufferUsages,
    ) -> Result<Buffer, GpuError> {
        let limit = self.limit(usage);
        if bytes > limit {
            return Err(GpuError::TooLarge { what, bytes, limit });
        }
        self.buffers_made += 1;
        self.bytes_made += bytes;
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(what),
            size: bytes.max(16).next_multiple_of(16),
            usage,
            mapped_at_creation: usage.contains(BufferUsages::MAP_WRITE),
        });
        self.check()?;
        Ok(buffer)
    }
}

/// The error of a driver that does not do what it was asked.
pub(super) fn refused(message: &str) -> GpuError {
    GpuError::Refused {
        message: message.to_owned(),
    }
}

/// A buffer that is made anew when it has become too small.
pub(super) struct Growing {
    pub(super) buffer: Buffer,
    what: &'static str,
    usage: BufferUsages,
}

impl Growing {
    pub(super) fn new(
        context: &mut Context,
        what: &'static str,
        bytes: u64,
        usage: BufferUsages,
    ) -> Result<Self, GpuError> {
        let buffer = context.buffer(what, bytes, usage)?;
        Ok(Self {
            buffer,
            what,
            usage,
        })
    }

    pub(super) fn bound(&self) -> BindingResource<'_> {
        self.buffer.as_entire_binding()
    }

    /// Makes room; returns whether the buffer is a new one, its contents gone.
    pub(super) fn reserve(&mut self, context: &mut Context, bytes: u64) -> Result<bool, GpuError> {
        if bytes <= self.buffer.size() {
            return Ok(false);
        }
        // Half as much again, so that a slowly growing need does not make one each step.
        let limit = context.limit(self.usage);
        let room = bytes.max((bytes + bytes / 2).min(limit));
        self.buffer = context.buffer(self.what, room, self.usage)?;
        Ok(true)
    }
}
