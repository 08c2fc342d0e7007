//! Initial rasterization (454): computes the texture needs of each pixel.

use crate::ReferenceCell;
use crate::cell::{CellFormat, layer_depth, most_pages};
use crate::cell_work::CellWork;
use crate::config::{CellConfig, EngineConfig, LightingMode, RendererConfig, WrapOverride};
use crate::page::{PyramidCut, TexturePage};
use crate::pyramid::is_same_picture;
use crate::sizes::TableSizes;
use crate::slopes::{TriangleSlopes, VertexLight};
use crate::tokens::{CellFlow, PlacedCell};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Cached, Demand, MemoryPorts, Operators, Step, Unit};
use basrelief_shading::{LightVector, light_vectors, saturated};
use basrelief_signals::{Control, Flow, Fragment, Frame, Polygon, Stamp, Texture, WrapMode};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

/// The current polygon.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PolygonSurface {
    polygon: Arc<Polygon>,
    /// Page of its texture, and the wrap modes of the coordinates.
    page: Option<(Arc<TexturePage>, [WrapMode; 2])>,
    /// Set-up of the triangle of the last fragment.
    #[serde(skip)]
    slopes: Cached<TriangleSlopes>,
}

/// Counters of the initial rasterization.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CellsCounters {
    /// Cells of textured pixels.
    pub textured: u64,
    /// Cells of direct colour.
    pub direct: u64,
    /// Cells whose texture coordinates exceed their fields.
    pub clamped: u64,
}

/// State of the initial rasterization between steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CellsState {
    /// Pages set up so far, by texture number. Textures of the same picture share a page.
    pub pages: BTreeMap<u32, Arc<TexturePage>>,
    /// First texture of each page, by page number.
    pub pictures: Vec<Arc<Texture>>,
    /// Declared textures whose pages are not set up yet.
    pub declared: VecDeque<Arc<Texture>>,
    /// First free byte of the texture-data memory (130).
    pub end: u64,
    /// The current frame.
    pub frame: Option<Arc<Frame>>,
    /// Lights of the frame as seen from the centre of the current object.
    pub lights: Vec<LightVector>,
    /// Polygon of the next fragments.
    pub(crate) surface: Option<PolygonSurface>,
    /// Counters.
    pub counters: CellsCounters,
}

/// Initial rasterization: converts visible fragments to cells, and sets up pages (132). It sets up a page for each picture that a
/// frame declares (452), one after the other, or for an undeclared picture when a polygon first uses it. Textures with the same
/// picture under several samplers share a page, because the wrap mode belongs to the cell.
#[derive(Clone, Debug)]
pub struct Cells {
    /// Parameters.
    pub config: EngineConfig,
    format: CellFormat,
    page_bits: u32,
    lighting: LightingMode,
    wrap: WrapOverride,
    cut: PyramidCut,
    work: CellWork,
    sizes: TableSizes,
    /// State between steps.
    pub state: CellsState,
}

/// Returns the largest brightness that a coefficient represents. With light, vertices can be brighter than 1.
pub fn brightness_range(lighting: LightingMode) -> f32 {
    if lighting == LightingMode::Gouraud { 2.0 } else { 1.0 }
}

impl Cells {
    /// Creates the unit in its power-on state.
    pub fn new(
        config: EngineConfig,
        operators: Operators,
        cell: &CellConfig,
        renderer: &RendererConfig,
        cut: PyramidCut,
    ) -> Self {
        Self {
            work: CellWork::new(&config, operators),
            sizes: TableSizes::new(cell, cut, &config),
            config,
            format: CellFormat::new(cell, brightness_range(renderer.lighting)),
            page_bits: cell.page_bits,
            lighting: renderer.lighting,
            wrap: renderer.wrap,
            cut,
            state: CellsState::default(),
        }
    }

    /// Sets up a page for a texture, unless its picture has one.
    fn set_up(&mut self, texture: &Arc<Texture>, traffic: &mut MemoryPorts) -> Option<Arc<TexturePage>> {
        let state = &mut self.state;
        if let Some(known) = state.pictures.iter().find(|known| is_same_picture(known, texture)) {
            let page = state.pages.get(&known.id).cloned();
            state.pages.extend(page.map(|page| (texture.id, page)));
            return None;
        }
        let pages = state.pictures.len();
        if pages >= most_pages(self.page_bits) {
            traffic.fault(format!(
                "there are more than {pages} textures, as many as `cell.page_bits` = {} can tell apart; raise it",
                self.page_bits
            ));
            return None;
        }
        let page = Arc::new(TexturePage::new(pages as u16, texture, self.cut, state.end));
        state.end += page.bytes();
        if state.end > self.config.texture_memory {
            traffic.fault(format!(
                "with texture {} of the scene, the pyramids take {} bytes, but `engine.texture_memory` has {}; raise it",
                pages + 1,
                state.end,
                self.config.texture_memory
            ));
            return None;
        }
        state.pictures.push(Arc::clone(texture));
        state.pages.insert(texture.id, Arc::clone(&page));
        Some(page)
    }

    /// Returns the page of a texture as a token, if it is not set up yet.
    fn new_page(&mut self, texture: &Arc<Texture>, traffic: &mut MemoryPorts) -> Option<CellFlow> {
        if self.state.pages.contains_key(&texture.id) {
            return None;
        }
        self.set_up(texture, traffic).map(CellFlow::Page)
    }

    fn begin(&mut self, polygon: &Arc<Polygon>, traffic: &mut MemoryPorts) -> Option<CellFlow> {
        let texture = polygon.material.color_texture.as_ref();
        let new = texture.and_then(|texture| self.new_page(texture, traffic));
        let page_of = |texture: &Arc<Texture>| {
            let page = self.state.pages.get(&texture.id)?;
            Some((Arc::clone(page), self.wrap.of(texture.sampler.wrap)))
        };
        let page = texture.and_then(page_of);
        self.state.surface = Some(PolygonSurface { polygon: Arc::clone(polygon), page, slopes: Cached::default() });
        new
    }

    fn control(&mut self, control: Control, traffic: &mut MemoryPorts) -> Option<CellFlow> {
        match control {
            Control::Frame(frame) => {
                self.state.declared.extend(frame.textures.iter().cloned());
                self.state.lights = light_vectors(&frame, [0.0; 3]);
                self.state.frame = Some(Arc::clone(&frame));
                Some(CellFlow::Frame(frame))
            }
            Control::Object(object) => {
                let frame = self.state.frame.as_ref();
                self.state.lights = frame.map_or_else(Vec::new, |frame| light_vectors(frame, object.centre));
                None
            }
            Control::Polygon(polygon) => self.begin(&polygon, traffic),
            Control::FrameEnd => Some(CellFlow::FrameEnd),
            Control::CodeBook(_) | Control::Criterion(_) => None,
        }
    }

    /// Returns the occupancy by a command \[cycles\]: set-up of the triangles of a polygon, and lighting of a bump target's
    /// vertices.
    fn setup(&self, control: &Control) -> u64 {
        let Control::Polygon(polygon) = control else { return 1 };
        let vertices = polygon.vertices.len() as u32;
        let lit = if polygon.bump && self.lighting == LightingMode::Gouraud { vertices } else { 0 };
        self.work.setup(vertices.saturating_sub(2), lit, self.state.lights.len() as u32)
    }

    #[inline]
    fn cells(&mut self, fragments: &Stamp<Fragment>) -> Stamp<PlacedCell> {
        let CellsState { surface, counters, lights, .. } = &mut self.state;
        let light = VertexLight { lighting: self.lighting, lights };
        let Some(surface) = surface else { return Stamp::new() };
        let mut cells = Stamp::new();
        for f in fragments {
            if surface.slopes.as_ref().is_none_or(|s| s.number != f.triangle) {
                let size = surface.page.as_ref().map_or([1.0; 2], |(page, _)| page.size());
                *surface.slopes = TriangleSlopes::new(&surface.polygon, size, f.triangle, light);
            }
            let Some(slopes) = &*surface.slopes else { continue };
            let colour = slopes.colour.at(f.weights);
            let cell = match &surface.page {
                Some((page, wrap)) => {
                    counters.textured += 1;
                    let depth = layer_depth(page.dmax(), slopes.footprint.rho_squared(f.x, f.y));
                    let st = slopes.coordinates.at(f.weights);
                    counters.clamped += u64::from(!self.format.holds(st));
                    self.format.textured(page, st, depth, colour).wrapped(*wrap)
                }
                None => {
                    counters.direct += 1;
                    ReferenceCell::direct(saturated(colour))
                }
            };
            cells.push(PlacedCell { x: f.x, y: f.y, cell });
        }
        cells
    }
}

impl Unit for Cells {
    basrelief_kernel::unit_info!("texture, coordinates, layer depth, brightness of a pixel; sets pages (132) up");
    type In = Option<Flow<Stamp<Fragment>>>;
    type Out = Option<CellFlow>;

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.declared.is_empty() { Demand::All } else { Demand::Nothing }
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        let latency = self.work.latency(self.config.latency);
        match input {
            Some(Flow::Item(stamp)) => {
                let cells = self.cells(&stamp);
                let groups = cells.len().div_ceil(self.config.fill_rate as usize);
                Step::over(groups, self.work.interval(), latency, (!cells.is_empty()).then_some(CellFlow::Cells(cells)))
            }
            Some(Flow::Control(control)) => {
                let setup = self.setup(&control);
                Step::during(setup, latency, self.control(control, traffic))
            }
            None => {
                let texture = self.state.declared.pop_front();
                Step::after(latency, texture.and_then(|texture| self.new_page(&texture, traffic)))
            }
        }
    }

    fn is_empty(&self) -> bool {
        self.state.declared.is_empty()
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        stats.rate(0, self.work.latency(self.config.latency), self.work.interval());
        self.work.tell(self.lighting, self.sizes, stats);
        let c = &self.state.counters;
        stats.figure("cells_textured", c.textured, "cells", "Cells with a texture");
        stats.figure("cells_direct", c.direct, "cells", "Cells with a colour");
        stats.figure("cells_clamped", c.clamped, "cells", "Cells whose texture coordinates exceed their fields");
    }
}
