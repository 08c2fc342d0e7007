//! `basrelief describe`: block diagram, units and parameters of a machine.

use super::rtl_area::from_rtl;
use crate::args::DescribeArgs;
use crate::error::{CommandError, CommandResult, print, print_styled};
use crate::global::GlobalOptions;
use crate::input::config_of;
use basrelief_parameters::{Effect, Parameter, nearest};
use basrelief_report::TextStyle;
use basrelief_report::model::Hardware;
use basrelief_scene::DEMOS;
use basrelief_sim::{MachineConfig, MachineInfo, UnitInfo};
use std::fmt::Write;

/// Prints the description of a machine.
pub fn describe(args: &DescribeArgs, global: &GlobalOptions) -> CommandResult {
    let machine = args.machine;
    let (config, _) = config_of(machine, args.config.as_deref(), &args.settings, &global.budget)?;
    if args.hardware {
        return hardware(machine.name, &config, args.json, global.text_style());
    }
    if args.json {
        let rows: Vec<_> = config.described().into_iter().filter(|row| is_selected(args, &row.key)).collect();
        return print(&format!("{}\n", serde_json::to_string_pretty(&rows).map_err(CommandError::bad_input)?));
    }
    if args.filter.is_some() {
        return print(&selected(args, &config)?);
    }
    let mut text = format!("{} - {}\n\n{}\nUnits\n", machine.name, machine.about, machine.diagram);
    units(&mut text, &machine.units());
    text.push_str("\nParameters (--set KEY=VALUE, or a file with --config)\n");
    config.parameters().iter().for_each(|p| entry(&mut text, p));
    text.push_str("\nDemo scenes with their machines\n");
    for d in DEMOS {
        let _ = writeln!(text, "  {:<10} {:<6} {}", d.name, MachineInfo::of_demo(d.name).name, d.about);
    }
    print(&text)
}

fn is_selected(args: &DescribeArgs, name: &str) -> bool {
    args.filter.as_ref().is_none_or(|filter| name.contains(filter.as_str()))
}

/// Returns the units and parameters whose names contain the filter.
fn selected(args: &DescribeArgs, config: &MachineConfig) -> CommandResult<String> {
    let (machine, mut text) = (args.machine, String::new());
    let shown: Vec<UnitInfo> = machine.units().into_iter().filter(|unit| is_selected(args, &unit.name)).collect();
    units(&mut text, &shown);
    let all = config.parameters();
    all.iter().filter(|p| is_selected(args, &p.key)).for_each(|p| entry(&mut text, p));
    if text.is_empty() {
        let filter = args.filter.as_deref().unwrap_or_default();
        let near =
            nearest(filter, all.iter().map(|p| p.key.as_str())).map_or(String::new(), |key| format!("; did you mean `{key}`?"));
        return Err(CommandError::Usage(format!("no unit or parameter of `{}` contains `{filter}`{near}", machine.name)));
    }
    Ok(text)
}

/// Lists units with their numerals, roles and code.
fn units(text: &mut String, units: &[UnitInfo]) {
    let width = units.iter().map(|u| u.name.len()).max().unwrap_or(0);
    for u in units {
        let numeral = if u.numeral.is_empty() { String::new() } else { format!("({})", u.numeral) };
        let _ = writeln!(text, "  {:<width$} {numeral:<6} {}", u.name, u.role);
        let _ = writeln!(text, "{:indent$}{}", "", u.code, indent = 2 + width + 1 + 6 + 1);
    }
}

/// Prints the hardware cost of a machine.
fn hardware(machine: &str, config: &MachineConfig, json: bool, style: TextStyle) -> CommandResult {
    let model = config.area_model();
    let pieces = config.hardware().map_err(CommandError::bad_input)?;
    let all: Vec<Hardware> = pieces.iter().map(|piece| Hardware::new(piece, &model)).collect();
    if json {
        return print(&format!("{}\n", serde_json::to_string_pretty(&all).map_err(CommandError::bad_input)?));
    }
    let from_rtl = from_rtl(machine, config, &all).map_err(CommandError::bad_input)?;
    print_styled(&format!("{}\n{from_rtl}", basrelief_report::hardware(&all, model.cycle_fo4(), style)), style)
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
