//! State of one body in the impacts of a step: how many it had, and whether it is frozen, moved or struck.

/// State of one body in the loop.
#[derive(Clone, Copy, Default)]
pub struct BodyImpactState {
    /// Impacts that it had.
    pub events: u32,
    /// Stays where it is, or is carried.
    pub frozen: bool,
    /// Leaves the motion that rapier gave it.
    pub moved: bool,
    /// Whether it has another velocity.
    pub struck: bool,
    /// Stands still since the step's budget was spent.
    pub waits: bool,
    /// Whether it is carried along by a driven body, or by what one carries.
    pub driven: bool,
}
