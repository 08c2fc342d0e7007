//! The graphics processor (104).

use crate::blend::{blended, filtered};
use crate::config::{DrawOrder, GraphicsConfig, Mip};
use crate::state::{GraphicsState, Held, Phase};
use basrelief_kernel::{Demand, Step, Traffic, Unit};
use basrelief_shading::texture::texel_offset;
use basrelief_shading::{fan_triangle, interpolate, level_offset, polygon_lod, select_levels, taps};
use basrelief_signals::{Control, Filter, Flow, Fragment, Pixel, Polygon, Shaded, Texture, layout};
use std::sync::Arc;

/// Client of the colour-texture cache.
const TEXTURES: u32 = 0;
/// Client that writes and reads held results.
const RESULTS: u32 = 1;

/// Graphics processor (104): puts the fragments of bump targets (input 0) and of other polygons (input 1) back into one
/// order, maps the ordinary texture, blends it with the brightness.
///
/// Colour = texture * base colour * vertex colour * brightness + highlight, 8 bits each, saturating; without a texture
/// the brightness itself times the colours. Other polygons carry their brightness at the vertices.
///
/// The order is that of the control tokens on input 0. Fragments of bump targets follow there; those of a polygon that is
/// no bump target come on input 1, between a twin of the polygon's token and a twin of the token that ends it.
#[derive(Clone, Debug, Default)]
pub struct GraphicsProcessor {
    /// Parameters.
    pub config: GraphicsConfig,
    /// The highlight is blended apart from the rest of the brightness (`brightness.components = separate`).
    pub separate: bool,
    /// Everything it remembers.
    pub state: GraphicsState,
}

impl GraphicsProcessor {
    /// A graphics processor at power-on; `separate`: the two terms of a vertex's brightness are blended apart.
    pub fn new(config: GraphicsConfig, separate: bool) -> Self {
        Self { config, separate, state: GraphicsState::default() }
    }

    /// A control token on the way through (106), which carries the order. Polygons that are no bump target, and what ends
    /// them, have a twin on the other way.
    fn control(&mut self, control: Control, traffic: &mut Traffic) -> Option<Flow<Pixel>> {
        if let Some(twin) = self.state.pending.take() {
            return self.accept_twin(control, &twin, traffic);
        }
        if is_plain(&control) {
            self.state.pending = Some(control);
            self.state.phase = Phase::Twin(1);
            return None;
        }
        self.accept(control)
    }

    /// A control token on the straight way.
    fn straight(&mut self, control: Control, traffic: &mut Traffic) -> Option<Flow<Pixel>> {
        if let Some(twin) = self.state.pending.take() {
            return self.accept_twin(control, &twin, traffic);
        }
        self.state.pending = Some(control);
        self.state.phase = Phase::Twin(0);
        None
    }

    fn accept_twin(&mut self, control: Control, twin: &Control, traffic: &mut Traffic) -> Option<Flow<Pixel>> {
        if !twins(&control, twin) {
            traffic.fault("graphics processor: its two inputs carry different control tokens; report this as a defect".into());
        }
        self.accept(control)
    }

    /// The control takes effect, or waits for the end of the list.
    fn accept(&mut self, control: Control) -> Option<Flow<Pixel>> {
        self.state.phase = match &control {
            Control::Polygon(polygon) => Phase::Fragments(usize::from(!polygon.bump)),
            _ => Phase::Control,
        };
        match self.config.draw {
            DrawOrder::Streamed => {
                self.take_effect(&control);
                Some(Flow::Control(control))
            }
            DrawOrder::AfterList => {
                self.state.drawing = control == Control::FrameEnd;
                self.state.held.push_back(Held::Control(control));
                None
            }
        }
    }

    /// What is constant over a polygon is chosen once.
    fn take_effect(&mut self, control: &Control) {
        let Control::Polygon(polygon) = control else { return };
        self.state.polygon = Some(Arc::clone(polygon));
        if let Some(texture) = &polygon.material.color_texture {
            self.state.level = match self.config.mip {
                Mip::Off => 0,
                Mip::Nearest => nearest_level(polygon, texture),
            };
            self.state.level_offset = level_offset(texture, self.state.level);
        }
    }

    /// Draws the result, or holds it until the end of the list; and the cycles that this takes.
    #[inline]
    fn result(&mut self, result: Held, traffic: &mut Traffic) -> (Option<Flow<Pixel>>, u64) {
        if !matches!(self.state.phase, Phase::Fragments(_)) {
            return (misplaced(traffic), 1);
        }
        match self.config.draw {
            DrawOrder::Streamed => (self.draw(result, traffic), u64::from(self.config.blend_cycles)),
            DrawOrder::AfterList => {
                self.hold(result, traffic);
                (None, 1)
            }
        }
    }

    fn hold(&mut self, result: Held, traffic: &mut Traffic) {
        let bytes = self.config.held_bytes;
        if (self.state.results_written + 1) * u64::from(bytes) > u64::from(self.config.hold_bytes) {
            return traffic.fault(format!(
                "graphics processor: the results of one frame exceed `graphics.hold_bytes` = {}; raise it, or set `graphics.draw` = streamed",
                self.config.hold_bytes
            ));
        }
        traffic.write(RESULTS, layout::HELD_RESULTS + self.state.results_written * u64::from(bytes), bytes);
        self.state.results_written += 1;
        self.state.counters.held += 1;
        self.state.counters.most_held = self.state.counters.most_held.max(self.state.results_written);
        self.state.held.push_back(result);
    }

    /// Draws the oldest of what is held.
    fn draw_held(&mut self, traffic: &mut Traffic) -> Option<Flow<Pixel>> {
        let held = self.state.held.pop_front()?;
        if !matches!(held, Held::Control(_)) {
            let bytes = self.config.held_bytes;
            traffic.read(RESULTS, layout::HELD_RESULTS + self.state.results_read * u64::from(bytes), bytes);
            self.state.results_read += 1;
        }
        if self.state.held.is_empty() {
            self.state.drawing = false;
            self.state.results_written = 0;
            self.state.results_read = 0;
        }
        self.draw(held, traffic)
    }

    #[inline]
    fn draw(&mut self, held: Held, traffic: &mut Traffic) -> Option<Flow<Pixel>> {
        match held {
            Held::Control(control) => {
                self.take_effect(&control);
                Some(Flow::Control(control))
            }
            Held::Bump(Shaded { fragment, brightness, highlight }) => {
                self.pixel(fragment, Some([brightness, highlight]), traffic)
            }
            Held::Plain(fragment) => self.pixel(fragment, None, traffic),
        }
    }

    /// `shaded`: brightness and highlight where they do not come from the vertices.
    #[inline]
    fn pixel(&mut self, fragment: Fragment, shaded: Option<[f32; 2]>, traffic: &mut Traffic) -> Option<Flow<Pixel>> {
        let polygon = self.state.polygon.as_deref()?;
        let [a, b, c] = fan_triangle(polygon, fragment.triangle)?;
        let weights = fragment.weights;
        let [brightness, highlight] = shaded.unwrap_or_else(|| {
            let [rest, specular] = interpolate([&a.brightness, &b.brightness, &c.brightness], weights);
            if self.separate { [rest, specular] } else { [rest + specular, 0.0] }
        });
        let color = interpolate([&a.color, &b.color, &c.color], weights);
        let mut base: [f32; 3] = std::array::from_fn(|i| color[i] * polygon.material.base_color[i]);
        if let Some(texture) = &polygon.material.color_texture {
            let uv = interpolate([&a.uv, &b.uv, &c.uv], weights);
            let texel = self.sample(texture, uv, traffic)?;
            base = std::array::from_fn(|i| base[i] * texel[i]);
            self.state.counters.textured += 1;
        }
        self.state.counters.pixels += 1;
        let rgb = blended(base, brightness, highlight);
        Some(Flow::Item(Pixel { x: fragment.x, y: fragment.y, z: fragment.z, rgb }))
    }

    #[inline]
    fn sample(&self, texture: &Texture, uv: [f32; 2], traffic: &mut Traffic) -> Option<[f32; 3]> {
        let image = texture.levels.get(self.state.level)?;
        let taps = taps(image, &texture.sampler, self.config.filter, uv);
        let bytes = self.config.texel_bytes;
        for &texel in taps.texel.iter().take(usize::from(taps.count)) {
            let offset = self.state.level_offset + texel_offset(image.width, texel);
            traffic.look_up(TEXTURES, layout::COLOR_TEXTURES + offset * u64::from(bytes), bytes);
        }
        Some(filtered(image, &taps))
    }
}

fn misplaced(traffic: &mut Traffic) -> Option<Flow<Pixel>> {
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

/// Whether two control tokens are the same. Twins share what they point to, so that the deep comparison is for restored
/// checkpoints only.
fn twins(a: &Control, b: &Control) -> bool {
    match (a, b) {
        (Control::Frame(a), Control::Frame(b)) => Arc::ptr_eq(a, b) || a == b,
        (Control::Object(a), Control::Object(b)) => Arc::ptr_eq(a, b) || a == b,
        (Control::Polygon(a), Control::Polygon(b)) => Arc::ptr_eq(a, b) || a == b,
        (a, b) => a == b,
    }
}

impl Unit for GraphicsProcessor {
    type In = (Option<Flow<Shaded>>, Option<Flow<Fragment>>);
    type Out = Option<Flow<Pixel>>;

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.drawing {
            return Demand::Nothing;
        }
        match self.state.phase {
            Phase::Control => Demand::Only(0),
            Phase::Fragments(input) | Phase::Twin(input) => Demand::Only(input),
        }
    }

    #[inline]
    fn step(&mut self, input: Self::In, traffic: &mut Traffic) -> Step<Self::Out> {
        let blend = u64::from(self.config.blend_cycles);
        let (out, occupancy) = match input {
            (Some(Flow::Item(shaded)), None) => self.result(Held::Bump(shaded), traffic),
            (None, Some(Flow::Item(fragment))) => self.result(Held::Plain(fragment), traffic),
            (Some(Flow::Control(control)), None) => (self.control(control, traffic), 1),
            (None, Some(Flow::Control(control))) => (self.straight(control, traffic), 1),
            (None, None) => (self.draw_held(traffic), blend),
            (Some(_), Some(_)) => (misplaced(traffic), 1),
        };
        Step::after(u64::from(self.config.latency), out).busy(occupancy)
    }

    /// Taps of a filtered sample, each on two lines of the cache where texels can straddle them; one held result, which
    /// is the whole traffic of its client.
    fn largest_step(&self, client: usize) -> u32 {
        let taps = if self.config.filter == Filter::Nearest { 1 } else { 4 };
        let lines = if self.config.texel_bytes.is_power_of_two() { 1 } else { 2 };
        match client {
            0 => taps * lines,
            1 => u32::from(self.config.draw == DrawOrder::AfterList),
            _ => 0,
        }
    }

    fn is_empty(&self) -> bool {
        self.state.pending.is_none() && self.state.held.is_empty()
    }
}

#[cfg(test)]
mod tests;
