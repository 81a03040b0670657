//! What becomes of the bars of [`crate::multibodies`] in the steps after the one in which they were struck.

use crate::multibodies::{By, Scene, Struck};
use rapier3d::prelude::*;

/// Steps of a 60th of a second.
fn coarse(n: usize) -> Vec<Real> {
    vec![1.0 / 60.0; n]
}

/// Steps of a 1,980th of a second for as many 60ths.
fn fine(n: usize) -> Vec<Real> {
    vec![1.0 / 1980.0; 33 * n]
}

/// Symptom: a bar that struck a hinged one at 60 m/s late in a step, and should have flown on at 36 m/s, came back at
/// 6; off rapier's capsules, joined as bodies, it flew on at 14. Cause: in the next step both still touch, and rapier
/// keeps the normal of the step's start and a point on either body. The hinged bar's goes along an arc and falls behind
/// the other, which is taken for a contact that gets deep. A hinged bar of a multibody was struck a second time, as its
/// path was taken for a chord.
#[test]
fn what_struck_a_hinged_bar_late_in_a_step_flies_on() {
    for by in [By::Multibody, By::ImpulseJoints] {
        for speed in [5.0, 20.0, 60.0] {
            for phase in [0.6, 0.7, 0.8, 0.87, 0.93, 0.99] {
                let scene = |medial| Scene::new(Struck::Hinge, by, medial, speed, phase);
                let ours = scene(true).run(true, &coarse(4)).rod;
                let [fine, own] = [fine(4), [fine(2), coarse(2)].concat()]
                    .map(|steps| scene(false).run(false, &steps).rod);
                let [off, own] = [ours, own].map(|rod| (rod - fine).abs() / speed);
                let name = format!("{by:?}, {speed} m/s, {phase} of a step");
                println!("{name}: off by {off:.3}, rapier's own {own:.3}");
                assert!(
                    off < own + 0.01 && off < 0.03,
                    "{name}: off by {off}, rapier's own {own}"
                );
            }
        }
    }
}

/// The step of an impact is as rapier's fine steps: what is off after whole steps is what rapier's steps make of it.
/// With fine steps after the two in which bars are struck, turns are within a twentieth of how far the fastest bar
/// turned, and so is the speed of what struck them, once it has left them.
#[test]
fn with_fine_steps_after_the_impact_all_is_as_in_fine_steps() {
    for struck in [Struck::Hinge, Struck::Chain, Struck::Ragdoll] {
        for by in [By::Multibody, By::ImpulseJoints] {
            for speed in [5.0, 20.0, 60.0] {
                for phase in [0.37, 0.87] {
                    let scene = |medial| Scene::new(struck, by, medial, speed, phase);
                    let [turned, left] = [4, 8].map(|n| {
                        let ours = scene(true).run(true, &[coarse(2), fine(n - 2)].concat());
                        let exact = scene(false).run(false, &fine(n));
                        (ours, exact)
                    });
                    let axes = turned.0.bent(&turned.1);
                    let turns = turned.0.off(&turned.1);
                    let rod = (left.0.rod - left.1.rod).abs() / speed;
                    let name = format!("{struck:?} by {by:?}, {speed} m/s, {phase} of a step");
                    println!("{name}: axes off by {axes:.3}, turns by {turns:.3}, rod by {rod:.3}");
                    let worst = axes.max(turns).max(rod);
                    assert!(worst < 0.05, "{name}: {axes}, {turns}, {rod}");
                }
            }
        }
    }
}
