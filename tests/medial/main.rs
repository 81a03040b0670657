//! The data layer: mass, files, envelope, exact solids, refusals, and the command line.

mod envelope;
mod ma_file;
mod mass;
mod mesh_file;
mod oracle;
