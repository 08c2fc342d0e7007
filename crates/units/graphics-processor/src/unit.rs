//! Graphics processor (104).

use crate::blend::{blended, filtered};
use crate::config::{DrawOrder, GraphicsConfig, MipFilter};
use crate::state::{GraphicsProcessorState, HeldItem, InputPhase};
use crate::work::{ANY_PIXEL, PixelTiming};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, OperandWidth, Operators, Step, Unit, UnitTable};
use basrelief_shading::{
    AttributeGradient, BlockLayout, FootprintLines, fan_triangle, footprints, polygon_lod, select_levels, side_by_side, wrapped,
};
use basrelief_signals::{
    Control, Flow, Fragment, Pixel, Polygon, ShadedFragment, Stamp, TexelFilter, Texture, from_fn_inline, layout,
};
use std::sync::Arc;
use wide::f32x4;

/// Client of the colour-texture cache.
const TEXTURES: u32 = 0;

type Out = Step<Option<Flow<Stamp<Pixel>>>>;

/// Graphics processor (104): merges the fragments of bump targets (input 0) and of other polygons (input 1) in one order, applies
/// the colour texture, and blends it with the brightness.
///
/// Colour = texture * base colour * vertex colour * brightness + highlight, 8 bits each, saturating. Without a texture it is the
/// brightness times the colours. Polygons that are not bump targets carry their brightness at the vertices.
///
/// The order is that of the control tokens on input 0. Fragments of bump targets follow there. Fragments of a polygon that is not
/// a bump target come on input 1, between a duplicate of the polygon's token and a duplicate of the token that ends it.
///
/// If drawn after the list, each fragment of a bump target waits as an entry in memory: its brightness, or the data to look it up
/// (client 1; the look-ups happen before this unit either way, in the same number). A second scan of the list restores the rest
/// of the fragment. The rasterizer makes this scan at the pace of the blending, because it has no other work then (assumed). So
/// polygons that are not bump targets need no memory while they wait.
#[derive(Clone, Debug)]
pub struct GraphicsProcessor {
    /// Parameters.
    pub config: GraphicsConfig,
    /// True if the highlight is blended separately from the rest of the brightness (`brightness.components = separate`).
    pub separate: bool,
    /// Maximum number of fragments of a stamp.
    pub stamp: u32,
    /// Line of the cache of colour textures \[bytes\].
    pub line_bytes: u32,
    /// Entry of a fragment that is drawn after the list, as selected by `held` \[bits\].
    pub entry_bits: u32,
    /// Memory layout of colour textures.
    pub layout: BlockLayout,
    timing: PixelTiming,
    lines: FootprintLines,
    /// State between steps.
    pub state: GraphicsProcessorState,
}

impl GraphicsProcessor {
    /// Creates a graphics processor in its power-on state, for stamps of at most `stamp` fragments. `separate`: the two terms of
    /// a vertex's brightness are blended separately. `line_bytes` is the colour cache's line, and `entry_bits` the size of a
    /// waiting entry.
    pub fn new(config: GraphicsConfig, operators: Operators, separate: bool, [stamp, line_bytes, entry_bits]: [u32; 3]) -> Self {
        let (timing, state) = (PixelTiming::new(operators), GraphicsProcessorState::default());
        let lines = FootprintLines::new(layout::COLOR_TEXTURES, config.texel_bytes, line_bytes);
        Self { config, separate, stamp, line_bytes, entry_bits, layout: BlockLayout::default(), timing, lines, state }
    }

    /// Sets the memory layout of colour textures.
    pub fn with_layout(self, layout: BlockLayout) -> Self {
        Self { layout, ..self }
    }

    /// Handles a control token on the path through (106), which defines the order. Polygons that are not bump targets, and the
    /// tokens that end them, have a duplicate on the other path.
    fn control(&mut self, control: Control, traffic: &mut MemoryPorts) -> Option<Flow<Stamp<Pixel>>> {
        if let Some(twin) = self.state.pending.take() {
            return self.accept_twin(control, &twin, traffic);
        }
        if is_plain(&control) {
            self.state.pending = Some(control);
            self.state.phase = InputPhase::Twin(1);
            return None;
        }
        self.accept(control, traffic)
    }

    /// Handles a control token on the direct path.
    fn straight(&mut self, control: Control, traffic: &mut MemoryPorts) -> Option<Flow<Stamp<Pixel>>> {
        if let Some(twin) = self.state.pending.take() {
            return self.accept_twin(control, &twin, traffic);
        }
        self.state.pending = Some(control);
        self.state.phase = InputPhase::Twin(0);
        None
    }

    fn accept_twin(&mut self, control: Control, twin: &Control, traffic: &mut MemoryPorts) -> Option<Flow<Stamp<Pixel>>> {
        if !twins(&control, twin) {
            traffic.fault("graphics processor: its two inputs carry different control tokens; report this as a defect".into());
        }
        self.accept(control, traffic)
    }

    /// Applies the control, or stores it until the end of the list.
    fn accept(&mut self, control: Control, traffic: &mut MemoryPorts) -> Option<Flow<Stamp<Pixel>>> {
        self.state.phase = match &control {
            Control::Polygon(polygon) => InputPhase::Fragments(usize::from(!polygon.bump)),
            _ => InputPhase::Control,
        };
        match self.config.draw {
            DrawOrder::Streamed => {
                self.take_effect(&control);
                Some(Flow::Control(control))
            }
            DrawOrder::AfterList => {
                if control == Control::FrameEnd {
                    self.end_list(traffic);
                }
                self.state.held.push_back(HeldItem::Control(control));
                None
            }
        }
    }

    /// Selects once all values that are constant over a polygon.
    fn take_effect(&mut self, control: &Control) {
        let Control::Polygon(polygon) = control else { return };
        self.state.polygon = Some(Arc::clone(polygon));
        self.state.pace = self.timing.pace(polygon, &self.config);
        if let Some(texture) = &polygon.material.color_texture {
            self.state.level = match self.config.mip {
                MipFilter::Off => 0,
                MipFilter::Nearest => nearest_level(polygon, texture),
            };
            self.state.place = self.layout.level(texture, self.state.level);
        }
    }

    /// Draws the result, or stores it until the end of the list.
    #[inline(always)]
    fn result(&mut self, result: HeldItem, traffic: &mut MemoryPorts) -> Out {
        if !matches!(self.state.phase, InputPhase::Fragments(_)) {
            return self.after(misplaced(traffic));
        }
        match self.config.draw {
            DrawOrder::Streamed => self.draw(result, traffic),
            DrawOrder::AfterList => {
                // Items that need no memory are only received.
                let entries = if matches!(result, HeldItem::Bump(_)) { result.fragments() } else { 1 };
                self.hold(result, traffic);
                Step::over(entries, 1, self.timing.latency, None)
            }
        }
    }

    /// Returns a step of one cycle.
    #[inline]
    fn after(&self, out: Option<Flow<Stamp<Pixel>>>) -> Out {
        Step::after(self.timing.latency, out)
    }

    /// Draws the oldest waiting item.
    fn draw_held(&mut self, traffic: &mut MemoryPorts) -> Out {
        match self.take_held(traffic) {
            // The work on an entry begins with its data.
            Some(held) => {
                let step = self.draw(held, traffic);
                step.after_data(self.timing.latency as u32)
            }
            None => self.after(None),
        }
    }

    #[inline(always)]
    fn draw(&mut self, held: HeldItem, traffic: &mut MemoryPorts) -> Out {
        let fragments = held.fragments();
        let pixels = match held {
            HeldItem::Control(control) => {
                self.take_effect(&control);
                return self.after(Some(Flow::Control(control)));
            }
            HeldItem::Bump(stamp) => {
                let brightness = side_by_side(&stamp, |s| [s.brightness, s.highlight]);
                self.pixels(&stamp, |s| &s.fragment, Some(brightness), traffic)
            }
            HeldItem::Plain(stamp) => self.pixels(&stamp, |fragment| fragment, None, traffic),
        };
        let out = pixels.map(Flow::Item);
        Step::over(fragments, self.state.pace, self.timing.latency, out).after_data(self.timing.after_texels)
    }

    /// Returns the pixels of the fragments of a triangle. Brightness and highlight come from the vertices if there are none.
    #[inline(always)]
    fn pixels<T>(
        &mut self,
        stamp: &Stamp<T>,
        fragment: impl Fn(&T) -> &Fragment,
        brightness: Option<[f32x4; 2]>,
        traffic: &mut MemoryPorts,
    ) -> Option<Stamp<Pixel>> {
        let polygon = self.state.polygon.as_deref()?;
        let material = &*polygon.material;
        let [a, b, c] = fan_triangle(polygon, fragment(stamp.first()?).triangle)?;
        let weights = side_by_side(stamp, |entry| fragment(entry).weights);
        let brightness = brightness.unwrap_or_else(|| {
            let lit = AttributeGradient::new([&a.brightness, &b.brightness, &c.brightness]);
            let [rest, specular] = lit.side_by_side(weights);
            if self.separate { [rest, specular] } else { [rest + specular, f32x4::ZERO] }
        });
        let color = AttributeGradient::new([&a.color, &b.color, &c.color]).side_by_side(weights);
        let mut base: [f32x4; 3] = from_fn_inline(|i| color[i] * material.base_color[i]);
        if let Some(texture) = &material.color_texture {
            let uv = AttributeGradient::new([&a.uv, &b.uv, &c.uv]).side_by_side(weights);
            let texel = self.sample(texture, uv, stamp.len(), traffic)?;
            base = from_fn_inline(|i| base[i] * texel[i]);
        }
        let [red, green, blue] = blended(base, brightness);
        let mut pixels = Stamp::new();
        for (lane, &Fragment { x, y, z, .. }) in stamp.iter().map(fragment).enumerate() {
            pixels.push(Pixel { x, y, z, rgb: [red[lane] as u8, green[lane] as u8, blue[lane] as u8] });
        }
        let count = pixels.len() as u64;
        self.state.counters.textured += if material.color_texture.is_some() { count } else { 0 };
        self.state.counters.pixels += count;
        Some(pixels)
    }

    /// Returns the RGB of samples side by side, of which the first `count` are in use.
    #[inline]
    fn sample(&self, texture: &Texture, uv: [f32x4; 2], count: usize, traffic: &mut MemoryPorts) -> Option<[f32x4; 3]> {
        let image = texture.levels.get(self.state.level)?;
        let footprints = footprints(image, &texture.sampler, self.config.filter, wrapped(&texture.sampler, uv));
        if !traffic.is_discarding() {
            let look_up = |address, bytes| traffic.look_up(TEXTURES, address, bytes);
            self.lines.each(self.state.place, &footprints, count, look_up);
        }
        Some(filtered(image, &footprints))
    }
}

fn misplaced(traffic: &mut MemoryPorts) -> Option<Flow<Stamp<Pixel>>> {
    traffic.fault("graphics processor: a fragment where a control token was due; report this as a defect".into());
    None
}

fn nearest_level(polygon: &Polygon, texture: &Texture) -> usize {
    let lod = polygon_lod(&polygon.vertices, texture, |v| v.uv);
    usize::from(select_levels(lod, 1, texture.levels.len()).level[0])
}

fn is_plain(control: &Control) -> bool {
    matches!(control, Control::Polygon(polygon) if !polygon.bump)
}

/// Returns true if two control tokens are equal. Duplicates share their data, so only restored checkpoints need the deep
/// comparison.
fn twins(a: &Control, b: &Control) -> bool {
    match (a, b) {
        (Control::Frame(a), Control::Frame(b)) => Arc::ptr_eq(a, b) || a == b,
        (Control::Object(a), Control::Object(b)) => Arc::ptr_eq(a, b) || a == b,
        (Control::Polygon(a), Control::Polygon(b)) => Arc::ptr_eq(a, b) || a == b,
        (a, b) => a == b,
    }
}

impl Unit for GraphicsProcessor {
    basrelief_kernel::unit_info!("texture RGB times brightness");
    type In = (Option<Flow<Stamp<ShadedFragment>>>, Option<Flow<Stamp<Fragment>>>);
    type Out = Option<Flow<Stamp<Pixel>>>;

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.drawing {
            return Demand::Nothing;
        }
        match self.state.phase {
            InputPhase::Control => Demand::Only(0),
            InputPhase::Fragments(input) | InputPhase::Twin(input) => Demand::Only(input),
        }
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        match input {
            (Some(Flow::Item(stamp)), None) => self.result(HeldItem::Bump(stamp), traffic),
            (None, Some(Flow::Item(stamp))) => self.result(HeldItem::Plain(stamp), traffic),
            (Some(Flow::Control(control)), None) => {
                let out = self.control(control, traffic);
                self.after(out)
            }
            (None, Some(Flow::Control(control))) => {
                let out = self.straight(control, traffic);
                self.after(out)
            }
            (None, None) => self.draw_held(traffic),
            (Some(_), Some(_)) => self.after(misplaced(traffic)),
        }
    }

    /// Returns the taps of a filtered sample, each on as many cache lines as a texel can lie on, and the lines of entries.
    fn largest_step(&self, client: usize) -> u32 {
        let taps = if self.config.filter == TexelFilter::Nearest { 1 } else { 4 };
        let (bytes, line) = (self.config.texel_bytes, self.line_bytes.max(1));
        let lines = if bytes.is_power_of_two() { bytes.div_ceil(line) } else { 2 + bytes / line };
        match client {
            0 => self.stamp * taps * lines,
            1 => self.largest_hold(),
            _ => 0,
        }
    }

    fn is_empty(&self) -> bool {
        self.state.pending.is_none() && self.state.held.is_empty()
    }

    /// Returns the latency, and the part of it that needs texels.
    fn twin_tables(&self) -> Vec<UnitTable> {
        let after = u64::from(self.timing.after_texels);
        vec![UnitTable::number("latency", self.timing.latency), UnitTable::number("after", after)]
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        stats.rate(0, self.timing.latency, 1_u64);
        stats.shared_operators("filter and blend", self.config.operators(), ANY_PIXEL, OperandWidth::SINGLE);
        stats.hardware(HardwareKind::Registers, "attributes of a triangle", 3 * SET_UP_ATTRIBUTES, NUMBER);
        let c = &self.state.counters;
        stats.figure("pixels_textured", c.textured, "pixels", "Pixels with a colour texture");
        self.tell_held(stats);
    }
}

/// Single-precision number \[bits\].
const NUMBER: u32 = 32;
/// Coordinates, colour, brightness: each is stored as the value at the first vertex and two differences.
const SET_UP_ATTRIBUTES: u32 = 2 + 4 + 2;

#[cfg(test)]
mod tests;
