//! The hulls of the nodes of two bodies at fixed poses, each placed once, and a lower bound of the distance of two.

use super::apart::{Balls, Plane, approached};
use super::placement::Placement;
use super::primitive_tree::PrimitiveTree;
use crate::math::Vector;
use crate::math::lane::Vec3;
use crate::math::tolerance::ROUNDING_ULPS;
use crate::medial::MedialSphere;
use crate::medial::tree::NodeKind;

/// A hull at rest, with what each look at it would compute again.
struct Resting {
    balls: Balls,
    middle: Vec3<f64>,
    core: f64,
    plane: Plane,
}

impl Resting {
    fn new(balls: Balls) -> Self {
        Self {
            middle: balls.middle(0.0),
            core: balls.core(),
            plane: balls.plane(0.0),
            balls,
        }
    }
}

/// A lower bound of the distance of two hulls at rest; as soon as it is more than `enough` no better one is looked for.
fn gap([first, second]: [&Resting; 2], enough: f64) -> f64 {
    let (a, b) = (&first.balls, &second.balls);
    let rounding = ROUNDING_ULPS * f64::EPSILON * (a.size + b.size);
    let y = second.middle - first.middle;
    // No direction says more.
    if y.length() - first.core - second.core <= enough {
        return f64::MIN;
    }
    let along = |n: Vec3<f64>| {
        let length = n.length();
        if length <= 0.0 {
            return f64::MIN;
        }
        let far = a.all().iter().map(|s| n.dot(s.0) + length * s.2);
        let near = b.all().iter().map(|s| n.dot(s.0) - length * s.2);
        let gap = near.fold(f64::MAX, f64::min) - far.fold(f64::MIN, f64::max);
        gap / length - rounding
    };
    let mut most = along(approached(first.plane, second.plane, y));
    // Flat faces keep slabs apart that lie side by side.
    if most <= enough {
        for n in [a.face(0.0, y), b.face(0.0, -y).map(|n| -n)] {
            if most > enough {
                break;
            }
            most = n.map_or(most, |n| most.max(along(n)));
        }
    }
    most
}

/// Hulls of two bodies' nodes in the frame of the first.
pub(super) struct Hulls<'a, A, B> {
    bodies: (&'a A, &'a B),
    place: &'a Placement,
    placed: [Placed; 2],
}

/// The hulls of one body that were asked for.
#[derive(Default)]
struct Placed {
    /// One more than the place of each node's hull; 0 where it was not asked for.
    places: Vec<u32>,
    hulls: Vec<Resting>,
}

impl Placed {
    fn get(
        &mut self,
        body: &impl PrimitiveTree,
        node: u32,
        place: impl Fn(Vector) -> Vec3<f64>,
    ) -> u32 {
        let at = node as usize;
        if self.places.len() <= at {
            self.places.resize(at + 1, 0);
        }
        if self.places[at] == 0 {
            let (spheres, len) = body.hull(node);
            let ball = |s: &MedialSphere| (place(s.center), Vec3::zero(), f64::from(s.radius));
            let hull = Balls::new(spheres[..len].iter().map(ball), 0.0);
            self.hulls.push(Resting::new(hull));
            self.places[at] = self.hulls.len() as u32;
        }
        self.places[at] - 1
    }
}

impl<'a, A: PrimitiveTree, B: PrimitiveTree> Hulls<'a, A, B> {
    pub(super) fn new(bodies: (&'a A, &'a B), place: &'a Placement) -> Self {
        Self {
            bodies,
            place,
            placed: Default::default(),
        }
    }

    /// A lower bound of the distance of what is below two nodes, as [`gap`]. Two cones are not looked at: their one
    /// elementary test takes no longer.
    pub(super) fn gap(&mut self, [i, j]: [u32; 2], enough: f64) -> f64 {
        let (first, second) = self.bodies;
        if let (NodeKind::Primitive(p), NodeKind::Primitive(q)) = (first.kind(i), second.kind(j))
            && first
                .primitive(p)
                .1
                .spheres
                .max(second.primitive(q).1.spheres)
                < 3
        {
            return f64::MIN;
        }
        let place = self.place;
        let [a, b] = &mut self.placed;
        let p = a.get(first, i, Vec3::from_vector) as usize;
        let q = b.get(second, j, |point| place.point(point)) as usize;
        gap([&a.hulls[p], &b.hulls[q]], enough)
    }
}
