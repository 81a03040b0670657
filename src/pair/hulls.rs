//! Lower bounds of the distance of two nodes' hulls at fixed poses, for the search for contacts
//! ([`super::contacts()`]) and for the distance (`distance.rs`). Each hull is placed once, however often it is asked
//! for.

use super::apart::{Balls, Plane, approached};
use super::contact_list::ContactList;
use super::face_contacts::{add_nearest, face_contacts};
use super::first_contact::Counts;
use super::hull_gap::{HullGap, PlacedHull, hull_gap};
use super::piece_contact::PieceGap;
use super::placement::Placement;
use super::primitive_pair::PrimitivePair;
use super::primitive_tree::{PrimitiveTree, thickness};
use super::sphere_pair::SpherePair;
use crate::elementary::penetration::gap_along;
use crate::math::Vector;
use crate::math::fast_hash::FastMap;
use crate::math::lane::Vec3;
use crate::math::tolerance::F64_ROUNDING;
use crate::medial::MedialSphere;
use crate::medial::tree::NodeKind;

/// Depth of a convex piece in its partner, in units of the thickness of the thinner, from which its contacts are
/// filtered: with a primitive or a piece of a medial mesh, those that point into it are left out; with another shape,
/// those that do not push it the shortest way out (`parry/corrections/deep_pieces.rs`). Larger, and a body may stay
/// where such contacts hold it; smaller, and more pairs are computed without the tree.
pub(crate) const FILTER_DEPTH: f64 = 0.25;

/// How much deeper two hulls may be along a contact's normal than along the best direction. At 1 a capsule that lies on
/// two faces of a box would have one contact; larger, and contacts through the whole of a piece count.
const OUTWARD_DEPTH_RATIO: f64 = 2.0;

/// Primitives below a node.
fn below(body: &impl PrimitiveTree, node: u32) -> Vec<u32> {
    let mut found = Vec::new();
    let mut stack = vec![node];
    while let Some(node) = stack.pop() {
        match body.kind(node) {
            NodeKind::Primitive(p) => found.push(p),
            NodeKind::Nodes(first, second) => stack.extend([second, first]),
        }
    }
    found
}

/// The hull of a node at a fixed pose, with what each look at it would compute again.
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
    let rounding = F64_ROUNDING * (a.size + b.size);
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
    placed: [PlacedHulls; 2],
    /// Convex pieces that were asked for, by their nodes.
    pieces: [FastMap<u32, PlacedHull<'a>>; 2],
}

/// The hulls of one body that are placed already, because they were asked for.
#[derive(Default)]
struct PlacedHulls {
    /// One more than the place of each node's hull; 0 where it was not asked for.
    places: Vec<u32>,
    hulls: Vec<Resting>,
}

impl PlacedHulls {
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
            pieces: Default::default(),
        }
    }

    /// Contacts of two nodes that hold convex pieces within `margin` of each other; `None` where they do not, or may
    /// have contacts that their primitives have to tell.
    pub(super) fn pieces_contacts(
        &mut self,
        [i, j]: [u32; 2],
        margin: f64,
        counts: &mut Counts,
    ) -> Option<Vec<SpherePair>> {
        let (first, second) = self.bodies;
        let pieces = [first.convex_piece(i), second.convex_piece(j)];
        let is_piece = pieces.iter().any(Option::is_some);
        if !(is_piece && first.is_convex(i) && second.is_convex(j)) {
            return None;
        }
        let place = self.place;
        let hulls = self.pieces([i, j]);
        match pieces {
            [Some(p), Some(q)] => {
                let primitives = [p.primitive, q.primitive];
                Some(face_contacts(hulls, primitives, place, margin))
            }
            _ => {
                let found = hull_gap(hulls, margin);
                if found.gap > margin {
                    return Some(Vec::new());
                }
                let thinner = thickness(first, i).min(thickness(second, j));
                let is_deep = found.gap < -FILTER_DEPTH * f64::from(thinner);
                is_deep.then(|| self.deep_contacts([i, j], found, margin, counts))
            }
        }
    }

    /// Distance of the convex pieces that two nodes hold, if they are within `margin` of each other and apart. Farther
    /// ones get a gap beyond the margin and no primitives.
    pub(super) fn pieces_nearest(&mut self, nodes: [u32; 2], margin: f64) -> Option<PieceGap> {
        let ((first, second), place) = (self.bodies, self.place);
        let pieces = [first.convex_piece(nodes[0]), second.convex_piece(nodes[1])];
        let is_piece = pieces.iter().any(Option::is_some);
        if !(is_piece && first.is_convex(nodes[0]) && second.is_convex(nodes[1])) {
            return None;
        }
        let hulls = self.pieces(nodes);
        let hull = hull_gap(hulls, margin);
        if hull.gap > margin {
            return Some(PieceGap::of(hull));
        }
        if hull.gap <= 0.0 {
            return None;
        }
        let taken_back = |p| Vec3::from_vector(place.inverse_point(p));
        Some(PieceGap::search(
            ((first, second), nodes),
            (hulls, hull),
            |k, p| [p, place.placed(p)][k],
            |k, p| [p, taken_back(p)][k],
        ))
    }

    /// Contacts of a convex piece and a primitive that are deep in each other: those of the piece's own primitives
    /// along which the two come apart about as soon as they can. Others point into the piece.
    fn deep_contacts(
        &mut self,
        nodes: [u32; 2],
        hull: HullGap,
        margin: f64,
        counts: &mut Counts,
    ) -> Vec<SpherePair> {
        let ((first, second), place) = (self.bodies, self.place);
        let below = [below(first, nodes[0]), below(second, nodes[1])];
        let mut found = ContactList::new(margin);
        for &p in &below[0] {
            for &q in &below[1] {
                let pair = PrimitivePair::new(first, second, [p, q], place);
                pair.contacts(&mut found, counts);
            }
        }
        let mut found = found.into_contacts();
        let hulls = self.pieces(nodes);
        found.retain(|contact| {
            let n = Vec3::from_vector(contact.normal);
            gap_along(&hulls[0].spheres, &hulls[1].spheres, n) >= OUTWARD_DEPTH_RATIO * hull.gap
        });
        let primitives = [
            first
                .convex_piece(nodes[0])
                .map_or(below[0][0], |p| p.primitive),
            second
                .convex_piece(nodes[1])
                .map_or(below[1][0], |p| p.primitive),
        ];
        add_nearest(hulls, (hull, primitives), place, &mut found);
        found
    }

    /// Two nodes' pieces, placed.
    fn pieces(&mut self, [i, j]: [u32; 2]) -> [&PlacedHull<'a>; 2] {
        let ((first, second), place) = (self.bodies, self.place);
        let [a, b] = &mut self.pieces;
        let a = (a.entry(i))
            .or_insert_with(|| PlacedHull::of_node(first, i, Vec3::from_vector, Vec3::from_vector));
        let b = (b.entry(j)).or_insert_with(|| {
            PlacedHull::of_node(second, j, |p| place.point(p), |n| place.direction(n))
        });
        [a, b]
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
