//! Graphics processor (104) and z-test keep the unit contract in every position and drawing order.

use basrelief_graphics_processor::{DepthConfig, DepthTest, DrawOrder, GraphicsConfig, GraphicsProcessor};
use basrelief_kernel::Operators;
use basrelief_kernel_conformance::unit_contract;
use basrelief_signals::{
    Control, Flow, Fragment, Frame, Image, Material, ObjectInfo, Pixel, Polygon, Sampler, ShadedFragment, Stamp, Texture, Vertex,
};
use std::sync::Arc;

fn frame(index: u32) -> Control {
    Control::Frame(Arc::new(Frame { index, width: 32, height: 16, ..Frame::default() }))
}

fn texture() -> Arc<Texture> {
    let level = |side: u32| Image {
        width: side,
        height: side,
        texels: (0..side * side).map(|i| [(i % 251) as u8, (i * 7 % 251) as u8, side as u8, 255]).collect(),
    };
    let levels = [32, 16, 8, 4, 2, 1].map(level).to_vec();
    Arc::new(Texture { id: 0, name: "t".into(), sampler: Sampler::default(), levels, offset: 640, elsewhere: None })
}

fn polygon(bump: bool, material: Material) -> Control {
    let vertex = |x: f32, y: f32| Vertex {
        position: [32.0 * x, 16.0 * y, 0.5, 1.0],
        uv: [3.0 * x, 3.0 * y],
        color: [1.0, 0.5 + 0.5 * x, 1.0, 1.0],
        brightness: [0.2 + x, 0.1 * y],
        ..Vertex::default()
    };
    let vertices = vec![vertex(0.0, 0.0), vertex(1.0, 0.0), vertex(1.0, 1.0), vertex(0.0, 1.0)];
    Control::Polygon(Arc::new(Polygon { vertices, material: Arc::new(material), object: 0, lod: 0, bump, arrival: 0 }))
}

fn fragment(i: u16) -> Fragment {
    let weights = [f32::from(i % 5) / 10.0, f32::from(i % 3) / 6.0];
    Fragment { x: 7 * i % 32, y: 5 * i % 16, z: u32::from(i * 37 % 101), weights, triangle: i % 2 }
}

fn shaded(i: u16) -> Flow<Stamp<ShadedFragment>> {
    let one =
        |i: u16| ShadedFragment { fragment: fragment(i), brightness: f32::from(i % 9) / 7.0, highlight: f32::from(i % 4) / 9.0 };
    // Fragments of one triangle.
    Flow::Item((0..=i % 3).map(|k| one(i + 2 * k)).collect())
}

type ShadingSettings = Vec<Flow<Stamp<ShadedFragment>>>;
type Plain = Vec<Flow<Stamp<Fragment>>>;

/// Returns two frames of bump targets and other polygons, textured and not, some without fragments, on the two paths.
fn both_ways() -> (ShadingSettings, Plain) {
    let textured = Material { id: 1, color_texture: Some(texture()), ..Material::default() };
    let bare = Material { base_color: [0.9, 0.4, 0.1, 1.0], ..Material::default() };
    let object = ObjectInfo { name: "o".into(), ..ObjectInfo::default() };
    let (mut bump_way, mut plain_way) = (Vec::new(), Vec::new());
    let mut after_plain = false;
    let mut control = |c: Control, plain: bool, ways: (&mut ShadingSettings, &mut Plain)| {
        if plain || after_plain {
            ways.1.push(Flow::Control(c.clone()));
        }
        ways.0.push(Flow::Control(c));
        after_plain = plain;
    };
    for index in 0..2 {
        control(frame(index), false, (&mut bump_way, &mut plain_way));
        control(Control::Object(Arc::new(object.clone())), false, (&mut bump_way, &mut plain_way));
        for (n, (bump, material)) in
            [(true, &textured), (false, &bare), (false, &textured), (true, &bare), (false, &bare), (true, &textured)]
                .into_iter()
                .enumerate()
        {
            control(polygon(bump, material.clone()), !bump, (&mut bump_way, &mut plain_way));
            let fragments = if n == 4 { 0..0 } else { 0..9 + n as u16 };
            match bump {
                true => bump_way.extend(fragments.map(shaded)),
                false => plain_way.extend(fragments.map(|i| Flow::Item(Stamp::from_iter([fragment(i)])))),
            }
        }
        control(Control::FrameEnd, false, (&mut bump_way, &mut plain_way));
    }
    (bump_way, plain_way)
}

unit_contract! {
    name: graphics_processor_streamed,
    unit: GraphicsProcessor::new(GraphicsConfig::default(), Operators::default(), false, [4, 64, 8]),
    inputs: both_ways(),
    clients: [ClientKind::Cache { line_bytes: 64 }, ClientKind::Port],
    state,
}

unit_contract! {
    name: graphics_processor_after_list,
    unit: GraphicsProcessor::new(
        GraphicsConfig { draw: DrawOrder::AfterList, adders: 3, ..GraphicsConfig::default() }, Operators::default(), true, [4, 64, 96],
    ),
    inputs: both_ways(),
    clients: [ClientKind::Cache { line_bytes: 64 }, ClientKind::Port],
    state,
}

unit_contract! {
    name: graphics_processor_of_texels_that_straddle_lines,
    unit: GraphicsProcessor::new(GraphicsConfig { texel_bytes: 12, ..GraphicsConfig::default() }, Operators::default(), false, [4, 64, 8]),
    inputs: both_ways(),
    clients: [ClientKind::Cache { line_bytes: 64 }, ClientKind::Port],
    state,
}

/// Returns two frames of items that hide each other, some of them outside the frame.
fn flow<T>(item: impl Fn(Fragment) -> T) -> Vec<Flow<Stamp<T>>> {
    let outside = Fragment { x: 32, y: 3, ..Fragment::default() };
    let frame = |index| {
        let items = (0..120).map(fragment).chain([outside]).map(|f| Flow::Item(Stamp::from_iter([item(f)])));
        let mut all = vec![Flow::Control(frame(index)), Flow::Control(polygon(true, Material::default()))];
        all.extend(items);
        all.push(Flow::Control(Control::FrameEnd));
        all
    };
    (0..2).flat_map(frame).collect()
}

unit_contract! {
    name: early_depth_test,
    unit: DepthTest::<Stamp<Fragment>>::new(DepthConfig::default(), &Operators::default(), 24, 64),
    inputs: flow(|fragment| fragment),
    clients: [ClientKind::Cache { line_bytes: 64 }, ClientKind::Port],
    state,
}

unit_contract! {
    name: late_depth_test,
    unit: DepthTest::<Stamp<Pixel>>::new(DepthConfig { flags: 9, ..DepthConfig::default() }, &Operators::default(), 16, 64),
    inputs: flow(|f| Pixel { x: f.x, y: f.y, z: f.z, rgb: [f.x as u8, f.y as u8, 9] }),
    clients: [ClientKind::Cache { line_bytes: 32 }, ClientKind::Port],
    state,
}

unit_contract! {
    name: depth_test_without_flags_and_with_a_cache_of_small_lines,
    unit: DepthTest::<Stamp<Fragment>>::new(DepthConfig { write_lines: 2, clear_flags: false, ..DepthConfig::default() }, &Operators::default(), 24, 8),
    inputs: flow(|fragment| fragment),
    clients: [ClientKind::Cache { line_bytes: 8 }, ClientKind::Port],
    state,
}
