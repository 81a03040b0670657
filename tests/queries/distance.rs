//! The signed distance at a fixed time, in both precisions, against the oracle.

use crate::ccd::contact::distance_at;
use crate::ccd::families::Family;
use crate::ccd::motion::{Ball, Paths};
use crate::ccd::rng::Rng;
use rapier3d_medial::elementary::distance::signed_distance;
use rapier3d_medial::elementary::penetration;
use rapier3d_medial::math::lane::{Scalar, Vec3};
use rapier3d_medial::math::tolerance::SLACK_ULPS;

fn convert<S: Scalar>(balls: &[Ball]) -> Vec<penetration::Ball<S>> {
    let convert = |ball: &Ball| {
        let [x, y, z] = [ball.center.x, ball.center.y, ball.center.z].map(S::splat);
        (Vec3::new(x, y, z), S::splat(ball.radius))
    };
    balls.iter().map(convert).collect()
}

/// Largest error, in the units of the slack that queries allow for: `EPSILON` times the largest
/// distance between two centres plus the largest radius sum.
fn worst<S: Scalar>(family: Family) -> f64 {
    let mut rng = Rng::new(500 + family as u64);
    let mut worst: f64 = 0.0;
    for k in 0..1800 {
        let query = family.query([1 + k % 3, 1 + k / 3 % 3], false, &mut rng);
        let paths = Paths::new(&query);
        let [a, b] = query.balls.each_ref().map(|balls| convert::<S>(balls));
        let found = signed_distance(&a, &b).to_f64();
        let (lower, upper) = distance_at(&paths, 0.0);
        let error = (found - upper).max(lower - found);
        worst = worst.max(error / (S::EPSILON * paths.at(0.0).scale()));
    }
    worst
}

/// Every query trusts the distance to the slack.
#[test]
fn errors_stay_below_the_slack() {
    for family in Family::ALL {
        let (single, double) = (worst::<f32>(family), worst::<f64>(family));
        assert!(
            single < SLACK_ULPS,
            "{family:?}: {single} in single precision"
        );
        assert!(
            double < SLACK_ULPS,
            "{family:?}: {double} in double precision"
        );
    }
}
