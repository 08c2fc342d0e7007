//! Frames, one by one.

use super::markup::{Html, details};
use super::svg::{ColumnChart, Ruler, bins, mean};
use super::table::html;
use crate::model::{Cycles, Report};
use crate::number::{decimal, thousands};
use crate::text::table::{Align::Right, Table};
use basrelief_reference::QualityMetrics;

/// Maximum number of columns of the chart, and of rows of the table.
const COLUMNS: usize = 120;
const ROWS: usize = 500;
/// A table with this many rows is collapsed.
const LONG: usize = 24;

pub(super) fn frames(report: &Report) -> Html {
    let Some(cycles) = report.cycles.as_ref().filter(|cycles| !cycles.frames.is_empty()) else { return Html::default() };
    let term = report.picture_term();
    let table = html(if term == "frame" { "Frames" } else { "Pictures" }, &table(report, cycles));
    let table = if cycles.frames.len() > LONG { details(&format!("Every {term}"), table) } else { table };
    [chart(cycles, term), table].into_iter().collect()
}

fn chart(Cycles { frames, .. }: &Cycles, term: &str) -> Html {
    if frames.len() < 2 {
        return Html::default();
    }
    let values: Vec<f64> = frames.iter().map(|&n| n as f64).collect();
    let columns: Vec<(String, f64)> = bins(&values, COLUMNS).map(|(at, n)| ((at + 1).to_string(), mean(n))).collect();
    let most = columns.iter().fold(0.0, |most: f64, (_, n)| most.max(*n));
    let cycles = if columns.len() < values.len() { format!("cycles, mean of several {term}s each") } else { "cycles".into() };
    let (title, axes) = (format!("Cycles per {term}"), [term, cycles.as_str()]);
    let top = (most, thousands(most.round() as u64));
    let ruler = Some(Ruler::numbered(1.0, frames.len(), COLUMNS));
    ColumnChart { title: &title, axes, class: "amount", columns, ruler, top, size: (640.0, 180.0) }.draw()
}

/// Returns the quality of a picture. Of several pictures of a frame, only the last one was compared. `frames`: frame of each picture.
fn quality_of_picture<'a>(report: &'a Report, frames: &[usize], picture: usize) -> Option<&'a QualityMetrics> {
    let quality = report.quality.as_ref()?;
    let (frame, next) = (frames.get(picture)?, frames.get(picture + 1));
    let last = quality.frames.is_empty() && next.is_none();
    quality.frames.get(*frame).or(last.then_some(&quality.last)).filter(|_| next != Some(frame))
}

fn table(report: &Report, cycles: &Cycles) -> Table {
    let titles = [report.picture_term(), "cycles", "ms", "PSNR dB", "SSIM", "FLIP"];
    let mut table = Table::new(&titles.map(|title| (title, Right, 0)));
    let (hz, frames) = (report.clock_hz(), report.frames_of_pictures());
    for (k, &n) in cycles.frames.iter().take(ROWS).enumerate() {
        let quality = quality_of_picture(report, &frames, k);
        let [psnr, ssim, flip] = quality
            .map_or_else(Default::default, |q| [format!("{:.2}", q.psnr_db), format!("{:.4}", q.ssim), format!("{:.4}", q.flip)]);
        let ms = hz.map_or(String::new(), |hz| decimal(1e3 * n as f64 / hz, 3));
        table.row([(k + 1).to_string(), thousands(n), ms, psnr, ssim, flip]);
    }
    if cycles.frames.len() > ROWS {
        table.row([format!("{} more", thousands((cycles.frames.len() - ROWS) as u64))]);
    }
    if report.drain() > 0 {
        let ms = hz.map_or(String::new(), |hz| decimal(1e3 * report.drain() as f64 / hz, 3));
        table.row(["write tail".into(), thousands(report.drain()), ms]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Figure;
    use crate::samples;

    #[test]
    fn quality_of_a_frame_stands_beside_its_last_picture() {
        let mut report = samples::balanced();
        report.cycles.as_mut().unwrap().frames = vec![7; 3];
        report.figures.insert("picture_frame".into(), Figure::List(vec![0.into(), 0.into(), 1.into()]));
        let quality = report.quality.as_mut().unwrap();
        let last = quality.last;
        quality.frames = [1.0, 2.0].map(|psnr_db| QualityMetrics { psnr_db, ..last }).into();
        let told =
            |report: &Report| [0, 1, 2].map(|k| quality_of_picture(report, &report.frames_of_pictures(), k).map(|of| of.psnr_db));
        assert_eq!(told(&report), [None, Some(1.0), Some(2.0)]);
        // Only the final image was compared.
        report.quality.as_mut().unwrap().frames.clear();
        assert_eq!(told(&report), [None, None, Some(last.psnr_db)]);
    }
}
