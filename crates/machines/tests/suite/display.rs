//! Display of all machines: memory holds the pictures, scan-out reads the front buffer, and frames wait for a free buffer.

use crate::common::trace::frame;
use crate::common::{config, replay, same, scene_front, small_demo};
use basrelief_kernel::{Engine, Machine, MemoryRequest, Outcome, RunLimits};
use basrelief_machines::bump::BumpProcessorConfig;
use basrelief_machines::defer::DeferConfig;
use basrelief_machines::shade::ShadeConfig;
use basrelief_machines::texel::TexelMachineConfig;
use basrelief_machines::{FrontEnd, MachineEngines as _, MachineSpec};
use basrelief_signals::{Control, layout};
use std::collections::{BTreeMap, BTreeSet};

/// Calls a generic function for each machine.
macro_rules! each_machine {
    ($function:ident($($argument:expr),*)) => {{
        $function::<BumpProcessorConfig>($($argument),*);
        $function::<ShadeConfig>($($argument),*);
        $function::<TexelMachineConfig>($($argument),*);
        $function::<DeferConfig>($($argument),*);
    }};
}

/// Name of the client, arrival, address.
type Accesses = Vec<(String, u64, u64)>;

/// Runs a machine, and returns the requests of all clients with its report.
fn recorded<S: MachineSpec>(front: FrontEnd, config: &S) -> (Accesses, basrelief_kernel::RunReport) {
    let mut machine = config.build(front).unwrap();
    machine.memories().keep_requests();
    let mut all: Vec<MemoryRequest> = Vec::new();
    let report = machine.run_with(Engine::Timed, None, RunLimits { max_cycles: u64::MAX, progress: &mut |_| true });
    assert_eq!(report.outcome, Outcome::Complete);
    all.extend(machine.memories().take_requests().flat_map(|(_, requests)| requests));
    let names: Vec<String> = machine.memories().client_names().map(str::to_owned).collect();
    (all.into_iter().map(|r| (names[r.client].clone(), r.arrival.0, r.address)).collect(), report)
}

/// Returns the lines that each frame writes, by frame, with the buffer. Neighbouring frames have different buffers.
fn written(accesses: &Accesses) -> Vec<(u64, BTreeSet<u64>)> {
    let mut frames: Vec<(u64, BTreeSet<u64>)> = Vec::new();
    for (_, _, address) in accesses.iter().filter(|(client, ..)| client == "pixel_write") {
        let buffer = address >> 27 << 27;
        if frames.last().is_none_or(|(last, _)| *last != buffer) {
            frames.push((buffer, BTreeSet::new()));
        }
        frames.last_mut().unwrap().1.insert((address - buffer) / 64);
    }
    frames
}

/// Asserts that each of `count` pictures of 64 x 48 pixels is written whole, in its buffer of the swap chain.
fn assert_whole(accesses: &Accesses, count: u64, name: &str) {
    let whole = |number: u64| (layout::color_buffer(number % 2), (0..64 * 48 / 16).collect::<BTreeSet<u64>>());
    assert_eq!(written(accesses), (0..count).map(whole).collect::<Vec<_>>(), "{name}");
}

fn empty_frames(count: u32) -> Vec<Control> {
    (0..count).flat_map(|index| [frame(index, [64, 48], vec![]), Control::FrameEnd]).collect()
}

/// Loads a configuration with one buffer per picture, and with a fast path.
fn plain<S: MachineSpec>(more: &[(&str, &str)]) -> S {
    let own = [
        ("defer.depth_pixel", "separate"),
        ("defer.mode", "best"),
        ("path.bits_per_second", "30000000000"),
        ("path.latency_us", "0"),
    ];
    let own = if S::FETCHES_TILES { &own[..] } else { &[] };
    config(&[own, more].concat())
}

fn empty_view_is_written<S: MachineSpec>() {
    let config: S = plain(&[]);
    let (accesses, _) = recorded(replay(&empty_frames(4), config.front()), &config);
    assert_whole(&accesses, 4, S::NAME);
}

// Claim: as frame_without_pixels_is_cleared_by_writes.
#[test]
fn empty_view_is_written_whole_in_every_frame() {
    each_machine!(empty_view_is_written());
}

fn later_frames_are_written<S: MachineSpec>() {
    let config: S = plain(&[]);
    let (accesses, _) = recorded(scene_front(&small_demo(S::DEMOS[0], 4), config.front()), &config);
    assert_whole(&accesses, 4, S::NAME);
}

#[test]
fn later_frames_leave_no_old_line() {
    each_machine!(later_frames_are_written());
}

/// A refresh of 48,000 cycles or more, with 12 reads of 1 KiB, the size of a picture of 64 x 48 pixels.
fn slow_display<S: MachineSpec>(mode: &'static str, more: &[(&str, &str)]) -> S {
    let hz = basrelief_parameters::to_json(&S::default()).unwrap()["clock"]["hz"].as_u64().unwrap();
    let (refresh_hz, pixel_hz) = (hz / 48_000, hz / 48_000 * 64 * 48);
    let [refresh_hz, pixel_hz] = [refresh_hz, pixel_hz].map(|n| n.to_string());
    let own = [
        ("display.mode", mode),
        ("display.refresh_hz", &refresh_hz),
        ("display.pixel_hz", &pixel_hz),
        ("display.burst_bytes", "1024"),
    ];
    plain(&[&own, more].concat())
}

fn front_buffer_is_read<S: MachineSpec>() {
    let config: S = slow_display("fifo", &[]);
    let (accesses, report) = recorded(replay(&empty_frames(4), config.front()), &config);
    let mut by_refresh: BTreeMap<u64, BTreeSet<u64>> = BTreeMap::new();
    let reads: Vec<_> = accesses.iter().filter(|(client, ..)| client == "scan_out").collect();
    let period = reads[1].1 - reads[0].1;
    for (_, at, address) in &reads {
        by_refresh.entry(at / (12 * period)).or_default().insert(address >> 27 << 27);
    }
    // Frame 0 is drawn into buffer 0 while buffer 1 is read. No refresh reads two buffers.
    let buffers: Vec<u64> = by_refresh
        .values()
        .flat_map(|buffers| {
            assert_eq!(buffers.len(), 1, "{}", S::NAME);
            buffers.iter().copied()
        })
        .collect();
    let expected: Vec<u64> = (0..buffers.len() as u64).map(|refresh| layout::color_buffer((refresh + 1) % 2)).collect();
    assert_eq!(buffers, expected, "{}", S::NAME);
    // Frame k is shown in refresh k + 1, and frame k + 2 is written from then on.
    for (frame, (buffer, _)) in written(&accesses).iter().enumerate().skip(1) {
        let first = accesses.iter().filter(|(client, at, address)| {
            client == "pixel_write" && address >> 27 << 27 == *buffer && *at >= frame as u64 * 12 * period
        });
        let own: Vec<u64> = first.map(|(_, at, _)| *at / (12 * period)).collect();
        assert!(own.contains(&(frame as u64)), "{}: frame {frame} is written in {own:?}", S::NAME);
    }
    assert!(report.total < 4 * 12 * period, "{}: the last flip does not count", S::NAME);
}

// Claim: images, swap chain: In fifo mode each frame waits for a free buffer, and scan-out reads the front buffer only.
#[test]
fn fifo_mode_shows_one_frame_per_refresh() {
    each_machine!(front_buffer_is_read());
}

fn total<S: MachineSpec>(config: &S) -> u64 {
    recorded(replay(&empty_frames(4), config.front()), config).1.total
}

fn immediate_flips_do_not_wait<S: MachineSpec>() {
    let [fifo, many, immediate] =
        [slow_display::<S>("fifo", &[]), slow_display("fifo", &[("display.buffers", "6")]), slow_display("immediate", &[])]
            .map(|config| total(&config));
    assert!(immediate < fifo && many < fifo, "{}: {immediate} {many} {fifo}", S::NAME);
}

#[test]
fn immediate_mode_does_not_wait_for_refresh() {
    each_machine!(immediate_flips_do_not_wait());
}

fn engines_agree<S: MachineSpec>() {
    for more in [&[][..], &[("display.buffers", "3"), ("depth.clear_flags", "false")]] {
        let config: S = slow_display("fifo", more);
        let scene = small_demo(S::DEMOS[0], 3);
        let [timed, ticked] = [Engine::Timed, Engine::Ticked]
            .map(|engine| crate::common::run(config.build(scene_front(&scene, config.front())).unwrap(), engine));
        same(&timed.report, &ticked.report);
        assert!(timed.frames == ticked.frames);
    }
}

#[test]
fn engines_agree_on_flips_of_every_machine() {
    each_machine!(engines_agree());
}

#[test]
fn shared_picture_is_held_until_it_is_read() {
    let config: DeferConfig = slow_display("fifo", &[("defer.depth_pixel", "shared"), ("depth.clear_flags", "false")]);
    let (accesses, report) = recorded(replay(&empty_frames(3), config.front()), &config);
    let of = |name: &str| -> Vec<u64> { accesses.iter().filter(|(client, ..)| client == name).map(|(_, at, _)| *at).collect() };
    let (reads, writes, depths) = (of("scan_out"), of("pixel_write"), of("z_write"));
    assert!(!reads.is_empty() && reads.len().is_multiple_of(12), "whole pictures only: {}", reads.len());
    assert!(accesses.iter().filter(|(client, ..)| client == "scan_out").all(|(_, _, address)| *address >= layout::Z_BUFFER));
    assert_eq!(writes.len(), 3 * 64 * 48 / 16, "whole pictures");
    for picture in reads.chunks(12) {
        let (from, to) = (picture[0], picture[11]);
        let overwrites = |at: &u64| (from..=to).contains(at);
        assert!(!writes.iter().chain(&depths).any(overwrites), "nothing overwrites a picture that is read");
    }
    assert_eq!(depths.len(), writes.len(), "the z-test clears all lines");
    // The cycles from the last pixel to the end: the flip, and the token to the server.
    let after = report.total - writes[writes.len() - 1];
    assert!(after < 100, "the run ends with the last pixel, and not after the display has read it: {after}");
    let waited: u64 = report.units.iter().filter(|unit| unit.name == "z-test").flat_map(|unit| &unit.account.memory).sum();
    assert!(waited > 2 * 40_000, "each frame after the first waits for a refresh: {waited}");
}

#[test]
fn display_beyond_memory_bandwidth_is_rejected() {
    let config: BumpProcessorConfig = config(&[("display.pixel_hz", "1000000000"), ("memory.graphics.part", "fpm-80")]);
    let problem = config.build(replay(&[], config.front())).err().unwrap();
    assert_eq!(problem.key, "display.pixel_hz");
    assert!(problem.to_string().contains("memory `graphics` would move"), "{problem}");
}

#[test]
fn old_names_of_parameters_are_read() {
    let old: BumpProcessorConfig = basrelief_parameters::load(
        "video_out.pixel_hz = 9000000\n[fifo.finished_frames]\ndepth = 1",
        &[("video_out.enabled", "false"), ("video_out.cycles_per_read", "4")],
    )
    .unwrap();
    let new: BumpProcessorConfig = config(&[("display.pixel_hz", "9000000"), ("display.enabled", "false")]);
    assert_eq!(old, new);
}
