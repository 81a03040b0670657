//! Debug lines of medial colliders (feature `debug-render`). rapier's debug renderer draws nothing for custom
//! shapes, so call [`MedialDebugRender::render`] after its own `render`.

use crate::math::{Pose, Real, Vector};
use crate::medial::MedialMesh;
use crate::pair::contacts;
use rapier3d::dynamics::{RigidBody, RigidBodySet, RigidBodyType};
use rapier3d::geometry::{Collider, ColliderSet, NarrowPhase};
use rapier3d::pipeline::{
    DebugColor, DebugRenderBackend, DebugRenderMode, DebugRenderObject, DebugRenderPipeline,
    DebugRenderStyle,
};
use std::collections::{HashMap, HashSet};

/// Steps along the longest side of a body's box, for the lines of its envelope (a count).
const STEPS: Real = 24.0;

/// Segments of a circle (a count).
const CIRCLE: u32 = 24;

/// Brightness of the medial mesh's lines against those of the envelope (a ratio of each channel).
const MEDIAL_SHADE: [f32; 4] = [0.5, 0.5, 0.5, 1.0];

/// Draws medial colliders with the style, mode and backend of rapier's debug renderer. Keep one and call
/// [`Self::render`] in each frame.
///
/// The lines of a mesh are computed when it is first seen, once for all colliders that share its data, and dropped
/// when no collider with it is drawn any more.
///
/// ```
/// use rapier3d::prelude::*;
/// use rapier3d_medial::rapier::MedialDebugRender;
///
/// fn draw(
///     world: &PhysicsWorld,
///     rapier: &DebugRenderPipeline,
///     medial: &mut MedialDebugRender,
///     lines: &mut impl DebugRenderBackend,
/// ) {
///     // After rapier.render(lines, …):
///     medial.render(rapier, lines, &world.bodies, &world.colliders, &world.narrow_phase);
/// }
/// ```
pub struct MedialDebugRender {
    /// Whether to draw the surface of the solid. On by default.
    pub envelope: bool,
    /// Whether to draw the lines between the centres of neighbouring spheres, at half the brightness. On by default.
    pub medial_mesh: bool,
    /// Whether to draw the spheres that touch where two medial colliders are in contact: a circle of each around the
    /// contact normal, and the normal. Off by default.
    pub sphere_pairs: bool,
    outlines: HashMap<usize, MeshLines>,
}

struct MeshLines {
    /// Keeps the data alive, whose address is the key.
    mesh: MedialMesh,
    vertices: Vec<Vector>,
    edges: Vec<[u32; 2]>,
}

impl Default for MedialDebugRender {
    fn default() -> Self {
        Self {
            envelope: true,
            medial_mesh: true,
            sphere_pairs: false,
            outlines: HashMap::new(),
        }
    }
}

impl MedialDebugRender {
    /// Draws medial colliders as rapier's `pipeline` draws others: only with [`DebugRenderMode::COLLIDER_SHAPES`], only
    /// what the backend's filter lets through, and in the colours of the body's type and state. Touching
    /// spheres are drawn only with [`DebugRenderMode::CONTACTS`].
    pub fn render(
        &mut self,
        pipeline: &DebugRenderPipeline,
        backend: &mut impl DebugRenderBackend,
        bodies: &RigidBodySet,
        colliders: &ColliderSet,
        narrow_phase: &NarrowPhase,
    ) {
        if pipeline.mode.contains(DebugRenderMode::COLLIDER_SHAPES) {
            self.render_colliders(&pipeline.style, backend, bodies, colliders);
        }
        if self.sphere_pairs && pipeline.mode.contains(DebugRenderMode::CONTACTS) {
            render_sphere_pairs(&pipeline.style, backend, colliders, narrow_phase);
        }
    }

    fn render_colliders(
        &mut self,
        style: &DebugRenderStyle,
        backend: &mut impl DebugRenderBackend,
        bodies: &RigidBodySet,
        colliders: &ColliderSet,
    ) {
        let mut seen = HashSet::new();
        for (handle, collider) in colliders.iter() {
            let Some(mesh) = collider.shape().as_shape::<MedialMesh>() else {
                continue;
            };
            let object = DebugRenderObject::Collider(handle, collider);
            if !backend.filter_object(object) {
                continue;
            }
            let color = collider_color(style, bodies, collider);
            let pose = collider.position();
            if self.envelope {
                let key = mesh.spheres().as_ptr().addr();
                seen.insert(key);
                let outline = self.outlines.entry(key).or_insert_with(|| outline_of(mesh));
                let (v, e) = (&outline.vertices, &outline.edges);
                backend.draw_polyline(object, v, e, pose, Vector::ONE, color);
            }
            if self.medial_mesh {
                let centers: Vec<_> = mesh.spheres().iter().map(|s| s.center).collect();
                let shade = times(color, MEDIAL_SHADE);
                backend.draw_polyline(object, &centers, mesh.edges(), pose, Vector::ONE, shade);
            }
        }
        self.outlines.retain(|key, _| seen.contains(key));
    }

    /// Number of meshes whose lines are kept.
    pub fn stored(&self) -> usize {
        debug_assert!(self.outlines.values().all(|o| !o.mesh.spheres().is_empty()));
        self.outlines.len()
    }
}

fn outline_of(mesh: &MedialMesh) -> MeshLines {
    let size = mesh.aabb().extents().max_element();
    let (vertices, triangles) = mesh.envelope(size / STEPS);
    let mut edges: Vec<[u32; 2]> = triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    MeshLines {
        mesh: mesh.clone(),
        vertices,
        edges,
    }
}

/// The colour that rapier gives a collider's shape.
fn collider_color(style: &DebugRenderStyle, bodies: &RigidBodySet, c: &Collider) -> DebugColor {
    let Some(body) = c.parent().and_then(|h| bodies.get(h)) else {
        return if c.is_enabled() {
            style.collider_parentless_color
        } else {
            style.disabled_color_multiplier
        };
    };
    let color = match body.body_type() {
        RigidBodyType::Fixed => style.collider_fixed_color,
        RigidBodyType::Dynamic | RigidBodyType::SoftFrame => style.collider_dynamic_color,
        RigidBodyType::KinematicPositionBased | RigidBodyType::KinematicVelocityBased => {
            style.collider_kinematic_color
        }
    };
    times(color, state_color(style, body, c.is_enabled()))
}

fn state_color(style: &DebugRenderStyle, body: &RigidBody, enabled: bool) -> DebugColor {
    if !body.is_enabled() || !enabled {
        style.disabled_color_multiplier
    } else if body.is_sleeping() {
        style.sleep_color_multiplier
    } else if !body.is_fixed() && body.activation().is_eligible_for_sleep() {
        style.sleep_eligible_color_multiplier
    } else {
        [1.0; 4]
    }
}

fn times(a: DebugColor, b: DebugColor) -> DebugColor {
    std::array::from_fn(|k| a[k] * b[k])
}

fn render_sphere_pairs(
    style: &DebugRenderStyle,
    backend: &mut impl DebugRenderBackend,
    colliders: &ColliderSet,
    narrow_phase: &NarrowPhase,
) {
    for pair in narrow_phase.contact_pairs() {
        let both = (colliders.get(pair.collider1), colliders.get(pair.collider2));
        let (Some(co1), Some(co2)) = both else {
            continue;
        };
        let meshes = [co1, co2].map(|c| c.shape().as_shape::<MedialMesh>());
        let [Some(mesh1), Some(mesh2)] = meshes else {
            continue;
        };
        let object = DebugRenderObject::ContactPair(pair, co1, co2);
        if !backend.filter_object(object) {
            continue;
        }
        let (pose1, pose2) = (co1.position(), co2.position());
        let (found, _) = contacts(mesh1, mesh2, &pose1.inv_mul(pose2), 0.0);
        for c in found {
            let normal = pose1.rotation * c.normal;
            let depth = style.contact_depth_color;
            let touched = [(mesh1, pose1, normal), (mesh2, pose2, -normal)];
            for (k, (mesh, pose, out)) in touched.into_iter().enumerate() {
                let part = mesh.primitive(c.primitives[k] as usize);
                let near = part.signed_distance(c.points[k]);
                let radius = part.interpolate(near.weights).radius;
                let center = pose * c.points[k] - out * radius;
                circle(backend, object, center, out, radius, depth);
            }
            let at = pose1 * c.points[0];
            let tip = at + normal * style.contact_normal_length;
            backend.draw_line(object, at, tip, style.contact_normal_color);
        }
    }
}

/// The circle of a sphere across an axis.
fn circle(
    backend: &mut impl DebugRenderBackend,
    object: DebugRenderObject,
    center: Vector,
    axis: Vector,
    radius: Real,
    color: DebugColor,
) {
    let u = axis.any_orthonormal_vector() * radius;
    let v = axis.cross(u);
    let points: Vec<_> = (0..CIRCLE)
        .map(|i| {
            let angle = i as Real / CIRCLE as Real * std::f32::consts::TAU;
            center + u * angle.cos() + v * angle.sin()
        })
        .collect();
    backend.draw_line_strip(object, &points, &Pose::IDENTITY, Vector::ONE, color, true);
}
