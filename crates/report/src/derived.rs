//! Derived figures, each with its unit and its formula. They are rounded to 6 decimals, so that the text of a report is the same on
//! every host. A figure with a divisor that is 0 or unknown is left out.

use crate::model::{Bus, Client, Cycles, Derived, Memory, Report};
use crate::number::round6;
use crate::work::{WorkCount, circuits, routes, work};
use indexmap::IndexMap;

/// Derived figures, and those that are left out because their divisor is 0 or unknown, with their formulas.
#[derive(Default)]
struct DerivedFigures {
    defined: IndexMap<String, Derived>,
    undefined: Vec<(String, String)>,
}

impl DerivedFigures {
    fn ratio(&mut self, name: impl Into<String>, above: f64, below: f64, unit: &str, formula: impl Into<String>) {
        let value = above / below;
        let (name, formula) = (name.into(), formula.into());
        if value.is_finite() {
            self.defined.insert(name, Derived { value: round6(value), unit: unit.into(), formula });
        } else {
            self.undefined.push((name, formula));
        }
    }
}

/// Formulas of the render cycles: alone, as an operand, and as a sum of frames.
struct RenderFormulas {
    plain: &'static str,
    grouped: &'static str,
    summed: &'static str,
}

impl RenderFormulas {
    /// Behind the last whole frame, an incomplete run still draws: its render cycles are all cycles.
    fn of(report: &Report, cycles: &Cycles) -> Self {
        if report.drain() != cycles.drain {
            return Self { plain: "cycles.total", grouped: "cycles.total", summed: "cycles.total" };
        }
        let (plain, grouped) = ("cycles.total - cycles.write_tail", "(cycles.total - cycles.write_tail)");
        Self { plain, grouped, summed: "sum(cycles.frames)" }
    }
}

/// Returns all figures derived from a timed report; empty for a functional report.
pub fn derive(report: &Report) -> IndexMap<String, Derived> {
    all_figures(report).defined
}

/// Returns the names of the figures that a timed report leaves out because their divisor is 0 or unknown, each with its formula.
pub fn undefined_figures(report: &Report) -> Vec<(String, String)> {
    all_figures(report).undefined
}

fn all_figures(report: &Report) -> DerivedFigures {
    let mut figures = DerivedFigures::default();
    let Some(cycles) = &report.cycles else { return figures };
    let total = cycles.total as f64;
    let hz = report.clock_hz().unwrap_or(0.0);
    let work = work(report);
    let fragments = work.count as f64;

    // In the tail, nothing is drawn.
    let drawing = report.frame_cycles() as f64;
    let RenderFormulas { plain, grouped: render, summed } = RenderFormulas::of(report, cycles);
    let formula = format!("{render} / {}", work.formula);
    figures.ratio(format!("cycles_per_{}", work.one), drawing, fragments, "cycles", formula);
    let polygons = routes(report).iter().map(|r| r.polygons as f64).sum::<f64>();
    let formula = format!("{render} / sum(figures.polygons_ROUTE)");
    figures.ratio("cycles_per_polygon", drawing, polygons, "cycles", formula);
    for circuit in circuits(report) {
        let (name, idle) = (circuit.name, drawing - circuit.started as f64);
        let formula = format!("{plain} - figures.{}", circuit.figure);
        figures.ratio(format!("{name}.idle"), idle, 1.0, "cycles", formula);
    }
    figures.ratio("time_ms", 1e3 * total, hz, "ms", "1000 * cycles.total / config.clock.hz");
    let frames = report.frames() as f64;
    if frames > 0.0 {
        let [sum, count] = match report.picture_term() {
            "frame" => ["sum(cycles.frames)", "count(cycles.frames)"],
            _ => ["sum(cycles.frames of finished frames)", "figures.frames"],
        };
        let whole = report.cycles_of_frames().iter().sum::<u64>() as f64;
        let formula = format!("1000 * {sum} / ({count} * config.clock.hz)");
        if let Some(ms) = report.frame_ms() {
            figures.ratio("frame_ms", ms, 1.0, "ms", formula);
        }
        let formula = format!("config.clock.hz * {count} / {sum}");
        figures.ratio("frames_per_s", hz * frames, whole, "1/s", formula);
    }
    let formula = format!("{} * config.clock.hz / {render} / 1e6", work.formula);
    figures.ratio("fill_rate", fragments * hz / 1e6, drawing, &format!("M {}s/s", work.one), formula);
    add_memories(report, &mut figures, hz, &work, summed);
    add_display(report, &mut figures, hz, total);
    for (name, c) in report.caches.iter().flatten() {
        let formula = format!("caches.{name}.hits / caches.{name}.lookups");
        figures.ratio(format!("{name}.hit_rate"), c.hits as f64, c.look_ups as f64, "1", formula);
    }
    let base = report.breakdown_cycles();
    let of = if base == report.frame_cycles() { render } else { "cycles.total" };
    for (name, u) in report.units.iter().flatten() {
        let formula = format!("units.{name}.busy / {of}");
        figures.ratio(format!("{name}.utilization"), u.busy as f64, base as f64, "1", formula);
    }
    figures
}

/// `drawn` is the formula of the render cycles.
fn add_memories(report: &Report, figures: &mut DerivedFigures, hz: f64, work: &WorkCount, drawn: &str) {
    for (name, memory) in report.memories.iter().flatten() {
        let sum = |f: fn(&Client) -> u64| memory.clients.values().map(|c| f(c) as f64).sum::<f64>();
        let formula = format!("memories.{name}.bytes.moved / {}", work.formula);
        figures.ratio(format!("{name}.bytes_per_{}", work.one), memory.bytes.moved as f64, work.count as f64, "bytes", formula);
        let (hits, bursts) = (sum(|c| c.row_hits), sum(|c| c.bursts));
        let formula = format!("sum(memories.{name}.clients.*.row_hits) / sum(memories.{name}.clients.*.bursts)");
        figures.ratio(format!("{name}.row_hit_rate"), hits, bursts, "1", formula);
        let (busy, cycles) = within_frames(report, memory);
        let formula = format!(
            "sum(memories.{name}.bus.busy[0..n]) / (min(n * memories.{name}.bus.interval, cycles.total) * count(memories.{name}.channels)), n = ceil({drawn} / memories.{name}.bus.interval)"
        );
        figures.ratio(format!("{name}.bus_utilization"), busy, cycles, "1", formula);
        if let Some([burst_bytes, burst_cycles]) = burst_shape(report, name) {
            let seconds = cycles / memory.channels.len() as f64 / hz;
            let formula = format!(
                "{name}.bus_utilization * count(memories.{name}.channels) * config.memory.{name}.burst_bytes / config.memory.{name}.burst_cycles * config.clock.hz / 1e9"
            );
            figures.ratio(format!("{name}.gb_per_s"), busy / burst_cycles * burst_bytes / 1e9, seconds, "GB/s", formula);
        }
    }
}

fn add_display(report: &Report, figures: &mut DerivedFigures, hz: f64, total: f64) {
    let Some(display) = &report.display else { return };
    let formula = "display.pictures_shown * config.clock.hz / cycles.total";
    figures.ratio("display.pictures_per_s", display.pictures_shown as f64 * hz, total, "1/s", formula);
    let formula = "display.flip_wait / display.flips";
    figures.ratio("display.flip_latency", display.flip_wait as f64, display.flips as f64, "cycles", formula);
    let name = &display.memory;
    let channels = report.memories.as_ref().and_then(|memories| memories.get(name)).map_or(0, |memory| memory.channels.len());
    let formula = format!("display.bus_cycles / (cycles.total * count(memories.{name}.channels))");
    figures.ratio("display.bus_share", display.bus_cycles as f64, total * channels as f64, "1", formula);
}

/// Bytes and cycles of a burst.
fn burst_shape(report: &Report, memory: &str) -> Option<[f64; 2]> {
    let config = report.config.get("memory")?.get(memory)?;
    Some([config.get("burst_bytes")?.as_f64()?, config.get("burst_cycles")?.as_f64()?])
}

/// Cycles in which the buses of a memory moved data, and in which they could have, in the intervals that touch a frame. (Without the
/// last of them, which frames end in with their writes, the result of short runs was up to a third too low.)
fn within_frames(report: &Report, memory: &Memory) -> (f64, f64) {
    let Bus { interval, ref busy } = memory.bus;
    let touched = report.frame_cycles().div_ceil(interval.max(1));
    let moved: u64 = busy.iter().take(usize::try_from(touched).unwrap_or(usize::MAX)).sum();
    let cycles = touched.saturating_mul(interval).min(report.cycles.as_ref().map_or(0, |cycles| cycles.total));
    (moved as f64, cycles as f64 * memory.channels.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples;

    #[test]
    fn figures_follow_from_their_formulas() {
        let derived = samples::balanced().derived;
        assert_eq!(derived["cycles_per_fragment"].value, 5.0);
        assert_eq!(derived["time_ms"].value, 5.0);
        assert_eq!(derived["replacement.utilization"].value, 0.97);
        assert_eq!(derived["graphics.bytes_per_fragment"].value, 19.2);
        assert_eq!(derived["graphics.gb_per_s"].value, 0.768);
        assert_eq!(derived["graphics.bus_utilization"].value, 0.24);
    }

    #[test]
    fn figure_without_divisor_is_undefined() {
        let mut report = samples::balanced();
        let caches = report.caches.as_mut().unwrap();
        let name = caches.keys().next().unwrap().clone();
        (caches[&name].hits, caches[&name].look_ups) = (0, 0);
        let undefined = undefined_figures(&report);
        let formula = format!("caches.{name}.hits / caches.{name}.lookups");
        assert!(undefined.contains(&(format!("{name}.hit_rate"), formula)), "{undefined:?}");
    }

    #[test]
    fn frame_figures_exclude_tail() {
        let mut report = samples::balanced();
        let before = report.derived.clone();
        let cycles = report.cycles.as_mut().unwrap();
        (cycles.total, cycles.drain) = (cycles.total + 9_000_000, 9_000_000);
        report.units.as_mut().unwrap().values_mut().for_each(|u| u.done += 9_000_000);
        let after = derive(&report);
        for (name, figure) in before.iter().filter(|(name, _)| *name != "time_ms") {
            assert_eq!(after[name].value, figure.value, "{name}");
        }
        assert_eq!(after["time_ms"].value, 50.0);
        assert_eq!(crate::bottleneck::diagnose(&report), crate::bottleneck::diagnose(&samples::balanced()));
    }

    #[test]
    fn bus_utilization_covers_interval_in_which_run_ends() {
        let mut report = samples::balanced();
        let total = report.cycles.as_ref().unwrap().total;
        let memory = report.memories.as_mut().unwrap().get_mut("graphics").unwrap();
        let channels = memory.channels.len() as u64;
        // Seven eighths of the run are idle, and the last interval, which the run ends in, is busy.
        memory.bus = Bus { interval: total / 8 * 7, busy: vec![0, channels * total / 8] };
        assert_eq!(derive(&report)["graphics.bus_utilization"].value, 0.125);
    }

    #[test]
    fn incomplete_frame_counts_in_no_mean_per_frame() {
        let mut report = samples::balanced();
        report.outcome.kind = crate::model::OutcomeKind::Limit;
        let cycles = report.cycles.as_mut().unwrap();
        (cycles.frames, cycles.drain) = (vec![200_000], 800_000);
        let derived = derive(&report);
        assert_eq!((derived["frame_ms"].value, derived["frames_per_s"].value), (1.0, 1000.0));
        // All other figures cover the whole run, and so do their formulas.
        assert_eq!((derived["cycles_per_fragment"].value, derived["graphics.bus_utilization"].value), (5.0, 0.24));
        let formulas: Vec<&str> = derived.values().map(|figure| &*figure.formula).collect();
        assert!(formulas.iter().all(|formula| !formula.contains("write_tail")), "{formulas:?}");
        assert!(derived["graphics.bus_utilization"].formula.ends_with("n = ceil(cycles.total / memories.graphics.bus.interval)"));
    }

    #[test]
    fn several_pictures_of_a_frame_count_as_one_frame() {
        let mut report = samples::balanced();
        let of_frames = derive(&report)["frame_ms"].value;
        assert_eq!((report.frames(), report.pictures(), report.picture_term()), (2, 2, "frame"));
        report.figures.insert("frames".into(), 1.into());
        report.figures.insert("picture_frame".into(), crate::model::Figure::List(vec![0.into(), 0.into()]));
        let derived = derive(&report);
        assert_eq!((report.frames(), report.pictures(), report.picture_term()), (1, 2, "picture"));
        assert_eq!((derived["frame_ms"].value, derived["frames_per_s"].value), (2.0 * of_frames, 1e3 / (2.0 * of_frames)));
        assert!(derived["frame_ms"].formula.contains("(figures.frames * "), "{}", derived["frame_ms"].formula);
        // A picture of a frame that was not finished counts in no mean.
        let mut stopped = report.clone();
        stopped.cycles.as_mut().unwrap().frames.push(9);
        stopped.figures.insert("picture_frame".into(), crate::model::Figure::List(vec![0.into(), 0.into()]));
        assert_eq!((stopped.frame_ms(), stopped.frames(), stopped.pictures()), (report.frame_ms(), 1, 3));
        stopped.figures.insert("frames".into(), 0.into());
        assert_eq!((stopped.frame_ms(), stopped.frames()), (None, 0));
        // Pictures of other frames are not paired.
        let mut other = report.clone();
        other.cycles.as_mut().unwrap().frames.push(7);
        let comparison = crate::compare::compare(&report, &other, None);
        assert!(comparison.sections.iter().flat_map(|section| &section.changes).all(|change| change.field != "frames"));
    }

    #[test]
    fn device_with_routes_is_reported_in_dots_and_polygons() {
        let derived = samples::with_routes().derived;
        assert_eq!(derived["cycles_per_dot"].value, 5.0);
        assert_eq!(derived["cycles_per_polygon"].value, 1000.0);
        assert_eq!(derived["circuit_50.idle"].value, 400_000.0);
        assert_eq!(derived["graphics.bytes_per_dot"].value, 19.2);
        assert_eq!(derived["fill_rate"].unit, "M dots/s");
        assert!(!derived.contains_key("cycles_per_fragment"));
    }

    #[test]
    fn nothing_is_divided_by_zero() {
        let mut report = samples::balanced();
        report.figures.clear();
        report.config = serde_json::json!({});
        let derived = derive(&report);
        assert!(!derived.contains_key("cycles_per_fragment") && !derived.contains_key("time_ms"));
        assert!(derived.values().all(|d| d.value.is_finite()));
    }
}
