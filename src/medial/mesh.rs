//! [`MedialMesh`]: checked spheres, edges and faces, with the trees that every query needs.
//! Source: paper §3 (medial mesh, a non-manifold triangle mesh of medial spheres).

use super::check::check;
use super::cone_mass;
use super::convex_pieces::{ConvexPieces, connected};
use super::exact::balls;
use super::leaf_order::LeafOrder;
use super::mass;
use super::polyhedron_mass;
use super::primitive::MedialPrimitive;
use super::proxy_hull::ProxyHull;
use super::rectangle::SweptRectangles;
use super::simplex::{Simplex, primitive_of, primitives_of, sorted};
use super::sphere::MedialSphere;
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

/// A concave solid made of spheres that are joined by medial cones and slabs: the shape of a medial
/// collider. Lengths are in the user's unit (metres in rapier), in the body's frame.
///
/// [`MedialMesh::from_trimesh`] builds one from triangles, [`MedialMesh::load_asset`] loads one, and
/// [`MedialMesh::torus`] and other constructors make simple solids. Make a collider of it with
/// [`ColliderBuilder::medial_mesh`](crate::MedialColliderBuilder::medial_mesh). Give each collider a clone: clones
/// share the data, so cloning is cheap.
#[derive(Clone, Debug)]
pub struct MedialMesh {
    data: Arc<MedialData>,
    id: u64,
    /// Whether parry may find contacts of its primitives with normals that point into their convex piece.
    takes_any_normals: bool,
}

#[derive(Debug)]
struct MedialData {
    parts: MeshData,
    aabb: Aabb,
    solid_mass: OnceLock<MassProperties>,
    boxes: OnceLock<Bvh>,
    proxy: OnceLock<Arc<ProxyHull>>,
    rectangles: OnceLock<SweptRectangles>,
    thicknesses: OnceLock<Thicknesses>,
    leaf_order: OnceLock<LeafOrder>,
    convex_pieces: OnceLock<ConvexPieces>,
}

/// Data of a mesh, and what was computed from it ahead of all queries.
#[derive(Clone, Debug)]
pub(super) struct MeshData {
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
    /// Whether each connected part is known to be convex ([`ConvexPieces`]). Each then has a node of the tree.
    pub(super) is_of_convex_pieces: bool,
}

static NEXT_ID: AtomicU64 = AtomicU64::new(1);

impl MedialMesh {
    /// A medial mesh from its parts. Each edge joins two spheres by a medial cone, each face joins three by a medial
    /// slab. Edges and faces name their spheres by index. A sphere without an edge stands alone. The edges of a face
    /// are added if they are not listed, and repeated edges and faces are dropped.
    ///
    /// # Errors
    /// [`MeshError`] names the first item that is wrong: no spheres at all, a number that is not finite,
    /// a sphere that reaches farther than 1e18 from the origin, a negative radius, an index beyond the
    /// spheres, the same sphere twice in an edge or face, or a mesh that is a single point.
    ///
    /// ```
    /// use rapier3d_medial::{MedialMesh, MedialSphere, math::Vector};
    /// let sphere = |x, radius| MedialSphere::new(Vector::new(x, 0.0, 0.0), radius);
    /// // A club: one cone from a thick end to a thin one.
    /// let club = MedialMesh::new(vec![sphere(0.0, 0.2), sphere(1.0, 0.05)], vec![[0, 1]], vec![])?;
    /// assert_eq!(club.primitive_count(), 1);
    /// # Ok::<(), rapier3d_medial::MeshError>(())
    /// ```
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
        let parts = MeshData {
            spheres,
            edges,
            faces,
            primitives,
            tree,
            thickness,
            source_mass: None,
            is_of_convex_pieces: false,
        };
        Ok(Self::from_parts(parts, OnceLock::new()))
    }

    /// The mesh, marked as a union of convex pieces if `is_of_them`, each with a node of its own in the tree.
    pub(crate) fn of_convex_pieces(self, is_of_them: bool) -> Self {
        if !is_of_them {
            return self;
        }
        let mut parts = self.data.parts.clone();
        let groups = connected(parts.spheres.len(), &parts.primitives);
        parts.tree = SphereTree::of_groups(&parts.spheres, &parts.primitives, &groups);
        parts.is_of_convex_pieces = true;
        Self {
            id: self.id,
            takes_any_normals: false,
            ..Self::from_parts(parts, self.data.solid_mass.clone())
        }
    }

    /// Takes parts that fit each other, and the solid's mass properties if they are known.
    pub(super) fn from_parts(parts: MeshData, solid_mass: OnceLock<MassProperties>) -> Self {
        let aabb = parts.spheres.iter().fold(Aabb::new_invalid(), |a, s| {
            let r = Vector::splat(s.radius);
            Aabb::new(a.mins.min(s.center - r), a.maxs.max(s.center + r))
        });
        let data = MedialData {
            parts,
            aabb,
            solid_mass,
            boxes: OnceLock::new(),
            proxy: OnceLock::new(),
            rectangles: OnceLock::new(),
            thicknesses: OnceLock::new(),
            leaf_order: OnceLock::new(),
            convex_pieces: OnceLock::new(),
        };
        Self {
            data: Arc::new(data),
            id: NEXT_ID.fetch_add(1, Ordering::Relaxed),
            takes_any_normals: false,
        }
    }

    pub(super) fn parts(&self) -> &MeshData {
        &self.data.parts
    }

    /// Returns this mesh with other mass properties (at density 1, in the body's frame), for instance those of the
    /// triangle mesh that it stands for; they are not checked. [`Self::from_trimesh`] sets those of its triangles
    /// itself. The data are copied: keep the result, and clone that.
    pub fn with_mass_properties(self, unit_density: MassProperties) -> Self {
        let parts = MeshData {
            source_mass: Some(unit_density),
            ..self.data.parts.clone()
        };
        let id = self.id;
        Self {
            id,
            takes_any_normals: false,
            ..Self::from_parts(parts, self.data.solid_mass.clone())
        }
    }

    /// The medial spheres.
    pub fn spheres(&self) -> &[MedialSphere] {
        &self.data.parts.spheres
    }

    /// All edges, those of faces included. Each is listed once, as the indices of its two spheres, the smaller index
    /// first.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.data.parts.edges
    }

    /// The faces, as indices of three spheres. Each is one medial slab.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.data.parts.faces
    }

    /// Number of primitives. These are the convex parts of the solid: slabs, cones that belong to no slab, and lone
    /// spheres.
    pub fn primitive_count(&self) -> usize {
        self.data.parts.primitives.len()
    }

    /// One primitive, in the body's frame. Slabs come first (one for each face, in order), then cones,
    /// then lone spheres.
    ///
    /// # Panics
    /// If `index` is not below [`Self::primitive_count`].
    pub fn primitive(&self, index: usize) -> MedialPrimitive {
        primitive_of(&self.data.parts.spheres, &self.data.parts.primitives[index])
    }

    /// All primitives, in the order of [`Self::primitive`].
    pub fn primitives(&self) -> impl ExactSizeIterator<Item = MedialPrimitive> + '_ {
        (0..self.primitive_count()).map(|i| self.primitive(i))
    }

    /// For each primitive, in the order of [`Self::primitive`]: the indices of its spheres, and the edges and spheres
    /// that it tests for its neighbours.
    pub fn simplices(&self) -> &[Simplex] {
        &self.data.parts.primitives
    }

    /// The tree of bounding spheres over the primitives, in the body's frame. This crate's queries search it.
    pub fn tree(&self) -> &SphereTree {
        &self.data.parts.tree
    }

    /// The tree of boxes over the primitives, in the body's frame. parry's own queries search it. It is built at the
    /// first call, in 1 ms for 5,000 primitives.
    pub fn bvh(&self) -> &Bvh {
        self.data.boxes.get_or_init(|| {
            let boxes: Vec<Aabb> = self.primitives().map(|p| p.aabb()).collect();
            Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes)
        })
    }

    /// A few balls that hold it. Made at the first call.
    pub(crate) fn proxy_hull(&self) -> &Arc<ProxyHull> {
        let proxy = &self.data.proxy;
        let of_mesh = || ProxyHull::of_mesh(self.spheres(), self.simplices(), self.tree());
        proxy.get_or_init(|| Arc::new(of_mesh()))
    }

    /// Swept rectangles round what is below the inner nodes of its tree. Made at the first call.
    pub(crate) fn rectangles(&self) -> &SweptRectangles {
        let MeshData {
            spheres,
            primitives,
            tree,
            ..
        } = &self.data.parts;
        let rectangles = &self.data.rectangles;
        rectangles.get_or_init(|| SweptRectangles::new(spheres, primitives, tree))
    }

    /// Order of the primitives in its tree. Made at the first call.
    pub(crate) fn leaf_order(&self) -> &LeafOrder {
        let leaf_order = &self.data.leaf_order;
        leaf_order.get_or_init(|| LeafOrder::new(self.tree()))
    }

    /// Convex pieces of several primitives, as far as they are known. Found at the first call.
    pub(crate) fn convex_pieces(&self) -> &ConvexPieces {
        let parts = &self.data.parts;
        self.data.convex_pieces.get_or_init(|| {
            if parts.is_of_convex_pieces {
                let thicknesses = &self.thicknesses().primitives;
                ConvexPieces::new(&parts.spheres, &parts.primitives, thicknesses, &parts.tree)
            } else {
                ConvexPieces::default()
            }
        })
    }

    /// Bounding box of the solid, in the body's frame.
    pub fn aabb(&self) -> Aabb {
        self.data.aabb
    }

    /// How thin the solid typically is, as a radius (half of what a caliper shows) in the mesh's
    /// unit of length: the radius that is exceeded on 95 % of the medial mesh's area, where a cone
    /// counts as a strip as wide as the cone. A blunt tip, as at the edges of a box, counts as
    /// thick as the part that it ends. The smallest radius would not do instead: it is near 0 at
    /// the tips of most meshes, so every motion would count as fast.
    pub fn thickness(&self) -> Real {
        self.data.parts.thickness
    }

    /// How thin it is in each place. Computed at the first call.
    pub(crate) fn thicknesses(&self) -> &Thicknesses {
        let parts = &self.data.parts;
        self.data.thicknesses.get_or_init(|| {
            let groups = || connected(parts.spheres.len(), &parts.primitives);
            let groups = parts.is_of_convex_pieces.then(groups).unwrap_or_default();
            Thicknesses::new(&parts.spheres, &parts.primitives, &parts.tree, &groups)
        })
    }

    /// Mass, centre of mass and inertia at a density (mass per cubed unit of length), in the body's frame. If the
    /// medial mesh was built from a triangle mesh, they are those of the triangle mesh; otherwise they are those of
    /// the solid, with overlaps of primitives counted once. Those of the solid are measured when they are first asked
    /// for, here or by the first contact, in 5 ms for two cones and 80 ms for 1,200. For a ball, a single cone and a
    /// convex body with flat faces they are exact, and need no measuring. Density 0 gives no mass,
    /// and measures nothing. Sheets have no volume, and no mass.
    ///
    /// ```
    /// use rapier3d_medial::MedialMesh;
    /// let ring = MedialMesh::torus(0.5, 0.1, 24)?;
    /// let steel = ring.mass_properties(7800.0).mass(); // kilograms, if lengths are in metres
    /// assert!((730.0..780.0).contains(&steel));
    /// # Ok::<(), rapier3d_medial::MeshError>(())
    /// ```
    pub fn mass_properties(&self, density: Real) -> MassProperties {
        if density == 0.0 {
            return MassProperties::default();
        }
        let mut scaled = *self.unit_mass_properties();
        scaled.set_mass(scaled.mass() * density, true);
        scaled
    }

    /// Mass properties at unit density, as they were measured.
    pub(crate) fn unit_mass_properties(&self) -> &MassProperties {
        let source = self.data.parts.source_mass.as_ref();
        source.unwrap_or_else(|| self.solid_mass_properties())
    }

    /// Volume of the solid in cubed units of length, with overlaps of primitives counted once. It is the volume of
    /// the medial mesh, even if the mass properties are those of a triangle mesh. It is computed at the first call.
    pub fn volume(&self) -> Real {
        self.solid_mass_properties().mass()
    }

    pub(super) fn solid_mass_properties(&self) -> &MassProperties {
        let solid = &self.data.solid_mass;
        solid.get_or_init(|| {
            let one = self.convex_pieces().of_node(0);
            if let Some(moments) = one.and_then(polyhedron_mass::moments) {
                return mass::mass_properties(&moments);
            }
            let primitives: Vec<_> = self.primitives().map(|p| balls(p.as_slab())).collect();
            if let [one] = primitives[..]
                && let Some(moments) = cone_mass::moments(&one)
            {
                return mass::mass_properties(&moments);
            }
            mass::solid_mass_properties(&primitives)
        })
    }

    /// The number by which [`crate::MedialPipeline`] tells colliders apart. Clones have the same number; the pipeline
    /// gives each collider a number of its own.
    pub fn instance_id(&self) -> u64 {
        self.id
    }

    /// How many clones share the data, this one included.
    #[cfg(feature = "gpu")]
    pub(crate) fn owners(&self) -> usize {
        Arc::strong_count(&self.data)
    }

    /// A clone with an [`Self::instance_id`] of its own.
    pub fn instance(&self) -> Self {
        Self {
            data: Arc::clone(&self.data),
            id: NEXT_ID.fetch_add(1, Ordering::Relaxed),
            takes_any_normals: false,
        }
    }

    /// A clone whose contacts in parry have any normal (see `parry/corrections/outward_normals.rs`).
    pub(crate) fn with_any_normals(&self) -> Self {
        Self {
            takes_any_normals: true,
            ..self.clone()
        }
    }

    pub(crate) fn takes_any_normals(&self) -> bool {
        self.takes_any_normals
    }

    /// Whether both are clones of one mesh, whatever their instance ids.
    pub fn shares_data(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.data, &other.data)
    }
}
