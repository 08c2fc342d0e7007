//! Warnings of a plan's figures.

use super::definition::{Plan, PlanInput, PlanPoint};
use basrelief_sim::ideal_parts;
use std::collections::BTreeSet;

/// Figures of the last image, each with that of the worst image.
const OF_LAST_IMAGE: [(&str, &str); 3] =
    [("quality.psnr_db", "quality.min.psnr_db"), ("quality.ssim", "quality.min.ssim"), ("quality.flip", "quality.max.flip")];

/// Begin of the names of figures that follow from the area model.
const OF_HARDWARE: &str = "hardware.";

impl Plan {
    /// Returns warnings of figures that a reader of the plan may take for others: those of the last image, although there are several,
    /// and those of the area of ideal hardware.
    pub fn warnings(&self) -> Vec<String> {
        self.last_image_warnings().into_iter().chain(self.area_warnings()).collect()
    }

    /// Returns the names of the figures of objectives and constraints, each with its list.
    fn named_figures(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let objectives = self.objectives.iter().map(|objective| ("objectives", objective.column.as_str()));
        objectives.chain(self.constraints.iter().map(|constraint| ("constraints", constraint.column.as_str())))
    }

    fn last_image_warnings(&self) -> Vec<String> {
        if self.inputs.iter().all(|input| PlanInput::frames(input) <= 1) {
            return vec![];
        }
        let warn = |(list, column): (&str, &str)| {
            let (_, worst) = OF_LAST_IMAGE.iter().find(|(last, _)| *last == column)?;
            Some(format!("{list}: `{column}` is that of the last image; `{worst}` is that of the worst image"))
        };
        self.named_figures().filter_map(warn).collect()
    }

    /// Warns of the area of points with ideal parts, which may dominate points that can be built.
    fn area_warnings(&self) -> Vec<String> {
        let named: Vec<_> = self.named_figures().filter(|(_, column)| column.starts_with(OF_HARDWARE)).collect();
        if named.is_empty() {
            return vec![];
        }
        let parts = |point: &PlanPoint| self.config(&point.places).map_or(vec![], |config| ideal_parts(&config.to_value()));
        let ideal: Vec<_> = self.points.iter().map(parts).filter(|parts| !parts.is_empty()).collect();
        if ideal.is_empty() {
            return vec![];
        }
        let (count, of) = (ideal.len(), self.points.len());
        let keys = ideal.into_iter().flatten().collect::<BTreeSet<_>>().into_iter().collect::<Vec<_>>().join(", ");
        let warn = |(list, column)| {
            format!("{list}: `{column}` has no meaning for {count} of {of} points, because no hardware is ideal: {keys}")
        };
        named.into_iter().map(warn).collect()
    }
}
