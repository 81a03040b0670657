//! Blocks with flat faces, as triangle meshes.

use rapier3d::prelude::*;

/// An L-shaped block of 1 m by 1 m by 0.35 m, whose arms are 0.35 m thick.
pub fn l_shape() -> (Vec<Vector>, Vec<[u32; 3]>) {
    let [low, inner, high] = [-0.4, -0.05, 0.6];
    let outline = [
        (low, low),
        (high, low),
        (high, inner),
        (inner, inner),
        (inner, high),
        (low, high),
    ];
    let faces = [[0, 1, 2], [0, 2, 3], [0, 3, 5], [3, 4, 5]];
    prism(&outline, &faces, [-0.17, 0.18])
}

/// A T-shaped block of 1 m by 1 m by 0.27 m.
pub fn t_shape() -> (Vec<Vector>, Vec<[u32; 3]>) {
    let outline = [
        (0.0, 0.0),
        (1.0, 0.0),
        (1.0, 2.0),
        (2.0, 2.0),
        (2.0, 3.0),
        (-1.0, 3.0),
        (-1.0, 2.0),
        (0.0, 2.0),
    ];
    let outline = outline.map(|(x, y): (Real, Real)| ((x - 0.5) / 3.0, (y - 1.5) / 3.0));
    let stem = [[0, 1, 2], [0, 2, 7]];
    let top = [[5, 6, 7], [5, 7, 2], [5, 2, 4], [4, 2, 3]];
    let faces = [&stem[..], &top[..]].concat();
    prism(&outline, &faces, [-0.4 / 3.0, 0.4 / 3.0])
}

/// A prism between two heights over an outline, which these triangles fill.
pub fn prism(
    outline: &[(Real, Real)],
    faces: &[[u32; 3]],
    [low, high]: [Real; 2],
) -> (Vec<Vector>, Vec<[u32; 3]>) {
    let layer = |z: Real| outline.iter().map(move |(x, y)| Vector::new(*x, *y, z));
    let vertices = layer(low).chain(layer(high)).collect();
    let n = outline.len() as u32;
    let caps = faces
        .iter()
        .flat_map(|[a, b, c]| [[*a, *c, *b], [a + n, b + n, c + n]]);
    let sides = (0..n).flat_map(|k| {
        let next = (k + 1) % n;
        [[k, next, next + n], [k, next + n, k + n]]
    });
    (vertices, caps.chain(sides).collect())
}
