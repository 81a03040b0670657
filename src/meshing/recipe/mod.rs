//! Which candidates a build makes, in which order, and which of them it returns.

pub(crate) mod candidate;
pub(crate) mod counts;
pub(crate) mod extruded;
pub(crate) mod ladder;
pub(crate) mod pieces;
pub(crate) mod pipeline;
pub(crate) mod polyhedron;
pub(crate) mod smallest;
pub(crate) mod source;
pub(crate) mod tightened;
