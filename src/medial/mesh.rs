//! The checked medial mesh: spheres, edges and faces, with what every query needs precomputed.
//! Source: paper §3 (medial mesh, a non-manifold triangle mesh of medial spheres).

use super::mass;
use super::primitive::{MedialPrimitive, MedialSphere};
use super::tree::SphereTree;
use crate::error::MeshError;
use crate::math::{Real, Vector};
use parry3d::bounding_volume::Aabb;
use parry3d::mass_properties::MassProperties;
use parry3d::partitioning::{Bvh, BvhBuildStrategy};
use std::collections::HashSet;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

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
    spheres: Vec<MedialSphere>,
    edges: Vec<[u32; 2]>,
    faces: Vec<[u32; 3]>,
    /// Spheres of each primitive: slabs, then cones, then lone spheres. Unused entries repeat the
    /// last sphere.
    primitives: Vec<Simplex>,
    tree: SphereTree,
    bvh: Bvh,
    aabb: Aabb,
    source_mass: Option<MassProperties>,
    solid_mass: OnceLock<MassProperties>,
    thickness: Real,
}

/// The spheres of a primitive, and the edges and spheres that it tests for the whole mesh.
///
/// An edge shared by several slabs is owned by the first of them, and so is a sphere: a query that
/// visits all primitives then meets each edge and sphere once.
#[derive(Clone, Copy, Debug)]
pub struct Simplex {
    /// Indices of its spheres.
    pub vertices: [u32; 3],
    /// How many of them count: 1, 2 or 3.
    pub len: u8,
    /// Bit `i`: it owns sphere `vertices[i]`.
    pub owns_vertex: u8,
    /// Bit `i`: it owns the edge from `vertices[i]` to `vertices[(i + 1) % 3]`.
    pub owns_edge: u8,
}

static NEXT_ID: AtomicU64 = AtomicU64::new(1);

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

impl MedialMesh {
    /// Checks and takes a medial mesh. Centres and radii are in the user's unit, in the body's
    /// frame; an edge or face names spheres by index. Edges of faces may be listed or not: missing
    /// ones are derived; doubles are dropped.
    ///
    /// Fails on the first item that is not finite, negative, out of range or degenerate, and names
    /// it.
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
        let boxes: Vec<Aabb> = primitives
            .iter()
            .map(|p| primitive_of(&spheres, p).aabb())
            .collect();
        let bvh = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        let aabb = boxes.iter().fold(Aabb::new_invalid(), |a, b| {
            Aabb::new(a.mins.min(b.mins), a.maxs.max(b.maxs))
        });
        let tree = SphereTree::new(&spheres, &primitives);
        let thickness = robust_thickness(&spheres, &primitives);
        let data = MedialData {
            spheres,
            edges,
            faces,
            primitives,
            tree,
            bvh,
            aabb,
            source_mass: None,
            solid_mass: OnceLock::new(),
            thickness,
        };
        Ok(Self {
            data: Arc::new(data),
            id: NEXT_ID.fetch_add(1, Ordering::Relaxed),
        })
    }

    /// The same mesh with mass properties measured on its source (unit density) in place of those
    /// of the solid.
    pub fn with_mass_properties(self, unit_density: MassProperties) -> Self {
        let d = &*self.data;
        let data = MedialData {
            spheres: d.spheres.clone(),
            edges: d.edges.clone(),
            faces: d.faces.clone(),
            primitives: d.primitives.clone(),
            tree: d.tree.clone(),
            bvh: d.bvh.clone(),
            aabb: d.aabb,
            source_mass: Some(unit_density),
            solid_mass: OnceLock::new(),
            thickness: d.thickness,
        };
        Self {
            data: Arc::new(data),
            id: self.id,
        }
    }

    /// The medial spheres.
    pub fn spheres(&self) -> &[MedialSphere] {
        &self.data.spheres
    }

    /// All edges, each once, smaller index first; those of faces among them.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.data.edges
    }

    /// The faces: one medial slab each.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.data.faces
    }

    /// How many convex volumes there are: slabs, cones that belong to no slab, lone spheres.
    pub fn primitive_count(&self) -> usize {
        self.data.primitives.len()
    }

    /// One of the volumes, in the body's frame. Slabs come first (one per face, in order), then
    /// cones, then lone spheres. Panics if `index` is not below [`Self::primitive_count`].
    pub fn primitive(&self, index: usize) -> MedialPrimitive {
        primitive_of(&self.data.spheres, &self.data.primitives[index])
    }

    /// All volumes, in the order of [`Self::primitive`].
    pub fn primitives(&self) -> impl ExactSizeIterator<Item = MedialPrimitive> + '_ {
        (0..self.primitive_count()).map(|i| self.primitive(i))
    }

    /// Indices and ownership of each primitive, in the order of [`Self::primitive`].
    pub fn simplices(&self) -> &[Simplex] {
        &self.data.primitives
    }

    /// Bounding spheres over the primitives, in the body's frame.
    pub fn tree(&self) -> &SphereTree {
        &self.data.tree
    }

    /// parry's tree of boxes over the primitives, in the body's frame.
    pub fn bvh(&self) -> &Bvh {
        &self.data.bvh
    }

    /// Box of the solid, in the body's frame.
    pub fn aabb(&self) -> Aabb {
        self.data.aabb
    }

    /// A typical small radius, a length: the 5th percentile of the local radius, weighted by the
    /// area of the medial mesh (a cone counts as a strip as wide as itself). Simplified tips have
    /// radius near 0, so the minimum would call every motion fast.
    pub fn thickness(&self) -> Real {
        self.data.thickness
    }

    /// Mass properties in the body's frame: of the source mesh when built from one, else of the
    /// solid with overlaps counted once.
    pub fn mass_properties(&self, density: Real) -> MassProperties {
        let unit = match &self.data.source_mass {
            Some(source) => *source,
            None => self.solid_mass_properties(),
        };
        let mut scaled = unit;
        scaled.set_mass(unit.mass() * density, true);
        scaled
    }

    /// Volume of the solid with overlaps counted once, in cubed units of length, whatever the mass
    /// properties were measured on. Computed at the first call.
    pub fn volume(&self) -> Real {
        self.solid_mass_properties().mass()
    }

    fn solid_mass_properties(&self) -> MassProperties {
        let solid = &self.data.solid_mass;
        *solid.get_or_init(|| mass::solid_mass_properties(self))
    }

    /// What tells colliders apart in caches. Clones share it.
    pub fn instance_id(&self) -> u64 {
        self.id
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

fn check(
    spheres: &[MedialSphere],
    edges: &[[u32; 2]],
    faces: &[[u32; 3]],
) -> Result<(), MeshError> {
    if spheres.is_empty() {
        return Err(MeshError::Empty);
    }
    for (index, s) in spheres.iter().enumerate() {
        if !(s.center.is_finite() && s.radius.is_finite()) {
            return Err(MeshError::NotFinite {
                index,
                center: s.center.into(),
                radius: s.radius,
            });
        }
        if s.radius < 0.0 {
            return Err(MeshError::NegativeRadius {
                index,
                radius: s.radius,
            });
        }
    }
    let count = spheres.len();
    let element = |element: &'static str, index: usize, vertices: &[u32]| {
        for (k, &value) in vertices.iter().enumerate() {
            if value as usize >= count {
                return Err(MeshError::IndexOutOfRange {
                    element,
                    index,
                    value: value.into(),
                    count,
                });
            }
            if vertices[..k].contains(&value) {
                return Err(MeshError::RepeatedIndex {
                    element,
                    index,
                    value,
                });
            }
        }
        Ok(())
    };
    for (index, e) in edges.iter().enumerate() {
        element("edge", index, e)?;
    }
    for (index, f) in faces.iter().enumerate() {
        element("face", index, f)?;
    }
    let first = spheres[0];
    if spheres
        .iter()
        .all(|s| s.radius == 0.0 && s.center == first.center)
    {
        return Err(MeshError::ZeroSize {
            count,
            center: first.center.into(),
        });
    }
    Ok(())
}

fn primitives_of(spheres: usize, edges: &[[u32; 2]], faces: &[[u32; 3]]) -> Vec<Simplex> {
    let mut edge_taken = HashSet::new();
    let mut vertex_taken = vec![false; spheres];
    let mut own_vertex = |v: u32, bit: u8| {
        let first = !std::mem::replace(&mut vertex_taken[v as usize], true);
        u8::from(first) << bit
    };
    let mut primitives = Vec::with_capacity(faces.len());
    for &vertices in faces {
        let [a, b, c] = vertices;
        let mut owns_edge = 0;
        for (bit, e) in [[a, b], [b, c], [c, a]].into_iter().enumerate() {
            owns_edge |= u8::from(edge_taken.insert(sorted(e))) << bit;
        }
        let owns_vertex = own_vertex(a, 0) | own_vertex(b, 1) | own_vertex(c, 2);
        primitives.push(Simplex {
            vertices,
            len: 3,
            owns_vertex,
            owns_edge,
        });
    }
    for &[a, b] in edges {
        if edge_taken.insert([a, b]) {
            primitives.push(Simplex {
                vertices: [a, b, b],
                len: 2,
                owns_vertex: own_vertex(a, 0) | own_vertex(b, 1),
                owns_edge: 1,
            });
        }
    }
    for v in 0..spheres as u32 {
        let owns_vertex = own_vertex(v, 0);
        if owns_vertex != 0 {
            primitives.push(Simplex {
                vertices: [v; 3],
                len: 1,
                owns_vertex,
                owns_edge: 1,
            });
        }
    }
    primitives
}

fn primitive_of(spheres: &[MedialSphere], p: &Simplex) -> MedialPrimitive {
    let [a, b, c] = p.vertices.map(|v| spheres[v as usize]);
    match p.len {
        1 => MedialPrimitive::Sphere(a),
        2 => MedialPrimitive::Cone([a, b]),
        _ => MedialPrimitive::Slab([a, b, c]),
    }
}

/// Weighted 5th percentile of the mean radius of each primitive; see [`MedialMesh::thickness`].
fn robust_thickness(spheres: &[MedialSphere], primitives: &[Simplex]) -> Real {
    let mut local: Vec<(Real, Real)> = primitives
        .iter()
        .map(|p| {
            let [a, b, c] = p.vertices.map(|v| spheres[v as usize]);
            let mean = (a.radius + b.radius + c.radius) / 3.0;
            let (ab, ac): (Vector, Vector) = (b.center - a.center, c.center - a.center);
            // A cone counts as a strip as wide as itself, a lone sphere as its own section.
            let area = match p.len {
                3 => 0.5 * ab.cross(ac).length(),
                2 => ab.length() * (a.radius + b.radius),
                _ => a.radius * a.radius,
            };
            let mean = if p.len == 2 {
                0.5 * (a.radius + b.radius)
            } else {
                mean
            };
            (mean, area)
        })
        .collect();
    local.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: Real = local.iter().map(|l| l.1).sum();
    let mut passed = 0.0;
    for &(radius, area) in &local {
        passed += area;
        if passed >= 0.05 * total {
            return radius;
        }
    }
    local.last().map_or(0.0, |l| l.0)
}
