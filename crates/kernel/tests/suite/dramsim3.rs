//! Comparison with another simulator: cycles per burst of eight request streams in DRAMsim3.
//!
//! DRAMsim3 (Li et al., IEEE CAL 2020), DDR3-800: 6-6-6, one rank of 8 banks, 2 KiB rows, 64-byte bursts, refresh off; 4,000 to
//! 8,000 bursts as fast as the credits allow. The law here has the same timing, a window of 32 and a cap of 16. With few requests
//! in flight the two differ more, because DRAMsim3 answers a write on acceptance, and the law after its data have moved. (The
//! figures of DRAMsim3 do not state the addresses of alternating streams. `FAR` is our choice.)

use basrelief_kernel::{Demand, Engine, Machine, MemoryConfig, MemoryPorts, MemorySystem, Stage, Step, Unit, Visitor, run};

const BURSTS: u64 = 8_000;

/// Maps a request number to its address and to true for a write.
type Stream = fn(u64) -> (u64, bool);

/// Issues one request of one burst per step.
struct Requester(Stream, u64);

impl Unit for Requester {
    type In = ();
    type Out = ();
    fn demand(&self) -> Demand {
        if self.1 < BURSTS { Demand::Nothing } else { Demand::Finished }
    }
    fn step(&mut self, (): (), traffic: &mut MemoryPorts) -> Step<()> {
        let (address, write) = self.0(self.1);
        if write {
            traffic.write(0, address, 64)
        } else {
            traffic.read(0, address, 64)
        }
        self.1 += 1;
        Step::after(0, ())
    }
    fn largest_step(&self, client: usize) -> u32 {
        u32::from(client == 0)
    }
    fn is_empty(&self) -> bool {
        self.1 == BURSTS
    }
}

struct Rig(Stage<Requester>, MemorySystem, [usize; 1]);

impl Machine for Rig {
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        v.stage(self.0.between((), ()).using(&mut self.1, &self.2));
    }
    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.1
    }
}

fn cycles_per_burst(stream: Stream, outstanding: u32, engine: Engine) -> f64 {
    let ddr3_800 = MemoryConfig {
        channels: 1,
        window: 32,
        cap: 16,
        cl: 6,
        cwl: 5,
        rcd: 6,
        rp: 6,
        ras: 15,
        rtp: 4,
        wr: 6,
        wtr: 4,
        rrd: 4,
        faw: 20,
        refi: 0,
        rfc: 0,
        burst_bytes: 64,
        burst_cycles: 4,
        banks: 8,
        row_bytes: 2048,
        ..MemoryConfig::default()
    };
    let mut memories = MemorySystem::default();
    let memory = memories.add_memory("ddr3-800", &ddr3_800);
    let client = memories.add_client("requests", memory, outstanding);
    let mut rig = Rig(Stage::new("requester", Requester(stream, 0)), memories, [client]);
    run(&mut rig, engine).total as f64 / BURSTS as f64
}

const ROW: u64 = 2048;
const BANKS: u64 = 8;
/// Distance from a stream to the stream that alternates with it, in rows of the same banks.
const FAR: u64 = 1 << 25;

/// Every second request belongs to the second stream.
fn in_turn(n: u64, second: u64) -> u64 {
    n / 2 * 64 + n % 2 * second
}

/// Two alternating streams through rows of bank 0, the second far from the first.
fn in_one_bank(n: u64) -> u64 {
    let at = n / 2 * 64;
    at / ROW * (BANKS * ROW) + at % ROW + n % 2 * FAR
}

fn scattered(n: u64) -> u64 {
    n * 64 * 10_007 % (1 << 26)
}

/// A stream, its cycles per burst in DRAMsim3 with 8 and with 32 requests in flight, and the allowed relative difference of the
/// law at 32.
const TABLE: [(&str, Stream, [f64; 2], f64); 8] = [
    ("sequential reads", |n| (n * 64, false), [4.03, 4.00], 0.07),
    ("sequential writes", |n| (n * 64, true), [3.94, 3.94], 0.07),
    ("two reads in turn, other banks", |n| (in_turn(n, FAR + 4 * ROW), false), [4.02, 4.02], 0.07),
    ("two reads in turn, rows of one bank", |n| (in_one_bank(n), false), [6.70, 4.93], 0.12),
    ("copy to other banks", |n| (in_turn(n, FAR + 4 * ROW), n % 2 == 1), [4.17, 4.18], 0.07),
    ("scattered reads", |n| (scattered(n), false), [5.12, 5.00], 0.07),
    ("scattered reads and writes in turn", |n| (scattered(n / 2) + n % 2 * FAR, n % 2 == 1), [5.94, 5.52], 0.07),
    ("stride 2,560", |n| (n * 2560, false), [5.25, 5.00], 0.07),
];

#[test]
fn streams_take_the_cycles_of_dramsim3() {
    println!("{:<36} {:>5} {:>8} {:>5} {:>8}", "cycles per burst", "8", "DRAMsim3", "32", "DRAMsim3");
    for (name, stream, theirs, within) in TABLE {
        let ours = [8, 32].map(|outstanding| cycles_per_burst(stream, outstanding, Engine::Timed));
        println!("{name:<36} {:>5.2} {:>8.2} {:>5.2} {:>8.2}", ours[0], theirs[0], ours[1], theirs[1]);
        let apart = (ours[1] / theirs[1] - 1.0).abs();
        assert!(apart <= within, "{name}: {:.2} cycles per burst, DRAMsim3 {:.2}", ours[1], theirs[1]);
    }
}

#[test]
fn both_engines_serve_the_streams_alike() {
    for (name, stream, ..) in TABLE {
        let [timed, ticked] = [Engine::Timed, Engine::Ticked].map(|engine| cycles_per_burst(stream, 32, engine));
        assert_eq!(timed.to_bits(), ticked.to_bits(), "{name}");
    }
}
