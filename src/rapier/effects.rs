//! What a scene, or a collider, calls for; what is off costs nothing. `docs/effects.md` has the
//! inequality by which each is decided.

use crate::batch::Backend;
use crate::medial::MedialMesh;
use crate::parry::answers::OnePoint;
use rapier3d::geometry::{ColliderHandle, ColliderSet};
use std::collections::HashMap;

/// Whether an effect is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Effect {
    /// Never.
    Off,
    /// Always.
    On,
    /// Decided per pair and step.
    #[default]
    Auto,
}

/// What a pair of colliders calls for.
///
/// ```
/// use rapier3d_medial::prelude::*;
///
/// let debris = Effects::default().continuous(Effect::Off).guard(Effect::Off);
/// let options = MedialOptions::default().effects(debris);
/// ```
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
    /// First contacts are those of the rigid motion. `Auto`: always
    /// (`docs/effects.md`). Off: of straight paths from where each point starts to
    /// where it ends, as in the paper (Eq. 1): what a turning body passes beyond them is missed. Two
    /// medial meshes only.
    pub exact_rotation: Effect,
    /// Every contact of a pair goes to the solver. `Auto`: always. Off: the deepest one alone, enough
    /// for bullets and debris, too little to rest on. Sensors have no contacts at all.
    pub full_manifolds: Effect,
    /// rapier's speculative contacts, kept to compare with: the pair is never muted, and both bodies
    /// get contacts from their poses at the start for all they may reach in the step
    /// (`RigidBody::set_soft_ccd_prediction`). `Auto`: never; they stop bodies that pass each other.
    pub speculative: Effect,
    /// The paper's response (§4.5): where `continuous` finds the pair's first contact, the whole world
    /// stops at that time, and rapier's solver does the contact in a step over the rest. `Auto`:
    /// never; each stop costs a step. Off: an impulse between the two bodies, the others go on. After
    /// eight stops in a step, and in worlds with multibodies or soft bodies, as if off.
    pub stop: Effect,
}

/// How a pipeline works.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct MedialOptions {
    /// What the scene calls for.
    pub effects: Effects,
    /// Where batches are computed; the world is the same on each, bit by bit.
    pub backend: Backend,
}

impl Effects {
    /// No effect but those that every contact has: rapier's own step, its contacts computed in a batch.
    pub const OFF: Self = Self {
        continuous: Effect::Off,
        guard: Effect::Off,
        exact_rotation: Effect::Auto,
        full_manifolds: Effect::Auto,
        speculative: Effect::Off,
        stop: Effect::Off,
    };

    /// The same, with [`Self::continuous`] set.
    pub const fn continuous(mut self, effect: Effect) -> Self {
        self.continuous = effect;
        self
    }

    /// The same, with [`Self::guard`] set.
    pub const fn guard(mut self, effect: Effect) -> Self {
        self.guard = effect;
        self
    }

    /// The same, with [`Self::exact_rotation`] set.
    pub const fn exact_rotation(mut self, effect: Effect) -> Self {
        self.exact_rotation = effect;
        self
    }

    /// The same, with [`Self::full_manifolds`] set.
    pub const fn full_manifolds(mut self, effect: Effect) -> Self {
        self.full_manifolds = effect;
        self
    }

    /// The same, with [`Self::speculative`] set.
    pub const fn speculative(mut self, effect: Effect) -> Self {
        self.speculative = effect;
        self
    }

    /// The same, with [`Self::stop`] set.
    pub const fn stop(mut self, effect: Effect) -> Self {
        self.stop = effect;
        self
    }

    /// Whether nothing needs to know how bodies move in the step.
    fn leaves_all_to_rapier(&self) -> bool {
        [self.continuous, self.guard] == [Effect::Off; 2] && self.speculative != Effect::On
    }
}

impl MedialOptions {
    /// The same, with the scene's effects set.
    pub const fn effects(mut self, effects: Effects) -> Self {
        self.effects = effects;
        self
    }

    /// The same, with the place set where batches are computed.
    pub const fn backend(mut self, backend: Backend) -> Self {
        self.backend = backend;
        self
    }
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

    /// Whether no pair can call for the motions of the step.
    pub fn none(&self) -> bool {
        let mut all = self.own.values().chain([&self.scene]);
        all.all(Effects::leaves_all_to_rapier)
    }

    /// Whether `chosen` holds of the scene or of a collider.
    pub fn any(&self, chosen: impl Fn(&Effects) -> bool) -> bool {
        self.own.values().chain([&self.scene]).any(chosen)
    }

    /// Which pairs get their deepest contact only. A collider's own setting is known by the mesh.
    pub fn one_point(&self, colliders: &ColliderSet) -> OnePoint {
        let mut pairs = OnePoint {
            others: self.scene.full_manifolds == Effect::Off,
            ..OnePoint::default()
        };
        for (handle, effects) in &self.own {
            let collider = colliders.get(*handle);
            let mesh = collider.and_then(|c| c.shape().as_shape::<MedialMesh>());
            if let Some(mesh) = mesh
                && effects.full_manifolds != Effect::Auto
            {
                let one = effects.full_manifolds == Effect::Off;
                pairs.own.insert(mesh.instance_id(), one);
            }
        }
        pairs
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
        let scene = self.scene;
        Effects {
            continuous: choose(a.continuous, b.continuous, scene.continuous),
            guard: choose(a.guard, b.guard, scene.guard),
            exact_rotation: choose(a.exact_rotation, b.exact_rotation, scene.exact_rotation),
            full_manifolds: choose(a.full_manifolds, b.full_manifolds, scene.full_manifolds),
            speculative: choose(a.speculative, b.speculative, scene.speculative),
            stop: choose(a.stop, b.stop, scene.stop),
        }
    }
}
