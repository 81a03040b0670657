//! What the user has set.

use crate::common::scene::Kind;
use kiss3d::prelude::*;
use rapier3d_medial::Effects;

/// What bodies are built with.
#[derive(Clone, Debug, PartialEq)]
pub struct Build {
    /// Primitives of a ring, and of the creature, at most.
    pub primitives: [usize; 2],
    /// Error at which a build ends, in percent of the size; 0 for none.
    pub max_error: f32,
}

/// What is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Show {
    /// The triangles that the bodies came as.
    pub source: bool,
    /// What they collide as: envelope, hull, parts, triangles.
    pub collider: bool,
    /// Edges and faces of the medial mesh.
    pub medial: bool,
    /// Its spheres.
    pub spheres: bool,
    /// Contact points and normals.
    pub contacts: bool,
    /// Sphere pairs that overlap, in green.
    pub pairs: bool,
}

/// All of it.
#[derive(Clone)]
pub struct Settings {
    /// What bodies collide as.
    pub kind: Kind,
    /// What is drawn.
    pub show: Show,
    /// How bodies are built.
    pub build: Build,
    /// What medial bodies call for.
    pub effects: Effects,
    /// No steps are taken.
    pub paused: bool,
    /// One step is asked for.
    pub one_step: bool,
    /// The start is asked for.
    pub restart: bool,
    /// What could not be done, in words.
    pub failure: Option<String>,
}

impl Settings {
    /// At the start.
    pub fn new(kind: Kind) -> Self {
        Self {
            kind,
            show: Show {
                source: true,
                collider: false,
                medial: true,
                spheres: false,
                contacts: true,
                pairs: true,
            },
            build: Build {
                primitives: [27, 300],
                max_error: 0.0,
            },
            effects: Effects::default(),
            paused: false,
            one_step: false,
            restart: false,
            failure: None,
        }
    }

    /// Space pauses, S steps. Whether the left button went down or up since the last call; `None`: neither.
    pub fn take_events(&mut self, window: &Window) -> Option<Action> {
        let typing = window.is_egui_capturing_keyboard();
        let mut button = None;
        for event in window.events().iter() {
            match event.value {
                WindowEvent::Key(Key::Space, Action::Press, _) if !typing => {
                    self.paused = !self.paused;
                }
                WindowEvent::Key(Key::S, Action::Press, _) if !typing => self.one_step = true,
                WindowEvent::MouseButton(MouseButton::Button1, action, _) => button = Some(action),
                _ => {}
            }
        }
        button
    }
}
