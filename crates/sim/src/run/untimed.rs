//! Untimed result of a run: everything in its report that does not depend on timing.

use crate::build::BUILD;
use basrelief_kernel::{Outcome, RunReport};
use basrelief_machines::{MachineSpec, PictureRecord, RunSummary, UnitStats, drawn_units};
use basrelief_parameters::to_json;
use basrelief_report::model::{Hardware, Input, Picture, PictureQuality, Size};
use basrelief_report::number::thousands;
use basrelief_report::{NO_AREA, Report, ReportContext, depth_warnings};
use basrelief_signals::Camera;
use serde::{Deserialize, Serialize};
use serde_json::Value;

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
        let config = to_json(spec).unwrap_or_default();
        let of_area = depth_warnings(&hardware, model.cycle_fo4()).into_iter().chain(no_area(&config));
        let absent = run.and_then(|run| absent_units(&config, run));
        let warnings = spec.warnings(&facts).into_iter().chain(of_area).chain(absent).chain(run.and_then(underruns));
        let context = ReportContext {
            build: BUILD.into(),
            machine: S::NAME.into(),
            input: self.input,
            config,
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

/// Warns if the memory serves the display too late.
fn underruns(run: &RunReport) -> Option<String> {
    let ports = run.memories.iter().flat_map(|memory| memory.ports.iter().map(|port| (&memory.name, port)));
    let mut displays = ports.filter_map(|(memory, port)| Some((memory, port.counts.reads, port.periodic?.late)));
    let (memory, reads, late) = displays.find(|(.., late)| *late > 0)?;
    Some(format!(
        "the display makes {} of its {} reads too late (underruns), so its image has gaps; raise display.burst_bytes, or choose a faster \
         memory.{memory}.part",
        thousands(late),
        thousands(reads)
    ))
}

/// Returns the parameters that make parts of a machine ideal, from the parameters of its configuration.
pub fn ideal_parts(config: &Value) -> Vec<String> {
    let memories = config["memory"].as_object().into_iter().flatten().filter(|(_, memory)| memory["part"] == "ideal");
    let units = config["ideal"]["units"].as_str().is_some_and(|units| !units.is_empty());
    memories.map(|(name, _)| format!("memory.{name}.part")).chain(units.then(|| "ideal.units".into())).collect()
}

/// Warns if parts of the machine are ideal, because no hardware is.
fn no_area(config: &Value) -> Option<String> {
    let ideal = ideal_parts(config);
    (!ideal.is_empty()).then(|| format!("{NO_AREA}, because no hardware is ideal: {}", ideal.join(", ")))
}

/// Warns if a unit that shall be ideal belongs to another kind of input.
fn absent_units(config: &Value, run: &RunReport) -> Option<String> {
    let named = config["ideal"]["units"].as_str()?.split(',').map(str::trim).filter(|name| !name.is_empty());
    let absent: Vec<String> =
        named.filter(|name| !run.units.iter().any(|unit| unit.name == *name)).map(|name| format!("`{name}`")).collect();
    (!absent.is_empty()).then(|| {
        let units = absent.join(", ");
        format!("ideal.units names {units}, which this kind of input does not use; scenes use host and geometry, traces use display-list")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn ideal_parts_have_no_area() {
        let config = |part, units| json!({"memory": {"a": {"part": part}, "b": {"part": "sdr-100"}}, "ideal": {"units": units}});
        assert_eq!(no_area(&config("sdr-100", "")), None);
        let warning = |of| Some(format!("the area has no meaning, because no hardware is ideal: {of}"));
        assert_eq!(no_area(&config("ideal", "")), warning("memory.a.part"));
        assert_eq!(no_area(&config("ideal", "x,y")), warning("memory.a.part, ideal.units"));
    }
}
