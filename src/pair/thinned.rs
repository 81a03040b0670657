//! Thins contacts out where a smooth body of many primitives has hundreds of them: of those at about one place under
//! about one normal the nearest stays.

use super::SpherePair;
use crate::math::Real;
use crate::math::fast_hash::FastMap;
use std::collections::hash_map::Entry;

/// Contacts that are left as they are: fewer cost less than they may tell.
const FEW: usize = 256;

/// Cells of unit normals along each axis in a unit of length: normals of one cell are within 12.5° of each other.
const NORMALS: Real = 8.0;

/// Leaves, of more than 256 contacts, the nearest of each cell of normals and of places on the first body, `apart` wide
/// (a length above 0), in the order in which they were.
pub fn thin(contacts: &mut Vec<SpherePair>, apart: Real) {
    if contacts.len() <= FEW {
        return;
    }
    let mut nearest: FastMap<[i64; 6], usize> = FastMap::default();
    for (k, c) in contacts.iter().enumerate() {
        let [x, y, z] = (c.points[0] / apart).to_array().map(|x| x.floor() as i64);
        let [n, o, p] = (c.normal * NORMALS).to_array().map(|x| x.round() as i64);
        match nearest.entry([x, y, z, n, o, p]) {
            Entry::Vacant(cell) => {
                cell.insert(k);
            }
            Entry::Occupied(mut cell) => {
                if c.distance < contacts[*cell.get()].distance {
                    cell.insert(k);
                }
            }
        }
    }
    let mut left: Vec<usize> = nearest.into_values().collect();
    left.sort_unstable();
    *contacts = left.into_iter().map(|k| contacts[k]).collect();
}
