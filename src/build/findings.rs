//! What was found in a source mesh and what was done about it: counts, and in words.

use std::fmt::Write as _;

/// What a build found in its triangle mesh and did about it. All are counts.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Findings {
    /// Vertices that no triangle uses.
    pub vertices_unused: usize,
    /// Vertices that became one with another at the same place (within 1e-6 of the longest side).
    pub vertices_welded: usize,
    /// Triangles of which two corners are one vertex. As segments or points they are covered, and measured
    /// as far as they stick out, and count for nothing else.
    pub triangles_collapsed: usize,
    /// Triangles dropped because another has the same corners, in whatever order.
    pub triangles_repeated: usize,
    /// Triangles without area: they join their neighbours and are covered, and count for nothing
    /// else.
    pub triangles_without_area: usize,
    /// Triangles turned round.
    pub triangles_turned: usize,
    /// Slivers without area that close seams, where a triangle's edge meets several of others.
    pub slivers: usize,
    /// Edges of one triangle.
    pub edges_open: usize,
    /// Edges of more than two triangles.
    pub edges_crowded: usize,
    /// Edges whose triangles cannot be made to face the same way.
    pub edges_twisted: usize,
    /// Patches: triangles joined across edges of two.
    pub patches: usize,
    /// Patches that bound solid matter, alone or together.
    pub patches_solid: usize,
    /// Of those, patches with openings that were taken for damage and closed.
    pub patches_mended: usize,
    /// Of those, closed shells that face inward: cavities.
    pub patches_cavity: usize,
    /// Patches built as sheets, which have no inside.
    pub patches_sheet: usize,
    /// Of those, closed ones: they enclose no volume.
    pub patches_flat: usize,
    /// Triangles of solid patches built as sheets, because matter is too thin there to hold balls.
    pub triangles_thin: usize,
    /// Triangles of sheets, after long edges are halved, left out because they lie inside solid
    /// matter.
    pub triangles_buried: usize,
    /// Triangles that lie inside solid matter all over: they count for nothing in the error.
    pub triangles_hidden: usize,
    /// Patches of such triangles only.
    pub patches_hidden: usize,
    /// Whether solid patches overlap, or one passes through itself.
    pub overlapping: bool,
    /// Where the mass properties are from.
    pub mass: MassSource,
}

/// Where the mass properties of a built mesh are from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MassSource {
    /// The source's closed surface, exactly.
    #[default]
    Surface,
    /// The source's solid patches, overlaps counted once, integrated along lines.
    Lines,
    /// The medial mesh: the source encloses nothing.
    MedialMesh,
}

impl Findings {
    /// What a user should know, a sentence each.
    pub(super) fn notes(&self) -> Vec<String> {
        let counts = [
            (self.vertices_unused, "vertices are used by no triangle"),
            (
                self.vertices_welded,
                "vertices welded to another at the same place",
            ),
            (
                self.triangles_collapsed,
                "triangles of fewer than three points: kept as segments only",
            ),
            (self.triangles_repeated, "repeated triangles dropped"),
            (
                self.triangles_without_area,
                "triangles without area: kept as seams only",
            ),
            (
                self.slivers,
                "slivers added along seams where one edge meets several",
            ),
            (self.edges_open, "open edges (edges of one triangle)"),
            (
                self.edges_crowded,
                "non-manifold edges (edges of more than two triangles)",
            ),
            (
                self.edges_twisted,
                "edges whose triangles cannot be made to face the same way",
            ),
            (self.triangles_turned, "triangles turned to face outward"),
        ];
        let say = |&(count, what): &(usize, &str)| format!("{count} {what}");
        let mut notes: Vec<String> = counts.iter().filter(|c| c.0 > 0).map(say).collect();
        let sheets = self.patches_sheet > 0;
        if sheets || self.patches_mended > 0 || self.patches > 1 {
            notes.push(self.patches_in_words());
        }
        if self.triangles_thin > 0 {
            let count = self.triangles_thin;
            notes.push(format!(
                "{count} triangles where matter is too thin for balls: built as sheets"
            ));
        }
        if self.triangles_buried > 0 {
            notes.push("parts of sheets that lie inside solid matter are left out".into());
        }
        if self.overlapping {
            notes.push("solid patches overlap or pass through themselves: built as one".into());
        }
        match self.mass {
            MassSource::Surface => {}
            MassSource::Lines => notes.push(
                "mass properties are within about a thousandth: the solid part's surface overlaps \
                 or has openings, so that they are summed along lines"
                    .into(),
            ),
            MassSource::MedialMesh => notes.push(
                "mass properties are those of the medial mesh: the source encloses nothing".into(),
            ),
        }
        if sheets && self.mass != MassSource::MedialMesh {
            notes.push("sheets count nothing in the mass properties: they have no volume".into());
        }
        notes
    }

    /// What is hidden inside matter: `share` of the area.
    pub(super) fn hidden_in_words(&self, share: f64) -> String {
        let mut text = format!(
            "{:.1} % of the source's area lies inside solid matter, and counts for nothing in the error: {} triangles \
             and parts of others",
            100.0 * share,
            self.triangles_hidden
        );
        if self.patches_hidden > 0 {
            // Writing to a string does not fail.
            let _ = write!(text, "; {} patches are hidden whole", self.patches_hidden);
        }
        text
    }

    fn patches_in_words(&self) -> String {
        let mut text = format!("{} patches: {} solid", self.patches, self.patches_solid);
        // Writing to a string does not fail.
        if self.patches_mended > 0 {
            let _ = write!(
                text,
                " ({} with small openings, closed)",
                self.patches_mended
            );
        }
        if self.patches_cavity > 0 {
            let _ = write!(text, " ({} cavities)", self.patches_cavity);
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
