//! Meshes of machine parts with many edges: spur gears, threaded rods and nuts.

use crate::meshes::Mesh;
use parry3d::math::Vector;
use std::f32::consts::{PI, TAU};

/// Where a profile of an ISO thread (60°) bends, in pitches, and how deep it is there, in thread depths: a crest of an
/// eighth of the pitch, a root of a quarter.
const PROFILE: [(f32, f32); 4] = [(0.0, 0.0), (0.125, 0.0), (0.4375, 1.0), (0.6875, 1.0)];

/// Depth of an ISO thread in pitches: 5/8 of the height of its triangle.
const DEPTH: f32 = 0.541_27;

/// A screw surface about the z axis from z = 0 to `turns` pitches: `major` is the radius at its crests, `around` the
/// count of straight pieces in a turn.
struct Screw {
    major: f32,
    pitch: f32,
    turns: u32,
    around: u32,
}

impl Screw {
    fn height(&self) -> f32 {
        self.turns as f32 * self.pitch
    }

    /// The angle of a column of vertices.
    fn angle(&self, column: u32) -> f32 {
        TAU * column as f32 / self.around as f32
    }

    /// Radius at a height, given in pitches above the start of a crest.
    fn radius(&self, pitches: f32) -> f32 {
        let at = pitches.rem_euclid(1.0);
        let next = (1.0, 0.0);
        let bends = PROFILE.into_iter().chain([next]);
        let mut last = PROFILE[0];
        for bend in bends {
            if at <= bend.0 {
                let part = (at - last.0) / (bend.0 - last.0).max(f32::MIN_POSITIVE);
                let depth = last.1 + part * (bend.1 - last.1);
                return self.major - depth * DEPTH * self.pitch;
            }
            last = bend;
        }
        self.major
    }

    /// Heights and radii of the bends of a column that lie between its two ends, in pitches, with the number of each
    /// along the screw.
    fn column(&self, column: u32) -> Vec<(i32, f32)> {
        let start = column as f32 / self.around as f32;
        (-8..4 * (self.turns as i32 + 1))
            .map(|k| {
                let bend = PROFILE[k.rem_euclid(4) as usize].0;
                (k, k.div_euclid(4) as f32 + bend + start)
            })
            .collect()
    }

    /// Its vertices and triangles, which look away from the axis, and the rims at the bottom and the top: a vertex for
    /// each column.
    fn surface(&self) -> (Mesh, [Vec<u32>; 2]) {
        let turns = self.turns as f32;
        let mut vertices = Vec::new();
        let mut rims = [Vec::new(), Vec::new()];
        // Of each bend of each column its vertex; bends beyond an end are the vertex of that rim.
        let mut columns: Vec<Vec<u32>> = Vec::new();
        for c in 0..self.around {
            let (sin, cos) = self.angle(c).sin_cos();
            let start = c as f32 / self.around as f32;
            let mut push = |pitches: f32| {
                let radius = self.radius(pitches - start);
                vertices.push(Vector::new(
                    radius * cos,
                    radius * sin,
                    pitches * self.pitch,
                ));
                vertices.len() as u32 - 1
            };
            let [bottom, top] = [push(0.0), push(turns)];
            rims[0].push(bottom);
            rims[1].push(top);
            let bends = self.column(c).into_iter().map(|(_, at)| match at {
                at if at < 1e-3 => bottom,
                at if at > turns - 1e-3 => top,
                at => push(at),
            });
            columns.push(bends.collect());
        }
        let mut indices = Vec::new();
        for c in 0..self.around as usize {
            let own = &columns[c];
            // A turn on, the bends are those of the turn above.
            let (next, shift) = match columns.get(c + 1) {
                Some(next) => (next, 0),
                None => (&columns[0], 4),
            };
            let at = |list: &[u32], k: usize| list.get(k).copied().unwrap_or(list[list.len() - 1]);
            for k in 0..own.len() {
                let [a, b] = [k, k + 1].map(|k| at(own, k));
                let [d, e] = [k, k + 1].map(|k| at(next, k + shift));
                for t in [[a, d, e], [a, e, b]] {
                    if t[0] != t[1] && t[1] != t[2] && t[2] != t[0] {
                        indices.push(t);
                    }
                }
            }
        }
        (Mesh { vertices, indices }, rims)
    }
}

/// A threaded rod along z, of crest radius 1.
pub fn threaded_rod(pitch: f32, turns: u32, around: u32) -> Mesh {
    let screw = Screw {
        major: 1.0,
        pitch,
        turns,
        around,
    };
    let (mut mesh, [bottom, top]) = screw.surface();
    for (rim, z, up) in [(bottom, 0.0, false), (top, screw.height(), true)] {
        let middle = mesh.vertices.len() as u32;
        mesh.vertices.push(Vector::new(0.0, 0.0, z));
        for k in 0..rim.len() {
            let (a, b) = (rim[k], rim[(k + 1) % rim.len()]);
            mesh.indices
                .push(if up { [middle, a, b] } else { [middle, b, a] });
        }
    }
    mesh
}

/// A hexagonal nut about z whose thread has the radius 1 at its bottom and is `across` wide from middle to flat;
/// `around` is a multiple of 12.
pub fn nut(across: f32, pitch: f32, turns: u32, around: u32) -> Mesh {
    let screw = Screw {
        major: 1.0,
        pitch,
        turns,
        around,
    };
    let (thread, rims) = screw.surface();
    let mut mesh = thread.inside_out();
    let hexagon = |c: u32| {
        let angle = screw.angle(c);
        let from_flat = (angle + PI / 6.0).rem_euclid(PI / 3.0) - PI / 6.0;
        across / from_flat.cos() * Vector::new(angle.cos(), angle.sin(), 0.0)
    };
    let first = mesh.vertices.len() as u32;
    for z in [0.0, screw.height()] {
        let corners = (0..around).map(|c| hexagon(c) + Vector::new(0.0, 0.0, z));
        mesh.vertices.extend(corners);
    }
    for c in 0..around {
        let n = (c + 1) % around;
        let [a, b, d, e] = [first + c, first + n, first + around + c, first + around + n];
        mesh.indices.extend([[a, b, e], [a, e, d]]);
        for (rim, [out, out_next], up) in [(&rims[0], [a, b], false), (&rims[1], [d, e], true)] {
            let [own, own_next] = [c, n].map(|k| rim[k as usize]);
            let quad = [[own, out, out_next], [own, out_next, own_next]];
            let turned = |[p, q, r]: [u32; 3]| if up { [p, q, r] } else { [p, r, q] };
            mesh.indices.extend(quad.map(turned));
        }
    }
    mesh
}

/// A spur gear about z with involute teeth of module 2 / `teeth` (so that its pitch radius is 1) at 20°, with a bore.
pub fn gear(teeth: u32, bore: f32, thickness: f32) -> Mesh {
    /// Points of a flank.
    const FLANK: u32 = 5;
    let module = 2.0 / teeth as f32;
    let pressure = 20f32.to_radians();
    let involute = |angle: f32| angle.tan() - angle;
    let base = pressure.cos();
    let (top, root) = (1.0 + module, 1.0 - 1.25 * module);
    // Half the angle of a tooth at a radius.
    let half = |radius: f32| {
        let angle = (base / radius.max(base)).min(1.0).acos();
        let foot = 0.3 * (base - radius).max(0.0);
        PI / (2.0 * teeth as f32) + involute(pressure) - involute(angle) + foot
    };
    let mut outline: Vec<(f32, f32)> = Vec::new();
    for tooth in 0..teeth {
        let middle = TAU * tooth as f32 / teeth as f32;
        let flank = |k: u32| root.max(0.0) + (top - root) * k as f32 / (FLANK - 1) as f32;
        let radii = (0..FLANK).map(flank);
        outline.extend(radii.clone().map(|r| (r, middle - half(r))));
        outline.extend(radii.rev().map(|r| (r, middle + half(r))));
    }
    let n = outline.len() as u32;
    let mut mesh = Mesh {
        vertices: Vec::new(),
        indices: Vec::new(),
    };
    for z in [0.0, thickness] {
        let at = |r: f32, angle: f32| Vector::new(r * angle.cos(), r * angle.sin(), z);
        mesh.vertices
            .extend(outline.iter().map(|&(r, angle)| at(r, angle)));
        let even = |i: u32| outline[0].1 + TAU * i as f32 / n as f32;
        mesh.vertices.extend((0..n).map(|i| at(bore, even(i))));
    }
    for i in 0..n {
        let j = (i + 1) % n;
        let quad = |a: u32, b: u32, c: u32, d: u32| [[a, b, c], [a, c, d]];
        mesh.indices.extend(quad(i, j, j + 2 * n, i + 2 * n));
        mesh.indices
            .extend(quad(j + n, i + n, i + 3 * n, j + 3 * n));
        mesh.indices.extend(quad(i, i + n, j + n, j));
        mesh.indices
            .extend(quad(i + 2 * n, j + 2 * n, j + 3 * n, i + 3 * n));
    }
    mesh
}
