//! Connections that count their traffic and bound the time for the head of a response.

use super::metrics::TransferMetrics;
use std::io;
use std::time::{Duration, Instant};
use ureq::unversioned::transport::{Buffers, ConnectionDetails, Connector, NextTimeout, Transport};

/// Counts the traffic of every connection. A timeout of one connection does not count while data arrives on another: the path is slow, and
/// the connection has to wait its turn.
#[derive(Debug)]
pub(super) struct CountingConnector(pub(super) TransferMetrics, pub(super) Duration);

impl<In: Transport> Connector<In> for CountingConnector {
    type Out = CountingTransport<In>;

    fn connect(&self, _: &ConnectionDetails<'_>, chained: Option<In>) -> Result<Option<Self::Out>, ureq::Error> {
        Ok(chained.map(|inner| {
            self.0.count_connection();
            CountingTransport { inner, meter: self.0.clone(), stall: self.1, head: HeadProgress::default() }
        }))
    }
}

/// Progress of the head of a response.
#[derive(Clone, Copy, Debug, Default)]
enum HeadProgress {
    /// No byte has arrived since the last request.
    #[default]
    Awaited,
    /// The first byte arrived at this time.
    Begun(Instant),
    /// The head is complete.
    Complete,
}

/// A counted connection.
#[derive(Debug)]
pub(super) struct CountingTransport<In> {
    inner: In,
    meter: TransferMetrics,
    /// Longest time without data on any connection, and for a head from its first byte.
    stall: Duration,
    head: HeadProgress,
}

impl<In: Transport> CountingTransport<In> {
    /// Follows the head in the input, which stays there until it is complete.
    fn follow_head(&mut self) {
        let input = self.inner.buffers().input();
        // An informational response, such as 103, has a head of its own before that of the response.
        let is_last = !input.starts_with(b"HTTP/1.1 1") && !input.starts_with(b"HTTP/1.0 1");
        let is_complete = is_last && input.windows(4).any(|end| end == b"\r\n\r\n");
        self.head = match self.head {
            HeadProgress::Awaited if input.is_empty() => HeadProgress::Awaited,
            HeadProgress::Awaited | HeadProgress::Begun(_) if is_complete => HeadProgress::Complete,
            HeadProgress::Awaited => HeadProgress::Begun(Instant::now()),
            head => head,
        };
    }

    /// Returns an error if the head takes too long.
    fn check_head(&self) -> Result<(), ureq::Error> {
        match self.head {
            HeadProgress::Begun(began) if began.elapsed() > self.stall => {
                let sentence = format!("too slow: the head of the answer takes more than {} s", self.stall.as_secs_f64());
                Err(io::Error::new(io::ErrorKind::TimedOut, sentence).into())
            }
            _ => Ok(()),
        }
    }
}

impl<In: Transport> Transport for CountingTransport<In> {
    fn buffers(&mut self) -> &mut dyn Buffers {
        self.inner.buffers()
    }

    fn transmit_output(&mut self, amount: usize, timeout: NextTimeout) -> Result<(), ureq::Error> {
        self.meter.count_sent(amount);
        self.head = HeadProgress::Awaited;
        self.inner.transmit_output(amount, timeout)
    }

    fn await_input(&mut self, timeout: NextTimeout) -> Result<bool, ureq::Error> {
        let before = self.inner.buffers().input().len();
        let came = loop {
            match self.inner.await_input(timeout) {
                Err(ureq::Error::Timeout(_)) if self.meter.came_within(self.stall) => self.check_head()?,
                came => break came?,
            }
        };
        self.meter.count_received(self.inner.buffers().input().len().saturating_sub(before));
        self.follow_head();
        self.check_head()?;
        Ok(came)
    }

    fn is_open(&mut self) -> bool {
        self.inner.is_open()
    }
}
