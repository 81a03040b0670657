//! The step reports of the last steps, as curves.

use kiss3d::egui::{Color32, Pos2, Sense, Stroke, StrokeKind, Ui, Vec2};
use rapier3d_medial::StepReport;
use std::collections::VecDeque;

/// Steps that a curve holds.
const STEPS: usize = 240;

/// Name, colour, and how a curve is read from a report.
type Curve = (&'static str, Color32, fn(&StepReport) -> f64);

const CURVES: [Curve; 6] = [
    ("ms", Color32::from_rgb(235, 235, 235), milliseconds),
    ("elementary tests", Color32::from_rgb(110, 170, 255), |r| {
        r.elementary_tests as f64
    }),
    ("contacts", Color32::from_rgb(255, 120, 90), |r| {
        r.contacts as f64
    }),
    ("pairs", Color32::from_rgb(80, 210, 120), |r| r.pairs as f64),
    (
        "continuous queries",
        Color32::from_rgb(210, 140, 255),
        |r| r.continuous_queries as f64,
    ),
    ("events", Color32::from_rgb(255, 200, 60), |r| {
        r.events as f64
    }),
];

fn milliseconds(report: &StepReport) -> f64 {
    let parts = [
        report.batch_seconds,
        report.mute_seconds,
        report.step_seconds,
        report.event_seconds,
    ];
    1.0e3 * parts.iter().sum::<f64>()
}

/// What the last steps did.
#[derive(Default)]
pub struct Graph(VecDeque<[f64; CURVES.len()]>);

impl Graph {
    /// Adds a step.
    pub fn push(&mut self, report: &StepReport) {
        if self.0.len() == STEPS {
            self.0.pop_front();
        }
        self.0.push_back(CURVES.map(|(_, _, value)| value(report)));
    }

    /// Draws each curve on a scale of its own, with its last and its largest value. The scale is that of
    /// 19 in 20 steps: one that the machine was slow in does not flatten the others.
    pub fn draw(&self, ui: &mut Ui) {
        for (k, (name, color, _)) in CURVES.iter().enumerate() {
            let values = || self.0.iter().map(|row| row[k]);
            let largest = values().fold(0.0, f64::max);
            let mut sorted: Vec<f64> = values().collect();
            sorted.sort_by(f64::total_cmp);
            let scale = sorted.get(sorted.len() * 19 / 20).copied();
            let scale = 1.2 * scale.unwrap_or(0.0).max(1.0e-9);
            let last = values().next_back().unwrap_or(0.0);
            let digits = if k == 0 { 2 } else { 0 };
            let text = format!("{name}: {last:.digits$} (most {largest:.digits$})");
            ui.colored_label(*color, text);
            let size = Vec2::new(ui.available_width(), 34.0);
            let (place, _) = ui.allocate_exact_size(size, Sense::hover());
            let painter = ui.painter_at(place);
            painter.rect(
                place,
                2.0,
                Color32::from_gray(18),
                Stroke::new(1.0, Color32::from_gray(70)),
                StrokeKind::Inside,
            );
            let points = values().enumerate().map(|(step, value)| {
                let x = step as f32 / STEPS as f32;
                let y = 1.0 - (value / scale).min(1.0) as f32 * 0.94;
                Pos2::new(
                    place.left() + x * place.width(),
                    place.top() + y * place.height(),
                )
            });
            painter.line(points.collect(), Stroke::new(1.2, *color));
        }
    }
}
