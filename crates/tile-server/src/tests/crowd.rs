//! Many simultaneous clients.

use super::*;
use crate::server::ServerLimits;
use std::io::Read as _;
use std::sync::mpsc::channel;
use std::time::Instant;

/// Simultaneous clients. Each keeps as many connections as it has requests in flight.
const CLIENTS: usize = 20;
const IN_FLIGHT: u32 = 8;
/// Connection limit: a tenth of the connections that the clients would keep.
const CONNECTIONS: usize = 16;

// Claim: defer, server under load: Clients with ten times the allowed connections receive every tile. Threads and memory do not
// grow with clients. A killed client, a restarted server and a full disk lose no received tile.
#[test]
fn crowded_clients_get_every_tile() {
    let limits = ServerLimits { connections: CONNECTIONS, ..ServerLimits::default() };
    let (address, _server) = served().listen(([127, 0, 0, 1], 0).into(), limits).unwrap();
    let page = Arc::new(TexturePage::new(0, &texture(), PyramidCut { tile: [16, 16], ..PyramidCut::default() }, 0));
    let tiles: Vec<_> = (0..page.tiles()).map(|tile| (Arc::clone(&page), tile)).collect();
    let mut model = TextureMemory::new(TileEncoding::Raw, 100);
    model.offer(&texture());
    let expected: Vec<_> = (0..page.tiles()).map(|tile| model.tile(&page, tile).unwrap()).collect();
    let look_around = &|client: usize| {
        let fetcher = new_fetcher(&format!("http://{address}"), RetryPolicy::default());
        let meter = fetcher.metrics().clone();
        let format = TileFormat { size: [16, 16], encoding: TileEncoding::Raw, quality: 100 };
        let fetch = TileFetch { format, ..fetch(IN_FLIGHT, 1) };
        let mut source = source_without_cache(fetcher, fetch);
        source.offer(&texture_without_texels());
        source.announce(&tiles);
        for (number, expected) in expected.iter().enumerate() {
            assert_eq!(source.tile(&page, number as u32).as_ref(), Ok(expected), "client {client}, tile {number}");
        }
        meter.read().requests as usize - expected.len()
    };
    let again: usize = thread::scope(|scope| {
        let clients: Vec<_> = (0..CLIENTS).map(|client| scope.spawn(move || look_around(client))).collect();
        clients.into_iter().map(|client| client.join().unwrap()).sum()
    });
    assert!(again < CLIENTS * tiles.len() / 100, "{again} requests were lost by connections closed on them");
}

// Claim: as crowded_clients_get_every_tile.
#[test]
fn concurrent_requests_compute_a_sum_once() {
    let served = Arc::new(served());
    let asked = format!("/bytes/{}/64x64/png/2", hex(&hash_of_picture(&texture())));
    let body = move |served: &SceneService| served.bytes(asked.trim_start_matches("/bytes/")).unwrap().0;
    let first = body(&served);
    let (tell, told) = channel();
    let again = Arc::clone(&served);
    // A second computation would wait for the lock of this picture.
    let _under_work = served.pictures[&hex(&hash_of_picture(&texture()))].pyramid.lock().unwrap();
    thread::spawn(move || tell.send(body(&again)));
    assert_eq!(told.recv_timeout(Duration::from_secs(20)), Ok(first));
}

/// Clients that request large tiles and read slowly share a bounded amount of memory, and an honest client is served at once.
#[test]
fn slow_readers_delay_no_honest_client() {
    let texels = vec![[7, 8, 9, 255]; 512 * 512];
    let large = Arc::new(Texture { levels: vec![Image { width: 512, height: 512, texels }], ..Texture::clone(&texture()) });
    let asked = format!("/tile/{}/512x512/raw/", hex(&hash_of_picture(&large)));
    let last = TexturePage::new(0, &large, PyramidCut { tile: [512, 512], ..PyramidCut::default() }, 0).tiles() - 1;
    let service = SceneService::new(b"scene".to_vec(), String::new(), [texture(), large]);
    // Room for four large bodies.
    let limits = ServerLimits { connections: 64, bodies: 4 << 20, ..ServerLimits::default() };
    let (at, _server) = service.listen(([127, 0, 0, 1], 0).into(), limits).unwrap();
    // More responses than the buffers of the operating system take.
    let requests = format!("GET {asked}{last} HTTP/1.1\r\nHost: localhost\r\n\r\n").repeat(16);
    for _ in 0..40 {
        let (requests, mut bytes) = (requests.clone(), [0; 4096]);
        // Each reads 80 kB/s, never stops, and comes back when it is evicted.
        thread::spawn(move || {
            while let Ok(mut slow) = TcpStream::connect(at) {
                let mut sent = slow.write_all(requests.as_bytes()).map(|()| 1);
                while sent.is_ok_and(|n| n > 0) {
                    thread::sleep(Duration::from_millis(50));
                    sent = slow.read(&mut bytes);
                }
            }
        });
    }
    thread::sleep(Duration::from_secs(2));
    for number in 0..5 {
        let began = Instant::now();
        let mut honest = TcpStream::connect(at).unwrap();
        write!(honest, "GET {asked}{last} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n").unwrap();
        let mut answer = Vec::new();
        honest.read_to_end(&mut answer).unwrap();
        assert!(answer.starts_with(b"HTTP/1.1 200"), "{}", String::from_utf8_lossy(&answer));
        assert!(began.elapsed() < Duration::from_secs(3), "{number}: {:?}", began.elapsed());
    }
}
