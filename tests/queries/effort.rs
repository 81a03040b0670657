//! How much two meshes of 1,236 primitives ask of the elementary tests: of 4.2 million, the few that can
//! come first. Counts, not times.

use crate::creature::{SCENES, SECONDS, combs, creature, motions};
use rapier3d_medial::elementary::{ToiOptions, ToiStatus};
use rapier3d_medial::pair::first_contact::first_contact_counted;

/// Most elementary tests of a query, in every scene.
const MOST: u32 = 200;

#[test]
fn whole_meshes_take_few_elementary_tests() {
    let mesh = creature();
    assert_eq!(mesh.primitive_count(), 1236);
    for scene in SCENES {
        let (mut hits, mut ran) = (0, 0);
        for (k, [m1, m2]) in motions(&scene, 200).iter().enumerate() {
            let options = ToiOptions::default();
            let (toi, counts) = first_contact_counted(&mesh, m1, &mesh, m2, SECONDS, &options);
            let name = scene.name;
            assert_ne!(toi.status, ToiStatus::Unresolved, "{name}, {k}: {toi:?}");
            assert!(counts.tests <= MOST, "{name}, {k}: {counts:?}");
            hits += u32::from(toi.status != ToiStatus::Separated);
            ran += counts.tests;
        }
        // The scenes are what their names say, and a contact is never found without a test.
        let (least, most) = match scene.name {
            "apart" => (0, 0),
            "approach" | "close" => (20, 80),
            _ => (200, 200),
        };
        assert!((least..=most).contains(&hits), "{}: {hits}", scene.name);
        assert!(scene.name == "overlapping at the start" || ran >= hits);
    }
}

#[test]
fn interleaved_combs_are_told_apart_by_directions() {
    let ([a, b], [m1, m2]) = combs();
    let options = ToiOptions::default();
    let (toi, counts) = first_contact_counted(&a, &m1, &b, &m2, SECONDS, &options);
    assert_eq!(toi.status, ToiStatus::Separated);
    assert!(counts.nodes > 10_000, "the teeth are between each other");
    assert!(counts.tests <= MOST, "{counts:?}");
}
