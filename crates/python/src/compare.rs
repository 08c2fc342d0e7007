//! Comparison of two runs.

use crate::error::{CommandError, CommandResult, PythonResult, budget, of_recording};
use crate::page::{WIDTH, pictures, report_of};
use crate::pixels;
use crate::recording::open_recording;
use basrelief_input::MemoryPool;
use basrelief_report::compare::comparisons_text;
use basrelief_report::html::{self, compared as page_of};
use basrelief_report::{Comparison, MeasuredCauses, Report, TextStyle, compare as difference};
use basrelief_sim::{ExplainOptions, RecordedRun, RecordingError, explain, page_assets};
use pyo3::pybacked::PyBackedBytes;
use pyo3::{FromPyObject, Python, pyfunction};

/// One of two compared runs.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct ComparedRun {
    name: String,
    report: String,
    image: Option<pixels::GivenPixels>,
    recording: Option<PyBackedBytes>,
}

/// A compared run with its report.
struct ParsedSide<'a> {
    side: &'a ComparedRun,
    report: Report,
}

impl ComparedRun {
    fn parsed(&self) -> CommandResult<ParsedSide<'_>> {
        Ok(ParsedSide { side: self, report: report_of(&self.report)? })
    }
}

impl ParsedSide<'_> {
    /// Returns `None` for the recording of another build that this build cannot use. Then causes are not measured.
    fn recorded_run(&self) -> CommandResult<Option<RecordedRun>> {
        let Some(recording) = &self.side.recording else { return Ok(None) };
        match RecordedRun::read(&self.report, &mut open_recording(recording)?, &budget(MemoryPool::DEFAULT)) {
            Err(RecordingError::OtherBuild { .. }) => Ok(None),
            read => read.map(Some).map_err(of_recording),
        }
    }

    fn html_side(&self) -> CommandResult<html::ComparedReport<'_>> {
        let assets = page_assets(&self.report).map_err(CommandError::bad_input)?;
        let assets = html::PageAssets { pictures: pictures(self.side.image.as_ref(), None)?, ..assets };
        Ok(html::ComparedReport { name: &self.side.name, report: &self.report, assets })
    }

    fn named_report(&self) -> (&str, &Report) {
        (&self.side.name, &self.report)
    }

    fn compared_with(&self, other: &Self) -> CommandResult<Comparison> {
        let explained = self.recorded_run()?.zip(other.recorded_run()?).and_then(|(a, b)| causes(&a, &b));
        Ok(difference(&self.report, &other.report, explained))
    }
}

/// Explains the difference by resimulation. Several work parameters are one cause, because the input is not here.
fn causes(a: &RecordedRun, b: &RecordedRun) -> Option<MeasuredCauses> {
    explain(a, b, &ExplainOptions { input: None, progress: &|_, _| {}, budget: &budget(MemoryPool::DEFAULT) })
}

/// Compares `a` with `b`. Returns the JSON and the text of the command line.
#[pyfunction]
pub fn compare(py: Python<'_>, a: ComparedRun, b: ComparedRun) -> PythonResult<(String, String)> {
    py.detach(|| {
        let sides = [a.parsed()?, b.parsed()?];
        let comparison = sides[0].compared_with(&sides[1])?;
        let style = TextStyle { width: WIDTH, color: false };
        let [first, second] = sides.each_ref().map(ParsedSide::named_report);
        let text = comparisons_text(first, &[(second, &comparison)], style);
        Ok((serde_json::to_string(&comparison).map_err(CommandError::bad_input)?, text))
    })
}

/// Returns the comparison as an HTML page.
#[pyfunction]
pub fn compared(py: Python<'_>, a: ComparedRun, b: ComparedRun) -> PythonResult<String> {
    py.detach(|| {
        let (a, b) = (a.parsed()?, b.parsed()?);
        let comparison = a.compared_with(&b)?;
        Ok(page_of(&a.html_side()?, &[(b.html_side()?, &comparison)]))
    })
}
