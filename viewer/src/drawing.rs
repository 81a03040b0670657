//! The bodies as nodes of kiss3d's scene, and what is drawn anew in each frame: contacts and lines.

use crate::common::mesh::ball;
use crate::common::scene::{Actor, Kind, Scene, Stage};
use crate::common::surfaces::surface;
use crate::settings::Show;
use kiss3d::prelude::*;
use rapier3d::prelude::{ColliderHandle, ContactManifold, ContactPair, Pose, SharedShape, Vector};
use rapier3d_medial::MedialMesh;
use rapier3d_medial::pair::contacts::contacts;

/// Length of a normal, in metres.
const NORMAL: f32 = 0.15;
const GREEN: Color = Color::new(0.05, 0.75, 0.15, 1.0);
const RED: Color = Color::new(0.85, 0.10, 0.05, 1.0);
const INK: Color = Color::new(0.05, 0.08, 0.15, 1.0);

/// The nodes of a body.
struct Body {
    group: SceneNode3d,
    source: SceneNode3d,
    collider: SceneNode3d,
    medial: SceneNode3d,
    spheres: SceneNode3d,
}

/// All that is drawn of a stage.
pub struct Drawing {
    bodies: Vec<Body>,
    ground: SceneNode3d,
    pairs: SceneNode3d,
    kind: Kind,
}

impl Drawing {
    /// Puts the bodies of a stage under a node.
    pub fn new(root: &mut SceneNode3d, scene: &Scene, stage: &Stage, kind: Kind) -> Self {
        let ground = root
            .add_cube(100.0, 0.5, 100.0)
            .set_position(Vec3::NEG_Y * 0.25)
            .set_color(Color::new(0.62, 0.61, 0.59, 1.0));
        let body = |(actor, (_, collider)): (&Actor, &(_, ColliderHandle))| {
            let shape = stage.world.colliders[*collider].shared_shape();
            Body::new(root, actor, shape)
        };
        let bodies = scene.actors.iter().zip(&stage.bodies).map(body).collect();
        Self {
            bodies,
            ground,
            pairs: unit_balls(root, GREEN),
            kind,
        }
    }

    /// Takes all nodes out again.
    pub fn remove(&mut self) {
        let groups = self.bodies.iter_mut().map(|body| &mut body.group);
        let all = groups.chain([&mut self.ground, &mut self.pairs]);
        all.for_each(SceneNode3d::detach);
    }

    /// Moves the bodies to where they are, and shows the parts wanted.
    pub fn show(&mut self, show: &Show, stage: &Stage) {
        let medial = self.kind == Kind::Medial;
        for (body, pose) in self.bodies.iter_mut().zip(stage.poses()) {
            body.group.set_pose(pose);
            body.source.set_visible(show.source);
            body.collider.set_visible(show.collider);
            body.medial.set_visible(show.medial && medial);
            body.spheres.set_visible(show.spheres && medial);
            // What is inside is seen through what is outside.
            let inner = medial && (show.medial || show.spheres || show.pairs);
            set_alpha(
                &mut body.source,
                if inner || show.collider { 0.35 } else { 1.0 },
            );
            set_alpha(&mut body.collider, if inner { 0.45 } else { 1.0 });
        }
    }

    /// Draws contacts, touching pairs and the edges of the medial meshes.
    pub fn overlay(&mut self, window: &mut Window, show: &Show, scene: &Scene, stage: &Stage) {
        let mut touching = Vec::new();
        for pair in stage.world.narrow_phase.contact_pairs() {
            if show.contacts {
                draw_contacts(window, stage, pair);
            }
            if show.pairs {
                touching.extend(touching_spheres(stage, pair));
            }
        }
        self.pairs.set_visible(!touching.is_empty());
        self.pairs.set_instances(&touching);
        if show.medial && self.kind == Kind::Medial {
            for (actor, pose) in scene.actors.iter().zip(stage.poses()) {
                let spheres = actor.model.medial.spheres();
                for edge in actor.model.medial.edges() {
                    let [a, b] = edge.map(|i| pose * spheres[i as usize].center);
                    window.draw_line(a, b, INK, 1.0, false);
                }
            }
        }
    }
}

impl Body {
    fn new(root: &mut SceneNode3d, actor: &Actor, shape: &SharedShape) -> Self {
        let mut group = root.add_group();
        let color = actor.color.powf(0.7);
        let color = Color::new(color.x, color.y, color.z, 1.0);
        let mesh = &actor.model.mesh;
        let mut source = trimesh(&mut group, &mesh.vertices, &mesh.indices);
        source.set_color(color);
        let outside = surface(&**shape);
        let mut collider = trimesh(&mut group, &outside.vertices, &outside.indices);
        collider.set_color(color);
        let medial = &actor.model.medial;
        let centers: Vec<Vector> = medial.spheres().iter().map(|s| s.center).collect();
        let mut faces = trimesh(&mut group, &centers, medial.faces());
        faces.enable_backface_culling(false);
        faces.set_color(color);
        let mut spheres = unit_balls(&mut group, color);
        let balls = medial.spheres().iter();
        let balls: Vec<_> = balls.map(|s| instance(s.center, s.radius, color)).collect();
        spheres.set_instances(&balls);
        Self {
            group,
            source,
            collider,
            medial: faces,
            spheres,
        }
    }
}

fn trimesh(parent: &mut SceneNode3d, vertices: &[Vector], triangles: &[[u32; 3]]) -> SceneNode3d {
    parent.add_trimesh(vertices.to_vec(), triangles.to_vec(), Vec3::ONE, false)
}

/// A ball of radius 1, to be drawn at many places.
fn unit_balls(parent: &mut SceneNode3d, color: Color) -> SceneNode3d {
    let mesh = ball(1.0, 20);
    trimesh(parent, &mesh.vertices, &mesh.indices).set_color(color)
}

fn instance(position: Vec3, radius: f32, color: Color) -> InstanceData3d {
    InstanceData3d {
        position,
        deformation: Mat3::from_diagonal(Vec3::splat(radius)),
        color,
        ..Default::default()
    }
}

fn set_alpha(node: &mut SceneNode3d, alpha: f32) {
    node.apply_to_objects_mut_recursive(&mut |object| {
        let color = object.data().color();
        object.set_color(Color::new(color.r, color.g, color.b, alpha));
        // Shadows of what is seen through are drawn in stripes.
        object.set_casts_shadows(alpha == 1.0);
    });
}

fn draw_contacts(window: &mut Window, stage: &Stage, pair: &ContactPair) {
    let pose = *stage.world.colliders[pair.collider1].position();
    for manifold in pair.manifolds() {
        let place = manifold.subshape_pos1().map_or(pose, |local| pose * local);
        draw_manifold(window, manifold, &place);
    }
}

fn draw_manifold(window: &mut Window, manifold: &ContactManifold, place: &Pose) {
    let normal = place.rotation * manifold.local_n1;
    for point in &manifold.points {
        let at = place.transform_point(point.local_p1);
        window.draw_point(at, RED, 7.0);
        window.draw_line(at, at + normal * NORMAL, RED, 2.0, false);
    }
}

/// The spheres of two medial meshes that overlap, a pair each.
fn touching_spheres(stage: &Stage, pair: &ContactPair) -> Vec<InstanceData3d> {
    let both = [pair.collider1, pair.collider2].map(|c| &stage.world.colliders[c]);
    let meshes = both.map(|c| c.shape().as_shape::<MedialMesh>());
    let ([Some(mesh1), Some(mesh2)], [pose1, pose2]) = (meshes, both.map(|c| c.position())) else {
        return Vec::new();
    };
    let (found, _) = contacts(mesh1, mesh2, &pose1.inv_mul(pose2), 0.0);
    let balls = found.iter().flat_map(|contact| {
        let normal = pose1.rotation * contact.normal;
        let sides = [(mesh1, pose1, normal), (mesh2, pose2, -normal)];
        [0, 1].map(|k| {
            let (mesh, pose, out) = sides[k];
            let part = mesh.primitive(contact.primitives[k] as usize);
            let weights = part.signed_distance(contact.points[k]).weights;
            let radius = part.interpolate(weights).radius;
            instance(*pose * contact.points[k] - out * radius, radius, GREEN)
        })
    });
    balls.collect()
}
