//! Medial meshes beside trees of bounding volumes over triangles (the paper's Figures 10 and 13).

use crate::bodies::Bodies;
use crate::common::decimate::decimated;
use crate::common::mesh::Mesh;
use crate::common::surface_error::spread_points;
use crate::crash::{Case, Crash, TOUCH, parry_motion};
use crate::outcome::{Outcome, quantile};
use crate::report::{Plot, Point, Section};
use crate::volumes::{Ball, Looked, Tree, TurnedBox, Volume};
use rapier3d::parry::query::PointQuery;
use rapier3d::prelude::Vector;

/// Largest distance of the creature's surface and the envelope of each representation, at equal
/// numbers of primitives and of leaves.
pub fn quality(crash: &Crash, medial: &[Bodies], points: usize, progress: &dyn Fn()) -> Section {
    let source = &crash.meshes[0];
    let balls = Tree::<Ball>::new(source);
    let boxes = Tree::<TurnedBox>::new(source);
    let mut rows = Vec::new();
    let mut series = ["medial mesh", Ball::NAME, TurnedBox::NAME].map(|n| (n.to_string(), vec![]));
    for bodies in medial {
        let leaves = bodies.parts;
        let errors = [
            bodies.bloat(source, points),
            balls.bloat(source, leaves, points),
            boxes.bloat(source, leaves, points),
        ];
        for ((name, line), error) in series.iter_mut().zip(errors) {
            rows.push(vec![
                name.clone(),
                leaves.to_string(),
                format!("{error:.4}"),
                format!("{:.2}", 100.0 * error / crate::crash::WIDTH),
            ]);
            line.push((leaves as f64, error));
        }
        progress();
    }
    Section {
        name: "leaves",
        title: "Bounding quality at equal numbers of leaves (the paper's Figure 10)",
        text: "Of the creature: trees of spheres and of oriented boxes over its triangles, cut where they \
               have as many leaves as the medial mesh has primitives. The error is the largest distance \
               from the boundary of the union to the surface, at sampled points. The trees cover the \
               surface only, the medial mesh is a solid."
            .into(),
        note: "",
        plot: Plot::Lines {
            x: "primitives, or leaves",
            y: "largest distance to the surface, metres",
            log: [true, true],
            series: series.into(),
        },
        head: vec!["volumes", "leaves", "error m", "error % of width"],
        rows,
    }
}

/// Whole queries: medial meshes, and trees down to triangles on coarser and coarser meshes.
pub fn queries(
    crash: &Crash,
    medial: &[&Bodies],
    sizes: &[usize],
    every: usize,
    progress: &dyn Fn(),
) -> Section {
    let mut rows = Vec::new();
    let mut series = vec![("medial meshes".to_string(), Vec::new())];
    let cases = || crash.cases.iter().step_by(every);
    let mut add =
        |name: String, label: String, vertices: usize, shape: f64, looked: Looked, o: Outcome| {
            let time = quantile(&o.microseconds, 0.5);
            let count = o.microseconds.len() as u64;
            let default = name == "medial mesh, 500";
            rows.push(vec![
                name,
                vertices.to_string(),
                format!("{shape:.4}"),
                count.to_string(),
                o.hits.to_string(),
                o.missed.to_string(),
                o.ghosts.to_string(),
                format!("{:.2e}", o.error(0.5)),
                format!("{:.2e}", o.error(0.95)),
                (looked.volumes / count).to_string(),
                (looked.triangles / count).to_string(),
                format!("{time:.1}"),
                format!("{:.1}", quantile(&o.microseconds, 0.95)),
            ]);
            Point {
                default,
                label,
                time,
                error: o.error(0.95).max(1.0e-6),
            }
        };
    for bodies in medial {
        let mut looked = Looked::default();
        let query = |case: &Case| {
            let [a, b] = case.motions.each_ref().map(parry_motion);
            let (found, counts) = bodies.counted([&a, &b])?;
            looked.volumes += counts.nodes;
            looked.triangles += counts.tests;
            found
        };
        let allowed = bodies.shape_error;
        let outcome = Outcome::of(crash, allowed, cases(), query, progress);
        let point = add(
            bodies.name.clone(),
            bodies.parts.to_string(),
            bodies.spheres,
            allowed,
            looked,
            outcome,
        );
        series[0].1.push(point);
    }
    let coarse: Vec<([Mesh; 2], f64)> = sizes
        .iter()
        .map(|&size| {
            let meshes = crash.meshes.each_ref().map(|m| decimated(m, size));
            let off = [0, 1].map(|k| apart(&meshes[k], &crash.meshes[k]));
            (meshes, off[0] + off[1])
        })
        .collect();
    let boxes = of_trees::<TurnedBox>(crash, &coarse, every, progress);
    let balls = of_trees::<Ball>(crash, &coarse, every, progress);
    for (name, all) in [(TurnedBox::NAME, boxes), (Ball::NAME, balls)] {
        let mut points = Vec::new();
        for (vertices, shape, looked, outcome) in all {
            let label = vertices.to_string();
            points.push(add(name.into(), label, vertices, shape, looked, outcome));
        }
        series.push((name.to_string(), points));
    }
    Section {
        name: "trees",
        title: "Medial meshes beside trees over triangles (the paper's Figures 13 and 14)",
        text: "The same motions. The trees are over the source meshes and over meshes drawn together to \
               fewer vertices by the quadric error, the smallest with as many as the medial mesh of 500 \
               primitives has spheres; under the volumes each pair of triangles is followed to its first \
               contact. Vertices are the creature's (spheres, of a medial mesh); pairs are those of \
               volumes looked at and of elementary tests, mean of a query. The error counts against the \
               source triangles."
            .into(),
        note: "A medial mesh is a solid with some enclosure error; a tree over the source's own \
               triangles has none, and takes as long as its table row says.",
        plot: Plot::Front {
            time: "one continuous query, microseconds, median",
            error: "error of the time of impact, seconds, 95th percentile",
            series,
        },
        head: vec![
            "bodies",
            "vertices",
            "shape error m",
            "motions",
            "hits",
            "missed",
            "ghosts",
            "time error p50 s",
            "time error p95 s",
            "volume pairs",
            "elementary tests",
            "query p50 us",
            "query p95 us",
        ],
        rows,
    }
}

type Measured = Vec<(usize, f64, Looked, Outcome)>;

fn of_trees<T: Volume>(
    crash: &Crash,
    coarse: &[([Mesh; 2], f64)],
    every: usize,
    progress: &dyn Fn(),
) -> Measured {
    let measure = |(meshes, off): &([Mesh; 2], f64)| {
        let trees = meshes.each_ref().map(Tree::<T>::new);
        let mut looked = Looked::default();
        let query = |case: &Case| {
            let both = [&case.motions[0], &case.motions[1]];
            let (found, counts) = trees[0].first_contact(&trees[1], both, TOUCH);
            looked.volumes += counts.volumes;
            looked.triangles += counts.triangles;
            found
        };
        let cases = crash.cases.iter().step_by(every);
        let outcome = Outcome::of(crash, f64::INFINITY, cases, query, progress);
        (meshes[0].vertices.len(), *off, looked, outcome)
    };
    coarse.iter().map(measure).collect()
}

/// Largest distance of two surfaces, both ways, at 20,000 points of each and all vertices.
fn apart(a: &Mesh, b: &Mesh) -> f64 {
    let [a, b] = [a, b].map(Mesh::to_parry);
    let far = |from: &rapier3d::prelude::TriMesh, to: &rapier3d::prelude::TriMesh| {
        let off = |p: Vector| to.project_local_point(p, false).point.distance(p);
        let vertices = from.vertices().iter().copied();
        spread_points(from, 20_000)
            .chain(vertices)
            .map(off)
            .fold(0.0, f32::max)
    };
    far(&a, &b).max(far(&b, &a)).into()
}
