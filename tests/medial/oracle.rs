//! Independent answers: the solid by searching the interpolation weights, and random meshes.
//! Nothing here uses the crate's geometry.

use rapier3d_medial::math::Vector;
use rapier3d_medial::{MedialMesh, MedialSphere};

/// A reproducible source of random numbers (SplitMix64).
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in [lo, hi).
    pub fn within(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * ((self.bits() >> 11) as f64 / (1u64 << 53) as f64)
    }

    pub fn vector(&mut self, half: f64) -> Vector {
        let mut c = || self.within(-half, half) as f32;
        Vector::new(c(), c(), c())
    }
}

/// Minimum over [0, hi] of a convex function, by ternary search.
fn convex_minimum(hi: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut a, mut b) = (0.0, hi);
    let mut best = f(a).min(f(b));
    for _ in 0..90 {
        let (m1, m2) = (a + (b - a) / 3.0, b - (b - a) / 3.0);
        let (f1, f2) = (f(m1), f(m2));
        best = best.min(f1).min(f2);
        if f1 < f2 {
            b = m2;
        } else {
            a = m1;
        }
        if b - a < 1e-15 * hi {
            break;
        }
    }
    best
}

/// A sphere in double precision: its centre and radius.
type Ball = ([f64; 3], f64);

/// The sphere at weight `x` between two.
fn between((a, r): Ball, (b, s): Ball, x: f64) -> Ball {
    ([0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * x), r + (s - r) * x)
}

/// Smallest |p − c| − r over the spheres between two, in closed form: at the foot of `p`, moved along by `h s / √(1 −
/// s²)`, with `h` the distance from the line and `s` the slope of the radius.
fn on_cone(p: [f64; 3], first: Ball, second: Ball) -> f64 {
    let minus = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| a[k] - b[k]);
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [0, 1, 2].map(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
    };
    let at = |x: f64| {
        let (c, r) = between(first, second, x);
        let d = minus(p, c);
        dot(d, d).sqrt() - r
    };
    let d = minus(second.0, first.0);
    let length = dot(d, d).sqrt();
    let ends = at(0.0).min(at(1.0));
    let slope = (second.1 - first.1) / length;
    if length == 0.0 || slope.abs() >= 1.0 {
        return ends;
    }
    let q = minus(p, first.0);
    let off = cross(q, d);
    let aside = dot(off, off).sqrt() / length;
    let x = (dot(q, d) / length + aside * slope / (1.0 - slope * slope).sqrt()) / length;
    ends.min(at(x.clamp(0.0, 1.0)))
}

/// Smallest |p − c| − r over the spheres interpolated between 1, 2 or 3 of them: of three by a search over the weight
/// of the third, in which the least over the other two is convex.
pub fn signed_distance(spheres: &[MedialSphere], p: [f64; 3]) -> f64 {
    let ball = |s: &MedialSphere| (s.center.to_array().map(f64::from), f64::from(s.radius));
    let balls: Vec<Ball> = spheres.iter().map(ball).collect();
    match balls[..] {
        [a] => on_cone(p, a, a),
        [a, b] => on_cone(p, a, b),
        [a, b, c] => convex_minimum(1.0, |x| on_cone(p, between(a, c, x), between(b, c, x))),
        _ => f64::INFINITY,
    }
}

/// Whether a point lies outside the box of some spheres by more than `margin`.
pub fn beyond_box(spheres: &[MedialSphere], p: [f64; 3], margin: f64) -> bool {
    (0..3).any(|k| {
        let reach = |sign: f64| {
            spheres.iter().fold(f64::NEG_INFINITY, |m, s| {
                m.max(sign * f64::from(s.center[k]) + f64::from(s.radius))
            })
        };
        p[k] > reach(1.0) + margin || -p[k] > reach(-1.0) + margin
    })
}

/// Whether the convex hull of 1, 2 or 3 spheres covers a point: whether `r² − |p − c|²`, quadratic
/// in the weights, reaches 0 at a sphere, along an edge, or inside the triangle. (Where it has
/// no interior maximum, its maximum over the triangle is on an edge.)
pub fn covers(spheres: &[MedialSphere], p: [f64; 3]) -> bool {
    // Vectors of Minkowski space (p − c, r), whose square is r² − |p − c|².
    let lift = |s: &MedialSphere| {
        let c = [s.center.x, s.center.y, s.center.z].map(f64::from);
        [p[0] - c[0], p[1] - c[1], p[2] - c[2], s.radius.into()]
    };
    let dot = |a: [f64; 4], b: [f64; 4]| a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2];
    let minus = |a: [f64; 4], b: [f64; 4]| [0, 1, 2, 3].map(|k| a[k] - b[k]);
    let lifted: Vec<_> = spheres.iter().map(lift).collect();
    if lifted.iter().any(|&a| dot(a, a) >= 0.0) {
        return true;
    }
    let on_edge = |a, b| {
        let e = minus(b, a);
        let (ee, ae) = (dot(e, e), dot(a, e));
        let x = -ae / ee;
        ee < 0.0 && x > 0.0 && x < 1.0 && dot(a, a) - ae * ae / ee >= 0.0
    };
    for i in 0..lifted.len() {
        if on_edge(lifted[i], lifted[(i + 1) % lifted.len()]) {
            return true;
        }
    }
    let &[a, b, c] = lifted.as_slice() else {
        return false;
    };
    let (u, v) = (minus(b, a), minus(c, a));
    let (uu, uv, vv, au, av) = (dot(u, u), dot(u, v), dot(v, v), dot(a, u), dot(a, v));
    let det = uu * vv - uv * uv;
    let (x, y) = ((av * uv - au * vv) / det, (au * uv - av * uu) / det);
    let value = dot(a, a) + au * x + av * y;
    uu < 0.0 && det > 0.0 && x > 0.0 && y > 0.0 && x + y < 1.0 && value >= 0.0
}

/// Whether a point lies in the solid.
pub fn inside(mesh: &MedialMesh, p: [f64; 3]) -> bool {
    mesh.primitives().any(|primitive| {
        let spheres = primitive.spheres();
        !beyond_box(spheres, p, 0.0) && covers(spheres, p)
    })
}

/// The two oracles agree.
#[test]
fn quadratic_and_search_agree() {
    let mut random = Random(9);
    let (mut covered, mut cases) = (0, 0);
    for case in 0..3000 {
        let spheres: Vec<_> = (0..1 + case % 3)
            .map(|_| MedialSphere::new(random.vector(0.8), random.within(0.0, 1.3) as f32))
            .collect();
        let p = [0; 3].map(|_| random.within(-0.8, 0.8));
        let distance = signed_distance(&spheres, p);
        if distance.abs() > 1e-6 {
            assert_eq!(
                covers(&spheres, p),
                distance < 0.0,
                "{spheres:?} {p:?} {distance}"
            );
            covered += usize::from(distance < 0.0);
            cases += 1;
        }
    }
    assert!(
        3 * covered > cases && 3 * (cases - covered) > cases,
        "{covered} of {cases}"
    );
}

/// A strip of slabs with dangling cones and a lone sphere: random, connected, concave, with
/// spheres that contain their neighbours now and then.
pub fn random_mesh(seed: u64) -> MedialMesh {
    let mut random = Random(seed);
    let count = 6 + (random.bits() % 5) as u32;
    let mut at = Vector::ZERO;
    let spheres = (0..count)
        .map(|_| {
            at += random.vector(0.5);
            MedialSphere::new(at, random.within(0.02, 0.35) as f32)
        })
        .collect();
    let faces = (0..count - 4).map(|i| [i, i + 1, i + 2]).collect();
    let edges = vec![[0, count - 2]];
    MedialMesh::new(spheres, edges, faces).unwrap()
}
