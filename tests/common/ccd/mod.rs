//! The judge of continuous collision queries: an oracle that shares nothing with the crate,
//! families of hard queries, and verdicts. Included by tests and by the example `hard_cases`.

pub mod contact;
pub mod distance;
pub mod extremes;
pub mod families;
pub mod judge;
pub mod motion;
pub mod passage;
pub mod rng;
pub mod shapes;
pub mod subject;
