//! Two bodies and their motion in a step, as they are sent to the GPU: computed in double precision in a frame of the
//! pair's own, so that large coordinates lose no digits, and with a slack for everything that is rounded later.

use super::layout::{Pair, Side};
use crate::batch::job::Sweep;
use crate::elementary::first_contact::motion_is_finite;
use crate::math::lane::Lane;
use crate::math::motion::RigidMotion;
use crate::math::tolerance::{GPU_SLACK_ULPS, PIECE_ANGLE};

/// Lengths above this, in the user's unit, stay on the CPU: their squares would overflow.
const MAX_LENGTH: f64 = 1.0e15;

/// Most pieces of a step; a body that turns further is left to the CPU, where endless turns end on the cap of
/// the work ([`crate::pair`]): with more pieces for the CPU than for the device, the device would say free where
/// the CPU says unresolved. With as many, the device gives up first: it walks 1,024 node pairs a piece, a
/// sixteenth of the cap in 32 of them.
const MAX_PIECES: f64 = 32.0;

impl Sweep<'_> {
    /// Pieces of the sweep as the device gets them; `None` where a number is not finite or too large, or a body turns
    /// so far that the CPU, which takes more pieces then, might end on its work cap: the device must not know more than
    /// the CPU.
    pub(super) fn pairs(&self, roots: [u32; 2]) -> impl Iterator<Item = Option<Pair>> {
        let [m1, m2] = &self.motions;
        let paths = RigidMotion::pair(m1, m2, self.seconds.into());
        let angle = |m: &RigidMotion<f64>| m.angle() / PIECE_ANGLE;
        let most = paths.iter().map(angle).fold(1.0, f64::max);
        let count = most.ceil().min(MAX_PIECES);
        (0..count as u32).map(move |k| {
            let times = [k, k + 1].map(|k| f64::from(k) / count);
            self.pair(roots, &paths, times)
        })
    }

    fn pair(
        &self,
        roots: [u32; 2],
        motions: &[RigidMotion<f64>; 2],
        [start, end]: [f64; 2],
    ) -> Option<Pair> {
        let mut sides = [Side::default(); 2];
        let mut scale = self.reach.abs();
        let mut turns_little = true;
        for (k, side) in sides.iter_mut().enumerate() {
            let motion = &motions[k];
            side.start = rows(motion, start);
            side.end = rows(motion, end);
            let center = self.motions[k].local_center;
            let angle = motion.angle() * (end - start);
            turns_little &= angle <= PIECE_ANGLE * (1.0 + 1.0e-6);
            // Rounded up: a sagitta must not shrink.
            let sagitta = angle * angle * (0.125 * (1.0 + 1.0e-6));
            side.turn = [center.x, center.y, center.z, sagitta as f32];
            let root = &self.meshes[k].tree().nodes()[0];
            let extent = f64::from((root.center - center).length() + root.radius);
            let lever = f64::from(center.length()) + extent;
            let away = |rows: &[[f32; 4]; 3]| {
                let square = rows.iter().map(|r| f64::from(r[3]).powi(2));
                square.sum::<f64>().sqrt()
            };
            scale += away(&side.start) + away(&side.end) + 2.0 * lever + sagitta * extent;
        }
        let slack = scale * GPU_SLACK_ULPS * f64::from(f32::EPSILON) + f32::TINY.sqrt();
        let reach = self.reach + slack;
        // Also false for what is not a number, which a device may take for anything.
        let numbers: &[f32] = bytemuck::cast_slice(&sides);
        let plain = numbers
            .iter()
            .fold(true, |all, x| all & (x.abs() < MAX_LENGTH as f32));
        let finite = self.motions.iter().all(motion_is_finite);
        let sound = finite && turns_little && scale < MAX_LENGTH && plain;
        sound.then(|| Pair {
            sides,
            roots,
            reach: (reach as f32).next_up(),
            lists: self.lists.into(),
        })
    }
}

/// Rows of a body's placement at a time.
fn rows(motion: &RigidMotion<f64>, time: f64) -> [[f32; 4]; 3] {
    motion.frame(time).rows().map(|row| row.map(|x| x as f32))
}
