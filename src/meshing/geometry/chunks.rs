//! Work over many items in chunks: on all cores with feature `parallel`, with the same results.
//!
//! The chunks do not depend on the number of threads and their results are joined in order, so a
//! build gives the same bytes on one core and on many. Between batches of chunks the caller hears
//! of progress and may stop.

use crate::error::BuildError;
use crate::meshing::watch::Watch;
#[cfg(feature = "parallel")]
use rayon::prelude::*;

/// Items of a chunk. Neighbouring items share hints, so smaller chunks search more; larger ones
/// leave cores idle at the end.
const CHUNK: usize = 512;

/// Chunks between two calls of the progress callback: 8,192 look-ups of up to 15 µs each are 0.12 s
/// on one core, below the 0.2 s within which a cancelled build returns.
const BATCH: usize = 16;

/// Items in a chunk where each takes some ten times as long as a look-up in a tree. Only speed depends on it.
pub const COSTLY: usize = 32;

/// Items in a chunk where each takes some hundred times as long as a look-up in a tree. Only speed depends on it.
pub const VERY_COSTLY: usize = 2;

/// Joins what `map` makes of each chunk of `items`, in order.
pub fn map_chunks<T: Sync, R: Send>(
    items: &[T],
    watch: &mut Watch,
    map: impl Fn(&[T]) -> Vec<R> + Sync,
) -> Result<Vec<R>, BuildError> {
    map_chunks_of(CHUNK, items, watch, map)
}

/// Results of `map` for all items, in order. The items are worked on in chunks of [`COSTLY`] or [`VERY_COSTLY`].
pub fn map_each<T: Sync, R: Send>(
    chunk: usize,
    items: &[T],
    watch: &mut Watch,
    map: impl Fn(&T) -> R + Sync,
) -> Result<Vec<R>, BuildError> {
    map_chunks_of(chunk, items, watch, |chunk| {
        chunk.iter().map(&map).collect()
    })
}

fn map_chunks_of<T: Sync, R: Send>(
    count: usize,
    items: &[T],
    watch: &mut Watch,
    map: impl Fn(&[T]) -> Vec<R> + Sync,
) -> Result<Vec<R>, BuildError> {
    let mut results = Vec::with_capacity(items.len());
    for batch in items.chunks(count * BATCH) {
        watch.again()?;
        #[cfg(feature = "parallel")]
        let parts: Vec<Vec<R>> = batch.par_chunks(count).map(&map).collect();
        #[cfg(not(feature = "parallel"))]
        let parts = batch.chunks(count).map(&map);
        for part in parts {
            results.extend(part);
        }
    }
    Ok(results)
}
