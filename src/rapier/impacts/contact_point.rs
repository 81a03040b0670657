//! Point where two bodies meet: their motions there, and the effect of an impulse there.

use crate::math::{Real, Vector};
use crate::rapier::impacts::hit::Hit;
use crate::rapier::impacts::impulse::{Impact, Material};
use crate::rapier::joints::rows::Twist;
use crate::rapier::joints::tied_system::System;
use crate::rapier::view::step_view::StepView;

/// A contact of two bodies at its time, in the world frame.
pub struct ContactPoint {
    bodies: [usize; 2],
    /// Where it is, world frame.
    pub position: Vector,
    /// Unit normal from the first body to the second.
    normal: Vector,
    /// Arms from the bodies' centres of mass to the point.
    arms: [Vector; 2],
    /// Velocities of the bodies' motions there, a length per second.
    motions: [Vector; 2],
}

impl ContactPoint {
    /// A point of a hit of two bodies.
    pub fn new(view: &StepView, bodies: [usize; 2], hit: &Hit, position: Vector) -> Self {
        let now = bodies.map(|b| view.bodies[b].motion_from(hit.time));
        let centers = [0, 1].map(|k| now[k].start * view.bodies[bodies[k]].mass.local_com);
        let mut point = Self {
            bodies,
            position,
            normal: hit.normal,
            arms: centers.map(|c| position - c),
            motions: [Vector::ZERO; 2],
        };
        // A carried body turns about its carrier's centre, not its own.
        point.motions = [0, 1].map(|k| {
            let m = &now[k];
            let arm = centers[k] - m.start * m.local_center;
            point.velocity([m.linvel + m.angvel.cross(arm), m.angvel], k)
        });
        point
    }

    /// Velocity there of body `k`, whose centre of mass moves so.
    pub fn velocity(&self, [linear, angular]: Twist, k: usize) -> Vector {
        linear + angular.cross(self.arms[k])
    }

    /// The fastest that points of two bodies so far from their centres move against each other, wherever they turn.
    pub fn greatest_speed(&self, [[v1, w1], [v2, w2]]: [Twist; 2]) -> Real {
        let [r1, r2] = self.arms.map(|arm| arm.length());
        (v2 - v1).length() + w1.length() * r1 + w2.length() * r2
    }

    /// Velocity of the motion of body `k` there.
    pub fn motion(&self, k: usize) -> Vector {
        self.motions[k]
    }

    /// Velocity of the second body's motion there against the first's.
    pub fn relative_motion(&self) -> Vector {
        self.motions[1] - self.motions[0]
    }

    /// An impulse there as a change of momentum and angular momentum of body `k`.
    pub fn wrench(&self, k: usize, impulse: Vector) -> Twist {
        [impulse, self.arms[k].cross(impulse)]
    }

    /// An impulse on the second body, and its opposite on the first.
    pub fn wrenches(&self, impulse: Vector) -> [(usize, Twist); 2] {
        [(0, -impulse), (1, impulse)].map(|(k, j)| (self.bodies[k], self.wrench(k, j)))
    }

    /// The impact there of bodies that joints tie together; `is_guided`: as [`Impact`] says.
    pub fn impact(&self, system: &System, material: Material, is_guided: bool) -> Impact {
        Impact {
            normal: self.normal,
            material,
            is_guided,
            response: Vector::AXES.map(|axis| {
                let change = system.change(&self.wrenches(axis));
                self.velocity(change[1], 1) - self.velocity(change[0], 0)
            }),
        }
    }
}
