//! Description of a machine for docs/reference/machines.md: block diagram, and units with their functions and source files.

use crate::support::{Inputs, Table};
use basrelief_sim::MachineInfo;
use std::error::Error;

/// Returns block diagram and units of a machine.
///
/// # Errors
/// An unknown machine.
pub fn machine(_: &Inputs, of: &[&str]) -> Result<String, Box<dyn Error>> {
    let machine = MachineInfo::named(of.first().ok_or("expected the name of a machine")?)?;
    let mut table = Table::new(&["unit", "function", "code"], 3);
    for unit in machine.units() {
        let numeral = if unit.numeral.is_empty() { String::new() } else { format!(" ({})", unit.numeral) };
        let label = unit.code.trim_start_matches("crates/units/");
        table.row(&[format!("`{}`{numeral}", unit.name), unit.role.into(), format!("[{label}](../../{})", unit.code)]);
    }
    Ok(format!("```\n{}\n```\n\n{}", machine.diagram.trim_end(), table.text()))
}

#[test]
fn machine_page_matches_the_machines() {
    let page = include_str!("../../../../docs/reference/machines.md");
    let shown = basrelief_sim::MACHINES.iter().filter(|m| page.contains(&format!("<!-- described: machine {} -->", m.name)));
    assert_eq!(shown.count(), basrelief_sim::MACHINES.len());
    let make = |command: &str| crate::make(&Inputs::default(), command).map(Some);
    let again = "run `cargo run -p basrelief-sim --example tables -- docs/reference/machines.md`";
    assert!(crate::document::replaced(page, make).unwrap() == page, "docs/reference/machines.md shows another machine: {again}");
}
