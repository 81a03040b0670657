//! The contacts of two bodies while a search finds them: at most [`MOST`], the nearest ones.
//!
//! A body that is hardly larger than rapier's prediction distance has all its primitives within reach of the other's: two
//! creatures of 3 cm and 500 primitives each have 110,000 contacts within rapier's default of 2 cm, of which those that touch
//! are a handful. Once there are more than [`MOST`], the nearer half stays, and the search goes on for nearer ones only.

use super::SpherePair;
use crate::math::Real;
use crate::math::lane::Vec3;
use crate::math::tolerance::ONE_DIRECTION;

/// Contacts of two bodies, at most. A nut of 500 primitives on its bolt has 975.
const MOST: usize = 2048;

/// Contacts in the order in which they were found.
pub(super) struct ContactList {
    contacts: Vec<SpherePair>,
    /// Distance beyond which none is kept.
    limit: Real,
    /// Distance beyond which none need be searched for.
    margin: f64,
}

impl ContactList {
    /// An empty list of contacts within `prediction`, a length.
    pub(super) fn new(prediction: f64) -> Self {
        Self {
            contacts: Vec::new(),
            limit: Real::INFINITY,
            margin: prediction,
        }
    }

    /// The distance beyond which a contact is of no use. It decreases while the list fills, but not below 0: how deep
    /// primitives are whose medial surfaces cross is not told by their bounds.
    pub(super) fn margin(&self) -> f64 {
        self.margin
    }

    /// Adds a contact. Of those closer to each other than `apart`, a length, and of the same normal only the nearest
    /// stays. `point` and `normal` are the contact's, before rounding.
    pub(super) fn add(&mut self, contact: SpherePair, [point, normal]: [Vec3<f64>; 2], apart: f64) {
        if contact.distance > self.limit {
            return;
        }
        let same = self.contacts.iter_mut().rev().find(|c| {
            let along = f64::from(c.points[0].x) - point.x;
            along * along <= apart * apart
                && (Vec3::<f64>::from_vector(c.points[0]) - point).length_sq() <= apart * apart
                && Vec3::<f64>::from_vector(c.normal).dot(normal) >= ONE_DIRECTION
        });
        match same {
            None => self.extend([contact]),
            Some(c) if contact.distance < c.distance => *c = contact,
            Some(_) => {}
        }
    }

    /// Adds contacts of which none is at the place of another.
    pub(super) fn extend(&mut self, contacts: impl IntoIterator<Item = SpherePair>) {
        let limit = self.limit;
        self.contacts
            .extend(contacts.into_iter().filter(|c| c.distance <= limit));
        if self.contacts.len() > MOST {
            self.keep_nearer_half();
        }
    }

    fn keep_nearer_half(&mut self) {
        let mut distances: Vec<_> = self.contacts.iter().map(|c| c.distance).collect();
        let (nearer, &mut limit, _) =
            distances.select_nth_unstable_by(MOST / 2, |a, b| a.total_cmp(b));
        // Of those that are just as far as the limit, the first ones.
        let mut ties = MOST / 2 - nearer.iter().filter(|d| **d < limit).count();
        self.contacts.retain(|c| {
            let stays = c.distance < limit || c.distance == limit && ties > 0;
            ties -= usize::from(stays && c.distance == limit);
            stays
        });
        self.limit = limit;
        self.margin = self.margin.min(f64::from(limit).max(0.0));
    }

    /// The contacts, in the order in which they were found.
    pub(super) fn into_contacts(self) -> Vec<SpherePair> {
        self.contacts
    }
}
