//! A mesh with what is known of it, and the check of what is built from it.
//!
//! Coverage is checked by points of every triangle against `oracle`, which shares no code with the
//! crate.

use crate::broken::*;
use crate::meshes::*;
use crate::oracle;
use parry3d::math::Vector;
use rapier3d_medial::Quality;
use rapier3d_medial::meshing::{Findings, MassSource};
use rapier3d_medial::{BuildOptions, MedialMesh, MedialSphere};

/// Primitives of each build. Few, so that errors are large and soon measured.
pub const PRIMITIVES: usize = 16;

/// A mesh, and what is planted in it.
pub struct Case {
    pub name: &'static str,
    pub mesh: Mesh,
    /// Patches that are solid, and that are sheets.
    pub patches: (usize, usize),
    /// Volume enclosed, and its relative tolerance; none where nothing is.
    pub volume: Option<(f32, f32)>,
    /// Points inside matter and points outside the solid, by at least a hundredth of the size.
    pub inside: Vec<Vector>,
    pub outside: Vec<Vector>,
    /// Largest error allowed, over the longest side.
    pub error: f32,
    pub primitives: usize,
    /// What else the findings must say.
    pub found: fn(&Findings) -> bool,
}

pub fn case(name: &'static str, mesh: Mesh, patches: (usize, usize)) -> Case {
    Case {
        name,
        mesh,
        patches,
        volume: None,
        inside: vec![],
        outside: vec![],
        error: 0.25,
        primitives: PRIMITIVES,
        found: |_| true,
    }
}

impl Case {
    pub fn volume(mut self, volume: f32, tolerance: f32) -> Self {
        self.volume = Some((volume, tolerance));
        self
    }

    pub fn inside(mut self, points: &[[f32; 3]]) -> Self {
        self.inside = points.iter().map(|&p| p.into()).collect();
        self
    }

    pub fn outside(mut self, points: &[[f32; 3]]) -> Self {
        self.outside = points.iter().map(|&p| p.into()).collect();
        self
    }

    pub fn error(mut self, error: f32) -> Self {
        self.error = error;
        self
    }

    pub fn primitives(mut self, primitives: usize) -> Self {
        self.primitives = primitives;
        self
    }

    pub fn found(mut self, found: fn(&Findings) -> bool) -> Self {
        self.found = found;
        self
    }

    pub fn check(&self) -> Result<(), String> {
        let mut options = BuildOptions::default();
        options.quality = Quality::Fast;
        options.primitives = Some(self.primitives);
        let Mesh { vertices, indices } = &self.mesh;
        let (medial, report) =
            MedialMesh::from_trimesh(vertices, indices, &options).map_err(|e| e.to_string())?;
        let findings = &report.findings;
        let side = report.longest_side;
        let ensure = |right: bool, what: String| match right {
            true => Ok(()),
            false => Err(format!("{what}; {findings:?}; {:?}", report.notes)),
        };
        let h = report.hausdorff;
        let error = h.surface_to_envelope.max(h.envelope_to_surface) / side;
        ensure(
            medial.primitive_count() <= self.primitives,
            "too many primitives".into(),
        )?;
        ensure(error <= self.error, format!("error {error}"))?;
        let magnitude = vertices
            .iter()
            .map(|v| v.abs().max_element())
            .fold(side, f32::max);
        let rounding = 4.0 * f32::EPSILON * magnitude;
        ensure(
            h.uncovered <= rounding,
            format!("uncovered {}", h.uncovered),
        )?;
        let (points, out) = uncovered(&medial, &self.mesh, side, rounding);
        ensure(out == 0, format!("{out} of {points} points uncovered"))?;
        ensure(points > 100, format!("only {points} points"))?;
        let patches = (findings.patches_solid, findings.patches_sheet);
        ensure(patches == self.patches, format!("patches {patches:?}"))?;
        ensure((self.found)(findings), "findings".into())?;
        let mass = medial.mass_properties(1.0).mass();
        match self.volume {
            Some((volume, tolerance)) => {
                let off = (mass / volume - 1.0).abs();
                ensure(off <= tolerance, format!("mass {mass}, volume {volume}"))?;
                ensure(
                    findings.mass != MassSource::MedialMesh,
                    "mass source".into(),
                )?;
            }
            None => ensure(
                findings.mass == MassSource::MedialMesh,
                "mass source".into(),
            )?,
        }
        let grown = |p: &Vector, by: f32| holds(&medial, *p, by);
        for p in &self.inside {
            ensure(grown(p, -0.01 * side), format!("{p} is not inside"))?;
        }
        for p in &self.outside {
            ensure(!grown(p, 0.01 * side), format!("{p} is not outside"))?;
        }
        Ok(())
    }
}

pub fn ball_volume() -> f32 {
    volume(&ball(1.0))
}

/// Whether the solid, with radii grown, holds a point.
pub fn holds(medial: &MedialMesh, p: Vector, grow: f32) -> bool {
    let p = p.to_array().map(f64::from);
    medial.primitives().any(|primitive| {
        let grown = |s: &MedialSphere| MedialSphere::new(s.center, (s.radius + grow).max(0.0));
        let spheres: Vec<_> = primitive.spheres().iter().map(grown).collect();
        // The quadratic loses its digits on needles.
        !oracle::beyond_box(&spheres, p, 0.0)
            && (oracle::covers(&spheres, p) || oracle::signed_distance(&spheres, p) <= 0.0)
    })
}

/// Points of all triangles, and how many of them the solid does not hold.
pub fn uncovered(medial: &MedialMesh, mesh: &Mesh, side: f32, rounding: f32) -> (usize, usize) {
    let points = mesh.dense_points(0.04 * side);
    let out = points
        .iter()
        .filter(|p| !holds(medial, **p, rounding))
        .count();
    (points.len(), out)
}

#[track_caller]
pub fn all_pass(cases: Vec<Case>) {
    let tried = cases.len();
    let failures: Vec<String> = cases
        .iter()
        .filter_map(|c| c.check().err().map(|e| format!("{}: {e}", c.name)))
        .collect();
    assert!(
        failures.is_empty(),
        "{} of {tried}:\n{}",
        failures.len(),
        failures.join("\n")
    );
}
