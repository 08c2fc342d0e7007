//! Hand-made reports for the tests of this crate, and one that the kernel made.

use crate::build::ReportContext;
use crate::derived::derive;
use crate::model::{
    Bus, Cache, Channel, Client, Cycles, Difference, Fifo, Figure, FigureGroup, Hardware, HardwareArea, Input, Legend, Memory,
    MemoryBytes, OutcomeKind, Picture, PictureQuality, Report, Size, Unit,
};
use crate::model::{Costs, CycleBreakdown, ObjectCost, PolygonCost, UnlistedCosts};
use basrelief_kernel::{Engine, Outcome, RunReport};
use basrelief_kernel_conformance::plan::{Plan, PlanMachine};
use basrelief_reference::QualityMetrics;
use basrelief_signals::Camera;
use serde_json::json;

/// Tokens that the source of [`plan`] emits.
pub const TOKENS: u64 = 40;
/// Cycles of the hand-made runs.
pub const TOTAL: u64 = 1_000_000;

pub fn context() -> ReportContext {
    let mut view_projection = [0.0; 16];
    [0, 5, 10, 15].into_iter().for_each(|i| view_projection[i] = 1.0);
    let figure = |name: &str, value: Figure| (name.to_owned(), value);
    ReportContext {
        build: "0.1.0+0123456789abcdef".into(),
        machine: "bump".into(),
        input: Input { kind: "demo".into(), name: "coin".into(), sha256: "ab".repeat(32) },
        config: json!({
            "clock": {"hz": 200_000_000},
            "memory": {"graphics": {"burst_bytes": 64, "burst_cycles": 4}, "normal_map": {"burst_bytes": 64, "burst_cycles": 4}},
            "replacement": {"entries": 256, "lanes": 8},
        }),
        camera: Camera { view_projection, to_light: [0.0, 0.0, 1.0], to_viewer: [0.0, 0.0, 1.0] },
        size: Size { width: 640, height: 480 },
        numerals: [("normal-mapping".to_owned(), 108), ("replacement".to_owned(), 110)].into_iter().collect(),
        figures: [
            figure("fragments", 200_000.into()),
            figure("bump_fragments", 180_000.into()),
            figure("reference_normals_used", vec![250_u64, 121].into()),
            figure("clut_rebuild_share", 0.015.into()),
            figure("codebook", "fixed".into()),
        ]
        .into_iter()
        .collect(),
        hardware: vec![],
        legend: [("fragments".to_owned(), legend("fragments", FigureGroup::Work))].into_iter().collect(),
        quality: PictureQuality::of(
            &[QualityMetrics { psnr_db: 41.25, ssim: 0.987654, flip: 0.0321 }],
            Some(Difference { mean: 0.75, largest: 12 }),
        ),
        image: vec![
            Picture { file: "image-0001.png".into(), sha256: "01".repeat(32) },
            Picture { file: "image.png".into(), sha256: "02".repeat(32) },
        ],
        warnings: vec!["material `rim`: emissive texture left out".into()],
    }
}

/// Meaning of a figure.
pub fn legend(unit: &str, part: FigureGroup) -> Legend {
    Legend { unit: unit.into(), about: String::new(), part: Some(part) }
}

pub fn functional() -> Report {
    Report::functional(context(), &Outcome::Complete)
}

/// A unit's row: name, then (cause, cycles); causes are `busy`, `done`, `<fifo`, `>fifo` and `@client`.
pub fn unit(row: &[(&str, u64)]) -> Unit {
    let mut unit = Unit { steps: 200_000, tokens: 200_000, ..Unit::default() };
    for &(cause, cycles) in row {
        match cause.split_at(1) {
            ("<", fifo) => drop(unit.starved.insert(fifo.into(), cycles)),
            (">", fifo) => drop(unit.blocked.insert(fifo.into(), cycles)),
            ("@", client) => drop(unit.memory.insert(client.into(), cycles)),
            _ if cause == "busy" => unit.busy = cycles,
            _ => unit.done = cycles,
        }
    }
    unit
}

/// A report of [`TOTAL`] cycles with these units, and the memory `graphics` with its two clients.
pub fn with_units(rows: &[(&str, &[(&str, u64)])]) -> Report {
    let mut report = functional();
    let frames = vec![520_000, 480_000];
    report.cycles = Some(Cycles { total: TOTAL, drain: 0, frames });
    let mut units: indexmap::IndexMap<_, _> = rows.iter().map(|&(name, row)| (name.to_owned(), unit(row))).collect();
    for (name, unit) in &mut units {
        unit.numeral = context().numerals.get(name).copied();
    }
    let names = units.values().flat_map(|u| u.blocked.keys()).cloned().collect::<Vec<_>>();
    report.fifos = Some(names.into_iter().zip(fifos().into_iter().cycle()).collect());
    report.units = Some(units);
    let client = |reads, writes| Client {
        reads,
        writes,
        read_bytes: 4 * reads,
        write_bytes: 4 * writes,
        bursts: (reads + writes) * 15 / 100,
        moved_bytes: 0,
        row_hits: (reads + writes) / 10,
        row_closed: (reads + writes) / 40,
        row_conflicts: (reads + writes) / 40,
        queue_wait: (reads + writes) * 45 / 100,
        latency_sum: 11 * reads + 21 * writes,
        latency_95: 32,
        latency: vec![0, 0, 0, reads, writes],
    };
    let named = |list: [(&str, Client); 2]| list.into_iter().map(|(n, c)| (n.to_owned(), c)).collect();
    let normal_map = named([("normals-fine", client(90_000, 0)), ("normals-coarse", client(30_000, 0))]);
    let graphics = named([("z", client(120_000, 80_000)), ("color", client(0, 200_000))]);
    let memories = [("normal_map", normal_map), ("graphics", graphics)];
    report.memories = Some(memories.into_iter().map(|(n, clients)| (n.to_owned(), memory(clients))).collect());
    let cache = Cache { look_ups: 720_000, hits: 600_000, misses: 120_000, merged: 0 };
    report.count_bytes();
    report.caches = Some([("normal-texels".to_owned(), cache)].into_iter().collect());
    report.derived = derive(&report);
    report
}

/// A memory of one channel that served these clients evenly.
fn memory(clients: indexmap::IndexMap<String, Client>) -> Memory {
    let sum = |f: fn(&Client) -> u64| clients.values().map(f).sum::<u64>();
    let bus_busy = 4 * sum(|c| c.bursts);
    let channel = Channel {
        row_hits: sum(|c| c.row_hits),
        row_closed: sum(|c| c.row_closed),
        row_conflicts: sum(|c| c.row_conflicts),
        turn_arounds: sum(|c| c.bursts) / 10,
        refreshes: TOTAL / 1560,
        bus_busy,
        queued: sum(|c| c.queue_wait + c.bursts),
    };
    let bus = Bus { interval: TOTAL / 250, busy: vec![bus_busy / 250; 250] };
    Memory { clients, channels: vec![channel], bus, bytes: MemoryBytes::default() }
}

fn fifos() -> Vec<Fifo> {
    let full = Fifo { depth: 4, tokens: 200_000, high_water: 4, histogram: vec![0, 10_000, 20_000, 70_000, 900_000] };
    let empty = Fifo { depth: 4, tokens: 200_000, high_water: 2, histogram: vec![700_000, 290_000, 10_000, 0, 0] };
    let mut histogram: Vec<u64> = (0..=64).map(|k| 32 * (k + 1)).collect();
    histogram[0] += TOTAL - histogram.iter().sum::<u64>();
    let wide = Fifo { depth: 64, tokens: 200_000, high_water: 64, histogram };
    vec![full, empty, wide]
}

/// Limited by the replacement unit, as the default machine is.
pub fn balanced() -> Report {
    with_units(&[
        ("geometry", &[("busy", 30_000), (">polygons", 900_000), ("done", 70_000)]),
        ("rasterizer", &[("busy", 200_000), ("<polygons", 30_000), (">fragments", 750_000), ("done", 20_000)]),
        (
            "normal-mapping",
            &[
                ("busy", 200_000),
                ("<fragments", 40_000),
                (">pseudo_normals", 610_000),
                ("@normals-fine", 135_000),
                ("done", 15_000),
            ],
        ),
        ("replacement", &[("busy", 970_000), ("<pseudo_normals", 20_000), (">indexes", 0), ("done", 10_000)]),
        ("frame-buffer", &[("busy", 200_000), ("<indexes", 795_000), ("@z", 3_000), ("@color", 2_000), ("done", 0)]),
    ])
}

/// [`balanced`], of a machine that counts dots on two routes, runs of a process, and the cycles of two circuits.
pub fn with_routes() -> Report {
    let mut report = balanced();
    report.machine = "shade".into();
    let (normal, flat) = (|| "normal".to_owned(), || "flat".to_owned());
    let figures = [
        ("fragments", 200_000, "dots", FigureGroup::Work),
        ("polygons_normal", 900, "polygons", FigureGroup::Route(normal())),
        ("polygons_flat", 100, "polygons", FigureGroup::Route(flat())),
        ("dots_normal", 150_000, "dots", FigureGroup::Route(normal())),
        ("dots_flat", 50_000, "dots", FigureGroup::Route(flat())),
        ("process_22_runs", 1_000, "runs", FigureGroup::Process("process_22".into())),
        ("process_22_cycles", 36_000, "cycles", FigureGroup::Process("process_22".into())),
        ("circuit_21_started_cycles", 150_000, "cycles", FigureGroup::Started("circuit_21".into())),
        ("circuit_50_started_cycles", 600_000, "cycles", FigureGroup::Started("circuit_50".into())),
        ("circuit_50_needed_cycles", 450_000, "cycles", FigureGroup::Needed("circuit_50".into())),
    ];
    report.figures = figures.iter().map(|(name, n, ..)| ((*name).to_owned(), Figure::Count(*n))).collect();
    report.legend = figures.into_iter().map(|(name, _, unit, part)| (name.to_owned(), legend(unit, part))).collect();
    report.derived = derive(&report);
    report
}

/// Limited by the port through which z is written.
pub fn memory_bound() -> Report {
    with_units(&[
        ("rasterizer", &[("busy", 300_000), (">fragments", 690_000), ("done", 10_000)]),
        ("depth-test", &[("busy", 200_000), ("<fragments", 150_000), ("@z", 540_000), (">pixels", 100_000), ("done", 10_000)]),
        ("frame-buffer", &[("busy", 200_000), ("<pixels", 700_000), ("@color", 100_000)]),
    ])
}

/// Limited by the source: display-list arrival.
pub fn source_bound() -> Report {
    with_units(&[
        ("host", &[("busy", 960_000), (">polygons", 0), ("done", 40_000)]),
        ("rasterizer", &[("busy", 250_000), ("<polygons", 730_000), (">fragments", 0), ("done", 20_000)]),
        ("frame-buffer", &[("busy", 200_000), ("<fragments", 800_000)]),
    ])
}

/// Returns a report of two units that wait for each other.
pub fn deadlocked() -> Report {
    let mut report = with_units(&[
        ("fork", &[("busy", 20_000), ("<in", 0), (">left", 980_000), (">right", 0)]),
        ("join", &[("busy", 20_000), ("<left", 0), ("<right", 980_000)]),
    ]);
    report.outcome.kind = OutcomeKind::Deadlock;
    report.outcome.message = Some(
        "deadlock after 1000000 cycles: `fork` waits for a slot in `left` (4 of 4 slots); `join` waits for a token from \
         `right` (0 of 4 slots)"
            .into(),
    );
    report
}

/// Source, unit with a memory client, sink.
fn plan() -> Plan {
    serde_json::from_str(include_str!("../../timeline/tests/plan.json")).unwrap()
}

fn run() -> RunReport {
    basrelief_kernel::run(&mut PlanMachine::new(&plan()).unwrap(), Engine::Timed)
}

/// Report of a run of [`plan`].
pub fn simulated() -> Report {
    Report::timed(context(), &run())
}

/// [`balanced`], and the same run with a quarter of the entries, where the search is not the bottleneck.
pub fn before_and_after() -> (Report, Report) {
    let a = balanced();
    let mut b = a.clone();
    b.config["replacement"]["entries"] = 64.into();
    b.cycles = Some(Cycles { total: 400_000, frames: vec![200_000, 200_000], drain: 0 });
    let rows: [(&str, &[(&str, u64)]); 5] = [
        ("geometry", &[("busy", 30_000), (">polygons", 300_000), ("done", 70_000)]),
        ("rasterizer", &[("busy", 200_000), ("<polygons", 30_000), (">fragments", 150_000), ("done", 20_000)]),
        (
            "normal-mapping",
            &[
                ("busy", 200_000),
                ("<fragments", 40_000),
                (">pseudo_normals", 10_000),
                ("@normals-fine", 135_000),
                ("done", 15_000),
            ],
        ),
        ("replacement", &[("busy", 280_000), ("<pseudo_normals", 110_000), (">indexes", 0), ("done", 10_000)]),
        ("frame-buffer", &[("busy", 200_000), ("<indexes", 195_000), ("@z", 3_000), ("@color", 2_000), ("done", 0)]),
    ];
    b.units = Some(rows.into_iter().map(|(name, row)| (name.to_owned(), unit(row))).collect());
    if let Some(z) = b.memories.as_mut().and_then(|m| m["graphics"].clients.get_mut("z")) {
        z.read_bytes -= 10_000;
    }
    if let Some(quality) = &mut b.quality {
        *quality =
            PictureQuality::of(&[QualityMetrics { psnr_db: 36.5, ssim: 0.961, flip: 0.0512 }], quality.difference).unwrap();
    }
    b.derived = derive(&b);
    (a, b)
}

/// Sets the clock of a report \[Hz\].
pub fn set_clock(report: &mut Report, hz: u64) {
    report.config["clock"]["hz"] = hz.into();
    report.derived = derive(report);
}

/// [`balanced`], with costs.
pub fn costed() -> Report {
    let mut report = balanced();
    let spent = |busy, starved| CycleBreakdown { cycles: busy + starved, busy, starved, ..CycleBreakdown::default() };
    let polygon = |polygon, busy| PolygonCost {
        frame: 1,
        polygon,
        object: Some(3),
        fragments: 40,
        from: 100,
        to: 2_100,
        breakdown: spent(busy, 2_000),
    };
    report.costs = Some(Costs {
        unit_cycles: 5 * TOTAL,
        pixels: spent(1_400_000, 900_000),
        non_pixel: spent(150_000, 50_000),
        unattributed: CycleBreakdown::default(),
        done: 2_500_000,
        frames: vec![spent(800_000, 500_000), spent(750_000, 450_000)],
        objects: vec![ObjectCost {
            object: 3,
            name: "ring".into(),
            polygons: 700,
            fragments: 199_000,
            breakdown: spent(1_500_000, 930_000),
        }],
        polygons: vec![polygon(17, 66_000), polygon(4, 33_000)],
        other_objects: UnlistedCosts::default(),
        other_polygons: UnlistedCosts { count: 698, fragments: 198_920, breakdown: spent(1_401_000, 926_000) },
    });
    report
}

/// Pieces of hardware without area.
pub(crate) fn piece(place: &str, kind: basrelief_kernel::HardwareKind, count: u64, width: u32) -> Hardware {
    let model = basrelief_kernel::AreaModel { area: Default::default(), operators: Default::default(), hz: 1 };
    let piece = basrelief_kernel::Hardware::new(place, kind, "what for", count, width);
    Hardware { area: HardwareArea::default(), ..Hardware::new(&piece, &model) }
}
