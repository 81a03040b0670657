//! Parts that touch in whole faces, as kits of boxes and voxels do: the faces between them are not of the solid.

use crate::meshes::Mesh;
use parry3d::math::{Pose, Vector};
use parry3d::query::{Ray, RayCast};
use parry3d::shape::Cuboid;
use rapier3d_medial::{BuildOptions, BuildReport, MedialMesh, Quality};

/// A fourth of a cell's width.
const UNIT: f32 = 0.1;

/// Boxes of four by six by four units, one for each place in a grid.
fn cells(places: &[[i32; 3]]) -> Mesh {
    let half = Vector::new(2.0, 3.0, 2.0) * UNIT;
    let mut all = Mesh {
        vertices: vec![],
        indices: vec![],
    };
    for place in places {
        let (vertices, indices) = Cuboid::new(half).to_trimesh();
        let at = Vector::from(place.map(|k| k as f32)) * 2.0 * half;
        all = all.and(Mesh { vertices, indices }.map(|v| v + at));
    }
    all
}

fn build(mesh: &Mesh, quality: Quality) -> (MedialMesh, BuildReport) {
    let options = BuildOptions {
        quality,
        ..Default::default()
    };
    let built = MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options);
    built.expect("a medial mesh")
}

fn grid([x, y, z]: [i32; 3]) -> Vec<[i32; 3]> {
    let column = |x| move |y| (0..z).map(move |z| [x, y, z]);
    let slice = move |x| (0..y).flat_map(column(x));
    (0..x).flat_map(slice).collect()
}

#[test]
fn cells_side_by_side_are_one_solid() {
    let without = |all: Vec<[i32; 3]>, gone: [i32; 3]| -> Vec<[i32; 3]> {
        all.into_iter().filter(|place| *place != gone).collect()
    };
    let kits = [
        // Faces that two share; parry cuts the lower and the upper side of a box along other diagonals.
        ("2 × 2", grid([2, 1, 2]), 4),
        ("2 × 2 upright", grid([2, 2, 1]), 2),
        ("3 × 3 × 3", grid([3, 3, 3]), 36),
        ("a corner", without(grid([2, 2, 2]), [1, 1, 1]), 6),
        ("a frame", without(grid([3, 1, 3]), [1, 0, 1]), 8),
    ];
    for (name, places, shared) in kits {
        let mut mesh = cells(&places);
        for inside_out in [false, true] {
            if inside_out {
                mesh = mesh.inside_out();
            }
            let (medial, report) = build(&mesh, Quality::Balanced);
            let error = report.hausdorff.error();
            let volume = 96.0 * UNIT.powi(3) * places.len() as f32;
            let mass = medial.mass_properties(1.0).mass();
            println!("{name}: error {error}, mass {mass} of {volume}");
            assert_eq!(report.findings.triangles_shared, 4 * shared, "{name}");
            assert_eq!(report.findings.triangles_repeated, 0, "{name}");
            assert!(error < 1.0e-5, "{name}: error {error}");
            assert!(
                (mass / volume - 1.0).abs() < 2.0e-3,
                "{name}: {mass} of {volume}"
            );
        }
    }
}

/// One triangle split at the middle of its longest edge, whose neighbour there is not.
fn with_seam(mut mesh: Mesh, triangle: usize) -> Mesh {
    let corners = mesh.indices[triangle];
    let at = |k: usize| mesh.vertices[corners[k % 3] as usize];
    let length = |k: &usize| (at(k + 1) - at(*k)).length();
    let longest = (0..3)
        .max_by(|j, k| length(j).total_cmp(&length(k)))
        .unwrap_or(0);
    let middle = (at(longest) + at(longest + 1)) * 0.5;
    let [a, b, c] = [0, 1, 2].map(|k| corners[(longest + k) % 3]);
    let m = mesh.vertices.len() as u32;
    mesh.vertices.push(middle);
    mesh.indices[triangle] = [a, m, c];
    mesh.indices.push([m, b, c]);
    mesh
}

/// One triangle without the part next to its first corner, a share of its sides.
fn with_hole(mut mesh: Mesh, triangle: usize, share: f32) -> Mesh {
    let [a, b, c] = mesh.indices[triangle];
    let at = |v: u32| mesh.vertices[v as usize];
    let cut = [b, c].map(|v| at(a).lerp(at(v), share));
    let [p, q] = [0, 1].map(|k| mesh.vertices.len() as u32 + k);
    mesh.vertices.extend(cut);
    mesh.indices[triangle] = [p, b, c];
    mesh.indices.push([p, c, q]);
    mesh
}

/// What is open far from where parts touch, and parts given twice, leave the faces between parts within the solid.
#[test]
fn damaged_parts_that_touch_are_one_solid() {
    let tower = || cells(&grid([1, 4, 1]));
    let all = grid([3, 3, 3]);
    let shell: Vec<_> = all
        .iter()
        .copied()
        .filter(|place| *place != [1; 3])
        .collect();
    let core = || cells(&[[1; 3]]);
    let mut kits = vec![(
        "a core given twice",
        cells(&shell).and(core()).and(core()),
        27,
    )];
    for triangle in [0, 16, 24, 45] {
        kits.push(("a seam", with_seam(tower(), triangle), 4));
        kits.push(("a small hole", with_hole(tower(), triangle, 0.03), 4));
    }
    for (name, mesh, count) in kits {
        let (medial, report) = build(&mesh, Quality::Balanced);
        let (error, mass) = (report.hausdorff.error(), medial.mass_properties(1.0).mass());
        let volume = 96.0 * UNIT.powi(3) * count as f32;
        println!(
            "{name}: error {error}, mass {mass} of {volume}, {:?}",
            report.variant
        );
        assert!(error < 1.0e-4, "{name}: error {error}");
        assert!(
            (mass / volume - 1.0).abs() < 2.0e-3,
            "{name}: {mass} of {volume}"
        );
    }
}

/// A ray from above hits something at a height of at least `least`.
fn is_hit(mesh: &Mesh, [x, z]: [f32; 2], least: f32) -> bool {
    let ray = Ray::new(Vector::new(x, 5.0, z), Vector::NEG_Y);
    let (medial, _) = build(mesh, Quality::Fast);
    medial.intersects_ray(&Pose::IDENTITY, &ray, 5.0 - least)
}

/// A rectangle of triangles on both sides.
fn sheet(y: f32, [lo, hi]: [f32; 2]) -> Mesh {
    let corner = |x: f32, z: f32| Vector::new(x, y, z);
    Mesh {
        vertices: vec![
            corner(lo, lo),
            corner(hi, lo),
            corner(hi, hi),
            corner(lo, hi),
        ],
        indices: vec![[0, 1, 2], [0, 2, 3], [0, 2, 1], [0, 3, 2]],
    }
}

/// Both sides of a sheet are of the same corners too.
#[test]
fn sheets_with_two_sides_stay_where_no_solid_is_around_them() {
    let places = grid([3, 1, 3]).into_iter().filter(|p| *p != [1, 0, 1]);
    let frame = cells(&places.collect::<Vec<_>>());
    let across = sheet(3.0 * UNIT, [2.0 * UNIT, 6.0 * UNIT]);
    let hole = [0.41, 0.37];
    assert!(!is_hit(&frame, hole, -1.0));
    assert!(is_hit(&frame.clone().and(across), hole, 2.0 * UNIT));
    // Most of it, and the middles of its triangles, are inside the frame.
    let with_fin = frame.and(sheet(0.0, [-3.0 * UNIT, 1.9 * UNIT]));
    for at in [[-0.25, -0.25], [-0.25, 0.1], [0.1, -0.25]] {
        assert!(is_hit(&with_fin, at, -UNIT), "no fin at {at:?}");
    }
    // A box of single triangles without its upper side, in which a sheet hangs.
    let (vertices, mut indices) = Cuboid::new(Vector::splat(1.0)).to_trimesh();
    indices.retain(|t| t.iter().any(|v| vertices[*v as usize].y < 0.0));
    let open = Mesh { vertices, indices };
    for y in [0.0, 1.0] {
        let shelf = sheet(y, [-1.0, 1.0]);
        assert!(!is_hit(&open, [0.3, 0.2], y - 0.2));
        assert!(
            is_hit(&open.clone().and(shelf), [0.3, 0.2], y - 0.2),
            "a sheet at {y}"
        );
    }
}

/// A floor and a roof of single triangles with low walls, which a narrow bridge joins: the rim of what is open between
/// them goes around the body, and back. A sheet that hangs in it is no face that parts share.
#[test]
fn sheets_in_bodies_that_are_open_all_around_stay() {
    for [gap, bridge, height] in [[0.12, 0.01, -0.2], [0.06, 0.02, -0.1], [0.2, 0.005, -0.15]] {
        let outline = [
            [-0.5, -0.5],
            [-bridge, -0.5],
            [bridge, -0.5],
            [0.5, -0.5],
            [0.5, 0.5],
            [-0.5, 0.5],
        ];
        let levels = [-0.3, -0.5 * gap, 0.5 * gap, 0.3];
        let level = |z: f32| outline.map(|[x, y]| Vector::new(x, y, z));
        let mut indices = Vec::new();
        for (level, corner) in (0..3).flat_map(|level| (0..6).map(move |corner| (level, corner))) {
            if level != 1 || corner == 1 {
                let [a, b] = [corner, (corner + 1) % 6].map(|k| 6 * level + k);
                indices.extend([[a, b, b + 6], [a, b + 6, a + 6]]);
            }
        }
        for [a, b, c] in [[0, 1, 5], [1, 2, 5], [2, 4, 5], [2, 3, 4]] {
            indices.extend([[a, c, b], [18 + a, 18 + b, 18 + c]]);
        }
        let lantern = Mesh {
            vertices: levels.into_iter().flat_map(level).collect(),
            indices,
        };
        let sheet = sheet(height, [-0.2, 0.2]).map(|v| Vector::new(v.x, -v.z, v.y));
        let (_, report) = build(&lantern.and(sheet), Quality::Fast);
        assert_eq!(report.findings.triangles_shared, 0, "a gap of {gap}");
    }
}
