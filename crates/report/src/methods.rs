//! Cost of each method of choosing division points at the same error bound: one line per method.

use crate::csv;
use crate::model::{Figure, Input, Report, Size};
use crate::number::round6;
use crate::number::{real, thousands};
use crate::text::style::TextStyle;
use crate::text::table::{Align, Table};
use crate::work::work;
use Align::{Left, Right};
use serde::{Deserialize, Serialize};

/// The same input on the same machine by different methods.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MethodComparison {
    /// Version of the simulator.
    pub version: String,
    /// The machine, as `--machine` names it.
    pub machine: String,
    /// Input of the run.
    pub input: Input,
    /// Size of the pictures.
    pub size: Size,
    /// Largest displacement that every method was to keep \[pixels\].
    pub error_bound: f64,
    /// One per method.
    pub methods: Vec<MethodResult>,
}

/// One run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MethodResult {
    /// In words.
    pub method: String,
    /// Options that select the method.
    pub settings: Vec<String>,
    /// All divisions and reciprocals per pixel with a texture, set-up and steps included.
    pub divisions_per_pixel: f64,
    /// Of the run.
    pub cycles: u64,
    /// `cycles / pixels drawn`, those that a nearer one hides included; rounded to 6 decimals.
    pub cycles_per_pixel: f64,
    /// Measured over all pixels with a texture \[pixels\].
    pub displacement_largest: f64,
    /// As above.
    pub displacement_mean: f64,
    /// Against exact mapping, of the worst picture \[dB\]; absent without reference images.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub psnr_db: Option<f64>,
}

impl MethodComparison {
    /// An empty one, for runs like this.
    pub fn of(report: &Report, error_bound: f64) -> Self {
        Self {
            version: report.version.clone(),
            machine: report.machine.clone(),
            input: report.input.clone(),
            size: report.size,
            error_bound,
            methods: vec![],
        }
    }

    /// The table on a terminal, with a line feed at the end.
    pub fn to_text(&self, style: TextStyle) -> String {
        let mut table = Table::new(&[
            ("Method", Left, 0),
            ("divisions/pixel", Right, 0),
            ("cycles", Right, 1),
            ("cycles/pixel", Right, 0),
            ("largest displacement", Right, 0),
            ("mean", Right, 1),
            ("PSNR dB", Right, 0),
        ]);
        let digits = |value: f64, scale: f64| real((value * scale).round() / scale);
        for m in &self.methods {
            table.row([
                m.method.clone(),
                digits(m.divisions_per_pixel, 1e4),
                thousands(m.cycles),
                digits(m.cycles_per_pixel, 1e4),
                digits(m.displacement_largest, 1e4),
                digits(m.displacement_mean, 1e4),
                m.psnr_db.map_or_else(String::new, |db| digits(db, 1e2)),
            ]);
        }
        let Size { width, height } = self.size;
        let title = format!("{} · {} {} · {width} x {height}", self.machine, self.input.kind, self.input.name);
        let bound = format!("No texel from farther away than {} pixels", self.error_bound);
        format!("{title}\n{bound}\n\n{}\n", table.render(style))
    }

    /// One line per method, header first.
    pub fn to_csv(&self) -> String {
        let header = [
            "method",
            "settings",
            "divisions_per_pixel",
            "cycles",
            "cycles_per_pixel",
            "displacement_largest",
            "displacement_mean",
            "psnr_db",
        ];
        let rows = self.methods.iter().map(|m| {
            [
                m.method.clone(),
                m.settings.join(" "),
                m.divisions_per_pixel.to_string(),
                m.cycles.to_string(),
                m.cycles_per_pixel.to_string(),
                m.displacement_largest.to_string(),
                m.displacement_mean.to_string(),
                m.psnr_db.map_or_else(String::new, |db| db.to_string()),
            ]
        });
        csv::csv_text(header, rows)
    }

    /// Indented, with a line feed at the end.
    ///
    /// # Errors
    /// None that is known: all of it is numbers and words.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string_pretty(self).map(|text| text + "\n")
    }
}

impl MethodResult {
    /// Result of a run.
    pub fn of(method: String, settings: Vec<String>, report: &Report) -> Self {
        let cycles = report.frame_cycles();
        let pixels = work(report).count;
        Self {
            method,
            settings,
            divisions_per_pixel: round6(figure(report, "divisions_per_pixel")),
            cycles,
            cycles_per_pixel: if pixels == 0 { 0.0 } else { round6(cycles as f64 / pixels as f64) },
            displacement_largest: figure(report, "displacement_largest"),
            displacement_mean: figure(report, "displacement_mean"),
            psnr_db: report.quality.as_ref().map(|quality| quality.min.psnr_db),
        }
    }
}

/// A figure of the machine; 0 where it has none of this name.
pub fn figure(report: &Report, name: &str) -> f64 {
    match report.figures.get(name) {
        Some(Figure::Count(n)) => *n as f64,
        Some(Figure::Real(x)) => *x,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples;

    fn methods() -> MethodComparison {
        let (mut slow, mut fast) = samples::before_and_after();
        for (report, share, largest) in [(&mut fast, 0.0625, 0.498), (&mut slow, 2.0, 0.0)] {
            report.figures.insert("divisions_per_pixel".into(), Figure::Real(share));
            report.figures.insert("displacement_largest".into(), Figure::Real(largest));
        }
        let mut methods = MethodComparison::of(&fast, 0.5);
        methods.methods.push(MethodResult::of("adaptive".into(), vec!["texel.method=adaptive".into()], &fast));
        methods.methods.push(MethodResult::of("exact".into(), vec!["texel.method=exact".into()], &slow));
        methods
    }

    #[test]
    fn as_text_csv_and_json() {
        let methods = methods();
        let text = methods.to_text(TextStyle::default());
        assert!(text.contains("farther away than 0.5 pixels"), "{text}");
        let line = |start: &str| text.lines().find(|l| l.starts_with(start)).map(|l| l.split_whitespace().collect::<Vec<_>>());
        assert_eq!(line("adaptive").unwrap()[..5], ["adaptive", "0.0625", "400,000", "2", "0.498"]);
        assert_eq!(line("exact").unwrap()[..5], ["exact", "2", "1,000,000", "5", "0"]);
        let csv = methods.to_csv();
        assert!(csv.lines().nth(1).unwrap().starts_with("adaptive,texel.method=adaptive,0.0625,400000,2,0.498,0,"), "{csv}");
        assert_eq!(serde_json::from_str::<MethodComparison>(&methods.to_json().unwrap()).unwrap(), methods);
    }

    #[test]
    fn the_worst_picture_counts() {
        let (mut report, _) = samples::before_and_after();
        let last = report.quality.as_ref().unwrap().last;
        let frames = [40.0, 30.0, 50.0].map(|psnr_db| basrelief_reference::QualityMetrics { psnr_db, ..last });
        report.quality = crate::model::PictureQuality::of(&frames, None);
        assert_eq!(MethodResult::of(String::new(), vec![], &report).psnr_db, Some(30.0));
    }
}
