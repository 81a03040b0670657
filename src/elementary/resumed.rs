//! A bracket that is taken only as far as a search needs it, and resumed later. On a curved path nothing but
//! `lower` outlives a round of the loop (roots are sought on straight paths only), so there resuming means starting
//! a new bracket at `lower`.

use super::bracket::{Bracket, Limits, Running};
use super::path::Path;
use super::test_list::Domain;
use crate::math::lane::Scalar;

/// The bracket of one elementary test from `limits.start`, until it is settled or its lower bound
/// lies after `until`; at least one round. To go on, start another at that lower bound with what is
/// left of the iterations.
pub fn bracket_until<S: Scalar, P: Path<S>>(
    path: &P,
    domain: Domain,
    limits: &Limits<S>,
    until: S,
) -> Bracket<S> {
    // Compiled once for each domain, as in `bracket`.
    match domain {
        Domain::Box => follow(path, Domain::Box, limits, until),
        Domain::Triangle => follow(path, Domain::Triangle, limits, until),
    }
}

#[inline(always)]
fn follow<S: Scalar, P: Path<S>>(
    path: &P,
    domain: Domain,
    limits: &Limits<S>,
    until: S,
) -> Bracket<S> {
    let mut running = Running::new(path, domain, limits);
    while running.active && running.bracket.iterations < limits.max_iterations {
        running.advance(path, domain, limits);
        if running.bracket.lower > until {
            break;
        }
    }
    running.bracket
}
