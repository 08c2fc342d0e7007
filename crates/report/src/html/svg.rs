//! Shapes, and the charts that are made of them. Colours are classes: each has one meaning on the whole page.

use super::markup::{Html, el, el_text, text};
use crate::number::thousands;

/// A length of a drawing, with at most two decimals.
pub fn px(x: f64) -> String {
    let text = format!("{x:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Returns a rectangle: left, top, width, height; with a tooltip.
pub fn rect(class: &str, [x, y, width, height]: [f64; 4], title: &str) -> Html {
    let title = if title.is_empty() { None } else { Some(el_text("title", "", title)) };
    let sides = [x, y, width, height].map(px);
    el("rect", &[("class", class), ("x", &sides[0]), ("y", &sides[1]), ("width", &sides[2]), ("height", &sides[3])], title)
}

/// Returns a drawing of this size with a description; `fit` is its `preserveAspectRatio`.
pub fn svg(class: &str, (width, height): (f64, f64), says: &str, fit: &str, shapes: Html) -> Html {
    let view = format!("0 0 {} {}", px(width), px(height));
    let attributes =
        [("class", class), ("viewBox", view.as_str()), ("preserveAspectRatio", fit), ("role", "img"), ("aria-label", says)];
    el("svg", &attributes, [shapes])
}

/// Returns a drawing scaled by a factor, whatever the width of its place. Attributes set the size, because a page may forbid styles.
pub fn svg_sized(class: &str, (width, height): (f64, f64), times: f64, says: &str, shapes: Html) -> Html {
    let view = format!("0 0 {} {}", px(width), px(height));
    let (width, height) = (px(times * width), px(times * height));
    let attributes = [
        ("class", class),
        ("viewBox", view.as_str()),
        ("width", width.as_str()),
        ("height", height.as_str()),
        ("role", "img"),
        ("aria-label", says),
    ];
    el("svg", &attributes, [shapes])
}

/// A part of a bar: class of its colour, name, size.
pub(super) type BarPart = (&'static str, String, u64);

/// Share of a whole, as people read it.
pub(super) fn percent_of(part: u64, whole: u64) -> String {
    match (part, whole) {
        (0, _) | (_, 0) => "0 %".into(),
        _ => format!("{:.1} %", 100.0 * part as f64 / whole as f64),
    }
}

/// Rectangles side by side that fill a space as their parts do a whole.
pub(super) fn stacked_rects(parts: &[BarPart], whole: u64, [x, y, width, height]: [f64; 4]) -> Html {
    let scale = width / whole.max(1) as f64;
    let mut at = x;
    let shapes = parts.iter().filter(|(.., n)| *n > 0).map(|(class, name, n)| {
        let wide = *n as f64 * scale;
        let shape = rect(class, [at, y, wide, height], &format!("{name}: {}", percent_of(*n, whole)));
        at += wide;
        shape
    });
    shapes.collect()
}

/// A bar as wide as its place, its parts side by side.
pub(super) fn bar(parts: &[BarPart], whole: u64) -> Html {
    let parts_text: Vec<String> =
        parts.iter().filter(|(.., n)| *n > 0).map(|(_, name, n)| format!("{name} {}", percent_of(*n, whole))).collect();
    let says = if parts_text.is_empty() { "nothing".to_owned() } else { parts_text.join(", ") };
    svg("bar", (1000.0, 10.0), &says, "none", stacked_rects(parts, whole, [0.0, 0.0, 1000.0, 10.0]))
}

/// Columns over an axis.
pub(super) struct ColumnChart<'a> {
    /// Title.
    pub(super) title: &'a str,
    /// Labels of the x and y axis.
    pub(super) axes: [&'a str; 2],
    /// Class of its colour.
    pub(super) class: &'static str,
    /// Under each column, and its height.
    pub(super) columns: Vec<(String, f64)>,
    /// Ends of the upright axis in words: of the highest column, or of a whole.
    pub(super) top: (f64, String),
    /// Width and height.
    pub(super) size: (f64, f64),
}

/// Room beside the columns: for the numbers left, the titles above and the numbers below.
const LEFT: f64 = 58.0;
const ABOVE: f64 = 20.0;
const BELOW: f64 = 34.0;
/// Room that a number under a column takes, per character, and between two.
const DIGIT: f64 = 6.6;

impl ColumnChart<'_> {
    /// The chart, with its axes.
    pub(super) fn draw(&self) -> Html {
        let (width, height) = (self.size.0 - LEFT - 4.0, self.size.1 - ABOVE - BELOW);
        let each = width / self.columns.len().max(1) as f64;
        let gap = if each > 5.0 { 1.0 } else { 0.0 };
        let columns = self.columns.iter().enumerate().filter(|(_, (_, n))| *n > 0.0).map(|(i, (label, n))| {
            // A value above zero has a visible column.
            let tall = ((n / self.top.0.max(f64::MIN_POSITIVE)).min(1.0) * height).max(1.0);
            let at = [LEFT + i as f64 * each, ABOVE + height - tall, each - gap, tall];
            rect(self.class, at, &format!("{label}: {}", number(*n)))
        });
        let shapes: Html = columns.chain([self.frame(width, height), self.column_labels(each, height)]).collect();
        svg("chart", self.size, &self.description(), "xMinYMid meet", shapes)
    }

    fn frame(&self, width: f64, height: f64) -> Html {
        let base = ABOVE + height;
        let path = format!("M{} {} V{} H{}", px(LEFT), px(ABOVE), px(base), px(LEFT + width));
        let titles = [
            label("end", LEFT - 5.0, ABOVE + 9.0, &self.top.1),
            label("end", LEFT - 5.0, base, "0"),
            label("start", 2.0, 11.0, self.axes[1]),
            label("end", LEFT + width, base + 30.0, self.axes[0]),
        ];
        std::iter::once(el("path", &[("class", "axis"), ("d", &path)], [])).chain(titles).collect()
    }

    /// Numbers under the columns, as many as there is room for.
    fn column_labels(&self, each: f64, height: f64) -> Html {
        let longest = self.columns.iter().map(|(label, _)| label.chars().count()).max().unwrap_or(1);
        let every = ((longest as f64 + 1.5) * DIGIT / each).ceil().max(1.0) as usize;
        let placed = self.columns.iter().enumerate().map(|(i, (text, _))| (LEFT + (i as f64 + 0.5) * each, text));
        // A number that would be cut off at the right is left out.
        let shown = placed.step_by(every).filter(|(x, text)| x + text.chars().count() as f64 * DIGIT / 2.0 <= self.size.0);
        shown.map(|(x, text)| label("middle", x, ABOVE + height + 14.0, text)).collect()
    }

    fn description(&self) -> String {
        let highest = self.columns.iter().reduce(|best, c| if c.1 > best.1 { c } else { best });
        let highest = highest.filter(|c| c.1 > 0.0).map_or("all zero".to_owned(), |(label, n)| {
            let [across, upright] = self.axes;
            format!("highest at {label} ({across}) with {} ({upright})", number(*n))
        });
        format!("{}: {highest}", self.title)
    }
}

/// Whole numbers whole, others with two decimals.
fn number(n: f64) -> String {
    if n.fract() == 0.0 { thousands(n as u64) } else { px(n) }
}

/// Text in a drawing; `anchor` is its `text-anchor`.
pub fn label(anchor: &str, x: f64, y: f64, content: &str) -> Html {
    el("text", &[("text-anchor", anchor), ("x", &px(x)), ("y", &px(y))], [text(content)])
}

/// Groups values into at most `most` columns of equal size, except the last. Returns the number of the first value, and the values.
pub(super) fn bins(values: &[f64], most: usize) -> impl Iterator<Item = (usize, &[f64])> {
    let per = values.len().div_ceil(most).max(1);
    values.chunks(per).enumerate().map(move |(i, chunk)| (i * per, chunk))
}

/// For [`bins`]: their mean.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_short_and_shares_never_vanish() {
        assert_eq!([px(1.0), px(0.125), px(-2.5), px(10.0)], ["1", "0.12", "-2.5", "10"]);
        assert_eq!([percent_of(0, 3), percent_of(1, 0), percent_of(1, 8)], ["0 %", "0 %", "12.5 %"]);
    }

    #[test]
    fn parts_fill_the_bar_and_its_description() {
        let parts = [("busy", "busy".to_owned(), 30), ("done", "done".to_owned(), 0), ("starved", "starved: in".to_owned(), 70)];
        let text = bar(&parts, 100).into_text();
        assert!(text.contains("aria-label=\"busy 30.0 %, starved: in 70.0 %\""), "{text}");
        assert!(bar(&[], 0).into_text().contains("aria-label=\"nothing\""), "every drawing has a description");
        assert!(text.contains("class=\"starved\" x=\"300\" y=\"0\" width=\"700\""), "{text}");
    }

    #[test]
    fn many_values_share_columns() {
        let means = |values: &[f64]| bins(values, 2).map(|(at, chunk)| (at, mean(chunk))).collect::<Vec<_>>();
        assert_eq!(means(&[1.0, 3.0, 5.0]), [(0, 2.0), (2, 5.0)]);
        assert_eq!(means(&[]), []);
    }
}
