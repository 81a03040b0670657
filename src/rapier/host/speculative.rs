//! rapier's own speculative contacts: switched on for one step for bodies whose colliders ask for them
//! ([`crate::Effects::speculative`]), and off again after it.

use crate::math::Real;
use crate::rapier::effects::{Effect, EffectSettings};
use crate::rapier::view::motion::Mobility;
use crate::rapier::view::step_view::StepView;
use rapier3d::dynamics::{RigidBodyHandle, RigidBodySet};

/// Distance for which contacts are predicted, in units of rapier's length unit: more than rapier lets a
/// body travel in a step of a second.
const SPECULATIVE_DISTANCE: Real = 1.0e3;

/// Bodies that speculate, and what they predicted before.
pub struct Speculators(Vec<(RigidBodyHandle, Real)>);

impl Speculators {
    /// Sets the prediction of all awake bodies that have a collider which calls for it.
    pub fn set(
        view: &StepView,
        effects: &EffectSettings,
        unit: Real,
        bodies: &mut RigidBodySet,
    ) -> Self {
        let mut own = Vec::new();
        if !effects.any(|e| e.speculative == Effect::On) {
            return Self(own);
        }
        for part in &view.colliders {
            let body = &view.bodies[part.body];
            let calls = effects.of([part.handle; 2]).speculative == Effect::On;
            if let Some(handle) = body.handle
                && calls
                && body.awake
                && body.mobility == Mobility::Free
                && own.iter().all(|(known, _)| *known != handle)
                && let Some(body) = bodies.get_mut(handle)
            {
                own.push((handle, body.soft_ccd_prediction()));
                body.set_soft_ccd_prediction(SPECULATIVE_DISTANCE * unit);
            }
        }
        Self(own)
    }

    /// How many bodies there are.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Gives the bodies back what they had.
    pub fn restore(self, bodies: &mut RigidBodySet) {
        for (handle, prediction) in self.0 {
            if let Some(body) = bodies.get_mut(handle) {
                body.set_soft_ccd_prediction(prediction);
            }
        }
    }
}
