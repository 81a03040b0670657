//! What the true shapes say about a run. Nothing here asks the colliders how they are shaped.

use super::scene::{Scene, Stage};
use rapier3d::parry::query;
use rapier3d::prelude::{ContactPair, Pose, Real};

/// Bodies that touch are no further apart, on their true surfaces, than this share of a ring's
/// longest side.
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
    /// Rings that touch nothing in the end: not the ground, no other body.
    pub floating: usize,
    /// How often the inner lines of two bodies crossed within a step: one body passed into or
    /// through another.
    pub crossings: usize,
    /// Deepest overlap of two bodies, as a share of their two radii (1: inner lines meet).
    pub deepest: Real,
    /// Lowest vertex of a ring; the ground is at 0.
    pub lowest: Real,
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
            finite: true,
        }
    }
}

impl Audit {
    /// Looks at one step, from the poses before it to those after it.
    pub fn look(&mut self, scene: &Scene, stage: &Stage, before: &[Pose], after: &[Pose]) {
        self.finite &= after.iter().all(|pose| pose.is_finite());
        if !self.finite {
            return;
        }
        for (ring, pose) in after.iter().enumerate().take(scene.starts.len()) {
            self.lowest = self.lowest.min(scene.lowest(ring, pose));
        }
        for body2 in 1..after.len() {
            for body1 in 0..body2 {
                let (lines1, lines2) = (&scene.model(body1).skeleton, &scene.model(body2).skeleton);
                let paths = [body1, body2].map(|b| [before[b], after[b]]);
                self.crossings += lines1.crosses(paths[0], lines2, paths[1]) as usize;
                let overlap = lines1.overlap(&after[body1], lines2, &after[body2]);
                self.deepest = self.deepest.max(overlap);
            }
        }
        self.count_ghosts(scene, stage, before);
    }

    /// The narrow phase worked on the poses before the step.
    fn count_ghosts(&mut self, scene: &Scene, stage: &Stage, before: &[Pose]) {
        self.last = (0, 0);
        for pair in stage
            .world
            .narrow_phase
            .contact_pairs()
            .filter(|p| touches(p))
        {
            let bodies = [pair.collider1, pair.collider2].map(|c| stage.body_of(c));
            let [Some(body1), Some(body2)] = bodies else {
                continue;
            };
            let ghost = !scene.near(body1, &before[body1], body2, &before[body2]);
            self.last.0 += 1;
            self.last.1 += ghost as usize;
        }
        self.contacts += self.last.0;
        self.ghosts += self.last.1;
    }

    /// Counts the rings that touch nothing. To be called with the last poses.
    pub fn count_floating(&mut self, scene: &Scene, poses: &[Pose]) {
        let floats = |ring: &usize| {
            let lowest = scene.lowest(*ring, &poses[*ring]);
            let others = (0..poses.len()).filter(|other| other != ring);
            lowest > scene.touching_distance()
                && !others
                    .into_iter()
                    .any(|other| scene.near(*ring, &poses[*ring], other, &poses[other]))
        };
        self.floating = (0..scene.starts.len()).filter(floats).count();
    }

    /// The checks that failed, in words: all bodies above the ground, none through another.
    pub fn failures(&self) -> Vec<String> {
        let mut failures = Vec::new();
        if !self.finite {
            failures.push("a body has a pose that is not finite".to_string());
        }
        if self.lowest < -0.02 {
            failures.push(format!("a ring is {} m under the ground", -self.lowest));
        }
        if self.floating > 0 {
            failures.push(format!("{} rings float in the air", self.floating));
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
    /// Height of a body's lowest vertex.
    fn lowest(&self, body: usize, pose: &Pose) -> Real {
        let vertices = self.model(body).mesh.vertices.iter();
        let heights = vertices.map(|v| pose.transform_point(*v).y);
        heights.fold(Real::MAX, Real::min)
    }

    fn touching_distance(&self) -> Real {
        let (low, high) = self.ring.mesh.bounds();
        APART_SHARE * (high - low).max_element()
    }

    /// Whether the triangles of two bodies are near enough to touch.
    fn near(&self, body1: usize, pose1: &Pose, body2: usize, pose2: &Pose) -> bool {
        let [surface1, surface2] = [body1, body2].map(|b| &self.model(b).surface);
        let contact = query::contact(pose1, surface1, pose2, surface2, self.touching_distance());
        contact.expect("triangle meshes are supported").is_some()
    }
}

fn touches(pair: &ContactPair) -> bool {
    let mut points = pair.manifolds().iter().flat_map(|m| &m.points);
    points.any(|point| point.dist <= 0.0)
}
