//! The unit and its step.

use crate::state::{TableKey, TableLoad};
use crate::tables::HostTables;
use crate::{CodeBookMode, NearestSearch, ReplacementConfig, ReplacementState, build_code_book};
use basrelief_kernel::facts::Facts;
use basrelief_kernel::{Demand, Step, Traffic, Unit};
use basrelief_shading::{LEVELS, TableError};
use basrelief_signals::{Control, Flow, Indexes, MAX_STAMP, PseudoNormals, Sample, Samples, quantization_memory};
use std::sync::Arc;

/// VQ tables (121) are read through this client.
const TABLES: u32 = 0;
/// Gathered pseudo-normals are written and read through this one.
const GATHERED: u32 = 1;

/// Normal-vector replacement unit (110).
///
/// A fragment whose VQ table is not resident starts loading it, one read per step; the step that issues the last read
/// also searches, since its answer is the last to come. With code books, fragments are gathered in memory (120) up to
/// the end of the polygon or object; then the unit clusters, sends the code book, and sends what it held.
#[derive(Clone, Debug)]
pub struct Replacement {
    /// Parameters.
    pub config: ReplacementConfig,
    normal_bits: u32,
    /// Everything it remembers.
    pub state: ReplacementState,
    /// What the VQ tables (121) hold; follows from their parameters.
    tables: HostTables,
}

type Out = Step<Option<Flow<Indexes>>>;

impl Replacement {
    /// A unit for pseudo-normals of `normal_bits` bits per component.
    ///
    /// # Errors
    /// Where a level's table does not exist (a tetrahedron has 4 k^2 faces).
    pub fn new(config: ReplacementConfig, normal_bits: u32) -> Result<Self, TableError> {
        let set = config.table_set();
        set.check()?;
        Ok(Self { config, normal_bits, state: ReplacementState::default(), tables: HostTables::new(set) })
    }

    /// Level of table and CLUT for a sample's MIP level.
    #[inline]
    fn table_level(&self, level: u8) -> u8 {
        level.saturating_add(self.config.vq_bias).min(LEVELS as u8 - 1)
    }

    fn fixed_by_object(&self) -> Option<u32> {
        self.state.object.as_ref().and_then(|o| o.entries)
    }

    fn quiet(&self) -> Out {
        Step::after(u64::from(self.config.latency), None)
    }

    #[inline(always)]
    fn item(&mut self, normals: PseudoNormals, traffic: &mut Traffic) -> Out {
        if self.config.codebook != CodeBookMode::Fixed {
            return self.gather(normals, traffic);
        }
        self.request_tables(&normals);
        if self.state.loads.is_empty() {
            return self.replace(normals, traffic);
        }
        self.state.pending = Some(normals);
        self.load(traffic)
    }

    fn control(&mut self, control: Control) -> Out {
        let gather = &mut self.state.gather;
        if gather.is_empty() {
            return self.pass(control);
        }
        let ends = match control {
            // A polygon that is no bump target waits beside this unit for what is ahead of it: a batch never stamps one.
            Control::Polygon(ref polygon) => !polygon.bump || self.config.codebook == CodeBookMode::PerPolygon,
            Control::Frame(_) | Control::Object(_) | Control::FrameEnd => true,
            Control::CodeBook(_) | Control::Criterion(_) => false,
        };
        if ends {
            gather.ending = Some(control);
        } else {
            gather.held.push_back(Flow::Control(control));
        }
        self.quiet()
    }

    /// A control token takes effect and travels on.
    fn pass(&mut self, control: Control) -> Out {
        match &control {
            Control::Object(object) => {
                self.state.object = Some(Arc::clone(object));
                self.state.polygons = 0;
                *self.state.settled = None;
            }
            Control::Polygon(_) => self.state.polygons += 1,
            _ => {}
        }
        Step::after(u64::from(self.config.latency), Some(Flow::Control(control)))
    }

    /// A step that takes no input: it loads, clusters, or sends what was gathered.
    fn resume(&mut self, traffic: &mut Traffic) -> Out {
        if self.state.pending.is_some() {
            self.load(traffic)
        } else if self.state.gather.is_flushing() {
            if self.state.gather.book.is_some() { self.send(traffic) } else { self.cluster() }
        } else {
            self.quiet()
        }
    }
}

/// VQ tables fixed in advance.
impl Replacement {
    /// Marks the tables of a fragment as used, and queues those that are not resident.
    #[inline]
    fn request_tables(&mut self, normals: &PseudoNormals) {
        let levels = || normals.samples.iter().map(|s| s.level);
        if self.state.settled.as_ref().is_some_and(|settled| settled.iter().copied().eq(levels())) {
            return;
        }
        let object = self.fixed_by_object();
        for level in levels() {
            let level = self.table_level(level);
            let key = (level, self.tables.set().entries(level, object));
            match self.state.resident.iter().position(|k| *k == key) {
                Some(at) => self.state.resident[..=at].rotate_right(1),
                None => self.admit(key),
            }
        }
        *self.state.settled = self.state.loads.is_empty().then(|| levels().collect());
    }

    fn admit(&mut self, key: TableKey) {
        let bytes = u64::from(key.1) * u64::from(self.tables.set().entry_bytes());
        self.state.resident.truncate(self.config.resident_tables.max(1) as usize - 1);
        self.state.resident.insert(0, key);
        self.state.loads.push_back(TableLoad { address: quantization_memory::vq_table(key.0), bytes });
        self.state.counters.table_loads += 1;
        self.state.counters.table_load_bytes += bytes;
    }

    /// Issues one read; after the last one the waiting fragment is searched.
    fn load(&mut self, traffic: &mut Traffic) -> Out {
        if let Some(load) = self.state.loads.front_mut() {
            let bytes = load.bytes.min(u64::from(self.config.load_bytes)).max(1);
            traffic.read(TABLES, load.address, bytes as u32);
            load.address += bytes;
            load.bytes = load.bytes.saturating_sub(bytes);
            if load.bytes == 0 {
                self.state.loads.pop_front();
            }
        }
        if !self.state.loads.is_empty() {
            return self.quiet();
        }
        match self.state.pending.take() {
            Some(normals) => self.replace(normals, traffic),
            None => self.quiet(),
        }
    }

    /// Searches every sample of a stamp in the table or code book of its level: those of the first fragment, then those of the
    /// second ...
    #[inline(always)]
    fn replace(&mut self, normals: PseudoNormals, traffic: &mut Traffic) -> Out {
        let object = self.fixed_by_object();
        let fragments = normals.stamp.len();
        let mut samples = Samples::new();
        let (mut of_fragment, mut pipelined) = (0, 0);
        for (i, Sample { level, weight, value }) in normals.samples.iter().enumerate() {
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
                    for (index, normal) in indexes.iter_mut().zip(value).take(fragments) {
                        *index = search.nearest(*normal);
                        self.state.counters.count_search(level, *index);
                    }
                }
                Err(error) => {
                    let name = self.state.object.as_ref().map_or("", |o| o.name.as_str());
                    traffic.fault(format!("object `{name}` fixes its number of reference normals: {error}"));
                }
            }
            of_fragment += cycles;
            pipelined = pipelined.max(i as u64 + cycles);
            samples.push(Sample { level, weight: *weight, value: indexes });
        }
        let searches = (fragments * samples.len()) as u64;
        let (occupancy, cycles) = if self.config.pipelined {
            // One search starts per cycle; the last fragment is the last to be through.
            (searches, searches - samples.len() as u64 + pipelined)
        } else {
            (fragments as u64 * of_fragment, fragments as u64 * of_fragment)
        };
        let out = Indexes { stamp: normals.stamp, samples };
        Step::after(u64::from(self.config.latency) + cycles, Some(Flow::Item(out))).busy(occupancy.max(1))
    }
}

/// Code books.
impl Replacement {
    fn item_bytes(&self, normals: &PseudoNormals) -> u32 {
        (3 * self.normal_bits).div_ceil(8) * (normals.stamp.len() * normals.samples.len()).max(1) as u32
    }

    fn gather(&mut self, normals: PseudoNormals, traffic: &mut Traffic) -> Out {
        let bytes = self.item_bytes(&normals);
        let needed = self.state.gather.written + u64::from(bytes);
        if needed > self.config.gather_bytes {
            traffic.fault(self.overflow(needed));
            return self.quiet();
        }
        traffic.write(GATHERED, quantization_memory::GATHERED + self.state.gather.written, bytes);
        self.state.gather.written = needed;
        self.state.gather.held.push_back(Flow::Item(normals));
        self.state.counters.gathered_bytes += u64::from(bytes);
        self.quiet()
    }

    fn overflow(&self, needed: u64) -> String {
        let (id, name) = self.state.object.as_ref().map_or((0, ""), |o| (o.id, o.name.as_str()));
        let (what, instead) = match self.config.codebook {
            CodeBookMode::PerPolygon => (format!("polygon {} of object {id} `{name}`", self.state.polygons), "fixed"),
            _ => (format!("object {id} `{name}`"), "per_polygon"),
        };
        format!(
            "the pseudo-normals of {what} need {needed} bytes so far, but `replacement.gather_bytes` is {}; raise it, or set \
             `replacement.codebook` to {instead}",
            self.config.gather_bytes
        )
    }

    /// Builds the code book of the batch: one list per table level in use. The step takes as long as the inner products of
    /// all passes do.
    fn cluster(&mut self) -> Out {
        let object = self.fixed_by_object();
        let mut lists = vec![Vec::new(); LEVELS];
        let mut products = 0;
        for (level, list) in lists.iter_mut().enumerate() {
            let normals: Vec<[i16; 3]> = self.state.gather.of_level(level as u8, |sample| self.table_level(sample)).collect();
            if normals.is_empty() {
                continue;
            }
            let entries = self.tables.set().entries(level as u8, object);
            let passes = self.config.kmeans_iterations;
            *list = build_code_book(normals.iter().copied(), entries, passes, self.config.entry_bits);
            // Fewer distinct normals than entries: one pass finds that out.
            let passes = if list.len() < entries as usize { 1 } else { passes };
            products += u64::from(passes) * normals.len() as u64 * list.len() as u64;
        }
        let cycles = products.div_ceil(u64::from(self.config.lanes.max(1))).max(1);
        self.state.counters.code_books += 1;
        self.state.counters.clustering_cycles += cycles;
        let book = Arc::new(lists);
        *self.state.book = None;
        self.state.gather.book = Some(Arc::clone(&book));
        let latency = cycles + u64::from(self.config.latency);
        Step::after(latency, Some(Flow::Control(Control::CodeBook(book)))).busy(cycles)
    }

    /// Sends the next of what was gathered; at last the control token that ended the batch.
    fn send(&mut self, traffic: &mut Traffic) -> Out {
        match self.state.gather.held.pop_front() {
            Some(Flow::Item(normals)) => {
                let bytes = self.item_bytes(&normals);
                traffic.read(GATHERED, quantization_memory::GATHERED + self.state.gather.read, bytes);
                self.state.gather.read += u64::from(bytes);
                self.prepare_book();
                self.replace(normals, traffic)
            }
            Some(Flow::Control(control)) => self.pass(control),
            None => {
                *self.state.book = None;
                match std::mem::take(&mut self.state.gather).ending {
                    Some(control) => self.pass(control),
                    None => self.quiet(),
                }
            }
        }
    }

    fn prepare_book(&mut self) {
        if self.state.book.is_none()
            && let Some(book) = &self.state.gather.book
        {
            let searches = self.state.gather.held.len();
            *self.state.book = Some(book.iter().map(|list| NearestSearch::new(list, searches)).collect());
        }
    }
}

impl Unit for Replacement {
    basrelief_kernel::role!("replaces N' by the index of the nearest reference normal");
    type In = Option<Flow<PseudoNormals>>;
    type Out = Option<Flow<Indexes>>;

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.pending.is_some() || self.state.gather.is_flushing() { Demand::Nothing } else { Demand::All }
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, traffic: &mut Traffic) -> Step<Self::Out> {
        match input {
            Some(Flow::Item(normals)) => self.item(normals, traffic),
            Some(Flow::Control(control)) => self.control(control),
            None => self.resume(traffic),
        }
    }

    fn largest_step(&self, client: usize) -> u32 {
        let fixed = self.config.codebook == CodeBookMode::Fixed;
        u32::from((client == TABLES as usize && fixed) || (client == GATHERED as usize && !fixed))
    }

    fn is_empty(&self) -> bool {
        self.state.pending.is_none() && self.state.gather.is_empty()
    }

    fn tell(&self, facts: &mut Facts) {
        let search = self.config.search_cycles(self.config.entries.levels()[0]);
        let interval = if self.config.pipelined { 1 } else { search };
        facts.rate(0, u64::from(self.config.latency) + search, interval);
        let c = &self.state.counters;
        // Claim 3 and the promise of the patent: only indexes are kept on the surface, so less is moved than with normals.
        let most = self.config.entries.levels().into_iter().max().unwrap_or(1);
        let index_bytes = u64::from(most.max(2).next_power_of_two().trailing_zeros()).div_ceil(8);
        let normal_bytes = u64::from(3 * self.normal_bits).div_ceil(8);
        facts.figure("searches", c.searches, "searches", "Searches for the nearest reference normal");
        facts.figure(
            "reference_normals_used",
            c.reference_normals_used().map(u64::from).to_vec(),
            "reference normals",
            "Reference normals that some search found, by VQ table",
        );
        facts.figure("vq_table_loads", c.table_loads, "loads", "Loads of VQ tables");
        facts.figure("vq_table_load_bytes", c.table_load_bytes, "bytes", "What they moved");
        facts.figure("code_books", c.code_books, "code books", "Code books made of gathered pseudo-normals");
        facts.figure("clustering_cycles", c.clustering_cycles, "cycles", "Cycles that making them took");
        facts.figure("gathered_bytes", c.gathered_bytes, "bytes", "Pseudo-normals gathered for them");
        facts.figure(
            "index_bytes",
            c.searches * index_bytes,
            "bytes",
            "What indexes take that are kept on the surface, one per search",
        );
        facts.figure("full_normal_bytes", c.searches * normal_bytes, "bytes", "What normals would take in their place");
    }
}

#[cfg(test)]
mod tests;
