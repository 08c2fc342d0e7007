//! Resimulations of one run with relaxed resources. Each is made once, by the thread that needs it first.

use super::relaxations::Settings;
use crate::recording::SharedRecording;
use basrelief_kernel::{CriticalPath, Netlist, StageGroups};
use basrelief_threads::lock;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock};

/// Maximum number of steps of a run whose critical path is found. A path keeps about 30 bytes per step and 40 per request.
pub(crate) const MOST_STEPS: usize = 2_800_000;

/// The recorded steps of a run, ready for repeated resimulation, and the results so far.
pub(super) struct Resimulations<'a> {
    recording: SharedRecording<'a>,
    /// Returns the netlist with these settings; `None` if they change the work of the units or do not fit together.
    netlist: &'a (dyn Fn(&Settings) -> Option<Netlist> + Sync),
    cycles: ResultsBySettings<u64>,
    paths: ResultsBySettings<CriticalPath>,
}

impl<'a> Resimulations<'a> {
    pub(super) fn new(recording: SharedRecording<'a>, netlist: &'a (dyn Fn(&Settings) -> Option<Netlist> + Sync)) -> Self {
        let (cycles, paths) = Default::default();
        Self { recording, netlist, cycles, paths }
    }

    /// Returns the render cycles with these settings, if they are known already.
    pub(super) fn known_cycles(&self, set: &Settings) -> Option<u64> {
        self.paths.known(set).map(|path| path.cycles).or_else(|| self.cycles.known(set))
    }

    /// Returns the render cycles with these settings; `None` if the run does not finish.
    pub(super) fn cycles(&self, set: &Settings) -> Option<u64> {
        match self.paths.known(set) {
            Some(path) => Some(path.cycles),
            None => self.cycles.get(set, || self.recording.cycles((self.netlist)(set)?).ok()?),
        }
    }

    /// Returns the critical path with these settings; `None` if the run does not finish or it has too many steps.
    pub(super) fn path(&self, set: &Settings) -> Option<CriticalPath> {
        self.paths.get(set, || self.grouped_path((self.netlist)(set)?, &[]))
    }

    /// As [`Resimulations::path`], on this netlist, with the cycles of groups of steps. The result is not kept.
    pub(super) fn grouped_path(&self, netlist: Netlist, groups: &[StageGroups]) -> Option<CriticalPath> {
        self.recording.critical_path(netlist, MOST_STEPS, groups).ok()?
    }
}

/// Results by settings; `None` for a resimulation without a result.
struct ResultsBySettings<T>(Mutex<BTreeMap<Settings, Arc<OnceLock<Option<T>>>>>);

impl<T> Default for ResultsBySettings<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T: Clone> ResultsBySettings<T> {
    /// Returns the result for these settings. Computes it, or waits while another thread does.
    fn get(&self, set: &Settings, compute: impl FnOnce() -> Option<T>) -> Option<T> {
        let place = Arc::clone(lock(&self.0).entry(set.clone()).or_default());
        place.get_or_init(compute).clone()
    }

    /// Returns the result for these settings, if there is one already.
    fn known(&self, set: &Settings) -> Option<T> {
        lock(&self.0).get(set)?.get()?.clone()
    }
}
