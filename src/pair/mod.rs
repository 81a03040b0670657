//! L3: one medial mesh against another, or against any body given as swept spheres.
//!
//! Culling happens here and only here: bounding spheres decide which primitives meet, and the
//! distance itself is always left to [`crate::elementary`].

mod apart;
pub mod contacts;
pub mod deepening;
pub mod distance;
mod ending;
pub mod first_contact;
pub mod held;
mod leaves;
pub mod outline;
mod queue;
mod search;
mod swept;
pub mod volumes;

pub use contacts::{SpherePair, contacts};
pub use distance::nearest_spheres;
pub use first_contact::first_contact;
pub use held::Play;
pub use volumes::{Soup, Volumes};
