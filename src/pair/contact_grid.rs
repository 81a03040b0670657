//! A grid of the places of contacts, in which those at one place are found among thousands.

use super::SpherePair;
use crate::math::fast_hash::FastMap;
use crate::math::lane::Vec3;

/// Marks the end of the list of contacts in a cell.
const END: u32 = u32::MAX;

/// Cells of contacts by their points on the first body. A contact is in the cells of all places where it has been.
pub(super) struct ContactGrid {
    /// Width of a cell, a length: at least as far as places may be apart.
    width: f64,
    /// Place in `links` of each cell's last contact.
    cells: FastMap<[i32; 3], u32>,
    /// Contacts, each with the place of the next in its cell.
    links: Vec<(u32, u32)>,
    /// Number of contacts that are in the grid.
    len: usize,
}

impl ContactGrid {
    /// An empty grid of cells that are at least so wide, a length; they widen where places farther apart are asked for.
    pub(super) fn new(width: f64) -> Self {
        Self {
            width,
            cells: FastMap::default(),
            links: Vec::new(),
            len: 0,
        }
    }

    /// Forgets all contacts.
    pub(super) fn clear(&mut self) {
        self.cells.clear();
        self.links.clear();
        self.len = 0;
    }

    /// The last of `contacts` for which `is_wanted`, of those no farther from `point` than `apart` (a length) along
    /// each axis. Contacts that were added since the last call come into the grid.
    pub(super) fn last_near(
        &mut self,
        contacts: &[SpherePair],
        point: Vec3<f64>,
        apart: f64,
        is_wanted: impl Fn(&SpherePair) -> bool,
    ) -> Option<usize> {
        if apart > self.width {
            self.clear();
            self.width = 2.0 * apart;
        }
        for (k, contact) in contacts.iter().enumerate().skip(self.len) {
            self.put(k, contact);
        }
        self.len = contacts.len();
        let end = |sign: f64| self.cell([point.x, point.y, point.z].map(|x| x + sign * apart));
        let [from, to] = [end(-1.0), end(1.0)];
        let mut last = None;
        for x in from[0]..=to[0] {
            for y in from[1]..=to[1] {
                for z in from[2]..=to[2] {
                    let mut at = self.cells.get(&[x, y, z]).copied().unwrap_or(END);
                    while let Some(&(k, next)) = self.links.get(at as usize) {
                        let k = k as usize;
                        if last.is_none_or(|last| k > last) && is_wanted(&contacts[k]) {
                            last = Some(k);
                        }
                        at = next;
                    }
                }
            }
        }
        last
    }

    /// Puts a contact in the cell of its place.
    pub(super) fn put(&mut self, k: usize, contact: &SpherePair) {
        let cell = self.cell(contact.points[0].to_array().map(f64::from));
        let link = self.links.len() as u32;
        let next = self.cells.insert(cell, link).unwrap_or(END);
        self.links.push((k as u32, next));
    }

    fn cell(&self, place: [f64; 3]) -> [i32; 3] {
        place.map(|x| (x / self.width).floor() as i32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Real, Vector};

    /// Numbers in [0, 1) (SplitMix64).
    fn random(state: &mut u64) -> Real {
        *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (*state ^ (*state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        ((z ^ (z >> 27)) >> 40) as Real / (1u64 << 24) as Real
    }

    fn contact(place: Vector) -> SpherePair {
        SpherePair {
            primitives: [0; 2],
            feature: 0,
            distance: 0.0,
            normal: Vector::X,
            points: [place; 2],
        }
    }

    /// Contacts that are added, replaced by others beside them, and taken away: the last at each place is found as if
    /// all were looked at.
    #[test]
    fn the_last_contact_at_a_place_is_found() {
        let mut state = 26;
        let (mut found, mut contacts) = (0, Vec::new());
        let mut grid = ContactGrid::new(0.001);
        for k in 0..4000 {
            let mut place = || Vector::from([0; 3].map(|_: i32| random(&mut state) - 0.5));
            let place = place() * 0.2;
            let apart = [0.0, 0.002, 0.01, 0.03][k / 1000];
            let near = |c: &SpherePair| c.points[0].distance(place) <= apart as Real;
            let expected = contacts.iter().rposition(near);
            let point = Vec3::from_vector(place);
            let last = grid.last_near(&contacts, point, apart, near);
            assert_eq!(last, expected, "{k}");
            match last {
                Some(k) if k % 3 == 0 => {
                    contacts[k] = contact(place);
                    grid.put(k, &contacts[k]);
                }
                _ => contacts.push(contact(place)),
            }
            if k % 700 == 699 {
                contacts.retain(|c| c.points[0].x > -0.05);
                grid.clear();
            }
            found += usize::from(last.is_some());
        }
        assert!(found > 500, "{found}");
    }
}
