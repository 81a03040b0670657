//! The contacts of two bodies while a search finds them. Of very many, those that do not touch are dropped.
//!
//! A body that is hardly larger than rapier's prediction distance has all its primitives within reach of the other's:
//! two creatures of 3 cm and 500 primitives each have 110,000 contacts within rapier's default of 2 cm, of which those
//! that touch are a handful. Once there are more than [`MAX_CONTACTS`], the nearer half stays, with all that nearly
//! touch, and the search goes on for nearer ones only. What nearly touches is never dropped: of two plates of many
//! slabs that lie on each other, the nearer half may be that of one side.

use super::SpherePair;
use super::contact_grid::ContactGrid;
use crate::math::Real;
use crate::math::lane::Vec3;
use crate::math::tolerance::ONE_DIRECTION;

/// Number of contacts from which the farther ones are dropped. A nut of 500 primitives on its bolt has 975.
const MAX_CONTACTS: usize = 2048;

/// Distance, as a share of the prediction distance, up to which a contact nearly touches.
const TOUCHING: Real = 0.125;

/// Number of contacts up to which those at one place are looked for one by one.
const FEW: usize = 64;

/// Least width of a cell of the grid of places, as a share of the prediction distance.
const CELL: f64 = 0.01;

/// Contacts in the order in which they were found.
pub(super) struct ContactList {
    contacts: Vec<SpherePair>,
    /// Their places, once they are more than a few.
    grid: ContactGrid,
    /// Distance beyond which none is kept.
    limit: Real,
    /// Distance beyond which none need be searched for.
    margin: f64,
    /// Distance up to which all are kept.
    touching: Real,
    /// Number of contacts from which the farther ones are dropped.
    most: usize,
}

impl ContactList {
    /// An empty list of contacts within `prediction`, a length.
    pub(super) fn new(prediction: f64) -> Self {
        Self {
            contacts: Vec::new(),
            grid: ContactGrid::new(CELL * prediction),
            limit: Real::INFINITY,
            margin: prediction,
            touching: TOUCHING * prediction.max(0.0) as Real,
            most: MAX_CONTACTS,
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
        let is_same = |c: &SpherePair| {
            let along = f64::from(c.points[0].x) - point.x;
            along * along <= apart * apart
                && (Vec3::<f64>::from_vector(c.points[0]) - point).length_sq() <= apart * apart
                && Vec3::<f64>::from_vector(c.normal).dot(normal) >= ONE_DIRECTION
        };
        let contacts = &mut self.contacts;
        let is_many = contacts.len() > FEW;
        let same = match is_many {
            true => self.grid.last_near(contacts, point, apart, is_same),
            false => contacts.iter().rposition(is_same),
        };
        match same {
            None => self.extend([contact]),
            Some(k) if contact.distance < contacts[k].distance => {
                contacts[k] = contact;
                if is_many {
                    self.grid.put(k, &contact);
                }
            }
            Some(_) => {}
        }
    }

    /// Adds contacts of which none is at the place of another.
    pub(super) fn extend(&mut self, contacts: impl IntoIterator<Item = SpherePair>) {
        let limit = self.limit;
        self.contacts
            .extend(contacts.into_iter().filter(|c| c.distance <= limit));
        if self.contacts.len() > self.most {
            self.keep_nearer_half();
        }
    }

    fn keep_nearer_half(&mut self) {
        let mut distances: Vec<_> = self.contacts.iter().map(|c| c.distance).collect();
        let half = distances.len() / 2;
        let (_, &mut middle, _) = distances.select_nth_unstable_by(half, |a, b| a.total_cmp(b));
        self.limit = middle.max(self.touching);
        let limit = self.limit;
        self.contacts.retain(|c| c.distance <= limit);
        self.grid.clear();
        self.margin = self.margin.min(f64::from(limit));
        self.most = MAX_CONTACTS.max(2 * self.contacts.len());
    }

    /// The contacts, in the order in which they were found.
    pub(super) fn into_contacts(self) -> Vec<SpherePair> {
        self.contacts
    }
}
