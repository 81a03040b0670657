//! The settings of the pipeline: which work beyond rapier's own step is done for the pairs of a scene or of single
//! colliders. An effect that is off costs nothing. `docs/effects.md` has the inequality by which each is decided.

use crate::batch::Backend;
use crate::medial::MedialMesh;
use crate::parry::narrow_phase_plan::SinglePointPairs;
use rapier3d::geometry::{ColliderHandle, ColliderSet};
use std::collections::HashMap;

/// Whether an effect is on for a pair of colliders.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Effect {
    /// Never.
    Off,
    /// Always.
    On,
    /// Decided by this crate: the documentation of each effect says how. In the settings of a
    /// single collider it means that the scene's setting holds.
    #[default]
    Auto,
}

/// Which work beyond rapier's own step is done for a pair of colliders. By default all effects are
/// [`Effect::Auto`]. Then only pairs that move fast, or are deep in each other, cost extra time.
///
/// Set effects for the whole scene by [`MedialOptions::effects`], or for single colliders by
/// [`MedialPipeline::set_effects`](crate::rapier::MedialPipeline::set_effects). For a pair, each effect is decided by
/// three rules, in this order: it is on if either collider has `On`; it is off if either has `Off`; otherwise the
/// scene's setting holds.
///
/// *Thickness* below is a length: roughly the radius of the thinner of the two parts that may meet.
///
/// ```
/// use rapier3d_medial::prelude::*;
///
/// // Fast debris may pass through other bodies, as with rapier's own shapes.
/// let debris = Effects::default().continuous(Effect::Off).guard(Effect::Off);
/// let options = MedialOptions::default().effects(debris);
/// let pipeline = MedialPipeline::new(options);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct Effects {
    /// Finds the first contact of a pair within the step and resolves it there, by an impulse. `Auto`: for pairs
    /// that move relative to each other by more than a quarter of their thickness in the step. Off: fast
    /// bodies may pass through each other, as rapier's own do.
    pub continuous: Effect,
    /// Resolves first contacts of slow pairs before the two are so deep in each other that one could pass through the
    /// other. `Auto`: for pairs of which rapier knows a contact deeper than a quarter of their thickness. Off: a
    /// heavy load may press a slow body through another.
    pub guard: Effect,
    /// Follows turning bodies on their exact paths to find a first contact. `Auto`: always. Off: each point is taken
    /// to move straight from where it is at the start of the step to where it is at the end, as in the paper (Eq. 1).
    /// Contacts of turning bodies that lie beside these lines are then missed. This effect is for pairs of two medial
    /// meshes only.
    pub exact_rotation: Effect,
    /// Gives the solver all contacts of a pair. `Auto`: always. Off: only the deepest one, which is enough for
    /// bullets and debris, but bodies cannot rest on it. Sensors have no contacts in either case.
    pub full_manifolds: Effect,
    /// Uses rapier's own speculative contacts (`RigidBody::set_soft_ccd_prediction`), for comparison. At the start of
    /// the step, the solver gets contacts with everything that the body may reach in the step. `Auto`: never, because
    /// such contacts also stop bodies that would pass each other without touching.
    pub speculative: Effect,
    /// Stops the whole world at the first contact that [`Self::continuous`] finds for the pair, and lets rapier's
    /// solver resolve it in a step over the time that is left (the paper's response, §4.5). Better for bodies that
    /// land flat on each other. `Auto`: never, because each stop costs another step. Off: only the two
    /// bodies get an impulse, and all others go on. There are at most eight stops in a step, and none in worlds
    /// with multibodies or soft bodies.
    pub stop: Effect,
    /// Lets pairs with restitution bounce where they meet within the step, by an impulse that gains no energy. In
    /// that step, rapier's solver does not get these pairs. `On`: for pairs whose restitution is above 0, if they may
    /// approach by more than twice the distance that gravity adds in the step. `Auto`: the same, but only for pairs
    /// on which no gravity, force of yours or joint acts, as in space. If this is off, or [`Self::stop`] is on for
    /// the pair, slow pairs bounce in rapier's solver. There, elastic bodies that are not round gain or lose much of
    /// their energy within seconds.
    pub restitution: Effect,
}

/// Settings of a [`MedialPipeline`](crate::rapier::MedialPipeline). With the defaults a step takes
/// as long as its impacts need, up to seconds; for games, which want short steps, there is
/// [`MedialOptions::games`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct MedialOptions {
    /// The effects of all colliders that have no settings of their own.
    pub effects: Effects,
    /// The CPU or a GPU, for contacts and first contacts of many pairs. The results are the same, bit by bit.
    pub backend: Backend,
    /// How much work the search for first contacts may do in a step, counted in tests of pairs of tree nodes and of
    /// pairs of primitives, each of which takes about a microsecond. A look at two convex pieces, parts of bodies with
    /// flat faces, or at a slab beside a cylinder or cone counts as 16. Once the budget is spent, a body whose path is
    /// not searched to the end stops where it is proven free, and goes on in the next step at the speed it had, unless
    /// the budget of that step does not pay for its first impact ([`crate::StepReport::waiting`] counts such bodies).
    /// So these bodies lose time, but pass through nothing. With 0, every body that would need a search waits.
    pub budget: u64,
}

/// The default of [`MedialOptions::budget`]: seconds of work. Heaps of 48 bodies thrown together take a thirty-sixth of
/// it, thirty rings of 200 cones dropped into a pen an eighth.
const BUDGET: u64 = 1 << 22;

/// Budget for games: a frame's work.
const BUDGET_OF_GAMES: u64 = 1 << 14;

impl Default for MedialOptions {
    fn default() -> Self {
        Self {
            effects: Effects::default(),
            backend: Backend::default(),
            budget: BUDGET,
        }
    }
}

impl Effects {
    /// Nothing beyond rapier's own step: medial colliders have contacts, but no continuous collision detection except
    /// rapier's own.
    pub const OFF: Self = Self {
        continuous: Effect::Off,
        guard: Effect::Off,
        exact_rotation: Effect::Auto,
        full_manifolds: Effect::Auto,
        speculative: Effect::Off,
        stop: Effect::Off,
        restitution: Effect::Off,
    };

    /// Returns these effects with [`Self::continuous`] set.
    pub const fn continuous(mut self, effect: Effect) -> Self {
        self.continuous = effect;
        self
    }

    /// Returns these effects with [`Self::guard`] set.
    pub const fn guard(mut self, effect: Effect) -> Self {
        self.guard = effect;
        self
    }

    /// Returns these effects with [`Self::exact_rotation`] set.
    pub const fn exact_rotation(mut self, effect: Effect) -> Self {
        self.exact_rotation = effect;
        self
    }

    /// Returns these effects with [`Self::full_manifolds`] set.
    pub const fn full_manifolds(mut self, effect: Effect) -> Self {
        self.full_manifolds = effect;
        self
    }

    /// Returns these effects with [`Self::speculative`] set.
    pub const fn speculative(mut self, effect: Effect) -> Self {
        self.speculative = effect;
        self
    }

    /// Returns these effects with [`Self::stop`] set.
    pub const fn stop(mut self, effect: Effect) -> Self {
        self.stop = effect;
        self
    }

    /// Returns these effects with [`Self::restitution`] set.
    pub const fn restitution(mut self, effect: Effect) -> Self {
        self.restitution = effect;
        self
    }

    /// Whether nothing needs to know how bodies move in the step.
    fn leaves_all_to_rapier(&self) -> bool {
        [self.continuous, self.guard, self.restitution] == [Effect::Off; 3]
            && self.speculative != Effect::On
    }
}

impl MedialOptions {
    /// Returns these options with [`Self::effects`] set.
    pub const fn effects(mut self, effects: Effects) -> Self {
        self.effects = effects;
        self
    }

    /// Options for games: the default effects, and a budget of 16,384, with which the search for
    /// first contacts took up to 20 ms a step in the scenes of `docs/effects.md`. If the budget
    /// does not suffice, bodies wait for the next step; they still pass through nothing.
    pub fn games() -> Self {
        Self::default().budget(BUDGET_OF_GAMES)
    }

    /// Returns these options with [`Self::budget`] set.
    pub const fn budget(mut self, budget: u64) -> Self {
        self.budget = budget;
        self
    }

    /// Returns these options with [`Self::backend`] set.
    pub const fn backend(mut self, backend: Backend) -> Self {
        self.backend = backend;
        self
    }
}

/// The effects of a scene and of single colliders.
#[derive(Clone, Debug, Default)]
pub struct EffectSettings {
    /// Effects of the scene.
    pub scene: Effects,
    own: HashMap<ColliderHandle, Effects>,
}

impl EffectSettings {
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
    pub fn single_point_pairs(&self, colliders: &ColliderSet) -> SinglePointPairs {
        let mut pairs = SinglePointPairs {
            others: self.scene.full_manifolds == Effect::Off,
            ..SinglePointPairs::default()
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

    /// Effects of a pair: for each, `On` of either collider wins, then `Off` of either, then the scene's.
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
            restitution: choose(a.restitution, b.restitution, scene.restitution),
        }
    }
}
