//! The checked medial mesh: spheres, edges and faces, with what every query needs precomputed.
//! Source: paper §3 (medial mesh, a non-manifold triangle mesh of medial spheres).

use super::check::check;
use super::mass;
use super::primitive::{MedialPrimitive, MedialSphere};
use super::shell::Shell;
use super::simplex::{primitive_of, primitives_of, sorted};
use super::thickness::{self, Thicknesses};
use super::tree::SphereTree;
use crate::error::MeshError;
use crate::math::{Real, Vector};
use parry3d::bounding_volume::Aabb;
use parry3d::mass_properties::MassProperties;
use parry3d::partitioning::{Bvh, BvhBuildStrategy};
use std::collections::HashSet;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

pub use super::simplex::Simplex;

/// A concave solid: spheres joined by medial cones and slabs, in the body's frame. Lengths are in
/// the user's unit (metres in rapier).
///
/// Cloning is cheap: clones share the data. Each clone keeps the instance id of its original;
/// [`MedialMesh::instance`] gives one with an id of its own.
#[derive(Clone, Debug)]
pub struct MedialMesh {
    data: Arc<MedialData>,
    id: u64,
}

#[derive(Debug)]
struct MedialData {
    parts: Parts,
    aabb: Aabb,
    solid_mass: OnceLock<MassProperties>,
    boxes: OnceLock<Bvh>,
    shell: OnceLock<Arc<Shell>>,
    thicknesses: OnceLock<Thicknesses>,
}

/// What a mesh is made of and what was computed from it ahead of all queries.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    pub(super) spheres: Vec<MedialSphere>,
    pub(super) edges: Vec<[u32; 2]>,
    pub(super) faces: Vec<[u32; 3]>,
    /// Spheres of each primitive: slabs, then cones, then lone spheres. Unused entries repeat the
    /// last sphere.
    pub(super) primitives: Vec<Simplex>,
    pub(super) tree: SphereTree,
    pub(super) thickness: Real,
    /// Mass properties measured on the source, at unit density.
    pub(super) source_mass: Option<MassProperties>,
}

static NEXT_ID: AtomicU64 = AtomicU64::new(1);

impl MedialMesh {
    /// Checks and takes a medial mesh. Centres and radii are in the user's unit, in the body's
    /// frame; an edge or face names spheres by index. Edges of faces may be listed or not: missing
    /// ones are derived; doubles are dropped.
    ///
    /// Fails on the first item that is not finite, farther than 1e18 from the origin, negative, out of
    /// range or degenerate, and names it.
    pub fn new(
        spheres: Vec<MedialSphere>,
        edges: Vec<[u32; 2]>,
        faces: Vec<[u32; 3]>,
    ) -> Result<Self, MeshError> {
        check(&spheres, &edges, &faces)?;
        let mut seen_faces = HashSet::new();
        let faces: Vec<_> = faces
            .into_iter()
            .filter(|f| {
                let mut key = *f;
                key.sort_unstable();
                seen_faces.insert(key)
            })
            .collect();
        let mut seen_edges = HashSet::new();
        let of_faces = faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let edges: Vec<_> = edges
            .iter()
            .copied()
            .chain(of_faces)
            .map(sorted)
            .filter(|e| seen_edges.insert(*e))
            .collect();
        let primitives = primitives_of(spheres.len(), &edges, &faces);
        let tree = SphereTree::new(&spheres, &primitives);
        let thickness = thickness::typical(&spheres, &primitives);
        let parts = Parts {
            spheres,
            edges,
            faces,
            primitives,
            tree,
            thickness,
            source_mass: None,
        };
        Ok(Self::from_parts(parts, OnceLock::new()))
    }

    /// Takes parts that fit each other, and the solid's mass properties if they are known.
    pub(super) fn from_parts(parts: Parts, solid_mass: OnceLock<MassProperties>) -> Self {
        let aabb = parts.spheres.iter().fold(Aabb::new_invalid(), |a, s| {
            let r = Vector::splat(s.radius);
            Aabb::new(a.mins.min(s.center - r), a.maxs.max(s.center + r))
        });
        let data = MedialData {
            parts,
            aabb,
            solid_mass,
            boxes: OnceLock::new(),
            shell: OnceLock::new(),
            thicknesses: OnceLock::new(),
        };
        Self {
            data: Arc::new(data),
            id: NEXT_ID.fetch_add(1, Ordering::Relaxed),
        }
    }

    pub(super) fn parts(&self) -> &Parts {
        &self.data.parts
    }

    /// The same mesh with mass properties measured on its source (unit density) in place of those
    /// of the solid.
    pub fn with_mass_properties(self, unit_density: MassProperties) -> Self {
        let parts = Parts {
            source_mass: Some(unit_density),
            ..self.data.parts.clone()
        };
        let id = self.id;
        Self {
            id,
            ..Self::from_parts(parts, self.data.solid_mass.clone())
        }
    }

    /// The medial spheres.
    pub fn spheres(&self) -> &[MedialSphere] {
        &self.data.parts.spheres
    }

    /// All edges, each once, smaller index first; those of faces among them.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.data.parts.edges
    }

    /// The faces: one medial slab each.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.data.parts.faces
    }

    /// How many convex volumes there are: slabs, cones that belong to no slab, lone spheres.
    pub fn primitive_count(&self) -> usize {
        self.data.parts.primitives.len()
    }

    /// One of the volumes, in the body's frame. Slabs come first (one per face, in order), then
    /// cones, then lone spheres. Panics if `index` is not below [`Self::primitive_count`].
    pub fn primitive(&self, index: usize) -> MedialPrimitive {
        primitive_of(&self.data.parts.spheres, &self.data.parts.primitives[index])
    }

    /// All volumes, in the order of [`Self::primitive`].
    pub fn primitives(&self) -> impl ExactSizeIterator<Item = MedialPrimitive> + '_ {
        (0..self.primitive_count()).map(|i| self.primitive(i))
    }

    /// Indices and ownership of each primitive, in the order of [`Self::primitive`].
    pub fn simplices(&self) -> &[Simplex] {
        &self.data.parts.primitives
    }

    /// Bounding spheres over the primitives, in the body's frame.
    pub fn tree(&self) -> &SphereTree {
        &self.data.parts.tree
    }

    /// parry's tree of boxes over the primitives, in the body's frame. Built at the first call: 1 ms
    /// for 5,000.
    pub fn bvh(&self) -> &Bvh {
        self.data.boxes.get_or_init(|| {
            let boxes: Vec<Aabb> = self.primitives().map(|p| p.aabb()).collect();
            Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes)
        })
    }

    /// A few balls that hold it. Made at the first call.
    pub(crate) fn shell(&self) -> &Arc<Shell> {
        let shell = &self.data.shell;
        shell.get_or_init(|| Arc::new(Shell::of_mesh(self)))
    }

    /// Box of the solid, in the body's frame.
    pub fn aabb(&self) -> Aabb {
        self.data.aabb
    }

    /// A typical small radius, a length: the 5th percentile of the local radius, weighted by the
    /// area of the medial mesh (a cone counts as a strip as wide as itself). Simplified tips have
    /// radius near 0, so the minimum would call every motion fast.
    pub fn thickness(&self) -> Real {
        self.data.parts.thickness
    }

    /// How thin it is in each place. Computed at the first call.
    pub(crate) fn thicknesses(&self) -> &Thicknesses {
        let Parts {
            spheres,
            primitives,
            tree,
            ..
        } = &self.data.parts;
        let thicknesses = &self.data.thicknesses;
        thicknesses.get_or_init(|| Thicknesses::new(spheres, primitives, tree))
    }

    /// Mass properties in the body's frame: of the source mesh when built from one, else of the
    /// solid with overlaps counted once, measured at the first call that is for any density but 0.
    pub fn mass_properties(&self, density: Real) -> MassProperties {
        if density == 0.0 {
            return MassProperties::default();
        }
        let mut scaled = *self.unit_mass_properties();
        scaled.set_mass(scaled.mass() * density, true);
        scaled
    }

    /// The same at unit density, as they were measured.
    pub(crate) fn unit_mass_properties(&self) -> &MassProperties {
        let source = self.data.parts.source_mass.as_ref();
        source.unwrap_or_else(|| self.solid_mass_properties())
    }

    /// Volume of the solid with overlaps counted once, in cubed units of length, whatever the mass
    /// properties were measured on. Computed at the first call.
    pub fn volume(&self) -> Real {
        self.solid_mass_properties().mass()
    }

    pub(super) fn solid_mass_properties(&self) -> &MassProperties {
        let solid = &self.data.solid_mass;
        solid.get_or_init(|| mass::solid_mass_properties(self))
    }

    /// What tells colliders apart in caches. Clones share it.
    pub fn instance_id(&self) -> u64 {
        self.id
    }

    /// How many clones share the data, this one included.
    #[cfg(feature = "gpu")]
    pub(crate) fn owners(&self) -> usize {
        Arc::strong_count(&self.data)
    }

    /// The same data under an instance id of its own.
    pub fn instance(&self) -> Self {
        Self {
            data: Arc::clone(&self.data),
            id: NEXT_ID.fetch_add(1, Ordering::Relaxed),
        }
    }

    /// Whether both share the same data, whatever their instance ids.
    pub fn shares_data(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.data, &other.data)
    }
}
