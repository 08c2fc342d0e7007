//! Waiting for memory: tables that are loaded and read back.

use crate::common::machine_runs::run;
use crate::common::{config, scene_front, small_demo};
use basrelief_kernel::Engine;
use basrelief_machines::MachineSpec;
use basrelief_machines::bump::BumpProcessorConfig;

/// Cycles in which a unit waits for memory (120), with this CL, and the loads of VQ tables.
fn waits(unit: &str, cl: &str) -> (u64, u64) {
    let config: BumpProcessorConfig = config(&[("memory.quantization.cl", cl), ("replacement.resident_tables", "1")]);
    let ran = run(scene_front(&small_demo("golf-ball", 1), config.front()), &config, Engine::Timed);
    let account = &ran.report.units.iter().find(|own| own.name == unit).expect("such a unit").account;
    (account.memory.iter().sum(), ran.count("vq_table_loads"))
}

#[test]
fn search_waits_for_its_table() {
    let ((short, loads), (long, _)) = (waits("replacement", "1"), waits("replacement", "101"));
    // A fragment waits once for the tables of two levels.
    assert!(loads > 20 && long >= short + 40 * loads, "{long} {short} {loads}");
}

#[test]
fn calculation_of_entries_waits_for_reference_normals() {
    let (short, long) = (waits("brightness", "1").0, waits("brightness", "101").0);
    // Two levels or more. Only their first reads wait; the others overlap with the calculation of entries.
    assert!(long >= short + 90 * 2, "{long} {short}");
}
