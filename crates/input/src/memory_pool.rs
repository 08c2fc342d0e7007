//! Memory limit for untrusted input, counted before memory is allocated.

use std::fmt::{self, Display, Formatter};
use std::io::{self, Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Pool of memory for untrusted input. Clones share one pool.
///
/// A reader takes memory from the pool with [`MemoryPool::try_reserve`] before it allocates. The count covers data structures and not
/// file sizes, so that a small file that expands into large structures is refused. Memory of the program itself is not counted.
#[derive(Clone, Debug)]
pub struct MemoryPool(Arc<PoolState>);

#[derive(Debug)]
struct PoolState {
    limit: u64,
    /// Advice for errors.
    advice: &'static str,
    /// True if the process gets no more memory than this.
    bounds_process: bool,
    /// Returns the bytes taken. Atomic, because several threads fetch tiles of a server.
    held: AtomicU64,
}

impl Default for MemoryPool {
    fn default() -> Self {
        Self::new(Self::DEFAULT)
    }
}

impl MemoryPool {
    /// Default limit \[bytes\].
    pub const DEFAULT: u64 = 1 << 30;

    /// Creates a pool of this many bytes, whose errors name `--memory-limit`.
    pub fn new(limit: u64) -> Self {
        Self::with_advice(limit, "give more with --memory-limit, if this input is to be trusted")
    }

    /// Creates a pool of this many bytes, with advice for its errors.
    pub fn with_advice(limit: u64, advice: &'static str) -> Self {
        Self::create(limit, advice, false)
    }

    /// Creates the pool of a process that gets only this many bytes, with advice for its errors.
    pub fn of_process(limit: u64, advice: &'static str) -> Self {
        Self::create(limit, advice, true)
    }

    fn create(limit: u64, advice: &'static str, bounds_process: bool) -> Self {
        Self(Arc::new(PoolState { limit, advice, bounds_process, held: AtomicU64::new(0) }))
    }

    /// Returns true if the process gets no more memory than this. Then memory that does not depend on an untrusted input counts too.
    pub fn bounds_process(&self) -> bool {
        self.0.bounds_process
    }

    /// Returns the bytes that are left.
    pub fn left(&self) -> u64 {
        self.0.limit.saturating_sub(self.0.held.load(Relaxed))
    }

    /// Takes `bytes` for `what`: a noun, such as `texels`. Dropping the result gives them back.
    ///
    /// # Errors
    /// `bytes` exceeds the bytes that are left. Nothing is taken then.
    pub fn try_reserve(&self, bytes: u64, what: impl Display) -> Result<MemoryReservation, OverBudget> {
        let mut held = self.empty_reservation();
        held.try_grow(bytes, what)?;
        Ok(held)
    }

    /// Returns a reservation of 0 bytes, which can grow.
    pub fn empty_reservation(&self) -> MemoryReservation {
        MemoryReservation { budget: self.clone(), bytes: 0 }
    }
}

/// Reservation of bytes of a [`MemoryPool`]. Dropping it gives the bytes back.
#[derive(Debug)]
pub struct MemoryReservation {
    budget: MemoryPool,
    bytes: u64,
}

impl MemoryReservation {
    /// Takes more bytes.
    ///
    /// # Errors
    /// `bytes` exceeds the bytes that are left. Nothing is taken then.
    pub fn try_grow(&mut self, bytes: u64, what: impl Display) -> Result<(), OverBudget> {
        let PoolState { limit, advice, held, .. } = &*self.budget.0;
        let more = |before: u64| before.checked_add(bytes).filter(|sum| sum <= limit);
        let taken = held.fetch_update(Relaxed, Relaxed, more);
        taken.map_err(|held| OverBudget { what: what.to_string(), bytes, held, limit: *limit, advice })?;
        self.bytes += bytes;
        Ok(())
    }

    /// Makes room in a list for `more` items. A full list doubles its capacity.
    ///
    /// # Errors
    /// Errors of [`MemoryReservation::try_grow`].
    pub fn make_room<T>(&mut self, list: &mut Vec<T>, more: usize, what: impl Display) -> Result<(), OverBudget> {
        if list.capacity() - list.len() < more {
            let larger = list.capacity().max(more).max(16);
            self.try_grow(size_of::<T>() as u64 * larger as u64, what)?;
            list.reserve_exact(larger + list.capacity() - list.len());
        }
        Ok(())
    }

    /// Gives back all but this many bytes.
    pub fn shrink_to(&mut self, bytes: u64) {
        self.give_back(self.bytes.saturating_sub(bytes));
    }

    /// Gives back this many bytes, at most all.
    pub fn give_back(&mut self, bytes: u64) {
        let bytes = bytes.min(self.bytes);
        self.bytes -= bytes;
        self.budget.0.held.fetch_sub(bytes, Relaxed);
    }

    /// Returns the bytes taken.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Adds the bytes of another reservation.
    pub fn join(&mut self, mut other: Self) {
        self.bytes += std::mem::take(&mut other.bytes);
    }

    /// Keeps the bytes until the program ends.
    pub fn keep_forever(mut self) {
        self.bytes = 0;
    }
}

impl Drop for MemoryReservation {
    fn drop(&mut self) {
        self.shrink_to(0);
    }
}

/// Error of a request that exceeds the limit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OverBudget {
    /// Purpose of the request.
    what: String,
    bytes: u64,
    /// Bytes that were taken before.
    held: u64,
    limit: u64,
    advice: &'static str,
}

impl Display for OverBudget {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [bytes, held, limit] = [self.bytes, self.held, self.limit].map(ByteSize);
        let (what, advice) = (&self.what, self.advice);
        write!(f, "needs {bytes} for {what}, beside {held} in use: over the limit of {limit}; {advice}")
    }
}

impl std::error::Error for OverBudget {}

impl From<OverBudget> for io::Error {
    fn from(error: OverBudget) -> Self {
        Self::new(io::ErrorKind::OutOfMemory, error)
    }
}

impl OverBudget {
    /// Returns the limit error inside an I/O error, or `None` for another I/O error.
    pub fn in_io_error(error: &io::Error) -> Option<&Self> {
        error.get_ref()?.downcast_ref()
    }
}

/// Number of bytes that is shown as `1 GiB` or `1.5 MiB`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ByteSize(pub u64);

impl Display for ByteSize {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let unit = [("GiB", 30), ("MiB", 20), ("KiB", 10)].into_iter().find(|(_, bits)| self.0 >> bits > 0);
        let Some((unit, bits)) = unit else { return write!(f, "{} bytes", self.0) };
        // Tenths are rounded up, so that a size above a limit is not shown as the limit.
        match (u128::from(self.0) * 10).div_ceil(1 << bits) {
            tenths if tenths.is_multiple_of(10) => write!(f, "{} {unit}", tenths / 10),
            tenths => write!(f, "{}.{} {unit}", tenths / 10, tenths % 10),
        }
    }
}

impl std::str::FromStr for ByteSize {
    type Err = String;

    /// Parses a whole number of bytes, `KiB`, `MiB` or `GiB`.
    fn from_str(text: &str) -> Result<Self, String> {
        let units = [("KiB", 10), ("MiB", 20), ("GiB", 30)];
        let unit = units.into_iter().find_map(|(unit, bits)| Some((text.strip_suffix(unit)?, bits)));
        let (number, bits) = unit.unwrap_or((text, 0));
        let bytes = number.trim_end().parse::<u64>().ok().and_then(|n| n.checked_mul(1 << bits)).filter(|n| *n > 0);
        bytes.map(Self).ok_or_else(|| "expected bytes, or a number with KiB, MiB or GiB behind it, such as 4GiB".into())
    }
}

/// Writer into memory that counts bytes as they arrive.
#[derive(Debug)]
pub struct CountedBuffer {
    bytes: Vec<u8>,
    held: MemoryReservation,
    what: &'static str,
}

impl CountedBuffer {
    /// Creates an empty buffer.
    pub fn new(budget: &MemoryPool, what: &'static str) -> Self {
        Self { bytes: Vec::new(), held: budget.empty_reservation(), what }
    }

    /// Returns the bytes written and their reservation.
    pub fn into_parts(self) -> (Vec<u8>, MemoryReservation) {
        (self.bytes, self.held)
    }

    /// Returns the number of bytes written.
    pub fn len(&self) -> usize {
        self.bytes.len()
    }

    /// Returns true if nothing was written.
    pub fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }
}

impl Write for CountedBuffer {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.held.make_room(&mut self.bytes, bytes.len(), self.what)?;
        self.bytes.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Reads to the end and counts bytes as they arrive. `expected` is the number of bytes, or 0 if it is unknown.
///
/// # Errors
/// A failed read, or [`OverBudget`].
pub fn read_to_end(
    reader: &mut dyn Read,
    expected: u64,
    budget: &MemoryPool,
    what: &'static str,
) -> io::Result<(Vec<u8>, MemoryReservation)> {
    let mut all = CountedBuffer::new(budget, what);
    all.held.make_room(&mut all.bytes, usize::try_from(expected).unwrap_or(usize::MAX), what)?;
    io::copy(reader, &mut all)?;
    Ok(all.into_parts())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dropped_reservation_is_given_back() {
        let budget = MemoryPool::new(100);
        let mut a = budget.try_reserve(60, "texels").unwrap();
        assert_eq!(budget.clone().left(), 40);
        assert!(budget.try_reserve(41, "names").is_err());
        assert!(a.try_grow(u64::MAX, "names").is_err(), "no overflow");
        assert_eq!(budget.left(), 40, "what is refused is not taken");
        a.join(budget.try_reserve(40, "names").unwrap());
        a.give_back(30);
        assert_eq!((a.bytes(), budget.left()), (70, 30));
        drop(a);
        assert_eq!(budget.left(), 100);
        budget.try_reserve(7, "a scene").unwrap().keep_forever();
        assert_eq!(budget.left(), 93);
    }

    #[test]
    fn the_error_says_what_of_how_much_and_what_to_do() {
        let budget = MemoryPool::new(1 << 20);
        let _held = budget.try_reserve(1 << 19, "texels").unwrap();
        assert_eq!(
            budget.try_reserve(3 << 19, "names").unwrap_err().to_string(),
            "needs 1.5 MiB for names, beside 512 KiB in use: over the limit of 1 MiB; give more with --memory-limit, if \
             this input is to be trusted"
        );
        let other = MemoryPool::with_advice(5, "buy more").try_reserve(6, "names").unwrap_err().to_string();
        assert_eq!(other, "needs 6 bytes for names, beside 0 bytes in use: over the limit of 5 bytes; buy more");
    }

    #[test]
    fn a_list_grows_within_the_budget() {
        let budget = MemoryPool::new(1000);
        let (mut held, mut list) = (budget.empty_reservation(), Vec::<u32>::new());
        for i in 0.. {
            if held.make_room(&mut list, 1, "numbers").is_err() {
                break;
            }
            list.push(i);
            assert!(list.capacity() as u64 * 4 <= held.bytes());
        }
        assert_eq!(list.len(), 128, "512 bytes, and no room for 1024");
    }

    #[test]
    fn a_reader_is_read_no_further_than_the_budget_goes() {
        let budget = MemoryPool::new(1 << 16);
        let error = read_to_end(&mut io::repeat(0), 0, &budget, "a file").unwrap_err();
        assert!(OverBudget::in_io_error(&error).is_some(), "{error}");
        assert_eq!(budget.left(), 1 << 16);
        assert!(read_to_end(&mut io::empty(), u64::MAX, &budget, "a file").is_err(), "nor is what is announced believed");
        assert_eq!(read_to_end(&mut &b"abc"[..], 3, &budget, "a file").unwrap().0, b"abc");
    }

    #[test]
    fn sizes_are_shown_and_parsed() {
        let shown = [(7, "7 bytes"), (1024, "1 KiB"), (1025, "1.1 KiB"), (3 << 29, "1.5 GiB"), (u64::MAX, "17179869184 GiB")];
        for (bytes, text) in shown {
            assert_eq!(ByteSize(bytes).to_string(), text);
        }
        let read = [("7", 7), ("2KiB", 2048), ("3 MiB", 3 << 20), ("4GiB", 1 << 32)];
        for (text, bytes) in read {
            assert_eq!(text.parse(), Ok(ByteSize(bytes)), "{text}");
        }
        for wrong in ["", "0", "-1", "1.5GiB", "1GB", "99999999999GiB", "GiB"] {
            assert!(wrong.parse::<ByteSize>().is_err(), "{wrong}");
        }
    }
}
