//! Area from RTL beside the estimate: SystemVerilog twins of units that `rtl/area` synthesized with yosys.

use basrelief_report::model::Hardware;
use basrelief_sim::MachineConfig;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Results of `rtl/area`.
const RESULTS: &str = include_str!("rtl_area.json");

#[derive(Deserialize)]
struct RtlArea {
    datapaths: Vec<Datapath>,
    twins: BTreeMap<String, Twin>,
}

/// Part of a twin that the estimate counts as well, in one configuration.
#[derive(Deserialize)]
struct Datapath {
    machine: String,
    place: String,
    /// Descriptions of the pieces of hardware.
    about: Vec<String>,
    settings: BTreeMap<String, serde_json::Value>,
    /// Number of equal modules in the device.
    instances: u64,
    gate_equivalents: u64,
    levels: u64,
    /// Reason for a difference of more than 15 %.
    differs: Option<String>,
}

/// Whole twin, with its control and its queue of tokens in flight.
#[derive(Deserialize)]
struct Twin {
    machine: String,
    place: String,
    /// Flip-flops without those of the parts.
    #[cfg_attr(not(test), expect(dead_code, reason = "a test compares them with the estimate"))]
    registers: u64,
    /// True if values pass through: floating-point operators are missing.
    timing: bool,
    flip_flops: u64,
    gate_equivalents: u64,
    levels: u64,
}

impl Datapath {
    fn rtl_ge(&self) -> u64 {
        self.instances * self.gate_equivalents
    }

    /// Returns the estimate \[GE\]. Registers of a pipeline are left out, because they depend on the place of the cuts.
    fn estimate_ge(&self, all: &[Hardware]) -> u64 {
        let pieces = all.iter().filter(|piece| piece.place == self.place && self.about.contains(&piece.about));
        pieces.map(|piece| if piece.kind.computes() { piece.area.logic_ge } else { piece.area.area_ge }).sum()
    }

    /// Returns the difference of the estimate from RTL \[%\].
    fn percent_off(&self, all: &[Hardware]) -> f64 {
        100.0 * (self.estimate_ge(all) as f64 / self.rtl_ge() as f64 - 1.0)
    }

    /// Returns true if the parameters have the synthesized values.
    fn applies_to(&self, config: &MachineConfig) -> bool {
        let parameters = config.parameters();
        self.settings.iter().all(|(key, value)| parameters.iter().any(|p| p.key == *key && p.default == *value))
    }
}

/// Returns the areas from RTL that apply to a machine with these parameters.
///
/// # Errors
/// The results of `rtl/area` are malformed.
pub fn from_rtl(machine: &str, config: &MachineConfig, all: &[Hardware]) -> serde_json::Result<String> {
    let results: RtlArea = serde_json::from_str(RESULTS)?;
    let mut text = String::new();
    let datapaths = results.datapaths.iter().filter(|datapath| datapath.machine == machine && datapath.applies_to(config));
    for datapath in datapaths {
        let (place, rtl, estimate) = (&datapath.place, datapath.rtl_ge(), datapath.estimate_ge(all));
        let reason = datapath.differs.as_ref().map_or_else(String::new, |reason| format!("; {reason}"));
        let about = datapath.about.join(", ");
        let (off, levels) = (datapath.percent_off(all), datapath.levels);
        let _ = writeln!(text, "  {place:<20} {rtl:>8} {estimate:>8} {off:>+5.0} % {levels:>6}  {about}{reason}");
    }
    for twin in results.twins.values().filter(|twin| twin.machine == machine) {
        let Twin { place, gate_equivalents, flip_flops, levels, .. } = twin;
        let kind = if twin.timing { "timing twin" } else { "whole twin" };
        let _ = writeln!(
            text,
            "  {place:<20} {gate_equivalents:>8} {:>8} {:>7} {levels:>6}  {kind}, {flip_flops} flip-flops",
            "", ""
        );
    }
    if text.is_empty() {
        return Ok(text);
    }
    Ok(format!(
        "\nFrom RTL (yosys, generic cells; levels of gates in the longest path)\n\n  {:<20} {:>8} {:>8} {:>7} {:>6}\n{text}",
        "Where", "RTL GE", "estimate", "off", "levels"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::config_of;
    use basrelief_input::MemoryPool;
    use basrelief_sim::MachineInfo;

    fn results() -> RtlArea {
        serde_json::from_str(RESULTS).unwrap()
    }

    fn estimated(machine: &str, settings: &BTreeMap<String, serde_json::Value>) -> (MachineConfig, Vec<Hardware>) {
        let settings: Vec<_> = settings.iter().map(|(key, value)| (key.clone(), value.to_string())).collect();
        let machine = MachineInfo::named(machine).unwrap();
        let (config, _) = config_of(machine, None, &settings, &MemoryPool::default()).unwrap();
        let (pieces, model) = (config.hardware().unwrap(), config.area_model());
        let all = pieces.iter().map(|piece| Hardware::new(piece, &model)).collect();
        (config, all)
    }

    /// A datapath with a reason must be off in one of its configurations.
    #[test]
    fn estimates_are_within_15_percent_of_rtl() {
        let (mut within, mut off) = (BTreeMap::new(), BTreeMap::new());
        for datapath in &results().datapaths {
            let (config, all) = estimated(&datapath.machine, &datapath.settings);
            assert!(datapath.applies_to(&config), "{} {:?}", datapath.place, datapath.settings);
            let percent = datapath.percent_off(&all);
            if datapath.differs.is_some() {
                *off.entry(datapath.place.clone()).or_insert(false) |= percent.abs() > 15.0;
            } else {
                assert!(percent.abs() <= 15.0, "{} {:?}: {percent} %", datapath.place, datapath.settings);
                *within.entry(datapath.place.clone()).or_insert(0) += 1;
            }
        }
        for place in ["figures", "replacement", "brightness", "depth-test", "adder", "selector-28"] {
            assert_eq!(within.get(place), Some(&3), "{place}");
        }
        assert!(off.values().all(|is_off| *is_off), "no reason is needed: {off:?}");
    }

    #[test]
    fn estimated_registers_are_those_of_rtl() {
        for place in ["gate", "selector-53", "selector-28", "registers"] {
            let (_, all) = estimated("shade", &BTreeMap::new());
            let registers = all.iter().filter(|p| p.place == place && p.kind == basrelief_kernel::HardwareKind::Registers);
            let results = results();
            let twin = results.twins.values().find(|twin| twin.place == place).unwrap();
            assert_eq!(registers.map(|piece| piece.area.register_bits).sum::<u64>(), twin.registers, "{place}");
        }
    }

    #[test]
    fn only_synthesized_configurations_are_shown() {
        let lanes = |lanes: u32| BTreeMap::from([("replacement.lanes".to_owned(), lanes.into())]);
        for (settings, shown) in [(lanes(64), true), (lanes(4), true), (lanes(32), false)] {
            let (config, all) = estimated("bump", &settings);
            let text = from_rtl("bump", &config, &all).unwrap();
            assert_eq!(text.contains("search, largest inner product"), shown, "{text}");
        }
    }
}
