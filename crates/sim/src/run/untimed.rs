//! Untimed result of a run: everything in its report that does not depend on timing.

use crate::build::BUILD;
use basrelief_kernel::{Outcome, RunReport};
use basrelief_machines::{MachineSpec, PictureRecord, RunSummary, UnitStats, drawn_units};
use basrelief_parameters::to_json;
use basrelief_report::model::{Hardware, Input, Picture, PictureQuality, Size};
use basrelief_report::{Report, ReportContext, depth_warnings};
use basrelief_signals::Camera;
use serde::{Deserialize, Serialize};

/// Untimed result of a run.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct UntimedResult {
    pub(crate) input: Input,
    pub(crate) camera: Camera,
    pub(crate) size: Size,
    pub(crate) quality: Option<PictureQuality>,
    pub(crate) image: Vec<Picture>,
    /// Warnings about the input.
    pub(crate) warnings: Vec<String>,
    pub(crate) shown: Vec<PictureRecord>,
}

impl UntimedResult {
    /// Returns the report of the run. `run` is `None` for the functional model.
    pub(crate) fn report<S: MachineSpec>(self, spec: &S, mut facts: UnitStats, run: Option<&RunReport>) -> Report {
        spec.figures(&RunSummary { run, pictures: &self.shown }, &mut facts);
        let model = spec.area_model();
        let drawn = drawn_units(S::DIAGRAM).into_iter();
        let hardware: Vec<Hardware> = facts.all_hardware().iter().map(|piece| Hardware::new(piece, &model)).collect();
        let warnings = spec.warnings(&facts).into_iter().chain(depth_warnings(&hardware, model.cycle_fo4()));
        let context = ReportContext {
            build: BUILD.into(),
            machine: S::NAME.into(),
            input: self.input,
            config: to_json(spec).unwrap_or_default(),
            camera: self.camera,
            size: self.size,
            numerals: drawn.filter_map(|(name, numeral)| Some((name.to_owned(), numeral.parse().ok()?))).collect(),
            figures: facts.figures().map(|f| (f.name.clone(), (&f.value).into())).collect(),
            hardware,
            legend: facts.figures().map(|f| (f.name.clone(), f.into())).collect(),
            quality: self.quality,
            image: self.image,
            warnings: self.warnings.into_iter().chain(warnings).collect(),
        };
        match run {
            Some(run) => Report::timed(context, run),
            None => Report::functional(context, &Outcome::Complete),
        }
    }
}
