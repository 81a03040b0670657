//! Leaves out sheets of a convex body's medial axis between two faces that lie nearly in one plane, and bounds what is
//! lost without them.
//!
//! A ball of such a sheet, of radius `r` and touching faces of a group that differ by up to the angle `φ`, lies within
//! another's as one climbs the roof to the next sheet that is kept: the radius grows there by `cos φ` or more of the
//! way, which is no longer than the larger radius. So `r (1 − cos φ)` is what is lost.

use crate::math::fast_hash::FastMap;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::geometry::convex::Plane;
use crate::meshing::geometry::union_find::Groups;

/// Sheets that are left out.
pub struct BluntSheets {
    groups: Groups,
    /// The two faces of each sheet, and its largest radius.
    sheets: Vec<([usize; 2], f64)>,
}

impl BluntSheets {
    /// A record of a body with so many faces, no sheet left out yet.
    pub fn new(faces: usize) -> Self {
        Self {
            groups: Groups::new(faces),
            sheets: Vec::new(),
        }
    }

    /// Leaves out the sheet of two faces if it alone loses no more than `most`.
    pub fn leaves_out(
        &mut self,
        faces: [usize; 2],
        planes: &[Plane],
        widest: f64,
        most: f64,
    ) -> bool {
        let [a, b] = faces.map(|k| planes[k].normal);
        let half = (0.5 * (1.0 + a.dot(b))).max(0.0).sqrt();
        let blunt = widest * (1.0 - half) <= most * half;
        if blunt {
            let [a, b] = faces;
            self.groups.join(a as u32, b as u32);
            self.sheets.push((faces, widest));
        }
        blunt
    }

    /// Length lost where sheets meet.
    pub fn loss(&mut self, planes: &[Plane]) -> f64 {
        let mut members: FastMap<u32, (Vec<Point>, f64)> = FastMap::default();
        for &(faces, widest) in &self.sheets {
            let group = members
                .entry(self.groups.find(faces[0] as u32))
                .or_default();
            group.0.extend(faces.map(|k| planes[k].normal));
            group.1 = group.1.max(widest);
        }
        let lost = |(normals, widest): &(Vec<Point>, f64)| {
            let spread = |a: &Point| {
                normals
                    .iter()
                    .map(|b| 0.5 * (*a - *b).length_sq())
                    .fold(0.0, f64::max)
            };
            widest * normals.iter().map(spread).fold(0.0, f64::max)
        };
        members.values().map(lost).fold(0.0, f64::max)
    }
}
