//! Which pairs of medial colliders may need manifolds in this step: sweep and prune over their boxes
//! at the start of the step.

use super::ahead::{Ahead, Start, Starts};
use super::hanging::is_hooked;
use super::recycled::Recycled;
use crate::batch::PairJob;
use crate::math::{Pose, Real, Rotation, Vector};
use crate::medial::MedialMesh;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use rapier3d::dynamics::{IntegrationParameters, RigidBody, RigidBodyHandle, RigidBodySet};
use rapier3d::geometry::{Collider, ColliderHandle, ColliderSet};
use std::collections::HashSet;

/// Gives every medial collider an instance id of its own; colliders that share a shape would share
/// answers. Returns how many medial colliders there are.
pub fn make_unique(colliders: &mut ColliderSet) -> usize {
    let mut seen = HashSet::new();
    let mut shared = Vec::new();
    let mut count = 0;
    for (handle, collider) in colliders.iter_enabled() {
        if let Some(mesh) = collider.shape().as_shape::<MedialMesh>() {
            count += 1;
            if !seen.insert(mesh.instance_id()) {
                shared.push((handle, mesh.instance()));
            }
        }
    }
    for (handle, mesh) in shared {
        if let Some(collider) = colliders.get_mut(handle) {
            collider.set_shape(rapier3d::geometry::SharedShape::new(mesh));
        }
    }
    count
}

struct Item<'a> {
    handle: ColliderHandle,
    collider: &'a Collider,
    parent: Option<(RigidBodyHandle, &'a RigidBody)>,
    mesh: &'a MedialMesh,
    pose: Pose,
    aabb: Aabb,
}

impl Item<'_> {
    fn start(&self, gravity: Vector, dt: Real) -> Start {
        let aabb = self.mesh.aabb();
        let offset = self.collider.position_wrt_parent();
        let extent = aabb.mins.abs().max(aabb.maxs.abs()).length();
        Start::new(
            self.parent.map(|(_, body)| body),
            [self.pose, offset.copied().unwrap_or(Pose::IDENTITY)],
            [extent, self.collider.contact_skin()],
            gravity,
            dt,
        )
    }

    /// Moves by the solver, and is awake.
    fn active(&self) -> bool {
        self.parent
            .is_some_and(|(_, b)| b.is_dynamic() && b.is_enabled() && !b.is_sleeping())
    }
}

/// Near pairs of medial colliders, and of them those that the narrow phase will ask for.
pub struct Candidates {
    /// How many near pairs there are.
    pub pairs: usize,
    /// Those whose relative pose changed too much for rapier to recycle their contacts.
    pub jobs: Vec<PairJob>,
    /// Where the answers to these belong.
    pub ahead: Vec<Ahead>,
    /// What those need that rapier asks for besides.
    pub starts: Starts,
}

/// Finds all near pairs of medial colliders: at least one of them dynamic and awake, not on the same
/// body, groups compatible. The order of the two is the narrow phase's (lower collider index
/// first). Of the colliders of `fresh` rapier will ask for all contacts.
pub fn find(
    gravity: Vector,
    parameters: &IntegrationParameters,
    bodies: &RigidBodySet,
    colliders: &ColliderSet,
    fresh: &HashSet<ColliderHandle>,
    recycled: &mut Recycled,
) -> Candidates {
    let items = items(parameters, bodies, colliders);
    let starts = starts(&items, gravity, parameters);
    recycled.begin(parameters);
    let (mut pairs, mut jobs, mut ahead) = (0, Vec::new(), Vec::new());
    for_each_near(&items, parameters, |near| {
        pairs += 1;
        if recycled.needs_update(&near.job, near.rotations(), near.asked(fresh)) {
            let (from, job) = near.at_the_end(&starts);
            jobs.push(job);
            ahead.push(from);
        }
    });
    Candidates {
        pairs,
        jobs,
        ahead,
        starts,
    }
}

fn starts(items: &[Item], gravity: Vector, parameters: &IntegrationParameters) -> Starts {
    let start = |item: &Item| (item.mesh.instance_id(), item.start(gravity, parameters.dt));
    Starts {
        all: items.iter().map(start).collect(),
        parameters: *parameters,
    }
}

/// What [`find`] will find at the next step, if nothing is changed until then.
pub fn expect(
    gravity: Vector,
    parameters: &IntegrationParameters,
    bodies: &RigidBodySet,
    colliders: &ColliderSet,
    fresh: &HashSet<ColliderHandle>,
    recycled: &Recycled,
) -> Vec<PairJob> {
    let items = items(parameters, bodies, colliders);
    let starts = starts(&items, gravity, parameters);
    let mut jobs = Vec::new();
    for_each_near(&items, parameters, |near| {
        if near.asked(fresh) || !recycled.recycles(&near.job, near.rotations()) {
            jobs.push(near.at_the_end(&starts).1);
        }
    });
    jobs
}

/// Two colliders that are near each other.
struct Near<'a, 'b> {
    items: [&'a Item<'b>; 2],
    /// At the start of the step.
    job: PairJob,
}

impl Near<'_, '_> {
    fn rotations(&self) -> [Rotation; 2] {
        self.items.map(|item| item.pose.rotation)
    }

    /// Whether rapier asks for the contacts of one of them in any case: the user has hooks on it, or it is
    /// `fresh`.
    fn asked(&self, fresh: &HashSet<ColliderHandle>) -> bool {
        let asked = |i: &&Item| is_hooked(i.collider) || fresh.contains(&i.handle);
        self.items.iter().any(asked)
    }

    /// The job at the poses that the velocities lead to.
    fn at_the_end(self, starts: &Starts) -> (Ahead, PairJob) {
        let of = |item: &Item| &starts.all[&item.mesh.instance_id()];
        Ahead::new(self.items.map(of), &starts.parameters, self.job)
    }
}

/// The medial colliders, from left to right.
fn items<'a>(
    parameters: &IntegrationParameters,
    bodies: &'a RigidBodySet,
    colliders: &'a ColliderSet,
) -> Vec<Item<'a>> {
    let prediction = parameters.prediction_distance();
    let mut items: Vec<Item> = colliders
        .iter_enabled()
        .filter_map(|(handle, collider)| {
            let mesh = collider.shape().as_shape::<MedialMesh>()?;
            let parent = collider
                .parent()
                .and_then(|h| bodies.get(h).map(|body| (h, body)));
            // What the narrow phase will see, to the bit.
            let pose = match (parent, collider.position_wrt_parent()) {
                (Some((_, body)), Some(offset)) => *body.position() * *offset,
                _ => *collider.position(),
            };
            let margin = prediction + collider.contact_skin();
            let aabb = parry3d::shape::Shape::compute_aabb(mesh, &pose).loosened(margin);
            pose.is_finite().then_some(Item {
                handle,
                collider,
                parent,
                mesh,
                pose,
                aabb,
            })
        })
        .collect();
    items.sort_by(|a, b| a.aabb.mins.x.total_cmp(&b.aabb.mins.x));
    items
}

/// Visits each near pair of them.
fn for_each_near<'a, 'b>(
    items: &'a [Item<'b>],
    parameters: &IntegrationParameters,
    mut visit: impl FnMut(Near<'a, 'b>),
) {
    let prediction = parameters.prediction_distance();
    for (i, a) in items.iter().enumerate() {
        for b in &items[i + 1..] {
            if b.aabb.mins.x > a.aabb.maxs.x {
                break;
            }
            if !wanted(a, b) {
                continue;
            }
            let (x, y) = in_order(a, b);
            let job = job(x, y, prediction);
            visit(Near { items: [x, y], job });
        }
    }
}

fn wanted(a: &Item, b: &Item) -> bool {
    let same_body = match (a.parent, b.parent) {
        (Some((x, _)), Some((y, _))) => x == y,
        _ => false,
    };
    a.aabb.intersects(&b.aabb)
        && (a.active() || b.active())
        && !same_body
        && a.collider
            .collision_groups()
            .test(b.collider.collision_groups())
        && !a.collider.is_sensor()
        && !b.collider.is_sensor()
}

/// In the narrow phase's order.
fn in_order<'a, 'b>(a: &'a Item<'b>, b: &'a Item<'b>) -> (&'a Item<'b>, &'a Item<'b>) {
    if a.handle.into_raw_parts().0 < b.handle.into_raw_parts().0 {
        (a, b)
    } else {
        (b, a)
    }
}

fn job(x: &Item, y: &Item, prediction: Real) -> PairJob {
    PairJob {
        mesh1: x.mesh.clone(),
        mesh2: y.mesh.clone(),
        pos12: x.pose.inv_mul(&y.pose),
        // Added up as rapier does.
        prediction: prediction + (x.collider.contact_skin() + y.collider.contact_skin()),
    }
}
