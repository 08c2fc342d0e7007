//! The comparison as people read it.

use super::comparison::{CauseShare, Comparison, FigureChange, MeasuredCauses, SectionChanges, UnjudgedFigure, Verdict};
use super::explain::cause_name;
use crate::model::Figure;
use crate::number::signed;
use crate::text::sections::figure;
use crate::text::style::{Emphasis, TextStyle};
use crate::text::table::{Align, Table};
use Align::{Left, Right};

/// Maximum number of rows of a table; JSON has them all.
const SHOWN: usize = 12;

impl Comparison {
    /// Returns the causes, the tables and the verdict, with a line feed at the end.
    pub fn to_text(&self, style: TextStyle) -> String {
        let mut parts = vec![style.paint(Emphasis::Bold, &style.wrap(&self.explanation))];
        parts.extend(self.explained.as_ref().filter(|of| of.shares.len() > 1).map(|of| causes_table(of).render(style)));
        parts.extend(self.sections.iter().map(|section| section.to_text(style)));
        let Verdict { worst, unjudged } = &self.verdict;
        for UnjudgedFigure { figure, reason } in unjudged {
            parts.push(style.wrap(&format!("Cannot be judged: {figure}: {reason}.")));
        }
        if worst.percent > 0.0 {
            parts.push(format!("Largest regression: {}, {}.", worst.what, worst.size()));
        } else if unjudged.is_empty() && !self.equal {
            parts.push("No regression in time, bytes or quality.".into());
        }
        parts.join("\n\n") + "\n"
    }
}

/// How a cause was measured.
pub(crate) fn measured_by(share: &CauseShare) -> &'static str {
    match (share.by, share.needs_run) {
        (None, _) => "",
        (_, true) => "a run",
        (_, false) => "resimulation",
    }
}

/// The causes, largest effect first, and their interaction.
fn causes_table(explained: &MeasuredCauses) -> Table {
    let titles = [("Cause", Left, 0), ("alone", Right, 0), ("share", Right, 0), ("measured by", Left, 1), ("derived", Right, 1)];
    let mut table = Table::new(&titles);
    for share in &explained.shares {
        table.row([
            cause_name(share),
            share.by.map_or("not separable".into(), |by| signed(by as f64)),
            share.share.map_or(String::new(), |share| signed(share.round())),
            measured_by(share).into(),
            if share.derived.is_empty() { String::new() } else { format!("{} parameters", share.derived.len()) },
        ]);
    }
    table.row(["interaction".into(), signed(explained.together as f64), String::new(), String::new(), String::new()]);
    table
}

impl SectionChanges {
    fn to_text(&self, style: TextStyle) -> String {
        let own = &self.changes[..self.changes.len().saturating_sub(self.derived)];
        let (shown, more) = own.split_at(own.len().min(SHOWN));
        let more = if more.is_empty() { String::new() } else { format!("\n.. and {} more", more.len()) };
        let derived = if self.derived > 0 { format!("\n.. and {} that follow from these", self.derived) } else { String::new() };
        self.of(shown).render(style) + &more + &derived
    }

    /// All changes as a table.
    pub(crate) fn table(&self) -> Table {
        self.of(&self.changes)
    }

    /// Title of the first column.
    pub(crate) fn title(&self) -> &'static str {
        match self.table {
            "run" => "Run",
            "config" => "Parameter",
            "derived" => "Time",
            "cycles" => "Cycles",
            "units" => "Unit",
            "fifos" => "FIFO",
            "memories" => "Memory",
            "channels" => "Channel",
            "caches" => "Cache",
            "figures" => "Figure",
            "quality" => "Quality",
            _ => "Image",
        }
    }

    fn of(&self, changes: &[FigureChange]) -> Table {
        let mut table =
            Table::new(&[(self.title(), Left, 0), ("A", Right, 0), ("B", Right, 0), ("change", Right, 0), ("%", Right, 1)]);
        for change in changes {
            table.row(change.cells());
        }
        table
    }
}

impl FigureChange {
    fn cells(&self) -> [String; 5] {
        let field = if self.field == "value" { "" } else { self.field };
        // An entry of a list has its place there, as in the report.
        let is_entry = self.key.parse::<u64>().is_ok();
        let (key, entry) = if is_entry { ("", format!("[{}]", self.key)) } else { (self.key.as_str(), String::new()) };
        let words: Vec<&str> = [self.name.as_str(), field, key].into_iter().filter(|w| !w.is_empty()).collect();
        let figure = |x: &Option<Figure>| x.as_ref().map_or("-".into(), |x| shortened(figure(x)));
        let percent = |p: f64| format!("{}{:.1}", if p > 0.0 { "+" } else { "" }, p);
        // A ratio of decibels has no meaning.
        let is_level = self.field == "psnr_db";
        [
            words.join(" ") + &entry,
            figure(&self.a),
            figure(&self.b),
            self.delta.map_or(String::new(), |delta| if is_level { format!("{} dB", signed(delta)) } else { signed(delta) }),
            self.percent.filter(|_| !is_level).map_or(String::new(), percent),
        ]
    }
}

/// Shortens a hash.
fn shortened(text: String) -> String {
    const SHOWN: usize = 16;
    if text.chars().count() > 2 * SHOWN { text.chars().take(SHOWN).chain("..".chars()).collect() } else { text }
}

#[cfg(test)]
mod tests {
    use crate::compare::compare;
    use crate::samples;
    use crate::text::TextStyle;

    #[test]
    fn a_comparison_as_text() {
        let (a, b) = samples::before_and_after();
        insta::assert_snapshot!("comparison", compare(&a, &b, None).to_text(TextStyle::default()));
    }

    #[test]
    fn equal_reports_need_one_line() {
        let a = samples::balanced();
        assert_eq!(compare(&a, &a, None).to_text(TextStyle::default()), "The reports are equal, host figures aside.\n");
    }

    #[test]
    fn largest_regression_comes_last() {
        let (a, b) = samples::before_and_after();
        let text = compare(&b, &a, None).to_text(TextStyle::default());
        assert!(text.ends_with("Largest regression: cycles.frames[0], 160.0 %.\n"), "{text}");
    }
}
