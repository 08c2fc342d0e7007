//! Runs of any machine.

use super::{Ran, config, replay};
use basrelief_frame_buffer::FinishedFrame;
use basrelief_kernel::{Engine, Machine, Outcome};
use basrelief_machines::{FrontEnd, MachineEngines as _, MachineSpec, UnitStats};
use basrelief_signals::Control;

/// Builds a machine.
pub fn machine<S: MachineSpec>(front: FrontEnd, config: &S) -> S::Machine {
    config.build(front).unwrap_or_else(|problem| panic!("{problem}"))
}

/// Returns the largest number of requests of a client that arrive in one cycle, while a demo is drawn with these settings.
pub fn most_arrivals<S: MachineSpec>(demo: &str, settings: &[(&str, &str)], client: &str) -> usize {
    let config: S = config(settings);
    let mut machine = machine(super::scene_front(&super::small_demo(demo, 1), config.front()), &config);
    let number = machine.memories().client_names().position(|name| name == client).expect("such a client");
    machine.memories().keep_requests();
    assert_eq!(machine.run(Engine::Timed).outcome, Outcome::Complete);
    let mut arrivals = std::collections::BTreeMap::new();
    let requests = machine.memories().take_requests().flat_map(|(_, requests)| requests).filter(|r| r.client == number);
    requests.for_each(|request| *arrivals.entry(request.arrival).or_insert(0) += 1);
    arrivals.into_values().max().unwrap_or(0)
}

/// Runs a machine.
pub fn run<S: MachineSpec>(front: FrontEnd, config: &S, engine: Engine) -> Ran {
    super::run(machine(front, config), engine)
}

/// Replays commands on the timed engine, and asserts that the run finishes.
pub fn timed<S: MachineSpec>(controls: &[Control], settings: &[(&str, &str)]) -> Ran {
    let config: S = config(settings);
    super::timed(machine(replay(controls, config.front()), &config), settings)
}

/// Returns pictures and figures of the functional model.
pub fn functional<S: MachineSpec>(front: FrontEnd, config: &S) -> (Vec<FinishedFrame>, UnitStats) {
    super::functional(machine(front, config))
}

/// Asserts that a machine rejects settings that do not fit together, with this key.
pub fn assert_rejected<S: MachineSpec>(settings: &[(&str, &str)], key: &str) {
    let config: S = config(settings);
    let problem = config.build(replay(&[], config.front())).err().unwrap_or_else(|| panic!("{settings:?} is accepted"));
    assert_eq!(problem.key, key, "{problem}");
}
