//! The plots, as SVG.

use crate::report::{Plot, Point, front};
use plotters::prelude::*;
use std::error::Error;
use std::ops::Range;

/// Width and height, in the unit of the fonts: small, so that text is large where it is scaled.
const SIZE: (u32, u32) = (760, 500);

const COLORS: [RGBColor; 8] = [
    RGBColor(0, 110, 160),
    RGBColor(200, 80, 20),
    RGBColor(30, 130, 60),
    RGBColor(130, 60, 150),
    RGBColor(110, 100, 0),
    RGBColor(190, 30, 80),
    RGBColor(70, 80, 95),
    RGBColor(20, 160, 160),
];

type Place = (f64, f64);

/// Axes and what is drawn over them; logarithmic ones hold powers of ten.
struct Axes<'a> {
    x: &'a str,
    y: &'a str,
    log: [bool; 2],
}

impl Axes<'_> {
    fn place(&self, (x, y): Place) -> Place {
        let scale = |value: f64, log: bool| if log { value.log10() } else { value };
        (scale(x, self.log[0]), scale(y, self.log[1]))
    }

    fn range(&self, values: impl Iterator<Item = f64>, axis: usize) -> Range<f64> {
        let start = (f64::MAX, f64::MIN);
        let (low, high) = values.fold(start, |(low, high), v| (low.min(v), high.max(v)));
        let wide = (high - low).max(1.0e-3);
        let below = if self.log[axis] {
            low - 0.1 * wide
        } else {
            low.min(0.0)
        };
        below..high + 0.25 * wide
    }
}

/// A number as short as it can be read.
fn number(value: f64, log: bool) -> String {
    let value = if log { 10f64.powf(value) } else { value };
    let size = value.abs();
    if size == 0.0 {
        "0".into()
    } else if !(1.0e-2..1.0e4).contains(&size) {
        format!("{value:.0e}")
    } else if size >= 10.0 {
        format!("{value:.0}")
    } else {
        format!("{value:.2}")
            .trim_end_matches('0')
            .trim_end_matches('.')
            .into()
    }
}

/// Where the legend, about a third of the width and of the height, hides fewest points.
fn freest(points: &[Place], [across, up]: &[Range<f64>; 2]) -> SeriesLabelPosition {
    use SeriesLabelPosition::*;
    const PART: f64 = 0.36;
    let share = |value: f64, range: &Range<f64>| (value - range.start) / (range.end - range.start);
    let hidden = |[left, low]: [f64; 2]| {
        let within = |p: &&Place| {
            let [x, y] = [share(p.0, across) - left, share(p.1, up) - low];
            (0.0..PART).contains(&x) && (0.0..PART).contains(&y)
        };
        points.iter().filter(within).count()
    };
    let (far, half) = (1.0 - PART, (1.0 - PART) / 2.0);
    let corners = [
        (UpperRight, [far, far]),
        (LowerLeft, [0.0, 0.0]),
        (UpperLeft, [0.0, far]),
        (LowerRight, [far, 0.0]),
        (MiddleRight, [far, half]),
        (MiddleLeft, [0.0, half]),
    ];
    let best = corners.into_iter().min_by_key(|(_, place)| hidden(*place));
    best.map_or(UpperRight, |(position, _)| position)
}

/// The plot as SVG.
pub fn svg(plot: &Plot) -> Result<String, Box<dyn Error>> {
    match plot {
        Plot::Front {
            time,
            error,
            series,
        } => {
            let axes = Axes {
                x: time,
                y: error,
                log: [true; 2],
            };
            let best = front(series).iter().map(|p| (p.time, p.error)).collect();
            let points: Vec<_> = series
                .iter()
                .map(|(name, p)| (name.as_str(), p.iter().collect()))
                .collect();
            drawn(&axes, &points, &[("Pareto front", best)])
        }
        Plot::Lines { x, y, log, series } => {
            let axes = Axes { x, y, log: *log };
            let lines: Vec<_> = series
                .iter()
                .map(|(name, line)| (name.as_str(), line.clone()))
                .collect();
            drawn(&axes, &[], &lines)
        }
    }
}

type Named<'a, T> = (&'a str, Vec<T>);

fn drawn(
    axes: &Axes,
    points: &[Named<&Point>],
    lines: &[Named<Place>],
) -> Result<String, Box<dyn Error>> {
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        area.fill(&WHITE)?;
        let dots = points
            .iter()
            .flat_map(|(_, p)| p.iter().map(|p| (p.time, p.error)));
        let on_lines = lines.iter().flat_map(|(_, line)| line.iter().copied());
        let all: Vec<Place> = dots.chain(on_lines).map(|p| axes.place(p)).collect();
        let ranges = [
            axes.range(all.iter().map(|p| p.0), 0),
            axes.range(all.iter().map(|p| p.1), 1),
        ];
        let mut chart = ChartBuilder::on(&area)
            .margin(12)
            .x_label_area_size(52)
            .y_label_area_size(82)
            .build_cartesian_2d(ranges[0].clone(), ranges[1].clone())?;
        chart
            .configure_mesh()
            .x_desc(axes.x)
            .y_desc(axes.y)
            .x_labels(6)
            .y_labels(7)
            .x_label_formatter(&|x| number(*x, axes.log[0]))
            .y_label_formatter(&|y| number(*y, axes.log[1]))
            .label_style(("sans-serif", 17))
            .axis_desc_style(("sans-serif", 18))
            .light_line_style(TRANSPARENT)
            .draw()?;
        for (place, (name, line)) in lines.iter().enumerate() {
            let color = match points {
                [] => COLORS[place % COLORS.len()].to_rgba(),
                _ => BLACK.mix(0.35),
            };
            let line = line.iter().map(|p| axes.place(*p));
            chart
                .draw_series(LineSeries::new(line, color.stroke_width(2)))?
                .label(*name)
                .legend(move |(x, y)| {
                    PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2))
                });
        }
        for (place, (name, points)) in points.iter().enumerate() {
            let color = COLORS[place % COLORS.len()];
            let at = |p: &Point| axes.place((p.time, p.error));
            chart
                .draw_series(points.iter().map(|p| Circle::new(at(p), 5, color.filled())))?
                .label(*name)
                .legend(move |(x, y)| Circle::new((x + 9, y), 5, color.filled()));
            let rings = points.iter().filter(|p| p.default);
            chart.draw_series(rings.map(|p| Circle::new(at(p), 10, color.stroke_width(2))))?;
            let style = ("sans-serif", 15).into_font().color(&color);
            let label = |p: &&Point| {
                EmptyElement::at(at(p)) + Text::new(p.label.clone(), (8, -15), style.clone())
            };
            chart.draw_series(points.iter().map(label))?;
        }
        chart
            .configure_series_labels()
            .position(freest(&all, &ranges))
            .background_style(WHITE.mix(0.85))
            .border_style(BLACK.mix(0.3))
            .label_font(("sans-serif", 16))
            .draw()?;
        area.present()?;
    }
    Ok(text)
}
