//! Broken meshes, each with what it is known to be: every one builds to a medial mesh that covers
//! it, and its findings, its mass and some points inside and outside are as planted ([`crate::planted`]).

use crate::broken::*;
use crate::combined::{combined, everything};
use crate::meshes::*;
use crate::planted::*;
use parry3d::math::Vector;
use rapier3d_medial::Quality;
use rapier3d_medial::meshing::Findings;
use rapier3d_medial::{BuildOptions, MedialMesh};

#[test]
fn closed_bodies_with_one_defect() {
    let whole = |name, mesh| case(name, mesh, (1, 0)).volume(BLOCK_VOLUME, 1e-4);
    all_pass(vec![
        whole("clean", block()),
        whole("inside out", block().inside_out()).found(|f| f.triangles_turned == 12),
        whole("a third turned", turn_some(block(), 1)).found(|f| f.triangles_turned > 0),
        whole("half turned", turn_some(refine(block(), 2), 2)).found(|f| f.triangles_turned > 20),
        whole("unwelded", unweld(block())).found(|f| f.vertices_welded == 28),
        whole("repeated", repeat(block())).found(|f| f.triangles_repeated == 12),
        whole("repeated the other way", repeat_turned(block()))
            .found(|f| f.triangles_repeated == 12),
        whole(
            "a copy at 1e-7",
            block().and(block().map(|v| v + Vector::splat(1e-7))),
        )
        .found(|f| f.triangles_repeated == 12),
        whole("collapsed triangles", collapse_some(block())).found(|f| f.triangles_collapsed == 5),
        whole("needles", with_needles(block())).found(|f| f.triangles_without_area > 0),
        whole("stray vertices", with_stray_vertices(block())).found(|f| f.vertices_unused == 3),
        whole("slivers", sliver_block()).found(|f| f.edges_open == 0),
    ]);
}

#[test]
fn open_bodies() {
    let holes = |f: &Findings| f.patches_mended == 1 && f.edges_open > 0;
    all_pass(vec![
        case("lost triangles", lose(refine(block(), 4), 4, 3), (1, 0))
            .volume(BLOCK_VOLUME, 0.01)
            .inside(&[[0.5, 0.35, 0.2]])
            .found(holes),
        case(
            "lost triangles, inside out",
            lose(refine(block(), 4), 4, 3).inside_out(),
            (1, 0),
        )
        .volume(BLOCK_VOLUME, 0.01)
        .inside(&[[0.5, 0.35, 0.2]])
        .found(holes),
        case(
            "lost triangles, some turned",
            turn_some(lose(refine(block(), 4), 4, 4), 5),
            (1, 0),
        )
        .volume(BLOCK_VOLUME, 0.01)
        .inside(&[[0.5, 0.35, 0.2]]),
        case("a bowl", cut(ball(1.0), |v| v.z < 0.6), (0, 1))
            .outside(&[[0.0, 0.0, -0.1]])
            .error(0.35),
        case(
            "a ball with a wide mouth",
            cut(ball(1.0), |v| v.z < 0.9),
            (0, 1),
        )
        .outside(&[[0.0; 3]])
        .error(0.35),
        case(
            "a bowl with a post in it",
            cut(ball(1.0), |v| v.z < 0.6)
                .and(cuboid(Vector::new(0.9, 0.9, 1.4)).map(|v| v - Vector::new(0.45, 0.45, 0.2))),
            (1, 1),
        )
        .primitives(60)
        .volume(0.9 * 0.9 * 1.4, 1e-3)
        .inside(&[[0.0, 0.0, 0.5]]),
        case(
            "a pipe",
            cut(capsule(1.0, 0.4, 16, 4), |v| v.z.abs() < 1.01),
            (0, 1),
        )
        .outside(&[[0.0, 0.0, 0.0], [0.0, 0.0, 0.9]]),
        case(
            "a can without a lid",
            cut(refine(plate(1.0), 1), |v| v.z < 0.99),
            (0, 1),
        )
        .outside(&[[0.0, 0.0, 0.5]])
        .error(0.35),
        case("a box that fell apart", apart(block(), 0.002), (12, 0))
            .volume(BLOCK_VOLUME, 0.03)
            .inside(&[[0.5, 0.35, 0.2]]),
        case("a ball that fell apart", apart(ball(1.0), 0.003), (90, 0))
            .volume(ball_volume(), 0.03)
            .inside(&[[0.0; 3]]),
    ]);
}

/// What lies along a loose seam says which way a triangle faces.
#[test]
fn bodies_that_fell_apart_and_were_turned() {
    let mut cases = Vec::new();
    for seed in 1..5 {
        let some_turned = apart(turn_some(block(), seed), 0.002);
        cases.push(
            case("a box that fell apart, some turned", some_turned, (12, 0))
                .volume(BLOCK_VOLUME, 0.03)
                .inside(&[[0.5, 0.35, 0.2]])
                .found(|f| f.triangles_turned > 0),
        );
    }
    let fine = turn_some(refine(block(), 2), 3);
    cases.extend([
        case(
            "a fine box that fell apart, some turned",
            apart(fine, 0.002),
            (192, 0),
        )
        .volume(BLOCK_VOLUME, 0.03)
        .inside(&[[0.5, 0.35, 0.2]]),
        case(
            "a ball that fell apart, some turned",
            apart(turn_some(ball(1.0), 2), 0.003),
            (90, 0),
        )
        .volume(ball_volume(), 0.03)
        .inside(&[[0.0; 3]]),
        // As of a whole box, a wide opening makes it a sheet.
        case(
            "a box that fell apart and lost a quarter of a face, some turned",
            lose(apart(turn_some(refine(block(), 1), 3), 0.002), 1, 3),
            (0, 47),
        )
        .primitives(60),
        case(
            "discs beside each other, that fell apart, some turned",
            apart(turn_some(disc(1), 7), 0.003),
            (0, 36),
        ),
    ]);
    all_pass(cases);
}

#[test]
fn sheets() {
    let flat = |f: &Findings| f.patches_flat == 2;
    all_pass(vec![
        case("one needle triangle", needle(), (0, 1)).error(0.02),
        case("a disc", disc(1), (0, 1)),
        case("a disc, some turned", turn_some(disc(3), 7), (0, 1))
            .found(|f| f.triangles_turned > 9),
        case(
            "a two-sided disc",
            disc(3).and(disc(3).inside_out()),
            (0, 1),
        ),
        case(
            "a disc with a copy at 1e-7",
            disc(3).and(disc(3).map(|v| v + Vector::splat(1e-7))),
            (0, 1),
        ),
        case(
            "a disc with a copy at 1e-4",
            disc(2).and(disc(2).map(|v| v + Vector::splat(1e-4))),
            (0, 2),
        ),
        case(
            "two discs that cross",
            disc(2).and(disc(2).map(|v| Vector::new(v.x + 0.1, 0.1, v.y))),
            (0, 2),
        ),
        case("a flat plate", flattened(), (0, 2)).found(flat),
        case("a Möbius strip", mobius(40), (0, 1)).found(|f| f.edges_twisted > 0),
        case(
            "waves",
            card(12).map(|v| Vector::new(v.x, v.y, 0.1 * (7.0 * v.x).sin())),
            (0, 1),
        ),
        case("a book of three pages", book(), (0, 3)).found(|f| f.edges_crowded == 6),
        case("a soup", soup(20, 8), (0, 20)).error(0.5),
    ]);
}

#[test]
fn thin_solids() {
    let thin = |f: &Findings| f.triangles_thin > 0;
    let area = 18.0 * 10f32.to_radians().sin();
    let round = |name, t: f32| case(name, plate(t), (1, 0)).volume(area * t, 2e-3);
    all_pass(vec![
        round("a plate", 0.1).found(|f| f.triangles_thin == 0),
        round("a thin plate", 0.006).found(thin),
        round("a foil", 1e-4).found(thin),
        case(
            "a thin ball",
            ball(1.0).and(ball(0.998).inside_out()),
            (2, 0),
        )
        .volume(ball_volume() * (1.0 - 0.998f32.powi(3)), 0.02)
        .outside(&[[0.0; 3]])
        .error(0.1)
        .primitives(60)
        .found(|f| f.patches_cavity == 1 && f.triangles_thin > 0),
        case("a needle box", cuboid(Vector::new(1.0, 1e-3, 1e-3)), (1, 0))
            .volume(1e-6, 1e-2)
            .error(0.05),
        case("a body with thin wings", winged(), (1, 0))
            .primitives(60)
            .found(thin)
            .volume(volume(&winged()), 2e-3)
            .inside(&[[0.0; 3]])
            .outside(&[[1.5, 0.0, 0.2], [1.5, 0.0, -0.2]]),
    ]);
}

#[test]
fn several_bodies() {
    let at = |x: f32| ball(1.0).map(move |v| v + Vector::new(x, 0.0, 0.0));
    let overlapping = |f: &Findings| f.overlapping;
    let over_bulb = cuboid(Vector::splat(1.2)).map(|v| v + Vector::new(-0.6, -0.6, 0.6));
    all_pass(vec![
        case("two apart", at(0.0).and(at(3.0)), (2, 0))
            .volume(2.0 * ball_volume(), 1e-3)
            .outside(&[[1.5, 0.0, 0.0]]),
        case(
            "two apart, one inside out",
            at(0.0).and(at(3.0).inside_out()),
            (2, 0),
        )
        .volume(2.0 * ball_volume(), 1e-3)
        .inside(&[[0.0; 3], [3.0, 0.0, 0.0]]),
        case("two that overlap", at(0.0).and(at(1.0)), (2, 0))
            .volume(union_volume(&at(0.0), &at(1.0)), 0.01)
            .inside(&[[0.5, 0.0, 0.0]])
            .found(overlapping),
        case(
            "two that overlap, inside out",
            at(0.0).and(at(1.0)).inside_out(),
            (2, 0),
        )
        .volume(union_volume(&at(0.0), &at(1.0)), 0.01)
        .inside(&[[0.5, 0.0, 0.0]])
        .found(overlapping),
        case("one in another", at(0.0).and(ball(0.5)), (2, 0))
            .volume(ball_volume(), 0.01)
            .inside(&[[0.0; 3]])
            .found(overlapping),
        case("a cavity", at(0.0).and(ball(0.5).inside_out()), (2, 0))
            .volume(ball_volume() * 0.875, 1e-3)
            .error(0.3)
            .outside(&[[0.0; 3]])
            .primitives(60)
            .found(|f| f.patches_cavity == 1 && f.triangles_turned == 0),
        case(
            "a cavity, all inside out",
            at(0.0).inside_out().and(ball(0.5)),
            (2, 0),
        )
        .volume(ball_volume() * 0.875, 1e-3)
        .error(0.3)
        .outside(&[[0.0; 3]])
        .primitives(60)
        .found(|f| f.patches_cavity == 1 && f.triangles_turned > 0),
        case(
            "one in another, inside out in part",
            turned_bulb().and(over_bulb.clone()),
            (2, 0),
        )
        .volume(union_volume(&capsule(0.0, 1.0, 16, 5), &over_bulb), 0.02)
        .inside(&[[0.0, 0.0, 1.2], [0.1, 0.1, 1.2], [0.0, 0.0, 1.5]])
        .found(|f| f.triangles_hidden > 100),
        case("a copy at 1e-4", ball(1.0).and(ball(0.9998)), (2, 0))
            .volume(ball_volume(), 0.01)
            .inside(&[[0.0; 3]]),
        case(
            "boxes with a common edge",
            block().and(block().map(|v| v + Vector::new(1.0, 0.7, 0.0))),
            (2, 0),
        )
        .volume(2.0 * BLOCK_VOLUME, 1e-3)
        .found(|f| f.edges_crowded == 1),
        case("boxes with a common wall", common_wall(), (2, 1))
            .volume(2.0 * BLOCK_VOLUME, 0.01)
            .inside(&[[1.0, 0.35, 0.2]]),
        case("a ring through itself", self_crossing(), (1, 0))
            .error(0.15)
            .found(overlapping)
            .volume(self_crossing_volume() as f32, 0.03),
    ]);
}

#[test]
fn solids_with_sheets() {
    let wings = |z: f32| card(8).map(move |v| Vector::new(4.0 * v.x - 2.0, v.y - 0.5, z));
    all_pass(vec![
        case(
            "a ball with wings through it",
            ball(0.8).and(wings(0.0)),
            (1, 1),
        )
        .volume(ball_volume() * 0.512, 1e-3)
        .inside(&[[0.0, 0.0, 0.4]])
        .outside(&[[1.5, 0.0, 0.2], [1.5, 0.0, -0.2]])
        .found(|f| f.triangles_buried > 0),
        case(
            "the same, inside out",
            ball(0.8).inside_out().and(wings(0.1)),
            (1, 1),
        )
        .volume(ball_volume() * 0.512, 1e-3)
        .inside(&[[0.0, 0.0, -0.4]])
        .outside(&[[1.5, 0.0, 0.3], [1.5, 0.0, -0.2]]),
        case("a fin on an edge", finned_block(), (1, 1))
            .volume(BLOCK_VOLUME, 1e-3)
            .inside(&[[0.5, 0.35, 0.2]])
            .outside(&[[0.5, -0.3, 0.2]])
            .found(|f| f.edges_crowded == 1),
        case("a collar all round", collared_block(), (1, 1))
            .volume(BLOCK_VOLUME, 1e-3)
            .primitives(40)
            .inside(&[[0.5, 0.35, 0.1], [0.5, 0.35, 0.3]])
            .outside(&[[1.2, 0.35, 0.4], [1.2, 0.35, 0.0]]),
        case(
            "a card inside a ball",
            ball(1.0).and(wings(0.0).map(|v| v * 0.2)),
            (1, 1),
        )
        .volume(ball_volume(), 1e-3)
        .inside(&[[0.0; 3]])
        .found(|f| f.triangles_buried > 0),
        case(
            "a ball on a sheet",
            ball(0.3).and(card(6).map(|v| v * 2.0 - Vector::new(1.0, 1.0, 0.6))),
            (1, 1),
        )
        .volume(ball_volume() * 0.027, 1e-3)
        .outside(&[[0.7, 0.7, 0.0]])
        .inside(&[[0.0; 3]]),
        case("all at once", everything(), (2, 2))
            .error(0.2)
            .inside(&[[0.0; 3]])
            .volume(2.0 * ball_volume(), 0.02),
    ]);
}

#[test]
fn units_from_a_thousandth_to_a_hundred_thousand() {
    let shift = Vector::new(0.7, -0.2, 0.4);
    let scaled = |scale: f32| {
        let mesh = ball(0.8).and(card(4).map(|v| Vector::new(4.0 * v.x - 2.0, v.y - 0.5, 0.0)));
        let body = case("scaled", mesh.map(|v| (v + shift) * scale), (1, 1));
        body.volume(ball_volume() * 0.512 * scale.powi(3), 1e-3)
            .inside(&[((Vector::new(0.0, 0.0, 0.4) + shift) * scale).to_array()])
    };
    all_pass([1e-3, 1.0, 1e5].map(scaled).into());
}

/// Whatever comes of defects in any combination covers its source and is about as large.
fn combinations(seeds: std::ops::Range<u64>) {
    for seed in seeds {
        let mesh = combined(seed);
        let build = |primitives: usize| {
            let mut options = BuildOptions::default();
            options.quality = Quality::Fast;
            options.primitives = Some(primitives);
            let built = MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options);
            built.unwrap_or_else(|e| panic!("seed {seed}: {e}"))
        };
        let (mut medial, mut report) = build(PRIMITIVES);
        // Loose pieces that are more than the primitives get one each.
        if report.findings.patches > PRIMITIVES {
            (medial, report) = build(report.findings.patches);
        }
        let side = report.longest_side;
        let magnitude = mesh.vertices.iter().map(|v| v.abs().max_element());
        let rounding = 4.0 * f32::EPSILON * magnitude.fold(side, f32::max);
        let (points, out) = uncovered(&medial, &mesh, side, rounding);
        assert!(
            out == 0 && points > 20,
            "seed {seed}: {out} of {points} uncovered"
        );
        let h = report.hausdorff;
        let error = h.surface_to_envelope.max(h.envelope_to_surface) / side;
        assert!(
            error < 0.6,
            "seed {seed}: error {error}, {:?}",
            report.notes
        );
        let mass = medial.mass_properties(1.0).mass();
        assert!(
            mass > 0.0 && mass < 4.0 * side.powi(3),
            "seed {seed}: mass {mass}"
        );
    }
}

#[test]
fn defects_combine() {
    combinations(0..6);
}

#[test]
#[ignore = "minutes: 114 combinations, of which CI builds the first six"]
fn defects_combine_in_many_ways() {
    combinations(6..120);
}

#[test]
fn refused_meshes_are_named() {
    let refused: Vec<(Mesh, &str)> = vec![
        (turned_to_nan(block(), 5), "vertex 5 is not finite"),
        (out_of_range(block(), 3), "triangle 3 names vertex 4000"),
        (
            block().map(|v| Vector::new(v.x, 0.0, 0.0)),
            "none of 12 triangles has an area",
        ),
        (
            block().map(|_| Vector::new(1.0, 2.0, 3.0)),
            "[1.0, 2.0, 3.0]",
        ),
        (
            Mesh {
                vertices: block().vertices,
                indices: vec![],
            },
            "no triangles (8 vertices)",
        ),
        (
            Mesh {
                vertices: block().vertices,
                indices: vec![[0, 0, 1]; 3],
            },
            "none of 3 triangles",
        ),
    ];
    for (mesh, words) in refused {
        let built =
            MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &BuildOptions::default());
        let said = built.expect_err(words).to_string();
        assert!(said.contains(words), "{words:?} not in {said:?}");
    }
}
