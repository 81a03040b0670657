//! Every query of parry with every built-in shape, in both orders: answered, and right by the samples.

use crate::oracle::{COARSE_CUTS, ROUNDING, Samples, apart, stand_in};
use crate::rng::Rng;
use crate::rotating::{rotation, vector};
use crate::shapes::{every_shape, ring};
use parry3d::math::{Pose, Real, Vector};
use parry3d::query::details::ShapeCastOptions;
use parry3d::query::{
    ClosestPoints, ContactManifold, DefaultQueryDispatcher, NonlinearRigidMotion,
    PersistentQueryDispatcher, QueryDispatcher, Unsupported,
};
use parry3d::shape::Shape;
use rapier3d_medial::{MedialDispatcher, MedialMesh};

/// Poses per shape; each is asked in both orders.
const CASES: usize = 10;

/// Parts that an edge of the mesh is cut in.
const TABLE_CUTS: usize = 128;

/// How far beyond the distance contacts are asked for, in metres.
const PREDICTION: Real = 0.05;

struct Case<'a> {
    shapes: [&'a dyn Shape; 2],
    pos12: Pose,
    /// Whether the mesh comes second.
    flipped: bool,
    /// Where the true distance lies: `least..=most`, below 0 for overlap.
    least: Real,
    most: Real,
    /// Distance of a point to each shape, up to the error of the samples; the mesh's is negative inside.
    on: [&'a dyn Fn(Vector) -> Real; 2],
    /// Error of the samples, where a point is measured.
    error: Real,
}

type Verdict = Result<(), String>;

fn expect(holds: bool, what: impl FnOnce() -> String) -> Verdict {
    if holds { Ok(()) } else { Err(what()) }
}

fn is_turned(shape: &dyn Shape) -> bool {
    use parry3d::shape::ShapeType;
    matches!(
        shape.shape_type(),
        ShapeType::Cylinder | ShapeType::Cone | ShapeType::RoundCylinder | ShapeType::RoundCone
    )
}

fn unsupported(_: Unsupported) -> String {
    "unsupported".into()
}

impl Case<'_> {
    fn distance(&self, dispatcher: &impl QueryDispatcher) -> Verdict {
        let [g1, g2] = self.shapes;
        let d = dispatcher
            .distance(&self.pos12, g1, g2)
            .map_err(unsupported)?
            .distance;
        let (least, most) = (self.least.max(0.0), self.most.max(0.0));
        expect((least..=most).contains(&d), || {
            format!("{d}, not in {least}..{most}")
        })
    }

    fn intersection(&self, dispatcher: &impl QueryDispatcher) -> Verdict {
        let [g1, g2] = self.shapes;
        let found = dispatcher.intersection_test(&self.pos12, g1, g2);
        let found = found.map_err(unsupported)?.intersecting;
        expect(self.most >= 0.0 || found, || {
            format!("{} deep, none found", -self.most)
        })?;
        expect(self.least <= 0.0 || !found, || {
            format!("{} apart, one found", self.least)
        })
    }

    fn closest_points(&self, dispatcher: &impl QueryDispatcher) -> Verdict {
        let [g1, g2] = self.shapes;
        let ask = |max: Real| {
            let answer = dispatcher.closest_points(&self.pos12, g1, g2, max);
            answer.map_err(unsupported)
        };
        match ask(self.most.max(0.0) + PREDICTION)? {
            ClosestPoints::Disjoint => return Err(format!("disjoint at {}", self.most)),
            ClosestPoints::Intersecting => {
                expect(self.least <= 0.0, || "intersecting".into())?;
            }
            ClosestPoints::WithinMargin(p1, p2) => {
                let d = (self.pos12 * p2 - p1).length();
                expect((self.least..=self.most.max(0.0)).contains(&d), || {
                    format!("{d}, not in {}..{}", self.least, self.most)
                })?;
                self.on_both([p1, p2])?;
            }
        }
        if self.least > 0.02 {
            let near = ask(self.least * 0.5)?;
            expect(near == ClosestPoints::Disjoint, || format!("{near:?}"))?;
        }
        Ok(())
    }

    fn contact(&self, dispatcher: &impl QueryDispatcher) -> Verdict {
        let [g1, g2] = self.shapes;
        let ask = |reach: Real| {
            let answer = dispatcher.contact(&self.pos12, g1, g2, reach);
            answer.map_err(unsupported)
        };
        let Some(c) = ask(self.most.max(0.0) + PREDICTION)? else {
            return Err(format!("none at {}", self.most));
        };
        // How deep a sphere is in a cylinder or cone is a search that ends early at times.
        let turned = self.shapes.iter().any(|g| is_turned(*g));
        let most = if turned && self.most < 0.0 {
            0.0
        } else {
            self.most
        };
        expect(c.dist <= most, || format!("{}, over {most}", c.dist))?;
        if self.least > 0.0 {
            expect(c.dist >= self.least, || {
                format!("{}, below {}", c.dist, self.least)
            })?;
            self.on_both([c.point1, c.point2])?;
            let far = ask(self.least * 0.5)?;
            expect(far.is_none(), || {
                format!("{far:?} beyond half of {}", self.least)
            })?;
        }
        let n2 = self.pos12.rotation * c.normal2;
        let gap = self.pos12 * c.point2 - c.point1;
        let sound = (c.normal1.length() - 1.0).abs() < 1.0e-4
            && (c.normal1 + n2).length() < 1.0e-3
            && (gap.dot(c.normal1) - c.dist).abs() < ROUNDING;
        expect(sound, || format!("{c:?}, gap {gap}"))
    }

    fn manifolds(&self, dispatcher: &impl PersistentQueryDispatcher<(), ()>) -> Verdict {
        let [g1, g2] = self.shapes;
        let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
        let reach = self.most.max(0.0) + PREDICTION;
        dispatcher
            .contact_manifolds(&self.pos12, g1, g2, reach, &mut manifolds, &mut None)
            .map_err(unsupported)?;
        let mut deepest = Real::MAX;
        for m in &manifolds {
            let moved = |p: Option<&Pose>, v: Vector| p.map_or(v, |p| p * v);
            for p in &m.points {
                let p1 = moved(m.subshape_pos1(), p.local_p1);
                let p2 = self.pos12 * moved(m.subshape_pos2(), p.local_p2);
                let n1 = m
                    .subshape_pos1()
                    .map_or(m.local_n1, |q| q.rotation * m.local_n1);
                let gap = (p2 - p1).dot(n1);
                expect((gap - p.dist).abs() < ROUNDING, || {
                    format!("{gap} along the normal, but {}", p.dist)
                })?;
                deepest = deepest.min(p.dist);
            }
        }
        // Points of a manifold bound the distance from above.
        expect(self.least <= 0.0 || deepest >= self.least, || {
            format!("{deepest}, below {}", self.least)
        })?;
        // parry finds no manifold with voxels that do not touch, whatever the reach.
        let voxels = self.shapes.iter().any(|g| g.as_voxels().is_some());
        let apart = voxels && self.most > 0.0;
        expect(apart || deepest <= reach, || {
            format!("none at {}", self.most)
        })
    }

    fn casts(&self, dispatcher: &impl QueryDispatcher) -> Verdict {
        let [g1, g2] = self.shapes;
        let velocity = -self.pos12.translation;
        let options = ShapeCastOptions::default();
        let straight = dispatcher.cast_shapes(&self.pos12, velocity, g1, g2, options);
        let still = NonlinearRigidMotion::identity();
        let moving = NonlinearRigidMotion {
            linvel: velocity,
            ..NonlinearRigidMotion::constant_position(self.pos12)
        };
        let turned = dispatcher.cast_shapes_nonlinear(&still, g1, &moving, g2, 0.0, 9.0, true);
        for hit in [straight, turned] {
            let hit = hit.map_err(unsupported)?;
            let at_start = hit.is_some_and(|h| h.time_of_impact == 0.0);
            expect(self.most >= 0.0 || at_start, || format!("{hit:?} inside"))?;
            expect(self.least <= 0.01 || !at_start, || format!("{hit:?} apart"))?;
        }
        Ok(())
    }

    /// Points in each shape's own frame lie on that shape.
    fn on_both(&self, points: [Vector; 2]) -> Verdict {
        for k in [0, 1] {
            let off = self.on[k](points[k]);
            let on = off.abs() <= self.error + 2.0 * ROUNDING;
            expect(on, || format!("point {} is {off} off", k + 1))?;
        }
        Ok(())
    }
}

#[test]
fn every_query_with_every_shape_in_both_orders_is_answered_and_right() {
    let mesh = ring();
    let fine = Samples::new(&mesh, TABLE_CUTS);
    let coarse = Samples::new(&mesh, COARSE_CUTS);
    let dispatcher = MedialDispatcher::default().chain(DefaultQueryDispatcher);
    let mut failures = Vec::new();
    let mut overlaps = 0;
    let mut cases = 0;
    for (i, (name, shape, aim)) in every_shape().iter().enumerate() {
        let measured = stand_in(shape);
        let medial = shape.as_shape::<MedialMesh>().is_some();
        let on_mesh = |p: Vector| fine.distance_to_point(p);
        let on_shape = |p: Vector| match medial {
            true => coarse.distance_to_point(p),
            false => apart(measured.as_ref(), p),
        };
        let mut rng = Rng::new(900 + i as u64);
        for round in 0..CASES {
            let at = vector(rng.in_ball() * (0.8 * aim));
            let pose = Pose::from_parts(at, rotation(&mut rng));
            let sampled = fine.distance(&pose.inverse(), 100.0, &on_shape);
            let error = fine.error + if medial { coarse.error } else { 0.0 };
            overlaps += usize::from(sampled < 0.0);
            cases += 1;
            for flipped in [false, true] {
                let (mesh, shape): (&dyn Shape, &dyn Shape) = (&mesh, shape.as_ref());
                let case = Case {
                    shapes: if flipped {
                        [shape, mesh]
                    } else {
                        [mesh, shape]
                    },
                    pos12: if flipped { pose.inverse() } else { pose },
                    flipped,
                    least: sampled - error - ROUNDING,
                    most: sampled + ROUNDING,
                    on: if flipped {
                        [&on_shape, &on_mesh]
                    } else {
                        [&on_mesh, &on_shape]
                    },
                    error,
                };
                let verdicts = [
                    ("distance", case.distance(&dispatcher)),
                    ("intersection", case.intersection(&dispatcher)),
                    ("closest points", case.closest_points(&dispatcher)),
                    ("contact", case.contact(&dispatcher)),
                    ("manifolds", case.manifolds(&dispatcher)),
                    ("casts", case.casts(&dispatcher)),
                ];
                for (query, verdict) in verdicts {
                    if let Err(e) = verdict {
                        let order = if case.flipped { "second" } else { "first" };
                        failures.push(format!("{query}, {name}, mesh {order}, {round}: {e}"));
                    }
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert!(
        (cases * 3 / 10..=cases * 7 / 10).contains(&overlaps),
        "{overlaps} of {cases} overlap"
    );
}
