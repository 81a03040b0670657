//! The surface of a medial mesh as triangles, for drawing and measuring.
//!
//! # Method
//! Every sheet (`sheet`: balls, flanks, planes) gets a grid; what lies inside another primitive
//! is cut off along the crease, and the cut's corners are found on the sheet by root search. So
//! every vertex is a point of the exact surface, at any spacing.
//!
//! The alternative, an isosurface on a grid of cells, is watertight, but a part thinner than a
//! cell vanishes (a medial mesh tapers to radius 0 at its tips, and may hold sheets of radius
//! 0), creases are bevelled by a cell, and its memory grows with the volume near the surface.
//! The price of sheets: along seams and creases neighbouring sheets share a curve but no
//! vertices, so the chords on its two sides differ by up to spacing²/(8 radius). Volume comes
//! from `mass`, which needs no surface.
//!
//! # Which points are hidden
//! A point of a sheet is hidden if its depth in some primitive exceeds the rounding of that depth.
//! Where two primitives share a piece of surface (a sphere listed twice, a cone along another),
//! the one with the lower index keeps it.
//!
//! A triangle with hidden corners is cut if one primitive hides them all: primitives are convex, so
//! that one hides what is between. Corners hidden by different primitives may have an exposed
//! strip between them: on the inner side of a torus of short cones each end of each flank is
//! hidden, by the neighbour at that end. Such a triangle is split in four and looked at again.

use super::cover::Cover;
use super::mesh::MedialMesh;
use super::sheet::{Sheet, Spot, sheets};
use crate::math::lane::Vec3;
use crate::math::{Real, Vector};
use parry3d::bounding_volume::Aabb;
use std::collections::HashMap;

/// Most triangles laid out before the cut (a count): 200 MB and about 3 s; a spacing that needs
/// more is widened.
const MAX_TRIANGLES: u64 = 1 << 22;

/// Steps along the longest side of the box when the spacing asked for is not a positive number.
const DEFAULT_STEPS: f64 = 64.0;

/// Rounding of a depth, as a fraction of the coordinates' magnitude: a few hundred times the
/// spacing of `f64`. Larger: surfaces that touch are torn apart along their contact; smaller:
/// surfaces cover themselves.
const ROUNDING: f64 = 1e-13;

/// Narrowest triangle kept: twice its area over the square of its longest side (a pure number).
/// Cutting leaves slivers along tangential seams; their area is nothing.
const SLIVER: f64 = 1e-5;

/// Root search along a side of a triangle ends at this fraction of the side: below `f32`'s
/// rounding of the vertex.
const ROOT_WIDTH: f64 = 1e-9;

/// Times that a triangle is split at most where its corners are hidden by different primitives
/// (a count): strips narrower than 1/8 of the spacing are lost, which is about a pixel where the
/// spacing is chosen to look smooth. One more makes narrow strips three times as costly.
const SPLITS: u32 = 3;

/// Primitives crossed in turn when a crease is sought (a count): two or three meet at its corners;
/// beyond this, bisection on whether anything hides the point is no slower.
const CREASE_ROUNDS: usize = 4;

/// Steps of a root search at most (a count): secants need about ten; where the crossing is
/// tangential the halvings between them still narrow it to 1e-4 of the side.
const ROOT_STEPS: usize = 40;

impl MedialMesh {
    /// The surface of the solid as vertices and triangles, for drawing, in the body's frame. Triangles are
    /// counter-clockwise seen from outside. Every vertex lies on the surface, up to rounding to `f32`.
    /// Neighbouring vertices are about `spacing` apart (a length), and closer along creases. Parts of radius 0
    /// appear as sheets with two sides. The pieces of the surface that different primitives contribute share
    /// no vertices, so fine cracks can be seen between them. Takes 5 to 20 µs per triangle.
    ///
    /// A spacing that is not positive and finite stands for 1/64 of the longest side of the bounding box. One
    /// that would need more than four million triangles is widened until it does not. Strips of the surface
    /// narrower than 1/8 of the spacing may be missing. Where a part narrower than the spacing
    /// stands on another surface, the hidden piece of that surface may be left in.
    ///
    /// ```
    /// use rapier3d_medial::MedialMesh;
    /// let ball = MedialMesh::ball(2.0)?;
    /// let (vertices, triangles) = ball.envelope(0.5);
    /// assert!(vertices.iter().all(|v| (v.length() - 2.0).abs() < 1e-6));
    /// assert!(triangles.len() > 100);
    /// # Ok::<(), rapier3d_medial::MeshError>(())
    /// ```
    pub fn envelope(&self, spacing: Real) -> (Vec<Vector>, Vec<[u32; 3]>) {
        let sheets = sheets(self);
        let mut trimmer = Trimmer::new(self);
        let spacing = usable_spacing(&sheets, trimmer.extent, spacing.into());
        for (sheet, spheres) in sheets {
            trimmer.select(&sheet, spheres);
            let grid = sheet.grid(spacing);
            trimmer.trim(&sheet, grid.parameters, &grid.triangles);
        }
        (trimmer.vertices, trimmer.triangles)
    }
}

fn usable_spacing(sheets: &[(Sheet, [u32; 3])], extent: f64, spacing: f64) -> f64 {
    let mut spacing = if spacing.is_finite() && spacing > 0.0 {
        spacing.min(extent)
    } else {
        extent / DEFAULT_STEPS
    };
    let size = |h: f64| {
        sheets
            .iter()
            .map(|(s, _)| s.size(h))
            .fold(0, u64::saturating_add)
    };
    while spacing < extent && size(spacing) > MAX_TRIANGLES {
        spacing *= 1.25;
    }
    spacing
}

/// Cuts sheets against the primitives around them and collects what is left.
struct Trimmer<'a> {
    mesh: &'a MedialMesh,
    /// Longest side of the box.
    extent: f64,
    /// Depths below this are rounding.
    rounding: f64,
    /// Primitives near the sheet at hand.
    covers: Vec<Cover>,
    /// Position in `covers` of what hid the last hidden point: it mostly hides the next.
    last: usize,
    /// Lowest index of a primitive that the sheet bounds.
    owner: u32,
    /// Triangles that may still be split.
    splits_left: u64,
    vertices: Vec<Vector>,
    triangles: Vec<[u32; 3]>,
}

impl<'a> Trimmer<'a> {
    fn new(mesh: &'a MedialMesh) -> Self {
        let aabb = mesh.aabb();
        let [lo, hi] = [aabb.mins, aabb.maxs].map(Vec3::<f64>::from_vector);
        let largest = |v: Vec3<f64>| v.x.abs().max(v.y.abs()).max(v.z.abs());
        Self {
            mesh,
            extent: largest(hi - lo),
            rounding: ROUNDING * largest(lo).max(largest(hi)),
            covers: Vec::new(),
            last: 0,
            owner: 0,
            splits_left: MAX_TRIANGLES,
            vertices: Vec::new(),
            triangles: Vec::new(),
        }
    }

    /// Collects the primitives that may hide points of a sheet.
    fn select(&mut self, sheet: &Sheet, rests_on: [u32; 3]) {
        let margin = self.rounding + self.extent * f64::from(Real::EPSILON);
        let margin = Vec3::new(margin, margin, margin);
        let [lo, hi] = sheet.bounds();
        let aabb = Aabb::new((lo - margin).to_vector(), (hi + margin).to_vector());
        let near = self.mesh.bvh().intersect_aabb(&aabb);
        self.covers = near
            .map(|index| Cover::new(self.mesh, index, rests_on, margin))
            .collect();
        if let Sheet::Plane { .. } = sheet {
            // All its points have one tangent plane, and so one rise.
            let spot = sheet.spot(Vec3::zero());
            self.covers.retain(|c| c.rise(spot) >= -self.rounding);
        }
        let owners = self.covers.iter().filter(|c| c.owner);
        self.owner = owners.map(|c| c.index).min().unwrap_or(0);
        // The primitives that most likely hide a point are asked first: the sheet's own, cheap to ask, then the others
        // by their distance from its middle.
        let middle = (lo + hi) * 0.5;
        self.covers.sort_by_cached_key(|c| c.rank(middle));
        self.last = 0;
    }

    fn hides(&self, cover: usize, spot: Spot) -> bool {
        let cover = &self.covers[cover];
        cover.hides(spot, self.rounding, cover.index < self.owner)
    }

    /// Position in `covers` of a primitive that hides the point.
    fn hidden_by(&mut self, spot: Spot) -> Option<usize> {
        let mut order = std::iter::once(self.last).chain(0..self.covers.len());
        let found = order.find(|&cover| self.hides(cover, spot))?;
        self.last = found;
        Some(found)
    }

    fn trim(&mut self, sheet: &Sheet, parameters: Vec<Vec3<f64>>, triangles: &[[u32; 3]]) {
        let hidden = parameters
            .iter()
            .map(|&q| self.hidden_by(sheet.spot(q)))
            .collect();
        let mut cut = Cut {
            sheet,
            parameters,
            hidden,
            middles: HashMap::new(),
            placed: HashMap::new(),
        };
        let mut waiting: Vec<([u32; 3], u32)> = Vec::new();
        for &triangle in triangles {
            waiting.push((triangle, 0));
            while let Some((triangle, splits)) = waiting.pop() {
                if splits < SPLITS && self.splits_left > 0 && cut.is_torn(self, triangle) {
                    self.splits_left -= 1;
                    let parts = cut.split(self, triangle);
                    waiting.extend(parts.map(|part| (part, splits + 1)));
                    continue;
                }
                let corners = cut.exposed_part(triangle);
                let placed: Vec<u32> = corners.iter().map(|&c| cut.place(self, c)).collect();
                for k in 2..placed.len() {
                    self.push_triangle([placed[0], placed[k - 1], placed[k]]);
                }
            }
        }
    }

    fn push_triangle(&mut self, triangle: [u32; 3]) {
        let [a, b, c] = triangle.map(|v| Vec3::<f64>::from_vector(self.vertices[v as usize]));
        let sides = [b - a, c - b, a - c].map(Vec3::length_sq);
        let longest_sq = sides[0].max(sides[1]).max(sides[2]);
        if (b - a).cross(c - a).length() > SLIVER * longest_sq {
            self.triangles.push(triangle);
        }
    }

    /// The last exposed parameter on the way from an exposed one to a hidden one.
    fn crease(&mut self, sheet: &Sheet, exposed: Vec3<f64>, hidden: Vec3<f64>) -> Vec3<f64> {
        let at = |x: f64| exposed + (hidden - exposed) * x;
        let mut end = 1.0;
        for _ in 0..CREASE_ROUNDS {
            let Some(by) = self.hidden_by(sheet.spot(at(end))) else {
                return at(end);
            };
            let cover = &self.covers[by];
            let excess = |x: f64| cover.excess(sheet.spot(at(x))) - self.rounding;
            end = last_negative(end, |x| excess(x).max(-self.extent));
        }
        // Many primitives meet here, or a shared surface hides it, of which the depth says nothing.
        let mut start = 0.0;
        while end - start > ROOT_WIDTH {
            let middle = 0.5 * (start + end);
            if self.hidden_by(sheet.spot(at(middle))).is_some() {
                end = middle;
            } else {
                start = middle;
            }
        }
        at(start)
    }
}

/// The largest `x` found in `[0, end)` from which a function that is not positive at 0 crosses to
/// positive: regula falsi with the Illinois step, the lower end of its final bracket.
fn last_negative(end: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut lo, mut hi) = (0.0, end);
    let (mut f_lo, mut f_hi) = (f(lo).min(0.0), f(hi).max(0.0));
    for step in 0..ROOT_STEPS {
        if hi - lo <= ROOT_WIDTH {
            break;
        }
        let secant = lo + (hi - lo) * (f_lo / (f_lo - f_hi));
        // Every third step halves: a tangential crossing starves the secant.
        let inner = secant > lo && secant < hi && step % 3 != 2;
        let x = if inner { secant } else { 0.5 * (lo + hi) };
        let value = f(x);
        if value <= 0.0 {
            (lo, f_lo, f_hi) = (x, value, 0.5 * f_hi);
        } else {
            (hi, f_hi, f_lo) = (x, value, 0.5 * f_lo);
        }
    }
    lo
}

/// The points of one sheet, as far as they are known.
struct Cut<'a> {
    sheet: &'a Sheet,
    parameters: Vec<Vec3<f64>>,
    /// Position in `Trimmer::covers` of what hides each point.
    hidden: Vec<Option<usize>>,
    /// Point in the middle of two others, lower index first.
    middles: HashMap<(u32, u32), u32>,
    /// Vertex on the side from an exposed to a hidden point, or at a point taken twice.
    placed: HashMap<(u32, u32), u32>,
}

impl Cut<'_> {
    /// Whether the hidden corners, two or more, are not all hidden by one primitive, and none so
    /// deeply that the whole triangle is within its depth.
    fn is_torn(&self, trimmer: &Trimmer, triangle: [u32; 3]) -> bool {
        let by = triangle.map(|v| self.hidden[v as usize]);
        if by.iter().flatten().count() < 2 {
            return false;
        }
        let spots = triangle.map(|v| self.sheet.spot(self.parameters[v as usize]));
        let hides_all = |cover: usize| {
            (0..3)
                .all(|k| by[k].is_none_or(|other| other == cover || trimmer.hides(cover, spots[k])))
        };
        if by.into_iter().flatten().any(hides_all) {
            return false;
        }
        let [a, b, c] = spots.map(|s| s.point);
        let [ab, bc, ca] = [b - a, c - b, a - c].map(Vec3::length);
        let side = ab.max(bc).max(ca);
        let shallow = |(k, cover): (usize, Option<usize>)| {
            let depth = cover.and_then(|cover| trimmer.covers[cover].depth(spots[k].point));
            depth.is_none_or(|(depth, _)| depth < side)
        };
        by.into_iter().enumerate().all(shallow)
    }

    fn split(&mut self, trimmer: &mut Trimmer, [a, b, c]: [u32; 3]) -> [[u32; 3]; 4] {
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(a, b)| {
            *self.middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let q = (self.parameters[a as usize] + self.parameters[b as usize]) * 0.5;
                self.parameters.push(q);
                self.hidden.push(trimmer.hidden_by(self.sheet.spot(q)));
                self.parameters.len() as u32 - 1
            })
        });
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    }

    /// The polygon of exposed corners and creases, each as in `placed`.
    fn exposed_part(&self, triangle: [u32; 3]) -> Vec<(u32, u32)> {
        let hidden = |v: u32| self.hidden[v as usize].is_some();
        let Some(first) = triangle.iter().position(|&v| !hidden(v)) else {
            return Vec::new();
        };
        let [a, b, c] = [0, 1, 2].map(|k| triangle[(first + k) % 3]);
        match (hidden(b), hidden(c)) {
            (false, false) => vec![(a, a), (b, b), (c, c)],
            (false, true) => vec![(a, a), (b, b), (b, c), (a, c)],
            (true, false) => vec![(a, a), (a, b), (c, b), (c, c)],
            (true, true) => vec![(a, a), (a, b), (a, c)],
        }
    }

    fn place(&mut self, trimmer: &mut Trimmer, (a, b): (u32, u32)) -> u32 {
        if let Some(&known) = self.placed.get(&(a, b)) {
            return known;
        }
        let mut q = self.parameters[a as usize];
        if a != b {
            q = trimmer.crease(self.sheet, q, self.parameters[b as usize]);
        }
        let index = trimmer.vertices.len() as u32;
        trimmer.vertices.push(self.sheet.spot(q).point.to_vector());
        self.placed.insert((a, b), index);
        index
    }
}
