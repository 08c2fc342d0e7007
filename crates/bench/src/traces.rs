//! Readers and writers of traces: the display list of W1 in all four forms, without its texels, which are read faster than
//! polygons.
//!
//! Throughput is in bytes of the JSON Lines for every form: the same content, so that forms can be compared.

use crate::machines::demo_scene;
use crate::workload::{RunSample, ThroughputUnit, Workload, WorkloadSize, measured};
use basrelief_input::MemoryPool;
use basrelief_signals::{Camera, Control, Lighting};
use basrelief_sim::{MachineConfig, display_list, trace_header};
use basrelief_trace::{
    BeginCommand, FrameBegin, FrameEnd, LightRecord, MaterialDefinition, NoFiles, ObjectBegin, PolygonRecord, TraceCommand,
    TraceEncoding, TraceError, TraceForm, TraceRecorder, TraceResolver, TraceWriter, convert, open,
};
use std::hint::black_box;
use std::io::{Write, sink};
use std::rc::Rc;
use std::sync::Arc;

/// Returns the JSON Lines of the display list of W1 without its normal map, with at most this many polygons.
fn json_lines(size: WorkloadSize) -> Vec<u8> {
    let most = size.of(usize::MAX, 1_000);
    let mut scene = demo_scene("sphere", [640, 480]);
    scene.objects.iter_mut().for_each(|object| {
        let object = Arc::make_mut(object);
        object.bump = Some(true);
        Arc::make_mut(&mut object.material).normal_map = None;
    });
    let scene = Arc::new(scene);
    let mut polygons = 0;
    let shortened = display_list(&scene, &MachineConfig::default()).filter(|control| {
        polygons += usize::from(matches!(control, Control::Polygon(_)));
        polygons <= most || !matches!(control, Control::Polygon(_))
    });
    let recorded = || {
        let mut recorder = TraceRecorder::new(Vec::new(), TraceForm::default(), trace_header(&scene))?;
        shortened.into_iter().try_for_each(|control| recorder.record(&control))?;
        recorder.finish(Vec::new())
    };
    recorded().expect("writing into memory")
}

fn name_of(form: TraceForm) -> String {
    let encoding = match form.encoding {
        TraceEncoding::JsonLines => "json-lines",
        TraceEncoding::Binary => "binary",
    };
    if form.compressed { format!("{encoding}-zstd") } else { encoding.into() }
}

/// Reads a trace to its end. Returns the number of commands.
fn read(bytes: &[u8]) -> Result<usize, TraceError> {
    open(bytes, &MemoryPool::default())?
        .try_fold(0, |count, command| command.map(|command| count + usize::from(black_box(command).name() == "polygon")))
}

/// Reads a trace as [`read`], and resolves it into tokens.
fn resolve(bytes: &[u8]) -> Result<usize, TraceError> {
    TraceResolver::new(bytes, NoFiles, &MemoryPool::default())?
        .try_fold(0, |count, control| control.map(|control| count + black_box([control]).len()))
}

fn write(commands: &[TraceCommand], form: TraceForm) -> Result<usize, TraceError> {
    let mut writer = TraceWriter::new(sink(), form)?;
    commands.iter().try_for_each(|command| writer.write(command))?;
    writer.finish().map(|_| commands.len())
}

/// Returns reading, resolving and writing.
pub fn workloads(size: WorkloadSize) -> Vec<Workload> {
    let reading = |what: &str, form: TraceForm, run: fn(&[u8]) -> Result<usize, TraceError>| {
        Workload::new(format!("trace/{what}/{}", name_of(form)), ThroughputUnit::Bytes, move || {
            let json = json_lines(size);
            let mut bytes = Vec::new();
            convert(json.as_slice(), &mut bytes, form, &MemoryPool::default()).expect("the trace is sound");
            move || {
                let (done, time) = measured(|| run(&bytes));
                done.expect("the trace is sound");
                RunSample { time, count: json.len() as u64 }
            }
        })
    };
    let writing = |form: TraceForm| {
        Workload::new(format!("trace/write/{}", name_of(form)), ThroughputUnit::Bytes, move || {
            let json = json_lines(size);
            let commands: Result<Vec<TraceCommand>, _> =
                open(json.as_slice(), &MemoryPool::default()).expect("the trace is sound").collect();
            let commands = Rc::new(commands.expect("the trace is sound"));
            move || {
                let (done, time) = measured(|| write(&commands, form));
                done.expect("the trace is sound");
                RunSample { time, count: json.len() as u64 }
            }
        })
    };
    let plain = TraceForm::ALL.into_iter().filter(|form| !form.compressed);
    let mut all: Vec<Workload> = TraceForm::ALL.into_iter().map(|form| reading("read", form, read)).collect();
    all.extend(plain.map(|form| reading("resolve", form, resolve)));
    all.extend(TraceForm::ALL.into_iter().map(writing));
    all
}

/// Width and height of a generated trace \[pixels\].
const GENERATED: [u32; 2] = [640, 480];
/// Side of its triangles \[pixels\].
const SIDE: u64 = 4;

/// Writes a trace of this many small triangles, row after row and layer over layer, in JSON Lines. It keeps nothing in memory.
///
/// # Errors
/// Returns an error if `out` cannot be written.
pub fn generate(polygons: u64, out: impl Write) -> Result<(), TraceError> {
    let mut writer = TraceWriter::new(out, TraceForm::default())?;
    let [width, height] = GENERATED;
    writer.write(&TraceCommand::Begin(BeginCommand::new(width, height)))?;
    let (name, color) = (String::from("sheet"), [0.8, 0.6, 0.4, 1.0]);
    let (color_texture, normal_map, double_sided) = (None, None, false);
    let (lighting, normal_scale) = (Lighting::default(), 1.0);
    let material = MaterialDefinition {
        id: 0,
        name: name.clone(),
        base_color: color,
        normal_scale,
        lighting,
        color_texture,
        normal_map,
        double_sided,
    };
    writer.write(&TraceCommand::Material(material))?;
    let camera = Camera { view_projection: [0.0; 16], to_light: [0.0, 0.0, 1.0], to_viewer: [0.0, 0.0, 1.0] };
    let lights = vec![LightRecord::Directional { to_light: [0.0, 0.0, 1.0], intensity: 1.0 }];
    writer.write(&TraceCommand::Frame(FrameBegin { index: 0, camera, lights }))?;
    writer.write(&TraceCommand::Object(ObjectBegin { id: 0, name, centre: [0.0; 3], entries: None, mesh: None }))?;
    (0..polygons).try_for_each(|n| writer.write(&TraceCommand::Polygon(triangle(n))))?;
    writer.write(&TraceCommand::FrameEnd(FrameEnd {}))?;
    writer.finish().map(drop)
}

fn triangle(n: u64) -> PolygonRecord {
    let [columns, rows] = GENERATED.map(|side| u64::from(side) / SIDE);
    let [x, y] = [n % columns * SIDE, n / columns % rows * SIDE].map(|at| at as f32);
    let side = SIDE as f32;
    let tilt = (n % 97) as f32 / 970.0;
    PolygonRecord {
        object: 0,
        material: 0,
        lod: 0,
        bump: false,
        arrival: n,
        position: [[x, y], [x + side, y], [x, y + side]].map(|[x, y]| [x, y, 0.5, 1.0]).to_vec(),
        normal: vec![[tilt, -tilt, 1.0]; 3],
        tangent: Vec::new(),
        uv: Vec::new(),
        uv_normal: Vec::new(),
        color: Vec::new(),
        brightness: vec![[0.75 + tilt, tilt]; 3],
    }
}
