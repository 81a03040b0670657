//! Sharp edges of a surface: convex creases, reflex edges, the corners where creases end, and the
//! smooth groups of triangles between them.
//!
//! On a convex crease the medial axis reaches the surface, with radius 0; a corner is a vertex of it
//! (Culver, Keyser and Manocha, "Exact computation of the medial axis of a polyhedron", 2004). At a
//! reflex edge the axis stays inside, and bends.

use crate::error::BuildError;
use crate::math::fast_hash::FastMap;
use crate::medial::simplex::sides;
use crate::meshing::geometry::bounds::{Point, direction};
use crate::meshing::geometry::triangle::closest_on_triangle;
use crate::meshing::geometry::union_find::Groups;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::surface::edges::Edges;
use crate::meshing::watch::Watch;
use std::collections::BTreeMap;

/// Cosine of the turn of a chain of creases above which its vertex is no corner: 32°.
const STRAIGHT: f64 = 0.85;

/// Needles crossed on the way from a triangle to its neighbour at most: strips of them are short.
const MOST_NEEDLES: usize = 20;

/// Steps of a walk over triangles at most; a walk along a finely cut group is as long as its way.
const MOST_STEPS: usize = 300;

/// A sharp edge.
#[derive(Clone, Copy)]
pub struct SharpEdge {
    /// Ends of the crease, as vertices of the surface.
    pub vertices: [u32; 2],
    /// The triangles that meet there.
    pub triangles: [u32; 2],
}

/// The sharp edges of a surface.
pub struct SharpEdges {
    /// Edges at which matter is a wedge of less than 180°.
    pub convex: Vec<SharpEdge>,
    /// Edges at which it is one of more.
    pub reflex: Vec<SharpEdge>,
    /// The smooth group of each triangle: triangles joined across edges that are not sharp.
    pub group: Vec<u32>,
    /// Triangles of the same group next to each.
    neighbors: Vec<Vec<u32>>,
    /// Convex creases between two groups, the lower first.
    between: FastMap<[u32; 2], Vec<u32>>,
    /// Groups at each vertex where creases end, branch or turn; nothing at other vertices.
    corner_groups: FastMap<u32, Vec<u32>>,
    /// Convex creases at each corner.
    creases_at: FastMap<u32, Vec<u32>>,
    /// Corners of each group.
    corners_of: FastMap<u32, Vec<u32>>,
}

impl SharpEdges {
    /// Edges at which normals differ by more than `angle` (rad).
    pub fn new(surface: &Surface, angle: f64, watch: &mut Watch) -> Result<Self, BuildError> {
        let adjacent = adjacent(surface, watch)?;
        let count = surface.triangles.len();
        let mut groups = Groups::new(count);
        let (mut convex, mut reflex) = (Vec::new(), Vec::new());
        for (&[t, u], &vertices) in &adjacent {
            let normals = [t, u].map(|i| surface.normals[i as usize]);
            if normals[0].dot(normals[1]) >= angle.cos() {
                groups.join(t, u);
                continue;
            }
            let edge = SharpEdge {
                vertices,
                triangles: [t, u],
            };
            match is_convex(surface, &edge) {
                true => convex.push(edge),
                false => reflex.push(edge),
            }
        }
        let group: Vec<u32> = (0..count as u32).map(|t| groups.find(t)).collect();
        let mut neighbors = vec![Vec::new(); count];
        for &[t, u] in adjacent.keys() {
            if group[t as usize] == group[u as usize] {
                neighbors[t as usize].push(u);
                neighbors[u as usize].push(t);
            }
        }
        let mut between: FastMap<[u32; 2], Vec<u32>> = FastMap::default();
        for (i, edge) in convex.iter().enumerate() {
            let [a, b] = edge.triangles.map(|t| group[t as usize]);
            let both = [a.min(b), a.max(b)];
            between.entry(both).or_default().push(i as u32);
        }
        let mut creases = Self {
            convex,
            reflex,
            group,
            neighbors,
            between,
            corner_groups: FastMap::default(),
            creases_at: FastMap::default(),
            corners_of: FastMap::default(),
        };
        creases.find_corners(surface);
        Ok(creases)
    }

    /// Takes down the vertices where creases end, branch, turn, or meet a reflex edge.
    fn find_corners(&mut self, surface: &Surface) {
        let mut directions: Vec<Vec<Point>> = vec![Vec::new(); surface.vertices.len()];
        for edge in &self.convex {
            let [a, b] = edge.vertices;
            let way = surface.vertices[b as usize] - surface.vertices[a as usize];
            directions[a as usize].push(direction(way));
            directions[b as usize].push(direction(-way));
        }
        let mut at_reflex = vec![false; surface.vertices.len()];
        for v in self.reflex.iter().flat_map(|e| e.vertices) {
            at_reflex[v as usize] = true;
        }
        let is_corner = |v: usize| match directions[v].as_slice() {
            [] => false,
            [a, b] => a.dot(*b) > -STRAIGHT || at_reflex[v],
            _ => true,
        };
        let corner: Vec<bool> = (0..directions.len()).map(is_corner).collect();
        for (i, edge) in self.convex.iter().enumerate() {
            for v in edge.vertices.into_iter().filter(|&v| corner[v as usize]) {
                self.creases_at.entry(v).or_default().push(i as u32);
            }
        }
        for (triangle, &group) in surface.triangles.iter().zip(&self.group) {
            for &v in triangle.iter().filter(|&&v| corner[v as usize]) {
                let groups = self.corner_groups.entry(v).or_default();
                if !groups.contains(&group) {
                    groups.push(group);
                    self.corners_of.entry(group).or_default().push(v);
                }
            }
        }
    }

    /// Number of corners at which a single crease ends.
    pub fn ends_alone(&self) -> usize {
        let at_corners = self.creases_at.values();
        at_corners.filter(|creases| creases.len() == 1).count()
    }

    /// Whether creases end, branch or turn at a vertex.
    pub fn is_corner(&self, vertex: u32) -> bool {
        self.corner_groups.contains_key(&vertex)
    }

    /// Corners at which all of `groups` meet.
    pub fn corners_at<'a>(&'a self, groups: &'a [u32]) -> impl Iterator<Item = u32> + 'a {
        let first = groups.first().and_then(|g| self.corners_of.get(g));
        let all = |v: &u32| groups.iter().all(|g| self.corner_groups[v].contains(g));
        first.into_iter().flatten().copied().filter(all)
    }

    /// Convex creases at a corner.
    pub fn convex_at(&self, corner: u32) -> impl Iterator<Item = &SharpEdge> {
        let at = self.creases_at.get(&corner).map_or(&[][..], |list| list);
        at.iter().map(|&i| &self.convex[i as usize])
    }

    /// Convex creases between two groups.
    pub fn between(&self, a: u32, b: u32) -> &[u32] {
        let both = [a.min(b), a.max(b)];
        self.between.get(&both).map_or(&[], |list| list)
    }

    /// The point nearest to `p` that a walk from `triangle` through its group, always nearer, comes to,
    /// and the triangle of that point.
    pub fn walk(&self, surface: &Surface, triangle: u32, p: Point) -> (Point, u32) {
        let nearest = |t: u32| {
            let q = closest_on_triangle(p, &surface.corners(t as usize));
            ((q - p).length_sq(), q)
        };
        let mut at = triangle;
        let (mut least, mut point) = nearest(at);
        for _ in 0..MOST_STEPS {
            let mut next = None;
            // A walk to triangles that are nearer by rounding only would go in circles.
            let mut limit = least * (1.0 - 1e-12);
            for &t in &self.neighbors[at as usize] {
                let (distance_sq, q) = nearest(t);
                if distance_sq < limit {
                    limit = distance_sq;
                    next = Some((distance_sq, q, t));
                }
            }
            let Some((distance_sq, q, t)) = next else {
                break;
            };
            (least, point, at) = (distance_sq, q, t);
        }
        (point, at)
    }
}

/// Whether the second triangle falls away behind the first.
fn is_convex(surface: &Surface, edge: &SharpEdge) -> bool {
    let [t, u] = edge.triangles.map(|i| i as usize);
    let on_edge = surface.vertices[edge.vertices[0] as usize];
    let heights = surface
        .corners(u)
        .map(|p| surface.normals[t].dot(p - on_edge));
    let farthest = |x: f64, y: f64| if y.abs() > x.abs() { y } else { x };
    heights.into_iter().fold(0.0, farthest) < 0.0
}

/// Pairs of triangles that share an edge or have only needles between them, each with that edge; if a pair shares
/// several, the shortest.
fn adjacent(
    surface: &Surface,
    watch: &mut Watch,
) -> Result<BTreeMap<[u32; 2], [u32; 2]>, BuildError> {
    let count = surface.triangles.len();
    let all: Vec<[u32; 3]> = [&surface.triangles[..], &surface.needles].concat();
    let edges = Edges::new(surface.vertices.len(), &all, watch)?;
    let mut across: FastMap<[u32; 2], [u32; 2]> = FastMap::default();
    for (edge, uses) in edges.iter() {
        if let [a, b] = uses {
            across.insert(edge, [a.triangle() as u32, b.triangle() as u32]);
        }
    }
    let length_sq = |e: [u32; 2]| {
        let [a, b] = e.map(|v| surface.vertices[v as usize]);
        (a - b).length_sq()
    };
    let mut pairs: BTreeMap<[u32; 2], [u32; 2]> = BTreeMap::new();
    for (i, triangle) in surface.triangles.iter().enumerate() {
        watch.every(i)?;
        let start = i as u32;
        let mut waiting: Vec<(u32, [u32; 2], [u32; 2], usize)> =
            sides(triangle).map(|e| (start, e, e, 0)).into();
        while let Some((from, edge, shortest, crossed)) = waiting.pop() {
            let Some(&[a, b]) = across.get(&edge).filter(|_| crossed <= MOST_NEEDLES) else {
                continue;
            };
            let other = if a == from { b } else { a };
            if (other as usize) < count {
                if other != start {
                    let pair = [start.min(other), start.max(other)];
                    let known = pairs.entry(pair).or_insert(shortest);
                    if length_sq(shortest) < length_sq(*known) {
                        *known = shortest;
                    }
                }
                continue;
            }
            // A needle has one long side, which lies on the two others.
            let mut others = sides(&all[other as usize]);
            others.sort_by(|x, y| length_sq(*y).total_cmp(&length_sq(*x)));
            let onward = match others[0] == edge {
                true => &others[1..],
                false => &others[..1],
            };
            for &next in onward {
                let nearer = length_sq(next) < length_sq(shortest);
                let shortest = if nearer { next } else { shortest };
                waiting.push((other, next, shortest, crossed + 1));
            }
        }
    }
    Ok(pairs)
}
