//! Shapes, and the charts that are made of them. Colours are classes: each has one meaning on the whole page.

use super::markup::{Html, el, el_text, text};
use crate::number::{round_number, round_step, thousands};

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

/// Values along an axis of columns.
#[derive(Clone, Copy)]
pub(super) struct Ruler {
    /// Value of the first column.
    pub(super) first: f64,
    /// Distance of two columns.
    pub(super) per_column: f64,
    /// Position of a value in its column: 0 for its left edge, 0.5 for its middle.
    pub(super) within: f64,
}

impl Ruler {
    /// Returns the ruler of the columns that [`bins`] makes from `count` values at a distance: values are at the left edge of a column.
    pub(super) fn of_bins(count: usize, most: usize, distance: f64) -> Self {
        Self { first: 0.0, per_column: distance * per_bin(count, most) as f64, within: 0.0 }
    }

    /// Returns the ruler of things that are numbered from `first`: a number is in the middle of a column that holds no other.
    pub(super) fn numbered(first: f64, count: usize, most: usize) -> Self {
        let per = per_bin(count, most);
        Self { first, within: if per == 1 { 0.5 } else { 0.0 }, ..Self::of_bins(count, most, 1.0) }
    }
}

/// Width of a wide and of a narrow page \[pixels\]; of a letter in a segment, and of both margins of its label.
const WIDE: f64 = 1000.0;
const NARROW: f64 = 330.0;
const LETTER: f64 = 7.6;
const MARGINS: f64 = 14.0;

/// A bar as wide as its place, with the name of each part in it. A part that is too narrow for its name has none.
pub(super) fn labelled_bar(parts: &[BarPart], whole: u64) -> Html {
    let percent = |n: u64| format!("{:.3}%", 100.0 * n as f64 / whole.max(1) as f64);
    let mut before = 0;
    let segments = parts.iter().map(|(class, name, n)| {
        let share = *n as f64 / whole.max(1) as f64;
        let room = |page: f64| name.chars().count() as f64 * LETTER + MARGINS <= share * page;
        let about = el_text("title", "", format!("{name}: {}", percent_of(*n, whole)));
        let fill = el("rect", &[("width", "100%"), ("height", "100%")], [about]);
        let class_of_label = if room(NARROW) { "" } else { "wide-only" };
        let label = el("text", &[("class", class_of_label), ("x", "6"), ("y", "64%")], [text(name)]);
        let place = [("class", *class), ("x", &percent(before)), ("width", &percent(*n)), ("height", "100%")];
        before += n;
        el("svg", &place, [fill, if room(WIDE) { label } else { Html::default() }])
    });
    let parts_text: Vec<String> = parts.iter().map(|(_, name, n)| format!("{name} {}", percent_of(*n, whole))).collect();
    let attributes = [("class", "bar segments"), ("role", "img"), ("aria-label", &parts_text.join(", "))];
    el("svg", &attributes, segments.collect::<Vec<_>>())
}

/// Columns over an axis.
pub(super) struct ColumnChart<'a> {
    /// Title.
    pub(super) title: &'a str,
    /// Labels of the x and y axis.
    pub(super) axes: [&'a str; 2],
    /// Class of its colour.
    pub(super) class: &'static str,
    /// Label and height of each column.
    pub(super) columns: Vec<(String, f64)>,
    /// Values along the x axis, which get round ticks; `None` if the columns have their labels as ticks.
    pub(super) ruler: Option<Ruler>,
    /// Ends of the upright axis in words: of the highest column, or of a whole.
    pub(super) top: (f64, String),
    /// Width and height.
    pub(super) size: (f64, f64),
}

/// Room beside the columns: at least for the numbers left, the titles above and the numbers below.
const LEFT: f64 = 58.0;
const ABOVE: f64 = 20.0;
const BELOW: f64 = 34.0;
/// Room that a number under a column takes, per character, and between two.
const DIGIT: f64 = 6.6;

impl ColumnChart<'_> {
    /// Room left of the columns, for the number at the top.
    fn left(&self) -> f64 {
        LEFT.max(self.top.1.chars().count() as f64 * DIGIT + 8.0)
    }

    /// The chart, with its axes.
    pub(super) fn draw(&self) -> Html {
        let left = self.left();
        let (width, height) = (self.size.0 - left - 4.0, self.size.1 - ABOVE - BELOW);
        let each = width / self.columns.len().max(1) as f64;
        let gap = if each > 5.0 { 1.0 } else { 0.0 };
        let columns = self.columns.iter().enumerate().filter(|(_, (_, n))| *n > 0.0).map(|(i, (label, n))| {
            // A value above zero has a visible column.
            let tall = ((n / self.top.0.max(f64::MIN_POSITIVE)).min(1.0) * height).max(1.0);
            let at = [left + i as f64 * each, ABOVE + height - tall, each - gap, tall];
            rect(self.class, at, &format!("{label}: {}", number(*n)))
        });
        let shapes: Html = columns.chain([self.frame(width, height), self.column_labels(each, height)]).collect();
        svg("chart", self.size, &self.description(), "xMinYMid meet", shapes)
    }

    fn frame(&self, width: f64, height: f64) -> Html {
        let (left, base) = (self.left(), ABOVE + height);
        let path = format!("M{} {} V{} H{}", px(left), px(ABOVE), px(base), px(left + width));
        let titles = [
            label("end", left - 5.0, ABOVE + 9.0, &self.top.1),
            label("end", left - 5.0, base, "0"),
            label("start", 2.0, 11.0, self.axes[1]),
            label("end", left + width, base + 30.0, self.axes[0]),
        ];
        std::iter::once(el("path", &[("class", "axis"), ("d", &path)], [])).chain(titles).collect()
    }

    /// Numbers under the columns, as many as there is room for.
    fn column_labels(&self, each: f64, height: f64) -> Html {
        if let Some(ruler) = self.ruler {
            return self.round_labels(ruler, each, height);
        }
        let left = self.left();
        let longest = self.columns.iter().map(|(label, _)| label.chars().count()).max().unwrap_or(1);
        let every = ((longest as f64 + 1.5) * DIGIT / each).ceil().max(1.0) as usize;
        let placed = self.columns.iter().enumerate().map(|(i, (text, _))| (left + (i as f64 + 0.5) * each, text));
        // A number that would be cut off at the right is left out.
        let shown = placed.step_by(every).filter(|(x, text)| x + text.chars().count() as f64 * DIGIT / 2.0 <= self.size.0);
        numbers_below(shown, height)
    }

    /// Round numbers under the columns, as many as there is room for.
    fn round_labels(&self, ruler: Ruler, each: f64, height: f64) -> Html {
        let left = self.left();
        let last = ruler.first + ruler.per_column * self.columns.len() as f64;
        let room = (thousands(last as u64).chars().count() as f64 + 1.5) * DIGIT;
        let (digit, exponent) = round_step((room / each * ruler.per_column).max(1.0));
        let step = round_number(digit, exponent);
        let ticks = (0..self.columns.len()).map(|k| step * k as f64).skip_while(|value| *value < ruler.first);
        let placed = ticks.map(|value| (left + each * ((value - ruler.first) / ruler.per_column + ruler.within), value));
        let end = left + each * self.columns.len() as f64;
        let shown = placed.map(|(x, value)| (x, thousands(value as u64))).take_while(|(x, text)| {
            // A number that would be cut off at the right is left out.
            *x < end && x + text.chars().count() as f64 * DIGIT / 2.0 <= self.size.0
        });
        numbers_below(shown, height)
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

/// Numbers under columns of this height, at these places. On a narrow screen every second one is hidden.
fn numbers_below(shown: impl Iterator<Item = (f64, impl AsRef<str>)>, height: f64) -> Html {
    let place = |(i, (x, text)): (usize, (f64, _))| {
        let number = label("middle", x, ABOVE + height + 14.0, AsRef::as_ref(&text));
        if i % 2 == 0 { number } else { el("g", &[("class", "odd")], [number]) }
    };
    shown.enumerate().map(place).collect()
}

/// Whole numbers whole, others with two decimals.
fn number(n: f64) -> String {
    if n.fract() == 0.0 { thousands(n as u64) } else { px(n) }
}

/// Text in a drawing; `anchor` is its `text-anchor`.
pub fn label(anchor: &str, x: f64, y: f64, content: &str) -> Html {
    el("text", &[("text-anchor", anchor), ("x", &px(x)), ("y", &px(y))], [text(content)])
}

/// Returns the number of values of a bin.
fn per_bin(count: usize, most: usize) -> usize {
    count.div_ceil(most).max(1)
}

/// Groups values into at most `most` columns of equal size, except the last. Returns the number of the first value, and the values.
pub(super) fn bins(values: &[f64], most: usize) -> impl Iterator<Item = (usize, &[f64])> {
    let per = per_bin(values.len(), most);
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
    fn segments_have_names_if_there_is_room() {
        let part = |class, name: &str, n| (class, name.to_owned(), n);
        let parts = [part("hue-0", "geometry", 600), part("hue-1", "frame-buffer", 250), part("hue-2", "rasterizer", 150)];
        let bar = labelled_bar(&parts, 1000).into_text();
        assert!(bar.contains("class=\"hue-1\" x=\"60.000%\" width=\"25.000%\""), "{bar}");
        assert!(bar.contains("<text class=\"\" x=\"6\" y=\"64%\">geometry</text>"), "{bar}");
        assert!(bar.contains("<text class=\"wide-only\" x=\"6\" y=\"64%\">frame-buffer</text>"), "{bar}");
        let narrow = labelled_bar(&[part("hue-0", "geometry", 950), part("hue-1", "rasterizer", 50)], 1000).into_text();
        assert!(!narrow.contains(">rasterizer</text>"), "{narrow}");
        assert!(narrow.contains("aria-label=\"geometry 95.0 %, rasterizer 5.0 %\""), "{narrow}");
    }

    #[test]
    fn ticks_of_numeric_axes_are_round() {
        let numbers = |columns: usize, ruler| {
            let columns = (0..columns).map(|k| (k.to_string(), 1.0)).collect();
            let (title, axes, class) = ("t", ["x", "y"], "busy");
            let chart = ColumnChart { title, axes, class, columns, ruler, top: (1.0, "1".into()), size: (540.0, 150.0) };
            let drawing = chart.draw().into_text();
            let ticks = drawing.split("text-anchor=\"middle\"").skip(1).map(|rest| {
                let (_, text) = rest.split_once('>').unwrap();
                text.split_once('<').unwrap().0.to_owned()
            });
            ticks.collect::<Vec<_>>().join(" ")
        };
        let cycles = "0 100,000 200,000 300,000 400,000 500,000";
        assert_eq!(numbers(130, Some(Ruler::of_bins(130, 150, 4096.0))), cycles);
        assert_eq!(numbers(65, Some(Ruler::of_bins(130, 65, 4096.0))), cycles, "the same values in half as many columns");
        assert_eq!(numbers(90, Some(Ruler::numbered(1.0, 90, 120))), "5 10 15 20 25 30 35 40 45 50 55 60 65 70 75 80 85 90");
        assert_eq!(numbers(3, None), "0 1 2");
    }

    #[test]
    fn many_values_share_columns() {
        let means = |values: &[f64]| bins(values, 2).map(|(at, chunk)| (at, mean(chunk))).collect::<Vec<_>>();
        assert_eq!(means(&[1.0, 3.0, 5.0]), [(0, 2.0), (2, 5.0)]);
        assert_eq!(means(&[]), []);
    }
}
