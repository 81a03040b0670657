//! What the true shapes say about a run. Nothing here asks the colliders how they are shaped.

use super::scene::{Scene, Stage};
use rapier3d::parry::query;
use rapier3d::prelude::{ContactPair, Pose, Real};

/// Contacts further apart on the true surfaces than this share of a ring's longest side are ghosts.
pub const GHOST_SHARE: Real = 0.01;

/// Findings over all steps of a run.
#[derive(Clone, Copy, Debug)]
pub struct Audit {
    /// Pairs of bodies that touch, summed over the steps.
    pub contacts: usize,
    /// Those of them whose true surfaces are apart.
    pub ghosts: usize,
    /// Contacts and ghosts in the last step.
    pub last: (usize, usize),
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
        for (body, pose) in after.iter().enumerate().take(scene.starts.len()) {
            let vertices = &scene.model(body).mesh.vertices;
            let heights = vertices.iter().map(|v| pose.transform_point(*v).y);
            self.lowest = heights.fold(self.lowest, Real::min);
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
        let (low, high) = scene.ring.mesh.bounds();
        let apart = GHOST_SHARE * (high - low).max_element();
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
            let [surface1, surface2] = [body1, body2].map(|b| &scene.model(b).surface);
            let near = query::contact(&before[body1], surface1, &before[body2], surface2, apart);
            self.last.0 += 1;
            self.last.1 += matches!(near, Ok(None)) as usize;
        }
        self.contacts += self.last.0;
        self.ghosts += self.last.1;
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
        if self.crossings > 0 {
            failures.push(format!("inner lines crossed {} times", self.crossings));
        }
        if self.deepest > 0.5 {
            failures.push(format!(
                "two bodies overlap by {:.2} of their radii",
                self.deepest
            ));
        }
        failures
    }
}

fn touches(pair: &ContactPair) -> bool {
    let mut points = pair.manifolds().iter().flat_map(|m| &m.points);
    points.any(|point| point.dist <= 0.0)
}
