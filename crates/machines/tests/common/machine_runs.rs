//! Runs of any machine.

use super::{Ran, config, replay};
use basrelief_frame_buffer::FinishedFrame;
use basrelief_kernel::Engine;
use basrelief_machines::{FrontEnd, MachineSpec, UnitStats};
use basrelief_signals::Control;

/// Builds a machine.
pub fn machine<S: MachineSpec, F: FrontEnd>(front: F, config: &S) -> S::Machine<F> {
    config.build(front).unwrap_or_else(|problem| panic!("{problem}"))
}

/// Runs a machine.
pub fn run<S: MachineSpec>(front: impl FrontEnd, config: &S, engine: Engine) -> Ran {
    super::run(machine(front, config), engine)
}

/// Replays commands on the timed engine, and asserts that the run finishes.
pub fn timed<S: MachineSpec>(controls: &[Control], settings: &[(&str, &str)]) -> Ran {
    let config: S = config(settings);
    super::timed(machine(replay(controls, config.front()), &config), settings)
}

/// Returns pictures and figures of the functional model.
pub fn functional<S: MachineSpec>(front: impl FrontEnd, config: &S) -> (Vec<FinishedFrame>, UnitStats) {
    super::functional(machine(front, config))
}

/// Asserts that a machine rejects settings that do not fit together, with this key.
pub fn assert_rejected<S: MachineSpec>(settings: &[(&str, &str)], key: &str) {
    let config: S = config(settings);
    let problem = config.build(replay(&[], config.front())).err().unwrap_or_else(|| panic!("{settings:?} is accepted"));
    assert_eq!(problem.key, key, "{problem}");
}
