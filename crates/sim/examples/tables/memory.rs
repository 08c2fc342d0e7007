//! Tables of two published experiments with texture memories, repeated on the texture mapping system.
//!
//! - Igehy, Eldridge and Proudfoot, "Prefetching in a texture cache architecture" (1998): where tags run ahead of the data and a
//!   FIFO holds the fragments meanwhile, latency costs next to nothing.
//! - Hakura and Gupta, "The design and analysis of a cache architecture for texture mapping" (1997): a cache of 16 KiB needs a
//!   third to a fifteenth of the bandwidth that texels need without one.

use crate::support::{Inputs, Table, bytes, figure, grouped, report, settings};
use basrelief_report::Report;
use basrelief_signals::Scene;
use std::error::Error;
use std::sync::Arc;

/// Latencies of the texture memory, from read command to first data \[cycles\].
const LATENCIES: [u64; 3] = [6, 24, 96];
/// Cycles of a burst on its bus: one that is wide, and one that is busy half of the time.
const BURST_CYCLES: [u64; 2] = [1, 4];
/// From look-up to data in the cache \[cycles\].
const HIT_LATENCY: u64 = 2;
/// From delivery to visibility, in any FIFO \[cycles\].
const FIFO_LATENCY: u64 = 1;
/// Lines that a step of the look-up table misses where none of its texture is in the cache, or so: as many as pixels.
const LINES: u64 = 16;
/// Lines that a step may miss, and needs credits for: four texels of each of two levels for each of 16 pixels.
const LARGEST_STEP: u64 = 128;
/// Deeper than any latency here needs \[steps\].
const DEEP: u64 = 64;
/// Lines of a set of the cache, where it has as many.
const WAYS: u64 = 4;

/// Parameters, by key.
type Settings = Vec<(String, String)>;

/// A run of the texture mapping system with these parameters.
fn run(scene: &Arc<Scene>, all: &Settings) -> Result<Report, Box<dyn Error>> {
    let all: Vec<(&str, &str)> = all.iter().map(|(key, value)| (key.as_str(), value.as_str())).collect();
    report(scene, &settings("texel", &all, false)?)
}

/// Settings of parameters that share the beginning of their keys.
fn below(group: &str, set: &[(&str, u64)]) -> Settings {
    set.iter().map(|(key, value)| (format!("{group}.{key}"), value.to_string())).collect()
}

/// A memory whose row commands take no time, never refreshed: what is left is its bus and its latency.
fn pipelined(name: &str, cl: u64, burst_cycles: u64, credits: u64) -> Settings {
    let none = ["rcd", "rp", "ras", "rtp", "wr", "wtr", "rrd", "faw", "refi", "rfc"].map(|key| (key, 0));
    let rest = [("channels", 1), ("window", 16), ("cap", 16), ("cl", cl), ("cwl", 0), ("burst_cycles", burst_cycles)];
    let burst = [("burst_bytes", 64), ("outstanding", credits)];
    below(&format!("memory.{name}"), &[&none[..], &rest, &burst].concat())
}

/// Trilinear texture on every pixel, a pixel per cycle, behind a cache of 16 KiB; nothing but the texture memory is ever waited
/// for.
fn texture_alone() -> Settings {
    let words = [
        ("video_out.enabled", "false"),
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

/// The texture mapping system with a memory of this latency and burst \[cycles\], a FIFO of this depth behind the look-up table,
/// and so many credits.
fn prefetching(scene: &Arc<Scene>, [cl, burst_cycles]: [u64; 2], [depth, credits]: [u64; 2]) -> Result<Report, Box<dyn Error>> {
    // What the other way holds meanwhile must not keep the look-up table from running ahead.
    let fifos = [("texture_values.depth", depth), ("illuminances.depth", 4 * DEEP), ("lit_spans.depth", 4 * DEEP)];
    let memory = pipelined("texture", cl, burst_cycles, credits);
    run(scene, &[texture_alone(), memory, below("fifo", &fifos)].concat())
}

/// Credits that never keep a step waiting while so many are under way: theirs, and those for the largest.
fn credits(depth: u64) -> u64 {
    LARGEST_STEP + LINES * depth
}

/// A scene, drawn without latency: what a latency is held against.
struct Without<'a> {
    scene: &'a Arc<Scene>,
    burst_cycles: u64,
    cycles: f64,
    /// Cycles that a step keeps the look-up table, in the mean.
    occupancy: f64,
}

impl<'a> Without<'a> {
    fn measure(scene: &'a Arc<Scene>, burst_cycles: u64) -> Result<Self, Box<dyn Error>> {
        let report = prefetching(scene, [0, burst_cycles], [DEEP, credits(DEEP)])?;
        let unit = report.units.as_ref().and_then(|units| units.get("texture-look-up")).ok_or("no look-up table")?;
        let occupancy = unit.busy as f64 / unit.steps.max(1) as f64;
        Ok(Self { scene, burst_cycles, cycles: drawing(&report), occupancy })
    }

    /// Law 2: full rate needs depth >= (latency + f + 1) / occupancy, and the latency is that of the loaded memory: a cycle to
    /// come into view, its latency, the bursts of a step, and the cache behind it.
    fn depth(&self, cl: u64) -> u64 {
        let latency = 1 + cl + LINES * self.burst_cycles + HIT_LATENCY;
        ((latency + FIFO_LATENCY + 1) as f64 / self.occupancy).ceil() as u64
    }

    /// Speed at a latency, over that without.
    fn speed(&self, cl: u64, room: [u64; 2]) -> Result<f64, Box<dyn Error>> {
        Ok(self.cycles / drawing(&prefetching(self.scene, [cl, self.burst_cycles], room)?))
    }
}

/// Cycles of the frames.
fn drawing(report: &Report) -> f64 {
    report.frame_cycles() as f64
}

/// By bus and latency: speed at the depth that law 2 asks for, at others, and with credits for a single step.
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

/// What a run reads of its texture \[bytes\].
struct Moved {
    pixels: f64,
    /// Every texel, every time that a pixel needs it.
    used: u64,
    /// From memory.
    read: u64,
}

impl Moved {
    /// Behind a cache of `size` bytes in lines of `line`; the memory moves a line in a burst.
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

/// By cache: bytes from the texture memory.
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
    fn igehy_1998_latency_is_hidden_at_the_depth_that_law_2_asks_for_and_not_at_a_smaller_one() {
        let scene = corridor([640, 480]);
        for burst_cycles in BURST_CYCLES {
            let without = Without::measure(&scene, burst_cycles).unwrap();
            let speed = |cl, depth, credits| without.speed(cl, [depth, credits]).unwrap();
            for cl in LATENCIES {
                let depth = without.depth(cl);
                let speed = speed(cl, depth, credits(depth));
                assert!(depth < DEEP && speed >= 0.97, "cl {cl}, bursts of {burst_cycles}: {speed} at depth {depth}");
            }
            let (cl, depth) = (96, without.depth(96));
            assert!(speed(cl, depth / 2, credits(depth)) < 0.9, "half the depth does, bursts of {burst_cycles}");
            assert!(speed(cl, depth, LARGEST_STEP) < 0.3, "credits of one step do, bursts of {burst_cycles}");
        }
    }

    /// Wider lines do not do on this scene, as docs/experiments/texture-caches.md explains: where they do, take the last line away.
    #[test]
    fn hakura_1997_a_cache_of_16_kib_reads_a_third_and_less() {
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
