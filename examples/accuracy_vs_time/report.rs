//! What the measurements are handed on as: a table for the CSV file, and what to plot.

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

/// A picture of a section; each series has a name and a colour.
pub enum Plot {
    /// Error against time, both axes logarithmic, with the Pareto front.
    Front {
        /// Unit of the times.
        time: &'static str,
        /// What the error is, and its unit.
        error: &'static str,
        /// The settings measured.
        series: Vec<(String, Vec<Point>)>,
    },
    /// Lines over something.
    Lines {
        /// What runs to the right, and its unit.
        x: &'static str,
        /// What runs up, and its unit.
        y: &'static str,
        /// Whether the axes are logarithmic.
        log: [bool; 2],
        /// Places in order.
        series: Vec<(String, Vec<(f64, f64)>)>,
    },
}

/// One experiment.
pub struct Section {
    /// File name of its table and its plot.
    pub name: &'static str,
    /// Heading on the page.
    pub title: &'static str,
    /// What was done and how to read it, in a few sentences.
    pub text: String,
    /// Said where a default is off the front: why.
    pub note: &'static str,
    /// What is drawn.
    pub plot: Plot,
    /// Columns of the table.
    pub head: Vec<&'static str>,
    /// Its rows.
    pub rows: Vec<Vec<String>>,
}

impl Section {
    /// Comma-separated values, with a head.
    pub fn csv(&self) -> String {
        let rows = self.rows.iter();
        let rows = rows.map(|row| line(row.iter().map(String::as_str)));
        line(self.head.iter().copied()) + &rows.collect::<String>()
    }

    /// The table as HTML; nothing where it is too long to read.
    pub fn table(&self) -> String {
        const LONGEST: usize = 60;
        if self.rows.len() > LONGEST {
            return format!("<p>{} rows in {}.csv.</p>\n", self.rows.len(), self.name);
        }
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

    /// The default settings that are not on the front.
    pub fn defaults_off_front(&self) -> Vec<String> {
        let Plot::Front { series, .. } = &self.plot else {
            return Vec::new();
        };
        let front = front(series);
        let off = |p: &&Point| p.default && !front.iter().any(|q| std::ptr::eq(*q, *p));
        let named = series.iter().flat_map(|(name, points)| {
            let off = points.iter().filter(off);
            off.map(move |p| format!("{name} {}", p.label))
        });
        named.collect()
    }
}

/// Points that no other beats in both time and error, the fastest first.
pub fn front(series: &[(String, Vec<Point>)]) -> Vec<&Point> {
    let all = || series.iter().flat_map(|(_, points)| points);
    let beaten = |p: &Point| {
        all().any(|q| {
            q.time <= p.time && q.error <= p.error && (q.time < p.time || q.error < p.error)
        })
    };
    let mut front: Vec<&Point> = all().filter(|p| !beaten(p)).collect();
    front.sort_by(|a, b| a.time.total_cmp(&b.time));
    front
}

/// A line of a CSV file; cells with commas are quoted.
fn line<'a>(cells: impl Iterator<Item = &'a str>) -> String {
    let quoted = cells.map(|cell| match cell.contains(',') {
        true => format!("\"{cell}\""),
        false => cell.to_string(),
    });
    quoted.collect::<Vec<_>>().join(",") + "\n"
}
