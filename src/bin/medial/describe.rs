//! What the program says of a medial mesh and of its errors.

use rapier3d_medial::build::Hausdorff;
use rapier3d_medial::{MedialMesh, MedialPrimitive};
use serde::Serialize;

/// Both Hausdorff distances, as fractions of the longest side of the source's box.
#[derive(Serialize)]
pub struct Errors {
    surface_to_envelope: f32,
    envelope_to_surface: f32,
    uncovered: f32,
    sampling: f32,
}

/// What a medial mesh is made of. Lengths in the file's unit.
#[derive(Serialize)]
pub struct Description {
    spheres: usize,
    primitives: usize,
    slabs: usize,
    cones: usize,
    lone_spheres: usize,
    box_min: [f32; 3],
    box_max: [f32; 3],
    thickness: f32,
}

pub fn describe(mesh: &MedialMesh) -> Description {
    let count = |kind: fn(&MedialPrimitive) -> bool| mesh.primitives().filter(kind).count();
    let aabb = mesh.aabb();
    Description {
        spheres: mesh.spheres().len(),
        primitives: mesh.primitive_count(),
        slabs: count(|p| matches!(p, MedialPrimitive::Slab(_))),
        cones: count(|p| matches!(p, MedialPrimitive::Cone(_))),
        lone_spheres: count(|p| matches!(p, MedialPrimitive::Sphere(_))),
        box_min: aabb.mins.to_array(),
        box_max: aabb.maxs.to_array(),
        thickness: mesh.thickness(),
    }
}

pub fn relative(hausdorff: &Hausdorff, longest_side: f32) -> Errors {
    Errors {
        surface_to_envelope: hausdorff.surface_to_envelope / longest_side,
        envelope_to_surface: hausdorff.envelope_to_surface / longest_side,
        uncovered: hausdorff.uncovered / longest_side,
        sampling: hausdorff.sampling / longest_side,
    }
}

impl Description {
    pub fn text(&self) -> String {
        let [lo, hi] = [self.box_min, self.box_max].map(|[x, y, z]| format!("({x}, {y}, {z})"));
        format!(
            "spheres     {}\nprimitives  {}: slabs {}, cones {}, lone spheres {}\n\
             box         {lo} to {hi}\nthickness   {}\n",
            self.spheres,
            self.primitives,
            self.slabs,
            self.cones,
            self.lone_spheres,
            self.thickness,
        )
    }
}

impl Errors {
    pub fn text(&self, title: &str) -> String {
        format!(
            "{title} (longest side of the source's box = 1)\n\
             \x20 surface to envelope  {:.5}\n  envelope to surface  {:.5}\n\
             \x20 uncovered            {:.5}\n\
             \x20 between samples      {:.5} more at most\n",
            self.surface_to_envelope, self.envelope_to_surface, self.uncovered, self.sampling,
        )
    }
}
