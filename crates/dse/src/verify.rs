//! Running points again, to compare.

use crate::one::{PointResult, run_point};
use crate::plan::{Plan, PlanPoint};
use crate::{PointStatus, SweepError, SweepFolder, SweepHost};
use basrelief_threads as threads;

/// Repeats the runs of `percent` of the points with reports and compares bytes. Returns the number of repeated points, and the hashes of
/// points that differ. Hashes select the points, so the sample is the same each time.
///
/// # Errors
/// A report that cannot be read, an input that cannot be opened.
pub fn verify(
    plan: &Plan,
    points: &[&PlanPoint],
    percent: f64,
    folder: &SweepFolder,
    host: &dyn SweepHost,
) -> Result<(usize, Vec<String>), SweepError> {
    let mut there: Vec<&PlanPoint> =
        points.iter().copied().filter(|point| folder.find(&point.id) == PointStatus::Report).collect();
    there.sort_by(|a, b| a.id.cmp(&b.id));
    there.truncate((there.len() as f64 * percent / 100.0).ceil() as usize);
    let count = there.len();
    let compared = threads::par_map(there, |point| {
        let PointResult { report, .. } = run_point(plan, point, false, false, host)?;
        let again = report.ok().and_then(|report| report.to_json().ok());
        let same = again.as_deref() == Some(folder.report_text(&point.id)?.as_str());
        Ok((!same).then(|| point.id.clone()))
    });
    let others = compared.into_iter().collect::<Result<Vec<_>, SweepError>>()?;
    Ok((count, others.into_iter().flatten().collect()))
}
