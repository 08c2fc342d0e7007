//! Cycles with each optimization of a machine switched off: one line per variant, the configured machine first.

use crate::csv;
use crate::model::{Input, Report, Size};
use crate::number::round6;
use crate::number::{real, signed, thousands};
use crate::text::style::TextStyle;
use crate::text::table::{Align, Table};
use crate::work::work;
use Align::{Left, Right};
use serde::{Deserialize, Serialize};

/// The same input on the same machine with short cuts switched off.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ablation {
    /// Version of the simulator.
    pub version: String,
    /// The machine, as `--machine` names it.
    pub machine: String,
    /// Input of the run.
    pub input: Input,
    /// Size of the pictures.
    pub size: Size,
    /// The machine as configured, without each short cut in turn, and without any.
    pub variants: Vec<AblationVariant>,
}

/// One run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AblationVariant {
    /// Optimization that is switched off.
    pub variant: String,
    /// Of the run.
    pub cycles: u64,
    /// Dots drawn, those that a nearer one hides included.
    pub dots: u64,
    /// `cycles / dots`, rounded to 6 decimals; 0 where nothing was drawn.
    pub cycles_per_dot: f64,
    /// Change of the cycles against the first variant \[%\].
    pub change_percent: f64,
    /// Largest change of any 8-bit value of any picture against the first variant.
    pub largest_change: u8,
}

impl Ablation {
    /// An empty one, for runs like this.
    pub fn of(report: &Report) -> Self {
        Self {
            version: report.version.clone(),
            machine: report.machine.clone(),
            input: report.input.clone(),
            size: report.size,
            variants: vec![],
        }
    }

    /// The table on a terminal, with a line feed at the end.
    pub fn to_text(&self, style: TextStyle) -> String {
        let mut table = Table::new(&[
            ("Variant", Left, 0),
            ("cycles", Right, 0),
            ("change %", Right, 0),
            ("cycles/dot", Right, 0),
            ("largest change", Right, 0),
        ]);
        for v in &self.variants {
            table.row([
                v.variant.clone(),
                thousands(v.cycles),
                signed((v.change_percent * 100.0).round() / 100.0),
                real((v.cycles_per_dot * 1e4).round() / 1e4),
                v.largest_change.to_string(),
            ]);
        }
        let Size { width, height } = self.size;
        let title = format!("{} · {} {} · {width} x {height}", self.machine, self.input.kind, self.input.name);
        format!("{title}\n\n{}\n", table.render(style))
    }

    /// One line per variant, header first.
    pub fn to_csv(&self) -> String {
        let rows = self.variants.iter().map(|v| {
            let numbers = [v.cycles.to_string(), v.dots.to_string(), v.cycles_per_dot.to_string(), v.change_percent.to_string()];
            let [cycles, dots, cycles_per_dot, change_percent] = numbers;
            [v.variant.clone(), cycles, dots, cycles_per_dot, change_percent, v.largest_change.to_string()]
        });
        csv::csv_text(["variant", "cycles", "dots", "cycles_per_dot", "change_percent", "largest_change"], rows)
    }

    /// Indented, with a line feed at the end.
    ///
    /// # Errors
    /// None that is known: all of it is numbers and words.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string_pretty(self).map(|text| text + "\n")
    }
}

impl AblationVariant {
    /// Result of a run, relative to the first one.
    pub fn of(variant: String, report: &Report, first: Option<&Self>, largest_change: u8) -> Self {
        let cycles = report.frame_cycles();
        let dots = work(report).count;
        let before = first.map_or(cycles, |f| f.cycles);
        let ratio = |above: f64, below: u64| if below == 0 { 0.0 } else { round6(above / below as f64) };
        Self {
            variant,
            cycles,
            dots,
            cycles_per_dot: ratio(cycles as f64, dots),
            change_percent: ratio(100.0 * (cycles as f64 - before as f64), before),
            largest_change,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples;

    fn ablation() -> Ablation {
        let (slow, fast) = samples::before_and_after();
        let mut ablation = Ablation::of(&fast);
        ablation.variants.push(AblationVariant::of("as configured".into(), &fast, None, 0));
        ablation.variants.push(AblationVariant::of("without flatness".into(), &slow, ablation.variants.first(), 3));
        ablation
    }

    #[test]
    fn changes_are_against_the_first_variant() {
        let variants = ablation().variants;
        assert_eq!((variants[0].cycles, variants[0].change_percent, variants[0].cycles_per_dot), (400_000, 0.0, 2.0));
        assert_eq!((variants[1].cycles, variants[1].change_percent, variants[1].cycles_per_dot), (1_000_000, 150.0, 5.0));
    }

    #[test]
    fn as_text_csv_and_json() {
        let ablation = ablation();
        let text = ablation.to_text(TextStyle::default());
        assert!(text.contains("without flatness  1,000,000      +150           5               3"), "{text}");
        let csv = ablation.to_csv();
        assert_eq!(csv.lines().nth(2), Some("without flatness,1000000,200000,5,150,3"));
        assert_eq!(serde_json::from_str::<Ablation>(&ablation.to_json().unwrap()).unwrap(), ablation);
    }
}
