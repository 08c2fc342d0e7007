//! Mapping (108), replacement (110) and brightness fetch (112), step by step, with access to every token between them.

use crate::bump::recipe::bumps;
use basrelief_brightness::BrightnessFetch;
use basrelief_kernel::{Demand, MemoryPorts, Unit};
use basrelief_machines::bump::BumpProcessorConfig;
use basrelief_normal_mapping::NormalMapping;
use basrelief_replacement::Replacement;
use basrelief_signals::{
    Camera, Control, Flow, Fragment, Frame, Image, Light, LightKind, Material, NormalIndexes, Polygon, PseudoNormals, Sampler,
    ShadedFragment, Stamp, StampSample, Texture, Vertex,
};
use std::sync::Arc;

/// Direction to the light of [`Chain`], unit; the viewer is at +z.
pub const TO_LIGHT: [f32; 3] = [0.48, 0.36, 0.8];

/// A fragment as it leaves each of the three units.
pub struct Traced {
    pub normals: PseudoNormals,
    pub indexes: NormalIndexes,
    pub shaded: ShadedFragment,
}

/// The three units.
pub struct Chain {
    mapping: NormalMapping,
    replacement: Replacement,
    brightness: BrightnessFetch,
}

/// Returns all outputs of a unit for a token.
fn pump<A, B, U: Unit<In = Option<A>, Out = Option<B>>>(unit: &mut U, token: A) -> Vec<B> {
    let mut out: Vec<B> = unit.step(Some(token), &mut MemoryPorts::default()).out.into_iter().collect();
    while unit.demand() == Demand::Nothing {
        out.extend(unit.step(None, &mut MemoryPorts::default()).out);
    }
    out
}

fn only_item<T>(tokens: Vec<Flow<T>>) -> T {
    let mut items = tokens.into_iter().filter_map(|t| if let Flow::Item(item) = t { Some(item) } else { None });
    match (items.next(), items.next()) {
        (Some(item), None) => item,
        _ => panic!("expected one token for one token"),
    }
}

impl Chain {
    /// Creates the units, and begins a frame with the light at [`TO_LIGHT`].
    pub fn new(config: &BumpProcessorConfig) -> Self {
        let c = config.clone();
        let samples = c.normal_mapping.samples(c.brightness.levels);
        let tables = c.replacement.table_set();
        let mapping =
            NormalMapping::new(c.normal_mapping.clone(), &c.operators, c.brightness.levels, 1, c.cache.normal_map.line_bytes);
        let replacement =
            Replacement::new(c.replacement, c.normal_mapping.normal_bits, &c.operators).unwrap_or_else(|e| panic!("{e}"));
        let mut chain =
            Self { mapping, replacement, brightness: BrightnessFetch::new(c.brightness, tables, samples, &c.operators) };
        let camera = Camera { view_projection: [0.0; 16], to_light: TO_LIGHT.map(f64::from), to_viewer: [0.0, 0.0, 1.0] };
        let lights = vec![Light { kind: LightKind::Directional { to_light: TO_LIGHT }, intensity: 1.0 }];
        chain.control(Control::Frame(Arc::new(Frame {
            index: 0,
            width: 6,
            height: 6,
            camera,
            lights,
            textures: Vec::new(),
            shading: Default::default(),
        })));
        chain
    }

    fn control(&mut self, control: Control) {
        for token in pump(&mut self.mapping, Flow::Control(control)) {
            for token in pump(&mut self.replacement, token) {
                pump(&mut self.brightness, token);
            }
        }
    }

    /// Begins a polygon with this LOD.
    pub fn begin_polygon(&mut self, lod: u8, normal_map: Arc<Texture>) {
        let vertex = |u: f32, v: f32| Vertex { tangent: [1.0, 0.0, 0.0, 1.0], uv_normal: [u, v], ..Vertex::default() };
        let vertices = vec![vertex(0.0, 0.0), vertex(1.0, 0.0), vertex(0.0, 1.0)];
        let material = Arc::new(Material { normal_map: Some(normal_map), ..Material::default() });
        self.control(Control::Polygon(Arc::new(Polygon { vertices, material, object: 0, lod, bump: true, arrival: 0 })));
    }

    /// Passes a fragment at these texture coordinates through all units.
    pub fn fragment(&mut self, weights: [f32; 2]) -> Traced {
        let normals =
            only_item(pump(&mut self.mapping, Flow::Item(Stamp::from_iter([Fragment { weights, ..Fragment::default() }]))));
        self.replaced(normals)
    }

    /// Passes a fragment with these pseudo-normals through the remaining units.
    pub fn replaced(&mut self, normals: PseudoNormals) -> Traced {
        let indexes = only_item(pump(&mut self.replacement, Flow::Item(normals.clone())));
        let shaded = only_item(pump(&mut self.brightness, Flow::Item(indexes.clone())))[0];
        Traced { normals, indexes, shaded }
    }
}

/// One pseudo-normal of one level.
pub fn single(level: u8, normal: [i16; 3]) -> PseudoNormals {
    PseudoNormals {
        stamp: Stamp::from_iter([Fragment::default()]),
        samples: [StampSample::all(level, 1.0, normal)].into_iter().collect(),
    }
}

/// A normal map of 16 x 16 texels and its five levels.
pub fn bumpy_map() -> Arc<Texture> {
    texture(bumps())
}

/// A map whose level k is one normal throughout.
pub fn uniform_map(levels: &[[u8; 3]]) -> Arc<Texture> {
    let level = |(k, &[r, g, b]): (usize, &[u8; 3])| {
        let side = 1u32 << (levels.len() - 1 - k);
        Image { width: side, height: side, texels: vec![[r, g, b, 255]; (side * side) as usize] }
    };
    texture(levels.iter().enumerate().map(level).collect())
}

fn texture(levels: Vec<Image>) -> Arc<Texture> {
    Arc::new(Texture { id: 0, name: "map".into(), sampler: Sampler::default(), levels, offset: 0, elsewhere: None })
}

/// The pseudo-normals of a fragment: level, weight and N' of each.
pub fn pseudo_normals(traced: &Traced) -> Vec<(u8, f32, [i16; 3])> {
    traced.normals.samples.iter().map(|s| s.of(0)).collect()
}

/// The indexes of a fragment: level, weight and index of each.
pub fn indexes(traced: &Traced) -> Vec<(u8, f32, u16)> {
    traced.indexes.samples.iter().map(|s| s.of(0)).collect()
}
