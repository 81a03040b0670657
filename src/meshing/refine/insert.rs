//! Insertion of primitives where a draft is farthest from the surface.
//!
//! The worst samples come first, one per primitive, none within three errors of one already served.
//! At a tip, where the surface sticks out beyond the end of the medial mesh, the ball that touches
//! the surface there joins it by a cone; in the middle of a cone, of a slab's edge or of a slab, a
//! ball splits it. No case closes a loop or opens one: the Euler number stays.

use crate::error::BuildError;
use crate::meshing::axis::shrinking_ball::{SMALLEST_BALL, shrink};
use crate::meshing::draft::{Ball, Corners, Draft};
use crate::meshing::geometry::bounds::Point;
use crate::meshing::geometry::triangle_tree::{GUESS, TriangleTree};
use crate::meshing::refine::refit::FitTarget;
use crate::meshing::refine::residuals::ResidualRow;
use crate::meshing::watch::Watch;

/// Error (longest side 1) below which no primitive is inserted.
const NEGLIGIBLE: f64 = 1e-5;

/// Weight (0 to 1) of both balls of a cone above which a place lies in its middle, and not at an end.
const MIDDLE_OF_CONE: f64 = 0.25;

/// Weight (0 to 1) of all balls of a slab above which a place lies in its middle, and not at an edge or a corner.
const MIDDLE_OF_SLAB: f64 = 0.15;

/// Between balls on creases radii are smaller than this (longest side 1).
const ON_CREASE: f64 = 1e-9;

/// Balls nearest to a tip that its cone may be joined to.
const ENDS: usize = 9;

/// A tip's cone may bulge out by this share of the error that it mends.
const BULGE: f64 = 0.8;

/// Largest number of faces at an edge that is split: each face costs a primitive.
const FACES_AT_EDGE: usize = 3;

/// Inserts up to `budget` primitives; gives the number added.
pub fn insert(
    draft: &mut Draft,
    target: &FitTarget,
    budget: usize,
    watch: &mut Watch,
) -> Result<usize, BuildError> {
    let found = target.residuals(draft, watch)?;
    let size = |i: usize| -> f64 {
        let residual = found.rows[i].residual;
        if i < found.surface_rows {
            residual.abs()
        } else {
            -residual
        }
    };
    let mut order: Vec<usize> = (0..found.rows.len())
        .filter(|&i| size(i) > NEGLIGIBLE)
        .collect();
    order.sort_unstable_by(|&i, &j| size(j).total_cmp(&size(i)).then(i.cmp(&j)));
    let mut inserter = Inserter {
        tree: target.tree,
        served: vec![false; draft.primitives().len()],
        touched: vec![false; draft.balls.len()],
        draft,
        places: Vec::new(),
        creases: target.creases,
        left: budget,
    };
    for (k, i) in order.into_iter().enumerate() {
        if k % 256 == 0 {
            watch.again()?;
        }
        if inserter.left == 0 {
            break;
        }
        let row = &found.rows[i];
        let normal = (i < found.surface_rows).then(|| target.samples[i].normal);
        let is_new = inserter.is_new_place(row, size(i));
        if is_new && inserter.serve(row, normal, size(i)) {
            inserter.places.push((row.point, size(i)));
            inserter.served[row.primitive as usize] = true;
        }
    }
    Ok(budget - inserter.left)
}

/// Site of a new ball, by the place of a sample in its primitive.
enum InsertionSite {
    /// A new ball beyond the medial mesh.
    Tip,
    /// A ball in the middle of a cone.
    Cone,
    /// A ball in the middle of the edge opposite to this corner of a slab.
    Edge(usize),
    /// A ball in the middle of a slab.
    Slab,
    /// No ball: the sample is at an end and does not stick out.
    End,
}

fn place(row: &ResidualRow, sticks_out: bool, on_surface: bool) -> InsertionSite {
    let [a, b, c] = row.corners;
    if a == b {
        return if on_surface {
            InsertionSite::Tip
        } else {
            InsertionSite::End
        };
    }
    let w = row.weights;
    if b == c {
        if w[0] > MIDDLE_OF_CONE && w[1] > MIDDLE_OF_CONE {
            return InsertionSite::Cone;
        }
    } else {
        let mut small = (0..3).filter(|&k| w[k] <= MIDDLE_OF_SLAB);
        match small.clone().count() {
            0 => return InsertionSite::Slab,
            1 => {
                return small
                    .next_back()
                    .map_or(InsertionSite::Slab, InsertionSite::Edge);
            }
            _ => {}
        }
    }
    if sticks_out {
        InsertionSite::Tip
    } else {
        InsertionSite::End
    }
}

struct Inserter<'a> {
    draft: &'a mut Draft,
    tree: &'a TriangleTree,
    served: Vec<bool>,
    /// Balls whose cone, edge or slab was split.
    touched: Vec<bool>,
    places: Vec<(Point, f64)>,
    creases: &'a [[Point; 2]],
    left: usize,
}

impl Inserter<'_> {
    fn is_new_place(&self, row: &ResidualRow, size: f64) -> bool {
        let near = |(p, error): &(Point, f64)| (*p - row.point).length() < 3.0 * error.max(size);
        !self.served[row.primitive as usize] && !self.places.iter().any(near)
    }

    /// Inserts for one sample; `normal` is the surface's, for samples of it. Whether it did.
    fn serve(&mut self, row: &ResidualRow, normal: Option<Point>, size: f64) -> bool {
        let sticks_out = normal.is_some() && row.residual > 0.0;
        let touching = normal.map(|n| shrink(self.tree, row.point, -n));
        match place(row, sticks_out, normal.is_some()) {
            InsertionSite::End => false,
            InsertionSite::Tip => touching.is_some_and(|ball| self.add_tip(ball, size)),
            place => {
                let corners = row.corners;
                if corners.iter().any(|&v| self.touched[v as usize]) {
                    return false;
                }
                let Some(ball) = self.splitting_ball(row, &place, touching) else {
                    return false;
                };
                let done = match place {
                    InsertionSite::Cone => self.split_cone(corners, ball),
                    InsertionSite::Edge(opposite) => self.split_edge(corners, opposite, ball),
                    _ => self.split_slab(corners, ball),
                };
                if done {
                    corners
                        .iter()
                        .for_each(|&v| self.touched[v as usize] = true);
                }
                done
            }
        }
    }

    /// The ball that splits a primitive: the one that touches the sample if it is near the medial mesh there, or the
    /// largest in the surface about the primitive's own. Of both the one whose new edges bulge out less: where the
    /// primitive crosses a groove, what touches its bottom belongs to another sheet.
    fn splitting_ball(
        &self,
        row: &ResidualRow,
        place: &InsertionSite,
        touching: Option<Ball>,
    ) -> Option<Ball> {
        let own = Ball::interpolate(self.draft.balls_of(row.corners), row.weights);
        if own.radius < ON_CREASE {
            return self.on_crease(own.center);
        }
        let near =
            |ball: &Ball| (ball.center - own.center).length() < 1.5 * own.radius.max(ball.radius);
        let signed = self.tree.signed_distance(own.center, own.radius);
        let largest = (signed < 0.0).then(|| Ball {
            center: own.center,
            radius: (-signed).max(SMALLEST_BALL),
        });
        match (touching.filter(near), largest) {
            (Some(touching), Some(largest)) => {
                let ends = self.ends_of_split(row.corners, place);
                let bulge = |ball: &Ball| {
                    let of_edges = ends.iter().map(|end| self.bulge(ball, end));
                    of_edges.fold(0.0, f64::max)
                };
                let less = bulge(&largest) < bulge(&touching);
                Some(if less { largest } else { touching })
            }
            (touching, largest) => touching.or(largest),
        }
    }

    /// Balls that a ball which splits a primitive gets edges to.
    fn ends_of_split(&self, corners: Corners, place: &InsertionSite) -> Vec<Ball> {
        let mut ends = corners.to_vec();
        if let InsertionSite::Edge(opposite) = place {
            let at_edge = self.faces_at_edge(corners, *opposite);
            ends.extend(at_edge.into_iter().flat_map(|k| self.draft.faces[k]));
        }
        ends.sort_unstable();
        ends.dedup();
        let ball = |v: u32| self.draft.balls[v as usize];
        ends.into_iter().map(ball).collect()
    }

    /// The faces at the edge opposite to a corner of a slab.
    fn faces_at_edge(&self, corners: Corners, opposite: usize) -> Vec<usize> {
        let (u, v) = (corners[(opposite + 1) % 3], corners[(opposite + 2) % 3]);
        let at_edge = |f: &[u32; 3]| f.contains(&u) && f.contains(&v);
        let faces = self.draft.faces.iter().enumerate();
        faces.filter(|(_, f)| at_edge(f)).map(|(k, _)| k).collect()
    }

    /// The ball of radius 0 on the nearest crease.
    fn on_crease(&self, p: Point) -> Option<Ball> {
        let nearest = self.creases.iter().map(|[a, b]| {
            let way = *b - *a;
            let t = ((p - *a).dot(way) / way.length_sq()).clamp(0.0, 1.0);
            *a + way * t
        });
        let nearer = |x: &Point, y: &Point| (*x - p).length_sq().total_cmp(&(*y - p).length_sq());
        nearest.min_by(nearer).map(|center| Ball {
            center,
            radius: 0.0,
        })
    }

    /// Joins a ball to the one of the nearest whose cone bulges out least.
    fn add_tip(&mut self, ball: Ball, size: f64) -> bool {
        let gap = |v: u32| {
            let other = &self.draft.balls[v as usize];
            (other.center - ball.center).length() - other.radius
        };
        let mut ends: Vec<(f64, u32)> = (0..self.draft.balls.len() as u32)
            .map(|v| (gap(v), v))
            .collect();
        if ends.len() > ENDS {
            let by_gap = |x: &(f64, u32), y: &(f64, u32)| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1));
            ends.select_nth_unstable_by(ENDS - 1, by_gap);
            ends.truncate(ENDS);
        }
        let cost = |&(gap, v): &(f64, u32)| {
            (
                self.bulge(&ball, &self.draft.balls[v as usize]) + 0.1 * gap.max(0.0),
                v,
            )
        };
        let best = ends.iter().map(cost);
        let best = best.min_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        let Some((bulge, end)) = best else {
            return false;
        };
        let distance = (self.draft.balls[end as usize].center - ball.center).length();
        if bulge > BULGE * size || distance < 1e-4 {
            return false;
        }
        let new = self.push(ball);
        self.draft.edges.push([new, end]);
        self.left -= 1;
        true
    }

    /// How far a cone leaves the surface, at a quarter, half and three quarters.
    fn bulge(&self, a: &Ball, b: &Ball) -> f64 {
        let at = |t: f64| {
            let ball = Ball::interpolate([*a, *b, *b], [1.0 - t, t, 0.0]);
            ball.radius
                + self
                    .tree
                    .signed_distance(ball.center, ball.radius.max(GUESS))
        };
        [0.25, 0.5, 0.75].map(at).into_iter().fold(0.0, f64::max)
    }

    fn push(&mut self, ball: Ball) -> u32 {
        self.draft.balls.push(ball);
        self.touched.push(true);
        self.draft.balls.len() as u32 - 1
    }

    fn split_cone(&mut self, [a, b, _]: Corners, ball: Ball) -> bool {
        let is_it = |e: &[u32; 2]| *e == [a, b] || *e == [b, a];
        let Some(k) = self.draft.edges.iter().position(is_it) else {
            return false;
        };
        let new = self.push(ball);
        self.draft.edges[k] = [a, new];
        self.draft.edges.push([new, b]);
        self.left -= 1;
        true
    }

    fn split_edge(&mut self, corners: Corners, opposite: usize, ball: Ball) -> bool {
        let (u, v) = (corners[(opposite + 1) % 3], corners[(opposite + 2) % 3]);
        let faces = self.faces_at_edge(corners, opposite);
        if faces.is_empty() || faces.len() > FACES_AT_EDGE.min(self.left) {
            return false;
        }
        let new = self.push(ball);
        for &k in &faces {
            let face = self.draft.faces[k];
            self.draft.faces[k] = face.map(|w| if w == u { new } else { w });
            self.draft
                .faces
                .push(face.map(|w| if w == v { new } else { w }));
        }
        self.draft.edges.retain(|e| *e != [u, v] && *e != [v, u]);
        self.left -= faces.len();
        true
    }

    fn split_slab(&mut self, corners: Corners, ball: Ball) -> bool {
        let Some(k) = self.draft.faces.iter().position(|f| *f == corners) else {
            return false;
        };
        if self.left < 2 {
            return false;
        }
        let new = self.push(ball);
        let [a, b, c] = corners;
        self.draft.faces[k] = [a, b, new];
        self.draft.faces.extend([[b, c, new], [c, a, new]]);
        self.left -= 2;
        true
    }
}
