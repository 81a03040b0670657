//! Stores records in a texture, four words to a texel, row after row (`shaders/texels.wgsl` reads them). A texture
//! suits records that neighbouring threads read at different places.

use super::context::Context;
use super::layout::TEXELS;
use crate::error::GpuError;
use wgpu::{
    BindingResource, Extent3d, Texture, TextureDescriptor, TextureDimension, TextureFormat,
    TextureUsages, TextureView,
};

/// Bytes of a row.
pub(super) const ROW: usize = TEXELS as usize * 16;

/// A texture that is made anew when it has become too small; it has a row at least.
pub(super) struct Texels {
    pub(super) texture: Texture,
    view: TextureView,
    what: &'static str,
}

impl Texels {
    pub(super) fn new(context: &mut Context, what: &'static str) -> Result<Self, GpuError> {
        let texture = texture(context, what, 1)?;
        Ok(Self {
            view: texture.create_view(&Default::default()),
            texture,
            what,
        })
    }

    /// Makes room; returns whether the texture is a new one, its contents gone.
    pub(super) fn reserve(
        &mut self,
        context: &mut Context,
        bytes: usize,
    ) -> Result<bool, GpuError> {
        let rows = bytes.div_ceil(ROW);
        if rows <= self.texture.height() as usize {
            return Ok(false);
        }
        let most = context.device.limits().max_texture_dimension_2d as usize;
        let most = most.min(context.options.binding_bytes as usize / ROW);
        if rows > most {
            return Err(GpuError::TooLarge {
                what: self.what,
                bytes: bytes as u64,
                limit: (most * ROW) as u64,
            });
        }
        // To the next power of two, so that a slowly growing need does not make one each step; and
        // lavapipe compiles a shader anew, in a second, where a height is none for the first time.
        let room = rows.next_power_of_two().min(most);
        self.texture = texture(context, self.what, room)?;
        self.view = self.texture.create_view(&Default::default());
        Ok(true)
    }

    pub(super) fn bound(&self) -> BindingResource<'_> {
        BindingResource::TextureView(&self.view)
    }
}

fn texture(context: &mut Context, what: &'static str, rows: usize) -> Result<Texture, GpuError> {
    context.buffers_made += 1;
    context.bytes_made += 16 * u64::from(TEXELS) * rows as u64;
    let texture = context.device.create_texture(&TextureDescriptor {
        label: Some(what),
        size: Extent3d {
            width: TEXELS,
            height: rows as u32,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: TextureDimension::D2,
        format: TextureFormat::Rgba32Uint,
        usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
        view_formats: &[],
    });
    context.check()?;
    Ok(texture)
}
