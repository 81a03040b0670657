//! Makes the surface of a solid from triangles: repair, orientation, creases, the boundary of what overlaps.

pub(crate) mod boundary;
pub(crate) mod checked_surface;
pub(crate) mod creases;
pub(crate) mod edges;
pub(crate) mod flat_faces;
pub(crate) mod folds;
pub(crate) mod openings;
pub(crate) mod orient;
pub(crate) mod patches;
pub(crate) mod profile;
pub(crate) mod repair;
pub(crate) mod samples;
pub(crate) mod seams;
pub(crate) mod sew;
pub(crate) mod weld;
