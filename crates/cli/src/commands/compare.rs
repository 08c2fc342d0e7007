//! `basrelief compare`: what changed between two reports.

use super::simulate::style;
use crate::args::CompareArgs;
use crate::error::{Done, Failure, print};
use crate::input::read_text;
use basrelief_input::{Budget, json_weight};
use basrelief_report::{Report, compare as difference};
use std::path::Path;

/// Lists changes, largest first; fails over a limit.
pub fn compare(args: &CompareArgs, budget: &Budget) -> Done {
    let comparison = difference(&read(&args.a, budget)?, &read(&args.b, budget)?);
    if args.json {
        print(&format!("{:#}\n", serde_json::to_value(&comparison).map_err(Failure::bad)?))?;
    } else {
        print(&comparison.to_text(style()))?;
    }
    let worst = comparison.worst_percent();
    match args.fail_over {
        Some(limit) if worst > limit => Err(Failure::Bad(format!("grew worse by {worst} %, allowed {limit} %"))),
        _ => Ok(()),
    }
}

fn read(path: &Path, budget: &Budget) -> Done<Report> {
    let file = if path.is_dir() { path.join("report.json") } else { path.to_path_buf() };
    let (text, _held) = read_text(&file, budget)?;
    let name = file.display().to_string();
    // It is there to the end of the program.
    budget.take(json_weight(text.as_bytes()), "what a report says").map_err(Failure::within(&name))?.keep();
    Report::from_json(&text).map_err(Failure::within(&name))
}
