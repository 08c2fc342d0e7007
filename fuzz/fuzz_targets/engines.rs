//! Differential test: a tiny trace, built from the bytes, gives the same report on both engines, in JSON Lines and in binary
//! form, and when recorded and replayed.
//!
//! Input: the machine, then the trace, one byte per choice. Missing bytes are 0.

#![no_main]

use basrelief_input::MemoryPool;
use basrelief_trace::*;
use basrelief_kernel::Engine;
use basrelief_report::Report;
use basrelief_sim::{MACHINES, MachineInfo, RunInput, RunOptions, RunError, NoObserver, run};
use basrelief_signals::{Camera, TexelFilter, Lighting, Sampler, WrapMode};
use libfuzzer_sys::fuzz_target;
use std::io::Cursor;

/// Longest run \[cycles\], because the ticked engine takes time for each cycle.
const MOST_CYCLES: u64 = 100_000;

/// Reader of choices.
struct Choices<'a>(&'a [u8]);

impl Choices<'_> {
    fn byte(&mut self) -> u8 {
        let first = self.0.split_off_first();
        first.copied().unwrap_or_default()
    }

    /// Returns a number below `end`, which is at most 256.
    fn below(&mut self, end: u32) -> u32 {
        u32::from(self.byte()) % end
    }

    fn switch(&mut self) -> bool {
        self.byte() % 2 == 1
    }

    /// Returns a number in -1 ..= 1.
    fn signed(&mut self) -> f32 {
        f32::from(self.byte() as i8) / 128.0
    }

    /// Returns a number in 0 ..= 1.
    fn share(&mut self) -> f32 {
        f32::from(self.byte()) / 255.0
    }

    fn some<T>(&mut self, make: impl FnOnce(&mut Self) -> T) -> Option<T> {
        self.switch().then(|| make(self))
    }

    fn per_vertex<const N: usize>(&mut self, count: usize, mut make: impl FnMut(&mut Self) -> [f32; N]) -> Vec<[f32; N]> {
        self.some(|c| (0..count).map(|_| make(c)).collect()).unwrap_or_default()
    }
}

fn texture(c: &mut Choices<'_>, id: u32, kind: TextureKind) -> TextureDefinition {
    let (width, height, seed) = (1 + c.below(9), 1 + c.below(9), c.byte());
    let wrap = [(); 2].map(|()| [WrapMode::Repeat, WrapMode::Mirror, WrapMode::Clamp][c.below(3) as usize]);
    let sampler = Sampler { wrap, filter: if c.switch() { TexelFilter::Nearest } else { TexelFilter::Bilinear } };
    let (levels, offset) = (1 + c.below(width.max(height).ilog2() + 1), 1024 * u64::from(id));
    let (name, sha256) = (format!("t{id}"), Digest::default());
    let mut texture = TextureDefinition { id, name, kind, sampler, width, height, levels, offset, sha256, data: None, file: None };
    let texels: Vec<u8> = (0..texture.texel_count() * kind.texel_bytes()).map(|i| seed.wrapping_mul(i as u8 | 1)).collect();
    texture.sha256 = Digest::of(&texels);
    texture.data = Some(Texels(texels));
    texture
}

fn material(c: &mut Choices<'_>, id: u32) -> MaterialDefinition {
    MaterialDefinition {
        id,
        name: format!("m{id}"),
        base_color: [(); 4].map(|()| c.share()),
        normal_scale: c.signed(),
        lighting: Lighting { ka: c.share(), kd: c.share(), ks: c.share(), n: 1.0 + f32::from(c.byte()) },
        color_texture: c.some(|_| 0),
        normal_map: c.some(|_| 1),
        double_sided: c.switch(),
    }
}

fn frame(c: &mut Choices<'_>, index: u32) -> FrameBegin {
    let mut view_projection = [0.0; 16];
    (0..4).for_each(|i| view_projection[5 * i] = 1.0);
    let camera = Camera { view_projection, to_light: [0.0, 0.0, 1.0], to_viewer: [0.0, 0.0, 1.0] };
    let light = |c: &mut Choices<'_>| {
        let (at, intensity) = ([(); 3].map(|()| c.signed()), c.share());
        if c.switch() {
            LightRecord::Point { position: at, intensity }
        } else {
            LightRecord::Directional { to_light: at, intensity }
        }
    };
    FrameBegin { index, camera, lights: (0..=c.below(2)).map(|_| light(c)).collect() }
}

fn polygon(c: &mut Choices<'_>, object: u32, arrival: &mut u64) -> PolygonRecord {
    let count = 3 + c.below(4) as usize;
    *arrival += u64::from(c.byte());
    let position = |c: &mut Choices<'_>| [c.signed() * 20.0, c.signed() * 20.0, c.share(), 0.1 + c.share()];
    PolygonRecord {
        object,
        material: c.below(2),
        lod: c.byte() % 64,
        bump: c.switch(),
        arrival: *arrival,
        position: (0..count).map(|_| position(c)).collect(),
        normal: c.per_vertex(count, |c| [(); 3].map(|()| c.signed())),
        tangent: c.per_vertex(count, |c| [(); 4].map(|()| c.signed())),
        uv: c.per_vertex(count, |c| [(); 2].map(|()| 3.0 * c.signed())),
        uv_normal: c.per_vertex(count, |c| [(); 2].map(|()| 3.0 * c.signed())),
        color: c.per_vertex(count, |c| [(); 4].map(|()| c.share())),
        brightness: c.per_vertex(count, |c| [(); 2].map(|()| c.share())),
    }
}

fn commands(c: &mut Choices<'_>) -> Vec<TraceCommand> {
    let mut all = vec![TraceCommand::Begin(BeginCommand::new(1 + c.below(16), 1 + c.below(16)))];
    all.push(TraceCommand::Texture(texture(c, 0, TextureKind::Color)));
    all.push(TraceCommand::Texture(texture(c, 1, TextureKind::Normal)));
    all.extend([0, 1].map(|id| TraceCommand::Material(material(c, id))));
    let mut arrival = 0;
    for index in 0..=c.below(2) {
        all.push(TraceCommand::Frame(frame(c, index)));
        for id in 0..c.below(3) {
            let (name, centre) = (format!("o{id}"), [(); 3].map(|()| c.signed()));
            let entries = c.some(|c| 1 + c.below(64));
            all.push(TraceCommand::Object(ObjectBegin { id, name, centre, entries, mesh: None }));
            all.extend((0..c.below(4)).map(|_| TraceCommand::Polygon(polygon(c, id, &mut arrival))));
        }
        all.push(TraceCommand::FrameEnd(FrameEnd {}));
    }
    all
}

fn written(commands: &[TraceCommand], encoding: TraceEncoding) -> Vec<u8> {
    let mut writer = TraceWriter::new(Vec::new(), TraceForm { encoding, compressed: false }).expect("in memory");
    commands.iter().for_each(|command| writer.write(command).expect("a valid command"));
    writer.finish().expect("in memory")
}

/// Returns a trace of the same tokens, recorded.
fn recorded(trace: &[u8]) -> Vec<u8> {
    let resolver = TraceResolver::new(trace, NoFiles, &MemoryPool::default()).expect("a valid trace");
    let mut recorder = TraceRecorder::new(Vec::new(), TraceForm::default(), resolver.begin().clone()).expect("a valid begin");
    resolver.for_each(|control| recorder.record(&control.expect("a valid trace").0).expect("what resolves can be recorded"));
    recorder.finish(vec![]).expect("in memory")
}

fn report(machine: &MachineInfo, trace: Vec<u8>, engine: Engine) -> Result<Report, String> {
    let config = machine.load("", &[]).expect("defaults");
    let options = RunOptions { config, engine: Some(engine), max_cycles: MOST_CYCLES, exact: false, ..RunOptions::default() };
    match run(RunInput::trace(Cursor::new(trace), "fuzz"), &options, &mut NoObserver, None) {
        Ok(run) => Ok(run.report),
        Err(RunError::Fault(fault)) => Err(fault),
        Err(error) => panic!("{error}"),
    }
}

fuzz_target!(|bytes: &[u8]| {
    let mut choices = Choices(bytes);
    let machine = MACHINES[choices.below(MACHINES.len() as u32) as usize];
    let commands = commands(&mut choices);
    let trace = written(&commands, TraceEncoding::JsonLines);
    let timed = report(&machine, trace.clone(), Engine::Timed);
    assert_eq!(report(&machine, trace.clone(), Engine::Ticked), timed, "ticked");
    assert_eq!(report(&machine, written(&commands, TraceEncoding::Binary), Engine::Timed), timed, "binary");
    assert_eq!(report(&machine, recorded(&trace), Engine::Timed), timed, "recorded");
});
