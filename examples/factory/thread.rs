//! Metric screw threads with the proportions of ISO 68-1: the analytic profile in double precision, a medial mesh
//! planted on it, and a triangle mesh of it.
//!
//! A ridge of 60° is a strip of slabs wound round the axis. In its cross-section a sphere whose centre is `d` below the
//! apex of the two flanks touches both where its radius is `d sin 30° = d / 2`. The strip lies between a helix of such
//! spheres at the crest and one whose spheres touch the flanks at the root; a cone is the bolt's core. The nut's
//! spheres of the root overlap from turn to turn, so its strip is its wall. All is about the y axis, in metres, and
//! right-handed.

use super::solid::Mesh;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::f64::consts::TAU;

/// A nut and its bolt.
#[derive(Clone, Copy, Debug)]
pub struct Thread {
    /// What it is called.
    pub name: &'static str,
    /// Diameter of the nut's thread at its root, metres.
    pub diameter: f64,
    /// Rise in a turn, metres.
    pub pitch: f64,
    /// Radial play between crest and root, metres.
    pub play: f64,
    /// Height of the nut and distance of its flats, metres.
    pub nut: [f64; 2],
    /// Straight pieces in a turn of the bolt. The more there are, the closer it is to the true thread, and the more
    /// contacts there are to solve.
    pub pieces: usize,
}

const fn metric(name: &'static str, mm: [f64; 5], pieces: usize) -> Thread {
    let [diameter, pitch, play, height, flats] = mm;
    Thread {
        name,
        diameter: 1.0e-3 * diameter,
        pitch: 1.0e-3 * pitch,
        play: 1.0e-3 * play,
        nut: [1.0e-3 * height, 1.0e-3 * flats],
        pieces,
    }
}

/// From Factory's loosest to its tightest: the play of M20 loose and M8 tight is Factory's, that of the others has the
/// same share of the pitch (0.228 loose, 0.12 tight).
pub const THREADS: [Thread; 5] = [
    metric("M20 loose", [20.0, 2.5, 0.57, 18.0, 30.0], 20),
    metric("M16 loose", [16.0, 2.0, 0.456, 14.8, 24.0], 20),
    metric("M12 loose", [12.0, 1.75, 0.399, 10.8, 18.0], 20),
    metric("M12 tight", [12.0, 1.75, 0.21, 10.8, 18.0], 24),
    metric("M8 tight", [8.0, 1.25, 0.15, 6.8, 13.0], 24),
];

/// Which of the two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Part {
    Bolt,
    Nut,
}

impl Thread {
    /// Height of the triangle of two flanks, metres.
    fn height(&self) -> f64 {
        self.pitch * 0.75_f64.sqrt()
    }

    /// Radii of crest and root, metres.
    pub fn radii(&self, part: Part) -> [f64; 2] {
        let [outer, inner] = [
            0.5 * self.diameter,
            0.5 * self.diameter - 0.625 * self.height(),
        ];
        match part {
            Part::Bolt => [outer - self.play, inner - self.play],
            Part::Nut => [inner, outer],
        }
    }

    /// Radius of the surface at a distance along the axis from the middle of the nearest ridge, metres.
    pub fn surface(&self, part: Part, from_ridge: f64) -> f64 {
        let [crest, root] = self.radii(part);
        let slope = 3.0_f64.sqrt();
        match part {
            Part::Bolt => (crest - slope * (from_ridge - self.pitch / 16.0).max(0.0)).max(root),
            Part::Nut => (crest + slope * (from_ridge - self.pitch / 8.0).max(0.0)).min(root),
        }
    }

    /// Distance along the axis from the middle of the nearest ridge of a point at an angle about the axis, metres.
    pub fn past_ridge(&self, part: Part, angle: f64, y: f64) -> f64 {
        let ahead = if part == Part::Bolt { 0.0 } else { 0.5 };
        let turns = y / self.pitch - angle / TAU - ahead;
        (turns - turns.round()).abs() * self.pitch
    }

    /// How deep a point is inside of the endless bolt, metres; normal to the flanks, negative outside.
    pub fn depth_in_bolt(&self, [x, y, z]: [f64; 3]) -> f64 {
        let from_ridge = self.past_ridge(Part::Bolt, (-z).atan2(x), y);
        let [crest, root] = self.radii(Part::Bolt);
        let r = x.hypot(z);
        // Along the flank's normal it is half of the distance along the radius.
        let flank = 0.5 * (crest - 3.0_f64.sqrt() * (from_ridge - self.pitch / 16.0) - r);
        flank.min(crest - r).max(root - r)
    }

    /// How far a nut can go along the axis to either side, metres.
    pub fn axial_play(&self) -> f64 {
        self.play / 3.0_f64.sqrt()
    }

    /// Straight pieces in a turn. Were they as many in both, all corners would pass chords at once.
    fn pieces_of(&self, part: Part) -> usize {
        match part {
            Part::Bolt => self.pieces,
            Part::Nut => self.pieces * 27 / 32,
        }
    }

    /// Radii of the helices of spheres at crest and root, and the spheres' radii, metres.
    fn helices(&self, part: Part) -> [[f64; 2]; 2] {
        let pieces = self.pieces_of(part);
        let h = self.height();
        let [crest, _] = self.radii(part);
        // Chords lie half of their sagitta outside, half of it inside of the helix.
        let wider = 1.0 + 0.5 * (1.0 - (0.5 * TAU / pieces as f64).cos());
        let at = |below_apex: f64| match part {
            Part::Bolt => [(crest + 0.125 * h - below_apex) * wider, 0.5 * below_apex],
            Part::Nut => [(crest - 0.25 * h + below_apex) * wider, 0.5 * below_apex],
        };
        let top = if part == Part::Bolt { 0.25 } else { 0.5 };
        [at(top * h), at(7.0 / 6.0 * h)]
    }

    /// The medial mesh of a part whose ridge goes from one height to another, metres.
    pub fn medial(&self, part: Part, heights: [f64; 2]) -> Result<MedialMesh, MeshError> {
        let [low, high] = heights.map(|y| y / self.pitch);
        let pieces = self.pieces_of(part);
        let count = ((high - low) * pieces as f64).round().max(1.0) as u32;
        let ahead = if part == Part::Bolt { 0.0 } else { 0.5 };
        let mut spheres = Vec::new();
        for k in 0..=count {
            let turns = low + (high - low) * f64::from(k) / f64::from(count);
            let (sin, cos) = (TAU * (turns - ahead)).sin_cos();
            for [far, radius] in self.helices(part) {
                let center = [far * cos, turns * self.pitch, -far * sin].map(|c| c as Real);
                spheres.push(MedialSphere::new(
                    Vector::from_array(center),
                    radius as Real,
                ));
            }
        }
        let piece = |k: u32| {
            [
                [2 * k, 2 * k + 1, 2 * k + 2],
                [2 * k + 1, 2 * k + 3, 2 * k + 2],
            ]
        };
        let faces = (0..count).flat_map(piece).collect();
        let mut edges = Vec::new();
        if part == Part::Bolt {
            let [_, root] = self.radii(part);
            for y in heights {
                spheres.push(MedialSphere::new(Vector::Y * y as Real, root as Real));
            }
            edges.push([2 * count + 2, 2 * count + 3]);
        }
        let mesh = MedialMesh::new(spheres, edges, faces)?;
        Ok(match part {
            Part::Bolt => mesh,
            Part::Nut => mesh.with_mass_properties(self.nuts_mass()),
        })
    }

    /// Heights of the ridge of a nut whose middle is at the origin, metres.
    pub fn nuts_heights(&self) -> [f64; 2] {
        let half = 0.5 * (self.nut[0] - self.pitch);
        [-half, half]
    }

    /// Mass properties of the nut at density 1, those of a ring as heavy as a hexagonal nut.
    pub fn nuts_mass(&self) -> MassProperties {
        let [height, flats] = self.nut;
        let [inner, outer] = [0.5 * self.diameter, 0.525 * flats].map(|r| r * r);
        let mass = 0.5 * TAU * height * (outer - inner);
        let about = 0.5 * mass * (outer + inner);
        let across = 0.5 * about + mass * height * height / 12.0;
        let inertia = [across, about, across].map(|i| i as Real);
        MassProperties::new(Vector::ZERO, mass as Real, Vector::from_array(inertia))
    }

    /// Acceleration of a nut that goes down without friction, led by its thread, m/s².
    pub fn acceleration(&self) -> f64 {
        let mass = self.nuts_mass();
        let about = f64::from(mass.principal_inertia().y) * f64::from(mass.inv_mass);
        9.81 / (1.0 + about * (TAU / self.pitch).powi(2))
    }

    /// Radius in the middle of where the flanks touch, metres.
    pub fn middle(&self) -> f64 {
        0.5 * (self.radii(Part::Bolt)[0] + self.radii(Part::Nut)[0])
    }

    /// Friction above which the nut does not go down by its weight, by theory: the tangent of the slope of the thread
    /// where the flanks touch, times the cosine of half the angle of the flanks.
    pub fn locks_at(&self) -> f64 {
        self.pitch / (TAU * self.middle()) * 0.75_f64.sqrt()
    }

    /// A closed triangle mesh of the part between two heights, metres.
    pub fn triangles(&self, part: Part, [low, high]: [f64; 2], around: usize) -> Mesh {
        let rows = (16.0 * (high - low) / self.pitch).round() as usize;
        let outer = |angle: f64, y: f64| match part {
            Part::Bolt => self.surface(part, self.past_ridge(part, angle, y)),
            Part::Nut => {
                // A hexagon.
                let to_flat = (angle * 6.0 / TAU + 0.5).rem_euclid(1.0) - 0.5;
                0.5 * self.nut[1] / (to_flat * TAU / 6.0).cos()
            }
        };
        let inner = |angle: f64, y: f64| self.surface(part, self.past_ridge(part, angle, y));
        let heights: Vec<f64> = (0..=rows)
            .map(|k| low + (high - low) * k as f64 / rows as f64)
            .collect();
        match part {
            Part::Bolt => Mesh::lathe(&heights, around, outer, None::<fn(f64, f64) -> f64>),
            Part::Nut => Mesh::lathe(&heights, around, outer, Some(inner)),
        }
    }
}
