//! What a scene, or a collider, calls for; what is off costs nothing.

use rapier3d::geometry::{ColliderHandle, ColliderSet};
use std::collections::HashMap;

/// Whether an effect is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Effect {
    /// Never.
    Off,
    /// Always.
    On,
    /// Decided per pair and step from the motion.
    #[default]
    Auto,
}

/// What a pair of colliders calls for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct Effects {
    /// Exact first contact on the motion of the step, and the impulse there. `Auto`: for pairs that
    /// travel more than a quarter of their thickness in the step. Off: fast bodies may pass through
    /// each other, as in rapier.
    pub continuous: Effect,
    /// Slow pairs are kept from crossing medial axes, whatever the solver does. `Auto`: for pairs whose
    /// contacts in rapier are deeper than a quarter of their thickness.
    pub guard: Effect,
}

impl Effects {
    /// All effects off: rapier's own step, its contacts computed in a batch.
    pub const OFF: Self = Self {
        continuous: Effect::Off,
        guard: Effect::Off,
    };
}

/// The effects of a scene and of single colliders.
#[derive(Clone, Debug, Default)]
pub struct Wanted {
    /// Of the scene.
    pub scene: Effects,
    own: HashMap<ColliderHandle, Effects>,
}

impl Wanted {
    /// Sets those of one collider.
    pub fn set(&mut self, collider: ColliderHandle, effects: Effects) {
        if effects == Effects::default() {
            self.own.remove(&collider);
        } else {
            self.own.insert(collider, effects);
        }
    }

    /// Forgets colliders that are gone.
    pub fn clean(&mut self, colliders: &ColliderSet) {
        self.own.retain(|handle, _| colliders.contains(*handle));
    }

    /// Whether no pair can call for the event loop.
    pub fn none(&self) -> bool {
        self.scene == Effects::OFF && self.own.values().all(|e| *e == Effects::OFF)
    }

    /// Those of a pair: `On` wins, then `Off`, of what the two colliders set; else the scene's.
    pub fn of(&self, pair: [ColliderHandle; 2]) -> Effects {
        if self.own.is_empty() {
            return self.scene;
        }
        let own = pair.map(|h| self.own.get(&h).copied().unwrap_or_default());
        let choose = |a: Effect, b: Effect, scene: Effect| match (a, b) {
            (Effect::On, _) | (_, Effect::On) => Effect::On,
            (Effect::Off, _) | (_, Effect::Off) => Effect::Off,
            (Effect::Auto, Effect::Auto) => scene,
        };
        let [a, b] = own;
        Effects {
            continuous: choose(a.continuous, b.continuous, self.scene.continuous),
            guard: choose(a.guard, b.guard, self.scene.guard),
        }
    }
}
