//! Tells what each patch of a surface is: the boundary of solid matter, or a sheet.
//!
//! The winding number jumps by 1 across a surface (Jacobson et al., "Robust Inside-Outside
//! Segmentation using Generalized Winding Numbers", 2013). Behind a patch that bounds matter it is
//! 1 and before it 0; before and behind a sheet it is ∓½, whatever its other side is called; behind
//! a patch that is inside out it is 0 and before it −1. So patches are looked at together: those
//! inside out are turned; those that enclose nothing, or have wide openings, are sheets and count
//! no longer; until nothing changes. A closed shell that faces inward within matter is a cavity,
//! as the signs say, and one that faces outward within matter is a part stuck into another.

use crate::error::BuildError;
use crate::meshing::findings::Findings;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::geometry::random::Random;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::surface::openings::{Opening, openings};
use crate::meshing::surface::orient::{Patch, Patches};
use crate::meshing::surface::samples::even_samples;
use crate::meshing::watch::Watch;

/// Points looked at, by area. A winding number costs about 10 µs where the surface is open.
const POINTS: usize = 4_096;

/// Least number of points of each patch.
const POINTS_PER_PATCH: u32 = 6;

/// Share of the area below which open patches, with what is sewn to them, are judged together: a soup of triangles is
/// either a body that fell apart or no solid at all.
const CRUMB: f64 = 1e-3;

/// Distance behind the surface at which the winding number is asked for (longest side 1): below
/// any two layers that welding leaves apart.
const BEHIND: f64 = 1e-7;

/// Share of [`BEHIND`] at which the winding number is asked for again where it tells of parts that overlap: behind a
/// point near a sharp edge there may be less matter. Smaller, and rounding would decide.
const EDGE_PROBE_SHARE: f64 = 1e-3;

/// A patch with less than this behind it, on average, is inside out.
const INSIDE_OUT: f64 = 0.3;

/// An open patch with less than this behind it, on average, is a sheet: a card has ½.
const ENCLOSING: f64 = 0.7;

/// One that is left with less than this, once no patch is below [`ENCLOSING`], is a sheet too: between two plates at a
/// third of their width there is .75 on average, behind what encloses something nearly 1.
const ENCLOSING_LAST: f64 = 0.8;

/// More than this behind the surface: it is inside something else.
const BURIED: f64 = 1.3;

/// A closed patch is flat when its volume over its area is less: that is rounding.
const FLAT: f64 = 1e-9;

/// Rounds of turning and of taking sheets away; two or three settle all but contrived meshes.
const ROUNDS: usize = 12;

/// Verdict on a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PatchKind {
    /// The patch bounds matter.
    Solid,
    /// The patch encloses nothing.
    Sheet,
}

/// A point of the surface by which its patch is classified.
struct ProbePoint {
    point: Point,
    normal: Point,
    patch: u32,
}

/// Decides what each patch is, turns those that are inside out, and lets the tree count only those
/// that bound matter.
pub fn classify(
    surface: &mut Surface,
    patches: &mut Patches,
    tree: &mut TriangleTree,
    findings: &mut Findings,
    watch: &mut Watch,
) -> Result<Vec<PatchKind>, BuildError> {
    let total: f64 = patches.list.iter().map(|p| p.area).sum();
    let mut areas = vec![0.0; patches.list.len()];
    patches
        .list
        .iter()
        .for_each(|p| areas[p.sewn as usize] += p.area);
    let crumb = |p: usize| areas[patches.list[p].sewn as usize] < CRUMB * total;
    let probes = probes(surface, patches, &crumb, watch)?;
    let openings = openings(&surface.vertices, patches, watch)?;
    let mut classifier = PatchClassifier {
        group: groups(&patches.list, &crumb),
        counts: patches.list.iter().map(|p| i8::from(!is_flat(p))).collect(),
        patches,
        probes,
        openings,
    };
    let mut turned = vec![false; classifier.counts.len()];
    for _ in 0..ROUNDS {
        let counts = &classifier.counts;
        tree.recount(
            |t| counts[classifier.patches.of[t as usize] as usize],
            watch,
        )?;
        let behind = classifier.behind(tree, watch)?;
        let inside_out = |p: usize| {
            behind
                .mean(classifier.group[p])
                .is_some_and(|m| m < INSIDE_OUT)
        };
        let turn: Vec<usize> = (0..turned.len())
            .filter(|&p| classifier.counts[p] != 0 && !turned[p] && inside_out(p))
            .collect();
        if !turn.is_empty() {
            for p in turn {
                turned[p] = true;
                classifier.counts[p] = -1;
            }
            continue;
        }
        let mut sheets = classifier.sheets(&behind, ENCLOSING, tree, watch)?;
        if sheets.is_empty() {
            sheets = classifier.sheets(&behind, ENCLOSING_LAST, tree, watch)?;
        }
        if sheets.is_empty() {
            findings.overlapping = behind.overlapping;
            break;
        }
        sheets.into_iter().for_each(|p| classifier.counts[p] = 0);
    }
    let counts = classifier.counts;
    tree.recount(|t| counts[patches.of[t as usize] as usize], watch)?;
    tree.turn();
    for (i, triangle) in surface.triangles.iter_mut().enumerate() {
        watch.every(i)?;
        if counts[patches.of[i] as usize] < 0 {
            triangle.swap(1, 2);
            surface.normals[i] = -surface.normals[i];
        }
    }
    for (patch, &count) in patches.list.iter_mut().zip(&counts) {
        if count < 0 {
            patch.turned = patch.triangles - patch.turned;
            patch.volume = -patch.volume;
        }
    }
    findings.triangles_turned = patches.list.iter().map(|p| p.turned).sum();
    let kind = |&count: &i8| match count {
        0 => PatchKind::Sheet,
        _ => PatchKind::Solid,
    };
    Ok(counts.iter().map(kind).collect())
}

/// The patches, and the points by which they are classified.
struct PatchClassifier<'a> {
    patches: &'a Patches,
    /// Patches judged together; a patch with none is what it seems.
    group: Vec<Option<u32>>,
    /// How each patch counts in the winding number: 1, −1 when turned, 0 as a sheet.
    counts: Vec<i8>,
    probes: Vec<ProbePoint>,
    openings: Vec<Opening>,
}

/// Winding numbers behind the probes of each group.
struct Behind {
    /// Sum and count over all probes, and over those that are not buried.
    sums: Vec<[(f64, usize); 2]>,
    overlapping: bool,
}

impl Behind {
    fn mean(&self, group: Option<u32>) -> Option<f64> {
        let (sum, count) = self.sums[group? as usize][0];
        (count > 0).then(|| sum / count as f64)
    }

    /// Over probes that are not inside something else.
    fn exposed_mean(&self, group: Option<u32>) -> Option<f64> {
        let (sum, count) = self.sums[group? as usize][1];
        (count > 0).then(|| sum / count as f64)
    }
}

impl PatchClassifier<'_> {
    fn behind(&self, tree: &TriangleTree, watch: &mut Watch) -> Result<Behind, BuildError> {
        let mut behind = Behind {
            sums: vec![[(0.0, 0); 2]; self.group.len()],
            overlapping: false,
        };
        for (i, w) in self.probes.iter().enumerate() {
            if i % 64 == 0 {
                watch.at(0.0)?;
            }
            let patch = w.patch as usize;
            if self.counts[patch] == 0 {
                continue;
            }
            let outward = w.normal * f64::from(self.counts[patch]);
            let winding = tree.winding(w.point - outward * BEHIND);
            let overlaps = |winding: f64| !(INSIDE_OUT..1.5).contains(&winding);
            // Next to a sharp edge the body may end before that point.
            behind.overlapping |= overlaps(winding)
                && overlaps(tree.winding(w.point - outward * (EDGE_PROBE_SHARE * BEHIND)));
            let Some(group) = self.group[patch] else {
                continue;
            };
            let [all, exposed] = &mut behind.sums[group as usize];
            *all = (all.0 + winding, all.1 + 1);
            if winding < BURIED {
                *exposed = (exposed.0 + winding, exposed.1 + 1);
            }
        }
        Ok(behind)
    }

    /// Patches that turn out to be sheets: what is behind them, on average, is below `enclosing`.
    fn sheets(
        &self,
        behind: &Behind,
        enclosing: f64,
        tree: &TriangleTree,
        watch: &mut Watch,
    ) -> Result<Vec<usize>, BuildError> {
        let mut sheets = vec![false; self.counts.len()];
        for (p, patch) in self.patches.list.iter().enumerate() {
            let doubtful = self.counts[p] != 0 && (!patch.closed || patch.twisted);
            let mean = behind.exposed_mean(self.group[p]);
            sheets[p] = doubtful && mean.is_none_or(|m| m < enclosing);
        }
        for opening in &self.openings {
            watch.at(0.0)?;
            let p = opening.patch as usize;
            sheets[p] |= self.counts[p] != 0 && opening.is_wide(tree);
        }
        // Patches that are sewn together are of one kind.
        for (p, patch) in self.patches.list.iter().enumerate() {
            sheets[p] |= self.counts[p] != 0 && sheets[patch.sewn as usize];
        }
        Ok((0..sheets.len()).filter(|&p| sheets[p]).collect())
    }
}

fn is_flat(patch: &Patch) -> bool {
    patch.closed && patch.volume.abs() < FLAT * patch.area
}

/// The group of each patch: itself, with what is sewn to it, if that is large, or closed and facing inward; all small
/// open ones together; none for small closed ones that face outward.
fn groups(list: &[Patch], crumb: &impl Fn(usize) -> bool) -> Vec<Option<u32>> {
    let crumbs = (0..list.len()).position(|p| crumb(p) && !list[p].closed);
    let group = |p: usize| match (crumb(p), list[p].closed) {
        (true, false) => crumbs.map(|c| c as u32),
        (true, true) if list[p].volume >= 0.0 => None,
        (true, true) => Some(p as u32),
        (false, _) => Some(list[p].sewn),
    };
    (0..list.len()).map(group).collect()
}

/// Points spread by area, and some more of patches, with what is sewn to them, that have few and are judged for
/// themselves.
fn probes(
    surface: &Surface,
    patches: &Patches,
    crumb: &impl Fn(usize) -> bool,
    watch: &mut Watch,
) -> Result<Vec<ProbePoint>, BuildError> {
    let mut have = vec![0u32; patches.list.len()];
    let mut probes = Vec::new();
    for sample in even_samples(surface, POINTS, &mut Random::new(5)) {
        let patch = patches.of[sample.triangle as usize];
        have[patches.list[patch as usize].sewn as usize] += 1;
        probes.push(ProbePoint {
            point: sample.point,
            normal: sample.normal,
            patch,
        });
    }
    for t in 0..surface.triangles.len() {
        watch.every(t)?;
        let patch = patches.of[t] as usize;
        let info = &patches.list[patch];
        let alone = !crumb(patch) || (info.closed && info.volume < 0.0);
        let have = &mut have[info.sewn as usize];
        if alone && *have < POINTS_PER_PATCH {
            *have += 1;
            let [a, b, c] = surface.corners(t);
            probes.push(ProbePoint {
                point: (a + b + c) * (1.0 / 3.0),
                normal: surface.normals[t],
                patch: patch as u32,
            });
        }
    }
    Ok(probes)
}
