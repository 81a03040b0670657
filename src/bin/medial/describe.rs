//! Descriptions of a medial mesh and of its errors, as the program prints them.

use rapier3d_medial::meshing::Hausdorff;
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

/// Contents of a medial mesh. Lengths are in the file's unit.
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
    /// Spheres less edges plus faces: 1 for a ball, 0 for a ring, −1 for a pair of glasses.
    euler: i64,
    /// Mass at density 1, in the file's unit; of the source mesh where the file has it.
    mass: f32,
    center_of_mass: [f32; 3],
    principal_inertia: [f32; 3],
}

pub fn describe(mesh: &MedialMesh) -> Description {
    let count = |kind: fn(&MedialPrimitive) -> bool| mesh.primitives().filter(kind).count();
    let aabb = mesh.aabb();
    let mass = mesh.mass_properties(1.0);
    let [spheres, edges, faces] = [mesh.spheres().len(), mesh.edges().len(), mesh.faces().len()];
    Description {
        spheres,
        primitives: mesh.primitive_count(),
        slabs: count(|p| matches!(p, MedialPrimitive::Slab(_))),
        cones: count(|p| matches!(p, MedialPrimitive::Cone(_))),
        lone_spheres: count(|p| matches!(p, MedialPrimitive::Sphere(_))),
        box_min: aabb.mins.to_array(),
        box_max: aabb.maxs.to_array(),
        thickness: mesh.thickness(),
        euler: spheres as i64 - edges as i64 + faces as i64,
        mass: mass.mass(),
        center_of_mass: mass.local_com.to_array(),
        principal_inertia: mass.principal_inertia().to_array(),
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
        let side = (0..3).map(|axis| self.box_max[axis] - self.box_min[axis]);
        let side = side.fold(0.0, f32::max);
        // Millionths of the size are rounding.
        let point = |[x, y, z]: [f32; 3], size: f32| {
            let round = |c: f32| if c.abs() < 1e-6 * size { 0.0 } else { c };
            format!("({}, {}, {})", round(x), round(y), round(z))
        };
        let [lo, hi] = [self.box_min, self.box_max].map(|corner| point(corner, side));
        format!(
            "spheres     {}\nprimitives  {}: slabs {}, cones {}, lone spheres {}\n\
             box         {lo} to {hi}\nthickness   {}\nEuler       {}\n\
             mass        {} at density 1, centre {}, principal inertia {}\n",
            self.spheres,
            self.primitives,
            self.slabs,
            self.cones,
            self.lone_spheres,
            self.thickness,
            self.euler,
            self.mass,
            point(self.center_of_mass, side),
            point(self.principal_inertia, 0.0),
        )
    }
}

impl Errors {
    pub fn text(&self, title: &str) -> String {
        // The smaller of the two is not searched for to the end.
        let or_more = match self.envelope_to_surface < self.surface_to_envelope {
            true => " or more",
            false => "",
        };
        format!(
            "{title}, as fractions of the triangle mesh's longest side\n\
             \x20 mesh to collider     {:.5}\n  collider to mesh     {:.5}{or_more}\n\
             \x20 mesh sticks out by   {:.5}\n\
             \x20 all may be larger by {:.5} between the points measured\n",
            self.surface_to_envelope, self.envelope_to_surface, self.uncovered, self.sampling,
        )
    }
}
