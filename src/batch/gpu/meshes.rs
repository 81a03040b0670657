//! Meshes that stay on the device: clusters and primitives of each, one after the other. A mesh is
//! sent once, whatever the number of its bodies; the sphere tree of the body gives the clusters.

use super::layout::{CLUSTER, Cluster, Primitive};
use crate::medial::tree::{Below, Node};
use crate::medial::{MedialMesh, MedialSphere};
use std::collections::HashMap;

/// Where a mesh lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) first_cluster: u32,
    pub(super) clusters: u32,
}

struct Resident {
    /// Keeps the address, by which it is found, from being given to another.
    mesh: MedialMesh,
    place: Place,
    used: u64,
}

/// What the device holds, and a copy of it.
#[derive(Default)]
pub(super) struct Meshes {
    pub(super) clusters: Vec<Cluster>,
    pub(super) primitives: Vec<Primitive>,
    /// Clusters and primitives that the device has.
    pub(super) sent: (usize, usize),
    residents: HashMap<usize, Resident>,
    batch: u64,
}

/// What bodies share: the spheres' address.
fn key(mesh: &MedialMesh) -> usize {
    mesh.spheres().as_ptr() as usize
}

impl Meshes {
    /// How many meshes there are.
    pub(super) fn len(&self) -> usize {
        self.residents.len()
    }

    /// Before a batch: what is asked for until the next call counts as used. Meshes that no one else
    /// holds go when they are half of all: earlier, each body that is removed would have all others
    /// sent again.
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

    /// Where the mesh lies; it is added if it is new.
    pub(super) fn place(&mut self, mesh: &MedialMesh) -> Place {
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
        self.clusters.clear();
        self.primitives.clear();
        self.send_again();
        let mut residents = std::mem::take(&mut self.residents);
        for resident in residents.values_mut() {
            resident.place = self.append(&resident.mesh);
        }
        self.residents = residents;
    }

    fn append(&mut self, mesh: &MedialMesh) -> Place {
        let nodes = mesh.tree().nodes();
        let first_cluster = self.clusters.len() as u32;
        let mut stack = vec![0u32];
        while let Some(node) = stack.pop() {
            match nodes[node as usize].below() {
                Below::Nodes(i, j) if !few(nodes, node) => stack.extend([j, i]),
                _ => self.cluster(mesh, node),
            }
        }
        Place {
            first_cluster,
            clusters: self.clusters.len() as u32 - first_cluster,
        }
    }

    fn cluster(&mut self, mesh: &MedialMesh, root: u32) {
        let nodes = mesh.tree().nodes();
        let first = self.primitives.len();
        let mut stack = vec![root];
        while let Some(node) = stack.pop() {
            let node = &nodes[node as usize];
            match node.below() {
                Below::Nodes(i, j) => stack.extend([j, i]),
                Below::Primitive(index) => self.primitives.push(Primitive {
                    bound: bound(node),
                    spheres: mesh.primitive(index as usize).as_slab().map(packed),
                    index,
                    count: mesh.simplices()[index as usize].len.into(),
                    pad: [0; 2],
                }),
            }
        }
        self.clusters.push(Cluster {
            bound: bound(&nodes[root as usize]),
            first: first as u32,
            count: (self.primitives.len() - first) as u32,
            pad: [0; 2],
        });
    }
}

fn bound(node: &Node) -> [f32; 4] {
    packed(MedialSphere::new(node.center, node.radius))
}

fn packed(s: MedialSphere) -> [f32; 4] {
    [s.center.x, s.center.y, s.center.z, s.radius]
}

/// Whether a node's primitives fit into one cluster.
fn few(nodes: &[Node], root: u32) -> bool {
    let mut stack = vec![root];
    let mut leaves = 0;
    while let Some(node) = stack.pop() {
        match nodes[node as usize].below() {
            Below::Nodes(i, j) => stack.extend([j, i]),
            Below::Primitive(_) => leaves += 1,
        }
        if leaves > CLUSTER {
            return false;
        }
    }
    true
}
