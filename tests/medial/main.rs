//! The data layer: mass, files, envelope, exact solids, refusals, and the command line.

mod asset;
mod broken_file;
#[cfg(feature = "cli")]
mod cli;
#[cfg(feature = "cli")]
mod cli_compare;
#[cfg(feature = "cli")]
mod cli_errors;
#[cfg(feature = "cli")]
mod cli_paths;
mod envelope;
mod fuzz;
#[cfg(feature = "gltf")]
mod gltf;
mod ma_file;
mod mass;
mod mesh;
mod mesh_file;
mod oracle;
mod polygon;
#[cfg(feature = "serde")]
mod serde_formats;
mod solids;
