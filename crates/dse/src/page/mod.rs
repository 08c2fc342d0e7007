//! A sweep as one HTML page. It works from a disk, loads only the pictures of points beside it, and is equal to the byte for equal
//! tables.
//!
//! | part | module |
//! |---|---|
//! | rows, columns and positions | `data`, `scale` |
//! | headline | `head` |
//! | scatter chart of two or three figures | `scatter`, moved by `sweep.js` |
//! | parallel coordinates | `parallel` |
//! | effects of the axes | `tornado`, `heat` |
//! | Pareto-optimal points, failures | `points` |
//!
//! This module draws everything: the script only moves points to positions in the page and shows hidden parts. Without it the page
//! shows the first two objectives. The number of drawn rows is limited for the browser; the page states it.

mod data;
mod head;
mod heat;
mod labels;
mod parallel;
mod points;
mod scale;
mod scatter;
#[cfg(test)]
mod tests;
mod tornado;

use crate::table::Table;
use base64::prelude::{BASE64_STANDARD, Engine};
use basrelief_report::html::markup::{Html, el, el_text, text};
use basrelief_report::html::{section, whole_page};
pub use data::PageOptions;
use data::SweepView;
use sha2::{Digest, Sha256};

const STYLE: &str = include_str!("sweep.css");
const SCRIPT: &str = include_str!("sweep.js");

/// Returns the page of a sweep. It expects pictures of rows beside itself.
///
/// The table must pass [`Table::check`]. Missing cells of a row are not shown.
pub fn page(table: &Table, options: &PageOptions) -> String {
    let sweep = SweepView::new(table, options);
    let parts = contents(&sweep);
    let links = parts.iter().map(|(id, title, _)| el("a", &[("href", &format!("#{id}"))], [text(title)]));
    let nav = el("nav", &[("aria-label", "Parts of this page")], links);
    let main = el("main", &[], parts.iter().map(|(id, title, content)| section(id, title, content.clone())));
    let body = [head::head(&sweep), nav, main, files(options), scatter::data(&sweep), Html::script(SCRIPT)];
    whole_page(&format!("{} · Basrelief", table.title), &policy(), STYLE, el("body", &[], body))
}

/// Returns the security policy: only pictures beside the page are loaded, and only the one script runs.
fn policy() -> String {
    let hash = BASE64_STANDARD.encode(Sha256::digest(SCRIPT));
    format!(
        "default-src 'none'; base-uri 'none'; form-action 'none'; img-src 'self' file: data:; style-src 'unsafe-inline'; \
         script-src 'sha256-{hash}'"
    )
}

/// Parts that have something to say: name in addresses, heading, markup.
fn contents(sweep: &SweepView<'_>) -> Vec<(&'static str, &'static str, Html)> {
    let all = [
        ("scatter", "Scatter chart", scatter::scatter(sweep)),
        ("front", "Pareto-optimal points", points::front(sweep)),
        ("sensitivities", "Effect of each axis", tornado::tornado(sweep)),
        ("pairs", "Pairs of axes", heat::heat(sweep)),
        ("parallel", "Parallel coordinates", parallel::parallel(sweep)),
        ("failures", "Failed points", points::failures(sweep)),
    ];
    all.into_iter().filter(|(_, _, content)| !content.is_empty()).collect()
}

fn files(options: &PageOptions) -> Html {
    let item =
        |(path, what): &(String, String)| el("li", &[], [el("a", &[("href", path)], [text(path)]), text(format!(": {what}"))]);
    if options.files.is_empty() {
        return Html::default();
    }
    el("footer", &[], [el_text("p", "quiet", "Files with the whole table:"), el("ul", &[], options.files.iter().map(item))])
}
