//! Worlds with medial colliders, saved and loaded: rapier refuses to write custom shapes. Feature
//! `serde-serialize`.
//!
//! A saved world is rapier's own with a ball in the place of every medial mesh, and beside it each mesh
//! once, however many colliders share its data. Loading puts the meshes back and clears the marks that
//! this leaves on the colliders, so that the world continues bit by bit as if it had not been saved:
//! broad phase, contacts and impulses are rapier's own records.

use crate::medial::MedialMesh;
use crate::medial::asset::checksum;
use crate::rapier::{MedialPipeline, MedialSharedShape};
use rapier3d::geometry::{
    BroadPhaseBvh, Collider, ColliderHandle, ColliderSet, NarrowPhase, SharedShape,
};
use rapier3d::pipeline::{CollisionPipeline, PhysicsWorld};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// First bytes of a saved world, as of a baked mesh.
pub const MAGIC: [u8; 8] = *b"\x89worlds\n";

/// Version of the bytes that is written and read: this crate's, and rapier 0.36's layout.
pub const VERSION: u32 = 3;

/// Bytes before the content: magic, version, checksum of the content.
const HEADER: usize = 20;

/// Why a world is not saved or not loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SavedWorldError {
    /// Colliders were removed since the last step, and the step that forgets them is not saved with them.
    #[error("{0} colliders were removed since the last step: step once, then save")]
    Removed(usize),
    /// A shape that is neither medial nor rapier's own, or a number that the format cannot hold.
    #[error("the world cannot be written: {0}")]
    Unwritable(#[source] postcard::Error),
    /// The bytes do not start like a saved world.
    #[error("not a saved world: it starts with {start:?}")]
    NotAWorld {
        /// The first bytes, 8 at most.
        start: Vec<u8>,
    },
    /// Another version of this crate wrote it.
    #[error("saved by version {found}, this reads version {reads}")]
    Version {
        /// Version of the bytes.
        found: u32,
        /// [`VERSION`].
        reads: u32,
    },
    /// Bytes were changed or are missing.
    #[error("damaged: the checksum is {computed:#x}, stored is {stored:#x}")]
    Damaged {
        /// Of the bytes that are there.
        computed: u64,
        /// That was stored when it was saved.
        stored: u64,
    },
    /// Bytes follow the world.
    #[error("{0} bytes follow the world")]
    TooLong(usize),
    /// The content is no world.
    #[error("the content is no world: {0}")]
    Unreadable(#[source] postcard::Error),
    /// A collider's mesh is not there, or the collider is not.
    #[error("collider {collider:?} has mesh {mesh}, of {meshes}: one of them is missing")]
    Missing {
        /// The collider.
        collider: ColliderHandle,
        /// Index of its mesh.
        mesh: u32,
        /// How many meshes there are.
        meshes: usize,
    },
}

/// A world in the form that serde writes, in any format that holds rapier's own worlds.
/// [`save_world`] and [`load_world`] are shorter, and see damage.
#[derive(Serialize, Deserialize)]
pub struct SavedWorld {
    meshes: Vec<MedialMesh>,
    /// Medial colliders, and which mesh each has.
    shapes: Vec<(ColliderHandle, u32)>,
    changes: Changes,
    world: PhysicsWorld,
}

impl MedialPipeline {
    /// Pairs whose start was told by impacts of the last step, and which rapier has not found yet. Save them beside
    /// the world, which does not have them, where somebody listens to collision events.
    pub fn told_starts(&self) -> &[[ColliderHandle; 2]] {
        &self.told.started
    }

    /// Goes on from what [`Self::told_starts`] was when the world was saved: these are not told again, and their ends
    /// are.
    pub fn resume_told_starts(&mut self, starts: Vec<[ColliderHandle; 2]>) {
        self.told.started = starts;
    }
}

/// Which colliders the next step has to look at anew.
#[derive(Serialize, Deserialize)]
enum Changes {
    /// These have moved, as a first contact within a step leaves them; none was changed otherwise.
    Moved(Vec<ColliderHandle>),
    /// Some were changed by hand. Their own marks say how; those of medial colliders say besides that
    /// the shape is new, for which rapier begins their contacts afresh.
    Marked,
}

impl SavedWorld {
    /// Takes a copy of the world. Save between steps: of colliders changed by hand since the last one
    /// (added, given other groups) the contacts, if they had any, begin afresh after loading.
    ///
    /// Fails if colliders were removed since the last step.
    pub fn new(world: &PhysicsWorld) -> Result<Self, SavedWorldError> {
        let mut colliders = world.colliders.clone();
        let removed = colliders.take_removed().len();
        if removed > 0 {
            return Err(SavedWorldError::Removed(removed));
        }
        let modified: Vec<ColliderHandle> = colliders.clone().take_modified().to_vec();
        let moved = |h: &ColliderHandle| colliders.get(*h).is_some_and(only_moved);
        let changes = if modified.iter().all(moved) {
            forget_changes(world, &mut colliders);
            Changes::Moved(modified)
        } else {
            // What is left in this list are then the colliders that get a ball, and no others.
            colliders.take_modified();
            Changes::Marked
        };
        let mut meshes: Vec<MedialMesh> = Vec::new();
        let mut known: HashMap<usize, u32> = HashMap::new();
        let mut shapes = Vec::new();
        for (handle, collider) in world.colliders.iter() {
            let Some(mesh) = collider.shape().as_shape::<MedialMesh>() else {
                continue;
            };
            // Meshes that share data share its address, as long as one of them lives.
            let index = *known
                .entry(mesh.spheres().as_ptr().addr())
                .or_insert_with(|| {
                    meshes.push(mesh.clone());
                    meshes.len() as u32 - 1
                });
            shapes.push((handle, index));
            if let Some(collider) = colliders.get_mut(handle) {
                collider.set_shape(SharedShape::ball(1.0));
            }
        }
        let world = PhysicsWorld {
            gravity: world.gravity,
            integration_parameters: world.integration_parameters,
            islands: world.islands.clone(),
            broad_phase: world.broad_phase.clone(),
            narrow_phase: world.narrow_phase.clone(),
            bodies: world.bodies.clone(),
            colliders,
            impulse_joints: world.impulse_joints.clone(),
            multibody_joints: world.multibody_joints.clone(),
            soft_bodies: world.soft_bodies.clone(),
            ..PhysicsWorld::default()
        };
        Ok(Self {
            meshes,
            shapes,
            changes,
            world,
        })
    }

    /// The world. Attach a pipeline to it ([`crate::MedialPipeline::attach`]) before it steps.
    ///
    /// Fails if a collider or its mesh is missing. Whether the rest of the world agrees with itself is not
    /// looked at ([`load_world`]).
    pub fn into_world(self) -> Result<PhysicsWorld, SavedWorldError> {
        let Self {
            meshes,
            shapes,
            changes,
            mut world,
        } = self;
        for (handle, index) in shapes {
            let both = (world.colliders.get_mut(handle), meshes.get(index as usize));
            let (Some(collider), Some(mesh)) = both else {
                return Err(SavedWorldError::Missing {
                    collider: handle,
                    mesh: index,
                    meshes: meshes.len(),
                });
            };
            collider.set_shape(SharedShape::medial_mesh(mesh.clone()));
        }
        let mut colliders = std::mem::take(&mut world.colliders);
        forget_changes(&world, &mut colliders);
        match changes {
            // Setting where it is already marks it as moved.
            Changes::Moved(moved) => moved.into_iter().for_each(|h| {
                if let Some(collider) = colliders.get_mut(h) {
                    collider.set_position(*collider.position());
                }
            }),
            // Lists all colliders as possibly changed; each one's own marks say whether it is.
            Changes::Marked => colliders.iter_mut().for_each(drop),
        }
        world.colliders = colliders;
        Ok(world)
    }
}

/// Whether nothing but its pose was changed since the last step. rapier keeps the marks to itself, but
/// prints them.
fn only_moved(collider: &Collider) -> bool {
    format!("{collider:?}").contains("changes: ColliderChanges(IN_MODIFIED_SET | POSITION)")
}

/// Clears the marks of the listed colliders. Only a step does that: one of collision detection alone,
/// with copies of all that it changes but the colliders.
fn forget_changes(world: &PhysicsWorld, colliders: &mut ColliderSet) {
    CollisionPipeline::new().step(
        0.0,
        &mut world.islands.clone(),
        &mut BroadPhaseBvh::default(),
        &mut NarrowPhase::new(),
        &mut world.bodies.clone(),
        colliders,
        &(),
        &(),
    );
}

/// The world as bytes: [`SavedWorld`] with a checksum. Save between steps.
///
/// Fails if colliders were removed since the last step, and for custom shapes other than medial meshes.
pub fn save_world(world: &PhysicsWorld) -> Result<Vec<u8>, SavedWorldError> {
    let saved = SavedWorld::new(world)?;
    let content = postcard::to_stdvec(&saved).map_err(SavedWorldError::Unwritable)?;
    let mut bytes = Vec::with_capacity(HEADER + content.len());
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend(checksum(&content).to_le_bytes());
    bytes.extend(content);
    Ok(bytes)
}

/// The world of [`save_world`]'s bytes, every mesh in memory once. Attach a pipeline to it
/// ([`crate::MedialPipeline::attach`]) before it steps.
///
/// Fails on bytes that are something else, of another version or damaged. Checked for damage, not for
/// malice: bytes made up with a good checksum may hold a world that contradicts itself (a joint of a
/// body that is not there), which rapier does not look for, and on which its next step, or the
/// loading itself, may panic. Load worlds from those you trust.
pub fn load_world(bytes: &[u8]) -> Result<PhysicsWorld, SavedWorldError> {
    let not_a_world = || SavedWorldError::NotAWorld {
        start: bytes.iter().take(MAGIC.len()).copied().collect(),
    };
    let rest = bytes.strip_prefix(&MAGIC).ok_or_else(not_a_world)?;
    let (version, rest) = rest.split_first_chunk::<4>().ok_or_else(not_a_world)?;
    let found = u32::from_le_bytes(*version);
    if found != VERSION {
        return Err(SavedWorldError::Version {
            found,
            reads: VERSION,
        });
    }
    let (stored, content) = rest.split_first_chunk::<8>().ok_or_else(not_a_world)?;
    let (computed, stored) = (checksum(content), u64::from_le_bytes(*stored));
    if computed != stored {
        return Err(SavedWorldError::Damaged { computed, stored });
    }
    let (saved, rest) =
        postcard::take_from_bytes::<SavedWorld>(content).map_err(SavedWorldError::Unreadable)?;
    if !rest.is_empty() {
        return Err(SavedWorldError::TooLong(rest.len()));
    }
    saved.into_world()
}
