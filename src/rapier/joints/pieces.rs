//! Ends of the pieces in which bodies held by joints move ([`crate::rapier::joints::jointed_bodies`]), and which bodies
//! each piece moves.

use crate::math::Real;
use crate::rapier::joints::jointed_bodies::MotionPiece;

/// Pieces of a step that have not ended.
#[derive(Default)]
pub struct MotionPieces(Vec<(Real, Vec<usize>)>);

impl MotionPieces {
    /// Seconds into the step at which the first ends.
    pub fn first_end(&self) -> Option<Real> {
        self.0
            .iter()
            .map(|(until, _)| *until)
            .min_by(Real::total_cmp)
    }

    /// Takes the bodies of one that has ended by `time`.
    pub fn take_ended(&mut self, time: Real) -> Option<Vec<usize>> {
        let ended = self.0.iter().position(|(until, _)| *until <= time)?;
        Some(self.0.swap_remove(ended).1)
    }

    /// Bodies leave those in which they are.
    pub fn end(&mut self, bodies: &[usize]) {
        self.begin(MotionPiece {
            until: None,
            moved: bodies.to_vec(),
        });
    }

    /// Bodies begin one, and leave those in which they are.
    pub fn begin(&mut self, piece: MotionPiece) {
        for (_, bodies) in &mut self.0 {
            bodies.retain(|b| !piece.moved.contains(b));
        }
        self.0.retain(|(_, bodies)| !bodies.is_empty());
        self.0.extend(piece.until.map(|until| (until, piece.moved)));
    }
}
