//! The panel: what can be switched, and the step report.

use crate::common::scene::Kind;
use crate::graph::Graph;
use crate::settings::Settings;
use kiss3d::egui::{Align2, Color32, Context, ScrollArea, Slider, Ui, Window};
use rapier3d_medial::Effect;

/// Draws the panel and takes what the user sets on it.
pub fn panel(context: &Context, settings: &mut Settings, graph: &Graph, building: bool) {
    let window = Window::new("rapier3d-medial").default_pos([12.0, 12.0]);
    window.default_width(250.0).show(context, |ui| {
        ScrollArea::vertical().show(ui, |ui| {
            run(ui, settings);
            if let Some(failure) = &settings.failure {
                ui.colored_label(Color32::from_rgb(255, 130, 110), failure);
            }
            ui.separator();
            show(ui, settings);
            if settings.kind == Kind::Medial {
                ui.separator();
                build(ui, settings, building);
                ui.separator();
                effects(ui, settings);
            }
        });
    });
    if settings.kind == Kind::Medial {
        let window = Window::new("step report").anchor(Align2::RIGHT_TOP, [-12.0, 12.0]);
        window
            .default_width(230.0)
            .show(context, |ui| graph.draw(ui));
    }
}

fn run(ui: &mut Ui, settings: &mut Settings) {
    ui.horizontal(|ui| {
        let name = if settings.paused { "run" } else { "pause" };
        settings.paused ^= ui.button(name).clicked();
        settings.one_step |= ui.button("step").clicked();
        settings.restart |= ui.button("restart").clicked();
    });
    ui.horizontal(|ui| {
        for (kind, name) in Kind::ALL {
            ui.selectable_value(&mut settings.kind, kind, name);
        }
    });
    ui.small("Drag bodies, or drop a mesh file to let it fall.");
}

fn show(ui: &mut Ui, settings: &mut Settings) {
    let show = &mut settings.show;
    ui.columns(2, |columns| {
        columns[0].checkbox(&mut show.source, "source mesh");
        columns[0].checkbox(&mut show.collider, "collider");
        columns[0].checkbox(&mut show.contacts, "contacts");
        columns[1].checkbox(&mut show.medial, "medial mesh");
        columns[1].checkbox(&mut show.spheres, "spheres");
        columns[1].checkbox(&mut show.pairs, "touching pairs");
    });
}

fn build(ui: &mut Ui, settings: &mut Settings, building: bool) {
    let build = &mut settings.build;
    // A build starts when the slider is let go.
    let mut wanted = build.clone();
    let [ring, creature] = &mut wanted.primitives;
    let released = [
        ui.add(Slider::new(ring, 4..=150).text("primitives, falling")),
        ui.add(Slider::new(creature, 20..=1500).text("primitives, creature")),
        ui.add(Slider::new(&mut wanted.max_error, 0.0..=8.0).text("max error, %")),
    ];
    if released.iter().any(|slider| slider.changed()) {
        *build = wanted;
    }
    if building {
        ui.label("building …");
    }
}

fn effects(ui: &mut Ui, settings: &mut Settings) {
    let of = &mut settings.effects;
    let rows = [
        (&mut of.continuous, "continuous"),
        (&mut of.guard, "guard"),
        (&mut of.exact_rotation, "exact rotation"),
        (&mut of.full_manifolds, "full manifolds"),
        (&mut of.speculative, "speculative"),
        (&mut of.stop, "stop at contact"),
    ];
    for (effect, name) in rows {
        ui.horizontal(|ui| {
            ui.selectable_value(effect, Effect::Off, "off");
            ui.selectable_value(effect, Effect::Auto, "auto");
            ui.selectable_value(effect, Effect::On, "on");
            ui.label(name);
        });
    }
}
