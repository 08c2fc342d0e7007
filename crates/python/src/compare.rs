//! Comparison of two runs.

use crate::error::{Done, Exported, Failure, budget, of_tape};
use crate::page::{WIDTH, pictures, report_of};
use crate::pixels;
use crate::recording::opened;
use basrelief_input::Budget;
use basrelief_report::html::{self, compared as page_of};
use basrelief_report::{Comparison, Report, Style, compare as difference};
use basrelief_sim::{RecordedRun, explain, page_assets};
use pyo3::pybacked::PyBackedBytes;
use pyo3::{FromPyObject, Python, pyfunction};

/// One of two compared runs.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Side {
    name: String,
    report: String,
    image: Option<pixels::Given>,
    recording: Option<PyBackedBytes>,
}

impl Side {
    fn taped(&self, report: &Report) -> Done<Option<RecordedRun>> {
        let read =
            |tape: &PyBackedBytes| RecordedRun::read(report, &mut opened(tape)?, &budget(Budget::DEFAULT)).map_err(of_tape);
        self.recording.as_ref().map(read).transpose()
    }

    fn shown<'a>(&'a self, report: &'a Report) -> Done<html::Side<'a>> {
        let beside =
            html::Beside { pictures: pictures(self.image.as_ref(), None)?, ..page_assets(report).map_err(Failure::bad)? };
        Ok(html::Side { name: &self.name, report, beside })
    }
}

/// Compares `a` with `b`. Returns the JSON and the text of the command line.
#[pyfunction]
pub fn compare(py: Python<'_>, a: Side, b: Side) -> Exported<(String, String)> {
    py.detach(|| {
        let comparison = compared_reports((&a, &report_of(&a.report)?), (&b, &report_of(&b.report)?))?;
        let text = comparison.to_text(Style { width: WIDTH, color: false });
        Ok((serde_json::to_string(&comparison).map_err(Failure::bad)?, text))
    })
}

/// Returns the comparison as an HTML page.
#[pyfunction]
pub fn compared(py: Python<'_>, a: Side, b: Side) -> Exported<String> {
    py.detach(|| {
        let (of_a, of_b) = (report_of(&a.report)?, report_of(&b.report)?);
        let comparison = compared_reports((&a, &of_a), (&b, &of_b))?;
        Ok(page_of(&a.shown(&of_a)?, &[(b.shown(&of_b)?, &comparison)]))
    })
}

fn compared_reports((a, of_a): (&Side, &Report), (b, of_b): (&Side, &Report)) -> Done<Comparison> {
    let explained = a.taped(of_a)?.zip(b.taped(of_b)?).and_then(|(a, b)| explain(&a, &b));
    Ok(difference(of_a, of_b, explained))
}
