//! What the measurements are handed on as: a table for the CSV file, and a plot of error against
//! time with its Pareto front.

use plotters::prelude::*;
use std::error::Error;
use std::fmt::Write;

/// One setting that was measured.
pub struct Point {
    /// What it is called in the plot.
    pub label: String,
    /// Time, in the plot's unit.
    pub time: f64,
    /// Error, in the plot's unit.
    pub error: f64,
    /// Whether it is what this crate does unless told otherwise.
    pub default: bool,
}

/// One experiment.
pub struct Section {
    /// File name of its table and its plot.
    pub name: &'static str,
    /// Heading on the page.
    pub title: &'static str,
    /// What was done and how to read it, in a few sentences.
    pub text: String,
    /// Unit of the times.
    pub time_axis: &'static str,
    /// What the error is, and its unit.
    pub error_axis: &'static str,
    /// Columns of the table.
    pub head: Vec<&'static str>,
    /// Its rows.
    pub rows: Vec<Vec<String>>,
    /// Plotted, in one colour each.
    pub series: Vec<(String, Vec<Point>)>,
}

impl Section {
    /// Comma-separated values, with a head.
    pub fn csv(&self) -> String {
        let line = |cells: Vec<&str>| cells.join(",") + "\n";
        let rows = self.rows.iter();
        let rows = rows.map(|row| line(row.iter().map(String::as_str).collect()));
        line(self.head.clone()) + &rows.collect::<String>()
    }

    /// The table as HTML.
    pub fn table(&self) -> String {
        let row = |tag: &str, cells: &[&str]| {
            let cells = cells.iter().map(|cell| format!("<{tag}>{cell}</{tag}>"));
            format!("<tr>{}</tr>\n", cells.collect::<String>())
        };
        let mut text = String::from("<div class=wide><table>\n");
        text += &row("th", &self.head);
        for cells in &self.rows {
            text += &row("td", &cells.iter().map(String::as_str).collect::<Vec<_>>());
        }
        text + "</table></div>\n"
    }

    /// Points that no other beats in both time and error.
    fn front(&self) -> Vec<&Point> {
        let all = || self.series.iter().flat_map(|(_, points)| points);
        let beaten = |p: &Point| {
            all().any(|q| {
                q.time <= p.time && q.error <= p.error && (q.time < p.time || q.error < p.error)
            })
        };
        let mut front: Vec<&Point> = all().filter(|p| !beaten(p)).collect();
        front.sort_by(|a, b| a.time.total_cmp(&b.time));
        front
    }

    /// The default settings that are not on the front.
    pub fn defaults_off_front(&self) -> Vec<&str> {
        let front = self.front();
        let defaults = self.series.iter().flat_map(|(_, points)| points);
        defaults
            .filter(|p| p.default && !front.iter().any(|q| std::ptr::eq(*q, *p)))
            .map(|p| p.label.as_str())
            .collect()
    }

    /// The plot as SVG: both axes logarithmic, the front as a line, the default ringed.
    pub fn svg(&self) -> Result<String, Box<dyn Error>> {
        let all = || self.series.iter().flat_map(|(_, points)| points);
        let range = |value: fn(&Point) -> f64| {
            let low = all().map(value).fold(f64::MAX, f64::min);
            let high = all().map(value).fold(0.0, f64::max);
            (low / 2.0)..(high * 2.5)
        };
        let mut text = String::new();
        {
            let area = SVGBackend::with_string(&mut text, (860, 520)).into_drawing_area();
            area.fill(&WHITE)?;
            let mut chart = ChartBuilder::on(&area)
                .margin(14)
                .x_label_area_size(46)
                .y_label_area_size(76)
                .build_cartesian_2d(
                    range(|p| p.time).log_scale(),
                    range(|p| p.error).log_scale(),
                )?;
            let number = |x: &f64| format!("{x:.0e}");
            chart
                .configure_mesh()
                .x_desc(self.time_axis)
                .y_desc(self.error_axis)
                .x_label_formatter(&number)
                .y_label_formatter(&number)
                .label_style(("sans-serif", 15))
                .axis_desc_style(("sans-serif", 17))
                .light_line_style(TRANSPARENT)
                .draw()?;
            let front: Vec<_> = self.front().iter().map(|p| (p.time, p.error)).collect();
            chart
                .draw_series(LineSeries::new(front, BLACK.mix(0.35).stroke_width(2)))?
                .label("Pareto front")
                .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], BLACK.mix(0.35)));
            for (number, (name, points)) in self.series.iter().enumerate() {
                let color = COLORS[number % COLORS.len()];
                let dots = points.iter().map(|p| (p.time, p.error));
                chart
                    .draw_series(dots.map(|at| Circle::new(at, 5, color.filled())))?
                    .label(name)
                    .legend(move |(x, y)| Circle::new((x + 9, y), 5, color.filled()));
                let rings = points.iter().filter(|p| p.default);
                chart.draw_series(
                    rings.map(|p| Circle::new((p.time, p.error), 10, color.stroke_width(2))),
                )?;
                let style = ("sans-serif", 13).into_font().color(&color);
                chart.draw_series(points.iter().map(|p| {
                    EmptyElement::at((p.time, p.error))
                        + Text::new(p.label.clone(), (9, -14), style.clone())
                }))?;
            }
            chart
                .configure_series_labels()
                .background_style(WHITE.mix(0.85))
                .border_style(BLACK.mix(0.3))
                .label_font(("sans-serif", 15))
                .draw()?;
            area.present()?;
        }
        Ok(text)
    }
}

const COLORS: [RGBColor; 5] = [
    RGBColor(0, 110, 160),
    RGBColor(200, 80, 20),
    RGBColor(30, 130, 60),
    RGBColor(130, 60, 150),
    RGBColor(110, 100, 0),
];

/// One page with everything in it, readable from a file.
pub fn page(sections: &[Section], machine: &str) -> Result<String, Box<dyn Error>> {
    let mut text = String::from(HEAD);
    write!(
        text,
        "<h1>What accuracy costs in time</h1>\n<p>{machine}</p>\n"
    )?;
    text += "<p>Rings mark what the crate does unless told otherwise; the grey line joins the \
             settings that no other beats in both time and error.</p>\n";
    for section in sections {
        write!(
            text,
            "<h2>{}</h2>\n<p>{}</p>\n",
            section.title, section.text
        )?;
        text += &section.svg()?;
        match section.defaults_off_front()[..] {
            [] => {}
            ref off => writeln!(text, "<p>Not on the front: {}.</p>", off.join(", "))?,
        }
        text += &section.table();
    }
    Ok(text + "</main>\n")
}

const HEAD: &str = "<!doctype html>
<html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width, initial-scale=1'>
<title>What accuracy costs in time</title>
<style>
body { font: 17px/1.5 system-ui, sans-serif; margin: 0; color: #1c222c; }
main { max-width: 900px; margin: auto; padding: 0 16px 60px; }
svg { width: 100%; height: auto; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: 14px; }
td, th { padding: 3px 10px; text-align: right; white-space: nowrap; border-bottom: 1px solid #ddd; }
td:first-child, th:first-child { text-align: left; }
</style>
<main>
";
