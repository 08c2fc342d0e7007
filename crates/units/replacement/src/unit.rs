//! The unit and its step.

use crate::gather::TableLoad;
use crate::policy::MOST_OBJECTS;
use crate::state::TableKey;
use crate::tables::HostTables;
use crate::{CodeBookMode, ReplacementConfig, ReplacementState, TablePolicy};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, OperandWidth, Operators, Step, Unit, UnitTable};
use basrelief_shading::{LEVELS, TableError};
use basrelief_signals::width::LEVEL;
use basrelief_signals::{Control, Flow, MAX_STAMP, NormalIndexes, ObjectInfo, PseudoNormals, StampSample, StampSamples};
use std::sync::Arc;

/// Client that reads VQ tables (121).
const TABLES: u32 = 0;
/// Client that writes and reads gathered pseudo-normals and the data held beside them, and writes code books.
pub(crate) const GATHERED: u32 = 1;

/// Number of entries of a VQ table, up to 2^16 \[bits\].
const SIZE_BITS: u32 = 17;
/// Width of the record of an object: its number, fragments, and the sum of their level of detail \[bits\].
const OBJECT_BITS: u32 = 16 + 32 + 38;

/// Normal-vector replacement unit (110).
///
/// A fragment whose VQ table is not resident starts loading it, one read per step. The unit waits for the last read, and then
/// searches. With code books, fragments are gathered in memory (120) up to the end of
/// the polygon or object. Then the unit clusters pass by pass, writes and sends the code book, and sends the held tokens.
#[derive(Clone, Debug)]
pub struct Replacement {
    /// Parameters.
    pub config: ReplacementConfig,
    pub(crate) normal_bits: u32,
    pub(crate) operators: Operators,
    /// Cycles from the last row of the largest table to an index. All tokens take it, so that none overtakes another.
    pub(crate) latency: u64,
    /// State between steps.
    pub state: ReplacementState,
    /// Contents of the VQ tables (121), computed from their parameters.
    pub(crate) tables: HostTables,
}

pub(crate) type Out = Step<Option<Flow<NormalIndexes>>>;

impl Replacement {
    /// Creates a unit for pseudo-normals of `normal_bits` bits per component, in a machine of these operators.
    ///
    /// # Errors
    /// Returns an error if a level's table does not exist (a tetrahedron has 4 k^2 faces).
    pub fn new(config: ReplacementConfig, normal_bits: u32, operators: &Operators) -> Result<Self, TableError> {
        let set = config.table_set();
        set.check()?;
        let most = config.entries.levels().into_iter().max().unwrap_or(1);
        let latency = config.latency(most, operators);
        let (operators, state) = (operators.clone(), ReplacementState::default());
        Ok(Self { config, normal_bits, operators, latency, state, tables: HostTables::new(set) })
    }

    /// Returns the level of table and CLUT for a sample's MIP level.
    #[inline]
    pub(crate) fn table_level(&self, level: u8) -> u8 {
        let bias = self.state.object.as_ref().and_then(|o| o.bias).unwrap_or(self.config.vq_bias);
        level.saturating_add(bias).min(LEVELS as u8 - 1)
    }

    pub(crate) fn fixed_by_object(&self) -> Option<u32> {
        self.state.object.as_ref().and_then(|o| o.entries)
    }

    pub(crate) fn quiet(&self) -> Out {
        Step::after(self.latency, None)
    }

    #[inline(always)]
    fn item(&mut self, normals: &mut PseudoNormals, traffic: &mut MemoryPorts) -> Out {
        if self.config.policy != TablePolicy::Fixed {
            let object = self.state.object.as_ref().map_or(0, |o| o.id);
            self.state.history.count(object, normals.stamp.len() as u64, self.state.lod);
        }
        if self.config.codebook != CodeBookMode::Fixed {
            return self.gather(std::mem::take(normals), traffic);
        }
        self.request_tables(normals);
        if self.state.loads.is_empty() {
            return self.replace(normals, traffic);
        }
        self.state.pending = Some(std::mem::take(normals));
        self.load(traffic)
    }

    fn control(&mut self, control: Control, traffic: &mut MemoryPorts) -> Out {
        if self.state.gather.is_empty() {
            return self.pass(control, traffic);
        }
        let ends = match control {
            // A polygon that is not a bump target waits beside this unit for the fragments ahead of it, because a batch never
            // stamps one.
            Control::Polygon(ref polygon) => !polygon.bump || self.config.codebook == CodeBookMode::PerPolygon,
            Control::Frame(_) | Control::Object(_) | Control::FrameEnd => true,
            Control::CodeBook(_) | Control::Criterion(_) => false,
        };
        if ends { self.end_batch(control) } else { self.hold(control, traffic) }
    }

    /// Applies a control token and sends it on.
    pub(crate) fn pass(&mut self, control: Control, traffic: &mut MemoryPorts) -> Out {
        let control = match control {
            Control::Object(object) => Control::Object(self.begin_object(object, traffic)),
            Control::Polygon(polygon) => {
                self.state.polygons += 1;
                self.state.lod = polygon.lod;
                Control::Polygon(polygon)
            }
            Control::Frame(frame) => {
                self.state.history.begin_frame();
                Control::Frame(frame)
            }
            other => other,
        };
        Step::after(self.latency, Some(Flow::Control(control)))
    }

    /// Begins an object, which travels on with the number of reference normals that the policy gives it.
    fn begin_object(&mut self, object: Arc<ObjectInfo>, traffic: &mut MemoryPorts) -> Arc<ObjectInfo> {
        let by_policy = || self.state.history.entries(object.id, &self.config);
        let object = match object.entries.is_none().then(by_policy).flatten() {
            Some(entries) => Arc::new(ObjectInfo { entries: Some(entries), ..ObjectInfo::clone(&object) }),
            None => object,
        };
        if let Some(error) = object.entries.and_then(|entries| self.state.places.hold(self.tables.set(), entries).err()) {
            traffic.fault(format!("object `{}`: {error}", object.name));
        }
        self.state.object = Some(Arc::clone(&object));
        self.state.polygons = 0;
        *self.state.settled = None;
        object
    }

    /// Makes a step without input: it loads, clusters, or sends gathered tokens.
    fn resume(&mut self, traffic: &mut MemoryPorts) -> Out {
        if self.state.pending.is_some() {
            self.load(traffic)
        } else if self.state.gather.is_flushing() {
            self.flush(traffic)
        } else {
            self.quiet()
        }
    }
}

/// Tables fixed in advance.
impl Replacement {
    /// Marks the tables of a stamp as used, and queues tables that are not resident. If the unit holds all of them, one pass for
    /// all fragments suffices. Otherwise each fragment has a pass, so that loads do not depend on the size of a stamp.
    #[inline]
    fn request_tables(&mut self, normals: &PseudoNormals) {
        let levels = || normals.samples.iter().map(|s| s.level);
        if self.state.settled.as_ref().is_some_and(|settled| settled.iter().copied().eq(levels())) {
            return;
        }
        let holds_all = normals.samples.len() <= self.config.resident_tables as usize;
        for _ in 0..if holds_all { 1 } else { normals.stamp.len() } {
            levels().for_each(|level| self.request_table(level));
        }
        *self.state.settled = self.state.loads.is_empty().then(|| levels().collect());
    }

    fn request_table(&mut self, level: u8) {
        let level = self.table_level(level);
        let key = (level, self.tables.set().entries(level, self.fixed_by_object()));
        match self.state.resident.iter().position(|k| *k == key) {
            Some(at) => self.state.resident[..=at].rotate_right(1),
            None => self.admit(key),
        }
    }

    fn admit(&mut self, key: TableKey) {
        let bytes = u64::from(key.1) * u64::from(self.tables.set().entry_bytes());
        let address = self.state.places.address(self.tables.set(), key.0, key.1);
        self.state.resident.truncate(self.config.resident_tables.max(1) as usize - 1);
        self.state.resident.insert(0, key);
        self.state.loads.push_back(TableLoad { address, bytes });
        self.state.counters.table_loads += 1;
        self.state.counters.table_load_bytes += bytes;
    }

    /// Issues one read, or searches the waiting fragment if all tables are loaded.
    fn load(&mut self, traffic: &mut MemoryPorts) -> Out {
        if let Some(load) = self.state.loads.front_mut() {
            let (address, bytes) = load.next(u64::from(self.config.load_bytes));
            traffic.read(TABLES, address, bytes);
            if load.bytes == 0 {
                self.state.loads.pop_front();
            }
            // The search needs all tables. Answers come in order, so the last one suffices.
            let step = self.quiet();
            return if self.state.loads.is_empty() { step.blocking() } else { step };
        }
        match self.state.pending.take() {
            Some(mut normals) => self.replace(&mut normals, traffic),
            None => self.quiet(),
        }
    }

    /// Searches every sample of a stamp in the table or code book of its level: first all samples of the first fragment, then
    /// those of the second. The stamp travels on.
    #[inline(always)]
    pub(crate) fn replace(&mut self, normals: &mut PseudoNormals, traffic: &mut MemoryPorts) -> Out {
        let object = self.fixed_by_object();
        let fragments = normals.stamp.len();
        let mut samples = StampSamples::new();
        let (mut of_fragment, mut pipelined) = (0, 0);
        for (i, StampSample { level, weight, value }) in normals.samples.iter().enumerate() {
            let level = self.table_level(*level);
            let search = match &mut *self.state.book {
                Some(book) => book.get_mut(usize::from(level)).ok_or(TableError::Entries(0)),
                None => self.tables.table(level, object),
            };
            let mut indexes = [0; MAX_STAMP];
            let mut cycles = 0;
            match search {
                Ok(search) => {
                    cycles = self.config.search_cycles(search.entries());
                    indexes = search.nearest_of(value, fragments);
                    self.state.counters.count_searches(level, &indexes[..fragments]);
                }
                Err(error) => {
                    let name = self.state.object.as_ref().map_or("", |o| o.name.as_str());
                    traffic.fault(format!("object `{name}` fixes its number of reference normals: {error}"));
                }
            }
            of_fragment += cycles;
            pipelined = pipelined.max(i as u64 + cycles);
            samples.push(StampSample { level, weight: *weight, value: indexes });
        }
        let searches = (fragments * samples.len()) as u64;
        // The last row enters in the last of these cycles.
        let (occupancy, cycles) = if self.config.pipelined {
            // One search starts per cycle, and the last fragment finishes last.
            (searches, searches - samples.len() as u64 + pipelined)
        } else {
            (fragments as u64 * of_fragment, fragments as u64 * of_fragment)
        };
        let out = Some(Flow::Item(NormalIndexes { stamp: std::mem::take(&mut normals.stamp), samples }));
        Step::after(self.latency + cycles.saturating_sub(1), out).busy(occupancy.max(1))
    }
}

impl Replacement {
    fn tell_hardware(&self, stats: &mut UnitStats) {
        let c = &self.config;
        let most = c.entries.levels().into_iter().max().unwrap_or(1);
        let (width, units) = (c.entry_bits.max(self.normal_bits), u64::from(c.inner_products()));
        stats.hardware(HardwareKind::InnerProduct, "search", units, OperandWidth::from(width).of_integers());
        let product = OperandWidth::from(2 * width + 2).of_integers();
        stats.hardware(HardwareKind::Comparator, "largest inner product", units, product);
        // A search passes its rows one after the other. Where each row has lanes of its own, N' goes with it.
        let rows = if c.pipelined { c.search_cycles(most) } else { 1 };
        stats.hardware(HardwareKind::Registers, "N' on its way through the rows of lanes", rows - 1, 3 * self.normal_bits);
        let held = u64::from(c.resident_tables) * u64::from(most);
        // Each lane reads a direction of its own in every cycle.
        stats.banked_table("VQ tables (121)", held, 3 * c.entry_bits, c.inner_products());
        if c.codebook == CodeBookMode::Fixed {
            stats.directory("resident VQ tables: level and size, valid, order of use", c.resident_tables, &[LEVEL, SIZE_BITS], 1);
        } else {
            stats.hardware(HardwareKind::Divider, "unit length of directions", 1_u64, width);
            stats.hardware(HardwareKind::SquareRoot, "unit length of directions", 1_u64, width);
            // Sums of 2^32 directions of an entry.
            stats.hardware(HardwareKind::Table, "sums of directions", 3 * u64::from(most), width + 32);
        }
        if c.policy != TablePolicy::Fixed {
            stats.hardware(HardwareKind::Table, "objects of two frames", 2 * MOST_OBJECTS as u64, OBJECT_BITS);
        }
    }
}

impl Unit for Replacement {
    basrelief_kernel::unit_info!("replaces N' by the index of the nearest reference normal");
    type In = Option<Flow<PseudoNormals>>;
    type Out = Option<Flow<NormalIndexes>>;

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.pending.is_some() || self.state.gather.is_flushing() { Demand::Nothing } else { Demand::All }
    }

    #[inline(always)]
    fn step(&mut self, mut input: Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        match input {
            // By reference, because a move would copy the token.
            Some(Flow::Item(ref mut normals)) => self.item(normals, traffic),
            Some(Flow::Control(control)) => self.control(control, traffic),
            None => self.resume(traffic),
        }
    }

    fn largest_step(&self, client: usize) -> u32 {
        match (client as u32, self.config.codebook) {
            (TABLES, CodeBookMode::Fixed) => 1,
            (GATHERED, CodeBookMode::PerPolygon | CodeBookMode::PerObject) => 2,
            _ => 0,
        }
    }

    fn is_empty(&self) -> bool {
        self.state.pending.is_none() && self.state.gather.is_empty()
    }

    /// Returns the latency, and the VQ tables of objects that fix no number of entries: x, y, z of each reference normal.
    fn twin_tables(&self) -> Vec<UnitTable> {
        let set = self.tables.set();
        let pack = |normal: [i16; 3]| vec![(0..).zip(normal).map(|(i, c)| u64::from(c as u16) << (16 * i)).sum()];
        let table = |level: u8| {
            let normals = set.normals(level, set.entries(level, None)).unwrap_or_default();
            UnitTable { name: format!("normals.{level}"), bits: 48, entries: normals.into_iter().map(pack).collect() }
        };
        let entry_bytes = UnitTable::number("entry_bytes", set.entry_bytes());
        [UnitTable::number("latency", self.latency), entry_bytes].into_iter().chain((0..LEVELS as u8).map(table)).collect()
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        let search = self.config.search_cycles(self.config.entries.levels()[0]);
        let interval = if self.config.pipelined { 1 } else { search };
        stats.rate(0, self.latency + search - 1, interval);
        self.tell_hardware(stats);
        let c = &self.state.counters;
        // Claim 3 and the promise of the patent: only indexes are kept on the surface, so less is moved than with normals.
        let most = self.config.entries.levels().into_iter().max().unwrap_or(1);
        let index_bytes = u64::from(most.max(2).next_power_of_two().trailing_zeros()).div_ceil(8);
        let normal_bytes = u64::from(3 * self.normal_bits).div_ceil(8);
        stats.figure("searches", c.searches, "searches", "Searches for the nearest reference normal");
        stats.figure(
            "reference_normals_used",
            c.reference_normals_used().map(u64::from).to_vec(),
            "reference normals",
            "Reference normals that some search found, by VQ table",
        );
        stats.figure("vq_table_loads", c.table_loads, "loads", "Loads of VQ tables");
        stats.figure("vq_table_load_bytes", c.table_load_bytes, "bytes", "Data of the loads of VQ tables");
        stats.figure(
            "vq_table_other_bytes",
            self.state.places.bytes(),
            "bytes",
            "VQ tables of other sizes that memory (120) holds, for all levels",
        );
        stats.figure("code_books", c.code_books, "code books", "Code books made of gathered pseudo-normals");
        stats.figure("clustering_passes", c.clustering_passes, "passes", "Passes over all gathered pseudo-normals for that");
        stats.figure("clustering_cycles", c.clustering_cycles, "cycles", "Cycles that making them took");
        stats.figure("gathered_bytes", c.gathered_bytes, "bytes", "Pseudo-normals gathered for them");
        stats.figure("held_beside_bytes", c.held_beside_bytes, "bytes", "Fragments and control held beside those");
        stats.figure("index_bytes", c.searches * index_bytes, "bytes", "Memory for the indexes on the surface, one per search");
        stats.figure("full_normal_bytes", c.searches * normal_bytes, "bytes", "Memory for normals in place of these indexes");
    }
}

#[cfg(test)]
mod tests;
