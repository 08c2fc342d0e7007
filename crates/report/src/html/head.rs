//! Heading of the page, with the key figures.

use super::markup::{Html, el, el_text, text};
use crate::model::Report;
use crate::number::{decimal, real, thousands};
use crate::work::work;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;

/// Machine, scene and size, with the key figures below.
pub(super) fn head(report: &Report) -> Html {
    let what = format!("{} · {} · {}\u{a0}×\u{a0}{}", report.machine, report.input.name, report.size.width, report.size.height);
    let title = el("h1", &[], [text("Basrelief "), el_text("span", "quiet", what)]);
    let numbers = big_numbers(numbers(report));
    let message = report.outcome.message.as_deref().unwrap_or("The run did not finish.");
    let message = if report.outcome.is_complete() {
        Html::default()
    } else {
        el("p", &[("class", "bad"), ("role", "alert")], [text(message)])
    };
    el("header", &[], [title, message, numbers])
}

/// Key figures in large type, with their units.
pub fn big_numbers(numbers: impl IntoIterator<Item = (String, String)>) -> Html {
    // The file has the term first, the page shows the number first.
    let headline = |(number, unit)| el("div", &[], [el_text("dt", "", unit), el_text("dd", "", number)]);
    el("dl", &[("class", "numbers")], numbers.into_iter().map(headline))
}

/// Separates the unit of a time from its clock.
pub(super) const CLOCK: &str = " at ";

/// Returns the key figures: number, and unit of measure.
pub(super) fn numbers(report: &Report) -> Vec<(String, String)> {
    let frames = report.averaged_frames();
    let each = if frames > Some(1) { " per frame" } else { "" };
    let per_frame = |n: u64| thousands(n / frames.unwrap_or(1));
    let mut list = vec![];
    if report.cycles.is_some() {
        list.push((per_frame(report.frame_cycles()), format!("{}{each}", report.cycles_term())));
    }
    let one = work(report).one;
    if let Some(d) = report.derived.get(&format!("cycles_per_{one}")) {
        list.push((decimal(d.value, 2), format!("cycles per {one}")));
    }
    if let Some(quality) = &report.quality {
        let which = if quality.frames.is_empty() { "the reference image" } else { "reference images, worst frame" };
        list.push((format!("{:.2}", quality.min.psnr_db), format!("dB against {which}")));
    }
    if let Some(bytes) = report.memory_bytes() {
        list.push((per_frame(bytes), format!("bytes of memory traffic{each}")));
    }
    if let Some(area) = report.hardware_area() {
        list.push((thousands(area.area_ge), "gate equivalents".into()));
    }
    if let Some(d) = report.derived.get(if frames.is_some() { "frame_ms" } else { "time_ms" }) {
        let hz = report.clock_hz().unwrap_or(0.0);
        list.push((decimal(d.value, 3), format!("ms{each}{CLOCK}{} MHz", real(hz / 1e6))));
    }
    list
}

/// The report itself, to be saved.
pub(super) fn save_link(json: &str) -> Html {
    let data = data_url("application/json", json.as_bytes());
    let link = el("a", &[("href", &data), ("download", "report.json")], [text("Save the report as JSON")]);
    let note = text(" (all figures, including those that are not on this page).");
    el("footer", &[], [el("p", &[], [link, note])])
}

/// A file within the page.
pub(super) fn data_url(kind: &str, bytes: &[u8]) -> String {
    format!("data:{kind};base64,{}", BASE64_STANDARD.encode(bytes))
}
