//! The unit and its step.

use crate::lines::Lines;
use crate::rotate::{FixedPoint, TangentFrame};
use crate::{Counters, FilterAt, NormalMappingConfig, NormalMappingState};
use basrelief_kernel::{Demand, Step, Traffic, Unit};
use basrelief_shading::{Gradient, LEVELS, Taps, decode_normal, fan_triangle, level_offset, select_levels, taps};
use basrelief_signals::{
    Control, Flow, Fragment, Image, MAX_SAMPLES, Polygon, PseudoNormal, PseudoNormals, Samples, Stamp, samples_per_item,
};
use std::sync::Arc;

/// Normal-vector mapping unit (108).
///
/// Client 0 is the cache in front of the normal-map memory (116). One stamp per step; pseudo-normals leave at
/// `normals_per_cycle`.
#[derive(Clone, Debug)]
pub struct NormalMapping {
    config: NormalMappingConfig,
    levels: u8,
    stamp: u32,
    lines: Lines,
    fixed_point: FixedPoint,
    state: NormalMappingState,
    /// Of the triangle that the last fragment was in; follows from the state.
    setup: Option<Setup>,
    /// Room for the samples of a fragment: kept, since a new one would be cleared or copied for each.
    gathered: Gathered,
}

/// Attributes over a triangle; follows from polygon and triangle.
#[derive(Clone, Debug)]
struct Setup {
    triangle: u16,
    /// Normal, tangent, coordinates of the normal map.
    attributes: Gradient<8>,
    handedness: f32,
}

impl Setup {
    fn new(polygon: &Polygon, triangle: u16) -> Option<Self> {
        let corners = fan_triangle(polygon, triangle)?;
        let [a, b, c] = corners.map(|v| {
            let ([nx, ny, nz], [tx, ty, tz, _], [u, v]) = (v.normal, v.tangent, v.uv_normal);
            [nx, ny, nz, tx, ty, tz, u, v]
        });
        Some(Self { triangle, attributes: Gradient::new([&a, &b, &c]), handedness: corners[0].tangent[3] })
    }
}

impl NormalMapping {
    /// A unit that selects `levels` MIP levels per polygon (`brightness.levels`) for stamps of at most `stamp` fragments, behind
    /// a cache with lines of `line_bytes` bytes (a power of two).
    ///
    /// With [`NormalMappingConfig::samples`] above [`MAX_SAMPLES`] the coarsest samples are dropped: the machine's
    /// configuration rejects that.
    pub fn new(config: NormalMappingConfig, levels: u8, stamp: u32, line_bytes: u32) -> Self {
        let lines = Lines::new(config.texel_bytes, line_bytes);
        let fixed_point = FixedPoint::new(config.normal_bits);
        Self {
            config,
            levels,
            stamp,
            lines,
            fixed_point,
            state: NormalMappingState::default(),
            setup: None,
            gathered: Gathered::default(),
        }
    }

    /// State; for checkpoints.
    pub fn state(&self) -> &NormalMappingState {
        &self.state
    }

    /// Puts a state back; the default resets.
    pub fn set_state(&mut self, state: NormalMappingState) {
        self.state = state;
        self.setup = None;
    }

    /// What was counted.
    pub fn counters(&self) -> &Counters {
        &self.state.counters
    }

    fn begin_polygon(&mut self, polygon: &Arc<Polygon>) {
        let map = polygon.material.normal_map.as_deref();
        // Without a map N' = N at every level: the levels still have different VQ tables.
        let set = select_levels(polygon.lod, self.levels, map.map_or(LEVELS, |m| m.levels.len()));
        if let Some(map) = map {
            self.state.base = std::array::from_fn(|i| level_offset(map, usize::from(set.level[i])));
        }
        self.state.levels = set;
        self.state.polygon = Some(Arc::clone(polygon));
        self.setup = None;
    }

    #[inline(always)]
    fn map(&mut self, stamp: Stamp<Fragment>, traffic: &mut Traffic) -> PseudoNormals {
        let mut samples = Samples::new();
        self.lines.begin_step();
        for fragment in &stamp {
            let before = samples.len();
            self.sample(fragment, &mut samples, traffic);
            if samples.len() == before {
                // No polygon was announced, or it has no such triangle: a normal without direction.
                samples.push(PseudoNormal { weight: 1.0, ..PseudoNormal::default() });
            }
        }
        let counters = &mut self.state.counters;
        counters.fragments += stamp.len() as u64;
        counters.pseudo_normals += samples.len() as u64;
        samples.iter().for_each(|s| counters.distinct.insert(s.normal));
        PseudoNormals { stamp, samples }
    }

    #[inline]
    fn sample(&mut self, fragment: &Fragment, out: &mut Samples<PseudoNormal>, traffic: &mut Traffic) -> Option<()> {
        let NormalMappingState { polygon, levels, base, counters } = &mut self.state;
        let polygon = polygon.as_deref()?;
        if self.setup.as_ref().is_none_or(|s| s.triangle != fragment.triangle) {
            self.setup = Setup::new(polygon, fragment.triangle);
        }
        let setup = self.setup.as_ref()?;
        counters.bump_fragments += u64::from(polygon.bump);
        let [nx, ny, nz, tx, ty, tz, u, v] = setup.attributes.at(fragment.weights);
        let selected = (0..usize::from(levels.count)).map(|i| (levels.level[i], levels.weight[i], base[i]));
        let Some(map) = polygon.material.normal_map.as_deref() else {
            let normal = self.fixed_point.quantize([nx, ny, nz, 0.0]);
            out.extend(selected.map(|(level, weight, _)| PseudoNormal { weight, normal, level }));
            return Some(());
        };
        let frame = TangentFrame::new([nx, ny, nz], [tx, ty, tz], setup.handedness);
        let scale = polygon.material.normal_scale;
        let gathered = &mut self.gathered;
        gathered.samples.clear();
        for (level, weight, base) in selected {
            let image = map.levels.get(usize::from(level))?;
            let taps = taps(image, &map.sampler, self.config.filter, [u, v]);
            self.lines.look_up(image.width, base, &taps, traffic);
            counters.texels += u64::from(taps.count);
            gathered.add((level, weight), self.config.filter_at, image, &taps);
        }
        // A loop of its own: the samples do not depend on each other, and a short body lets the processor overlap them.
        for sample in &gathered.samples {
            let [x, y, z, _] = decode_normal(sample.stored);
            let normal = self.fixed_point.quantize(frame.rotate([x * scale, y * scale, z]));
            out.push(PseudoNormal { weight: sample.weight, normal, level: sample.level });
        }
        Some(())
    }
}

/// A texel as stored, 0..=255 per component; one that the image lacks (its texels are short) points straight up.
///
/// All four components, although alpha means nothing: four fit a vector register, three do not.
#[inline]
fn stored(image: &Image, [x, y]: [u32; 2]) -> [f32; 4] {
    let at = y as usize * image.width as usize + x as usize;
    let [r, g, b, a] = image.texels.get(at).copied().unwrap_or([128, 128, 255, 255]);
    [f32::from(r), f32::from(g), f32::from(b), f32::from(a)]
}

/// A sample in tangent space, as stored in the map.
#[derive(Clone, Copy, Debug)]
struct Stored {
    stored: [f32; 4],
    weight: f32,
    level: u8,
}

/// The samples of a fragment.
#[derive(Clone, Debug, Default)]
struct Gathered {
    samples: Vec<Stored>,
}

impl Gathered {
    /// Adds the samples of a level: one, or one per tap.
    #[inline]
    fn add(&mut self, (level, weight): (u8, f32), at: FilterAt, image: &Image, taps: &Taps) {
        let [p, q, r, s] = taps.texel;
        let a = stored(image, p);
        if taps.count == 1 {
            return self.push(Stored { stored: a, weight, level });
        }
        let (b, c, d) = (stored(image, q), stored(image, r), stored(image, s));
        let [wa, wb, wc, wd] = taps.weight;
        match at {
            // The weighted sum of what is stored: decoding is linear, so it can follow.
            FilterAt::Normal => {
                let lane = |i: usize| (wa * a[i] + wb * b[i]) + (wc * c[i] + wd * d[i]);
                self.push(Stored { stored: [lane(0), lane(1), lane(2), lane(3)], weight, level });
            }
            FilterAt::Brightness => {
                for (share, stored) in [(wa, a), (wb, b), (wc, c), (wd, d)] {
                    self.push(Stored { stored, weight: weight * share, level });
                }
            }
        }
    }

    /// A ninth is dropped.
    #[inline]
    fn push(&mut self, sample: Stored) {
        if self.samples.len() < MAX_SAMPLES {
            self.samples.push(sample);
        }
    }
}

impl Unit for NormalMapping {
    type In = Option<Flow<Stamp<Fragment>>>;
    type Out = Option<Flow<PseudoNormals>>;

    fn demand(&self) -> Demand {
        Demand::All
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, traffic: &mut Traffic) -> Step<Self::Out> {
        let latency = u64::from(self.config.latency);
        match input {
            Some(Flow::Item(stamp)) => {
                let out = self.map(stamp, traffic);
                let per_fragment = samples_per_item(out.samples.len(), out.stamp.len()) as u32;
                let interval = per_fragment.div_ceil(self.config.normals_per_cycle.max(1));
                Step::over(out.stamp.len(), u64::from(interval), latency, Some(Flow::Item(out)))
            }
            Some(Flow::Control(control)) => {
                if let Control::Polygon(polygon) = &control {
                    self.begin_polygon(polygon);
                }
                Step::after(latency, Some(Flow::Control(control)))
            }
            None => Step::after(latency, None),
        }
    }

    fn largest_step(&self, client: usize) -> u32 {
        if client != 0 {
            return 0;
        }
        self.stamp * u32::from(self.levels.clamp(1, LEVELS as u8)) * self.config.taps() * self.lines.per_texel
    }
}

#[cfg(test)]
#[path = "unit_tests.rs"]
mod tests;
