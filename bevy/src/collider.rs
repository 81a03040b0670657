//! [`MedialCollider`]: a medial mesh at hand, in a file, or still to be built, as a bevy_rapier `Collider`.

use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use rapier3d_medial::MedialMesh;
use rapier3d_medial::prelude::*;

#[cfg(feature = "assets")]
pub use assets::{MedialAsset, MedialAssetLoader, MedialBuild, MedialBuilt};

#[cfg(feature = "assets")]
pub(crate) use assets::finish;

/// A concave collider. The entity gets bevy_rapier's `Collider` as soon as the medial mesh is there: at once, when
/// its file is loaded, or when it is built. Until then it collides with nothing. The collider follows the entity's
/// scale if that is the same along all axes; a sphere scaled otherwise would be no sphere.
#[derive(Component, Clone)]
#[non_exhaustive]
pub enum MedialCollider {
    /// A medial mesh made in code.
    Mesh(MedialMesh),
    /// A `.medial` file, made by `medial build body.obj -o body.medial` or `MedialMesh::save_asset`.
    #[cfg(feature = "assets")]
    Asset(Handle<MedialAsset>),
    /// A render mesh, built in the background; once for all entities that name the same mesh and options.
    #[cfg(feature = "assets")]
    Build(MedialBuild),
}

impl From<MedialMesh> for MedialCollider {
    fn from(mesh: MedialMesh) -> Self {
        Self::Mesh(mesh)
    }
}

/// Marks entities whose [`MedialCollider`] has not become a `Collider` yet.
#[derive(Component)]
struct Waiting;

/// Adds what makes colliders of the components.
pub(crate) fn add_systems(app: &mut App, schedule: Interned<dyn ScheduleLabel>) {
    #[cfg(feature = "assets")]
    assets::add(app, schedule);
    let serve = (wait, serve).chain().before(PhysicsSet::SyncBackend);
    app.add_systems(schedule, serve).add_observer(remove);
}

/// Removes the `Collider` of an entity that has lost its [`MedialCollider`].
fn remove(removed: On<Remove<MedialCollider>>, mut commands: Commands) {
    commands
        .entity(removed.entity)
        .try_remove::<(Collider, Waiting)>();
}

fn wait(mut commands: Commands, changed: Query<Entity, Changed<MedialCollider>>) {
    for entity in &changed {
        commands.entity(entity).insert(Waiting);
    }
}

fn serve(
    mut commands: Commands,
    waiting: Query<(Entity, &MedialCollider), With<Waiting>>,
    #[cfg(feature = "assets")] mut source: assets::Source,
) {
    for (entity, collider) in &waiting {
        let mesh = match collider {
            MedialCollider::Mesh(mesh) => mesh.clone(),
            #[cfg(feature = "assets")]
            other => match source.find(entity, other) {
                assets::Found::Mesh(mesh) => mesh,
                assets::Found::NotYet => continue,
                assets::Found::Failed => {
                    commands.entity(entity).remove::<Waiting>();
                    continue;
                }
            },
        };
        let collider = Collider::from(bevy_rapier3d::rapier::geometry::SharedShape::medial_mesh(
            mesh,
        ));
        commands.entity(entity).insert(collider).remove::<Waiting>();
    }
}

#[cfg(feature = "assets")]
mod assets {
    use super::*;
    use bevy::asset::io::Reader;
    use bevy::asset::{AssetLoader, LoadContext};
    use bevy::ecs::system::SystemParam;
    use bevy::tasks::{AsyncComputeTaskPool, Task, block_on, poll_once};
    use rapier3d_medial::BuildError;

    /// A `.medial` file.
    #[derive(Asset, TypePath, Clone)]
    pub struct MedialAsset(pub MedialMesh);

    /// Loads `.medial` files.
    #[derive(Default, TypePath)]
    pub struct MedialAssetLoader;

    impl AssetLoader for MedialAssetLoader {
        type Asset = MedialAsset;
        type Settings = ();
        type Error = BevyError;

        async fn load(
            &self,
            reader: &mut dyn Reader,
            _: &(),
            _: &mut LoadContext<'_>,
        ) -> Result<MedialAsset, BevyError> {
            let mut bytes = Vec::new();
            reader.read_to_end(&mut bytes).await?;
            Ok(MedialAsset(MedialMesh::from_bytes(&bytes)?))
        }

        fn extensions(&self) -> &[&str] {
            &["medial"]
        }
    }

    /// A render mesh to build a collider from, and how.
    #[derive(Clone, PartialEq)]
    pub struct MedialBuild {
        /// The render mesh: a list of triangles that the main world may read.
        pub mesh: Handle<Mesh>,
        /// The number of primitives, the error allowed, and more.
        pub options: BuildOptions,
    }

    /// The message sent once for each entity whose [`MedialCollider::Build`] has ended.
    #[derive(Message)]
    pub struct MedialBuilt {
        /// The entity.
        pub entity: Entity,
        /// The report of the build, or the error that ended it.
        pub outcome: Result<BuildReport, String>,
    }

    type Outcome = Result<(MedialMesh, BuildReport), BuildError>;

    /// A build, under way or done, for all entities that ask for it.
    struct Build {
        mesh: AssetId<Mesh>,
        options: BuildOptions,
        task: Option<Task<Outcome>>,
        outcome: Option<Result<(MedialMesh, BuildReport), String>>,
    }

    /// All builds of meshes that are still loaded.
    #[derive(Resource, Default)]
    struct Builds(Vec<Build>);

    /// What the source of a collider says.
    pub(super) enum Found {
        Mesh(MedialMesh),
        NotYet,
        Failed,
    }

    /// Where medial meshes come from.
    #[derive(SystemParam)]
    pub(super) struct Source<'w> {
        files: Option<Res<'w, Assets<MedialAsset>>>,
        meshes: Option<Res<'w, Assets<Mesh>>>,
        builds: ResMut<'w, Builds>,
        built: MessageWriter<'w, MedialBuilt>,
    }

    impl Source<'_> {
        pub(super) fn find(&mut self, entity: Entity, collider: &MedialCollider) -> Found {
            match collider {
                MedialCollider::Mesh(mesh) => Found::Mesh(mesh.clone()),
                MedialCollider::Asset(file) => {
                    let loaded = self.files.as_ref().and_then(|files| files.get(file));
                    loaded.map_or(Found::NotYet, |asset| Found::Mesh(asset.0.clone()))
                }
                MedialCollider::Build(of) => self.built(entity, of),
            }
        }

        fn built(&mut self, entity: Entity, of: &MedialBuild) -> Found {
            let same = |build: &&Build| build.mesh == of.mesh.id() && build.options == of.options;
            let Some(known) = self.builds.0.iter().find(same) else {
                let mesh = self.meshes.as_ref().and_then(|meshes| meshes.get(&of.mesh));
                if let Some(mesh) = mesh {
                    self.builds.0.push(Build::start(of, mesh));
                }
                return Found::NotYet;
            };
            let Some(outcome) = &known.outcome else {
                return Found::NotYet;
            };
            let (found, outcome) = match outcome {
                Ok((mesh, report)) => (Found::Mesh(mesh.clone()), Ok(report.clone())),
                Err(why) => {
                    log::error!("{entity} gets no collider: {why}");
                    (Found::Failed, Err(why.clone()))
                }
            };
            self.built.write(MedialBuilt { entity, outcome });
            found
        }
    }

    impl Build {
        /// Starts a build in the background.
        fn start(of: &MedialBuild, mesh: &Mesh) -> Self {
            let (mesh_id, options) = (of.mesh.id(), of.options.clone());
            let mut build = Self {
                mesh: mesh_id,
                options: options.clone(),
                task: None,
                outcome: None,
            };
            let corners: Vec<Vec3> = match mesh.triangles() {
                Ok(triangles) => triangles.flat_map(|t| t.vertices).collect(),
                Err(why) => {
                    build.outcome = Some(Err(format!(
                        "its render mesh has no triangles to read: {why}"
                    )));
                    return build;
                }
            };
            let triangles = (0..corners.len() as u32 / 3)
                .map(|k| [3 * k, 3 * k + 1, 3 * k + 2])
                .collect::<Vec<_>>();
            let work = async move { MedialMesh::from_trimesh(&corners, &triangles, &options) };
            build.task = Some(AsyncComputeTaskPool::get().spawn(work));
            build
        }
    }

    /// Fetches what has been built.
    fn collect(mut builds: ResMut<Builds>) {
        for build in &mut builds.0 {
            let ended = build
                .task
                .as_mut()
                .and_then(|task| block_on(poll_once(task)));
            if let Some(outcome) = ended {
                build.task = None;
                build.outcome = Some(outcome.map_err(|why| why.to_string()));
            }
        }
    }

    /// A render mesh or file that changes gives new colliders.
    fn refresh(
        mut commands: Commands,
        mut meshes: MessageReader<AssetEvent<Mesh>>,
        mut files: MessageReader<AssetEvent<MedialAsset>>,
        mut builds: ResMut<Builds>,
        colliders: Query<(Entity, &MedialCollider)>,
    ) {
        for event in meshes.read() {
            let (AssetEvent::Modified { id } | AssetEvent::Removed { id }) = *event else {
                continue;
            };
            builds.0.retain(|build| build.mesh != id);
            for (entity, collider) in &colliders {
                if matches!(collider, MedialCollider::Build(of) if of.mesh.id() == id) {
                    commands.entity(entity).insert(Waiting);
                }
            }
        }
        for event in files.read() {
            let AssetEvent::Modified { id } = *event else {
                continue;
            };
            for (entity, collider) in &colliders {
                if matches!(collider, MedialCollider::Asset(file) if file.id() == id) {
                    commands.entity(entity).insert(Waiting);
                }
            }
        }
    }

    pub(super) fn add(app: &mut App, schedule: Interned<dyn ScheduleLabel>) {
        app.init_resource::<Builds>()
            .add_message::<MedialBuilt>()
            .add_message::<AssetEvent<Mesh>>()
            .add_message::<AssetEvent<MedialAsset>>();
        app.add_systems(schedule, (refresh, collect).chain().before(super::wait));
    }

    /// Once all plugins are there, in whatever order they were added.
    pub(crate) fn finish(app: &mut App) {
        if app.world().contains_resource::<AssetServer>() {
            app.init_asset::<MedialAsset>()
                .init_asset_loader::<MedialAssetLoader>();
        }
    }
}
