//! A sweep as one page: what it found, in words and in drawings. It works from a disk, loads nothing but the pictures of points
//! that lie beside it, and is the same to the byte for equal tables.
//!
//! | part | where |
//! |---|---|
//! | what is drawn, and where it stands | `data`, `scale` |
//! | headline | `head` |
//! | any two or three figures against each other | `scatter`, moved by `sweep.js` |
//! | a line per point across all columns | `parallel` |
//! | what each axis moves | `tornado`, `heat` |
//! | points on the front, failures | `points` |
//!
//! All that is drawn is drawn here: the script moves points to positions that stand in the page and shows what was hidden. Without
//! it the page shows the first two objectives. Only so many rows are drawn as a browser bears; the page says how many.

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
use data::Sweep;
use sha2::{Digest, Sha256};

const STYLE: &str = include_str!("sweep.css");
const SCRIPT: &str = include_str!("sweep.js");

/// The page of a sweep. Pictures of rows are looked for beside it.
///
/// The table must be as [`Table::check`] demands; where a row has no cell for a column, none is shown.
pub fn page(table: &Table, options: &PageOptions) -> String {
    let sweep = Sweep::new(table, options);
    let parts = contents(&sweep);
    let links = parts.iter().map(|(id, title, _)| el("a", &[("href", &format!("#{id}"))], [text(title)]));
    let nav = el("nav", &[("aria-label", "Parts of this page")], links);
    let main = el("main", &[], parts.iter().map(|(id, title, content)| section(id, title, content.clone())));
    let body = [head::head(&sweep), nav, main, files(options), scatter::data(&sweep), Html::script(SCRIPT)];
    whole_page(&format!("{} · Basrelief", table.title), &policy(), STYLE, el("body", &[], body))
}

/// Nothing comes from elsewhere but pictures beside the page, and nothing is run but the one script.
fn policy() -> String {
    let hash = BASE64_STANDARD.encode(Sha256::digest(SCRIPT));
    format!(
        "default-src 'none'; base-uri 'none'; form-action 'none'; img-src 'self' file: data:; style-src 'unsafe-inline'; \
         script-src 'sha256-{hash}'"
    )
}

/// Parts that have something to say: name in addresses, heading, markup.
fn contents(sweep: &Sweep<'_>) -> Vec<(&'static str, &'static str, Html)> {
    let all = [
        ("scatter", "Figures against each other", scatter::scatter(sweep)),
        ("front", "Points on the front", points::front(sweep)),
        ("sensitivities", "What each axis moves", tornado::tornado(sweep)),
        ("pairs", "Two axes at once", heat::heat(sweep)),
        ("parallel", "All columns at once", parallel::parallel(sweep)),
        ("failures", "Points that failed", points::failures(sweep)),
    ];
    all.into_iter().filter(|(_, _, content)| !content.is_empty()).collect()
}

fn files(options: &PageOptions) -> Html {
    let item =
        |(path, what): &(String, String)| el("li", &[], [el("a", &[("href", path)], [text(path)]), text(format!(": {what}"))]);
    if options.files.is_empty() {
        return Html::default();
    }
    el(
        "footer",
        &[],
        [el_text("p", "quiet", "The whole table, beside this page:"), el("ul", &[], options.files.iter().map(item))],
    )
}
