//! A shaped path on loopback: a relay that lets so many bits per second pass each way, each byte so much later.

use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Bytes that travel as one: of a packet of Ethernet.
const PACKET: usize = 1460;

/// One direction of the path, which all connections share: when it has carried what it was given.
#[derive(Debug)]
struct Way {
    bits_per_second: f64,
    /// From one end to the other.
    delay: Duration,
    free: Mutex<Instant>,
}

impl Way {
    /// When so many bytes that are given now come out at the other end.
    fn carry(&self, bytes: usize) -> Instant {
        let mut free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        let takes = Duration::from_secs_f64(8.0 * bytes as f64 / self.bits_per_second);
        *free = Instant::now().max(*free) + takes;
        *free + self.delay
    }
}

/// Listens at an address of its own, and passes everything on to and from `server`, an address with its port. Its own address. Half of
/// the latency lies each way. It goes on to the end of the program.
pub fn relay(server: &str, bits_per_second: f64, latency: Duration) -> std::io::Result<String> {
    let listener = TcpListener::bind("127.0.0.1:0")?;
    let own = listener.local_addr()?.to_string();
    let server = server.to_owned();
    let way = || Arc::new(Way { bits_per_second, delay: latency / 2, free: Mutex::new(Instant::now()) });
    let ways = [way(), way()];
    thread::spawn(move || {
        for client in listener.incoming().flatten() {
            // A server that is gone is to the client as if the path ended there.
            if let Ok(server) = TcpStream::connect(&server) {
                let _ = pass(&client, &server, &ways[0]).and_then(|()| pass(&server, &client, &ways[1]));
            }
        }
    });
    Ok(own)
}

/// Passes on what comes from one to the other, on a way, from now on.
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

/// Writes each packet when its time has come.
fn deliver(take: &Receiver<(Instant, Vec<u8>)>, mut to: TcpStream) {
    for (at, packet) in take {
        thread::sleep(at.saturating_duration_since(Instant::now()));
        if to.write_all(&packet).is_err() {
            break;
        }
    }
    // Who is gone needs no telling.
    let _ = to.shutdown(Shutdown::Write);
}
