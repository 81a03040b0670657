//! Blocks of flat faces, whose convex pieces are searched as a whole: first contacts against those of their triangles,
//! contacts and depths of boxes against the separating axes of boxes in double precision.

use crate::blocks::{l_shape, t_shape};
use crate::ccd::rng::Rng;
use crate::truth_of_examples::mesh::Mesh;
use crate::truth_of_examples::triangle_toi::{
    Motion, TriangleBody, distance_at, first_contact as of_triangles,
};
use nalgebra::{Matrix3, Rotation3, Vector3};
use rapier3d::parry::query::NonlinearRigidMotion;
use rapier3d::parry::shape::Cuboid;
use rapier3d::prelude::{Pose, Real, Rotation, Vector};
use rapier3d_medial::elementary::Cores;
use rapier3d_medial::meshing::Variant;
use rapier3d_medial::pair::first_contact::first_contact_counted;
use rapier3d_medial::pair::{contacts, first_contact};
use rapier3d_medial::{BuildOptions, InitialContact, MedialMesh, ToiOptions, ToiStatus};

pub type V = Vector3<f64>;

pub fn mesh_of(triangles: &Mesh) -> MedialMesh {
    let built = MedialMesh::from_trimesh(
        &triangles.vertices,
        &triangles.indices,
        &BuildOptions::default(),
    );
    let (mesh, report) = built.expect("a block");
    assert_eq!(report.variant, Variant::Exact);
    mesh
}

pub fn cuboid(half: [Real; 3]) -> Mesh {
    let (vertices, indices) = Cuboid::new(Vector::from_array(half)).to_trimesh();
    Mesh { vertices, indices }
}

/// Motion of a second by exact numbers of single precision, for the triangles and for the medial mesh.
pub fn motion(start: V, velocity: V, turn: V) -> (Motion, NonlinearRigidMotion) {
    let single = |v: V| Vector::new(v.x as Real, v.y as Real, v.z as Real);
    let exact = |v: V| v.map(|x| f64::from(x as Real));
    let medial = NonlinearRigidMotion::new(
        Pose::from_translation(single(start)),
        Vector::ZERO,
        single(velocity),
        single(turn),
    );
    let triangles = Motion {
        start: exact(start),
        velocity: exact(velocity),
        turn: exact(turn),
    };
    (triangles, medial)
}

#[test]
fn tumbling_blocks_meet_when_their_triangles_do() {
    let blocks = [l_shape(), t_shape()];
    let [l, t] = blocks.map(|(vertices, indices)| Mesh { vertices, indices });
    let sources = [l, t, cuboid([0.3, 0.2, 0.5])];
    let blocks = sources.each_ref().map(mesh_of);
    let mut rng = Rng::new(2201);
    let mut count = [0; 2];
    for case in 0..240 {
        let (i, j) = (case % 3, case / 3 % 3);
        let from = V::new(-1.6, rng.range(-0.9, 0.9), rng.range(-0.9, 0.9));
        let speed = V::new(rng.range(1.0, 3.0), 0.0, 0.0);
        let first = motion(from, speed, rng.in_ball() * 6.0);
        let second = motion(V::zeros(), rng.in_ball() * 0.3, rng.in_ball() * 6.0);
        let bodies = [(&sources[i], &blocks[i]), (&sources[j], &blocks[j])];
        let meets = meets_as_its_triangles(bodies, [&first, &second], case);
        count[usize::from(meets)] += 1;
    }
    assert!(count[1] > 60 && count[0] > 40, "{count:?}");
}

/// Whether two bodies meet in the step; they must do so when their triangles do.
pub fn meets_as_its_triangles(
    bodies: [(&Mesh, &MedialMesh); 2],
    motions: [&(Motion, NonlinearRigidMotion); 2],
    case: usize,
) -> bool {
    let triangles = bodies.map(|(source, _)| TriangleBody::new(source));
    let triangles = [&triangles[0], &triangles[1]];
    let [(first, first_moves), (second, second_moves)] = motions;
    let truth = of_triangles(triangles, [first, second], 1.0, 1.0e-9);
    let options = ToiOptions::default();
    let [(_, a), (_, b)] = bodies;
    let found = first_contact(a, first_moves, b, second_moves, 1.0, &options);
    match (truth, found.status) {
        (None, ToiStatus::Separated) => false,
        (_, ToiStatus::Contact) => {
            let time = truth.unwrap_or(1.0);
            assert!(f64::from(found.lower) <= time + 1.0e-6, "{case}: late");
            // The tolerance, and what blocks are thicker than their triangles.
            let apart = distance_at(triangles, [first, second], f64::from(found.upper));
            let most = f64::from(options.tolerance) + 6.0e-6;
            assert!(apart < most, "{case}: told to touch when {apart} apart");
            true
        }
        other => panic!("{case}: {other:?}"),
    }
}

/// A box as a frame of three axes, its half sides, and its middle.
struct Box64 {
    axes: Matrix3<f64>,
    half: V,
    middle: V,
}

impl Box64 {
    fn reach(&self, n: &V) -> f64 {
        (self.axes.transpose() * n).abs().dot(&self.half)
    }

    /// The gap of two boxes along the fifteen directions that may separate them, the largest and its direction: minus
    /// the depth where they overlap.
    fn gap(&self, other: &Self) -> (f64, V) {
        let (a, b) = (&self.axes, &other.axes);
        let edges = (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
        let cross = edges.map(|(i, j)| a.column(i).cross(&b.column(j)));
        let faces = (0..3).flat_map(|k| [a.column(k).into_owned(), b.column(k).into_owned()]);
        let y = other.middle - self.middle;
        let along = |n: V| {
            let n = n.normalize() * y.dot(&n).signum();
            (y.dot(&n) - self.reach(&n) - other.reach(&n), n)
        };
        (faces.chain(cross))
            .filter(|n: &V| n.norm() > 1.0e-6)
            .map(along)
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .expect("a direction")
    }

    /// How far a point is outside, negative inside.
    fn distance(&self, point: &V) -> f64 {
        let local = (self.axes.transpose() * (point - self.middle)).abs() - self.half;
        let outside = local.map(|x| x.max(0.0)).norm();
        if outside > 0.0 { outside } else { local.max() }
    }
}

pub fn random_rotation(rng: &mut Rng) -> Rotation3<f64> {
    Rotation3::from_scaled_axis(rng.direction() * rng.range(0.0, 3.1))
}

pub fn double(v: Vector) -> V {
    V::new(v.x.into(), v.y.into(), v.z.into())
}

/// A rotation in single precision, and exactly this one.
pub fn rounded(rotation: &Rotation3<f64>) -> (Rotation, Rotation3<f64>) {
    let q = nalgebra::UnitQuaternion::from_rotation_matrix(rotation);
    let [x, y, z, w] = [q.i, q.j, q.k, q.w].map(|v| v as Real);
    let [i, j, k, r] = [x, y, z, w].map(f64::from);
    let exact = nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(r, i, j, k));
    (Rotation::from_xyzw(x, y, z, w), exact.to_rotation_matrix())
}

/// The pose in single precision, and the box at exactly this pose.
fn placed(half: [Real; 3], rotation: &Rotation3<f64>, middle: V) -> (Pose, Box64) {
    let (single, exact) = rounded(rotation);
    let at = Vector::new(middle.x as Real, middle.y as Real, middle.z as Real);
    let pose = Pose::from_parts(at, single);
    let of = Box64 {
        axes: *exact.matrix(),
        half: V::from(half.map(f64::from)),
        middle: double(at),
    };
    (pose, of)
}

#[test]
fn contacts_of_boxes_are_as_deep_as_separating_axes_say() {
    let halves = [[0.3, 0.2, 0.5], [0.25, 0.25, 0.25], [0.6, 0.1, 0.2]];
    let boxes = halves.map(|half| mesh_of(&cuboid(half)));
    let mut rng = Rng::new(2202);
    const MARGIN: f64 = 0.02;
    let (mut met, mut wide) = (0, 0);
    for case in 0..3000 {
        let (i, j) = (case % 3, case / 3 % 3);
        let first = placed(halves[i], &Rotation3::identity(), V::zeros()).1;
        // Faces that lie nearly flat on each other, and any others.
        let rotation = match case % 2 {
            0 => random_rotation(&mut rng),
            _ => Rotation3::from_scaled_axis(rng.in_ball() * 0.01),
        };
        let direction = rng.direction();
        // As far off along it as makes them overlap, or be apart, by a little.
        let wanted = rng.range(-0.03, 0.015);
        let (mut near, mut far) = (0.0, 3.0);
        for _ in 0..40 {
            let middle = 0.5 * (near + far);
            let second = placed(halves[j], &rotation, direction * middle).1;
            match first.gap(&second).0 < wanted {
                true => near = middle,
                false => far = middle,
            }
        }
        let (pose, second) = placed(halves[j], &rotation, direction * far);
        let (gap, n) = first.gap(&second);
        let (found, _) = contacts(&boxes[i], &boxes[j], &pose, MARGIN as Real);
        let deepest = (found.iter()).min_by(|a, b| a.distance.total_cmp(&b.distance));
        let Some(deepest) = deepest else {
            // The axes are exact of boxes that overlap; beside edges and corners boxes are farther apart.
            assert!(gap > 0.0, "case {case}: no contact at {gap}");
            continue;
        };
        met += 1;
        wide += u32::from(found.len() > 2);
        let told = f64::from(deepest.distance);
        assert!(told < MARGIN + 1.0e-6, "case {case}: {told}");
        if gap <= 0.0 {
            // A face is taken where an edge would be deeper by a little: up to 10° off.
            assert!(told <= gap + 2.0e-6, "case {case}: told {told}, is {gap}");
            assert!(
                told >= 1.02 * gap - 2.0e-6,
                "case {case}: told {told}, is {gap}"
            );
        } else {
            assert!(
                told >= 0.98 * gap - 2.0e-6,
                "case {case}: told {told}, is {gap}"
            );
        }
        let normal = double(deepest.normal);
        // Another axis may be as good.
        let is_as_good = along(&first, &second, &normal) > gap - 2.0e-6;
        assert!(
            gap > 0.0 || normal.dot(&n) > 0.98 || is_as_good,
            "case {case}: {normal} is not {n}"
        );
        for c in &found {
            let [on_first, on_second] = [c.points[0], pose * c.points[1]].map(double);
            // Thicker by enclosure, and rounded to single precision.
            let (a, b) = (first.distance(&on_first), second.distance(&on_second));
            assert!(
                a.abs() < 1.0e-5 && b.abs() < 1.0e-5,
                "case {case}: {a}, {b}"
            );
            let n = double(c.normal);
            let way = (on_second - on_first).dot(&n);
            assert!((way - f64::from(c.distance)).abs() < 1.0e-5, "case {case}");
        }
    }
    assert!(met > 1500 && wide > 600, "{met} met, {wide} of them wide");
}

fn along(first: &Box64, second: &Box64, n: &V) -> f64 {
    (second.middle - first.middle).dot(n) - first.reach(n) - second.reach(n)
}

/// Two boxes lie on each other and move: where the query says that they never get deeper by more than they may, they
/// never do, at two thousand times of the step; nor before a contact that it finds.
#[test]
fn boxes_that_touch_sink_in_no_deeper_than_they_may() {
    let halves = [[0.3, 0.2, 0.5], [0.25, 0.25, 0.25]];
    let boxes = halves.map(|half| mesh_of(&cuboid(half)));
    let mut rng = Rng::new(2203);
    const BY: f64 = 0.02;
    let (mut free, mut stopped) = (0, 0);
    for case in 0..200 {
        let options = ToiOptions {
            target_distance: 1.0e-3,
            initial_contact: InitialContact::Deepen { by: BY as Real },
            cores: Some(Cores {
                share: 0.0,
                at_most: Real::INFINITY,
                tips: 0.2,
            }),
            ..ToiOptions::default()
        };
        let top = 0.45 - rng.range(0.0, 0.01);
        let size = rng.log_range(0.01, 1.0);
        let moves = [0.0, top].map(|y| {
            let start = V::new(rng.range(-0.2, 0.2), y, rng.range(-0.2, 0.2));
            (start, rng.in_ball() * 0.1 * size, rng.in_ball() * size)
        });
        let [first, second] = moves.map(|(start, velocity, turn)| motion(start, velocity, turn));
        let found = first_contact(&boxes[0], &first.1, &boxes[1], &second.1, 1.0, &options);
        let gap_at = |t: f64| {
            let [a, b] = [(&first.0, halves[0]), (&second.0, halves[1])].map(|(m, half)| Box64 {
                axes: *Rotation3::from_scaled_axis(m.turn * t).matrix(),
                half: V::from(half.map(f64::from)),
                middle: m.start + m.velocity * t,
            });
            a.gap(&b).0
        };
        let deepest = gap_at(0.0) - BY;
        let until = match found.status {
            ToiStatus::Separated => 1.0,
            _ => f64::from(found.lower),
        };
        for k in 0..=2000 {
            let gap = gap_at(until * f64::from(k) / 2000.0);
            assert!(
                gap > deepest - 1.2e-4,
                "case {case}: {gap} is below {deepest}"
            );
        }
        match found.status {
            ToiStatus::Separated => free += 1,
            ToiStatus::Contact => stopped += 1,
            other => panic!("case {case}: {other:?}"),
        }
    }
    assert!(free > 60 && stopped > 20, "{free} free, {stopped} stopped");
}

/// A mesh that is saved, loaded or scaled keeps its pieces: it takes as few looks.
#[test]
fn pieces_survive_saving_and_scaling() {
    let (vertices, indices) = t_shape();
    let block = mesh_of(&Mesh { vertices, indices });
    let bytes = block.to_bytes();
    let loaded = MedialMesh::from_bytes(&bytes).expect("what was saved");
    let scaled = block.scaled(Vector::splat(2.0)).expect("a uniform scaling");
    // The same spheres, of which nobody knows that they are convex.
    let listed = MedialMesh::new(
        block.spheres().to_vec(),
        block.edges().to_vec(),
        block.faces().to_vec(),
    )
    .expect("a mesh");
    let nodes = |mesh: &MedialMesh, size: Real| {
        let at = |x: Real, speed: Real| {
            let start = Pose::from_translation(Vector::new(x * size, 0.1 * size, 0.0));
            NonlinearRigidMotion::new(
                start,
                Vector::ZERO,
                Vector::new(speed * size, 0.0, 0.0),
                Vector::ZERO,
            )
        };
        let options = ToiOptions::default();
        let (toi, counts) =
            first_contact_counted(mesh, &at(0.0, 0.0), mesh, &at(1.2, -0.5), 1.0, &options);
        assert_eq!(toi.status, ToiStatus::Contact);
        counts.nodes
    };
    let own = nodes(&block, 1.0);
    assert_eq!(nodes(&loaded, 1.0), own);
    #[cfg(feature = "serde")]
    {
        let text = serde_json::to_string(&block).expect("text");
        let read: MedialMesh = serde_json::from_str(&text).expect("what was written");
        assert_eq!(nodes(&read, 1.0), own);
    }
    assert_eq!(nodes(&scaled, 2.0), own);
    assert!(nodes(&listed, 1.0) > own, "{own}");
}
