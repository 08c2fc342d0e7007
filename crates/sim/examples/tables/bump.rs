//! Tables of the quantized bump-mapping processor: picture, cycles and bytes by table size and levels.

use crate::support::{Inputs, Set, Table, bytes, cycles, grouped, report, settings};
use std::error::Error;

const ENTRIES: [&str; 4] = ["16", "64", "256", "1024"];

/// Variants: number of levels, and whether their tables differ.
const LEVELS: [(&str, &str, &str); 4] =
    [("1", "1", "different"), ("2", "2", "different"), ("2, identical tables", "2", "identical"), ("3", "3", "different")];

/// Table by table size.
pub fn entries(inputs: &Inputs, of: &[&str]) -> Result<String, Box<dyn Error>> {
    let head =
        ["reference normals per level", "PSNR dB", "SSIM", "FLIP", "cycles", "bytes, all memories", "of these, tables and CLUTs"];
    let mut table = Table::new(&head, 0);
    for name in of {
        let scene = inputs.open(name, 1)?;
        for entries in ENTRIES {
            let report = report(&scene, &settings("bump", &[("replacement.entries", entries)], true)?)?;
            let q = report.quality.as_ref().ok_or("no reference image")?.last;
            let [all, tables] = [bytes(&report, |_, _| true), bytes(&report, |memory, _| memory == "quantization")].map(grouped);
            let quality = [format!("{:.2}", q.psnr_db), format!("{:.3}", q.ssim), format!("{:.3}", q.flip)];
            table.row(&[&[entries.to_owned()], &quality[..], &[grouped(cycles(&report)), all, tables]].concat());
        }
    }
    Ok(table.text())
}

/// Table by table size and levels, for each input.
pub fn quality(inputs: &Inputs, of: &[&str]) -> Result<String, Box<dyn Error>> {
    let mut text = String::new();
    for name in of {
        let scene = inputs.open(name, 1)?;
        let mut table = Table::new(&["entries", "levels", "PSNR dB", "SSIM", "FLIP", "cycles", "bytes"], 2);
        for entries in ENTRIES {
            for (label, levels, tables) in LEVELS {
                // The unit holds a table per level. Otherwise, every fragment would reload the tables.
                let held = if levels == "3" { "3" } else { "2" };
                let set: Set<'_> = &[
                    ("replacement.entries", entries),
                    ("brightness.levels", levels),
                    ("replacement.tables", tables),
                    ("replacement.resident_tables", held),
                ];
                let report = report(&scene, &settings("bump", set, true)?)?;
                let q = report.quality.as_ref().ok_or("no reference image")?.last;
                let quality = [format!("{:.2}", q.psnr_db), format!("{:.4}", q.ssim), format!("{:.4}", q.flip)];
                let cost = [grouped(cycles(&report)), grouped(bytes(&report, |_, _| true))];
                table.row(&[&[entries.to_owned(), label.to_owned()], &quality[..], &cost].concat());
            }
        }
        text.push_str(&format!("### {name}\n\n{}\n", table.text()));
    }
    Ok(text)
}
