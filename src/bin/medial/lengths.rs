//! Lengths given with a unit or without, and the units that files are in.

use rapier3d_medial::math::Vector;
use rapier3d_medial::meshing::mesh_file::{MeshFormat, TriangleMesh};
use std::path::Path;
use std::str::FromStr;

/// Units and their lengths (m).
const UNITS: [(&str, f64); 8] = [
    ("um", 1e-6),
    ("µm", 1e-6),
    ("mm", 1e-3),
    ("cm", 1e-2),
    ("m", 1.0),
    ("km", 1e3),
    ("in", 0.0254),
    ("ft", 0.3048),
];

/// A unit of length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    name: &'static str,
    /// Length of the unit (m).
    meters: f64,
}

impl FromStr for Unit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = UNITS.iter().find(|u| u.0 == text);
        found
            .map(|&(name, meters)| Self { name, meters })
            .ok_or_else(|| {
                let known = UNITS.map(|u| u.0).join(", ");
                format!("unknown unit {text:?}; known are {known}")
            })
    }
}

/// A positive length, in a unit of its own or in the mesh's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Length {
    value: f64,
    unit: Option<Unit>,
}

impl FromStr for Length {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        // The whole text is read as a number first: the e of 2e-5 and the letters of `inf` and `NaN` are no unit.
        let (number, unit) = match text.parse::<f64>() {
            Ok(number) => (number, None),
            Err(_) => {
                let is_unit = |c: char| c.is_alphabetic();
                let number = text.trim_end_matches(is_unit);
                let unit = text[number.len()..].parse()?;
                let number = number.trim_end().parse();
                let wanted = "must be a number, with or without a unit, as 0.02mm";
                (number.map_err(|_| wanted.to_owned())?, Some(unit))
            }
        };
        match number.is_finite() && number > 0.0 {
            true => Ok(Self {
                value: number,
                unit,
            }),
            false => Err("must be positive and finite".into()),
        }
    }
}

/// A tolerance has a unit, and the mesh has none.
#[derive(Debug, thiserror::Error)]
#[error(
    "{path}: a tolerance of {value}{unit} needs the unit of the mesh: say --unit mm (or cm, m, in, …), or give \
     the tolerance in the mesh's own unit"
)]
pub struct UnitUnknown {
    path: String,
    value: f64,
    unit: &'static str,
}

impl Length {
    /// The length in the unit of a file, which `unit` says; a glTF scene is in metres.
    pub fn in_unit_of(self, path: &Path, unit: Option<Unit>) -> Result<f64, UnitUnknown> {
        let Some(own) = self.unit else {
            return Ok(self.value);
        };
        let meters = match (unit, MeshFormat::of(path)) {
            (Some(unit), _) => unit.meters,
            (None, Some(MeshFormat::Gltf)) => 1.0,
            (None, _) => {
                return Err(UnitUnknown {
                    path: path.display().to_string(),
                    value: self.value,
                    unit: own.name,
                });
            }
        };
        Ok(self.value * own.meters / meters)
    }
}

/// Longest side of the box of the vertices that triangles use.
pub fn longest_side(mesh: &TriangleMesh) -> f32 {
    let corners = mesh.indices.iter().flatten();
    let points = corners.filter_map(|&v| mesh.vertices.get(v as usize));
    let (lo, hi) = points.fold((Vector::MAX, Vector::MIN), |(lo, hi), p| {
        (lo.min(*p), hi.max(*p))
    });
    (hi - lo).max_element()
}
