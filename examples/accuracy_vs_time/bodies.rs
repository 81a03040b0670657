//! What a body collides as: medial meshes of several sizes, and what rapier's users take today.

use crate::MEMORY;
use crate::common::decimate::decimated;
use crate::common::mesh::Mesh;
use crate::common::shape_error::shape_error;
use crate::common::surface_error::surface_error;
use crate::crash::WIDTH;
use rapier3d::parry::query::{NonlinearRigidMotion, cast_shapes_nonlinear};
use rapier3d::parry::shape::{Compound, Shape, SharedShape};
use rapier3d::parry::transformation::vhacd::VHACDParameters;
use rapier3d::parry::transformation::voxelization::FillMode;
use rapier3d::prelude::{ColliderBuilder, Real};
use rapier3d_medial::pair::first_contact::{Counts, first_contact_counted};
use rapier3d_medial::{
    BuildError, BuildOptions, MedialColliderBuilder, MedialMesh, Quality, ToiOptions, ToiStatus,
};
use std::time::Instant;

/// Tolerance of the medial queries, in metres: that of the true contacts.
const TOLERANCE: Real = 4.0e-5;

/// Primitives that are enough for three balls melted into one.
const BLOB: usize = 100;

/// Two bodies in one representation.
pub struct Bodies {
    /// As the page names it.
    pub name: String,
    /// Primitives, parts, triangles or voxels of the creature.
    pub parts: usize,
    /// Largest distance between the shapes and their sources, both bodies together: a contact may
    /// come that much nearer or further away. The builder's bound; of the peers, from sampled points.
    pub shape_error: f64,
    /// Kilobytes that the creature keeps allocated.
    pub kilobytes: f64,
    /// Only every such motion is asked: some answers take a second each.
    pub every: usize,
    /// Spheres of the creature's medial mesh, 0 of other shapes.
    pub spheres: usize,
    /// Seconds to build both.
    pub seconds: f64,
    shapes: Shapes,
}

/// A medial mesh, the bound of its distance from its source, in metres, and the seconds it took.
struct Built {
    mesh: MedialMesh,
    error: f64,
    seconds: f64,
}

impl Built {
    fn new(source: &Mesh, primitives: usize, quality: Quality) -> Result<Self, BuildError> {
        let start = Instant::now();
        let mut options = BuildOptions::default();
        options.primitives = Some(primitives);
        options.quality = quality;
        let built = MedialMesh::from_trimesh(&source.vertices, &source.indices, &options);
        let (mesh, report) = built?;
        let h = &report.hausdorff;
        Ok(Self {
            mesh,
            error: (h.surface_to_envelope.max(h.envelope_to_surface) + h.sampling).into(),
            seconds: start.elapsed().as_secs_f64(),
        })
    }
}

enum Shapes {
    Medial([MedialMesh; 2]),
    Parry([SharedShape; 2]),
}

impl Bodies {
    /// Medial meshes: the creature's with so many primitives, the blob's with that at most.
    pub fn medial(
        meshes: &[Mesh; 2],
        sizes: &[usize],
        quality: Quality,
        progress: &dyn Fn(),
    ) -> Result<Vec<Self>, BuildError> {
        let mut blob: Option<(usize, Built)> = None;
        let mut all = Vec::new();
        for &size in sizes {
            let wanted = size.min(BLOB);
            let blob = match &mut blob {
                Some((count, built)) if *count == wanted => built,
                other => {
                    &mut other
                        .insert((wanted, Built::new(&meshes[1], wanted, quality)?))
                        .1
                }
            };
            let (creature, bytes) = kept(|| Built::new(&meshes[0], size, quality));
            let creature = creature?;
            all.push(Self {
                name: format!("medial mesh, {size}"),
                parts: creature.mesh.primitive_count(),
                spheres: creature.mesh.spheres().len(),
                shape_error: creature.error + blob.error,
                kilobytes: bytes as f64 / 1.0e3,
                every: 1,
                seconds: creature.seconds + blob.seconds,
                shapes: Shapes::Medial([creature.mesh, blob.mesh.clone()]),
            });
            progress();
        }
        Ok(all)
    }

    /// Shapes of parry's, made by `build`.
    fn parry(name: &str, meshes: &[Mesh; 2], build: impl Fn(&Mesh) -> SharedShape) -> Self {
        let start = Instant::now();
        let (creature, bytes) = kept(|| build(&meshes[0]));
        let shapes = [creature, build(&meshes[1])];
        Self {
            name: name.into(),
            seconds: start.elapsed().as_secs_f64(),
            parts: parts(&*shapes[0]),
            shape_error: [0, 1]
                .map(|k| shape_error(&*shapes[k], &meshes[k]))
                .iter()
                .sum(),
            kilobytes: bytes as f64 / 1.0e3,
            spheres: 0,
            every: 1,
            shapes: Shapes::Parry(shapes),
        }
    }

    /// The peers: hull, convex decompositions, and, where there is time, triangles, of the source and
    /// of one drawn together to so many `vertices`, and voxels.
    pub fn peers(meshes: &[Mesh; 2], vertices: usize, quick: bool) -> Vec<Self> {
        let default = VHACDParameters::default();
        let decomposition = |resolution, concavity| {
            move |m: &Mesh| {
                let parameters = VHACDParameters {
                    resolution,
                    concavity,
                    ..default
                };
                SharedShape::convex_decomposition_with_params(&m.vertices, &m.indices, &parameters)
            }
        };
        let voxels = |m: &Mesh| {
            let (low, high) = m.bounds();
            let fill = FillMode::FloodFill {
                detect_cavities: false,
            };
            let size = (high - low).max_element() / 24.0;
            SharedShape::voxelized_mesh(&m.vertices, &m.indices, size, fill)
        };
        let mut peers = vec![
            Self::parry("convex hull", meshes, |m| {
                SharedShape::convex_hull(&m.vertices).expect("a body has a hull")
            }),
            Self::parry(
                "VHACD, default",
                meshes,
                decomposition(default.resolution, default.concavity),
            ),
        ];
        if quick {
            return peers;
        }
        let fewer = format!("triangle mesh, {vertices} vertices");
        peers.extend([
            Self::parry("VHACD, 128 / 0.001", meshes, decomposition(128, 0.001)),
            Self::parry("triangle mesh", meshes, |m| SharedShape::new(m.to_parry())),
            Self::parry(&fewer, meshes, |m| {
                SharedShape::new(decimated(m, vertices).to_parry())
            }),
            Self::parry("voxels, 24 along", meshes, voxels),
        ]);
        for slow in &mut peers[3..] {
            slow.every = 100;
        }
        peers
    }

    /// First contact of medial meshes over one second, and the work it took; `None` for others.
    pub fn counted(&self, motions: [&NonlinearRigidMotion; 2]) -> Option<(Option<f64>, Counts)> {
        let Shapes::Medial([a, b]) = &self.shapes else {
            return None;
        };
        let mut options = ToiOptions::default();
        options.tolerance = TOLERANCE;
        options.time_tolerance = 1.0e-6;
        let (toi, counts) = first_contact_counted(a, motions[0], b, motions[1], 1.0, &options);
        let hit = toi.status != ToiStatus::Separated;
        Some((hit.then(|| toi.upper.into()), counts))
    }

    /// Largest distance from the creature's envelope to its source, at sampled points; not a number
    /// for other shapes.
    pub fn bloat(&self, source: &Mesh, points: usize) -> f64 {
        let Shapes::Medial([creature, _]) = &self.shapes else {
            return f64::NAN;
        };
        let spacing = WIDTH as Real / 150.0;
        let error = surface_error(creature, source, spacing, points);
        error.map_or(f64::NAN, |e| e.envelope_to_surface.into())
    }

    /// Whether they are medial meshes.
    pub fn is_medial(&self) -> bool {
        matches!(self.shapes, Shapes::Medial(_))
    }

    /// The creature as a collider.
    pub fn collider(&self) -> ColliderBuilder {
        match &self.shapes {
            Shapes::Medial([creature, _]) => ColliderBuilder::medial_mesh(creature.instance()),
            Shapes::Parry([creature, _]) => ColliderBuilder::new(creature.clone()),
        }
    }

    /// First contact over one second; `None` where the answer is that there is none.
    pub fn first_contact(&self, motions: [&NonlinearRigidMotion; 2]) -> Option<f64> {
        match &self.shapes {
            Shapes::Medial(_) => self.counted(motions)?.0,
            Shapes::Parry([a, b]) => {
                let hit = cast_shapes_nonlinear(motions[0], &**a, motions[1], &**b, 0.0, 1.0, true);
                hit.ok().flatten().map(|hit| hit.time_of_impact.into())
            }
        }
    }
}

/// What is built, and the bytes that it keeps.
fn kept<T>(build: impl FnOnce() -> T) -> (T, usize) {
    let before = MEMORY.current_usage();
    let built = build();
    (built, MEMORY.current_usage().saturating_sub(before))
}

fn parts(shape: &dyn Shape) -> usize {
    if let Some(compound) = shape.as_shape::<Compound>() {
        compound.shapes().len()
    } else if let Some(triangles) = shape.as_trimesh() {
        triangles.indices().len()
    } else if let Some(voxels) = shape.as_voxels() {
        voxels.voxels().filter(|v| !v.state.is_empty()).count()
    } else {
        1
    }
}
