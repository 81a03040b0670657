//! What the true shapes say about a run. Nothing here asks the colliders how they are shaped.

use super::scene::{Scene, Stage};
use rapier3d::parry::query;
use rapier3d::prelude::{Pose, Real, RigidBodyType, Vector};

/// Bodies that touch are no further apart, on their true surfaces, than this share of the longest
/// side of the smaller.
const APART_SHARE: Real = 0.01;

/// Findings over all steps of a run.
#[derive(Clone, Copy, Debug)]
pub struct Audit {
    /// Pairs of bodies that touch, summed over the steps.
    pub contacts: usize,
    /// Those of them whose true surfaces are apart.
    pub ghosts: usize,
    /// Contacts and ghosts in the last step.
    pub last: (usize, usize),
    /// Moving bodies that touch nothing in the end: not the ground, no other body.
    pub floating: usize,
    /// How often the inner lines of two bodies crossed within a step: one body passed into or
    /// through another.
    pub crossings: usize,
    /// Deepest overlap of two bodies, as a share of their two radii (1: inner lines meet).
    pub deepest: Real,
    /// Lowest vertex of a moving body; the ground is at 0.
    pub lowest: Real,
    /// The same in the last step.
    pub lowest_last: Real,
    /// No pose was infinite or not a number.
    pub finite: bool,
}

impl Default for Audit {
    fn default() -> Self {
        Self {
            contacts: 0,
            ghosts: 0,
            last: (0, 0),
            floating: 0,
            crossings: 0,
            deepest: 0.0,
            lowest: Real::MAX,
            lowest_last: Real::MAX,
            finite: true,
        }
    }
}

/// Contacts of one step between bodies whose true surfaces are apart, in world space.
pub struct Ghosts(pub Vec<Vector>);

impl Audit {
    /// Looks at one step, from the poses before it to those after it.
    pub fn look(
        &mut self,
        scene: &Scene,
        stage: &Stage,
        before: &[Pose],
        after: &[Pose],
    ) -> Ghosts {
        self.finite &= after.iter().all(|pose| pose.is_finite());
        if !self.finite {
            return Ghosts(Vec::new());
        }
        let moving = after.iter().enumerate().filter(|(b, _)| scene.moves(*b));
        let heights = moving.map(|(body, pose)| scene.lowest(body, pose));
        self.lowest_last = heights.fold(Real::MAX, Real::min);
        self.lowest = self.lowest.min(self.lowest_last);
        for body2 in 1..after.len() {
            for body1 in (0..body2).filter(|b| scene.moves(*b) || scene.moves(body2)) {
                let [lines1, lines2] = [body1, body2].map(|b| &scene.actors[b].model.skeleton);
                let paths = [body1, body2].map(|b| [before[b], after[b]]);
                self.crossings += lines1.crosses(paths[0], lines2, paths[1]) as usize;
                let overlap = lines1.overlap(&after[body1], lines2, &after[body2]);
                self.deepest = self.deepest.max(overlap);
            }
        }
        self.find_ghosts(scene, stage, before)
    }

    /// The narrow phase worked on the poses before the step.
    fn find_ghosts(&mut self, scene: &Scene, stage: &Stage, before: &[Pose]) -> Ghosts {
        self.last = (0, 0);
        let mut ghosts = Vec::new();
        for pair in stage.world.narrow_phase.contact_pairs() {
            let handles = [pair.collider1, pair.collider2];
            let [Some(body1), Some(body2)] = handles.map(|c| stage.actor_of(c)) else {
                continue;
            };
            let Some(collider) = stage.world.colliders.get(pair.collider1) else {
                continue;
            };
            let place = collider
                .position_wrt_parent()
                .map_or(before[body1], |local| before[body1] * *local);
            let points = pair.manifolds().iter().flat_map(|manifold| {
                let pose = manifold
                    .subshape_pos1()
                    .map_or(place, |local| place * local);
                let deep = manifold.points.iter().filter(|point| point.dist <= 0.0);
                deep.map(move |point| pose.transform_point(point.local_p1))
            });
            let points: Vec<Vector> = points.collect();
            if points.is_empty() {
                continue;
            }
            self.last.0 += 1;
            if !scene.near(body1, &before[body1], body2, &before[body2]) {
                self.last.1 += 1;
                ghosts.extend(points);
            }
        }
        self.contacts += self.last.0;
        self.ghosts += self.last.1;
        Ghosts(ghosts)
    }

    /// Counts the moving bodies that touch nothing. To be called with the last poses.
    pub fn count_floating(&mut self, scene: &Scene, poses: &[Pose]) {
        let floats = |&body: &usize| {
            let mut others = (0..poses.len()).filter(|other| *other != body);
            scene.moves(body)
                && scene.lowest(body, &poses[body]) > scene.touching_distance(body)
                && !others.any(|other| scene.near(body, &poses[body], other, &poses[other]))
        };
        self.floating = (0..poses.len()).filter(floats).count();
    }

    /// The checks that failed, in words: all bodies above the ground, none through another.
    pub fn failures(&self) -> Vec<String> {
        let mut failures = Vec::new();
        if !self.finite {
            failures.push("a body has a pose that is not finite".to_string());
        }
        if self.lowest < -0.02 {
            failures.push(format!("a body is {} m under the ground", -self.lowest));
        }
        if self.floating > 0 {
            failures.push(format!("{} bodies float in the air", self.floating));
        }
        if self.deepest > 0.5 {
            let share = 100.0 * self.deepest;
            failures.push(format!("two bodies overlap by {share:.0} % of their radii"));
        }
        if self.crossings > 0 {
            failures.push(format!("inner lines crossed {} times", self.crossings));
        }
        failures
    }
}

impl Scene {
    /// Whether a body is dynamic.
    fn moves(&self, body: usize) -> bool {
        self.actors[body].start.body_type == RigidBodyType::Dynamic
    }

    /// Height of a body's lowest vertex.
    fn lowest(&self, body: usize, pose: &Pose) -> Real {
        let vertices = self.actors[body].model.mesh.vertices.iter();
        let heights = vertices.map(|v| pose.transform_point(*v).y);
        heights.fold(Real::MAX, Real::min)
    }

    fn touching_distance(&self, body: usize) -> Real {
        let (low, high) = self.actors[body].model.mesh.bounds();
        APART_SHARE * (high - low).max_element()
    }

    /// Whether the triangles of two bodies are near enough to touch.
    pub fn near(&self, body1: usize, pose1: &Pose, body2: usize, pose2: &Pose) -> bool {
        let [surface1, surface2] = [body1, body2].map(|b| &self.actors[b].model.surface);
        let limit = self
            .touching_distance(body1)
            .min(self.touching_distance(body2));
        let contact = query::contact(pose1, surface1, pose2, surface2, limit);
        contact.expect("triangle meshes are supported").is_some()
    }
}
