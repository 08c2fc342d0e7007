//! Measures clients that look around simultaneously on one server: a table of docs/experiments/defer.md.
//!
//! ```text
//! cargo run --release -p basrelief-cli --example many_clients -- [--seconds S] [OPTION of `run`...]
//! ```
//!
//! Each client turns around the scene in successive views. For each view it fetches the missing tiles that `basrelief run` would
//! load, with as many requests in flight. After a full turn it starts again without tiles. Every client starts at a different
//! view. The example compares the received tiles with those that the model's own server makes. Cargo builds `basrelief` with the
//! example, which runs it from the folder above its own.

mod common;

use basrelief_deferred_renderer::{PyramidCut, TextureMemory, TexturePage, TileSource as _};
use basrelief_scene::SceneSubject;
use basrelief_signals::Texture;
use basrelief_tile_server::protocol::{hash_of, hash_of_picture, hex, parse_format};
use common::{Server, program};
use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};
use ureq::Agent;

const SCENE: &str = "demo:gallery";
const CLIENTS: [usize; 3] = [1, 10, 100];
/// Views of a full turn.
const VIEWS: usize = 12;
/// Requests in flight per client: the default of `path.requests`.
const IN_FLIGHT: usize = 8;
/// Attempts per request, as in `run --from`.
const ATTEMPTS: u32 = 5;
const PAUSE: Duration = Duration::from_millis(100);
/// Interval at which the server's threads are counted.
const LOOK: Duration = Duration::from_millis(20);

type Failed = Box<dyn Error>;

/// Tiles of a view: their addresses and expected hashes.
type View = Vec<(String, Arc<str>)>;

fn main() -> Result<(), Failed> {
    let mut options: Vec<String> = std::env::args().skip(1).collect();
    let mut seconds = 10.0;
    if options.first().is_some_and(|option| option == "--seconds") {
        seconds = options.get(1).ok_or("--seconds: expected a number")?.parse()?;
        options.drain(..2);
    }
    let program = program()?;
    let views = views(&program, &options)?;
    println!(
        "| clients | connections | tiles/s | MB/s | p50 | p99 | longest | asked again | lost | wrong | server: threads | memory | processor time of a tile |"
    );
    println!("|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|");
    for clients in CLIENTS {
        println!("{}", row(&program, &views, clients, Duration::from_secs_f64(seconds))?);
    }
    Ok(())
}

/// Returns the tiles of each view: the addresses that a run loads, and the hashes that the model expects.
fn views(program: &Path, options: &[String]) -> Result<Vec<View>, Failed> {
    let server = Server::start(program, SCENE)?;
    let folder = std::env::temp_dir().join(format!("many-clients-{}", std::process::id()));
    let mut model = Model::new()?;
    let mut views = Vec::new();
    for number in 0..VIEWS {
        let (kept, out) = (folder.join(format!("tiles-{number}")), folder.join("out"));
        let turn = format!("{},0", 360 * number / VIEWS);
        let from = format!("http://{}/", server.address);
        let mut run = Command::new(program);
        run.args(["run", "--from", &from, "--size", "640x480", "--turn", &turn, "--no-bottlenecks", "--quiet"]).args(options);
        let done = run.arg("--tile-cache").arg(&kept).arg("--out").arg(&out).status()?;
        if !done.success() {
            return Err(format!("{run:?}: {done}").into());
        }
        let mut view = Vec::new();
        for file in std::fs::read_dir(&kept)? {
            let address = file?.file_name().to_string_lossy().replace('-', "/").replace("jpeg/", "jpeg-");
            let hash = model.hash_of_tile(&address)?;
            view.push((address, hash));
        }
        views.push(view);
    }
    std::fs::remove_dir_all(&folder)?;
    Ok(views)
}

/// The server of the model, which holds the texels in memory.
struct Model {
    /// Textures by the hash of their picture.
    textures: BTreeMap<String, Arc<Texture>>,
    hashes: BTreeMap<String, Arc<str>>,
}

impl Model {
    fn new() -> Result<Self, Failed> {
        let subject = SceneSubject::demo(SCENE.trim_start_matches("demo:"))?;
        let textures = subject.objects().iter().filter_map(|object| object.material.color_texture.clone());
        let textures = textures.map(|texture| (hex(&hash_of_picture(&texture)), texture)).collect();
        Ok(Self { textures, hashes: BTreeMap::new() })
    }

    /// Returns the expected hash of `tile/PICTURE/WIDTHxHEIGHT/ENCODING/NUMBER`.
    fn hash_of_tile(&mut self, address: &str) -> Result<Arc<str>, Failed> {
        if let Some(hash) = self.hashes.get(address) {
            return Ok(Arc::clone(hash));
        }
        let parts: Vec<&str> = address.split('/').collect();
        let [_, picture, size, encoding, number] = parts[..] else { return Err(format!("{address}: no tile").into()) };
        let texture = self.textures.get(picture).ok_or("a picture of another scene")?;
        let format = parse_format(&format!("{size}/{encoding}")).ok_or("another format of tiles")?;
        let cut = PyramidCut { tile: format.size, ..PyramidCut::default() };
        let mut memory = TextureMemory::new(format.encoding, format.quality);
        memory.offer(texture);
        let tile = memory.tile(&Arc::new(TexturePage::new(0, texture, cut, 0)), number.parse()?)?;
        let hash: Arc<str> = hash_of(&tile).into();
        self.hashes.insert(address.into(), Arc::clone(&hash));
        Ok(hash)
    }
}

/// Results of clients.
#[derive(Default)]
struct Seen {
    /// Duration of each answered request.
    times: Vec<Duration>,
    bytes: u64,
    again: u64,
    lost: u64,
    wrong: u64,
}

impl Seen {
    fn add(mut self, other: Self) -> Self {
        self.times.extend(other.times);
        self.bytes += other.bytes;
        self.again += other.again;
        self.lost += other.lost;
        self.wrong += other.wrong;
        self
    }

    /// Requests one tile, and retries after a failure.
    fn fetch(&mut self, agent: &Agent, url: &str, hash: &str) {
        for attempt in 0..ATTEMPTS {
            let began = Instant::now();
            let tile = agent.get(url).call().and_then(|mut answer| answer.body_mut().read_to_vec());
            if let Ok(tile) = tile {
                self.times.push(began.elapsed());
                self.bytes += tile.len() as u64;
                self.wrong += u64::from(hash_of(&tile) != hash);
                return;
            }
            self.again += 1;
            thread::sleep(PAUSE * (1 << attempt));
        }
        self.lost += 1;
    }
}

/// Runs one client until a time, starting at view `first`.
fn look_around(base: &str, views: &[View], first: usize, until: Instant) -> Seen {
    let config = Agent::config_builder().max_idle_connections(IN_FLIGHT).max_idle_connections_per_host(IN_FLIGHT);
    let agent = config.timeout_global(Some(Duration::from_secs(60))).build().new_agent();
    let (mut seen, mut has) = (Seen::default(), BTreeSet::new());
    for step in 0.. {
        if step % views.len() == 0 {
            has.clear();
        }
        let view = &views[(first + step) % views.len()];
        let wanted: Vec<_> = view.iter().filter(|(address, _)| has.insert(address)).collect();
        let next = AtomicUsize::new(0);
        let fetch = || {
            let mut seen = Seen::default();
            while Instant::now() < until
                && let Some((address, hash)) = wanted.get(next.fetch_add(1, Ordering::Relaxed))
            {
                seen.fetch(&agent, &format!("{base}/{address}"), hash);
            }
            seen
        };
        let all = thread::scope(|scope| {
            let workers: Vec<_> = (0..IN_FLIGHT).map(|_| scope.spawn(fetch)).collect();
            workers.into_iter().map(|worker| worker.join().expect("a worker")).fold(Seen::default(), Seen::add)
        });
        seen = seen.add(all);
        if Instant::now() >= until {
            break;
        }
    }
    seen
}

/// Runs this many clients simultaneously and returns a row of the table.
fn row(program: &Path, views: &[View], clients: usize, lasts: Duration) -> Result<String, Failed> {
    let server = Server::start(program, SCENE)?;
    let (base, pid) = (format!("http://{}", server.address), server.process.id());
    let (before, began) = (milliseconds(pid), Instant::now());
    let mut threads = 0;
    let seen = thread::scope(|scope| {
        let client = |number| look_around(&base, views, number, began + lasts);
        let all: Vec<_> = (0..clients).map(|number| scope.spawn(move || client(number))).collect();
        while all.iter().any(|client| !client.is_finished()) {
            threads = threads.max(status(pid, "Threads"));
            thread::sleep(LOOK);
        }
        all.into_iter().map(|client| client.join().expect("a client")).fold(Seen::default(), Seen::add)
    });
    let (took, busy) = (began.elapsed().as_secs_f64(), milliseconds(pid) - before);
    let mut times = seen.times;
    times.sort();
    let tiles = times.len().max(1);
    let rank = |share: f64| times.get(((tiles as f64 * share).ceil() as usize).max(1) - 1).map_or(0.0, |t| 1e3 * t.as_secs_f64());
    Ok(format!(
        "| {clients} | {} | {:.0} | {:.1} | {:.2} ms | {:.2} ms | {:.0} ms | {} | {} | {} | {threads} | {:.0} MB | {:.0} us |",
        clients * IN_FLIGHT,
        times.len() as f64 / took,
        seen.bytes as f64 / took / 1e6,
        rank(0.5),
        rank(0.99),
        rank(1.0),
        seen.again,
        seen.lost,
        seen.wrong,
        status(pid, "VmHWM") as f64 * 1024.0 / 1e6,
        1e3 * busy as f64 / tiles as f64,
    ))
}

/// Returns a number of `/proc/PID/status`, or 0 if there is no such file. `VmHWM` is the peak memory \[KiB\].
fn status(pid: u32, name: &str) -> u64 {
    let text = std::fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(':'));
    line.and_then(|rest| rest.split_whitespace().next()?.parse().ok()).unwrap_or(0)
}

/// Returns the processor time of a process \[ms\] from `/proc/PID/stat`, which counts hundredths of a second.
fn milliseconds(pid: u32) -> u64 {
    let text = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
    let fields: Vec<&str> = text.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    fields.iter().skip(11).take(2).filter_map(|ticks| ticks.parse::<u64>().ok()).sum::<u64>() * 10
}
