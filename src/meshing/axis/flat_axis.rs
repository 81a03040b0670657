//! The medial axis of a convex body of flat faces, read off the roof over it (`roof.rs`), and how far it may be off.
//!
//! Where more than four sides meet in one corner, the roof has several corners near each other; those joined by short
//! edges become one ball again, and corners on the ground become the vertices of the source.
//!
//! # Proof
//! The sheets around the cell of a face and the face itself close up (each edge of the roof is of two of them),
//! and still do after corners became one and sheets were cut into triangles. So the points at which the balls
//! of those triangles touch the face cover it: were one not covered, a line through it would leave the cell
//! once. What balls miss the plane by, what vertices of the source are off the faces' polygons by, and what is
//! left out because it has no height, is therefore what the solid must grow by to cover the source, at most.
//! Balls are no larger than the least of their depths, so it bulges by no more than it grows and the planes' own
//! body does.

use crate::math::fast_hash::{FastMap, FastSet};
use crate::meshing::axis::blunt_sheets::BluntSheets;
use crate::meshing::axis::roof::{FIRST, GROUND, RoofCorner};
use crate::meshing::axis::sheet_triangles::sheet_triangles;
use crate::meshing::draft::{Ball, Draft};
use crate::meshing::geometry::bounds::{Point, direction};
use crate::meshing::geometry::convex::Plane;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::geometry::union_find::Groups;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::surface::flat_faces::FlatFaces;
use std::f64::consts::TAU;

/// Height, in units of the distance within which corners become one, below which triangles of a sheet are left out.
const NO_HEIGHT: f64 = 0.03;

/// Length, in units of the distance within which corners become one, up to which the surface may stick out of the other
/// sheets' balls for a sheet to be left out: those between faces that are nearly coplanar.
const BLUNT_HEIGHT: f64 = 0.03;

/// A face's polygon turns by this more or less than once around (rad), by rounding.
const TURN_ROUNDING: f64 = 1e-3;

/// First guess of a distance (longest side 1); only time depends on it.
const GUESS: f64 = 1e-7;

/// A medial axis.
pub struct Axis {
    /// Balls and slabs of the axis.
    pub draft: Draft,
    /// Radii must grow by this to cover the source for certain.
    pub growth: f64,
    /// How far it sticks out of the source at most.
    pub bulge: f64,
    /// Area of the body's faces (longest side 1).
    pub area: f64,
}

/// A two-dimensional face of the roof.
pub struct Polygon {
    /// The sides that it lies on, in ascending order.
    pub sides: [u32; 2],
    /// Corners of the polygon, in order.
    corners: Vec<u32>,
}

/// A convex body and the roof over it.
pub struct ConvexBody<'a> {
    surface: &'a Surface,
    pub planes: Vec<Plane>,
    corners: Vec<RoofCorner>,
    /// Vertices of the source, and the faces that each is on.
    vertices: Vec<(u32, Vec<u32>)>,
    /// Place of the vertex of each corner of the roof that is on the ground.
    vertex_of: Vec<Option<u32>>,
    /// Corners on the ground.
    ground: Vec<Point>,
}

impl<'a> ConvexBody<'a> {
    /// A body of the source, with the planes and the corners of the roof over it.
    pub fn new(
        surface: &'a Surface,
        faces: &FlatFaces,
        planes: Vec<Plane>,
        corners: Vec<RoofCorner>,
    ) -> Self {
        let mut faces_at: FastMap<u32, Vec<u32>> = FastMap::default();
        for &(t, face) in &faces.face_of {
            for v in surface.triangles[t] {
                let at = faces_at.entry(v).or_default();
                if !at.contains(&face) {
                    at.push(face);
                }
            }
        }
        let mut vertices: Vec<(u32, Vec<u32>)> = faces_at.into_iter().collect();
        vertices.sort_unstable();
        let on_ground = |c: &&RoofCorner| c.sides[0] == GROUND;
        let ground: Vec<Point> = corners
            .iter()
            .filter(on_ground)
            .map(|c| c.ball.center)
            .collect();
        let mut body = Self {
            surface,
            planes,
            vertex_of: Vec::new(),
            corners,
            vertices,
            ground,
        };
        body.vertex_of = body.corners.iter().map(|c| body.vertex_at(c)).collect();
        body
    }

    /// The vertex of the source that a corner on the ground stands for: the nearest on its three faces, or else
    /// the nearest on three faces.
    fn vertex_at(&self, corner: &RoofCorner) -> Option<u32> {
        if corner.sides[0] != GROUND {
            return None;
        }
        let all = |faces: &Vec<u32>| {
            corner.sides[1..]
                .iter()
                .all(|s| faces.contains(&(s - FIRST)))
        };
        let way = |at: usize| {
            let p = self.surface.vertices[self.vertices[at].0 as usize];
            (p - corner.ball.center).length_sq()
        };
        let known = (0..self.vertices.len()).filter(|&at| self.vertices[at].1.len() >= 3);
        let key = |at: &usize| (!all(&self.vertices[*at].1), way(*at));
        let nearest = known.min_by(|x, y| {
            let (x, y) = (key(x), key(y));
            x.0.cmp(&y.0).then(x.1.total_cmp(&y.1))
        });
        nearest.map(|at| at as u32)
    }

    /// All two-dimensional faces of the roof.
    pub fn polygons(&self) -> Vec<Polygon> {
        /// All pairs of the four sides that meet in a corner.
        const PAIRS: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
        let mut seen: FastSet<(u32, [u32; 2])> = FastSet::default();
        let mut polygons = Vec::new();
        for first in 0..self.corners.len() as u32 {
            for pair in PAIRS {
                let sides = pair.map(|k| self.corners[first as usize].sides[k]);
                if seen.contains(&(first, sides)) {
                    continue;
                }
                let mut corners = Vec::new();
                let mut at = first;
                // Along the edge that leaves one of the two other sides, and then the other that it came to.
                let mut leave = (0..4).find(|k| !pair.contains(k)).unwrap_or(0);
                while seen.insert((at, sides)) {
                    corners.push(at);
                    let from = &self.corners[at as usize];
                    let stays = from
                        .sides
                        .iter()
                        .enumerate()
                        .find(|(k, side)| *k != leave && !sides.contains(side));
                    let stays = stays.map(|(_, &side)| side);
                    at = from.next[leave];
                    let to = &self.corners[at as usize];
                    leave = stays.and_then(|side| to.place(side)).unwrap_or(0);
                }
                polygons.push(Polygon { sides, corners });
            }
        }
        polygons
    }

    /// The ball of each corner of the roof, where those joined by edges of up to `same` are one, and the balls.
    fn balls(&self, same: f64) -> (Vec<u32>, Vec<Ball>) {
        let n = self.corners.len();
        let mut groups = Groups::new(n);
        let mut first_of: FastMap<u32, u32> = FastMap::default();
        for (i, corner) in self.corners.iter().enumerate() {
            for &other in &corner.next {
                let ball = &self.corners[other as usize].ball;
                let way = (ball.center - corner.ball.center).length_sq();
                if way + (ball.radius - corner.ball.radius).powi(2) <= same * same {
                    groups.join(i as u32, other);
                }
            }
            if let Some(vertex) = self.vertex_of[i] {
                groups.join(i as u32, *first_of.entry(vertex).or_insert(i as u32));
            }
        }
        let mut index: FastMap<u32, u32> = FastMap::default();
        let mut members: Vec<Vec<u32>> = Vec::new();
        let mut ball_of = Vec::with_capacity(n);
        for i in 0..n as u32 {
            let own = *index.entry(groups.find(i)).or_insert_with(|| {
                members.push(Vec::new());
                members.len() as u32 - 1
            });
            members[own as usize].push(i);
            ball_of.push(own);
        }
        let balls = members.iter().map(|members| self.ball(members)).collect();
        (ball_of, balls)
    }

    /// The one ball of several corners: a vertex of the source, or the largest inside about their middle.
    fn ball(&self, members: &[u32]) -> Ball {
        if let Some(vertex) = members.iter().find_map(|&i| self.vertex_of[i as usize]) {
            return Ball {
                center: self.surface.vertices[self.vertices[vertex as usize].0 as usize],
                radius: 0.0,
            };
        }
        let share = 1.0 / members.len() as f64;
        let center = members.iter().fold(Point::zero(), |sum, &i| {
            sum + self.corners[i as usize].ball.center * share
        });
        let depths = self.planes.iter().map(|plane| plane.depth(center));
        Ball {
            center,
            radius: depths.fold(f64::INFINITY, f64::min).max(0.0),
        }
    }

    /// The axis where corners up to `same` apart are one.
    pub fn axis(&self, polygons: &[Polygon], same: f64, tree: &TriangleTree) -> Axis {
        let (ball_of, balls) = self.balls(same);
        let mut faces: FastSet<[u32; 3]> = FastSet::default();
        let mut list = Vec::new();
        let mut area = 0.0;
        let mut blunt = BluntSheets::new(self.planes.len());
        let (mut gap, mut left_out, mut off): (f64, f64, f64) = (0.0, 0.0, 0.0);
        for polygon in polygons {
            let mut corners: Vec<u32> = polygon
                .corners
                .iter()
                .map(|&c| ball_of[c as usize])
                .collect();
            corners.dedup();
            while corners.len() > 1 && corners.first() == corners.last() {
                corners.pop();
            }
            let [a, b] = polygon.sides;
            let of = |side: u32| (side - FIRST) as usize;
            if a == GROUND {
                off = off.max(self.off_polygon(of(b) as u32, &corners, &balls));
                area += polygon_area(&corners, &balls);
                continue;
            }
            let widest = corners.iter().map(|&v| balls[v as usize].radius);
            let widest = widest.fold(0.0, f64::max);
            if blunt.leaves_out([a, b].map(of), &self.planes, widest, BLUNT_HEIGHT * same) {
                continue;
            }
            for &corner in &corners {
                let ball = &balls[corner as usize];
                for side in [a, b] {
                    let depth = self.planes[of(side)].depth(ball.center);
                    gap = gap.max((depth - ball.radius).abs());
                }
            }
            let at = |v: u32| balls[v as usize].center;
            let (triangles, lost) = sheet_triangles(&corners, at, NO_HEIGHT * same);
            left_out += lost;
            for triangle in triangles {
                let mut key = triangle;
                key.sort_unstable();
                if faces.insert(key) {
                    list.push(triangle);
                }
            }
        }
        let bulge = |p: &Point| (tree.closest(*p, GUESS) - *p).length();
        Axis {
            bulge: self.ground.iter().map(bulge).fold(0.0, f64::max),
            growth: gap + left_out + off + blunt.loss(&self.planes),
            draft: without_unused(balls, list),
            area,
        }
    }

    /// How far vertices of a face are off the polygon of its corners; infinite where that does not go round once.
    fn off_polygon(&self, face: u32, corners: &[u32], balls: &[Ball]) -> f64 {
        let plane = &self.planes[face as usize];
        let n = corners.len();
        if n < 3 {
            return f64::INFINITY;
        }
        let flat = |p: Point| p + plane.normal * plane.depth(p);
        let at = |k: usize| flat(balls[corners[k % n] as usize].center);
        let inward = |k: usize| plane.normal.cross(direction(at(k + 1) - at(k)));
        // Which way it goes round, how often, and how far it turns back.
        let turns = (0..n).map(|k| {
            let (d, e) = (
                direction(at(k + 1) - at(k)),
                direction(at(k + 2) - at(k + 1)),
            );
            d.cross(e).dot(plane.normal).atan2(d.dot(e))
        });
        let turns: Vec<f64> = turns.collect();
        let turn: f64 = turns.iter().sum();
        let sign = turn.signum();
        if (turn.abs() - TAU).abs() > TURN_ROUNDING {
            return f64::INFINITY;
        }
        let mut back = 0.0;
        for k in (0..n).filter(|&k| turns[k] * sign < 0.0) {
            let shorter = (at(k + 1) - at(k))
                .length()
                .min((at(k + 2) - at(k + 1)).length());
            back += shorter * turns[k].abs().min(1.0);
        }
        let mut most: f64 = 0.0;
        for (v, faces) in &self.vertices {
            if !faces.contains(&face) {
                continue;
            }
            let vertex = self.surface.vertices[*v as usize];
            let p = flat(vertex);
            let mut beyond: f64 = 0.0;
            let mut nearest = f64::INFINITY;
            for k in 0..n {
                let way = p - at(k);
                let side = at(k + 1) - at(k);
                beyond = beyond.max(-sign * way.dot(inward(k)));
                let along = way.dot(side) / side.length_sq().max(f64::MIN_POSITIVE);
                nearest = nearest.min((way - side * along.clamp(0.0, 1.0)).length());
            }
            let outside = if beyond > 0.0 { nearest } else { 0.0 };
            most = most.max(outside + plane.depth(vertex).abs());
        }
        most + back
    }
}

/// Area of a flat polygon of balls' centres.
fn polygon_area(corners: &[u32], balls: &[Ball]) -> f64 {
    let at = |v: u32| balls[v as usize].center - balls[corners[0] as usize].center;
    let parts = corners.windows(2).map(|w| at(w[0]).cross(at(w[1])));
    0.5 * parts.fold(Point::zero(), |sum, part| sum + part).length()
}

/// A draft of balls and slabs, less balls that are of none.
fn without_unused(balls: Vec<Ball>, faces: Vec<[u32; 3]>) -> Draft {
    let mut place = vec![u32::MAX; balls.len()];
    let mut draft = Draft::default();
    for face in faces {
        let face = face.map(|v| {
            let own = &mut place[v as usize];
            if *own == u32::MAX {
                *own = draft.balls.len() as u32;
                draft.balls.push(balls[v as usize]);
            }
            *own
        });
        draft.faces.push(face);
    }
    draft
}
