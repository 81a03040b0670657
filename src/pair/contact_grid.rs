//! A grid of the places of contacts, in which those at one place are found among thousands.

use super::SpherePair;
use crate::math::fast_hash::FastMap;
use crate::math::lane::Vec3;

/// No more contacts in a cell.
const END: u32 = u32::MAX;

/// Cells of contacts by their points on the first body. A contact is in the cells of all places where it has been.
pub(super) struct ContactGrid {
    /// Width of a cell, a length. Any serves, but a cell as wide as places may be apart is quick.
    width: f64,
    /// Place in `links` of each cell's last contact.
    cells: FastMap<[i32; 3], u32>,
    /// Contacts, each with the place of the next in its cell.
    links: Vec<(u32, u32)>,
    /// Number of contacts that are in the grid.
    len: usize,
}

impl ContactGrid {
    /// An empty grid of cells that are at least so wide, a length.
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

    /// The last of `contacts` for which `is_wanted`, of those no farther from `point` than `apart` (a length) along each
    /// axis. Contacts that were added since the last call come into the grid.
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
