//! Texture look-up table (330), with its cache and its memory.

use crate::config::LookUpConfig;
use crate::join_streams::{PairedInput, pair};
use crate::signals::{LevelPacket, TexelPacket, TexturePacket, to_16_bits};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, Step, Unit};
use basrelief_shading::{BlockLayout, LevelPlace, SampleTaps, taps};
use basrelief_signals::{Control, Flow, Image, PACKET_PIXELS, TexelFilter, Texture};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// White in the format of [`TexturePacket::rgba`].
const WHITE: [u16; 4] = [255 << 8; 4];

/// Counters of the texture look-up table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TextureLookUpTableCounters {
    /// Pixels with a texture.
    pub pixels: u64,
    /// Samples filtered. A pixel between two levels has two.
    pub samples: u64,
    /// Texels read for the samples.
    pub texels: u64,
}

/// State of the texture look-up table between steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TextureLookUpTableState {
    /// Texture of the polygon.
    pub texture: Option<Arc<Texture>>,
    /// Position of each of its levels.
    pub places: Vec<LevelPlace>,
    /// Counters.
    pub counters: TextureLookUpTableCounters,
}

/// Texture look-up table (330): takes u, v and map select, and emits the texture value. Client 0 is the cache in front of its
/// memory.
///
/// Only pixels that passed the depth test are looked up. A polygon without a texture is white.
#[derive(Clone, Debug, Default)]
pub struct TextureLookUpTable {
    /// Parameters.
    pub config: LookUpConfig,
    /// True if a level with a fraction looks up two levels.
    pub trilinear: bool,
    /// Bytes per line of the cache.
    pub line_bytes: u32,
    /// Memory layout of textures.
    pub layout: BlockLayout,
    /// Exponent n: 2^n texels share a line.
    shared: u32,
    /// State between steps.
    pub state: TextureLookUpTableState,
}

impl TextureLookUpTable {
    /// Creates a texture look-up table in its power-on state, with a cache of lines of this size.
    pub fn new(config: LookUpConfig, trilinear: bool, line_bytes: u32) -> Self {
        let bytes = config.texel_bytes;
        let shared = if bytes.is_power_of_two() { (line_bytes / bytes).max(1).ilog2() } else { 0 };
        let (layout, state) = (BlockLayout::default(), TextureLookUpTableState::default());
        Self { config, trilinear, line_bytes, layout, shared, state }
    }

    /// Sets the memory layout of textures.
    pub fn with_layout(self, layout: BlockLayout) -> Self {
        Self { layout, ..self }
    }

    fn take(&mut self, control: &Control) {
        let Control::Polygon(polygon) = control else { return };
        let texture = &polygon.material.color_texture;
        let is_known = match (&self.state.texture, texture) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (a, b) => a.is_none() && b.is_none(),
        };
        if !is_known {
            self.state.texture.clone_from(texture);
            let layout = self.layout;
            self.state.places = texture.iter().flat_map(|t| (0..t.levels.len()).map(|k| layout.level(t, k))).collect();
        }
    }

    /// Returns the texture values of a packet, and the cycles of its pixels.
    #[inline(always)]
    fn look_up(&mut self, packet: TexelPacket, levels: &LevelPacket, traffic: &mut MemoryPorts) -> (TexturePacket, usize) {
        let TexelPacket { packet, points, uv, displacement, .. } = packet;
        let mut out = TexturePacket { packet, points, rgba: [WHITE; PACKET_PIXELS], displacement };
        let Self { config, trilinear, state, shared, .. } = self;
        let Some(texture) = state.texture.as_deref() else { return (out, packet.pixels()) };
        let (mut second, pixels) = (0, packet.pixels());
        let mut port = TexelPort { config, texture, places: &state.places, shared: *shared, recent: [u64::MAX; 4], texels: 0 };
        for i in packet.positions() {
            let level = levels.level[i];
            let (fine, share) = (level as usize, level - (level as usize) as f32);
            let mut value = port.sample(fine, uv[i], traffic);
            if *trilinear && share > 0.0 {
                second += 1;
                let coarse = port.sample(fine + 1, uv[i], traffic);
                value = std::array::from_fn(|c| value[c] + share * (coarse[c] - value[c]));
            }
            let [r, g, b, a] = value;
            out.rgba[i] = to_16_bits([256.0 * r, 256.0 * g, 256.0 * b, 256.0 * a]);
        }
        state.counters.pixels += pixels as u64;
        state.counters.samples += (pixels + second) as u64;
        state.counters.texels += port.texels;
        // With two filters a pixel's two samples take one cycle, but two pixels never share a cycle.
        let cycles = if config.samples_per_cycle >= 2 { pixels } else { pixels + second };
        (out, cycles)
    }
}

/// Components of a texel.
const COMPONENTS: u32 = 4;
/// Width of a component or of a weight: 8 bits, and 8 of a fraction.
const COMPONENT_BITS: u32 = 16;
/// Width of u, v as an address.
const ADDRESS_BITS: u32 = 24;

impl TextureLookUpTable {
    /// Reports the hardware. A weighted mean of two is a difference, a product and a sum. A bilinear sample is three means for
    /// each component, and two levels are one more.
    fn tell_hardware(&self, stats: &mut UnitStats) {
        let means = if self.config.filter == TexelFilter::Nearest { 0 } else { 3 * self.config.samples_per_cycle };
        let levels = u32::from(self.trilinear);
        stats.hardware(HardwareKind::Multiplier, "u, v to texels", 2 * self.config.samples_per_cycle, ADDRESS_BITS);
        stats.hardware(HardwareKind::Multiplier, "filters", means * COMPONENTS, COMPONENT_BITS);
        stats.hardware(HardwareKind::Adder, "filters", 2 * means * COMPONENTS, COMPONENT_BITS);
        stats.hardware(HardwareKind::Multiplier, "between levels", levels * COMPONENTS, COMPONENT_BITS);
        stats.hardware(HardwareKind::Adder, "between levels", 2 * levels * COMPONENTS, COMPONENT_BITS);
    }
}

/// Access to the texels of a packet.
struct TexelPort<'a> {
    config: &'a LookUpConfig,
    texture: &'a Texture,
    places: &'a [LevelPlace],
    shared: u32,
    /// Lines that were looked up last. Repeated look-ups would cost the device nothing, but they would cost host time.
    recent: [u64; 4],
    texels: u64,
}

impl TexelPort<'_> {
    /// Returns the filtered RGBA of a level, 0..=255. Missing levels use the last one.
    #[inline(always)]
    fn sample(&mut self, level: usize, uv: [f32; 2], traffic: &mut MemoryPorts) -> [f32; 4] {
        let level = level.min(self.texture.levels.len().saturating_sub(1));
        let (Some(image), Some(place)) = (self.texture.levels.get(level), self.places.get(level)) else { return [255.0; 4] };
        let taps = taps(image, &self.texture.sampler, self.config.filter, uv);
        let count = usize::from(taps.count);
        self.texels += count as u64;
        for texel in &place.taps(&taps)[..count] {
            self.mention(*texel, traffic);
        }
        filtered(image, &taps)
    }

    /// Looks up a texel.
    #[inline(always)]
    fn mention(&mut self, texel: u64, traffic: &mut MemoryPorts) {
        let bytes = self.config.texel_bytes;
        let line = texel >> self.shared;
        if !self.recent.contains(&line) {
            self.recent = [line, self.recent[0], self.recent[1], self.recent[2]];
            traffic.look_up(0, texel * u64::from(bytes), bytes);
        }
    }
}

/// Returns the weighted mean of the texels in `taps`.
#[inline(always)]
fn filtered(image: &Image, taps: &SampleTaps) -> [f32; 4] {
    let texel = |i: usize| {
        let [column, row] = taps.texel[i];
        let texel = image.texels.get(row as usize * image.width as usize + column as usize);
        let [r, g, b, a] = texel.copied().unwrap_or_default();
        [f32::from(r), f32::from(g), f32::from(b), f32::from(a)]
    };
    if taps.count == 1 {
        return texel(0);
    }
    // Spelled out, because a map over the array would be a call.
    let (a, b, c, d) = (texel(0), texel(1), texel(2), texel(3));
    let [p, q, r, s] = taps.weight;
    let mixed = |i: usize| p * a[i] + q * b[i] + r * c[i] + s * d[i];
    [mixed(0), mixed(1), mixed(2), mixed(3)]
}

impl Unit for TextureLookUpTable {
    basrelief_kernel::unit_info!("looks texels up and filters them");
    type In = (Option<Flow<TexelPacket>>, Option<Flow<LevelPacket>>);
    type Out = Option<Flow<TexturePacket>>;

    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        let latency = u64::from(self.config.latency);
        match pair("texture look-up table", input, traffic) {
            PairedInput::Items(packet, levels) => {
                let (out, cycles) = self.look_up(packet, &levels, traffic);
                Step::over(cycles, 1, latency, Some(Flow::Item(out)))
                    .after_data(self.config.filter_latency.min(self.config.latency))
            }
            PairedInput::Control(control) => {
                self.take(&control);
                Step::after(latency, Some(Flow::Control(control)))
            }
            PairedInput::Nothing => Step::after(latency, None),
        }
    }

    /// Returns the taps of the pixels of a packet, each on two cache lines if texels can straddle them.
    fn largest_step(&self, client: usize) -> u32 {
        let taps = if self.config.filter == TexelFilter::Nearest { 1 } else { 4 };
        let levels = if self.trilinear { 2 } else { 1 };
        let bytes = self.config.texel_bytes;
        let lines =
            if bytes.is_power_of_two() { bytes.div_ceil(self.line_bytes.max(1)) } else { 2 + bytes / self.line_bytes.max(1) };
        if client == 0 { PACKET_PIXELS as u32 * taps * levels * lines } else { 0 }
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        stats.rate(0, self.config.latency, 1_u64);
        let c = &self.state.counters;
        stats.figure("pixels_textured", c.pixels, "pixels", "Pixels with a texture");
        stats.figure("samples_filtered", c.samples, "samples", "Samples of a level filtered for them");
        stats.figure("texels_read", c.texels, "texels", "Texels read for them");
        self.tell_hardware(stats);
    }
}
