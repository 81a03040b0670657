//! Saves and loads worlds with medial colliders (feature `serde-serialize`), since rapier refuses to write custom
//! shapes.
//!
//! A saved world is rapier's own with a ball in place of each medial mesh, and the meshes beside it, each once, however
//! many colliders share its data. Loading puts the meshes back and clears the change marks that this leaves on
//! the colliders, so that the world goes on bit by bit as if it had not been saved: broad phase, contacts and
//! impulses are in rapier's own records.

use crate::medial::MedialMesh;
use crate::medial::asset::checksum;
use crate::rapier::host::change_marks::{SlightChange, slight_change};
use crate::rapier::impacts::initial_overlaps::OverlapsRecord;
use crate::rapier::{MedialPipeline, MedialSharedShape};
use rapier3d::geometry::{BroadPhaseBvh, ColliderHandle, ColliderSet, NarrowPhase, SharedShape};
use rapier3d::pipeline::{CollisionPipeline, PhysicsWorld};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// First bytes of a saved world.
pub const MAGIC: [u8; 8] = *b"\x89worlds\n";

/// Version of the format that is written and read. It stands for the layout of this crate and of rapier 0.36.
pub const VERSION: u32 = 5;

/// Bytes before the content: magic, version, checksum of the content.
const HEADER: usize = 20;

/// Why a world cannot be saved or loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SavedWorldError {
    /// Colliders were removed since the last step. rapier forgets them in the next step; save after it.
    #[error("{0} colliders were removed since the last step: step once, then save")]
    Removed(usize),
    /// The world has a shape that is neither medial nor rapier's own, or a number that the format cannot hold.
    #[error("the world cannot be written: {0}")]
    Unwritable(#[source] postcard::Error),
    /// The bytes do not begin like a saved world.
    #[error("not a saved world: it starts with {start:?}")]
    NotAWorld {
        /// The first bytes, 8 at most.
        start: Vec<u8>,
    },
    /// The world was saved in another version of the format.
    #[error("saved by version {found}, this reads version {reads}")]
    Version {
        /// Version of the bytes.
        found: u32,
        /// The version that this crate reads.
        reads: u32,
    },
    /// Bytes were changed or are missing: the checksum is wrong.
    #[error("damaged: the checksum is {computed:#x}, stored is {stored:#x}")]
    Damaged {
        /// Checksum of the bytes that are there.
        computed: u64,
        /// Checksum stored when the world was saved.
        stored: u64,
    },
    /// More bytes follow the world; this is their number.
    #[error("{0} bytes follow the world")]
    TooLong(usize),
    /// The checksum is right, but the content is not a world.
    #[error("the content is no world: {0}")]
    Unreadable(#[source] postcard::Error),
    /// A collider that should have a medial mesh is missing, or its mesh is.
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

/// A world as serde can write it, in any format that can hold rapier's own worlds. [`save_world`] and
/// [`load_world`] are simpler to call, and detect damage.
#[derive(Serialize, Deserialize)]
pub struct SavedWorld {
    meshes: Vec<MedialMesh>,
    /// Medial colliders, and which mesh each has.
    shapes: Vec<(ColliderHandle, u32)>,
    changes: Changes,
    world: PhysicsWorld,
}

impl MedialPipeline {
    /// Pairs whose collision event `Started` was emitted because of an impact in the last step, and whose contact
    /// rapier has not found yet. They are not part of the world: if your game handles collision events, save them
    /// beside it.
    pub fn told_starts(&self) -> &[[ColliderHandle; 2]] {
        &self.state.reported.started
    }

    /// Restores what [`Self::told_starts`] was when the world was saved, so that no `Started` is
    /// emitted twice and no `Stopped` is lost.
    pub fn resume_told_starts(&mut self, starts: Vec<[ColliderHandle; 2]>) {
        self.state.reported.started = starts;
    }

    /// Record for the next step of bodies that were put into each other (spawned, teleported) and have not come apart.
    /// It is not part of the world: if your game puts bodies into each other, save it beside the world.
    pub fn overlaps(&self) -> OverlapsRecord {
        self.state.initial_overlaps.record()
    }

    /// Restores what [`Self::overlaps`] was when the world was saved, so that bodies that were put into each other come
    /// apart as they would have.
    pub fn resume_overlaps(&mut self, record: OverlapsRecord, world: &PhysicsWorld) {
        self.state.initial_overlaps.resume(record, &world.colliders);
    }
}

/// Which colliders the next step has to look at anew.
#[derive(Serialize, Deserialize)]
enum Changes {
    /// These colliders were changed slightly, as a first contact within a step changes their poses; none was changed
    /// otherwise.
    Slight(Vec<(ColliderHandle, SlightChange)>),
    /// Some were changed otherwise. Their own marks say how; those of medial colliders say besides that the shape is
    /// new, for which rapier begins their contacts afresh. These others were changed slightly.
    Marked(Vec<(ColliderHandle, SlightChange)>),
}

impl SavedWorld {
    /// Takes a copy of the world, between steps. If you have changed the shape, mass, groups or parent of a medial
    /// collider since the last step, its place on the parent, whether it is a sensor or whether it is enabled, it loses
    /// its contacts and gets new ones in the first step after loading.
    ///
    /// # Errors
    /// [`SavedWorldError::Removed`] if colliders were removed since the last step.
    pub fn new(world: &PhysicsWorld) -> Result<Self, SavedWorldError> {
        let mut colliders = world.colliders.clone();
        let removed = colliders.take_removed().len();
        if removed > 0 {
            return Err(SavedWorldError::Removed(removed));
        }
        let modified: Vec<ColliderHandle> = colliders.clone().take_modified().to_vec();
        let slight = modified.iter();
        let slight = slight.filter_map(|h| Some((*h, slight_change(colliders.get(*h)?)?)));
        let slight: Vec<(ColliderHandle, SlightChange)> = slight.collect();
        let mut unmarked = colliders.clone();
        forget_changes(world, &mut unmarked);
        let changes = if slight.len() == modified.len() {
            colliders = unmarked;
            Changes::Slight(slight)
        } else {
            // This list then holds the colliders that get a ball, and no others.
            colliders.take_modified();
            for &(h, _) in &slight {
                if let (Some(collider), Some(unmarked)) = (colliders.get_mut(h), unmarked.get(h)) {
                    *collider = unmarked.clone();
                }
            }
            Changes::Marked(slight)
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

    /// The world again. Attach a pipeline to it ([`crate::MedialPipeline::attach`]) before the first step.
    ///
    /// # Errors
    /// [`SavedWorldError::Missing`] if a collider or its mesh is missing. The rest of the world is not checked for
    /// contradictions; see [`load_world`].
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
        let slight = match changes {
            Changes::Slight(slight) => slight,
            // Lists all colliders as possibly changed; each one's own marks say whether it is.
            Changes::Marked(slight) => {
                colliders.iter_mut().for_each(drop);
                slight
            }
        };
        for (h, change) in slight {
            // To borrow it already marks it as changed.
            if let Some(collider) = colliders.get_mut(h)
                && change == SlightChange::Pose
            {
                collider.set_position(*collider.position());
            }
        }
        world.colliders = colliders;
        Ok(world)
    }
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

/// Saves a world as bytes with a checksum. Call it between steps. The bytes do not contain
/// [`MedialPipeline::told_starts`] and [`MedialPipeline::overlaps`]: if your game needs them, save
/// them too.
///
/// # Errors
/// [`SavedWorldError::Removed`] if colliders were removed since the last step, [`SavedWorldError::Unwritable`] if
/// the world has custom shapes other than medial meshes.
///
/// ```
/// use rapier3d::prelude::*;
/// use rapier3d_medial::prelude::*;
/// use rapier3d_medial::rapier::{load_world, save_world};
///
/// let mut world = PhysicsWorld::new();
/// let ring = ColliderBuilder::medial_mesh(MedialMesh::torus(0.5, 0.1, 16)?);
/// world.insert(RigidBodyBuilder::dynamic(), ring);
/// let bytes = save_world(&world)?;
///
/// let mut loaded = load_world(&bytes)?;
/// let mut pipeline = MedialPipeline::new(MedialOptions::default());
/// pipeline.attach(&mut loaded);
/// pipeline.step(&mut loaded);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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

/// Loads a world from the bytes of [`save_world`]. It goes on bit by bit as if it had not been saved. Attach a pipeline
/// to it ([`crate::MedialPipeline::attach`]) before the first step.
///
/// # Errors
/// [`SavedWorldError`] if the bytes are not a saved world, are of another version, or are damaged.
///
/// # Panics
/// Damage is detected, malice is not: forged bytes with a good checksum may hold a world that contradicts itself (a
/// joint of a body that is not there). rapier does not check this, and may panic in the loading or in the next
/// step. Load only worlds from sources you trust.
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
