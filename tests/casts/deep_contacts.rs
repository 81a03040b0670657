//! Contacts that parry's queries get of bodies deep in each other, beside the shortest way out by brute force over
//! directions in double precision: that of the two convex parts that are deepest in each other, as of parry's
//! compounds.

use crate::rng::Rng;
use nalgebra::{Isometry3, Point3, Vector3};
use parry3d::math::{Pose, Real, Rotation, Vector};
use parry3d::query::{DefaultQueryDispatcher, QueryDispatcher};
use parry3d::shape::SharedShape;
use rapier3d_medial::{MedialDispatcher, MedialMesh, MedialSphere};

type V = Vector3<f64>;

/// A convex part: how far it reaches along a unit direction.
#[derive(Clone)]
enum Part {
    /// The hull of spheres: their centres and radii.
    Spheres(Vec<(V, f64)>),
    /// Half extents.
    Cuboid(V),
    /// Half height and radius.
    Cylinder(f64, f64),
    Cone(f64, f64),
    /// A part grown by a radius.
    Round(Box<Part>, f64),
    Placed(Isometry3<f64>, Box<Part>),
}

impl Part {
    fn reach(&self, n: V) -> f64 {
        let across = n.x.hypot(n.z);
        match self {
            Self::Spheres(spheres) => {
                let reach = spheres
                    .iter()
                    .map(|(center, radius)| n.dot(center) + radius);
                reach.fold(f64::MIN, f64::max)
            }
            Self::Cuboid(half) => n.abs().dot(half),
            Self::Cylinder(height, radius) => height * n.y.abs() + radius * across,
            Self::Cone(height, radius) => (height * n.y).max(radius * across - height * n.y),
            Self::Round(inner, border) => inner.reach(n) + border,
            Self::Placed(pose, part) => {
                let own = pose.rotation.inverse_transform_vector(&n);
                part.reach(own) + n.dot(&pose.translation.vector)
            }
        }
    }
}

struct Body {
    name: &'static str,
    shape: SharedShape,
    parts: Vec<Part>,
}

fn exact(v: Vector) -> V {
    V::new(v.x.into(), v.y.into(), v.z.into())
}

/// The hull of some spheres of a mesh.
fn hull_of<'a>(spheres: impl Iterator<Item = &'a MedialSphere>) -> Part {
    let spheres = spheres.map(|s| (exact(s.center), f64::from(s.radius)));
    Part::Spheres(spheres.collect())
}

fn medial(name: &'static str, mesh: MedialMesh, is_convex: bool) -> Body {
    let parts = if is_convex {
        vec![hull_of(mesh.spheres().iter())]
    } else {
        let primitives = (0..mesh.primitive_count()).map(|k| mesh.primitive(k));
        primitives.map(|p| hull_of(p.spheres().iter())).collect()
    };
    Body {
        name,
        shape: SharedShape::new(mesh),
        parts,
    }
}

fn corners(unit: Real) -> [Vector; 3] {
    [[-0.5, 0.1, -0.4], [0.6, -0.1, -0.3], [0.0, 0.0, 0.6]].map(|c| Vector::from_array(c) * unit)
}

fn slab(unit: Real) -> MedialMesh {
    let radii = [0.02, 0.05, 0.1];
    let spheres = [0, 1, 2].map(|k| MedialSphere::new(corners(unit)[k], radii[k] * unit));
    let edges = vec![[0, 1], [1, 2], [0, 2]];
    MedialMesh::new(spheres.to_vec(), edges, vec![[0, 1, 2]]).expect("a slab")
}

fn medial_bodies(unit: Real) -> Vec<Body> {
    let v = |x, y, z| Vector::new(x, y, z) * unit;
    let r = |radius: Real| radius * unit;
    let cone = [
        MedialSphere::new(v(0.0, -0.5, 0.0), r(0.03)),
        MedialSphere::new(v(0.1, 0.5, 0.0), r(0.12)),
    ];
    let cone = MedialMesh::new(cone.to_vec(), vec![[0, 1]], vec![]).expect("a cone");
    let cuboid = MedialMesh::cuboid(v(0.5, 0.2, 0.3)).expect("a box");
    let ring = MedialMesh::torus(r(0.4), r(0.08), 12).expect("a ring");
    vec![
        medial("slab", slab(unit), true),
        medial("medial cone", cone, true),
        medial("medial box", cuboid, true),
        medial(
            "medial ball",
            MedialMesh::ball(r(0.2)).expect("a ball"),
            true,
        ),
        medial("ring", ring, false),
    ]
}

fn other_bodies(unit: Real) -> Vec<Body> {
    let body = |name, shape, part| Body {
        name,
        shape,
        parts: vec![part],
    };
    let r = |length: Real| length * unit;
    let x = |length: Real| f64::from(length * unit);
    let half = V::new(x(0.5), x(0.3), x(0.4));
    let spread = (0..14).map(|k| {
        let k = f64::from(k);
        V::new((2.4 * k).sin(), (1.7 * k).cos(), (0.9 * k + 1.0).sin()).normalize() * x(0.5)
    });
    let points: Vec<Vector> = spread.map(|p| p.cast::<Real>().data.0[0].into()).collect();
    let hull = Part::Spheres(points.iter().map(|p| (exact(*p), 0.0)).collect());
    let ends = [V::y(), -V::y()].map(|end| (end * x(0.4), x(0.2)));
    let aside = |along: Real| Isometry3::translation(x(along), x(0.1), 0.0);
    let pose = |along: Real| Pose::translation(r(along), r(0.1), 0.0);
    // The first child is out of reach.
    let pair = SharedShape::compound(vec![
        (pose(-10.0), SharedShape::cuboid(r(0.25), r(0.3), r(0.4))),
        (pose(-0.3), SharedShape::cuboid(r(0.25), r(0.3), r(0.4))),
        (pose(0.3), SharedShape::cylinder(r(0.5), r(0.3))),
    ]);
    let [a, b, c] = corners(unit);
    vec![
        body(
            "cuboid",
            SharedShape::cuboid(r(0.5), r(0.3), r(0.4)),
            Part::Cuboid(half),
        ),
        body(
            "round cuboid",
            SharedShape::round_cuboid(r(0.5), r(0.3), r(0.4), r(0.05)),
            Part::Round(Box::new(Part::Cuboid(half)), x(0.05)),
        ),
        body(
            "cylinder",
            SharedShape::cylinder(r(0.5), r(0.3)),
            Part::Cylinder(x(0.5), x(0.3)),
        ),
        body(
            "cone",
            SharedShape::cone(r(0.5), r(0.4)),
            Part::Cone(x(0.5), x(0.4)),
        ),
        body(
            "round cylinder",
            SharedShape::round_cylinder(r(0.45), r(0.25), r(0.05)),
            Part::Round(Box::new(Part::Cylinder(x(0.45), x(0.25))), x(0.05)),
        ),
        body(
            "hull",
            SharedShape::convex_hull(&points).expect("a hull"),
            hull,
        ),
        body(
            "capsule",
            SharedShape::capsule_y(r(0.4), r(0.2)),
            Part::Spheres(ends.to_vec()),
        ),
        body(
            "round triangle",
            SharedShape::round_triangle(a, b, c, r(0.1)),
            Part::Spheres([a, b, c].map(|c| (exact(c), x(0.1))).to_vec()),
        ),
        Body {
            name: "compound",
            shape: pair,
            parts: vec![
                Part::Placed(
                    aside(-10.0),
                    Box::new(Part::Cuboid(V::new(x(0.25), x(0.3), x(0.4)))),
                ),
                Part::Placed(
                    aside(-0.3),
                    Box::new(Part::Cuboid(V::new(x(0.25), x(0.3), x(0.4)))),
                ),
                Part::Placed(aside(0.3), Box::new(Part::Cylinder(x(0.5), x(0.3)))),
            ],
        },
    ]
}

/// Directions over the sphere.
fn directions() -> Vec<V> {
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let direction = |k: u32| {
        let y = 1.0 - (2.0 * f64::from(k) + 1.0) / 3000.0;
        let (sin, cos) = (golden * f64::from(k)).sin_cos();
        let across = (1.0 - y * y).sqrt();
        V::new(across * cos, y, across * sin)
    };
    (0..3000).map(direction).collect()
}

/// How far `b` has to move to be out of `a`: the least over all directions, refined about the best ones.
fn depth(a: &Part, b: &Part, directions: &[V]) -> f64 {
    let along = |n: V| (a.reach(n) + b.reach(-n), n);
    let mut ways: Vec<_> = directions.iter().map(|n| along(*n)).collect();
    ways.sort_by(|a, b| a.0.total_cmp(&b.0));
    let refined = ways.iter().take(12).map(|way| {
        let (mut best, mut width) = (*way, 0.05);
        while width > 1.0e-5 {
            let aside = best.1.cross(&V::new(0.3, -0.5, 0.8)).normalize();
            let across = best.1.cross(&aside);
            let around = (0..12).map(|k| {
                let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_6).sin_cos();
                along((best.1 + (aside * cos + across * sin) * width).normalize())
            });
            let next = around.min_by(|a, b| a.0.total_cmp(&b.0));
            match next.filter(|next| next.0 < best.0) {
                Some(next) => best = next,
                None => width *= 0.6,
            }
        }
        best.0
    });
    refined.fold(f64::MAX, f64::min)
}

/// The two parts that are deepest in each other, and how deep.
fn deepest<'a>(a: &'a Body, b: &'a [Part], directions: &[V]) -> (f64, [&'a Part; 2]) {
    let pairs = a.parts.iter().flat_map(|a| b.iter().map(move |b| [a, b]));
    let depths = pairs.map(|[a, b]| (depth(a, b, directions), [a, b]));
    let deepest = depths.max_by(|a, b| a.0.total_cmp(&b.0));
    deepest.expect("some parts")
}

/// Asserts that `dispatcher` tells the deepest contact of two bodies, and its way out, in both orders; whether they are
/// deep in each other.
fn is_shortest(
    dispatcher: &dyn QueryDispatcher,
    [a, b]: [&Body; 2],
    pose: &Pose,
    (directions, unit): (&[V], f64),
) -> bool {
    let exact_pose = Isometry3::from_parts(
        exact(pose.translation).into(),
        nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(
            pose.rotation.w.into(),
            pose.rotation.x.into(),
            pose.rotation.y.into(),
            pose.rotation.z.into(),
        )),
    );
    let of_b = |part: &Part| Part::Placed(exact_pose, Box::new(part.clone()));
    let placed: Vec<Part> = b.parts.iter().map(of_b).collect();
    let (depth, [part_a, part_b]) = deepest(a, &placed, directions);
    if depth < 0.05 * unit {
        return false;
    }
    let names = [a.name, b.name];
    for flipped in [false, true] {
        let contact = if flipped {
            dispatcher.contact(&pose.inverse(), &*b.shape, &*a.shape, 0.0)
        } else {
            dispatcher.contact(pose, &*a.shape, &*b.shape, 0.0)
        };
        let contact = contact.expect("known").expect("they overlap");
        let (normal, points) = if flipped {
            (contact.normal2, [contact.point2, contact.point1])
        } else {
            (contact.normal1, [contact.point1, contact.point2])
        };
        let told = -f64::from(contact.dist);
        let at = format!("{names:?} {flipped} {pose:?}: {contact:?}, {depth}");
        assert!((told - depth).abs() < 0.01 * depth, "{at}");
        // It separates the two parts, and its points are as far apart.
        let n = exact(normal);
        let along = part_a.reach(n) + part_b.reach(-n);
        assert!((along - told).abs() < 0.01 * depth, "{at}: {along}");
        let [p, q] = [
            Point3::from(exact(points[0])),
            Point3::from(exact(points[1])),
        ];
        let apart = n.dot(&(exact_pose * q - p));
        assert!((apart + told).abs() < 1.0e-3 * depth, "{at}: {apart}");
    }
    true
}

/// Symptom: of a slab across a cylinder the contact told the way out of its deepest sphere, up to nine times as long as
/// that of the slab, with a depth that did not separate them; of boxes it told the way through a face only.
#[test]
fn contacts_of_deep_bodies_are_the_shortest_way_out() {
    let dispatcher = MedialDispatcher::default().chain(DefaultQueryDispatcher);
    let directions = directions();
    let mut rng = Rng::new(11);
    let mut deep = 0;
    // parry's own contacts of bodies as small as the second are wrong or missing.
    for (unit, poses) in [(1.0, 4), (0.002, 2)] {
        let (medial, others) = (medial_bodies(unit), other_bodies(unit));
        for a in &medial {
            for b in medial.iter().chain(&others) {
                for _ in 0..poses {
                    let mut number = |by: f64| rng.range(-by, by) as Real;
                    let mut vector = |by| Vector::new(number(by), number(by), number(by));
                    let (at, turn) = (vector(0.35) * unit, vector(3.0));
                    let pose = Pose::from_parts(at, Rotation::from_scaled_axis(turn));
                    let size = f64::from(unit);
                    deep +=
                        usize::from(is_shortest(&dispatcher, [a, b], &pose, (&directions, size)));
                }
            }
        }
    }
    assert!(deep > 150, "{deep}");
}
