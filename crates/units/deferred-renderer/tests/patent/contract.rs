//! Every unit keeps the unit contract. The tokens are those of two frames in the mode of best resolution, and of two in the
//! progressive one.

use crate::texture;
use crate::two_wires::{Either, Requested, TwoInputs, TwoOutputs};
use basrelief_deferred_renderer::tokens::{
    CellFlow, EncodedTile, ExpandedTile, MarkFlow, PassFlow, PassRound, PlacedCell, ResponseContent, StoreOrder, TileMark,
    TileRequest, TileResponse,
};
use basrelief_deferred_renderer::{
    CellConfig, CellFormat, Cells, EngineConfig, Expander, Identification, Path, PathConfig, PyramidCut, Rasterization,
    ReferenceBuffer, ReferenceCell, RenderMode, RendererConfig, TableSizes, TileConfig, TileLists, TileOrder, ViewpointEnds,
};
use basrelief_kernel::{Demand, MemoryPorts, Operators, Unit};
use basrelief_kernel_conformance::unit_contract;
use basrelief_signals::{Control, Flow, Fragment, Frame, Material, Polygon, Stamp, Vertex};
use std::sync::Arc;

fn polygon(material: Material, repeats: f32) -> Control {
    let corner = |x, y, q, u, v| Vertex { position: [x, y, 0.5, q], uv: [u, v], ..Vertex::default() };
    let vertices = [corner(0.0, 0.0, 1.0, 0.0, 0.0), corner(40.0, 0.0, 0.3, repeats, 0.0), corner(0.0, 30.0, 0.5, 0.0, repeats)];
    let (vertices, material) = (vertices.into_iter().collect(), Arc::new(material));
    Control::Polygon(Arc::new(Polygon { vertices, material, object: 0, lod: 0, bump: false, arrival: 0 }))
}

/// Returns the control tokens of two frames.
fn controls() -> Vec<Control> {
    let texture = texture([64, 48]);
    let one = |index: u32, repeats: f32| {
        let textures = if index == 0 { vec![Arc::clone(&texture)] } else { vec![] };
        let frame = Frame { index, width: 22, height: 13, textures, ..Frame::default() };
        let textured = Material { id: 1, color_texture: Some(Arc::clone(&texture)), ..Material::default() };
        let plain = Material { id: 2, base_color: [0.2, 0.7, 0.4, 1.0], ..Material::default() };
        [Control::Frame(Arc::new(frame)), polygon(textured, repeats), polygon(plain, 1.0), Control::FrameEnd]
    };
    [one(0, 3.0), one(1, 0.4)].concat()
}

/// Returns the control tokens with fragments of the polygons: a wide one, and a narrow one over it.
fn fragments() -> Vec<Flow<Stamp<Fragment>>> {
    let stamp = |x: u16, y: u16| {
        let fragment =
            |x: u16| Fragment { x, y, z: 9, weights: [f32::from(x) / 40.0, f32::from(y) / 30.0], ..Fragment::default() };
        Flow::Item((x..x + 4).map(fragment).collect())
    };
    let mut all = Vec::new();
    for control in controls() {
        let columns = match &control {
            Control::Polygon(polygon) if polygon.material.color_texture.is_some() => 0..20,
            Control::Polygon(_) => 8..12,
            _ => 0..0,
        };
        all.push(Flow::Control(control));
        all.extend((0..12).flat_map(|y| columns.clone().step_by(4).map(move |x| stamp(x, y))));
    }
    all
}

/// Steps a unit until a requested input is empty.
fn drive<U: Unit>(mut unit: U, mut next: impl FnMut(Demand) -> Option<U::In>) -> Vec<U::Out> {
    let mut out = Vec::new();
    while let Some(input) = next(unit.demand()) {
        out.push(unit.step(input, &mut MemoryPorts::default()).out);
    }
    out
}

/// Feeds the tokens of one input.
fn one<A>(tokens: Vec<A>) -> impl FnMut(Demand) -> Option<Option<A>> {
    let mut tokens = tokens.into_iter();
    move |demand| if demand == Demand::Nothing { Some(None) } else { tokens.next().map(Some) }
}

/// Feeds the tokens of two inputs, of which a step takes one.
fn two<A, B>(first: Vec<A>, second: Vec<B>) -> impl FnMut(Demand) -> Option<(Option<A>, Option<B>)> {
    let (mut first, mut second) = (first.into_iter(), second.into_iter());
    move |demand| match demand {
        Demand::Nothing => Some((None, None)),
        Demand::Only(0) => first.next().map(|a| (Some(a), None)),
        _ => second.next().map(|b| (None, Some(b))),
    }
}

/// Tokens between the units.
struct Wires {
    cells: Vec<CellFlow>,
    rounds: Vec<PassRound>,
    marking: Vec<PassFlow>,
    colouring: Vec<PassFlow>,
    marks: Vec<MarkFlow>,
    improvements: Vec<MarkFlow>,
    asked: Vec<Either<TileRequest, ()>>,
    parcels: Vec<TileResponse>,
    encoded: Vec<EncodedTile>,
    acquired: Vec<Either<StoreOrder, ExpandedTile>>,
}

fn engine() -> EngineConfig {
    EngineConfig::default()
}

fn cells() -> Cells {
    let cut = PyramidCut { tile: [8, 8], ..PyramidCut::default() };
    Cells::new(engine(), Operators::default(), &CellConfig::default(), &RendererConfig::default(), cut)
}

fn reference_buffer(mode: RenderMode) -> ReferenceBuffer {
    ReferenceBuffer::new(engine(), mode, 16, TableSizes::default())
}

fn tile_lists(mode: RenderMode) -> TwoOutputs {
    TwoOutputs(TileLists::new(engine(), mode, TileOrder::Pixels, TableSizes::default(), ViewpointEnds::default()))
}

fn expander() -> Expander {
    Expander::new(TileConfig::default(), 8, 2)
}

fn path() -> Path {
    // A fraction of a bit per cycle, and no whole number of cycles per byte.
    Path::new(&PathConfig { bits_per_second: 777_777_777, latency_us: 1, ..PathConfig::default() }, 200_000_000, 3 * 64 * 64)
}

fn rasterization(mode: RenderMode) -> TwoInputs {
    TwoInputs(Rasterization::new(
        engine(),
        mode,
        ViewpointEnds::default(),
        CellFormat::new(&CellConfig::default(), 1.0),
        TableSizes::default(),
    ))
}

/// Returns the improvements that the final rasterization would request: in the first frame some tiles, then none, and in the
/// second none.
fn improvements() -> Vec<MarkFlow> {
    let mark = |tile| TileMark { page: 0, tile, pixels: 3, distance: 40 };
    vec![MarkFlow::Marks((1..5).map(mark).collect()), MarkFlow::End, MarkFlow::End, MarkFlow::End]
}

/// Returns the orders, each with its tile.
fn with_tiles(orders: impl Iterator<Item = StoreOrder>, tiles: Vec<ExpandedTile>) -> Vec<Either<StoreOrder, ExpandedTile>> {
    let mut tiles = tiles.into_iter();
    let with_tile = |order: StoreOrder| {
        let tile = if matches!(order, StoreOrder::Load { .. }) { tiles.next() } else { None };
        [Some(Either::Second(order)), tile.map(Either::Third)].into_iter().flatten()
    };
    orders.flat_map(with_tile).collect()
}

fn wires(mode: RenderMode) -> Wires {
    let progressive = mode == RenderMode::Progressive;
    let rounds = if progressive { vec![PassRound::Again, PassRound::Done, PassRound::Done] } else { vec![PassRound::Done; 2] };
    let improvements = if progressive { improvements() } else { vec![] };
    let cell_flow: Vec<CellFlow> = drive(cells(), one(fragments())).into_iter().flatten().collect();
    let (marking, colouring): (Vec<_>, Vec<_>) =
        drive(reference_buffer(mode), two(cell_flow.clone(), rounds.clone())).into_iter().unzip();
    let [marking, colouring] = [marking, colouring].map(|tokens| tokens.into_iter().flatten().collect::<Vec<_>>());
    let marks: Vec<_> = drive(Identification::new(engine(), RenderMode::Best, TableSizes::default()), one(marking.clone()))
        .into_iter()
        .flatten()
        .collect();
    let (requests, orders): (Vec<_>, Vec<_>) =
        drive(tile_lists(mode), two(marks.clone(), improvements.clone())).into_iter().unzip();
    let asked = |request: TileRequest| {
        let shown = (request == TileRequest::End).then_some(Either::Third(()));
        [Some(Either::Second(request)), shown].into_iter().flatten()
    };
    let asked: Vec<_> = requests.into_iter().flatten().flat_map(asked).collect();
    let parcels: Vec<_> = drive(Requested::new(), two(controls(), asked.clone())).into_iter().flatten().collect();
    let encoded: Vec<_> = drive(path(), one(parcels.clone())).into_iter().filter_map(|(_, tile)| tile).collect();
    let tiles = drive(expander(), one(encoded.clone())).into_iter().flatten().collect();
    let acquired = with_tiles(orders.into_iter().flatten().filter_map(|(order, _)| order), tiles);
    Wires { cells: cell_flow, rounds, marking, colouring, marks, improvements, asked, parcels, encoded, acquired }
}

#[test]
fn contract_tokens_have_attributions() {
    for mode in [RenderMode::Best, RenderMode::Progressive] {
        let wires = wires(mode);
        let blocks = |tokens: &[PassFlow]| tokens.iter().filter(|t| matches!(t, PassFlow::Cells(_))).count();
        let passes = if mode == RenderMode::Best { 2 } else { 3 };
        // 20 x 12 pixels are 15 blocks, and the picture has 24 blocks.
        assert_eq!(blocks(&wires.colouring), 24 * passes, "{mode:?}: those without pixels are background");
        assert_eq!(blocks(&wires.marking), if mode == RenderMode::Best { 30 } else { 0 });
        let tiles = wires.parcels.iter().filter(|p| matches!(p.content, ResponseContent::Tile(_))).count();
        assert!(tiles == wires.encoded.len() && tiles >= 5, "{mode:?}: {tiles} tiles");
        let ends = wires.asked.iter().filter(|a| **a == Either::Third(())).count();
        assert_eq!(ends, 2, "each frame is shown to its last picture");
        let stored = wires.acquired.iter().filter(|a| matches!(a, Either::Third(_))).count();
        assert_eq!(stored, tiles);
        assert!(wires.marks.len() >= 4 && wires.cells.len() > 60);
    }
}

unit_contract! {
    name: server,
    unit: Requested::new(),
    inputs: (controls(), wires(RenderMode::Best).asked),
    state: |unit| unit.0.state.clone() => |unit, state| unit.0.state = state,
}

unit_contract! {
    name: path_of_the_tiles,
    unit: path(),
    inputs: wires(RenderMode::Best).parcels,
    state,
}

unit_contract! {
    name: expander_of_tiles,
    unit: expander(),
    inputs: wires(RenderMode::Best).encoded,
    stateless,
}

unit_contract! {
    name: cells_of_fragments,
    unit: cells(),
    inputs: fragments(),
    state,
}

unit_contract! {
    name: reference_buffer_of_best_resolution,
    unit: reference_buffer(RenderMode::Best),
    inputs: { let w = wires(RenderMode::Best); (w.cells, w.rounds) },
    clients: [ClientKind::Port, ClientKind::Port],
    state,
}

unit_contract! {
    name: reference_buffer_of_the_progressive_mode,
    unit: reference_buffer(RenderMode::Progressive),
    inputs: { let w = wires(RenderMode::Progressive); (w.cells, w.rounds) },
    clients: [ClientKind::Port, ClientKind::Port],
    state,
}

unit_contract! {
    name: reference_buffer_that_gathers_one_block,
    unit: ReferenceBuffer::new(EngineConfig { write_lines: 1, ..engine() }, RenderMode::Best, 16, TableSizes::default()),
    inputs: { let w = wires(RenderMode::Best); (w.cells, w.rounds) },
    clients: [ClientKind::Port, ClientKind::Port],
    state,
}

unit_contract! {
    name: reference_buffer_with_few_flags,
    unit: ReferenceBuffer::new(
        EngineConfig { flags: 5, flags_per_cycle: 2, ..engine() },
        RenderMode::Progressive,
        16,
        TableSizes::default()
    ),
    inputs: { let w = wires(RenderMode::Progressive); (w.cells, w.rounds) },
    clients: [ClientKind::Port, ClientKind::Port],
    state,
}

#[test]
fn reference_buffer_evicts_lru_block_and_flushes_at_end() {
    let mut unit = ReferenceBuffer::new(EngineConfig { write_lines: 2, ..engine() }, RenderMode::Best, 16, TableSizes::default());
    let mut input = |token: Option<CellFlow>| {
        let demand = if token.is_some() { Demand::Only(0) } else { Demand::Nothing };
        assert_eq!((unit.demand(), unit.is_empty()), (demand, token.is_some()));
        let mut traffic = MemoryPorts::default();
        unit.step((token, None), &mut traffic);
        traffic.requests().iter().filter(|r| r.write).map(|r| (r.client, r.address, r.bytes)).collect::<Vec<_>>()
    };
    let Some(CellFlow::Frame(frame)) = wires(RenderMode::Best).cells.into_iter().find(|t| matches!(t, CellFlow::Frame(_))) else {
        panic!("a frame begins");
    };
    input(Some(CellFlow::Frame(frame)));
    let mut block = |column: u16| {
        let cell = PlacedCell { x: 4 * column, y: 0, cell: ReferenceCell::default() };
        input(Some(CellFlow::Cells(Stamp::from_iter([cell]))))
    };
    assert_eq!([0, 1, 0, 0].map(&mut block).concat(), []);
    assert_eq!(block(2), [(1, 256, 256)], "block 1");
    assert_eq!(input(Some(CellFlow::FrameEnd)), [(1, 0, 256)], "block 0");
    assert_eq!(input(None), [(1, 512, 256)], "block 2");
    assert_eq!(input(None), [], "the pass");
}

unit_contract! {
    name: identification,
    unit: Identification::new(engine(), RenderMode::Best, TableSizes::default()),
    inputs: wires(RenderMode::Best).marking,
    state,
}

unit_contract! {
    name: tile_lists_of_best_resolution,
    unit: tile_lists(RenderMode::Best),
    inputs: { let w = wires(RenderMode::Best); (w.marks, w.improvements) },
    state: |unit| unit.0.state.clone() => |unit, state| unit.0.state = state,
}

unit_contract! {
    name: tile_lists_of_the_progressive_mode,
    unit: tile_lists(RenderMode::Progressive),
    inputs: { let w = wires(RenderMode::Progressive); (w.marks, w.improvements) },
    state: |unit| unit.0.state.clone() => |unit, state| unit.0.state = state,
}

unit_contract! {
    name: final_rasterization_of_best_resolution,
    unit: rasterization(RenderMode::Best),
    inputs: { let w = wires(RenderMode::Best); (w.colouring, w.acquired) },
    clients: [ClientKind::Cache { line_bytes: 64 }, ClientKind::Port, ClientKind::Port],
    state: |unit| unit.0.state.clone() => |unit, state| unit.0.state = state,
}

unit_contract! {
    name: final_rasterization_of_the_progressive_mode,
    unit: rasterization(RenderMode::Progressive),
    inputs: { let w = wires(RenderMode::Progressive); (w.colouring, w.acquired) },
    clients: [ClientKind::Cache { line_bytes: 64 }, ClientKind::Port, ClientKind::Port],
    state: |unit| unit.0.state.clone() => |unit, state| unit.0.state = state,
}
