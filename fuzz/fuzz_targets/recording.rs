//! Recordings: the resimulation of any input ends with a report or an error.

#![no_main]

use basrelief_input::MemoryPool;
use basrelief_sim::{ResimulateOptions, resimulate};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let options = ResimulateOptions { budget: MemoryPool::new(64 << 20), ..ResimulateOptions::default() };
    if let Ok(report) = resimulate(&mut &bytes[..], &options) {
        assert!(report.cycles.is_some());
    }
});
