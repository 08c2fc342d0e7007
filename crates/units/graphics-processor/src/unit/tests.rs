use super::*;
use basrelief_signals::{Image, Material, Sampler, Vertex};

fn texture(levels: &[[u8; 4]]) -> Arc<Texture> {
    let side = |k: usize| 1u32 << (levels.len() - 1 - k);
    let level = |(k, &texel): (usize, &[u8; 4])| Image {
        width: side(k),
        height: side(k),
        texels: vec![texel; (side(k) * side(k)) as usize],
    };
    let levels = levels.iter().enumerate().map(level).collect();
    Arc::new(Texture { id: 0, name: String::new(), sampler: Sampler::default(), levels, offset: 1600, elsewhere: None })
}

/// Creates a triangle of 4 x 4 / 2 pixels with the texture mapped once over it.
fn polygon(bump: bool, material: Material) -> Control {
    let vertex = |x: f32, y: f32, brightness| Vertex {
        position: [4.0 * x, 4.0 * y, 0.5, 1.0],
        uv: [x, y],
        color: [1.0, 0.5, 1.0, 1.0],
        brightness,
        ..Vertex::default()
    };
    let vertices = vec![vertex(0.0, 0.0, [0.2, 0.1]), vertex(1.0, 0.0, [0.6, 0.1]), vertex(0.0, 1.0, [0.2, 0.5])];
    let material = Arc::new(material);
    Control::Polygon(Arc::new(Polygon { vertices, material, object: 0, lod: 0, bump, arrival: 0 }))
}

fn shaded(x: u16, brightness: f32, highlight: f32) -> Flow<Stamp<ShadedFragment>> {
    Flow::Item(Stamp::from_iter([ShadedFragment { fragment: fragment(x), brightness, highlight }]))
}

fn fragment(x: u16) -> Fragment {
    Fragment { x, y: 1, z: 7, weights: [0.5, 0.25], triangle: 0 }
}

type Token<T> = Flow<Stamp<T>>;

/// Test bench that feeds both inputs in the order that the unit demands, until they are empty. It collects the tokens out and the
/// traffic of each step.
struct Bench {
    unit: GraphicsProcessor,
    inputs: (Vec<Token<ShadedFragment>>, Vec<Token<Fragment>>),
    /// True if the last polygon fed is not a bump target.
    plain: bool,
    out: Vec<Flow<Stamp<Pixel>>>,
    traffic: Vec<MemoryPorts>,
}

impl Bench {
    fn new(config: GraphicsConfig, separate: bool) -> Self {
        Self::holding(config, separate, 8)
    }

    /// Creates a bench with entries of `entry_bits` bits.
    fn holding(config: GraphicsConfig, separate: bool, entry_bits: u32) -> Self {
        let unit = GraphicsProcessor::new(config, Operators::default(), separate, [4, 64, entry_bits]);
        Self { unit, inputs: Default::default(), plain: false, out: Vec::new(), traffic: Vec::new() }
    }

    fn control(mut self, control: &Control) -> Self {
        self.inputs.0.push(Flow::Control(control.clone()));
        let ends_plain = std::mem::replace(&mut self.plain, super::is_plain(control));
        if ends_plain || self.plain {
            self.inputs.1.push(Flow::Control(control.clone()));
        }
        self
    }

    fn bump(mut self, token: Flow<Stamp<ShadedFragment>>) -> Self {
        self.inputs.0.push(token);
        self
    }

    fn plain(mut self, fragment: Fragment) -> Self {
        self.inputs.1.push(Flow::Item(Stamp::from_iter([fragment])));
        self
    }

    fn run(mut self) -> Self {
        let mut a = std::mem::take(&mut self.inputs.0).into_iter();
        let mut b = std::mem::take(&mut self.inputs.1).into_iter();
        loop {
            let demand = self.unit.demand();
            let input = (if demand.takes(0) { a.next() } else { None }, if demand.takes(1) { b.next() } else { None });
            if (demand.takes(0) && input.0.is_none()) || (demand.takes(1) && input.1.is_none()) {
                assert!(a.next().is_none() && b.next().is_none(), "stuck at {demand:?}");
                return self;
            }
            let mut traffic = MemoryPorts::default();
            self.out.extend(self.unit.step(input, &mut traffic).out);
            for client in 0..2 {
                let requests = traffic.requests().iter().filter(|r| r.client == client).count();
                let look_ups = traffic.look_ups().iter().filter(|r| r.client == client).count();
                assert!((requests + look_ups) as u32 <= self.unit.largest_step(client as usize));
            }
            self.traffic.push(traffic);
        }
    }

    /// Returns the requests for entries: write or read, offset from the first entry, bytes.
    fn entries(&self) -> Vec<(bool, u64, u32)> {
        let all = self.traffic.iter().flat_map(MemoryPorts::requests);
        all.map(|r| (r.write, r.address - layout::HELD_RESULTS, r.bytes)).collect()
    }

    fn pixels(&self) -> Vec<Pixel> {
        self.out.iter().filter_map(|t| if let Flow::Item(p) = t { Some(p[0]) } else { None }).collect()
    }
}

#[test]
fn list_order_is_restored_and_control_leaves_once() {
    let (bump, plain) = (polygon(true, Material::default()), polygon(false, Material::default()));
    for draw in [DrawOrder::Streamed, DrawOrder::AfterList] {
        let bench = Bench::new(GraphicsConfig { draw, ..GraphicsConfig::default() }, false)
            .control(&bump)
            .bump(shaded(1, 1.0, 0.0))
            .bump(shaded(2, 1.0, 0.0))
            .control(&plain)
            .plain(fragment(3))
            .control(&bump)
            .control(&plain)
            .plain(fragment(4))
            .control(&Control::FrameEnd)
            .run();
        let marks: Vec<u16> = bench
            .out
            .iter()
            .map(|t| match t {
                Flow::Item(p) => p[0].x,
                Flow::Control(Control::FrameEnd) => 99,
                Flow::Control(c) => {
                    if *c == bump {
                        10
                    } else {
                        20
                    }
                }
            })
            .collect();
        assert_eq!(marks, [10, 1, 2, 20, 3, 10, 20, 4, 99], "{draw:?}");
        assert!(bench.unit.is_empty());
        assert_eq!(bench.unit.state.counters.pixels, 4);
    }
}

#[test]
fn bump_target_is_blended_with_brightness_and_highlight() {
    let material = Material { base_color: [0.5, 1.0, 1.0, 1.0], ..Material::default() };
    let bench = Bench::new(GraphicsConfig::default(), true).control(&polygon(true, material)).bump(shaded(1, 0.5, 0.25)).run();
    assert_eq!(bench.pixels(), [Pixel { x: 1, y: 1, z: 7, rgb: [128, 128, 191] }]);
}

#[test]
fn plain_polygon_takes_brightness_from_vertices() {
    let material = Material { base_color: [0.5, 1.0, 1.0, 1.0], ..Material::default() };
    let rgb = |separate| {
        let plain = polygon(false, material.clone());
        Bench::new(GraphicsConfig::default(), separate).control(&plain).plain(fragment(1)).run().pixels()[0].rgb
    };
    // Brightness 0.4 and 0.2 at the fragment.
    let eight = |v: f32| (v * 255.0).round() as u8;
    assert_eq!(rgb(false), [eight(0.3), eight(0.3), eight(0.6)]);
    assert_eq!(rgb(true), [eight(0.4), eight(0.4), eight(0.6)]);
}

#[test]
fn texture_level_follows_polygon_texel_ratio() {
    // 8 x 8 texels on 4 x 4 pixels: LOD 8, level 1.
    let map = texture(&[[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255; 4]]);
    let material = Material { color_texture: Some(map), ..Material::default() };
    let run_with = |line_bytes, config: GraphicsConfig| {
        let unit = GraphicsProcessor::new(config.clone(), Operators::default(), false, [4, line_bytes, 8]);
        let bench = Bench { unit, ..Bench::new(config, false) };
        bench.control(&polygon(true, material.clone())).bump(shaded(1, 1.0, 0.0)).run()
    };
    let run = |config| run_with(4, config);
    let nearest = run(GraphicsConfig::default());
    assert_eq!(nearest.pixels()[0].rgb, [0, 128, 0]);
    let base = layout::COLOR_TEXTURES + (1600 + 64) * 4;
    let addresses: Vec<u64> = nearest.traffic[1].look_ups().iter().map(|r| r.address - base).collect();
    // uv (0.5, 0.25) of 4 x 4 texels: columns 1 and 2, rows 0 and 1.
    assert_eq!(addresses, [4, 8, 20, 24]);
    let in_one_line = run_with(64, GraphicsConfig::default());
    let looked_up: Vec<u64> = in_one_line.traffic[1].look_ups().iter().map(|r| r.address / 64).collect();
    assert_eq!(looked_up, [base / 64]);
    assert_eq!(nearest.unit.state.counters.textured, 1);
    let off = run(GraphicsConfig { mip: MipFilter::Off, filter: TexelFilter::Nearest, ..GraphicsConfig::default() });
    assert_eq!(off.pixels()[0].rgb, [255, 0, 0]);
    assert_eq!(off.traffic[1].look_ups().len(), 1);
}

const AFTER_LIST: GraphicsConfig = GraphicsConfig {
    draw: DrawOrder::AfterList,
    filter: TexelFilter::Bilinear,
    mip: MipFilter::Nearest,
    texel_bytes: 4,
    multipliers: 41,
    adders: 38,
    held: crate::HeldEntry::Brightness,
    hold_fragments: 1000,
};

#[test]
fn bump_entries_are_written_and_read_by_lines() {
    let bump = polygon(true, Material::default());
    let mut bench = Bench::new(AFTER_LIST, false);
    for _ in 0..2 {
        bench = bench.control(&bump);
        for _ in 0..30 {
            bench = bench.bump(shaded(1, 1.0, 0.0));
        }
        bench = bench.control(&Control::FrameEnd).run();
        // A byte of brightness and four of its position: 30 times 5 bytes.
        let lines = |write| [(write, 0, 64), (write, 64, 64), (write, 128, 22)];
        assert_eq!(bench.entries(), [lines(true), lines(false)].concat(), "each frame starts afresh");
        bench.traffic.clear();
    }
    assert_eq!((bench.unit.state.counters.held, bench.unit.state.counters.pixels), (60, 60));
}

#[test]
fn waiting_fragment_has_size_of_its_entry() {
    let bytes = |entry_bits| {
        let Flow::Item(mut stamp) = shaded(1, 1.0, 0.0) else { panic!() };
        stamp.push(ShadedFragment { fragment: fragment(2), brightness: 0.5, highlight: 0.0 });
        let bench = Bench::holding(AFTER_LIST, false, entry_bits)
            .control(&polygon(true, Material::default()))
            .bump(Flow::Item(stamp))
            .control(&Control::FrameEnd)
            .run();
        let [written, read] = [true, false].map(|w| bench.entries().iter().filter(|e| e.0 == w).map(|e| e.2).sum::<u32>());
        assert_eq!(written, read);
        written
    };
    // Two fragments of a stamp: brightness, indexes of two levels, or normals of two levels.
    assert_eq!([8, 16, 96].map(bytes), [4 + 2, 4 + 2 * 2, 4 + 2 * 12]);
}

#[test]
fn plain_polygons_do_not_wait_in_memory() {
    let bench = Bench::new(AFTER_LIST, false)
        .control(&polygon(false, Material::default()))
        .plain(fragment(1))
        .plain(fragment(2))
        .control(&Control::FrameEnd)
        .run();
    assert_eq!(bench.entries(), []);
    assert_eq!((bench.unit.state.counters.held, bench.pixels().len()), (0, 2));
}

#[test]
fn too_many_waiting_fragments_fault_names_parameter() {
    for bump in [true, false] {
        let mut bench = Bench::new(GraphicsConfig { hold_fragments: 1, ..AFTER_LIST }, false);
        bench = bench.control(&polygon(bump, Material::default()));
        for x in 0..2 {
            bench = if bump { bench.bump(shaded(x, 1.0, 0.0)) } else { bench.plain(fragment(x)) };
        }
        let bench = bench.run();
        let faults: Vec<_> = bench.traffic.iter().map(|t| format!("{t:?}").contains("graphics.hold_fragments")).collect();
        assert_eq!(faults.iter().position(|fault| *fault), Some(faults.len() - 1));
        assert_eq!(faults.iter().filter(|fault| **fault).count(), 1);
    }
}

#[test]
fn pixel_uses_operators_of_its_polygon() {
    let kept = |bump, material: Material| {
        let config = GraphicsConfig { multipliers: 1, adders: 1024, ..GraphicsConfig::default() };
        let mut unit = GraphicsProcessor::new(config, Operators::default(), false, [4, 64, 8]);
        let Control::Polygon(coloured) = polygon(bump, material) else { panic!() };
        let vertices = coloured.vertices.iter().map(|v| Vertex { color: [1.0; 4], ..*v }).collect();
        unit.state.polygon = None;
        unit.take_effect(&Control::Polygon(Arc::new(Polygon { vertices, ..Polygon::clone(&coloured) })));
        let white = unit.state.pace;
        unit.take_effect(&Control::Polygon(coloured));
        (white, unit.state.pace)
    };
    let textured = Material { color_texture: Some(texture(&[[255; 4]])), ..Material::default() };
    // Base colour and brightness 6, colours at the vertices 6 + 3, brightness at the vertices 4, a filtered texture 22.
    assert_eq!(kept(true, Material::default()), (6, 15));
    assert_eq!(kept(false, Material::default()), (10, 19));
    assert_eq!(kept(true, textured), (28, 37));
}

#[test]
fn unit_reports_operators_and_lines_of_entries() {
    let told = |draw| {
        let mut facts = UnitStats::default();
        let config = GraphicsConfig { draw, multipliers: 7, ..GraphicsConfig::default() };
        GraphicsProcessor::new(config, Operators::default(), false, [4, 64, 8]).report_stats(&mut facts);
        let multipliers = facts.all_hardware().iter().find(|h| h.kind == HardwareKind::Multiplier).map(|h| h.count);
        (multipliers, facts.all_hardware().iter().map(basrelief_kernel::Hardware::bits).sum::<u64>())
    };
    let (streamed, after_list) = (told(DrawOrder::Streamed), told(DrawOrder::AfterList));
    assert_eq!((streamed.0, after_list.1 - streamed.1), (Some(7), 2 * 64 * 8));
}

#[test]
fn different_duplicates_and_misplaced_fragments_are_faults() {
    let mut unit = GraphicsProcessor::new(GraphicsConfig::default(), Operators::default(), false, [4, 64, 8]);
    let mut traffic = MemoryPorts::default();
    unit.step((Some(shaded(1, 1.0, 0.0)), Some(Flow::Item(Stamp::from_iter([fragment(1)])))), &mut traffic);
    assert!(format!("{traffic:?}").contains("a fragment where a control token was due"));
    let mut traffic = MemoryPorts::default();
    let frame_end = Control::FrameEnd;
    unit.step((Some(Flow::Control(polygon(false, Material::default()))), None), &mut traffic);
    unit.step((None, Some(Flow::Control(frame_end))), &mut traffic);
    assert!(format!("{traffic:?}").contains("different control tokens"));
}

#[test]
fn filter_and_factors_begin_with_their_texels() {
    let operators = Operators { multiply: basrelief_kernel::OperatorConfig::new(10, 1), ..Operators::default() };
    let mut unit = GraphicsProcessor::new(GraphicsConfig::default(), operators, false, [4, 64, 8]);
    let polygon = polygon(true, Material { color_texture: Some(texture(&[[255; 4], [255; 4]])), ..Material::default() });
    unit.step((Some(Flow::Control(polygon)), None), &mut MemoryPorts::default());
    let step = unit.step((Some(shaded(1, 0.5, 0.0)), None), &mut MemoryPorts::default());
    // Filter and four products; two sums each for filter and limit. Before them: coordinates, address, weights.
    assert_eq!((step.after_data, step.latency), (5 * 10 + 4, 8 * 10 + 8));
}

#[test]
fn work_on_held_entry_begins_with_the_entry() {
    let config = GraphicsConfig { draw: DrawOrder::AfterList, ..GraphicsConfig::default() };
    let mut unit = GraphicsProcessor::new(config, Operators::default(), false, [4, 64, 8]);
    for token in [Flow::Control(polygon(true, Material::default())), shaded(1, 0.5, 0.0), Flow::Control(Control::FrameEnd)] {
        unit.step((Some(token), None), &mut MemoryPorts::default());
    }
    let steps: Vec<Out> = (0..3).map(|_| unit.step((None, None), &mut MemoryPorts::default())).collect();
    assert!(steps.iter().all(|step| u64::from(step.after_data) == step.latency), "{steps:?}");
}
