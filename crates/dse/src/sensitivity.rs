//! Sensitivity of a run to assumed parameters: a plan that changes one value at a time. Its store keeps only the measures of each point.

use crate::folder::{PointFailure, PointStore};
use crate::plan::{Axis, Plan, PlanPoint};
use crate::{PointStatus, SweepError, SweepHost, SweepJob, execute};
use basrelief_report::Report;
use basrelief_report::sensitivity::{ComesTo, Measure, ParameterChange, Sensitivity};
use basrelief_sim::ParameterInfo;
use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Figures of points, by their hashes.
#[derive(Default)]
struct PointMeasures(Mutex<BTreeMap<String, Result<Measure, PointFailure>>>);

impl PointMeasures {
    fn all(&self) -> MutexGuard<'_, BTreeMap<String, Result<Measure, PointFailure>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl PointStore for PointMeasures {
    fn find(&self, id: &str) -> PointStatus {
        match self.all().get(id) {
            Some(Ok(_)) => PointStatus::Report,
            Some(Err(_)) => PointStatus::Failed,
            None => PointStatus::Missing,
        }
    }

    fn put(&self, id: &str, report: &Report, _picture: Option<&[u8]>, host: &dyn SweepHost) -> Result<(), SweepError> {
        if host.is_stopped() {
            return Err(SweepError("stopped".into()));
        }
        self.all().insert(id.into(), Ok(report.measure()));
        Ok(())
    }

    fn put_failure(&self, id: &str, failure: &PointFailure, _: &dyn SweepHost) -> Result<(), SweepError> {
        self.all().insert(id.into(), Err(failure.clone()));
        Ok(())
    }
}

/// Runs the points of a plan [around a run](Plan::one_at_a_time) on several threads and returns the effect of each. The result does not depend
/// on the number of threads.
///
/// # Errors
/// An input that can no longer be opened, or a base run that does not finish.
pub fn sensitivity(plan: &Plan, threads: usize, host: &dyn SweepHost) -> Result<Sensitivity, SweepError> {
    let measures = PointMeasures::default();
    let points: Vec<&PlanPoint> = plan.points.iter().collect();
    execute(plan, &SweepJob { points: &points, retry_failed: false, pictures: false, threads }, &measures, host)?;
    let measures = measures.all();
    let measure = |point: &PlanPoint| measures.get(&point.id).cloned();
    let is_base = |point: &&PlanPoint| point.places.iter().all(|place| *place == 0);
    let base = match plan.points.iter().find(is_base).and_then(measure) {
        Some(Ok(base)) => base,
        Some(Err(PointFailure { outcome, message })) => return Err(SweepError(format!("as configured: {outcome}: {message}"))),
        None => return Err(SweepError("as configured: was not run".into())),
    };
    let described = plan.config(&vec![0; plan.axes.len()]).map_err(SweepError)?.described();
    let described: BTreeMap<&str, &ParameterInfo> = described.iter().map(|p| (p.key.as_str(), p)).collect();
    let change = |point: &PlanPoint| {
        let (axis, place) = plan.axes.iter().zip(&point.places).find(|(_, place)| **place > 0)?;
        Some(change(axis, *place, described.get(axis.keys[0].as_str())?, measure(point)?, base))
    };
    let changes = plan.points.iter().filter_map(change).collect();
    let unchanged = plan.axes.iter().filter(|axis| axis.values.len() < 2).map(|axis| axis.keys[0].clone()).collect();
    Ok(Sensitivity::new(base, changes, unchanged))
}

fn change(
    axis: &Axis,
    place: usize,
    of: &ParameterInfo,
    measure: Result<Measure, PointFailure>,
    base: Measure,
) -> ParameterChange {
    ParameterChange {
        parameter: of.key.clone(),
        about: of.about.clone(),
        unit: of.unit.into(),
        from: of.value.clone(),
        to: json_of(&axis.values[place][0]),
        comes_to: match measure {
            Ok(measure) => ComesTo::Run(base.change_to(measure)),
            Err(PointFailure { outcome, message }) => ComesTo::Nothing { reason: format!("{outcome}: {message}") },
        },
    }
}

/// A value of TOML as one of JSON.
fn json_of(text: &str) -> Value {
    let table: Option<toml::Table> = format!("value = {text}").parse().ok();
    table.and_then(|mut table| serde_json::to_value(table.remove("value")?).ok()).unwrap_or_default()
}
