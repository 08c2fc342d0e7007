//! The unit and its step.

use crate::clut::NormalTables;
use crate::state::Rebuild;
use crate::{BrightnessConfig, BrightnessFetchState, BrightnessSource, Clut};
use basrelief_kernel::facts::Facts;
use basrelief_kernel::{Demand, Step, Traffic, Unit};
use basrelief_shading::{LEVELS, TableSet, light_vectors};
use basrelief_signals::{Control, Flow, Indexes, MAX_SAMPLES, MAX_STAMP, Sample, Shaded, Stamp, quantization_memory};
use std::sync::Arc;

/// The cache in front of the CLUTs (122) in memory (120).
const CLUT: u32 = 0;
/// Recalculated entries are written through this client.
const REBUILT: u32 = 1;
/// Bytes of recalculated entries per write (assumed).
const WRITE_BYTES: u32 = 32;

/// Brightness fetch unit (112).
///
/// Control is noted when it comes; the CLUTs are compared with it at the first fragment after it, so that a frame or an
/// object without bump targets costs nothing. If they differ, that fragment waits while the entries of all tables are
/// recalculated, up to 32 bytes per step. Code books end here.
#[derive(Clone, Debug)]
pub struct BrightnessFetch {
    /// Parameters.
    pub config: BrightnessConfig,
    most_samples: u32,
    /// Everything it remembers.
    pub state: BrightnessFetchState,
    /// What the VQ tables (121) hold; follows from their parameters.
    normals: NormalTables,
}

type Out = Step<Option<Flow<Stamp<Shaded>>>>;

impl BrightnessFetch {
    /// A unit for the VQ tables (121) that the replacement unit searches, and stamps of at most `most_samples` samples.
    pub fn new(config: BrightnessConfig, tables: TableSet, most_samples: u32) -> Self {
        let most_samples = most_samples.clamp(1, (MAX_SAMPLES * MAX_STAMP) as u32);
        Self { config, most_samples, state: BrightnessFetchState::default(), normals: NormalTables::new(tables) }
    }

    fn quiet(&self) -> Out {
        Step::after(u64::from(self.config.latency), None)
    }

    fn control(&mut self, control: Control) -> Out {
        let state = &mut self.state;
        match &control {
            Control::Frame(frame) => {
                state.frame = Some(Arc::clone(frame));
                state.lights_changed = true;
            }
            Control::Object(object) => {
                state.wanted.entries = object.entries;
                state.object = Some(Arc::clone(object));
                state.lights_changed = true;
            }
            Control::Polygon(polygon) => state.wanted.lighting = polygon.material.lighting,
            Control::CodeBook(book) => state.wanted.book = Some(Arc::clone(book)),
            Control::FrameEnd | Control::Criterion(_) => {}
        }
        state.check = true;
        let out = (!matches!(control, Control::CodeBook(_))).then_some(Flow::Control(control));
        Step::after(u64::from(self.config.latency), out)
    }

    #[inline(always)]
    fn item(&mut self, indexes: Indexes, traffic: &mut Traffic) -> Out {
        if self.state.check {
            self.state.check = false;
            if self.is_outdated() {
                return self.recalculate(indexes, traffic);
            }
        }
        self.fetch(&indexes, traffic)
    }

    fn is_outdated(&mut self) -> bool {
        let state = &mut self.state;
        if state.lights_changed {
            state.lights_changed = false;
            let centre = state.object.as_ref().map_or([0.0; 3], |o| o.centre);
            state.wanted.lights = state.frame.as_ref().map_or_else(Vec::new, |f| light_vectors(f, centre));
        }
        state.held.as_ref() != Some(&state.wanted)
    }

    /// All entries are calculated at once; what takes time is modelled in the steps that write them.
    fn recalculate(&mut self, indexes: Indexes, traffic: &mut Traffic) -> Out {
        match Clut::calculate(&self.config, &self.state.wanted, &mut self.normals) {
            Ok(clut) => self.state.clut = clut,
            Err(error) => {
                let name = self.state.object.as_ref().map_or("", |o| o.name.as_str());
                traffic.fault(format!("object `{name}` fixes its number of reference normals: {error}"));
                self.state.clut = Clut::default();
            }
        }
        let largest = self.state.clut.entries().into_iter().max().unwrap_or(0);
        let stride = quantization_memory::clut_stride(largest, self.config.entry_bytes());
        self.state.base = std::array::from_fn(|k| quantization_memory::CLUTS + k as u64 * stride);
        self.state.held = Some(self.state.wanted.clone());
        if self.config.source == BrightnessSource::Direct || largest == 0 {
            return self.fetch(&indexes, traffic);
        }
        self.state.counters.rebuilds += 1;
        self.state.pending = Some(indexes);
        self.state.rebuild = Some(Rebuild::default());
        self.rebuild(traffic)
    }

    /// Writes the next entries; after the last ones the next step serves the fragment that waits.
    fn rebuild(&mut self, traffic: &mut Traffic) -> Out {
        let entries = self.state.clut.entries();
        let Some(mut at) = self.state.rebuild.take() else { return self.quiet() };
        while at.level < LEVELS && entries[at.level] == at.written {
            at = Rebuild { level: at.level + 1, written: 0 };
        }
        let Some(left) = entries.get(at.level).map(|n| n - at.written) else { return self.quiet() };
        let entry_bytes = self.config.entry_bytes();
        let count = left.min((WRITE_BYTES / entry_bytes) as usize);
        let address = self.state.base[at.level] + at.written as u64 * u64::from(entry_bytes);
        let bytes = count as u32 * entry_bytes;
        traffic.write(REBUILT, address, bytes);
        at.written += count;
        let done = entries[at.level] == at.written && entries[at.level + 1..].iter().all(|n| *n == 0);
        self.state.rebuild = (!done).then_some(at);
        let cycles = count as u64 * u64::from(self.config.rebuild_cycles_per_entry);
        self.state.counters.rebuild_cycles += cycles;
        self.state.counters.rebuild_bytes += u64::from(bytes);
        self.quiet().busy(cycles)
    }

    #[inline(always)]
    fn fetch(&mut self, indexes: &Indexes, traffic: &mut Traffic) -> Out {
        let state = &mut self.state;
        let entry_bytes = self.config.entry_bytes();
        let from_clut = self.config.source == BrightnessSource::Clut;
        let mut out = Stamp::new();
        for (lane, &fragment) in indexes.stamp.iter().enumerate() {
            let mut sum = [0.0; 2];
            for &Sample { level, weight, value } in &indexes.samples {
                let (weight, index) = (weight[lane], value[lane]);
                let value = state.clut.fetch(level, index);
                sum = [sum[0] + weight * value[0], sum[1] + weight * value[1]];
                if from_clut {
                    let base = state.base[usize::from(level).min(LEVELS - 1)];
                    traffic.look_up(CLUT, base + u64::from(index) * u64::from(entry_bytes), entry_bytes);
                }
            }
            out.push(Shaded { fragment, brightness: sum[0], highlight: sum[1] });
        }
        let per_fragment = indexes.samples.len();
        state.counters.fragments += out.len() as u64;
        state.counters.samples += (out.len() * per_fragment) as u64;
        let computing = if from_clut { 0 } else { per_fragment as u64 * u64::from(self.config.direct_cycles) };
        let latency = u64::from(self.config.latency) + computing;
        Step::over(out.len(), computing.max(1), latency, Some(Flow::Item(out)))
    }
}

impl Unit for BrightnessFetch {
    basrelief_kernel::role!("looks brightness up by index, interpolates between levels");
    type In = Option<Flow<Indexes>>;
    type Out = Option<Flow<Stamp<Shaded>>>;

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.pending.is_some() { Demand::Nothing } else { Demand::All }
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, traffic: &mut Traffic) -> Step<Self::Out> {
        match input {
            Some(Flow::Item(indexes)) => self.item(indexes, traffic),
            Some(Flow::Control(control)) => self.control(control),
            None if self.state.rebuild.is_some() => self.rebuild(traffic),
            None => match self.state.pending.take() {
                Some(indexes) => self.fetch(&indexes, traffic),
                None => self.quiet(),
            },
        }
    }

    fn largest_step(&self, client: usize) -> u32 {
        match (self.config.source, client) {
            (BrightnessSource::Clut, 0) => self.most_samples,
            (BrightnessSource::Clut, 1) => 1,
            _ => 0,
        }
    }

    fn is_empty(&self) -> bool {
        self.state.pending.is_none()
    }

    fn tell(&self, facts: &mut Facts) {
        facts.rate(0, self.config.latency, 1_u64);
        let c = &self.state.counters;
        facts.figure("clut_samples", c.samples, "samples", "Samples looked up in CLUTs");
        facts.figure("clut_rebuilds", c.rebuilds, "rebuilds", "Times that CLUTs were calculated anew");
        facts.figure("clut_rebuild_cycles", c.rebuild_cycles, "cycles", "Cycles that this took");
        facts.figure("clut_rebuild_bytes", c.rebuild_bytes, "bytes", "What it wrote");
    }
}

#[cfg(test)]
mod tests;
