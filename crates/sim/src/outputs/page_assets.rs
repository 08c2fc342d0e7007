//! Content of an HTML page other than the report.

use super::png::to_png;
use basrelief_machines::MachineInfo;
use basrelief_parameters::{Parameter, as_option, value_of};
use basrelief_reference::{RgbPicture, metrics};
use basrelief_report::Report;
use basrelief_report::html::{PageAssets, PagePicture, ParameterRow};
use serde_json::Value;

/// Returns the block diagram of the report's machine, and its parameters with their values in this run. Contains no pictures.
///
/// # Errors
/// An unknown machine.
pub fn page_assets(report: &Report) -> Result<PageAssets, String> {
    let machine = MachineInfo::named(&report.machine)?;
    let parameters = machine.parameters().iter().map(|parameter| row(parameter, &report.config)).collect();
    Ok(PageAssets { diagram: machine.diagram.into(), pictures: vec![], parameters })
}

/// Returns the pictures of a page: the machine's image and, if given, the reference image and the difference.
///
/// # Errors
/// Pictures of different sizes, and pictures that cannot be encoded.
pub fn page_pictures(machine: &RgbPicture, exact: Option<&RgbPicture>) -> Result<Vec<PagePicture>, String> {
    let made = |caption: &str, picture: &RgbPicture, largest| -> Result<PagePicture, String> {
        Ok(PagePicture { caption: caption.into(), png: to_png(picture)?, largest })
    };
    let mut list = vec![made("The machine's image", machine, None)?];
    if let Some(exact) = exact {
        let (difference, largest) = metrics::scaled_difference(exact, machine).map_err(|e| e.to_string())?;
        list.push(made("The reference image", exact, None)?);
        list.push(made("The difference", &difference, Some(largest))?);
    }
    Ok(list)
}

fn row(parameter: &Parameter, config: &Value) -> ParameterRow {
    let value = value_of(config, &parameter.key).unwrap_or(&parameter.default);
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
