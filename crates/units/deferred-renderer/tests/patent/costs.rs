//! Costs: light, meshes on the path, searches, background, pictures under several samplers.

use crate::acquisition::load;
use crate::{page, texture};
use basrelief_deferred_renderer::cell::CellFormat;
use basrelief_deferred_renderer::colour::progressive;
use basrelief_deferred_renderer::tokens::{
    CellBlock, CellFlow, EncodedTile, ExpandedTile, PassFlow, ResponseContent, StoreOrder, TileResponse,
};
use basrelief_deferred_renderer::{
    CellConfig, Cells, ConventionalLoad, EngineConfig, Identification, LightingMode, PageTexels, Path, PathConfig, PyramidCut,
    Rasterization, ReferenceCell, RenderMode, RendererConfig, ServedTexture, Server, TableSizes, TextureMemory, TileEncoding,
    ViewpointEnds,
};
use basrelief_kernel::{MemoryPorts, Operators, Unit};
use basrelief_signals::{
    Camera, Control, Flow, Fragment, Frame, Light, LightKind, Material, MeshInfo, ObjectInfo, Polygon, Sampler, Stamp, Texture,
    Vertex, WrapMode,
};
use std::sync::Arc;

/// Returns a frame lit from +z and seen from there.
fn frame(index: u32) -> Control {
    let camera = Camera { view_projection: [0.0; 16], to_light: [0.0, 0.0, 1.0], to_viewer: [0.0, 0.0, 1.0] };
    let kind = LightKind::Directional { to_light: [0.0, 0.0, 1.0] };
    let lights = vec![Light { kind, intensity: 1.0 }];
    Control::Frame(Arc::new(Frame { index, width: 16, height: 16, camera, lights, ..Frame::default() }))
}

fn object(mesh: Option<MeshInfo>) -> Control {
    Control::Object(Arc::new(ObjectInfo { id: 3, name: "o".into(), mesh, ..ObjectInfo::default() }))
}

fn triangle(material: Material, normal: [f32; 3], bump: bool) -> Control {
    let corner = |x, y| Vertex { position: [x, y, 0.5, 1.0], normal, ..Vertex::default() };
    let vertices = vec![corner(0.0, 0.0), corner(16.0, 0.0), corner(0.0, 16.0)];
    Control::Polygon(Arc::new(Polygon { vertices, material: Arc::new(material), object: 3, lod: 0, bump, arrival: 0 }))
}

fn cells(lighting: LightingMode) -> Cells {
    let renderer = RendererConfig { lighting, ..RendererConfig::default() };
    let (engine, operators) = (EngineConfig::default(), Operators::default());
    Cells::new(engine, operators, &CellConfig::default(), &renderer, PyramidCut::default())
}

/// Returns the cell of a pixel of the last polygon of these commands, and the number of pages set up.
fn cell(unit: &mut Cells, controls: &[Control]) -> (ReferenceCell, usize) {
    let mut step = |token| unit.step(Some(token), &mut MemoryPorts::default()).out;
    let pages = controls.iter().filter(|c| matches!(step(Flow::Control((*c).clone())), Some(CellFlow::Page(_)))).count();
    let fragment = Fragment { x: 1, y: 1, weights: [0.1, 0.1], ..Fragment::default() };
    match step(Flow::Item(Stamp::from_iter([fragment]))) {
        Some(CellFlow::Cells(cells)) => (cells.iter().next().unwrap().cell, pages),
        other => panic!("a pixel has a cell: {other:?}"),
    }
}

// Claim: defer, brightness coefficients (316): Bump targets are lit like other polygons and the reference image.
#[test]
fn bump_target_is_lit_at_vertices_by_formula() {
    let material = Material { base_color: [0.5; 4], ..Material::default() };
    let lighting = material.lighting;
    let slanted = [0.6, 0.0, 0.8];
    let lit = |bump: bool, light: LightingMode| {
        let polygon = triangle(material.clone(), slanted, bump);
        cell(&mut cells(light), &[frame(0), object(None), polygon]).0.rgb()[0]
    };
    let formula = lighting.ka + lighting.kd * 0.8 + lighting.ks * 0.8_f32.powf(lighting.n);
    let expected = (0.5 * formula * 255.0 + 0.5) as u8;
    assert_eq!(lit(true, LightingMode::Gouraud), expected, "a bump target has no brightness of its own");
    assert_eq!(lit(false, LightingMode::Gouraud), 128, "others have: 1 here");
    assert_eq!(lit(true, LightingMode::None), 128);
}

// Claim: defer, page (132): An image under several samplers is one page.
#[test]
fn one_picture_under_several_samplers_is_one_page() {
    let one = texture([100, 40]);
    let sampler = Sampler { wrap: [WrapMode::Clamp, WrapMode::Mirror], ..Sampler::default() };
    let other = Arc::new(Texture { id: 8, sampler, ..Texture::clone(&one) });
    let of = |t: &Arc<Texture>| Material { color_texture: Some(Arc::clone(t)), ..Material::default() };
    let controls = [frame(0), triangle(of(&one), [0.0; 3], false), triangle(of(&other), [0.0; 3], false)];
    let mut unit = cells(LightingMode::None);
    let (cell, pages) = cell(&mut unit, &controls);
    assert_eq!((pages, unit.state.pictures.len()), (1, 1));
    assert_eq!((cell.page(), cell.wrap), (Some(0), [WrapMode::Clamp, WrapMode::Mirror]), "a sampler is the cell's");

    let (bytes, conventional) = sent(PathConfig { number_bytes: 0, ..PathConfig::default() }, LightingMode::None, &controls);
    assert_eq!(bytes.iter().sum::<u64>(), 8, "its size travels once");
    assert_eq!(conventional, ConventionalLoad { raw_bytes: 100 * 40 * 3, encoded_bytes: Some(100 * 40 * 3) });
}

/// Returns the bytes of the server's tokens for these commands, and the load of all their textures.
fn sent(config: PathConfig, lighting: LightingMode, controls: &[Control]) -> (Vec<u64>, ConventionalLoad) {
    let source = TextureMemory::new(TileEncoding::Raw, 85);
    let mut server = Server::new(config, lighting, Box::new(source));
    let mut send = |control: &Control| {
        // The phase between frames does not matter here.
        let (phase, traffic) = (matches!(control, Control::Frame(_)).then_some(()), &mut MemoryPorts::default());
        let Some(TileResponse { bytes, .. }) = server.step((Some(control.clone()), None, phase), traffic).out else { return 0 };
        bytes
    };
    let bytes = controls.iter().map(&mut send).collect();
    (bytes, server.conventional(PyramidCut::default()))
}

// Claim: defer, 451, 482: A mesh travels once, indexed. Later frames send commands only.
#[test]
fn step_451_mesh_travels_once_and_indexed() {
    let mesh = MeshInfo { vertices: 100, indices: 300, uv: true, colors: false, digest: 0 };
    let polygon = || triangle(Material::default(), [0.0, 0.0, 1.0], false);
    let controls = |index, mesh| [frame(index), object(mesh), polygon(), polygon(), Control::FrameEnd];
    let of = |mesh, lighting| sent(PathConfig::default(), lighting, &[controls(0, mesh), controls(1, mesh)].concat()).0;
    let (of_frame, of_object) = (4 * (21 + 5), 4 * 13);
    let once = |mesh| [of_frame, of_object + mesh, 0, 0, 0, of_frame, of_object, 0, 0, 0];
    assert_eq!(of(Some(mesh), LightingMode::None), once(100 * 4 * (3 + 2) + 300 * 2 + 40));
    assert_eq!(
        of(Some(mesh), LightingMode::Gouraud),
        once(100 * 4 * (3 + 2 + 3) + 300 * 2 + 40),
        "normals where something is lit"
    );
    let large = MeshInfo { vertices: 70_000, indices: 9, uv: false, colors: true, digest: 0 };
    assert_eq!(of(Some(large), LightingMode::None), once(70_000 * 4 * (3 + 1) + 9 * 4 + 40), "indices of four bytes");
    let instance = |id, digest| {
        let mesh = Some(MeshInfo { digest, ..mesh });
        Control::Object(Arc::new(ObjectInfo { id, mesh, ..ObjectInfo::default() }))
    };
    let instances = [instance(0, 7), instance(1, 7), instance(2, 8), instance(3, 0), instance(4, 0)];
    let whole = of_object + 100 * 4 * (3 + 2) + 300 * 2 + 40;
    let sent = sent(PathConfig::default(), LightingMode::None, &instances).0;
    assert_eq!(sent, [whole, of_object + 40, whole, whole, whole], "an instance has a surface of its own");
    let untold = of(None, LightingMode::None);
    assert_eq!(untold[1..5], [of_object, 3 * 12, 3 * 12, 0], "a list that does not tell: vertex by vertex");
    assert_eq!(untold[5..], [of_frame, of_object, 0, 0, 0]);
}

/// Creates a page of 8 x 8 tiles in its finest layer, with only the top tile present.
fn with_top() -> PageTexels {
    let page = page([512, 512], [64, 64]);
    let mut texels = PageTexels::new(Arc::clone(&page));
    load(&mut ServedTexture::new(texture([512, 512])), &mut texels, 0, TileEncoding::Raw);
    texels
}

// Claim: defer, Figure 7B: The search pays for each word of the tile load list (136).
#[test]
fn figure_7b_search_reads_one_or_two_words_per_layer() {
    let texels = with_top();
    let words = |st: [f32; 2], depth: f32, entries: u32| {
        let cell = ReferenceCell::textured(0, st, depth, [255; 3]);
        progressive(&texels, &cell, texels.page.placed(cell.coordinates, cell.wrap), entries).unwrap().words
    };
    assert_eq!(words([10.0, 10.0], 0.0, 64), 1);
    assert_eq!(words([10.0, 10.0], 2.5, 64), 4, "layers 3, 2, 1, 0");
    // Tile 5 + 8 * 3 + 3, and the tiles to its right and below, two rows apart.
    assert_eq!(words([256.0, 256.0], 3.0, 4), 2 + words([256.0, 256.0], 2.0, 4), "four tiles of layer 3 lie in two words of 4");
}

// Claim: as figure_7b_search_reads_one_or_two_words_per_layer.
#[test]
fn final_rasterization_pays_for_figure_7b_search() {
    let cycles = |mode: RenderMode, depth: f32| {
        let (format, engine) = (CellFormat::new(&CellConfig::default(), 1.0), EngineConfig::default());
        let mut unit = Rasterization::new(engine, mode, ViewpointEnds::default(), format, TableSizes::default());
        unit.state.pages.push(with_top());
        let mut block = CellBlock { mask: u16::MAX, ..CellBlock::default() };
        block.cells = [ReferenceCell::textured(0, [10.0, 10.0], depth, [255; 3]); 16];
        unit.step((Some(PassFlow::Begin), None, None), &mut MemoryPorts::default());
        unit.step((None, Some(StoreOrder::End), None), &mut MemoryPorts::default());
        unit.step((Some(PassFlow::Cells(block)), None, None), &mut MemoryPorts::default()).occupancy
    };
    assert_eq!(cycles(RenderMode::Progressive, 0.0), 16, "a layer each");
    assert_eq!(cycles(RenderMode::Progressive, 3.0), 16 * 4, "layers 3, 2, 1, 0");
    assert_eq!(cycles(RenderMode::Best, 3.0), 16, "all is there: no search");
}

#[test]
fn identification_takes_a_cycle_per_scanned_layer() {
    let occupancy = |scan_rate, depth: f32| {
        let mut unit =
            Identification::new(EngineConfig { scan_rate, ..EngineConfig::default() }, RenderMode::Best, TableSizes::default());
        unit.state.pages.push(page([512, 512], [64, 64]));
        let mut block = CellBlock { mask: u16::MAX, ..CellBlock::default() };
        block.cells = [ReferenceCell::textured(0, [10.0, 10.0], depth, [255; 3]); 16];
        unit.step(Some(PassFlow::Cells(block)), &mut MemoryPorts::default()).occupancy
    };
    assert_eq!([1, 2, 3, 16].map(|rate| occupancy(rate, 3.0)), [16, 8, 6, 1]);
    assert_eq!([1, 2, 3, 16].map(|rate| occupancy(rate, 2.5)), [32, 16, 11, 2], "two layers each");
}

#[test]
fn tile_arrives_one_latency_after_its_transfer() {
    let step = |latency_us, content| {
        let config = PathConfig { bits_per_second: 8_000_000, latency_us, ..PathConfig::default() };
        let mut path = Path::new(&config, 100_000_000, 64);
        let step = path.step(Some(TileResponse { bytes: 10, content }), &mut MemoryPorts::default());
        (step.occupancy, step.latency)
    };
    let tile = || ResponseContent::Tile(EncodedTile { page: page([64, 64], [64, 64]), tile: 0, bytes: Arc::new([0; 10]) });
    // Ten bytes at one byte per microsecond, at 100 cycles each.
    assert_eq!(step(0, tile()), (1_000, 999));
    assert_eq!(step(7, tile()), (1_000, 999 + 700));
    let control = || Control::FrameEnd;
    assert_eq!(step(7, ResponseContent::Asked(control())), (1_700, 1_699), "the polygons are one answer");
    assert_eq!(step(7, ResponseContent::Mesh(control())), (1_000, 999));
}

#[test]
fn set_up_of_a_triangle_occupies_initial_rasterization() {
    let occupancy = |setup_units| {
        let engine = EngineConfig { setup_units, ..EngineConfig::default() };
        let renderer = RendererConfig { lighting: LightingMode::None, ..RendererConfig::default() };
        let mut unit = Cells::new(engine, Operators::default(), &CellConfig::default(), &renderer, PyramidCut::default());
        unit.step(Some(Flow::Control(frame(0))), &mut MemoryPorts::default());
        let polygon = triangle(Material::default(), [0.0, 0.0, 1.0], false);
        unit.step(Some(Flow::Control(polygon)), &mut MemoryPorts::default()).occupancy
    };
    // 51 products and 38 sums.
    assert_eq!([1, 4, 16].map(occupancy), [51, 13, 4]);
}

#[test]
fn tile_occupies_rasterization_texel_by_texel() {
    let (format, ends) = (CellFormat::new(&CellConfig::default(), 1.0), ViewpointEnds::default());
    let engine = EngineConfig { average_rate: 5, ..EngineConfig::default() };
    let mut unit = Rasterization::new(engine, RenderMode::Best, ends, format, TableSizes::default());
    let page = page([16, 16], [16, 8]);
    unit.state.pages.push(PageTexels::new(Arc::clone(&page)));
    unit.step((Some(PassFlow::Begin), None, None), &mut MemoryPorts::default());
    unit.step((None, Some(StoreOrder::Load { page: 0, tile: 0 }), None), &mut MemoryPorts::default());
    let arrived = ExpandedTile { page: Arc::clone(&page), tile: 0, texels: vec![[9; 4]; 16 * 8].into() };
    assert_eq!(unit.step((None, None, Some(arrived)), &mut MemoryPorts::default()).occupancy, 26, "128 texels, 5 a cycle");
    let average = page.tiles() - 1;
    let order = StoreOrder::Synthesize { page: 0, tile: average };
    let step = unit.step((None, Some(order), None), &mut MemoryPorts::default());
    assert_eq!(step.occupancy, page.texels_in(average).div_ceil(5));
}

#[test]
fn edge_tile_moves_its_own_texels_only() {
    let (format, ends) = (CellFormat::new(&CellConfig::default(), 1.0), ViewpointEnds::default());
    let mut unit = Rasterization::new(EngineConfig::default(), RenderMode::Best, ends, format, TableSizes::default());
    // Layers of 10 x 5 and 20 x 9 texels: tile 0, and tiles 1 and 2 of 16 x 9 and 4 x 9 texels.
    let page = page([20, 9], [16, 16]);
    unit.state.pages.push(PageTexels::new(Arc::clone(&page)));
    let mut requests = |pass, order, tile| {
        let mut traffic = MemoryPorts::default();
        unit.step((pass, order, tile), &mut traffic);
        traffic.requests().iter().map(|r| (r.write, r.address, r.bytes)).collect::<Vec<_>>()
    };
    requests(Some(PassFlow::Begin), None, None);
    let mut load = |tile, texels| {
        requests(None, Some(StoreOrder::Load { page: 0, tile }), None);
        let texels = vec![[9; 4]; texels].into();
        requests(None, None, Some(ExpandedTile { page: Arc::clone(&page), tile, texels }))
    };
    assert_eq!(load(1, 16 * 9), [(true, 1024, 4 * 16 * 9)]);
    assert_eq!(load(2, 4 * 9), [(true, 2048, 4 * 4 * 9)]);
    let averaged = requests(None, Some(StoreOrder::Synthesize { page: 0, tile: 0 }), None);
    assert_eq!(averaged, [(false, 1024, 4 * 16 * 9), (false, 2048, 4 * 4 * 9), (true, 0, 4 * 10 * 5)]);
}

#[test]
fn final_rasterization_filters_after_its_texels() {
    let (format, engine) = (CellFormat::new(&CellConfig::default(), 1.0), EngineConfig::default());
    let mut unit = Rasterization::new(engine, RenderMode::Best, ViewpointEnds::default(), format, TableSizes::default());
    let mut texels = PageTexels::new(page([128, 128], [64, 64]));
    let mut served = ServedTexture::new(texture([128, 128]));
    (0..texels.page.tiles()).for_each(|tile| load(&mut served, &mut texels, tile, TileEncoding::Raw));
    unit.state.pages.push(texels);
    unit.step((Some(PassFlow::Begin), None, None), &mut MemoryPorts::default());
    let order = StoreOrder::Synthesize { page: 0, tile: 0 };
    assert!(unit.step((None, Some(order), None), &mut MemoryPorts::default()).blocking, "the next tile may need this one");
    unit.step((None, Some(StoreOrder::End), None), &mut MemoryPorts::default());
    let mut block = CellBlock { mask: 1, ..CellBlock::default() };
    block.cells[0] = ReferenceCell::textured(0, [10.0, 10.0], 0.0, [255; 3]);
    let step = unit.step((Some(PassFlow::Cells(block)), None, None), &mut MemoryPorts::default());
    assert_eq!((step.after_data, step.latency), (6, 8));
}
