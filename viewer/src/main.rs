//! A window on a scene of medial meshes: what a body is, what it collides as, where it touches, what
//! a step costs. Rings fall on a creature, or a body of your own falls on it.
//!
//! ```text
//! cd viewer && cargo run --release -- [--mesh FILE] [--kind medial|hulls|parts|triangles] [--steps N]
//! ```
//! `--steps N` takes N steps before the first frame, pauses, and prints `ready` once it has drawn some:
//! what `screenshot.sh` waits for.
//! Left button: on a body that falls, drag it; elsewhere, turn. Right button: move. Wheel: nearer. Space: pause. S: one
//! step. Drop a mesh file: it falls instead.

mod bodies;
#[path = "../../examples/common/mod.rs"]
mod common;
mod drawing;
mod graph;
mod hand;
mod panel;
mod settings;

use bodies::Builder;
use common::arguments::Arguments;
use common::scene::Kind;
use drawing::Drawing;
use graph::Graph;
use hand::Hand;
use kiss3d::prelude::*;
use settings::Settings;
use std::path::PathBuf;

/// After so many frames the panel has found its size.
const FRAMES: usize = 4;

struct Options {
    mesh: Option<PathBuf>,
    kind: Kind,
    steps: Option<usize>,
}

fn options() -> Result<Options, String> {
    let mut arguments = Arguments::from_env();
    let options = Options {
        mesh: arguments.value("--mesh")?,
        kind: match arguments.value::<String>("--kind")? {
            None => Kind::Medial,
            Some(name) => Kind::named(&name)?,
        },
        steps: arguments.value("--steps")?,
    };
    arguments.finish()?;
    Ok(options)
}

#[kiss3d::main]
async fn main() {
    if let Err(message) = view().await {
        eprintln!("{message}");
        std::process::exit(2);
    }
}

async fn view() -> Result<(), String> {
    let mut options = options()?;
    let mut settings = Settings::new(options.kind);
    let mut builder = Builder::new(options.mesh.take());
    let mut scene = builder.build(&settings.build)?;
    let mut stage = scene.stage(settings.kind);
    let mut graph = Graph::default();
    let mut frames = 0;
    for _ in 0..options.steps.unwrap_or(0) {
        graph.push(&stage.step());
    }
    settings.paused = options.steps.is_some();

    let mut window = Window::new_with_size("rapier3d-medial", 1280, 800).await;
    window.set_background_color(Color::new(0.86, 0.90, 0.94, 1.0));
    window.set_ambient(0.45);
    let mut camera = OrbitCamera3d::new(Vec3::new(2.8, 3.6, 6.6), Vec3::new(0.0, 1.0, 0.0));
    let mut root = SceneNode3d::empty();
    let sun = Light::directional(Vec3::new(-0.45, -0.8, -0.4)).with_intensity(2.4);
    root.add_light(sun);
    let mut drawing = Drawing::new(&mut root, &scene, &stage, settings.kind);

    let mut hand = Hand::default();
    while window.render_3d(&mut root, &mut camera).await {
        let pointer = ray(&window, &camera);
        let button = settings.take_events(&window);
        if button == Some(Action::Press) && !window.is_egui_capturing_mouse() {
            let held = pointer.is_some_and(|ray| hand.grab(&stage, ray));
            let turns = (!held).then_some(MouseButton::Button1);
            camera.rebind_rotate_button(turns);
        } else if button == Some(Action::Release) {
            hand.open();
            camera.rebind_rotate_button(Some(MouseButton::Button1));
        }
        if let Some(file) = window.dropped_files().pop() {
            builder.take(file, &settings.build);
        }
        frames += 1;
        if frames == FRAMES && options.steps.is_some() {
            println!("ready");
        }
        if !settings.paused || std::mem::take(&mut settings.one_step) {
            if let Some(ray) = pointer {
                hand.pull(&mut stage, ray);
            }
            graph.push(&stage.step());
        }
        let before = settings.clone();
        window.draw_ui(|context| panel::panel(context, &mut settings, &graph, builder.is_busy()));
        if before.build != settings.build {
            builder.start(&settings.build);
        }
        let built = match builder.finished() {
            Some(Ok(scene)) => {
                settings.failure = None;
                Some(scene)
            }
            Some(Err(failure)) => {
                settings.failure = Some(failure);
                None
            }
            None => None,
        };
        let restart = std::mem::take(&mut settings.restart);
        if built.is_some() || before.kind != settings.kind || restart {
            let other = built.is_some();
            scene = built.unwrap_or(scene);
            stage = match restart {
                true => scene.stage(settings.kind),
                false => scene.stage_from(settings.kind, &stage),
            };
            stage.set_effects(settings.effects);
            hand.open();
            drawing.remove();
            drawing = Drawing::new(&mut root, &scene, &stage, settings.kind);
            if other || restart {
                graph = Graph::default();
            }
        }
        if before.effects != settings.effects {
            stage.set_effects(settings.effects);
        }
        drawing.show(&settings.show, &stage);
        drawing.overlay(&mut window, &settings.show, &scene, &stage);
    }
    Ok(())
}

/// From the eye through the pointer, while that is over the window.
fn ray(window: &Window, camera: &OrbitCamera3d) -> Option<(Vec3, Vec3)> {
    let (x, y) = window.cursor_pos()?;
    Some(camera.unproject(Vec2::new(x as f32, y as f32), window.size().as_vec2()))
}
