//! Chains of a multibody with limits, hanging or held out, struck at any link by balls lighter and heavier than a link:
//! beside rapier's capsules of the same sizes.

use crate::bodies::attached;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

const LENGTH: Real = 0.3;
const RADIUS: Real = 0.05;
const GRAVITY: Real = 9.81;

#[derive(Clone, Copy, Debug)]
struct Hung {
    links: usize,
    /// Radians either way.
    limit: Real,
    ball_joints: bool,
    /// Of the ball, kg and metres per second. A link has 2 kg.
    mass: Real,
    speed: Real,
    /// Where the ball strikes, in links from the hook, and by how many metres beside the middle.
    at: Real,
    aside: Real,
    /// Whether the chain hangs, or is held out level.
    hangs: bool,
}

impl Hung {
    /// All with balls of some masses.
    fn all(masses: &[Real]) -> Vec<Self> {
        let mut all = Vec::new();
        for (i, &mass) in masses.iter().enumerate() {
            for links in 2..=6 {
                for (k, limit) in [0.1, 0.5, 1.2].into_iter().enumerate() {
                    for (n, speed) in [5.0, 20.0, 60.0].into_iter().enumerate() {
                        for ball_joints in [false, true] {
                            let place = (i + links + k + n) % 3;
                            let last = links as Real;
                            all.push(Self {
                                links,
                                limit,
                                ball_joints,
                                mass,
                                speed,
                                at: [0.6, 0.5 * last + 0.1, last - 0.3][place],
                                aside: [0.0, 0.02, 0.1][place],
                                hangs: (links + n) % 2 == 0,
                            });
                        }
                    }
                }
            }
        }
        all
    }

    /// The energy that came in after 12 steps at most, in units of the ball's at the start; infinite once anything is
    /// no number.
    fn most_gained(self, medial: bool) -> f64 {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::NEG_Y * GRAVITY;
        let mut pipeline = attached(&mut world);
        let (along, way) = match self.hangs {
            true => (Vector::NEG_Y, Vector::NEG_X),
            false => (Vector::X, Vector::NEG_Y),
        };
        let mut last = world.insert_body(RigidBodyBuilder::fixed());
        for k in 0..self.links {
            let end = along * (0.5 * LENGTH - RADIUS - 0.005);
            let collider = match medial {
                true => ColliderBuilder::medial_mesh(
                    MedialMesh::capsule(-end, end, RADIUS).expect("a link"),
                ),
                false => ColliderBuilder::capsule_from_endpoints(-end, end, RADIUS),
            };
            let at = along * (LENGTH * (k as Real + 0.5));
            let body = RigidBodyBuilder::dynamic().translation(at);
            let (link, _) = world.insert(body, collider.density(1000.0));
            let anchors = [
                along * (if k == 0 { 0.0 } else { 0.5 * LENGTH }),
                along * (-0.5 * LENGTH),
            ];
            world.insert_multibody_joint(last, link, self.joint(anchors));
            last = link;
        }
        let back = 0.1 + RADIUS + 0.01 + self.speed / 60.0 * 1.37;
        let at = along * (LENGTH * self.at) - way * back + Vector::Z * self.aside;
        let ball = RigidBodyBuilder::dynamic()
            .translation(at)
            .linvel(way * self.speed)
            .gravity_scale(0.0)
            .ccd_enabled(!medial);
        world.insert(ball, ColliderBuilder::ball(0.1).mass(self.mass));
        let energy = |world: &PhysicsWorld| -> f64 {
            let of = |b: &RigidBody| {
                let height = b.center_of_mass().y * b.gravity_scale();
                f64::from(b.kinetic_energy()) + f64::from(b.mass() * GRAVITY * height)
            };
            let dynamic = world.bodies.iter().filter(|(_, b)| b.is_dynamic());
            dynamic.map(|(_, b)| of(b)).sum()
        };
        let start = energy(&world);
        let came = 0.5 * f64::from(self.mass * self.speed * self.speed);
        let mut most: f64 = 0.0;
        for _ in 0..12 {
            if medial {
                pipeline.step(&mut world);
            } else {
                world.step();
            }
            let gained = (energy(&world) - start) / came;
            most = most.max(if gained.is_finite() {
                gained
            } else {
                f64::INFINITY
            });
        }
        most
    }

    fn joint(self, [first, second]: [Vector; 2]) -> GenericJoint {
        let range = [-self.limit, self.limit];
        if self.ball_joints {
            return SphericalJointBuilder::new()
                .local_anchor1(first)
                .local_anchor2(second)
                .limits(JointAxis::AngZ, range)
                .limits(JointAxis::AngX, range)
                .into();
        }
        RevoluteJointBuilder::new(Vector::Z)
            .local_anchor1(first)
            .local_anchor2(second)
            .limits(range)
            .into()
    }
}

/// Balls of a tenth of a link's mass and of its mass: nothing gains energy or leaves all numbers. Of rapier's own
/// chains some do.
#[test]
fn struck_chains_with_limits_gain_no_energy() {
    let all = Hung::all(&[0.2, 2.0]);
    let own = all.iter().filter(|h| h.most_gained(false) > 0.02).count();
    for &hung in &all {
        let gained = hung.most_gained(true);
        assert!(gained < 0.02, "{hung:?}: {gained} of the ball's energy");
    }
    println!(
        "{} chains: none of ours gains, of rapier's own {own}",
        all.len()
    );
}

/// Balls of ten links: where one of ours leaves all numbers, rapier's own does too, and of ten of those one at most.
#[test]
fn chains_struck_by_heavy_balls_leave_all_numbers_where_rapiers_do() {
    let (mut ours, mut own) = (0, 0);
    let all = Hung::all(&[20.0]);
    for &hung in &all {
        let [of_ours, of_own] = [true, false].map(|medial| hung.most_gained(medial));
        assert!(
            of_ours < 0.02 || of_ours == f64::INFINITY,
            "{hung:?}: {of_ours} of the ball's energy"
        );
        assert!(of_ours.is_finite() || of_own == f64::INFINITY, "{hung:?}");
        ours += usize::from(of_ours == f64::INFINITY);
        own += usize::from(of_own == f64::INFINITY);
    }
    println!(
        "{} chains: {ours} leave all numbers, of rapier's own {own}",
        all.len()
    );
    assert!(10 * ours <= own, "{ours}, of rapier's own {own}");
}
