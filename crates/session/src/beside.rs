//! What a page shows of a machine beside a report.

use crate::machines::MachineInfo;
use basrelief_parameters::{Parameter, as_option};
use basrelief_report::Report;
use basrelief_report::html::{Beside, ParameterRow};
use serde_json::Value;

/// The drawing of the report's machine, and its parameters with their values in this run; no pictures.
///
/// # Errors
/// A machine that there is not.
pub fn beside(report: &Report) -> Result<Beside, String> {
    let machine = MachineInfo::named(&report.machine)?;
    let parameters = machine.parameters().iter().map(|parameter| row(parameter, &report.config)).collect();
    Ok(Beside { diagram: machine.diagram.into(), pictures: vec![], parameters })
}

fn row(parameter: &Parameter, config: &Value) -> ParameterRow {
    let value = config.pointer(&format!("/{}", parameter.key.replace('.', "/"))).unwrap_or(&parameter.default);
    ParameterRow {
        key: parameter.key.clone(),
        value: as_option(value),
        default: parameter.as_option(),
        unit: parameter.unit.into(),
        about: parameter.doc.clone(),
        provenance: parameter.provenance.kind().into(),
        source: parameter.provenance.text().into(),
    }
}
