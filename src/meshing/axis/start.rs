//! The initial medial mesh: balls inside where the surface bounds matter, slabs where it is a
//! sheet.
//!
//! A solid part thinner than the distance between samples holds few of the balls that touch them,
//! or none. Samples that no ball touches show where: there the surface itself becomes slabs.

use crate::error::BuildError;
use crate::meshing::axis::inner_balls::{inner_balls, tetrahedra};
use crate::meshing::axis::sheets::{open_sheets, thin_sheets};
use crate::meshing::axis::wall_samples::times_for_walls;
use crate::meshing::draft::Draft;
use crate::meshing::findings::Findings;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::surface::folds::Folds;
use crate::meshing::surface::samples::{Sample, blue_noise, spacing};
use crate::meshing::watch::Watch;
use std::borrow::Cow;

/// A part with a smaller share of its samples touched by balls is too thin for them.
const TOUCHED: f64 = 0.5;

/// Distance before the surface at which the winding number tells whether it lies inside matter
/// (longest side 1): below any two layers that welding leaves apart.
const BEFORE: f64 = 1e-7;

/// The initial medial mesh.
pub struct Start {
    /// All balls inside solid matter.
    pub solid: Draft,
    /// Samples asked for: more than the caller's count where walls are thin.
    pub samples: usize,
    /// Distance between the samples that balls touch.
    pub spacing: f64,
    /// Slabs of sheets, and of matter too thin for balls.
    pub sheets: Draft,
    /// Share of the surface's area that became slabs.
    pub share: f64,
    /// Patches that are sheets: each wants a primitive at least.
    pub sheet_patches: usize,
}

/// The initial medial mesh from about `count` samples of the solid patches, or up to four times as many where they are
/// of thin walls, as the boundary of the solid tells; `findings` is told what turned out too thin and what is buried.
pub fn start(
    (surface, tree): (&Surface, &TriangleTree),
    boundary: (&Surface, &TriangleTree),
    count: usize,
    findings: &mut Findings,
    watch: &mut Watch,
) -> Result<Start, BuildError> {
    let part = without_sheets(surface);
    watch.begin("samples")?;
    let mut solid = Draft::default();
    let mut thin = vec![false; surface.triangles.len()];
    let distance = spacing(&part, count);
    let walls = without_sheets(boundary.0);
    let count = match walls.triangles.is_empty() {
        true => count,
        false => count * times_for_walls(&walls, boundary.1, distance, watch)?,
    };
    let spacing = (part.area / count as f64).sqrt();
    if !part.triangles.is_empty() {
        let mut samples = blue_noise(&part, count, watch)?;
        if findings.overlapping {
            // No ball touches what lies inside matter, and none may be stopped by it.
            let folds = Folds::new(surface, tree, watch)?;
            let patch_of = |s: &Sample| part.patch_of[s.triangle as usize];
            let before = |s: &Sample| s.point + s.normal * BEFORE;
            samples.retain(|s| !folds.is_inside(before(s), patch_of(s), &mut 0));
        }
        watch.begin("delaunay")?;
        let delaunay = tetrahedra(&samples, watch)?;
        watch.begin("inner balls")?;
        let votes = !findings.overlapping;
        let (mut balls, touched) = inner_balls(&samples, &delaunay, tree, votes, watch)?;
        let mut is_thin = thin_triangles(&part, &samples, &touched);
        if votes && is_thin.contains(&true) {
            let (sure, touched) = inner_balls(&samples, &delaunay, tree, false, watch)?;
            is_thin = thin_triangles(&part, &samples, &touched);
            balls = sure;
        }
        solid = balls;
        let of_solid = (0..surface.triangles.len()).filter(|&t| !surface.sheet[t]);
        for (t, is_thin) in of_solid.zip(is_thin) {
            thin[t] = is_thin;
        }
        findings.triangles_thin = thin.iter().filter(|t| **t).count();
    }
    watch.begin("sheets")?;
    let (open, buried) = open_sheets(surface, tree, watch)?;
    findings.triangles_buried = buried;
    let slabs = |t: usize| surface.sheet[t] || thin[t];
    let share = surface.part(slabs).area / surface.area;
    Ok(Start {
        solid,
        samples: count,
        spacing,
        sheets: open.and(thin_sheets(surface, &thin, spacing, watch)?),
        share,
        sheet_patches: findings.patches_sheet,
    })
}

/// The triangles of a surface that are no sheet's.
fn without_sheets(surface: &Surface) -> Cow<'_, Surface> {
    match surface.sheet.contains(&true) {
        false => Cow::Borrowed(surface),
        true => Cow::Owned(surface.part(|t| !surface.sheet[t])),
    }
}

/// Which triangles lie where matter is too thin for balls: those around whose corners too few
/// samples are touched, or in whose patch, where there are no samples.
fn thin_triangles(surface: &Surface, samples: &[Sample], touched: &[bool]) -> Vec<bool> {
    let patches = surface.patch_of.iter().max().map_or(0, |&p| p as usize + 1);
    let mut of_patch = vec![TouchedSamples::default(); patches];
    let mut of_vertex = vec![TouchedSamples::default(); surface.vertices.len()];
    for (sample, &touched) in samples.iter().zip(touched) {
        let t = sample.triangle as usize;
        of_patch[surface.patch_of[t] as usize].add(touched);
        for v in surface.triangles[t] {
            of_vertex[v as usize].add(touched);
        }
    }
    let is_thin = |(t, &patch): (&[u32; 3], &u32)| {
        let [a, b, c] = t.map(|v| of_vertex[v as usize]);
        let around = a.plus(b).plus(c);
        match around.all {
            0 => of_patch[patch as usize].is_thin(),
            _ => around.is_thin(),
        }
    };
    let triangles = surface.triangles.iter().zip(&surface.patch_of);
    triangles.map(is_thin).collect()
}

/// Count of samples, and of those among them that balls touch.
#[derive(Clone, Copy, Default)]
struct TouchedSamples {
    touched: u32,
    all: u32,
}

impl TouchedSamples {
    fn add(&mut self, touched: bool) {
        self.touched += u32::from(touched);
        self.all += 1;
    }

    fn plus(self, other: Self) -> Self {
        Self {
            touched: self.touched + other.touched,
            all: self.all + other.all,
        }
    }

    fn is_thin(&self) -> bool {
        f64::from(self.touched) < TOUCHED * f64::from(self.all)
    }
}
