//! Joints in impacts: bodies held together move as one system.

pub(crate) mod jointed_bodies;
pub(crate) mod limits;
pub(crate) mod pieces;
pub(crate) mod rows;
pub(crate) mod skyline;
pub(crate) mod tied_system;
