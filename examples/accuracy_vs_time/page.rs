//! One page with everything in it, readable from a file on a laptop and on a phone.

use crate::plot::svg;
use crate::report::Section;
use std::error::Error;
use std::fmt::Write;

/// All sections under a heading and a line on the machine.
pub fn page(sections: &[Section], machine: &str) -> Result<String, Box<dyn Error>> {
    let mut text = String::from(HEAD);
    write!(
        text,
        "<h1>What accuracy costs in time</h1>\n<p>{machine}</p>\n<p>Rings mark what the crate does \
         unless told otherwise; the grey line joins the settings that no other beats in both time \
         and error.</p>\n<ul>\n"
    )?;
    for section in sections {
        writeln!(
            text,
            "<li><a href='#{}'>{}</a>",
            section.name, section.title
        )?;
    }
    text += "</ul>\n";
    for section in sections {
        let Section {
            name,
            title,
            text: said,
            ..
        } = section;
        write!(text, "<h2 id={name}>{title}</h2>\n<p>{said}</p>\n")?;
        writeln!(text, "<div class=wide>{}</div>", svg(&section.plot)?)?;
        let off = section.defaults_off_front();
        if !off.is_empty() {
            writeln!(
                text,
                "<p>Not on the front: {}. {}</p>",
                off.join("; "),
                section.note
            )?;
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
h1, h2 { line-height: 1.2; }
h2 { margin-top: 2em; }
svg { width: 100%; min-width: 560px; height: auto; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: 14px; }
td, th { padding: 3px 10px; text-align: right; white-space: nowrap; border-bottom: 1px solid #ddd; }
td:first-child, th:first-child { text-align: left; position: sticky; left: 0; background: #fff; }
</style>
<main>
";
