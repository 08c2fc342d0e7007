//! Initial rasterization (454): what a pixel will want of which texture.

use crate::Cell;
use crate::cell::{CellFormat, layer_depth, most_pages};
use crate::config::{CellConfig, EngineConfig, Lighting, WrapMode};
use crate::page::{Cut, Page};
use crate::tokens::{CellFlow, PlacedCell};
use basrelief_kernel::facts::Facts;
use basrelief_kernel::{Demand, Derived, Step, Traffic, Unit};
use basrelief_shading::{Gradient, fan_triangle, saturated};
use basrelief_signals::{Control, Flow, Fragment, Polygon, Stamp, Texture};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

/// What is known of the current triangle.
#[derive(Clone, Debug)]
struct Slopes {
    /// Number in the fan.
    number: u16,
    colour: Gradient<3>,
    /// S and T \[finest texels\].
    coordinates: Gradient<2>,
    footprint: Footprint,
}

/// How texture coordinates change over the screen: planes of S/w, T/w and 1/w, from the first vertex on.
#[derive(Clone, Copy, Debug)]
struct Footprint {
    origin: [f64; 2],
    q: f64,
    /// Change of 1/w per pixel to the right and down.
    q_by: [f64; 2],
    /// Change of (S - S0)/w and (T - T0)/w.
    st_by: [[f64; 2]; 2],
}

impl Footprint {
    /// Of three corners: window position, 1/w, and S, T.
    fn new(corners: [([f64; 2], f64); 3], st: [[f64; 2]; 3]) -> Self {
        let largest = corners.iter().fold(f64::MIN_POSITIVE, |l, c| l.max(c.1));
        let q = corners.map(|c| c.1 / largest);
        let [o, a, b] = corners.map(|c| c.0);
        let (ax, ay, bx, by) = (a[0] - o[0], a[1] - o[1], b[0] - o[0], b[1] - o[1]);
        let scale = 1.0 / (ax * by - bx * ay);
        // Of a plane with these differences to the first corner.
        let slope = |da: f64, db: f64| [(da * by - db * ay) * scale, (db * ax - da * bx) * scale];
        let of = |i: usize| slope((st[1][i] - st[0][i]) * q[1], (st[2][i] - st[0][i]) * q[2]);
        Self { origin: o, q: q[0], q_by: slope(q[1] - q[0], q[2] - q[0]), st_by: [of(0), of(1)] }
    }

    /// Square of the longer of the two axes of the pixel's footprint \[finest texels\].
    #[inline]
    fn rho_squared(&self, x: u16, y: u16) -> f32 {
        let (dx, dy) = (f64::from(x) + 0.5 - self.origin[0], f64::from(y) + 0.5 - self.origin[1]);
        let inverse = 1.0 / (self.q + self.q_by[0] * dx + self.q_by[1] * dy);
        let st = self.st_by.map(|by| (by[0] * dx + by[1] * dy) * inverse);
        let axis = |i: usize| {
            let [s, t] = [0, 1].map(|c| self.st_by[c][i] - st[c] * self.q_by[i]);
            s * s + t * t
        };
        (axis(0).max(axis(1)) * inverse * inverse) as f32
    }
}

/// The current polygon.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Surface {
    polygon: Arc<Polygon>,
    page: Option<Arc<Page>>,
    /// Of the triangle that the last fragment was in.
    #[serde(skip)]
    slopes: Derived<Slopes>,
}

/// What the initial rasterization has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CellsCounters {
    /// Cells of textured pixels.
    pub textured: u64,
    /// Cells of direct colour.
    pub direct: u64,
}

/// Everything the initial rasterization remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CellsState {
    /// Pages set up so far, by number of their texture.
    pub pages: BTreeMap<u32, Arc<Page>>,
    /// Declared textures whose pages come next.
    pub declared: VecDeque<Arc<Texture>>,
    /// First free byte of the texture-data memory (130).
    pub end: u64,
    /// The polygon of the fragments that come.
    pub(crate) surface: Option<Surface>,
    /// What it has counted.
    pub counters: CellsCounters,
}

/// Makes cells of the fragments that are in front, and sets up pages (132): one per texture that a frame declares (452), one
/// after the other, or when a polygon first names one that was not declared.
#[derive(Clone, Debug)]
pub struct Cells {
    /// Parameters.
    pub config: EngineConfig,
    format: CellFormat,
    page_bits: u32,
    lighting: Lighting,
    wrap: WrapMode,
    cut: Cut,
    /// Everything it remembers.
    pub state: CellsState,
}

/// Largest brightness that a coefficient stands for: with light, vertices may be brighter than 1.
pub fn brightness_range(lighting: Lighting) -> f32 {
    if lighting == Lighting::Gouraud { 2.0 } else { 1.0 }
}

impl Cells {
    /// At power-on.
    pub fn new(config: EngineConfig, cell: &CellConfig, (lighting, wrap): (Lighting, WrapMode), cut: Cut) -> Self {
        Self {
            config,
            format: CellFormat::new(cell, brightness_range(lighting)),
            page_bits: cell.page_bits,
            lighting,
            wrap,
            cut,
            state: CellsState::default(),
        }
    }

    /// Pages set up so far, in order of their texture's number.
    pub fn pages(&self) -> impl Iterator<Item = &Arc<Page>> {
        self.state.pages.values()
    }

    /// Sets the page of a texture up.
    fn set_up(&mut self, texture: &Texture, traffic: &mut Traffic) -> Option<Arc<Page>> {
        if self.state.pages.len() >= most_pages(self.page_bits) {
            traffic.fault(format!(
                "there are more than {} textures, as many as `cell.page_bits` = {} can tell apart; raise it",
                self.state.pages.len(),
                self.page_bits
            ));
            return None;
        }
        let page =
            Page::new(self.state.pages.len() as u16, texture, self.wrap.of(texture.sampler.wrap), self.cut, self.state.end);
        self.state.end += page.bytes();
        if self.state.end > self.config.texture_memory {
            traffic.fault(format!(
                "the pyramids of {} textures take {} bytes, `engine.texture_memory` has {}; raise it",
                self.state.pages.len() + 1,
                self.state.end,
                self.config.texture_memory
            ));
            return None;
        }
        let page = Arc::new(page);
        self.state.pages.insert(texture.id, Arc::clone(&page));
        Some(page)
    }

    /// The page of a texture that is not set up yet, as a token.
    fn new_page(&mut self, texture: &Texture, traffic: &mut Traffic) -> Option<CellFlow> {
        if self.state.pages.contains_key(&texture.id) {
            return None;
        }
        self.set_up(texture, traffic).map(CellFlow::Page)
    }

    fn begin(&mut self, polygon: &Arc<Polygon>, traffic: &mut Traffic) -> Option<CellFlow> {
        let texture = polygon.material.color_texture.as_ref();
        let new = texture.and_then(|texture| self.new_page(texture, traffic));
        let page = texture.and_then(|texture| self.state.pages.get(&texture.id)).cloned();
        self.state.surface = Some(Surface { polygon: Arc::clone(polygon), page, slopes: Derived::default() });
        new
    }

    fn control(&mut self, control: Control, traffic: &mut Traffic) -> Option<CellFlow> {
        match control {
            Control::Frame(frame) => {
                self.state.declared.extend(frame.textures.iter().cloned());
                Some(CellFlow::Frame(frame))
            }
            Control::Polygon(polygon) => self.begin(&polygon, traffic),
            Control::FrameEnd => Some(CellFlow::FrameEnd),
            Control::Object(_) | Control::CodeBook(_) | Control::Criterion(_) => None,
        }
    }

    #[inline]
    fn cells(&mut self, fragments: &Stamp<Fragment>) -> Stamp<PlacedCell> {
        let CellsState { surface, counters, .. } = &mut self.state;
        let Some(surface) = surface else { return Stamp::new() };
        let mut cells = Stamp::new();
        for f in fragments {
            if surface.slopes.as_ref().is_none_or(|s| s.number != f.triangle) {
                *surface.slopes = slopes(&surface.polygon, surface.page.as_deref(), f.triangle, self.lighting);
            }
            let Some(slopes) = &*surface.slopes else { continue };
            let colour = slopes.colour.at(f.weights);
            let cell = match &surface.page {
                Some(page) => {
                    counters.textured += 1;
                    let depth = layer_depth(page.dmax(), slopes.footprint.rho_squared(f.x, f.y));
                    self.format.textured(page, slopes.coordinates.at(f.weights), depth, colour)
                }
                None => {
                    counters.direct += 1;
                    Cell::direct(saturated(colour))
                }
            };
            cells.push(PlacedCell { x: f.x, y: f.y, cell });
        }
        cells
    }
}

/// Sets a triangle of the polygon's fan up.
fn slopes(polygon: &Polygon, page: Option<&Page>, number: u16, lighting: Lighting) -> Option<Slopes> {
    let vertices = fan_triangle(polygon, number)?;
    let factor = polygon.material.base_color;
    let colours = vertices.map(|v| {
        let light = if lighting == Lighting::Gouraud { v.brightness[0] + v.brightness[1] } else { 1.0 };
        [0, 1, 2].map(|i| factor[i] * v.color[i] * light)
    });
    let size = page.map_or([1.0; 2], Page::size);
    let st = vertices.map(|v| [v.uv[0] * size[0], v.uv[1] * size[1]]);
    let corner = |i: usize| {
        let [x, y, _, q] = vertices[i].position.map(f64::from);
        ([x, y], q)
    };
    Some(Slopes {
        number,
        colour: Gradient::new([&colours[0], &colours[1], &colours[2]]),
        coordinates: Gradient::new([&st[0], &st[1], &st[2]]),
        footprint: Footprint::new([corner(0), corner(1), corner(2)], st.map(|c| c.map(f64::from))),
    })
}

impl Unit for Cells {
    basrelief_kernel::role!("texture, coordinates, layer depth, brightness of a pixel; sets pages (132) up");
    type In = Option<Flow<Stamp<Fragment>>>;
    type Out = Option<CellFlow>;

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.declared.is_empty() { Demand::All } else { Demand::Nothing }
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, traffic: &mut Traffic) -> Step<Self::Out> {
        let latency = u64::from(self.config.latency);
        match input {
            Some(Flow::Item(stamp)) => {
                let cells = self.cells(&stamp);
                let groups = cells.len().div_ceil(self.config.fill_rate as usize);
                Step::over(groups, 1, latency, (!cells.is_empty()).then_some(CellFlow::Cells(cells)))
            }
            Some(Flow::Control(control)) => Step::after(latency, self.control(control, traffic)),
            None => {
                let texture = self.state.declared.pop_front();
                Step::after(latency, texture.and_then(|texture| self.new_page(&texture, traffic)))
            }
        }
    }

    fn is_empty(&self) -> bool {
        self.state.declared.is_empty()
    }

    fn tell(&self, facts: &mut Facts) {
        facts.rate(0, self.config.latency, 1_u64);
        let c = &self.state.counters;
        facts.figure("cells_textured", c.textured, "cells", "Cells with a texture");
        facts.figure("cells_direct", c.direct, "cells", "Cells with a colour");
    }
}
