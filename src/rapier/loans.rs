//! Properties that bodies are given for the length of rapier's step, and lose after it.

use crate::rapier::effects::EffectSettings;
use crate::rapier::host::multibody_energy::FastMultibodies;
use crate::rapier::host::sleep_timers::SleepTimers;
use crate::rapier::host::speculative::Speculators;
use crate::rapier::host::substeps::Substeps;
use crate::rapier::view::step_view::StepView;
use crate::rapier::world::World;
use rapier3d::dynamics::{IntegrationParameters, RigidBodyHandle, RigidBodySet};

/// Properties that bodies have been given.
pub struct Loans {
    speculators: Speculators,
    substeps: Substeps,
    timers: SleepTimers,
}

impl Loans {
    /// Sets the properties that bodies need in rapier's step: speculative contacts and sub-steps by the view and by the
    /// multibodies that may gain energy, and the time to sleep of `moved`, the bodies that impacts moved in the step
    /// before.
    pub fn give(
        (view, fast_multibodies): (&StepView, &FastMultibodies),
        (effects, moved): (&EffectSettings, &[RigidBodyHandle]),
        parameters: &IntegrationParameters,
        world: &mut World,
    ) -> Self {
        let unit = parameters.length_unit;
        let speculators = Speculators::set(view, effects, unit, world.bodies);
        let joints = (&*world.impulse_joints, &*world.multibody_joints);
        let substeps = Substeps::set(
            view,
            joints,
            world.narrow_phase,
            parameters,
            fast_multibodies,
            world.bodies,
        );
        let contacts = (&*world.colliders, &*world.narrow_phase);
        let timers = SleepTimers::shorten(moved, world.bodies, contacts, unit);
        Self {
            speculators,
            substeps,
            timers,
        }
    }

    /// How many bodies rapier looks ahead for.
    pub fn speculative(&self) -> usize {
        self.speculators.count()
    }

    /// Takes it all back.
    pub fn take_back(self, bodies: &mut RigidBodySet) {
        self.speculators.restore(bodies);
        self.substeps.restore(bodies);
        self.timers.restore(bodies);
    }
}
