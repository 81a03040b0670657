//! Meshes with planted defects.

use crate::meshes::*;
use crate::oracle::Random;
use parry3d::math::Vector;

/// Volume of [`block`].
pub const BLOCK_VOLUME: f32 = 0.28;

/// Volume that a closed mesh encloses, by the divergence theorem.
pub fn volume(mesh: &Mesh) -> f32 {
    let six = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.vertices[v as usize].as_dvec3());
        a.dot(b.cross(c))
    };
    (mesh.indices.iter().map(six).sum::<f64>() / 6.0) as f32
}

/// Volume of the union of two convex meshes, counted on a lattice with half-spaces.
pub fn union_volume(a: &Mesh, b: &Mesh) -> f32 {
    let planes = |mesh: &Mesh| -> Vec<(Vector, f32)> {
        let plane = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| mesh.vertices[v as usize]);
            let normal = (b - a).cross(c - a);
            (normal, normal.dot(a))
        };
        let with_area = |p: &(Vector, f32)| p.0.length() > 1e-4;
        mesh.indices.iter().map(plane).filter(with_area).collect()
    };
    let (a, b) = (planes(a), planes(b));
    let holds = |planes: &[(Vector, f32)], p: Vector| planes.iter().all(|(n, d)| n.dot(p) <= *d);
    let n = 60;
    let mut held = 0;
    for i in 0..n * n * n {
        let unit = |k: i32| ((k % n) as f32 + 0.5) / n as f32 * 4.0 - 2.0;
        let p = Vector::new(unit(i), unit(i / n), unit(i / (n * n)));
        held += usize::from(holds(&a, p) || holds(&b, p));
    }
    held as f32 * (4.0 / n as f32).powi(3)
}

pub fn block() -> Mesh {
    cuboid(Vector::new(1.0, 0.7, 0.4))
}

/// A ball of few facets, so that its error is large and soon measured.
pub fn ball(radius: f32) -> Mesh {
    let mut mesh = capsule(0.0, radius, 9, 3);
    // Its poles are fans with flat triangles, and its middle ring is double.
    let Mesh { vertices, indices } = &mut mesh;
    indices.retain(|t| {
        let [a, b, c] = t.map(|v| vertices[v as usize]);
        (b - a).cross(c - a).length() > 1e-4 * radius * radius
    });
    mesh
}

/// A disc of radius 1 in the plane z = 0, in rings, so that a few primitives miss its outline.
pub fn disc(rings: u32) -> Mesh {
    let around = 36;
    let mut vertices = vec![Vector::ZERO];
    let mut indices = Vec::new();
    for k in 1..=rings {
        let first = vertices.len() as u32;
        for i in 0..around {
            let angle = i as f32 / around as f32 * std::f32::consts::TAU;
            vertices.push(Vector::new(angle.cos(), angle.sin(), 0.0) * (k as f32 / rings as f32));
            let (a, b) = (first + i, first + (i + 1) % around);
            if k == 1 {
                indices.push([0, a, b]);
            } else {
                indices.extend([[a - around, a, b], [a - around, b, b - around]]);
            }
        }
    }
    Mesh { vertices, indices }
}

/// A round plate.
pub fn plate(thickness: f32) -> Mesh {
    let outline: Vec<(f32, f32)> = (0..36)
        .map(|i| (i as f32 / 36.0 * std::f32::consts::TAU).sin_cos())
        .map(|(y, x)| (x, y))
        .collect();
    let cap: Vec<[u32; 3]> = (1..35).map(|k| [0, k, k + 1]).collect();
    prism(&outline, thickness, &cap)
}

/// Turns about a third of the triangles round.
pub fn turn_some(mut mesh: Mesh, seed: u64) -> Mesh {
    let mut random = Random(seed);
    for t in &mut mesh.indices {
        if random.within(0.0, 1.0) < 0.35 {
            t.swap(0, 1);
        }
    }
    mesh
}

/// Gives each triangle vertices of its own.
pub fn unweld(mesh: Mesh) -> Mesh {
    let corners = mesh.indices.iter().flatten();
    Mesh {
        vertices: corners.map(|&v| mesh.vertices[v as usize]).collect(),
        indices: (0..mesh.indices.len() as u32)
            .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
            .collect(),
    }
}

/// Shrinks each triangle towards its middle, so that none touch.
pub fn apart(mesh: Mesh, share: f32) -> Mesh {
    let mut mesh = unweld(mesh);
    for t in mesh.vertices.chunks_mut(3) {
        let middle = (t[0] + t[1] + t[2]) / 3.0;
        t.iter_mut().for_each(|v| *v += (middle - *v) * share);
    }
    mesh
}

pub fn repeat(mut mesh: Mesh) -> Mesh {
    mesh.indices.extend(mesh.indices.clone());
    mesh
}

pub fn repeat_turned(mut mesh: Mesh) -> Mesh {
    let turned = mesh.indices.iter().map(|&[a, b, c]| [c, b, a]);
    mesh.indices.extend(turned.collect::<Vec<_>>());
    mesh
}

pub fn collapse_some(mut mesh: Mesh) -> Mesh {
    mesh.indices
        .extend([[0, 0, 1], [2, 3, 2], [4, 4, 4], [5, 6, 6], [7, 7, 1]]);
    mesh
}

/// Puts a vertex on each edge of some triangles, and a triangle without area to close the gap.
pub fn with_needles(mut mesh: Mesh) -> Mesh {
    for t in 0..4 {
        let [a, b, c] = mesh.indices[t];
        let middle = (mesh.vertices[a as usize] + mesh.vertices[b as usize]) * 0.5;
        let m = mesh.vertices.len() as u32;
        mesh.vertices.push(middle);
        mesh.indices[t] = [a, m, c];
        mesh.indices.extend([[m, b, c], [a, b, m]]);
    }
    mesh
}

pub fn with_stray_vertices(mut mesh: Mesh) -> Mesh {
    mesh.vertices
        .extend([Vector::splat(1e6), Vector::splat(-1e6), Vector::ZERO]);
    mesh
}

/// The block with caps cut into fans of slivers.
pub fn sliver_block() -> Mesh {
    let n = 60;
    let side = |k: u32| {
        let s = 4.0 * k as f32 / n as f32;
        let (x, y) = match s as u32 {
            0 => (s, 0.0),
            1 => (1.0, s - 1.0),
            2 => (3.0 - s, 1.0),
            _ => (0.0, 4.0 - s),
        };
        (x, 0.7 * y)
    };
    let outline: Vec<(f32, f32)> = (0..n).map(side).collect();
    let cap: Vec<[u32; 3]> = (1..n - 1).map(|k| [0, k, k + 1]).collect();
    prism(&outline, 0.4, &cap)
}

/// Takes away triangles with the vertices of `count` random ones.
pub fn lose(mut mesh: Mesh, count: usize, seed: u64) -> Mesh {
    let mut random = Random(seed);
    for _ in 0..count {
        let at = random.bits() as usize % mesh.indices.len();
        mesh.indices.remove(at);
    }
    mesh
}

/// Keeps the triangles all of whose corners are wanted.
pub fn cut(mut mesh: Mesh, keep: impl Fn(Vector) -> bool) -> Mesh {
    let Mesh { vertices, indices } = &mut mesh;
    indices.retain(|t| t.iter().all(|&v| keep(vertices[v as usize])));
    mesh
}

pub fn needle() -> Mesh {
    Mesh {
        vertices: vec![
            Vector::ZERO,
            Vector::new(1.0, 0.0, 0.0),
            Vector::new(0.3, 1e-4, 0.0),
        ],
        indices: vec![[0, 1, 2]],
    }
}

/// The unit square of the plane z = 0 in n × n cells.
pub fn card(n: u32) -> Mesh {
    let mut vertices = Vec::new();
    let mut indices = Vec::new();
    for i in 0..=n {
        for j in 0..=n {
            vertices.push(Vector::new(i as f32, j as f32, 0.0) / n as f32);
            if i < n && j < n {
                let a = i * (n + 1) + j;
                let b = a + n + 1;
                indices.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
            }
        }
    }
    Mesh { vertices, indices }
}

/// A round plate of no height whose top and bottom are cut differently.
pub fn flattened() -> Mesh {
    let mut mesh = plate(0.1).map(|v| Vector::new(v.x, v.y, 0.0));
    for t in mesh
        .indices
        .iter_mut()
        .filter(|t| t.iter().all(|&v| v >= 36))
    {
        *t = t.map(|v| 36 + (v - 36 + 5) % 36);
    }
    mesh
}

pub fn mobius(n: u32) -> Mesh {
    let mut vertices = Vec::new();
    for i in 0..n {
        let u = i as f32 / n as f32 * std::f32::consts::TAU;
        for s in [-0.3, 0.3] {
            let r = 1.0 + s * (0.5 * u).cos();
            vertices.push(Vector::new(r * u.cos(), r * u.sin(), s * (0.5 * u).sin()));
        }
    }
    let mut indices = Vec::new();
    for i in 0..n {
        let (a, b) = (2 * i, 2 * i + 1);
        let (c, d) = if i + 1 < n { (a + 2, b + 2) } else { (1, 0) };
        indices.extend([[a, b, c], [b, d, c]]);
    }
    Mesh { vertices, indices }
}

/// Three wavy pages at one edge, which is six edges long.
pub fn book() -> Mesh {
    let page = |angle: f32| {
        card(6).map(move |v| {
            let wave = 0.1 * (7.0 * v.x).sin();
            let (sin, cos) = angle.sin_cos();
            Vector::new(v.x * cos - wave * sin, v.x * sin + wave * cos, v.y)
        })
    };
    page(0.0).and(page(0.7)).and(page(2.0))
}

/// Triangles anywhere.
pub fn soup(count: u32, seed: u64) -> Mesh {
    let mut random = Random(seed);
    let vertices = (0..count)
        .flat_map(|_| {
            let at = random.vector(1.0);
            [0; 3].map(|_| at + random.vector(0.3))
        })
        .collect();
    Mesh {
        vertices,
        indices: (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
    }
}

/// Two blocks side by side that share the triangles between them.
pub fn common_wall() -> Mesh {
    let wall =
        |mesh: &Mesh, t: &[u32; 3], x: f32| t.iter().all(|&v| mesh.vertices[v as usize].x == x);
    let left = block();
    let mut right = block();
    right
        .indices
        .retain(|t| !t.iter().all(|&v| right.vertices[v as usize].x == 0.0));
    let found = left.indices.iter().filter(|t| wall(&left, t, 1.0)).count();
    assert_eq!(found, 2);
    left.and(right.map(|v| v + Vector::new(1.0, 0.0, 0.0)))
}

/// A tube along a figure of eight: it passes through itself in the middle.
pub fn self_crossing() -> Mesh {
    torus(1.0, 0.15, 80, 10).map(|v| {
        let angle = v.y.atan2(v.x);
        let from_axis = v.x.hypot(v.y) - 1.0;
        let center = Vector::new(angle.sin(), (2.0 * angle).sin() * 0.6, 0.0);
        let along = Vector::new(angle.cos(), 1.2 * (2.0 * angle).cos(), 0.0).normalize();
        center + along.cross(Vector::Z) * from_axis + Vector::Z * v.z
    })
}

/// A ball of radius 1 whose top goes through itself to a bulb, which is inside out: it lies from z = 1.1 to 1.35, and
/// has radius .2.
pub fn turned_bulb() -> Mesh {
    let around = 16u32;
    let ball = (1..10).map(|k| (18.0 * k as f32 - 90.0).to_radians().sin_cos());
    let ball = ball.map(|(z, r)| (r, z));
    let rings: Vec<(f32, f32)> = ball
        .chain([(-0.1, 1.1), (-0.2, 1.2), (-0.1, 1.3)])
        .collect();
    let mut vertices = vec![Vector::NEG_Z, Vector::new(0.0, 0.0, 1.35)];
    let mut indices = Vec::new();
    for (k, &(r, z)) in rings.iter().enumerate() {
        let first = 2 + around * k as u32;
        for i in 0..around {
            let (sin, cos) = (i as f32 / around as f32 * std::f32::consts::TAU).sin_cos();
            // Mirrored where r is negative.
            vertices.push(Vector::new(r.abs() * cos, r * sin, z));
            let (a, b) = (first + i, first + (i + 1) % around);
            match k {
                0 => indices.push([0, b, a]),
                _ => indices.extend([[a - around, b, a], [a - around, b - around, b]]),
            }
            if k + 1 == rings.len() {
                indices.push([1, a, b]);
            }
        }
    }
    Mesh { vertices, indices }
}

/// A thick octagonal body whose closed wings are a thousandth thick, in one patch.
pub fn winged() -> Mesh {
    let n = 48;
    let profile = |k: u32| -> (f32, f32) {
        // Around the cross-section: x from the tip of one wing over the body to the other.
        let s = k as f32 / n as f32 * 4.0 - 2.0;
        let body = (0.36 - s * s).max(0.0).sqrt();
        (s, body.max(0.001))
    };
    let upper = (0..=n).map(profile);
    let lower = (0..=n).rev().map(profile).map(|(x, y)| (x, -y));
    let outline: Vec<(f32, f32)> = upper.chain(lower).collect();
    let m = outline.len() as u32;
    let mut mesh = Mesh {
        vertices: Vec::new(),
        indices: Vec::new(),
    };
    for y in [-0.5f32, 0.5] {
        mesh.vertices
            .extend(outline.iter().map(|&(x, z)| Vector::new(x, y, z)));
    }
    for i in 0..m {
        let j = (i + 1) % m;
        mesh.indices.extend([[i, j, j + m], [i, j + m, i + m]]);
    }
    for k in 0..n {
        let (a, b, c, d) = (k, k + 1, m - 2 - k, m - 1 - k);
        mesh.indices.extend([
            [a, c, b],
            [a, d, c],
            [a + m, b + m, c + m],
            [a + m, c + m, d + m],
        ]);
    }
    mesh
}

/// Volume of [`self_crossing`]: that of the round tube, counted on a lattice, times the share of a
/// circle that its ten corners leave.
pub fn self_crossing_volume() -> f64 {
    let curve: Vec<[f64; 2]> = (0..300)
        .map(|k| k as f64 / 300.0 * std::f64::consts::TAU)
        .map(|a| [a.sin(), 0.6 * (2.0 * a).sin()])
        .collect();
    let spacing = 0.02;
    let mut held = 0;
    for i in -60..=60 {
        for j in -40..=40 {
            let (x, y) = (i as f64 * spacing, j as f64 * spacing);
            let to = |c: &[f64; 2]| (c[0] - x).hypot(c[1] - y);
            let nearest = curve.iter().map(to).fold(f64::MAX, f64::min);
            let height = (0.15f64 * 0.15 - nearest * nearest).max(0.0).sqrt();
            held += (2.0 * height / spacing).round() as usize;
        }
    }
    let corners = 10.0 * (36f64.to_radians()).sin() / std::f64::consts::TAU;
    held as f64 * spacing.powi(3) * corners
}

/// The block with a fin at its edge from (0, 0, 0) to (1, 0, 0).
pub fn finned_block() -> Mesh {
    let mut mesh = block();
    mesh.vertices
        .extend([Vector::new(0.0, -0.6, -0.1), Vector::new(1.0, -0.6, -0.1)]);
    mesh.indices.extend([[0, 8, 9], [0, 9, 1]]);
    mesh
}

/// The block, cut at half its height, with a collar on the cut.
pub fn collared_block() -> Mesh {
    let half =
        |z: f32| cuboid(Vector::new(1.0, 0.7, 0.2)).map(move |v| v + Vector::new(0.0, 0.0, z));
    let without = |mut mesh: Mesh, z: f32| {
        let Mesh { vertices, indices } = &mut mesh;
        indices.retain(|t| !t.iter().all(|&v| (vertices[v as usize].z - z).abs() < 1e-6));
        mesh
    };
    let mut mesh = without(half(0.0), 0.2).and(without(half(0.2), 0.2));
    let inner = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.7), (0.0, 0.7)];
    let outer = [(-0.4, -0.4), (1.4, -0.4), (1.4, 1.1), (-0.4, 1.1)];
    let first = mesh.vertices.len() as u32;
    let rings = inner.into_iter().chain(outer);
    mesh.vertices
        .extend(rings.map(|(x, y)| Vector::new(x, y, 0.2)));
    for k in 0..4 {
        let next = (k + 1) % 4;
        let [a, b, c, d] = [k, next, next + 4, k + 4].map(|i| first + i);
        mesh.indices.extend([[a, b, c], [a, c, d]]);
    }
    mesh
}

pub fn turned_to_nan(mut mesh: Mesh, vertex: usize) -> Mesh {
    mesh.vertices[vertex].y = f32::NAN;
    mesh
}

pub fn out_of_range(mut mesh: Mesh, triangle: usize) -> Mesh {
    mesh.indices[triangle][1] = 4000;
    mesh
}
