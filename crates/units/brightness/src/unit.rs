//! The unit and its step.

use crate::clut::{NormalTables, calculate};
use crate::sets::tell_directory;
use crate::state::ClutRebuild;
use crate::{BrightnessConfig, BrightnessFetchState, BrightnessSource};
use arrayvec::ArrayVec;
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, OperandWidth, Operators, Step, Unit, UnitTable};
use basrelief_shading::{TableSet, light_vectors};
use basrelief_signals::width::SHARE;
use basrelief_signals::{Control, Flow, MAX_SAMPLES, MAX_STAMP, NormalIndexes, ShadedFragment, Stamp, StampSample};
use std::sync::Arc;

/// Client of the cache in front of the CLUTs (122) in memory (120).
const CLUT: u32 = 0;
/// Client that reads reference normals and writes calculated entries.
const BUILD: u32 = 1;
/// Bytes of calculated entries per write (assumed).
const WRITE_BYTES: u32 = 32;

/// Brightness fetch unit (112).
///
/// Control tokens are only recorded. At the first fragment after them the unit selects the set of CLUTs of its material and
/// lights, so that a frame or an object without bump targets costs nothing. A missing level is calculated when a fragment needs
/// it, and that fragment waits. Reference normals are read from memory (120), lit, and written back as entries, up to 32 bytes
/// per step. Code books end in this unit.
#[derive(Clone, Debug)]
pub struct BrightnessFetch {
    /// Parameters.
    pub config: BrightnessConfig,
    most_samples: u32,
    operators: Operators,
    latency: u64,
    /// State between steps.
    pub state: BrightnessFetchState,
    /// Contents of the VQ tables (121), computed from their parameters.
    normals: NormalTables,
}

type Out = Step<Option<Flow<Stamp<ShadedFragment>>>>;

impl BrightnessFetch {
    /// Creates a unit for the VQ tables (121) that the replacement unit searches, and for stamps of at most `most_samples`
    /// samples, in a machine of these operators.
    pub fn new(config: BrightnessConfig, tables: TableSet, most_samples: u32, operators: &Operators) -> Self {
        let most_samples = most_samples.clamp(1, (MAX_SAMPLES * MAX_STAMP) as u32);
        let latency = config.latency(u32::from(config.levels), operators);
        let (operators, state) = (operators.clone(), BrightnessFetchState::default());
        Self { config, most_samples, operators, latency, state, normals: NormalTables::new(tables) }
    }

    fn quiet(&self) -> Out {
        Step::after(self.latency, None)
    }

    fn control(&mut self, control: Control, traffic: &mut MemoryPorts) -> Out {
        let state = &mut self.state;
        match &control {
            Control::Frame(frame) => {
                state.frame = Some(Arc::clone(frame));
                state.lights_changed = true;
            }
            Control::Object(object) => {
                state.wanted.entries = object.entries;
                if let Some(error) = object.entries.and_then(|entries| state.places.hold(self.normals.set(), entries).err()) {
                    traffic.fault(format!("object `{}`: {error}", object.name));
                }
                state.object = Some(Arc::clone(object));
                state.lights_changed = true;
            }
            Control::Polygon(polygon) => state.wanted.lighting = polygon.material.lighting,
            Control::CodeBook(book) => {
                state.wanted.book = Some(Arc::clone(book));
                state.sets.drop_books();
            }
            Control::FrameEnd | Control::Criterion(_) => {}
        }
        state.sets.lose_sight();
        let out = (!matches!(control, Control::CodeBook(_))).then_some(Flow::Control(control));
        Step::after(self.latency, out)
    }

    #[inline(always)]
    fn item(&mut self, indexes: &mut NormalIndexes, traffic: &mut MemoryPorts) -> Out {
        if !self.state.sets.has_found() {
            self.find_set();
        }
        if indexes.samples.iter().all(|sample| self.state.sets.has(sample.level)) {
            return self.fetch(indexes, traffic);
        }
        self.state.pending = Some(std::mem::take(indexes));
        self.resume(traffic)
    }

    fn find_set(&mut self) {
        let state = &mut self.state;
        if state.lights_changed {
            state.lights_changed = false;
            let centre = state.object.as_ref().map_or([0.0; 3], |o| o.centre);
            state.wanted.lights = state.frame.as_ref().map_or_else(Vec::new, |f| light_vectors(f, centre));
        }
        state.sets.select(&state.wanted, self.normals.largest(&state.wanted), &self.config);
    }

    /// Returns the address of a level's VQ table or code book.
    fn table_address(&self, level: u8) -> u64 {
        let wanted = &self.state.wanted;
        let set = self.normals.set();
        let size = if wanted.book.is_some() { None } else { wanted.entries };
        self.state.places.address(set, level, set.entries(level, size))
    }

    /// Makes a step without input: it calculates the next missing entries of the waiting fragment, or serves it.
    fn resume(&mut self, traffic: &mut MemoryPorts) -> Out {
        if self.state.rebuild.is_none() {
            let Some(indexes) = self.state.pending.take() else { return self.quiet() };
            let lacking = indexes.samples.iter().map(|sample| sample.level).find(|level| !self.state.sets.has(*level));
            let Some(level) = lacking else { return self.fetch(&indexes, traffic) };
            self.state.pending = Some(indexes);
            let entries = self.calculate(level, traffic);
            // Direct computation needs no table.
            if self.config.source == BrightnessSource::Direct || entries == 0 {
                return self.resume(traffic);
            }
            self.state.counters.rebuilds += 1;
            self.state.rebuild = Some(ClutRebuild { level, entries, ..ClutRebuild::default() });
        }
        self.rebuild(traffic)
    }

    /// Calculates all entries of a level at once. The steps that write them model the time.
    fn calculate(&mut self, level: u8, traffic: &mut MemoryPorts) -> usize {
        let Self { config, state, normals, .. } = self;
        let entries = state.sets.calculate(level, |key| calculate(level, config, key, normals));
        entries.unwrap_or_else(|error| {
            let name = state.object.as_ref().map_or("", |o| o.name.as_str());
            traffic.fault(format!("object `{name}` fixes its number of reference normals: {error}"));
            let _ = state.sets.calculate(level, |_| Ok(vec![]));
            0
        })
    }

    /// Reads the next reference normals, calculates the entries of those read before, and writes the entries calculated before.
    /// The unit waits for its reads. After the last entries the next step examines the waiting fragment again.
    fn rebuild(&mut self, traffic: &mut MemoryPorts) -> Out {
        let Some(ClutRebuild { level, entries, read, calculated, written }) = self.state.rebuild.take() else {
            return self.quiet();
        };
        let (entry_bytes, normal_bytes) = (self.config.entry_bytes(), self.normals.entry_bytes());
        let at_once = (WRITE_BYTES / entry_bytes) as usize;
        if calculated > written {
            let address = self.state.sets.address(level) + written as u64 * u64::from(entry_bytes);
            let bytes = (calculated - written) as u32 * entry_bytes;
            traffic.write(BUILD, address, bytes);
            self.state.counters.rebuild_bytes += u64::from(bytes);
        }
        let count = (entries - read).min(at_once);
        if count > 0 {
            let address = self.table_address(level) + read as u64 * u64::from(normal_bytes);
            let bytes = count as u32 * normal_bytes;
            traffic.read(BUILD, address, bytes);
            self.state.counters.normal_bytes += u64::from(bytes);
        }
        let next = ClutRebuild { level, entries, read: read + count, calculated: read, written: calculated };
        self.state.rebuild = (next.written < entries).then_some(next);
        let calculating = (read - calculated) as u64;
        let cycles = (calculating * self.config.entry_cycles(self.state.wanted.lights.len(), &self.operators)).max(1);
        self.state.counters.rebuild_cycles += cycles;
        self.quiet().busy(cycles).blocking()
    }

    #[inline(always)]
    fn fetch(&mut self, indexes: &NormalIndexes, traffic: &mut MemoryPorts) -> Out {
        let (entry_bytes, normal_bytes) = (self.config.entry_bytes(), self.normals.entry_bytes());
        let from_clut = self.config.source == BrightnessSource::Clut;
        // Values common to all fragments: entries, address of the first, and entry size. (A collected array would be copied.)
        let mut tables = ArrayVec::<_, MAX_SAMPLES>::new();
        for &StampSample { level, .. } in &indexes.samples {
            let (base, bytes) =
                if from_clut { (self.state.sets.address(level), entry_bytes) } else { (self.table_address(level), normal_bytes) };
            tables.push((self.state.sets.entries(level), base, bytes));
        }
        let mut out = Stamp::new();
        for (lane, &fragment) in indexes.stamp.iter().enumerate() {
            let mut sum = [0.0; 2];
            for (StampSample { weight, value, .. }, (entries, base, bytes)) in indexes.samples.iter().zip(&tables) {
                let (weight, index) = (weight[lane], value[lane]);
                // A missing entry is black.
                let value = entries.get(usize::from(index)).copied().unwrap_or_default();
                sum = [sum[0] + weight * value[0], sum[1] + weight * value[1]];
                traffic.look_up(CLUT, base + u64::from(index) * u64::from(*bytes), *bytes);
            }
            out.push(ShadedFragment { fragment, brightness: sum[0], highlight: sum[1] });
        }
        let per_fragment = indexes.samples.len();
        let counters = &mut self.state.counters;
        counters.fragments += out.len() as u64;
        counters.samples += (out.len() * per_fragment) as u64;
        let interpolating = per_fragment.div_ceil(self.config.samples_per_cycle.max(1) as usize) as u64;
        let (interval, latency) = if from_clut {
            (interpolating, self.latency)
        } else {
            let computing = per_fragment as u64 * self.config.entry_cycles(self.state.wanted.lights.len(), &self.operators);
            (interpolating.max(computing), self.latency + BrightnessConfig::entry_latency(&self.operators))
        };
        // An address is an index with a base in front. All arithmetic needs the entries.
        Step::over(out.len(), interval, latency, Some(Flow::Item(out))).after_data(latency as u32)
    }

    fn tell_hardware(&self, stats: &mut UnitStats) {
        let c = &self.config;
        let values = c.values();
        // A single level is not interpolated.
        let blenders = if c.levels > 1 { u64::from(c.samples_per_cycle * values) } else { 0 };
        let share = OperandWidth::fixed(c.bits, SHARE).of_integers();
        stats.hardware(HardwareKind::Multiplier, "share of a level", blenders, share);
        stats.hardware(HardwareKind::Adder, "sum of levels", blenders, OperandWidth::from(c.bits).of_integers());
        stats.hardware(HardwareKind::Multiplier, "lighting of an entry", c.multipliers, OperandWidth::SINGLE);
        stats.hardware(HardwareKind::Adder, "lighting of an entry", c.multipliers, OperandWidth::SINGLE);
        stats.hardware(HardwareKind::Power, "highlight of an entry", c.powers, OperandWidth::SINGLE);
        // Direct computation needs no table.
        if c.source == BrightnessSource::Clut {
            tell_directory(c, stats);
        }
    }
}

impl Unit for BrightnessFetch {
    basrelief_kernel::unit_info!("looks brightness up by index, interpolates between levels");
    type In = Option<Flow<NormalIndexes>>;
    type Out = Option<Flow<Stamp<ShadedFragment>>>;

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.pending.is_some() { Demand::Nothing } else { Demand::All }
    }

    #[inline(always)]
    fn step(&mut self, mut input: Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        match input {
            // Borrowed, because a move would copy the token.
            Some(Flow::Item(ref mut indexes)) => self.item(indexes, traffic),
            Some(Flow::Control(control)) => self.control(control, traffic),
            None => self.resume(traffic),
        }
    }

    /// One line per sample, or two if reference normals can lie across lines. One read and one write.
    fn largest_step(&self, client: usize) -> u32 {
        match (self.config.source, client as u32) {
            (BrightnessSource::Clut, CLUT) => self.most_samples,
            (BrightnessSource::Direct, CLUT) => 2 * self.most_samples,
            (BrightnessSource::Clut, BUILD) => 2,
            _ => 0,
        }
    }

    fn is_empty(&self) -> bool {
        self.state.pending.is_none()
    }

    /// Returns the latency, the cycles of an entry, and for each set and level its address, full scale and entries.
    fn twin_tables(&self) -> Vec<UnitTable> {
        let cycles = self.config.entry_cycles(self.state.wanted.lights.len(), &self.operators);
        let numbers = [
            ("latency", self.latency),
            ("entry_cycles", cycles),
            ("entry_bytes", self.config.entry_bytes().into()),
            ("normal_bytes", self.normals.entry_bytes().into()),
        ];
        let mut tables: Vec<_> = numbers.into_iter().map(|(name, value)| UnitTable::number(name, value)).collect();
        tables.extend(self.state.sets.twin_tables(&self.config));
        tables
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        stats.rate(0, self.latency, 1_u64);
        self.tell_hardware(stats);
        let c = &self.state.counters;
        stats.figure("clut_samples", c.samples, "samples", "Samples looked up in CLUTs");
        stats.figure("clut_rebuilds", c.rebuilds, "rebuilds", "Times that the CLUT of a level was calculated");
        stats.figure("clut_rebuild_cycles", c.rebuild_cycles, "cycles", "Cycles that this took");
        stats.figure("clut_rebuild_bytes", c.rebuild_bytes, "bytes", "Entries that it wrote");
        stats.figure("clut_normal_bytes", c.normal_bytes, "bytes", "Reference normals that it read");
    }
}

#[cfg(test)]
mod tests;
