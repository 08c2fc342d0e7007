//! A shaped path on loopback: a relay with a limited rate and a latency in each direction.

use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Bytes per packet, as in Ethernet.
const PACKET: usize = 1460;

/// One direction of the path, shared by all connections. `free` is the time at which it has sent all bytes given to it.
#[derive(Debug)]
struct Way {
    bits_per_second: f64,
    /// Latency from end to end.
    delay: Duration,
    free: Mutex<Instant>,
}

impl Way {
    /// Returns the time at which bytes sent now arrive at the other end.
    fn carry(&self, bytes: usize) -> Instant {
        let mut free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        let takes = Duration::from_secs_f64(8.0 * bytes as f64 / self.bits_per_second);
        *free = Instant::now().max(*free) + takes;
        *free + self.delay
    }
}

/// Starts a relay to `server`, an address with its port, and returns the relay's own address. Each direction has half of the
/// latency. The relay runs until the program ends.
pub fn relay(server: &str, bits_per_second: f64, latency: Duration) -> std::io::Result<String> {
    let listener = TcpListener::bind("127.0.0.1:0")?;
    let own = listener.local_addr()?.to_string();
    let server = server.to_owned();
    let way = || Arc::new(Way { bits_per_second, delay: latency / 2, free: Mutex::new(Instant::now()) });
    let ways = [way(), way()];
    thread::spawn(move || {
        for client in listener.incoming().flatten() {
            // If the server does not listen, the client's connection closes.
            if let Ok(server) = TcpStream::connect(&server) {
                let _ = pass(&client, &server, &ways[0]).and_then(|()| pass(&server, &client, &ways[1]));
            }
        }
    });
    Ok(own)
}

/// Starts to forward bytes from one stream to the other, over one direction of the path.
fn pass(from: &TcpStream, to: &TcpStream, way: &Arc<Way>) -> std::io::Result<()> {
    let (mut from, to, way) = (from.try_clone()?, to.try_clone()?, Arc::clone(way));
    to.set_nodelay(true)?;
    let (give, take) = channel();
    thread::spawn(move || {
        let mut packet = [0; PACKET];
        while let Ok(n @ 1..) = from.read(&mut packet)
            && give.send((way.carry(n), packet[..n].to_vec())).is_ok()
        {}
    });
    thread::spawn(move || deliver(&take, to));
    Ok(())
}

/// Writes each packet at its arrival time.
fn deliver(take: &Receiver<(Instant, Vec<u8>)>, mut to: TcpStream) {
    for (at, packet) in take {
        thread::sleep(at.saturating_duration_since(Instant::now()));
        if to.write_all(&packet).is_err() {
            break;
        }
    }
    // The client may have disconnected already.
    let _ = to.shutdown(Shutdown::Write);
}
