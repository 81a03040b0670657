//! The medial mesh under construction: double precision, in the builder's frame, no invariants
//! beyond indices in range.

use crate::error::MeshError;
use crate::math::fast_hash::FastSet;
use crate::math::lane::Vec3;
pub use crate::math::sphere::Ball;
use crate::math::{Real, Vector};
use crate::medial::simplex::{sides, sorted};
use crate::medial::{MedialMesh, MedialSphere};
use crate::meshing::surface::checked_surface::BuilderFrame;
use crate::meshing::watch::bytes_of;

/// Balls joined by edges and faces.
#[derive(Clone, Debug, Default)]
pub struct Draft {
    /// The balls.
    pub balls: Vec<Ball>,
    /// Pairs of balls; edges of faces may be listed or not.
    pub edges: Vec<[u32; 2]>,
    /// Triples of balls.
    pub faces: Vec<[u32; 3]>,
}

/// Balls of a primitive: all different for a slab, the last two equal for a cone, all equal for a
/// lone ball.
pub type Corners = [u32; 3];

/// Signed distance of a point to a primitive, and the weights of the ball that gives it.
#[derive(Clone, Copy, Debug)]
pub struct Signed {
    /// Negative inside, where it is minus the depth within the deepest ball.
    pub distance: f64,
    /// Weights of the primitive's three corners; sum 1.
    pub weights: [f64; 3],
}

impl Draft {
    /// The volumes: slabs, then cones that belong to no slab, then lone balls.
    pub fn primitives(&self) -> Vec<Corners> {
        let mut joined = FastSet::default();
        let mut used = vec![false; self.balls.len()];
        let mut primitives = self.faces.clone();
        joined.extend(self.faces.iter().flat_map(sides));
        for &[a, b] in &self.edges {
            if joined.insert(sorted([a, b])) {
                primitives.push([a, b, b]);
            }
        }
        for p in &primitives {
            p.iter().for_each(|&v| used[v as usize] = true);
        }
        let lone = (0..self.balls.len() as u32).filter(|&v| !used[v as usize]);
        primitives.extend(lone.map(|v| [v; 3]));
        primitives
    }

    /// Bytes of its arrays.
    pub fn bytes(&self) -> usize {
        bytes_of(&self.balls) + bytes_of(&self.edges) + bytes_of(&self.faces)
    }

    /// Joins two drafts in one.
    pub fn and(mut self, other: Self) -> Self {
        let first = self.balls.len() as u32;
        self.balls.extend(other.balls);
        let edges = other.edges.into_iter().map(|e| e.map(|v| v + first));
        self.edges.extend(edges);
        let faces = other.faces.into_iter().map(|f| f.map(|v| v + first));
        self.faces.extend(faces);
        self
    }

    /// The balls of a primitive.
    #[inline]
    pub fn balls_of(&self, corners: Corners) -> [Ball; 3] {
        corners.map(|v| self.balls[v as usize])
    }

    /// The medial mesh in the user's frame.
    ///
    /// Rounding to `f32` moves a centre; its radius grows by as much and is rounded up, so that the
    /// solid still covers what it covered: the ball of weights α moves by at most Σ αᵢ δᵢ and grows
    /// by at least that.
    pub fn to_medial_mesh(&self, frame: &BuilderFrame) -> Result<MedialMesh, MeshError> {
        let spheres = self
            .balls
            .iter()
            .map(|ball| {
                let exact = ball.center * frame.scale + frame.center;
                let center: Vector = exact.to_vector();
                let moved = (Vec3::from_vector(center) - exact).length();
                let radius = ball.radius * frame.scale + moved;
                MedialSphere::new(center, round_up(radius))
            })
            .collect();
        MedialMesh::new(spheres, self.edges.clone(), self.faces.clone())
    }

    /// The draft of a medial mesh, brought into `frame`.
    pub fn from_medial_mesh(mesh: &MedialMesh, frame: &BuilderFrame) -> Self {
        Self {
            balls: mesh
                .spheres()
                .iter()
                .map(|s| Ball {
                    center: frame.enter(s.center),
                    radius: f64::from(s.radius) / frame.scale,
                })
                .collect(),
            edges: mesh.edges().to_vec(),
            faces: mesh.faces().to_vec(),
        }
    }
}

/// The smallest `f32` that is not below `value`.
fn round_up(value: f64) -> Real {
    let rounded = value as Real;
    if f64::from(rounded) < value {
        rounded.next_up()
    } else {
        rounded
    }
}
