//! Tables of two published experiments with texture memories, repeated on the texture mapping system.
//!
//! - Igehy, Eldridge and Proudfoot, "Prefetching in a texture cache architecture" (1998): if tags run ahead of the data and a FIFO
//!   buffers the fragments, latency costs almost nothing.
//! - Hakura and Gupta, "The design and analysis of a cache architecture for texture mapping" (1997): a cache of 16 KiB needs a
//!   third to a fifteenth of the bandwidth that texels need without one.

use crate::support::{Inputs, Table, bytes, figure, grouped, report, settings};
use basrelief_report::Report;
use basrelief_signals::Scene;
use std::error::Error;
use std::sync::Arc;

/// Latencies of the texture memory, from read command to first data \[cycles\].
const LATENCIES: [u64; 3] = [6, 24, 96];
/// Bus cycles of a burst: a wide bus, and a bus that is busy half of the time.
const BURST_CYCLES: [u64; 2] = [1, 4];
/// Latency of the cache \[cycles\].
const HIT_LATENCY: u64 = 2;
/// Latency of a FIFO \[cycles\].
const FIFO_LATENCY: u64 = 1;
/// Approximate number of misses of a look-up step with a cold cache: one per pixel.
const LINES: u64 = 16;
/// Maximum number of misses of a step, which need credits: four texels of each of two levels for each of 16 pixels.
const LARGEST_STEP: u64 = 128;
/// Depth that exceeds all latencies in this table \[steps\].
const DEEP: u64 = 64;
/// Ways of the cache.
const WAYS: u64 = 4;

/// Parameters, by key.
type Settings = Vec<(String, String)>;

/// Runs the texture mapping system with these parameters.
fn run(scene: &Arc<Scene>, all: &Settings) -> Result<Report, Box<dyn Error>> {
    let all: Vec<(&str, &str)> = all.iter().map(|(key, value)| (key.as_str(), value.as_str())).collect();
    report(scene, &settings("texel", &all, false)?)
}

/// Returns settings with a common prefix of their keys.
fn below(group: &str, set: &[(&str, u64)]) -> Settings {
    set.iter().map(|(key, value)| (format!("{group}.{key}"), value.to_string())).collect()
}

/// Memory without row commands and refreshes, so that only bus and latency remain.
fn pipelined(name: &str, cl: u64, burst_cycles: u64, credits: u64) -> Settings {
    let none = ["rcd", "rp", "ras", "rtp", "wr", "wtr", "rrd", "faw", "refi", "rfc"].map(|key| (key, 0));
    let rest = [("channels", 1), ("window", 16), ("cap", 16), ("cl", cl), ("cwl", 0), ("burst_cycles", burst_cycles)];
    let burst = [("burst_bytes", 64), ("outstanding", credits)];
    below(&format!("memory.{name}"), &[&none[..], &rest, &burst].concat())
}

/// Settings: trilinear texture on every pixel, one pixel per cycle, and a cache of 16 KiB. Only the texture memory causes waits.
fn texture_alone() -> Settings {
    let words = [
        ("display.enabled", "false"),
        ("texel.method", "adaptive"),
        ("texel.error_bound", "0.5"),
        ("mip.mode", "trilinear"),
        ("mip.per", "segment"),
        ("look_up.filter", "bilinear"),
        ("texture.layout", "blocked"),
        ("texture.block", "4"),
    ];
    let words: Settings = words.iter().map(|&(key, value)| (key.to_owned(), value.to_owned())).collect();
    let look_up = [("texel_bytes", TEXEL), ("samples_per_cycle", 2), ("latency", 6)];
    let cache = [("line_bytes", 64), ("sets", 64), ("ways", WAYS), ("hit_latency", HIT_LATENCY), ("lookups_per_cycle", 16)];
    let divider = [("count", 32), ("bits_per_cycle", 2)];
    let others = [pipelined("depth", 0, 1, 64), pipelined("pixel", 0, 1, 64)].concat();
    [words, below("look_up", &look_up), below("cache.texture", &cache), below("divider", &divider), others].concat()
}

/// Returns the settings for a texture memory with this latency and burst \[cycles\], the depth of the FIFO after the look-up table, and the
/// number of credits.
fn prefetching(scene: &Arc<Scene>, [cl, burst_cycles]: [u64; 2], [depth, credits]: [u64; 2]) -> Result<Report, Box<dyn Error>> {
    // The FIFOs of the illuminance path must not block the look-up table.
    let fifos = [("texture_values.depth", depth), ("illuminances.depth", 4 * DEEP), ("lit_spans.depth", 4 * DEEP)];
    let memory = pipelined("texture", cl, burst_cycles, credits);
    run(scene, &[texture_alone(), memory, below("fifo", &fifos)].concat())
}

/// Returns enough credits for `steps` steps in flight and one more of the largest size.
fn credits(depth: u64) -> u64 {
    LARGEST_STEP + LINES * depth
}

/// A scene drawn without memory latency, as the baseline.
struct Without<'a> {
    scene: &'a Arc<Scene>,
    burst_cycles: u64,
    cycles: f64,
    /// Returns the mean occupancy of the look-up table per step \[cycles\].
    occupancy: f64,
}

impl<'a> Without<'a> {
    fn measure(scene: &'a Arc<Scene>, burst_cycles: u64) -> Result<Self, Box<dyn Error>> {
        let report = prefetching(scene, [0, burst_cycles], [DEEP, credits(DEEP)])?;
        let unit = report.units.as_ref().and_then(|units| units.get("texture-look-up")).ok_or("no look-up table")?;
        let occupancy = unit.busy as f64 / unit.steps.max(1) as f64;
        Ok(Self { scene, burst_cycles, cycles: drawing(&report), occupancy })
    }

    /// Law 2: full throughput needs depth >= (latency + f + 1) / occupancy, with the latency of the loaded memory: one cycle until the
    /// request is visible, the memory latency, the bursts of a step, and the cache latency.
    fn depth(&self, cl: u64) -> u64 {
        let latency = 1 + cl + LINES * self.burst_cycles + HIT_LATENCY;
        ((latency + FIFO_LATENCY + 1) as f64 / self.occupancy).ceil() as u64
    }

    /// Returns the speed at a latency relative to the baseline.
    fn speed(&self, cl: u64, room: [u64; 2]) -> Result<f64, Box<dyn Error>> {
        Ok(self.cycles / drawing(&prefetching(self.scene, [cl, self.burst_cycles], room)?))
    }
}

/// Returns the render cycles.
fn drawing(report: &Report) -> f64 {
    report.frame_cycles() as f64
}

/// Table by bus and latency: speed at the depth of law 2, at other depths, and with credits for a single step.
pub fn igehy(inputs: &Inputs, of: &[&str]) -> Result<String, Box<dyn Error>> {
    let head =
        ["input", "bus", "`cl`", "occupancy", "depth", "credits", "speed %", "twice %", "half %", "depth 1 %", "128 credits %"];
    let mut table = Table::new(&head, 1);
    for name in of {
        let scene = inputs.open(name, 1)?;
        for burst_cycles in BURST_CYCLES {
            let without = Without::measure(&scene, burst_cycles)?;
            for cl in LATENCIES {
                let depth = without.depth(cl);
                let other = [depth, 2 * depth, (depth / 2).max(1), 1].map(|depth| [depth, credits(depth)]);
                let rooms = other.into_iter().chain([[depth, LARGEST_STEP]]);
                let percent = |room| Ok(format!("{:.1}", 100.0 * without.speed(cl, room)?));
                let speeds = rooms.map(percent).collect::<Result<Vec<_>, Box<dyn Error>>>()?;
                let [bus, cl, depth, credits] = [burst_cycles, cl, depth, credits(depth)].map(|n| n.to_string());
                let given = [(*name).to_owned(), bus, cl, format!("{:.2}", without.occupancy), depth, credits];
                table.row(&[&given[..], &speeds].concat());
            }
        }
    }
    Ok(table.text())
}

/// Bytes of a texel, and of a line of the smallest cache there can be.
const TEXEL: u64 = 4;
/// Caches: sizes and lines \[bytes\].
const CACHES: [[u64; 2]; 7] =
    [[1 << 10, 64], [4 << 10, 64], [16 << 10, 16], [16 << 10, 32], [16 << 10, 64], [16 << 10, 128], [64 << 10, 64]];

/// Texture bytes that a run reads.
struct Moved {
    pixels: f64,
    /// Bytes without a cache.
    used: u64,
    /// Bytes from memory.
    read: u64,
}

impl Moved {
    /// Runs with a cache of `size` bytes and lines of `line` bytes. The memory transfers a line in a burst.
    fn behind(scene: &Arc<Scene>, [size, line]: [u64; 2]) -> Result<Self, Box<dyn Error>> {
        let ways = WAYS.min(size / line);
        let cache = below("cache.texture", &[("line_bytes", line), ("ways", ways), ("sets", size / line / ways)]);
        let burst = below("memory.texture", &[("burst_bytes", line)]);
        let report = run(scene, &[texture_alone(), pipelined("texture", 0, 1, LARGEST_STEP), burst, cache].concat())?;
        let [pixels, texels] = ["pixels_textured", "texels_read"].map(|name| figure(&report, name));
        let read = bytes(&report, |memory, client| (memory, client) == ("texture", "texel_read"));
        Ok(Self { pixels, used: texels as u64 * TEXEL, read })
    }
}

/// Table by cache: bytes from the texture memory.
pub fn hakura(inputs: &Inputs, of: &[&str]) -> Result<String, Box<dyn Error>> {
    let head = ["input", "cache", "line", "bytes", "bytes/pixel", "of none", "of one texel"];
    let mut table = Table::new(&head, 2);
    for name in of {
        let scene = inputs.open(name, 1)?;
        let one = Moved::behind(&scene, [TEXEL, TEXEL])?;
        let mut row = |cache: String, line: String, read: u64| {
            let share = |of: u64| format!("1/{:.1}", of as f64 / read as f64);
            let per_pixel = format!("{:.2}", read as f64 / one.pixels);
            table.row(&[(*name).to_owned(), cache, line, grouped(read), per_pixel, share(one.used), share(one.read)]);
        };
        row("none".into(), String::new(), one.used);
        row("one texel".into(), TEXEL.to_string(), one.read);
        for [size, line] in CACHES {
            row(format!("{} KiB", size >> 10), line.to_string(), Moved::behind(&scene, [size, line])?.read);
        }
    }
    Ok(table.text())
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_scene::{ViewOptions, demo};

    fn corridor(size: [u32; 2]) -> Arc<Scene> {
        Arc::new(demo("corridor", &ViewOptions { size, ..ViewOptions::default() }).unwrap())
    }

    #[test]
    fn igehy_1998_depth_of_law_2_hides_the_latency() {
        let scene = corridor([640, 480]);
        for burst_cycles in BURST_CYCLES {
            let without = Without::measure(&scene, burst_cycles).unwrap();
            let speed = |cl, depth, credits| without.speed(cl, [depth, credits]).unwrap();
            for cl in LATENCIES {
                let depth = without.depth(cl);
                let speed = speed(cl, depth, credits(depth));
                assert!(depth < DEEP && speed >= 0.96, "cl {cl}, bursts of {burst_cycles}: {speed} at depth {depth}");
            }
            let (cl, depth) = (96, without.depth(96));
            assert!(speed(cl, depth / 2, credits(depth)) < 0.9, "half the depth does, bursts of {burst_cycles}");
            assert!(speed(cl, depth, LARGEST_STEP) < 0.3, "credits of one step do, bursts of {burst_cycles}");
        }
    }

    /// Wider lines do not reach a third on this scene; docs/experiments/texture-caches.md explains why. If they do, delete the last assertion.
    #[test]
    fn hakura_1997_cache_of_16_kib_reads_at_most_a_third() {
        let scene = corridor([640, 480]);
        let times = |line| {
            let moved = Moved::behind(&scene, [16 << 10, line]).unwrap();
            moved.used as f64 / moved.read as f64
        };
        let [narrow, half, block] = [16, 32, 64].map(times);
        assert!(narrow >= 3.0 && half >= 3.0, "1/{narrow} and 1/{half}");
        assert!((2.0..3.0).contains(&block), "1/{block}");
    }
}
