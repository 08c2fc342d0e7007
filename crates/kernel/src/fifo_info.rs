//! The untyped half of a FIFO: its properties, its connections, and its number of tokens.

/// Properties and state of a FIFO apart from its tokens.
#[derive(Clone, Debug)]
pub struct FifoInfo {
    name: String,
    depth: usize,
    /// Width of a slot \[bits\]; 0 if unknown.
    bits: u32,
    latency: u64,
    /// Tokens become visible in multiples of this cycle.
    period: u64,
    pushed: u64,
    popped: u64,
    /// Numbers of the stages at its ends and of the FIFO itself, once the wiring is checked.
    producer: Option<usize>,
    consumer: Option<usize>,
    number: usize,
}

impl FifoInfo {
    /// Creates the state of a FIFO of `depth` slots whose tokens are visible `latency` cycles after delivery. Both are at least
    /// 1.
    ///
    /// # Panics
    /// If depth or latency is 0: the laws of time need both.
    pub fn new(name: &str, depth: usize, latency: u64) -> Self {
        assert!(depth >= 1, "FIFO {name}: depth 0, expected at least 1 (law 1)");
        assert!(latency >= 1, "FIFO {name}: latency 0, expected at least 1 (law 1)");
        let (producer, consumer) = (None, None);
        Self { name: name.into(), depth, bits: 0, latency, period: 1, pushed: 0, popped: 0, producer, consumer, number: 0 }
    }

    /// Its name in the machine.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Width of a slot \[bits\]; 0 if unknown.
    pub fn bits(&self) -> u32 {
        self.bits
    }

    pub(crate) fn set_bits(&mut self, bits: u32) {
        self.bits = bits;
    }

    /// Number of the producer stage in the wiring; `None` before a run.
    pub fn producer(&self) -> Option<usize> {
        self.producer
    }

    /// Number of the consumer stage in the wiring; `None` before a run.
    pub fn consumer(&self) -> Option<usize> {
        self.consumer
    }

    pub(crate) fn set_producer(&mut self, stage: usize) {
        self.producer = Some(stage);
    }

    pub(crate) fn set_consumer(&mut self, stage: usize) {
        self.consumer = Some(stage);
    }

    pub(crate) fn forget_ends(&mut self) {
        (self.producer, self.consumer) = (None, None);
    }

    /// Number among the FIFOs of the machine, in the order of the wiring by producer.
    pub(crate) fn number(&self) -> usize {
        self.number
    }

    pub(crate) fn set_number(&mut self, number: usize) {
        self.number = number;
    }

    /// Slots.
    pub fn depth(&self) -> usize {
        self.depth
    }

    /// Cycles from delivery to visibility.
    pub fn latency(&self) -> u64 {
        self.latency
    }

    /// Cycles between the cycles in which tokens can become visible; 1 for any cycle (law 1).
    pub fn period(&self) -> u64 {
        self.period
    }

    pub(crate) fn set_period(&mut self, period: u64) {
        assert!(period >= 1, "FIFO {}: period 0, expected at least 1 (law 1)", self.name);
        self.period = period;
    }

    /// Tokens inside, delivered or not.
    #[inline]
    pub fn len(&self) -> usize {
        (self.pushed - self.popped) as usize
    }

    /// Returns true if no token is inside.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns true if a slot is free.
    #[inline]
    pub fn has_room(&self) -> bool {
        self.len() < self.depth
    }

    /// Tokens pushed so far.
    #[inline(always)]
    pub(crate) fn pushed(&self) -> u64 {
        self.pushed
    }

    /// Tokens popped so far.
    #[inline(always)]
    pub(crate) fn popped(&self) -> u64 {
        self.popped
    }

    #[inline(always)]
    pub(crate) fn count_push(&mut self) {
        self.pushed += 1;
    }

    #[inline(always)]
    pub(crate) fn count_pop(&mut self) {
        self.popped += 1;
    }
}
