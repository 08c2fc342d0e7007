//! `basrelief compare`: what changed between two reports.

use super::simulate::style;
use crate::args::CompareArgs;
use crate::error::{Done, Failure, print};
use crate::input::read_text;
use basrelief_report::{Report, compare as difference};
use std::path::Path;

/// Lists changes, largest first; fails over a limit.
pub fn compare(args: &CompareArgs) -> Done {
    let comparison = difference(&read(&args.a)?, &read(&args.b)?);
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

fn read(path: &Path) -> Done<Report> {
    let file = if path.is_dir() { path.join("report.json") } else { path.to_path_buf() };
    Report::from_json(&read_text(&file)?).map_err(Failure::within(&file.display().to_string()))
}
