//! Which pairs of medial colliders may need manifolds in this step: those whose boxes at its start meet.

use super::ahead::{Ahead, Start, Starts};
use super::hanging::{self, is_hooked};
use super::pushes;
use super::recycled::{Place, Recycled};
use super::sweep::meeting;
use crate::batch::PairJob;
use crate::math::{Pose, Real, Vector};
use crate::medial::MedialMesh;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use rapier3d::dynamics::{
    ImpulseJointSet, IntegrationParameters, MultibodyJointSet, RigidBody, RigidBodyHandle,
    RigidBodySet,
};
use rapier3d::geometry::{Collider, ColliderHandle, ColliderSet, NarrowPhase};
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
    /// As far as contacts are looked for.
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

    fn reach(&self) -> Real {
        let aabb = self.mesh.aabb();
        aabb.mins.length().max(aabb.maxs.length())
    }
}

/// The world at the start of a step.
#[derive(Clone, Copy)]
pub struct Sets<'a> {
    /// Gravity.
    pub gravity: Vector,
    /// Of the step.
    pub parameters: &'a IntegrationParameters,
    /// Bodies.
    pub bodies: &'a RigidBodySet,
    /// Colliders.
    pub colliders: &'a ColliderSet,
    /// Joints.
    pub impulse_joints: &'a ImpulseJointSet,
    /// Multibodies.
    pub multibody_joints: &'a MultibodyJointSet,
    /// Contacts of the step before.
    pub narrow_phase: &'a NarrowPhase,
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
    /// Colliders that rapier has to be made to ask for.
    pub fresh: HashSet<ColliderHandle>,
}

/// Finds all near pairs of medial colliders: at least one of them dynamic and awake, not on the same
/// body, groups compatible. The order of the two is the narrow phase's (lower collider index
/// first).
pub fn find(sets: Sets, recycled: &mut Recycled) -> Candidates {
    let scene = Scene::new(sets);
    let fresh = hanging::find(&sets, &scene.starts);
    recycled.begin(sets.parameters);
    let asked =
        |pair: &&[usize; 2]| recycled.needs_update(&scene.place(pair), scene.asked(pair, &fresh));
    let asked = scene.pairs.iter().filter(asked);
    let (ahead, jobs) = asked.map(|pair| scene.at_the_end(pair)).unzip();
    Candidates {
        pairs: scene.pairs.len(),
        jobs,
        ahead,
        starts: scene.starts,
        fresh,
    }
}

/// What [`find`] will find at the next step, if nothing is changed until then.
pub fn expect(sets: Sets, recycled: &Recycled) -> Vec<PairJob> {
    let scene = Scene::new(sets);
    let fresh = hanging::find(&sets, &scene.starts);
    let asked =
        |pair: &&[usize; 2]| scene.asked(pair, &fresh) || !recycled.recycles(&scene.place(pair));
    let asked = scene.pairs.iter().filter(asked);
    asked.map(|pair| scene.at_the_end(pair).1).collect()
}

/// The medial colliders at the start of a step, and which of them are near each other.
struct Scene<'a> {
    items: Vec<Item<'a>>,
    starts: Starts,
    /// In the narrow phase's order.
    pairs: Vec<[usize; 2]>,
}

impl<'a> Scene<'a> {
    fn new(sets: Sets<'a>) -> Self {
        let items = items(&sets);
        let start = |item: &Item| item.start(sets.gravity, sets.parameters.dt);
        let mut all: Vec<Start> = items.iter().map(start).collect();
        let mut boxes: Vec<Aabb> = items.iter().map(|item| item.aabb).collect();
        let speed = |(item, start): (&Item, &Start)| match item.parent {
            Some((body, _)) if pushes::is_tied(&sets, body) => Real::MAX,
            _ => start.speed(),
        };
        let mut speeds: Vec<Real> = items.iter().zip(&all).map(speed).collect();
        for (aabb, speed) in pushes::others(&sets) {
            boxes.push(aabb);
            speeds.push(speed);
        }
        let met = meeting(&boxes);
        let pushed = pushes::pushed(&speeds, &met);
        for (start, pushed) in all.iter_mut().zip(pushed) {
            start.pushed = pushed;
        }
        let medial = met
            .into_iter()
            .filter(|pair| pair.iter().all(|k| *k < items.len()));
        let wanted = medial.filter(|[i, j]| wanted(&items[*i], &items[*j]));
        let pairs = wanted.map(|pair| in_order(&items, pair)).collect();
        let starts = Starts {
            ids: items.iter().map(|item| item.mesh.instance_id()).collect(),
            all,
            parameters: *sets.parameters,
        };
        Self {
            items,
            starts,
            pairs,
        }
    }

    fn of(&self, pair: &[usize; 2]) -> [&Item<'a>; 2] {
        pair.map(|k| &self.items[k])
    }

    fn place(&self, pair: &[usize; 2]) -> Place {
        let [a, b] = self.of(pair);
        Place {
            ids: pair.map(|k| self.starts.ids[k]),
            pos12: a.pose.inv_mul(&b.pose),
            rotations: [a.pose.rotation, b.pose.rotation],
            reach: a.reach().max(b.reach()),
        }
    }

    /// Whether rapier asks for the contacts of one of them in any case: the user has hooks on it, or it is
    /// `fresh`.
    fn asked(&self, pair: &[usize; 2], fresh: &HashSet<ColliderHandle>) -> bool {
        let asked = |i: &&Item| is_hooked(i.collider) || fresh.contains(&i.handle);
        self.of(pair).iter().any(asked)
    }

    /// The job at the poses that the velocities lead to.
    fn at_the_end(&self, pair: &[usize; 2]) -> (Ahead, PairJob) {
        let [a, b] = self.of(pair);
        let parameters = &self.starts.parameters;
        let skins = a.collider.contact_skin() + b.collider.contact_skin();
        let job = PairJob {
            mesh1: a.mesh.clone(),
            mesh2: b.mesh.clone(),
            pos12: a.pose.inv_mul(&b.pose),
            // Added up as rapier does.
            prediction: parameters.prediction_distance() + skins,
        };
        Ahead::new(pair.map(|k| &self.starts.all[k]), parameters, job)
    }
}

/// The medial colliders, by instance id.
fn items<'a>(sets: &Sets<'a>) -> Vec<Item<'a>> {
    let prediction = sets.parameters.prediction_distance();
    let mut items: Vec<Item> = sets
        .colliders
        .iter_enabled()
        .filter_map(|(handle, collider)| {
            let mesh = collider.shape().as_shape::<MedialMesh>()?;
            let parent = collider
                .parent()
                .and_then(|h| sets.bodies.get(h).map(|body| (h, body)));
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
    items.sort_by_key(|item| item.mesh.instance_id());
    items
}

fn wanted(a: &Item, b: &Item) -> bool {
    let same_body = match (a.parent, b.parent) {
        (Some((x, _)), Some((y, _))) => x == y,
        _ => false,
    };
    (a.active() || b.active())
        && !same_body
        && a.collider
            .collision_groups()
            .test(b.collider.collision_groups())
        && !a.collider.is_sensor()
        && !b.collider.is_sensor()
}

/// In the narrow phase's order.
fn in_order(items: &[Item], [i, j]: [usize; 2]) -> [usize; 2] {
    let index = |k: usize| items[k].handle.into_raw_parts().0;
    if index(i) < index(j) { [i, j] } else { [j, i] }
}
