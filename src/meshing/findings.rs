//! Faults found in a triangle mesh and what was done about them, as numbers and in words.

use std::fmt::Write as _;

/// Numbers of faults that a build found in its triangle mesh, and of repairs. [`crate::meshing::BuildReport::notes`]
/// says the same in words.
///
/// A *patch* is a set of triangles that are joined across edges of exactly two triangles. It is *solid* if it
/// bounds a volume, alone or together with others, else it is a *sheet*.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Findings {
    /// Vertices that no triangle uses; ignored.
    pub vertices_unused: usize,
    /// Vertices that were welded to another at the same place (within 1e-6 of the longest side).
    pub vertices_welded: usize,
    /// Triangles with two or three corners at one vertex, so that they are segments or points. The
    /// medial mesh covers them, and the error includes how far they stick out of it; for all else
    /// they are ignored.
    pub triangles_collapsed: usize,
    /// Triangles dropped because another has the same corners, in any order, but for those in
    /// [`Self::triangles_shared`].
    pub triangles_repeated: usize,
    /// Triangles between two parts that touch, dropped in pairs of the same corners that face opposite ways: the solid
    /// is on both sides of them.
    pub triangles_shared: usize,
    /// Triangles without area. They join their neighbours and are covered; for all else they are ignored.
    pub triangles_without_area: usize,
    /// Triangles whose orientation was reversed, to face outward.
    pub triangles_turned: usize,
    /// Triangles without area that were added to close seams, where one long edge meets several short ones.
    pub slivers: usize,
    /// Edges of only one triangle.
    pub edges_open: usize,
    /// Edges of more than two triangles.
    pub edges_crowded: usize,
    /// Edges whose triangles cannot be made to face the same way.
    pub edges_twisted: usize,
    /// Patches, solid or not.
    pub patches: usize,
    /// Solid patches.
    pub patches_solid: usize,
    /// Solid patches with openings that were taken for damage and closed.
    pub patches_mended: usize,
    /// Solid patches that bound a cavity: closed, and facing inward.
    pub patches_cavity: usize,
    /// Patches that were built as sheets.
    pub patches_sheet: usize,
    /// Sheets that are closed but enclose no volume.
    pub patches_flat: usize,
    /// Triangles of solid patches that were built as sheets, because the solid is too thin there to hold spheres.
    pub triangles_thin: usize,
    /// Triangles of sheets (after long edges were halved) that were left out because they lie inside a solid.
    pub triangles_buried: usize,
    /// Number of triangles that lie entirely inside a solid. They do not count in the error.
    pub triangles_hidden: usize,
    /// Patches of which all triangles lie entirely inside a solid.
    pub patches_hidden: usize,
    /// Whether the surface is so tangled that not all of it was tested for lying inside a solid,
    /// down to pieces of 0.6 % of the longest side. A larger piece then counts as outside if a part
    /// of it is, which may overstate the error.
    pub boundary_coarse: bool,
    /// Whether fits ended early, after a fixed amount of work, because the surface is so tangled that its nearest
    /// points take long to find: they may not have reached the least error.
    pub fit_cut_short: bool,
    /// Whether solid patches overlap, or one passes through itself.
    pub overlapping: bool,
    /// How the mass properties were computed.
    pub mass: MassSource,
}

/// How the mass properties of a built mesh were computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MassSource {
    /// The closed surface of the triangle mesh, exactly.
    #[default]
    Surface,
    /// The solid patches of the triangle mesh, with overlaps counted once, by integration along lines: exact to about a
    /// thousandth.
    Lines,
    /// The medial mesh, because the triangle mesh encloses nothing.
    MedialMesh,
}

/// One triangle, and several.
const TRIANGLES: [&str; 2] = ["triangle", "triangles"];

/// A number of things, named by the words for one and for several.
fn counted(count: usize, [one, several]: [&str; 2]) -> String {
    match count {
        1 => format!("1 {one}"),
        _ => format!("{count} {several}"),
    }
}

impl Findings {
    /// Sentences on vertices, triangles and edges.
    fn counts_in_words(&self) -> Vec<String> {
        let counts = [
            (
                self.vertices_unused,
                ["vertex is", "vertices are"],
                "used by no triangle",
            ),
            (
                self.vertices_welded,
                ["vertex", "vertices"],
                "welded to another at the same place",
            ),
            (
                self.triangles_collapsed,
                TRIANGLES,
                "of fewer than three points: kept as segments only",
            ),
            (
                self.triangles_repeated,
                ["repeated triangle", "repeated triangles"],
                "dropped",
            ),
            (
                self.triangles_shared,
                TRIANGLES,
                "between touching parts dropped: the solid is on both sides of them",
            ),
            (
                self.triangles_without_area,
                TRIANGLES,
                "without area: kept as seams only",
            ),
            (
                self.slivers,
                ["sliver", "slivers"],
                "added along seams where one edge meets several",
            ),
            (
                self.edges_open,
                ["open edge", "open edges"],
                "(edges of one triangle)",
            ),
            (
                self.edges_crowded,
                ["non-manifold edge", "non-manifold edges"],
                "(edges of more than two triangles)",
            ),
            (
                self.edges_twisted,
                ["edge", "edges"],
                "whose triangles cannot be made to face the same way",
            ),
            (self.triangles_turned, TRIANGLES, "turned to face outward"),
        ];
        let found = counts.into_iter().filter(|(count, ..)| *count > 0);
        let say = |(count, names, what)| format!("{} {what}", counted(count, names));
        found.map(say).collect()
    }

    /// Sentences that a user should know.
    pub(crate) fn notes(&self) -> Vec<String> {
        let mut notes = self.counts_in_words();
        let sheets = self.patches_sheet > 0;
        if sheets || self.patches_mended > 0 || self.patches > 1 {
            notes.push(self.patches_in_words());
        }
        if self.triangles_thin > 0 {
            notes.push(format!(
                "{} where the solid is too thin for spheres: built as sheets",
                counted(self.triangles_thin, TRIANGLES)
            ));
        }
        if self.triangles_buried > 0 {
            notes.push("parts of sheets that lie inside solid matter are left out".into());
        }
        if self.overlapping {
            notes
                .push("solid pieces overlap or pass through themselves: built as one solid".into());
        }
        match self.mass {
            MassSource::Surface => {}
            MassSource::Lines => notes.push(
                "mass properties are exact to about a thousandth, because the solid's surface overlaps or has openings"
                    .into(),
            ),
            MassSource::MedialMesh => notes.push(
                "mass properties are those of the medial mesh, because the triangle mesh encloses no volume".into(),
            ),
        }
        if sheets && self.mass != MassSource::MedialMesh {
            notes.push("sheets add nothing to the mass, because they have no volume".into());
        }
        notes
    }

    /// Sentences on what was left undone because the surface is tangled: the boundary of the solid is coarse, fits
    /// ended early.
    pub(crate) fn undone_in_words(&self) -> impl Iterator<Item = String> + use<> {
        let coarse = "the surface is so tangled that only large pieces of it were tested for lying inside solid matter: \
                    the error may be overstated";
        let cut_short = "the surface is so tangled that the fit was ended after a fixed amount of work: a smaller error \
                         may be possible with this many primitives";
        let said = [
            (self.boundary_coarse, coarse),
            (self.fit_cut_short, cut_short),
        ];
        said.into_iter().filter(|s| s.0).map(|s| s.1.into())
    }

    /// Sentence on what is hidden inside matter, `share` of the area.
    pub(crate) fn hidden_in_words(&self, share: f64) -> String {
        let mut text = format!(
            "{:.1} % of the mesh's area lies inside solid matter and does not count in the error: {} and parts of others",
            100.0 * share,
            counted(self.triangles_hidden, TRIANGLES)
        );
        if self.patches_hidden > 0 {
            // Writing to a string does not fail.
            let pieces = counted(self.patches_hidden, ["piece is", "pieces are"]);
            let _ = write!(text, "; {pieces} hidden entirely");
        }
        text
    }

    fn patches_in_words(&self) -> String {
        let mut text = format!(
            "{} of surface: {} solid",
            counted(self.patches, ["connected piece", "connected pieces"]),
            self.patches_solid
        );
        // Writing to a string does not fail.
        if self.patches_mended > 0 {
            let _ = write!(
                text,
                " ({} with small openings, closed)",
                self.patches_mended
            );
        }
        if self.patches_cavity > 0 {
            let cavities = counted(self.patches_cavity, ["cavity", "cavities"]);
            let _ = write!(text, " ({cavities})");
        }
        if self.patches_sheet > 0 {
            let _ = write!(text, ", {} built as sheets", self.patches_sheet);
        }
        if self.patches_flat > 0 {
            let _ = write!(text, " ({} closed but without volume)", self.patches_flat);
        }
        text
    }
}
