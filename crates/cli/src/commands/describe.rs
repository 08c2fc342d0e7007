//! `basrelief describe`: block diagram, units and parameters of a machine.

use super::reporting::style;
use crate::args::DescribeArgs;
use crate::error::{CommandError, CommandResult, print};
use crate::input::config_of;
use basrelief_input::MemoryPool;
use basrelief_parameters::{Effect, Parameter};
use basrelief_report::model::Hardware;
use basrelief_scene::DEMOS;
use basrelief_sim::{MachineConfig, MachineInfo};
use std::fmt::Write;

/// Prints the description of a machine.
pub fn describe(args: &DescribeArgs, budget: &MemoryPool) -> CommandResult {
    let machine = args.machine;
    let (config, _) = config_of(machine, args.config.as_deref(), &args.settings, budget)?;
    if args.hardware {
        return hardware(&config, args.json);
    }
    let table = config.parameters();
    if args.json {
        return print(&format!("{}\n", serde_json::to_string_pretty(&config.described()).map_err(CommandError::bad_input)?));
    }
    let mut text = format!("{} - {}\n\n{}\nUnits\n", machine.name, machine.about, machine.diagram);
    let units = machine.units();
    let width = units.iter().map(|u| u.name.len()).max().unwrap_or(0);
    for u in units {
        let numeral = if u.numeral.is_empty() { String::new() } else { format!("({})", u.numeral) };
        let _ = writeln!(text, "  {:<width$} {numeral:<6} {}", u.name, u.role);
        let _ = writeln!(text, "{:indent$}{}", "", u.code, indent = 2 + width + 1 + 6 + 1);
    }
    text.push_str("\nParameters (--set KEY=VALUE, or a TOML file with --config)\n");
    table.iter().for_each(|p| entry(&mut text, p));
    text.push_str("\nDemo scenes with their machines\n");
    for d in DEMOS {
        let _ = writeln!(text, "  {:<10} {:<6} {}", d.name, MachineInfo::of_demo(d.name).name, d.about);
    }
    print(&text)
}

/// Prints the hardware cost of a machine.
fn hardware(config: &MachineConfig, json: bool) -> CommandResult {
    let model = config.area_model();
    let pieces = config.hardware().map_err(CommandError::bad_input)?;
    let all: Vec<Hardware> = pieces.iter().map(|piece| Hardware::new(piece, &model)).collect();
    if json {
        return print(&format!("{}\n", serde_json::to_string_pretty(&all).map_err(CommandError::bad_input)?));
    }
    print(&format!("{}\n", basrelief_report::hardware(&all, model.cycle_fo4(), style())))
}

fn entry(text: &mut String, p: &Parameter) {
    let value = p.as_option();
    let unit = if p.unit.is_empty() { String::new() } else { format!(" {}", p.unit) };
    let range = if p.range.is_empty() { String::new() } else { format!("   [{}]", p.range) };
    let _ = writeln!(text, "\n  {} = {value}{unit}{range}", p.key);
    let _ = writeln!(text, "      {}\n      {}: {}", p.doc, p.provenance.kind(), p.provenance.text());
    if p.effect != Effect::Work {
        let _ = writeln!(text, "      {} parameter", p.effect.name());
    }
}
