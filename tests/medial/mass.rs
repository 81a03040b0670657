//! Mass properties against closed forms, and against stratified sampling of random solids.

use crate::oracle::{Random, inside, random_mesh};
use nalgebra::Matrix3;
use parry3d::mass_properties::MassProperties;
use rapier3d_medial::math::{Rotation, Vector};
use rapier3d_medial::{MedialMesh, MedialSphere};
use std::f64::consts::PI;

fn close(found: f32, wanted: f64, relative: f64, what: &str) {
    let error = (f64::from(found) - wanted).abs() / wanted.abs();
    assert!(
        error <= relative,
        "{what}: {found}, not {wanted} ({error:.1e})"
    );
}

fn sorted_principal(m: &MassProperties) -> [f32; 3] {
    let p = m.principal_inertia();
    let mut p = [p.x, p.y, p.z];
    p.sort_by(f32::total_cmp);
    p
}

fn moved(mesh: &MedialMesh, rotation: Rotation, shift: Vector) -> MedialMesh {
    let spheres = mesh
        .spheres()
        .iter()
        .map(|s| MedialSphere::new(rotation * s.center + shift, s.radius))
        .collect();
    MedialMesh::new(spheres, mesh.edges().to_vec(), mesh.faces().to_vec()).unwrap()
}

#[test]
fn ball_has_the_closed_form() {
    for radius in [1e-3, 0.7, 250.0f32] {
        let m = MedialMesh::ball(radius).unwrap().mass_properties(2.0);
        let r = f64::from(radius);
        let mass = 2.0 * 4.0 / 3.0 * PI * r.powi(3);
        close(m.mass(), mass, 1e-6, "mass");
        for i in sorted_principal(&m) {
            close(i, 0.4 * mass * r * r, 1e-6, "inertia");
        }
        assert!(m.local_com.length() < 1e-6 * radius);
    }
}

#[test]
fn capsule_has_the_closed_form() {
    let (r, length) = (0.25f64, 1.5f64);
    let (a, b) = (Vector::new(3.0, 1.0, -2.0), Vector::new(3.0, 2.5, -2.0));
    let m = MedialMesh::capsule(a, b, r as f32)
        .unwrap()
        .mass_properties(1.0);
    let (tube, caps) = (PI * r * r * length, 4.0 / 3.0 * PI * r.powi(3));
    close(m.mass(), tube + caps, 1e-6, "mass");
    assert!((m.local_com - (a + b) * 0.5).length() < 1e-6);
    let axial = tube * r * r / 2.0 + caps * 0.4 * r * r;
    // Each half ball about the middle: its own transverse moment moved from the centre of the
    // ball to its centroid (3r/8) and on by half the length.
    let across = tube * (r * r / 4.0 + length * length / 12.0)
        + caps * (0.4 * r * r + length * length / 4.0 + 3.0 * length * r / 8.0);
    let [low, middle, high] = sorted_principal(&m);
    close(low, axial, 1e-6, "axial inertia");
    close(middle, across, 1e-6, "transverse inertia");
    close(high, across, 1e-6, "transverse inertia");
    let axis = m.principal_inertia_local_frame.inverse() * Vector::Y;
    let p = m.principal_inertia();
    let about_y = p.x * axis.x.powi(2) + p.y * axis.y.powi(2) + p.z * axis.z.powi(2);
    close(about_y, axial, 1e-5, "inertia about the capsule's axis");
}

/// Boxes, and a wedge that was built from triangles, in closed form.
#[test]
fn boxes_and_wedges_have_the_closed_form() {
    for half in [[0.5f32, 0.2, 0.3], [1e-3, 2e-3, 1e-3], [40.0, 0.01, 3.0]] {
        let mesh = MedialMesh::cuboid(Vector::from(half)).unwrap();
        let m = mesh.mass_properties(3.0);
        let [x, y, z] = half.map(f64::from);
        let mass = 3.0 * 8.0 * x * y * z;
        close(m.mass(), mass, 1e-6, "mass");
        let mut inertia = [y * y + z * z, x * x + z * z, x * x + y * y].map(|s| mass * s / 3.0);
        inertia.sort_by(f64::total_cmp);
        for (i, known) in sorted_principal(&m).into_iter().zip(inertia) {
            close(i, known, 1e-5, "inertia");
        }
        assert!(m.local_com.length() < 1e-6 * half[0]);
    }
    // Half a box, cut along the diagonal of its xy-face.
    let at = Vector::new(5.0, -2.0, 1.0);
    let outline = [[0.0, 0.0], [0.6, 0.0], [0.0, 0.4]];
    let corners = [0.0, 0.5].map(|z| outline.map(|[x, y]| at + Vector::new(x, y, z)));
    let triangles = [
        [0, 2, 1],
        [3, 4, 5],
        [0, 1, 4],
        [0, 4, 3],
        [1, 2, 5],
        [1, 5, 4],
        [2, 0, 3],
        [2, 3, 5],
    ];
    let built = MedialMesh::from_trimesh(&corners.concat(), &triangles, &Default::default());
    let m = built.unwrap().0;
    close(m.volume(), 0.06, 2e-5, "volume of the wedge");
    let com = m.mass_properties(1.0).local_com - at;
    assert!(
        com.distance(Vector::new(0.2, 0.4 / 3.0, 0.25)) < 1e-5,
        "{com:?}"
    );
}

#[test]
fn torus_has_the_closed_form() {
    let (major, minor, segments) = (1.0f64, 0.3f64, 256);
    let m = MedialMesh::torus(major as f32, minor as f32, segments)
        .unwrap()
        .mass_properties(1.0);
    let mass = 2.0 * PI * PI * major * minor * minor;
    close(m.mass(), mass, 5e-4, "mass");
    let [low, middle, high] = sorted_principal(&m);
    let axial = mass * (major * major + 0.75 * minor * minor);
    let across = mass * (0.5 * major * major + 0.625 * minor * minor);
    close(low, across, 1e-3, "transverse inertia");
    close(middle, across, 1e-3, "transverse inertia");
    close(high, axial, 1e-3, "axial inertia");
}

/// Steiner's formula for a triangle widened by a ball: 2 r A + π r² P/2 + 4/3 π r³.
#[test]
fn slabs_of_one_radius_have_the_closed_form_however_thin_and_however_turned() {
    let corners = [
        Vector::ZERO,
        Vector::new(1.0, 0.0, 0.0),
        Vector::new(0.0, 1.0, 0.0),
    ];
    for radius in [0.3f32, 1e-2, 1e-4, 1e-6] {
        for turn in [
            Rotation::IDENTITY,
            Rotation::from_rotation_x(1.0),
            Rotation::from_rotation_y(-2.0),
        ] {
            let spheres = corners
                .map(|c| MedialSphere::new(turn * c, radius))
                .to_vec();
            let mesh = MedialMesh::new(spheres, vec![], vec![[0, 1, 2]]).unwrap();
            let r = f64::from(radius);
            let perimeter = 2.0 + 2f64.sqrt();
            let wanted = r + PI / 2.0 * r * r * perimeter + 4.0 / 3.0 * PI * r.powi(3);
            close(
                mesh.volume(),
                wanted,
                2e-3,
                &format!("volume at radius {radius}"),
            );
        }
    }
}

/// A taper's volume: the frustum between the tangent circles and the two caps they cut. Its centre and inertia by
/// 20,000 discs.
#[test]
fn tapered_cone_has_the_closed_form() {
    let (r1, r2, length) = (0.5f64, 0.2f64, 1.0f64);
    let spheres = vec![
        MedialSphere::new(Vector::ZERO, r1 as f32),
        MedialSphere::new(Vector::new(0.0, 0.0, length as f32), r2 as f32),
    ];
    let mesh = MedialMesh::new(spheres, vec![[0, 1]], vec![]).unwrap();
    let volume = mesh.volume();
    let sin = (r1 - r2) / length;
    let cos = (1.0 - sin * sin).sqrt();
    let frustum = {
        let (a, b) = (r1 * cos, r2 * cos);
        let height = length - (r1 - r2) * sin;
        PI * height / 3.0 * (a * a + a * b + b * b)
    };
    let cap = |r: f64, height: f64| PI * height * height * (3.0 * r - height) / 3.0;
    close(
        volume,
        frustum + cap(r1, r1 * (1.0 + sin)) + cap(r2, r2 * (1.0 - sin)),
        1e-6,
        "volume",
    );
    let [mut discs, mut first, mut second, mut spin] = [0.0; 4];
    let step = (r1 + length + r2) / 20_000.0;
    for k in 0..20_000 {
        let z = -r1 + step * (f64::from(k) + 0.5);
        // The widest of all balls there.
        let ball = |s: f64| (r1 + s * (r2 - r1)).powi(2) - (z - s * length).powi(2);
        let best = (0..=2_000).map(|i| ball(f64::from(i) / 2_000.0));
        let radius_sq = best.fold(0.0, f64::max);
        let disc = PI * radius_sq * step;
        (discs, first, second) = (discs + disc, first + z * disc, second + z * z * disc);
        spin += 0.5 * radius_sq * disc;
    }
    let m = mesh.mass_properties(1.0);
    let middle = first / discs;
    close(m.local_com.z, middle, 1e-5, "centre");
    let across = 0.5 * spin + second - discs * middle * middle;
    let [low, between, high] = sorted_principal(&m);
    close(low, spin, 1e-5, "inertia about the axis");
    close(between, across, 1e-5, "inertia across it");
    close(high, across, 1e-5, "inertia across it");
}

#[test]
fn overlaps_count_once_and_apart_bodies_add_up() {
    let ball = MedialSphere::new(Vector::new(0.3, -0.2, 0.1), 0.5);
    let inner = MedialSphere::new(ball.center, 0.2);
    let far = MedialSphere::new(Vector::new(1e4, 0.0, 0.0), 0.5);
    let one = 4.0 / 3.0 * PI * 0.125;
    let volume =
        |spheres: Vec<MedialSphere>| MedialMesh::new(spheres, vec![], vec![]).unwrap().volume();
    close(
        volume(vec![ball, ball, inner]),
        one,
        2e-4,
        "the same ball twice, one inside",
    );
    close(
        volume(vec![ball, far]),
        2.0 * one,
        2e-4,
        "two balls far apart",
    );
}

#[test]
fn a_rigid_motion_moves_the_centre_and_keeps_the_principal_moments() {
    for seed in 0..6 {
        let mesh = random_mesh(seed);
        let mut random = Random(seed + 100);
        let rotation = Rotation::from_scaled_axis(random.vector(3.0));
        let shift = random.vector(5.0);
        let before = mesh.mass_properties(1.0);
        let after = moved(&mesh, rotation, shift).mass_properties(1.0);
        close(after.mass(), before.mass().into(), 1e-3, "mass");
        let wanted = rotation * before.local_com + shift;
        assert!((after.local_com - wanted).length() < 1e-3);
        for (a, b) in sorted_principal(&after)
            .into_iter()
            .zip(sorted_principal(&before))
        {
            close(a, b.into(), 2e-3, "principal inertia");
        }
    }
}

/// One random point in each cell of a grid: at 110³ cells the volume is known to about 2e-4.
#[test]
fn random_solids_agree_with_sampling() {
    for seed in 0..8 {
        let mesh = random_mesh(seed);
        let found = mesh.mass_properties(1.0);
        let mut random = Random(seed + 1000);
        let side = 110;
        let aabb = mesh.aabb();
        let (lo, size) = (aabb.mins, aabb.maxs - aabb.mins);
        let cell =
            f64::from(size.x) * f64::from(size.y) * f64::from(size.z) / f64::from(side).powi(3);
        let (mut count, mut first, mut second) = (0.0, [0.0; 3], Matrix3::zeros());
        let center = [found.local_com.x, found.local_com.y, found.local_com.z].map(f64::from);
        for cell in 0..side * side * side {
            let index = [cell % side, cell / side % side, cell / side / side];
            let mut p = [0.0; 3];
            for k in 0..3 {
                let step = f64::from(size[k]) / f64::from(side);
                p[k] = f64::from(lo[k]) + (f64::from(index[k]) + random.within(0.0, 1.0)) * step;
            }
            if inside(&mesh, p) {
                count += 1.0;
                for i in 0..3 {
                    first[i] += p[i] - center[i];
                    for j in 0..3 {
                        second[(i, j)] += (p[i] - center[i]) * (p[j] - center[j]);
                    }
                }
            }
        }
        close(
            found.mass(),
            count * cell,
            2e-3,
            &format!("volume, seed {seed}"),
        );
        let reach = f64::from(size.length());
        for f in first {
            assert!(
                (f / count).abs() < 5e-4 * reach,
                "seed {seed}: centre off by {}",
                f / count
            );
        }
        let trace: f64 = second.trace();
        let inertia = found.reconstruct_inertia_matrix();
        for i in 0..3 {
            for j in 0..3 {
                let wanted = cell * (if i == j { trace } else { 0.0 } - second[(i, j)]);
                let off = (f64::from(inertia.col(j)[i]) - wanted).abs() / (cell * trace);
                assert!(off < 3e-3, "seed {seed}: inertia[{i}][{j}] off by {off}");
            }
        }
    }
}

#[test]
fn no_volume_is_parrys_zero() {
    let flat = |z: f32| MedialSphere::new(Vector::new(z, z * z, 1.0), 0.0);
    let sheet = MedialMesh::new(
        vec![flat(0.0), flat(1.0), flat(2.0)],
        vec![],
        vec![[0, 1, 2]],
    )
    .unwrap();
    assert_eq!(sheet.mass_properties(3.0), MassProperties::default());
    assert_eq!(sheet.volume(), 0.0);
}

/// Sizes from the smallest `f32` to the largest that a mesh may have: a finite answer or zero, at once.
#[test]
fn absurd_sizes_end() {
    let mut zeros = 0;
    let mut cases = 0;
    for radius in [1e-45f32, 1e-30, 1e-12, 1.0, 1e12, 4e17] {
        for reach in [1e-45f32, 1e-30, 1e-12, 1.0, 1e12, 1e15, 6e17] {
            let spheres = vec![
                MedialSphere::new(Vector::ZERO, radius),
                MedialSphere::new(Vector::new(reach, 0.0, reach), radius * 0.5),
                MedialSphere::new(Vector::new(0.0, reach, reach), 0.0),
            ];
            let mesh = MedialMesh::new(spheres, vec![[0, 1]], vec![[0, 1, 2]]).unwrap();
            let m = mesh.mass_properties(1.0);
            assert!(m.mass().is_finite() && m.local_com.is_finite());
            zeros += usize::from(m.mass() == 0.0);
            cases += 1;
        }
    }
    assert!(
        zeros > 0 && zeros < cases,
        "{zeros} of {cases} without mass"
    );
}

/// A skew tetrahedron's mass, given to a medial mesh that is then scaled, beside that of the scaled tetrahedron.
#[test]
fn a_scaled_mesh_keeps_the_mass_of_its_triangles() {
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 2.0, 0.0],
        [0.3, 0.4, 3.0],
    ];
    let corners = corners.map(|[x, y, z]| Vector::new(x, y, z));
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
    let mass = MassProperties::from_trimesh(1.0, &corners, &faces);
    let mesh = MedialMesh::ball(1.0)
        .expect("a ball")
        .with_mass_properties(mass);
    let signs = [
        [1, 1, 1],
        [-1, 1, 1],
        [1, -1, 1],
        [1, 1, -1],
        [-1, -1, 1],
        [-1, -1, -1],
    ];
    // Of bodies of centimetres parry has no principal axes: their inertia is below its tolerance.
    for factor in [0.4f32, 1.0, 7.0] {
        for signs in signs {
            let scale = Vector::new(signs[0] as f32, signs[1] as f32, signs[2] as f32) * factor;
            let is_mirrored = signs.iter().product::<i32>() < 0;
            let turned = faces.map(|[a, b, c]| if is_mirrored { [a, c, b] } else { [a, b, c] });
            let wanted = MassProperties::from_trimesh(3.0, &corners.map(|c| c * scale), &turned);
            let found = mesh.scaled(scale).expect("scaled").mass_properties(3.0);
            close(found.mass(), wanted.mass().into(), 1e-5, "mass");
            assert!(
                (found.local_com - wanted.local_com).length() < 1e-5 * factor,
                "{scale}"
            );
            let [found, wanted] = [found, wanted].map(|m| m.reconstruct_inertia_matrix());
            let size = wanted
                .to_cols_array()
                .iter()
                .fold(0.0f32, |most, x| most.max(x.abs()));
            let off = (found - wanted).to_cols_array();
            assert!(
                off.iter().all(|x| x.abs() < 1e-4 * size),
                "{scale}: {found} is not {wanted}"
            );
        }
    }
    assert!(mesh.scaled(Vector::new(1.0, 2.0, 1.0)).is_none());
    // Beyond what `f32` holds, mass properties are the medial mesh's own, and no others than without triangles.
    for factor in [1.0e-12f32, 1.0e-9, 1.0e9] {
        let bare = MedialMesh::ball(factor)
            .expect("a ball")
            .mass_properties(1.0);
        let scaled = mesh
            .scaled(Vector::splat(factor))
            .expect("scaled")
            .mass_properties(1.0);
        assert_eq!(scaled.mass(), bare.mass(), "{factor}");
    }
}
