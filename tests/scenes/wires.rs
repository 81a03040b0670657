//! Heaps of rings of thin wire, or of wire without any thickness: no ring gets through another, and what is held
//! because it has too many impacts gains no speed by its weight.

use crate::wire_heaps::Heap;

/// Symptom: rings of radius 0 got linked, in 3 heaps of 6. Cause: what is pressed on and on came nearer to the axes
/// than the rounding of poses. And a ring that was held in every step fell at 3 m/s in the end without moving: it kept
/// the speed that its weight gave it.
#[test]
fn rings_of_no_thickness_stay_unlinked() {
    for (seed, steps) in [(2, 200), (3, 170)] {
        let heap = Heap::of_no_thickness(seed);
        let found = heap.fall(steps);
        assert_eq!(found.linked, 0, "seed {seed}: {found:?}");
        assert!(found.speed < 0.5, "seed {seed}: {found:?}");
    }
}

/// Under a plate a thousand times as heavy as all of them, where rapier's capsules are pressed through each other.
#[test]
#[ignore = "minutes: three heaps of each kind under a plate"]
fn rings_of_thin_wire_under_a_plate() {
    for capsules in [true, false] {
        for seed in 0..3 {
            let heap = Heap {
                radius: 0.002,
                mass: 1.6e-5,
                plate: true,
                capsules,
                seed,
            };
            let found = heap.fall(200);
            println!("capsules: {capsules}, seed {seed}: {found:?}");
            assert!(
                capsules || found.linked == 0 && found.speed < 0.5,
                "{found:?}"
            );
        }
    }
}
