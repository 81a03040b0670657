//! Patches of a surface: triangles joined across edges of two, each patch turned to face one way.
//!
//! Two triangles that share an edge agree when they use it in opposite directions. Within a patch
//! the majority decides; which side of a patch is outside is for `patches` to find out.
//!
//! An edge of more than two triangles does not say who belongs together. But a fin on a body leaves
//! the body whole: patches that end somewhere are taken away, and where two triangles of an edge
//! are then left, they join.
//!
//! Patches along loose seams (`sew.rs`) stay what they are, but face one way together.

use crate::error::BuildError;
use crate::meshing::findings::Findings;
use crate::meshing::geometry::bounds::{Point, direction};
use crate::meshing::geometry::union_find::Groups;
use crate::meshing::surface::checked_surface::{corners, cross};
use crate::meshing::surface::edges::{Edges, Shells, Use};
use crate::meshing::surface::sew::{OpenEdge, Seam, loose_seams};
use crate::meshing::watch::Watch;

/// Triangles joined across edges of two.
#[derive(Clone, Copy, Debug, Default)]
pub struct Patch {
    /// Whether the patch uses each of its edges an even number of times: it ends nowhere.
    pub closed: bool,
    /// Whether no choice makes all triangles of the patch face the same way.
    pub twisted: bool,
    /// Signed volume about the origin; means something where the patch is closed.
    pub volume: f64,
    /// Sum of its triangles' areas.
    pub area: f64,
    /// How many triangles it has.
    pub triangles: usize,
    /// Number of triangles that were turned round.
    pub turned: usize,
    /// The first of the patches that are joined to it along loose seams, and face the same way as it does: itself if
    /// there are none.
    pub sewn: u32,
}

/// All patches, and what of them ends where.
pub struct Patches {
    /// The patch of each triangle.
    pub of: Vec<u32>,
    /// All patches, in order of their first triangles.
    pub list: Vec<Patch>,
    /// Edges of one triangle: their vertices, and their patches.
    pub open_edges: Vec<([u32; 2], u32)>,
    /// Open edges at no loose seam: their vertices, of which those at a seam count as one, and the first of the patches
    /// that are sewn together.
    pub rims: Vec<([u32; 2], u32)>,
}

impl Patches {
    /// Area of each patch and all those sewn to it, at the first of them; 0 at the others.
    pub fn sewn_areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.list.len()];
        for patch in &self.list {
            areas[patch.sewn as usize] += patch.area;
        }
        areas
    }
}

/// Finds the patches, and turns triangles so that each patch faces one way.
pub fn orient(
    vertices: &[Point],
    triangles: &mut [[u32; 3]],
    findings: &mut Findings,
    watch: &mut Watch,
) -> Result<Patches, BuildError> {
    let edges = Edges::new(vertices.len(), triangles, watch)?;
    let mut shells = Shells::new(triangles.len());
    // Per root of a shell.
    let mut open = vec![false; triangles.len()];
    let mut twisted: Vec<usize> = Vec::new();
    let mut single: Vec<([u32; 2], usize)> = Vec::new();
    let mut crowded: Vec<&[Use]> = Vec::new();
    for (i, (ends, uses)) in edges.iter().enumerate() {
        watch.every(i)?;
        match uses {
            [only] => single.push((ends, only.triangle())),
            [a, b] if !shells.join(a, b) => twisted.push(a.triangle()),
            [_, _] => {}
            _ => crowded.push(uses),
        }
    }
    findings.edges_open = single.len();
    findings.edges_crowded = crowded.len();
    for &(_, triangle) in &single {
        open[shells.find(triangle).0] = true;
    }
    strip(&crowded, &mut shells, &mut open, watch)?;
    for (i, uses) in crowded.iter().enumerate() {
        watch.every(i)?;
        let mut whole = uses.iter().filter(|u| !open[shells.find(u.triangle()).0]);
        let pair = (whole.next(), whole.next(), whole.next());
        drop(whole);
        if let (Some(a), Some(b), None) = pair
            && !shells.join(a, b)
        {
            twisted.push(a.triangle());
        }
    }
    findings.edges_twisted = twisted.len();
    let mut sewn = shells.clone();
    let loose: Vec<OpenEdge> = open_as_used(vertices, triangles, &single);
    let seams = loose_seams(&loose, watch)?;
    for seam in &seams {
        sewn.join_triangles(seam.edges.map(|e| loose[e].triangle), seam.against);
    }
    let (of, mut list) = number(&mut shells, &mut sewn, vertices, triangles, watch)?;
    findings.patches = list.len();
    for triangle in twisted {
        list[of[triangle] as usize].twisted = true;
    }
    let mut users: Vec<u32> = Vec::new();
    for (i, (_, uses)) in edges.iter().enumerate() {
        watch.every(i)?;
        users.clear();
        users.extend(uses.iter().map(|u| of[u.triangle()]));
        users.sort_unstable();
        for own in users
            .chunk_by(|a, b| a == b)
            .filter(|own| own.len() % 2 == 1)
        {
            list[own[0] as usize].closed = false;
        }
    }
    let rims = rims(vertices.len(), &loose, &seams, |t| {
        list[of[t] as usize].sewn
    });
    let patch_of = |(ends, triangle): ([u32; 2], usize)| (ends, of[triangle]);
    Ok(Patches {
        rims,
        open_edges: single.into_iter().map(patch_of).collect(),
        of,
        list,
    })
}

/// Open edges as their triangles use them.
fn open_as_used(
    vertices: &[Point],
    triangles: &[[u32; 3]],
    single: &[([u32; 2], usize)],
) -> Vec<OpenEdge> {
    let as_used = |&([lo, hi], triangle): &([u32; 2], usize)| {
        let [a, b, c] = triangles[triangle];
        let forward = [[a, b], [b, c], [c, a]].contains(&[lo, hi]);
        let used = if forward { [lo, hi] } else { [hi, lo] };
        let ends = used.map(|v| vertices[v as usize]);
        let normal = cross(corners(vertices, &triangles[triangle]));
        OpenEdge {
            vertices: used,
            ends,
            inward: direction(normal.cross(ends[1] - ends[0])),
            triangle,
        }
    };
    single.iter().map(as_used).collect()
}

/// Open edges without those at seams, whose ends become one.
fn rims(
    vertices: usize,
    open: &[OpenEdge],
    seams: &[Seam],
    sewn: impl Fn(usize) -> u32,
) -> Vec<([u32; 2], u32)> {
    let mut places = Groups::new(vertices);
    let mut at_seam = vec![false; open.len()];
    for seam in seams {
        let [one, other] = seam.edges.map(|e| open[e].vertices);
        let [first, last] = if seam.against { [0, 1] } else { [1, 0] };
        places.join(one[0], other[first]);
        places.join(one[1], other[last]);
        seam.edges.into_iter().for_each(|e| at_seam[e] = true);
    }
    let left = open.iter().zip(at_seam).filter(|(_, at_seam)| !at_seam);
    left.map(|(edge, _)| (edge.vertices.map(|v| places.find(v)), sewn(edge.triangle)))
        .collect()
}

/// Marks as open the shells that end at crowded edges once the open ones are away, and so on.
fn strip(
    crowded: &[&[Use]],
    shells: &mut Shells,
    open: &mut [bool],
    watch: &mut Watch,
) -> Result<(), BuildError> {
    let mut touching: Vec<(usize, usize)> = Vec::new();
    // Uses of each edge by shells that are not open.
    let mut left = vec![0usize; crowded.len()];
    let mut waiting: Vec<usize> = Vec::new();
    for (edge, uses) in crowded.iter().enumerate() {
        watch.every(edge)?;
        let shells_of = uses.iter().map(|u| shells.find(u.triangle()).0);
        for shell in shells_of {
            touching.push((shell, edge));
            left[edge] += usize::from(!open[shell]);
        }
        if left[edge] == 1 {
            waiting.push(edge);
        }
    }
    touching.sort_unstable();
    let mut steps = 0;
    while let Some(edge) = waiting.pop() {
        let last = crowded[edge].iter().map(|u| shells.find(u.triangle()).0);
        let Some(shell) = last.into_iter().find(|&s| !open[s]) else {
            continue;
        };
        open[shell] = true;
        let first = touching.partition_point(|t| t.0 < shell);
        for &(_, edge) in touching[first..].iter().take_while(|t| t.0 == shell) {
            watch.every(steps)?;
            steps += 1;
            left[edge] -= 1;
            if left[edge] == 1 {
                waiting.push(edge);
            }
        }
    }
    Ok(())
}

/// Numbers the shells, turns the minority of each set of them that is sewn, and sums up areas and volumes.
fn number(
    shells: &mut Shells,
    sewn: &mut Shells,
    vertices: &[Point],
    triangles: &mut [[u32; 3]],
    watch: &mut Watch,
) -> Result<(Vec<u32>, Vec<Patch>), BuildError> {
    let mut number_of = vec![u32::MAX; triangles.len()];
    let mut of = Vec::with_capacity(triangles.len());
    let mut list: Vec<Patch> = Vec::new();
    // Per root of what is sewn: its first patch; triangles that face against the root, and those that face with it.
    let mut first = vec![u32::MAX; triangles.len()];
    let mut votes = vec![[0u32; 2]; triangles.len()];
    for t in 0..triangles.len() {
        watch.every(t)?;
        let root = shells.find(t).0;
        let (whole, against) = sewn.find(t);
        let patch = &mut number_of[root];
        if *patch == u32::MAX {
            *patch = list.len() as u32;
            let sewn = &mut first[whole];
            *sewn = (*sewn).min(*patch);
            list.push(Patch {
                closed: true,
                sewn: *sewn,
                ..Default::default()
            });
        }
        votes[whole][usize::from(!against)] += 1;
        of.push(*patch);
    }
    for (t, triangle) in triangles.iter_mut().enumerate() {
        watch.every(t)?;
        let (whole, odd) = sewn.find(t);
        let patch = &mut list[of[t] as usize];
        let [against, with] = votes[whole];
        patch.triangles += 1;
        if odd != (against > with) {
            triangle.swap(1, 2);
            patch.turned += 1;
        }
        let [a, b, c] = triangle.map(|v| vertices[v as usize]);
        patch.volume += a.dot(b.cross(c)) / 6.0;
        patch.area += 0.5 * (b - a).cross(c - a).length();
    }
    Ok((of, list))
}
