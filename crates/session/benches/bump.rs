//! W1: `demo sphere`, 20,000 triangles, 640 x 480, normal map 512^2 bilinear, two levels, 256 entries, all memories
//! modelled. Only the simulation is timed: scene, exact picture and metrics are made outside.
//!
//! Ratios of one run are worth more than single times: `timed` / `functional`, and a search of 256 cycles against one of 1
//! cycle, are printed after the measurements.

use basrelief_kernel::Engine;
use basrelief_machines::bump::BumpProcessorConfig;
use basrelief_session::{NoProbe, Settings, Source, Unobserved, run};
use basrelief_signals::Scene;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

fn seconds() -> f64 {
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64()
}

/// The machine of one measurement.
fn settings(engine: Option<Engine>, set: &[(&str, &str)]) -> Settings {
    let config: BumpProcessorConfig = basrelief_parameters::load("", set).unwrap();
    Settings { config: config.into(), engine, exact: false, clock: seconds, ..Settings::default() }
}

/// Simulated seconds and fragments of one run.
fn simulate(scene: &Arc<Scene>, settings: &Settings) -> (f64, u64) {
    let run = run(Source::Scene(Arc::clone(scene)), settings, &mut Unobserved, &mut NoProbe).unwrap();
    (run.simulate_s, run.report.device_number("fragments").unwrap_or(0.0) as u64)
}

fn w1(c: &mut Criterion) {
    let scene = Arc::new(basrelief_scene::demo("sphere", &basrelief_scene::ViewOptions::default()).unwrap());
    // A search of 1 cycle and one of 256, the same otherwise: a new one starts every cycle.
    let cases = [
        ("timed", settings(Some(Engine::Timed), &[])),
        ("functional", settings(None, &[])),
        ("search-1", settings(Some(Engine::Timed), &[("replacement.lanes", "256")])),
        ("search-256", settings(Some(Engine::Timed), &[("replacement.lanes", "1"), ("fifo.indexes.depth", "512")])),
    ];
    let mut group = c.benchmark_group("w1");
    group.sample_size(10);
    group.throughput(Throughput::Elements(simulate(&scene, &cases[0].1).1));
    for (name, settings) in &cases {
        group.bench_function(*name, |b| {
            b.iter_custom(|n| Duration::from_secs_f64((0..n).map(|_| simulate(&scene, settings).0).sum()));
        });
    }
    group.finish();
    let best = |settings: &Settings| (0..7).map(|_| simulate(&scene, settings).0).fold(f64::INFINITY, f64::min);
    let [timed, functional, one, many] = [0, 1, 2, 3].map(|i| best(&cases[i].1));
    println!("timed / functional {:.2}, search of 256 / of 1 cycle {:.3}", timed / functional, many / one);
}

criterion_group!(benches, w1);
criterion_main!(benches);
