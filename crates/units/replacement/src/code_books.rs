//! Code books: the unit gathers N', clusters them, and sends the held tokens.

use crate::clustering::{BookBatch, Clustering};
use crate::unit::{GATHERED, Out};
use crate::{CodeBook, CodeBookMode, NearestSearch, Replacement, build_code_book};
use basrelief_kernel::MemoryPorts;
use basrelief_shading::LEVELS;
use basrelief_signals::{Control, Flow, PseudoNormals, quantization_memory};

impl Replacement {
    fn normals_bytes(&self, normals: &PseudoNormals) -> u32 {
        (3 * self.normal_bits).div_ceil(8) * (normals.stamp.len() * normals.samples.len()).max(1) as u32
    }

    /// Writes N' to the lower end of the room in memory (120), and the data held beside them to the upper end.
    pub(crate) fn gather(&mut self, normals: PseudoNormals, traffic: &mut MemoryPorts) -> Out {
        let (bytes, beside) = (self.normals_bytes(&normals), crate::gather::fragments_bytes(&normals));
        if !self.has_room(u64::from(bytes) + u64::from(beside), traffic) {
            return self.quiet();
        }
        traffic.write(GATHERED, quantization_memory::GATHERED + self.state.gather.normals.written, bytes);
        self.state.gather.normals.written += u64::from(bytes);
        self.hold_beside(beside, traffic);
        self.state.gather.held.push_back(Flow::Item(normals));
        self.state.counters.gathered_bytes += u64::from(bytes);
        self.quiet()
    }

    /// Holds a control token that arrives between gathered fragments.
    pub(crate) fn hold(&mut self, control: Control, traffic: &mut MemoryPorts) -> Out {
        let bytes = crate::gather::control_bytes(&control);
        if self.has_room(u64::from(bytes), traffic) {
            self.hold_beside(bytes, traffic);
            self.state.gather.held.push_back(Flow::Control(control));
        }
        self.quiet()
    }

    /// Takes the control token that ends a batch. It leaves after all of the batch.
    pub(crate) fn end_batch(&mut self, control: Control) -> Out {
        self.state.gather.ending = Some(control);
        self.quiet()
    }

    fn hold_beside(&mut self, bytes: u32, traffic: &mut MemoryPorts) {
        let beside = &mut self.state.gather.beside;
        beside.written += u64::from(bytes);
        traffic.write(GATHERED, quantization_memory::GATHERED + self.config.gather_bytes - beside.written, bytes);
        self.state.counters.held_beside_bytes += u64::from(bytes);
    }

    fn has_room(&self, bytes: u64, traffic: &mut MemoryPorts) -> bool {
        let needed = self.state.gather.normals.written + self.state.gather.beside.written + bytes;
        let fits = needed <= self.config.gather_bytes;
        if !fits {
            traffic.fault(self.overflow(needed));
        }
        fits
    }

    fn overflow(&self, needed: u64) -> String {
        let (id, name) = self.state.object.as_ref().map_or((0, ""), |o| (o.id, o.name.as_str()));
        let (what, instead) = match self.config.codebook {
            CodeBookMode::PerPolygon => (format!("polygon {} of object {id} `{name}`", self.state.polygons), "fixed"),
            _ => (format!("object {id} `{name}`"), "per_polygon"),
        };
        format!(
            "the pseudo-normals of {what} and what is held beside them need {needed} bytes so far, but \
             `replacement.gather_bytes` is {}; raise it, or set `replacement.codebook` to {instead}",
            self.config.gather_bytes
        )
    }

    /// Makes a step without input while a batch is flushed: of the clustering, of writing the book, or of sending.
    pub(crate) fn flush(&mut self, traffic: &mut MemoryPorts) -> Out {
        if self.state.gather.is_sending {
            return self.send(traffic);
        }
        match self.state.clustering.take() {
            None => self.cluster(traffic),
            Some(clustering) => self.cluster_on(clustering, traffic),
        }
    }

    /// Computes the code book of the batch, one list per table level in use, and makes the first step of its cost.
    fn cluster(&mut self, traffic: &mut MemoryPorts) -> Out {
        let object = self.fixed_by_object();
        let mut lists = vec![Vec::new(); LEVELS];
        let mut batch = BookBatch { bytes: self.state.gather.normals.written, ..BookBatch::default() };
        for (level, list) in lists.iter_mut().enumerate() {
            let normals: Vec<[i16; 3]> = self.state.gather.of_level(level as u8, |sample| self.table_level(sample)).collect();
            if normals.is_empty() {
                continue;
            }
            let entries = self.tables.set().entries(level as u8, object);
            let passes = self.config.kmeans_iterations;
            let book: CodeBook = build_code_book(normals.iter().copied(), entries, passes, self.config.entry_bits);
            batch.normals += normals.len() as u64;
            batch.entries += book.normals.len() as u64;
            batch.seeds = batch.seeds.max(u64::from(book.seeds));
            batch.means = batch.means.max(u64::from(book.passes));
            batch.search_cycles += normals.len() as u64 * self.config.search_cycles(book.normals.len() as u32);
            *list = book.normals;
        }
        self.state.counters.code_books += 1;
        self.state.counters.clustering_passes += 1 + batch.seeds + batch.means;
        *self.state.book = None;
        self.state.gather.write_book(lists, u64::from(self.tables.set().entry_bytes()));
        self.cluster_on(Clustering::new(&batch, &self.config, &self.operators), traffic)
    }

    fn cluster_on(&mut self, mut clustering: Clustering, traffic: &mut MemoryPorts) -> Out {
        let most = u64::from(self.config.load_bytes);
        let Some(part) = clustering.next(most) else { return self.write_book(traffic) };
        let address = quantization_memory::GATHERED + part.at;
        traffic.read(GATHERED, address, part.read);
        if part.write > 0 {
            traffic.write(GATHERED, address, part.write);
        }
        self.state.clustering = Some(clustering);
        let step = self.count_cycles(part.cycles.max(1));
        // The next pass needs the result of this one.
        if part.is_last { step.blocking() } else { step }
    }

    fn count_cycles(&mut self, cycles: u64) -> Out {
        self.state.counters.clustering_cycles += cycles;
        self.quiet().busy(cycles)
    }

    /// Writes the next part of the code book to the VQ tables (121). With the last part, the book itself is sent.
    fn write_book(&mut self, traffic: &mut MemoryPorts) -> Out {
        let most = u64::from(self.config.load_bytes);
        if let Some(load) = self.state.gather.unwritten.front_mut() {
            let bytes = load.next(most);
            traffic.write(GATHERED, bytes.0, bytes.1);
            if load.bytes == 0 {
                self.state.gather.unwritten.pop_front();
            }
        }
        if !self.state.gather.unwritten.is_empty() {
            self.state.clustering = Some(Clustering::default());
            return self.count_cycles(1);
        }
        self.state.gather.is_sending = true;
        let book = self.state.gather.book.clone().unwrap_or_default();
        let mut step = self.count_cycles(1);
        step.out = Some(Flow::Control(Control::CodeBook(book)));
        step
    }

    /// Sends the next gathered token. The control token that ended the batch is last.
    fn send(&mut self, traffic: &mut MemoryPorts) -> Out {
        match self.state.gather.held.pop_front() {
            Some(Flow::Item(mut normals)) => {
                let bytes = self.normals_bytes(&normals);
                traffic.read(GATHERED, quantization_memory::GATHERED + self.state.gather.normals.read, bytes);
                self.state.gather.normals.read += u64::from(bytes);
                self.read_beside(crate::gather::fragments_bytes(&normals), traffic);
                self.prepare_book();
                let step = self.replace(&mut normals, traffic);
                // The search begins with the data. The unit holds one stamp, so it reads the next one after that.
                let latency = step.latency as u32;
                step.after_data(latency).blocking()
            }
            Some(Flow::Control(control)) => {
                self.read_beside(crate::gather::control_bytes(&control), traffic);
                let latency = self.latency as u32;
                self.pass(control, traffic).after_data(latency).blocking()
            }
            None => {
                *self.state.book = None;
                match std::mem::take(&mut self.state.gather).ending {
                    Some(control) => self.pass(control, traffic),
                    None => self.quiet(),
                }
            }
        }
    }

    fn read_beside(&mut self, bytes: u32, traffic: &mut MemoryPorts) {
        let beside = &mut self.state.gather.beside;
        beside.read += u64::from(bytes);
        traffic.read(GATHERED, quantization_memory::GATHERED + self.config.gather_bytes - beside.read, bytes);
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
