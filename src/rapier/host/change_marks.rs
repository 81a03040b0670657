//! The marks of what was changed in a collider since the last step. rapier keeps them to itself, but prints them.

use rapier3d::geometry::Collider;

/// A change of a collider for which rapier keeps its contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde-serialize",
    derive(serde::Serialize, serde::Deserialize)
)]
pub enum SlightChange {
    /// A setting for which rapier sets no mark of its own: friction, restitution, how these are combined, contact skin,
    /// active events, hooks and collision types, the threshold of force events.
    Property,
    /// Its pose, and perhaps a property.
    Pose,
}

/// How a collider was changed since the last step; `None` if it was not, or if something else was changed, as its shape
/// or its groups.
pub fn slight_change(collider: &Collider) -> Option<SlightChange> {
    let printed = format!("{collider:?}");
    let (_, marks) = printed.split_once("changes: ColliderChanges(")?;
    match marks.split_once(')')?.0 {
        "IN_MODIFIED_SET" => Some(SlightChange::Property),
        "IN_MODIFIED_SET | POSITION" => Some(SlightChange::Pose),
        _ => None,
    }
}
