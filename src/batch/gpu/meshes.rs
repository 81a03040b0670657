//! The meshes that are kept on the GPU: the sphere tree and the primitives of each, one after the other. A mesh is sent
//! once, however many bodies have it.

use super::layout::{Node, Primitive};
use super::near::Range;
use crate::math::fast_hash::FastMap;
use crate::medial::tree::NodeKind;
use crate::medial::{MedialMesh, MedialPrimitive, MedialSphere};

/// Marks a leaf in [`Node::below`].
const LEAF: u32 = 1 << 31;

/// A mesh that the device holds.
struct Resident {
    /// Keeps the address, by which it is found, from being given to another.
    mesh: MedialMesh,
    /// Index of the root of its tree, and where its primitives are.
    place: (u32, Range),
    used: u64,
}

/// Meshes that the device holds, and a copy of them.
#[derive(Default)]
pub(super) struct Meshes {
    pub(super) nodes: Vec<Node>,
    pub(super) primitives: Vec<Primitive>,
    /// Nodes and primitives that the device has.
    pub(super) sent: (usize, usize),
    residents: FastMap<usize, Resident>,
    batch: u64,
}

/// Key of the data that bodies share: the spheres' address.
fn key(mesh: &MedialMesh) -> usize {
    mesh.spheres().as_ptr() as usize
}

impl Meshes {
    /// How many meshes there are.
    pub(super) fn len(&self) -> usize {
        self.residents.len()
    }

    /// Begins a batch: meshes asked for until the next call count as used. Meshes that no one else holds go when they
    /// are half of all: earlier, each body that is removed would have all others sent again.
    pub(super) fn begin(&mut self) {
        self.batch += 1;
        let orphan = |r: &Resident| r.mesh.owners() == 1;
        let orphans = self.residents.values().filter(|r| orphan(r));
        let orphaned: usize = orphans.map(|r| r.mesh.primitive_count()).sum();
        if orphaned > 0 && 2 * orphaned >= self.primitives.len() {
            self.residents.retain(|_, r| !orphan(r));
            self.pack();
        }
    }

    /// Index of the root of the mesh's tree, and where its primitives are; the mesh is added if it is new.
    pub(super) fn place(&mut self, mesh: &MedialMesh) -> (u32, Range) {
        let batch = self.batch;
        if let Some(resident) = self.residents.get_mut(&key(mesh)) {
            resident.used = batch;
            return resident.place;
        }
        let place = self.append(mesh);
        let resident = Resident {
            mesh: mesh.clone(),
            place,
            used: batch,
        };
        self.residents.insert(key(mesh), resident);
        place
    }

    /// Drops a mesh; the others move together and are sent again.
    pub(super) fn remove(&mut self, mesh: &MedialMesh) -> bool {
        let found = self.residents.remove(&key(mesh)).is_some();
        if found {
            self.pack();
        }
        found
    }

    /// Drops what this batch has not used.
    pub(super) fn drop_unused(&mut self) {
        let batch = self.batch;
        self.residents.retain(|_, r| r.used == batch);
        self.pack();
    }

    /// The device has lost its copy.
    pub(super) fn send_again(&mut self) {
        self.sent = (0, 0);
    }

    fn pack(&mut self) {
        self.nodes.clear();
        self.primitives.clear();
        self.send_again();
        let mut residents = std::mem::take(&mut self.residents);
        for resident in residents.values_mut() {
            resident.place = self.append(&resident.mesh);
        }
        self.residents = residents;
    }

    fn append(&mut self, mesh: &MedialMesh) -> (u32, Range) {
        let root = self.nodes.len() as u32;
        let first = self.primitives.len() as u32;
        let nodes = mesh.tree().nodes().iter().map(|node| {
            let below = match node.kind() {
                NodeKind::Nodes(child, _) => root + child,
                NodeKind::Primitive(index) => (first + index) | LEAF,
            };
            Node {
                bound: packed(MedialSphere::new(node.center, node.radius)),
                below,
                radius: node.radius,
                pad: [0; 2],
            }
        });
        self.nodes.extend(nodes);
        let spheres = |p: MedialPrimitive| p.as_slab().map(packed);
        let primitives = mesh.primitives().map(spheres);
        self.primitives
            .extend(primitives.map(|spheres| Primitive { spheres }));
        let count = self.primitives.len() as u32 - first;
        (root, Range { first, count })
    }
}

fn packed(s: MedialSphere) -> [f32; 4] {
    [s.center.x, s.center.y, s.center.z, s.radius]
}
