//! Waiting for memory: issue rate, and operands of the CPU (11).

use crate::common::machine_runs::{most_arrivals, run};
use crate::common::{config, scene_front, small_demo};
use basrelief_kernel::Engine;
use basrelief_machines::MachineSpec;
use basrelief_machines::shade::ShadeConfig;

#[test]
fn port_issues_one_request_per_cycle() {
    assert_eq!(most_arrivals::<ShadeConfig>("cut-plane", &[], "host_write"), 1);
    let at_once = [("memory.local.issue", "0")];
    assert!(most_arrivals::<ShadeConfig>("cut-plane", &at_once, "host_write") > 1, "points, normals, coefficients");
}

#[test]
fn cpu_waits_for_each_operand() {
    let waits = |cl: &str| {
        let config: ShadeConfig = config(&[("memory.local.cl", cl)]);
        let ran = run(scene_front(&small_demo("cut-plane", 1), config.front()), &config, Engine::Timed);
        let cpu = ran.report.units.iter().find(|unit| unit.name == "microcomputer").expect("a CPU");
        let port = ran.report.memories.iter().flat_map(|m| &m.ports).find(|port| port.client == "cpu").expect("its port");
        (cpu.account.memory.iter().sum::<u64>(), port.counts.reads)
    };
    let ((short, reads), (long, same)) = (waits("1"), waits("51"));
    assert!(reads > 100 && reads == same, "{reads} {same}");
    // A load takes two cycles for each number, and waits for the rest.
    assert!(long >= short + 40 * reads, "{long} {short} {reads}");
}
