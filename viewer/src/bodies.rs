//! The scene's bodies: built at the start, and again beside the window when their settings change.

use crate::common::creature::creature;
use crate::common::falling::{SIZE, falling_on, falling_ring};
use crate::common::mesh::Mesh;
use crate::common::scene::{Model, Scene};
use crate::common::skeleton::Skeleton;
use crate::settings::Build;
use rapier3d_medial::{BuildOptions, MedialMesh, Quality};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::thread;

const COUNT: usize = 15;

type Built = Result<[Arc<Model>; 2], String>;

/// Builds what falls and what it falls on.
pub struct Builder {
    mesh: Option<PathBuf>,
    running: Option<(Build, Receiver<Built>)>,
    next: Option<Build>,
}

impl Builder {
    /// `mesh` falls instead of rings.
    pub fn new(mesh: Option<PathBuf>) -> Self {
        Self {
            mesh,
            running: None,
            next: None,
        }
    }

    /// Builds the scene and waits for it.
    pub fn build(&self, build: &Build) -> Result<Scene, String> {
        models(self.mesh.clone(), build).map(scene)
    }

    /// Starts a build; of those asked for during a build, the last one is done next.
    pub fn start(&mut self, build: &Build) {
        if self.running.is_some() {
            self.next = Some(build.clone());
            return;
        }
        let (sender, receiver) = channel();
        let (mesh, wanted) = (self.mesh.clone(), build.clone());
        thread::spawn(move || sender.send(models(mesh, &wanted)));
        self.running = Some((build.clone(), receiver));
    }

    /// Another mesh falls, once it is built.
    pub fn take(&mut self, mesh: PathBuf, build: &Build) {
        self.mesh = Some(mesh);
        self.start(build);
    }

    /// Whether a build is running.
    pub fn is_busy(&self) -> bool {
        self.running.is_some()
    }

    /// The scene of a build that has ended.
    pub fn finished(&mut self) -> Option<Result<Scene, String>> {
        let (_, receiver) = self.running.as_ref()?;
        let built = receiver.try_recv().ok()?;
        self.running = None;
        if let Some(next) = self.next.take() {
            self.start(&next);
        }
        Some(built.map(scene))
    }
}

fn models(file: Option<PathBuf>, build: &Build) -> Built {
    let (mesh, lines) = match file {
        None => falling_ring(),
        Some(file) => (Mesh::read(&file)?.fitted(SIZE), Skeleton::new(Vec::new())),
    };
    let falling = model(mesh, lines, build.primitives[0], build)?;
    let (mesh, lines) = creature();
    Ok([falling, model(mesh, lines, build.primitives[1], build)?])
}

fn model(
    mesh: Mesh,
    lines: Skeleton,
    primitives: usize,
    build: &Build,
) -> Result<Arc<Model>, String> {
    let options = BuildOptions {
        primitives: Some(primitives),
        // The slider must not wait for more.
        quality: Quality::Fast,
        max_error: (build.max_error > 0.0).then_some(build.max_error / 100.0),
        ..Default::default()
    };
    let built = MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options);
    let (medial, _) = built.map_err(|e| e.to_string())?;
    Ok(Model::new(mesh, lines, medial))
}

fn scene([falling, creature]: [Arc<Model>; 2]) -> Scene {
    falling_on(creature, &falling, COUNT)
}
