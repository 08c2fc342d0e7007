//! The unit and its step.

use crate::DistinctCounter;
use crate::lanes::weights;
use crate::lines::Lines;
use crate::rotate::{FixedPoint, TangentFrame};
use crate::state::Setup;
use crate::work::Timing;
use crate::{FilterAt, NormalMappingConfig, NormalMappingState};
use basrelief_kernel::facts::Facts;
use basrelief_kernel::{Demand, HardwareKind, Operators, Step, Traffic, Unit};
use basrelief_shading::{Footprints, LEVELS, Layout, Taps, decode_normal, footprints, select_levels};
use basrelief_signals::{Control, Flow, Fragment, Image, MAX_SAMPLES, MAX_STAMP, Polygon, PseudoNormals, Sample, Samples, Stamp};
use std::sync::Arc;
use wide::f32x4;

/// Normal-vector mapping unit (108).
///
/// Client 0 is the cache in front of the normal-map memory (116). One stamp per step; fragments follow each other as fast as
/// operators take turns with their pseudo-normals.
#[derive(Clone, Debug)]
pub struct NormalMapping {
    /// Parameters.
    pub config: NormalMappingConfig,
    timing: Timing,
    levels: u8,
    stamp: u32,
    lines: Lines,
    layout: Layout,
    fixed_point: FixedPoint,
    /// Everything it remembers.
    pub state: NormalMappingState,
}

impl NormalMapping {
    /// A unit that selects `levels` MIP levels per polygon (`brightness.levels`) for stamps of at most `stamp` fragments, behind
    /// a cache with lines of `line_bytes` bytes (a power of two).
    ///
    /// With [`NormalMappingConfig::samples`] above [`MAX_SAMPLES`] the coarsest samples are dropped: the machine's
    /// configuration rejects that.
    pub fn new(config: NormalMappingConfig, operators: &Operators, levels: u8, stamp: u32, line_bytes: u32) -> Self {
        let lines = Lines::new(config.texel_bytes, line_bytes);
        let fixed_point = FixedPoint::new(config.normal_bits);
        let timing = Timing::new(&config, operators);
        let (layout, state) = (Layout::default(), NormalMappingState::default());
        Self { config, timing, levels, stamp, lines, layout, fixed_point, state }
    }

    /// With normal maps laid out so.
    pub fn with_layout(self, layout: Layout) -> Self {
        Self { layout, ..self }
    }

    fn begin_polygon(&mut self, polygon: &Arc<Polygon>) {
        let map = polygon.material.normal_map.as_deref();
        // Without a map N' = N at every level: the levels still have different VQ tables.
        let set = select_levels(polygon.lod, self.levels, map.map_or(LEVELS, |m| m.levels.len()));
        if let Some(map) = map {
            self.state.places = std::array::from_fn(|i| self.layout.level(map, usize::from(set.level[i])));
        }
        self.state.levels = set;
        self.state.polygon = Some(Arc::clone(polygon));
        *self.state.setup = None;
    }

    #[inline(always)]
    fn map(&mut self, stamp: Stamp<Fragment>, traffic: &mut Traffic) -> PseudoNormals {
        let mut samples = Samples::new();
        if self.sample(&stamp, &mut samples, traffic).is_none() {
            // No polygon was announced, or it has no such triangle or level: a normal without direction.
            samples.clear();
            samples.push(Sample::all(0, 1.0, [0; 3]));
        }
        let counters = &mut self.state.counters;
        counters.fragments += stamp.len() as u64;
        counters.pseudo_normals += (stamp.len() * samples.len()) as u64;
        for sample in &samples {
            sample.value.iter().take(stamp.len()).for_each(|normal| counters.distinct.insert(*normal));
        }
        PseudoNormals { stamp, samples }
    }

    /// Samples the fragments of a stamp side by side; `None` where there is nothing to sample.
    #[inline(always)]
    fn sample(&mut self, stamp: &Stamp<Fragment>, out: &mut Samples<[i16; 3]>, traffic: &mut Traffic) -> Option<()> {
        let NormalMappingState { polygon, levels, places, setup, counters } = &mut self.state;
        let polygon = polygon.as_deref()?;
        let triangle = stamp.first()?.triangle;
        if setup.as_ref().is_none_or(|s| s.triangle != triangle) {
            **setup = Setup::new(polygon, triangle);
        }
        let setup = setup.as_ref()?;
        counters.bump_fragments += u64::from(polygon.bump) * stamp.len() as u64;
        let [nx, ny, nz, tx, ty, tz, u, v] = setup.attributes.side_by_side(weights(stamp));
        let selected = (0..usize::from(levels.count)).map(|i| (levels.level[i], levels.weight[i], places[i]));
        let Some(map) = polygon.material.normal_map.as_deref() else {
            let value = self.fixed_point.quantize([nx, ny, nz]);
            out.extend(selected.map(|(level, weight, _)| Sample { level, weight: [weight; MAX_STAMP], value }));
            return Some(());
        };
        let frame = TangentFrame::new([nx, ny, nz], [tx, ty, tz], f32x4::splat(setup.handedness));
        let scale = polygon.material.normal_scale;
        for (level, weight, place) in selected {
            let image = map.levels.get(usize::from(level))?;
            let footprints = footprints(image, &map.sampler, self.config.filter, [u, v]);
            self.lines.look_up(place, (&footprints, stamp.len()), traffic);
            counters.texels += u64::from(footprints.count) * stamp.len() as u64;
            let mut add = |weight: [f32; MAX_STAMP], stored: [f32x4; 3]| {
                let [x, y, z] = stored.map(|c| f32x4::new(decode_normal(c.to_array())));
                let value = self.fixed_point.quantize(frame.rotate([x * scale, y * scale, z]));
                // A ninth is dropped.
                if out.len() < MAX_SAMPLES {
                    out.push(Sample { level, weight, value });
                }
            };
            match self.config.filter_at {
                FilterAt::Normal => add([weight; MAX_STAMP], filtered(image, &footprints)),
                FilterAt::Brightness => {
                    for tap in 0..usize::from(footprints.count) {
                        let shares = std::array::from_fn(|lane| weight * footprints.taps(lane).weight[tap]);
                        add(shares, unfiltered(image, &footprints, tap));
                    }
                }
            }
        }
        Some(())
    }
}

/// A texel as stored, 0..=255 per component; one that the image lacks (its texels are short) points straight up. Alpha comes
/// along, although it means nothing.
#[inline(always)]
fn stored(image: &Image, [x, y]: [u32; 2]) -> f32x4 {
    let at = y as usize * image.width as usize + x as usize;
    let [r, g, b, a] = image.texels.get(at).copied().unwrap_or([128, 128, 255, 255]);
    f32x4::new([f32::from(r), f32::from(g), f32::from(b), f32::from(a)])
}

/// What is stored, filtered: the weighted sum of the taps. Decoding is linear, so it can follow.
#[inline(always)]
fn filtered(image: &Image, footprints: &Footprints) -> [f32x4; 3] {
    if footprints.count == 1 {
        return unfiltered(image, footprints, 0);
    }
    side_by_side(|lane| {
        let Taps { texel: [a, b, c, d], weight: [wa, wb, wc, wd], .. } = footprints.taps(lane);
        (stored(image, a) * wa + stored(image, b) * wb) + (stored(image, c) * wc + stored(image, d) * wd)
    })
}

/// One tap of each footprint as stored.
#[inline]
fn unfiltered(image: &Image, footprints: &Footprints, tap: usize) -> [f32x4; 3] {
    side_by_side(|lane| stored(image, footprints.taps(lane).texel[tap]))
}

/// Turns the texels of the lanes into the lanes of the components.
#[inline(always)]
fn side_by_side(texel: impl Fn(usize) -> f32x4) -> [f32x4; 3] {
    let [x, y, z, _] = f32x4::transpose([texel(0), texel(1), texel(2), texel(3)]);
    [x, y, z]
}

impl Unit for NormalMapping {
    basrelief_kernel::role!("maps the normals of the selected MIP levels: pseudo-normals N'");
    type In = Option<Flow<Stamp<Fragment>>>;
    type Out = Option<Flow<PseudoNormals>>;

    fn demand(&self) -> Demand {
        Demand::All
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, traffic: &mut Traffic) -> Step<Self::Out> {
        let latency = self.timing.latency;
        match input {
            Some(Flow::Item(stamp)) => {
                let out = self.map(stamp, traffic);
                let is_mapped = self.state.polygon.as_ref().is_some_and(|polygon| polygon.material.normal_map.is_some());
                let pace = self.timing.pace(is_mapped, out.samples.len());
                Step::over(out.stamp.len(), pace, latency, Some(Flow::Item(out)))
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

    fn tell(&self, facts: &mut Facts) {
        facts.rate(0, self.timing.latency, 1_u64);
        facts.operators("filter, rotate, scale", self.config.operators(), NUMBER);
        facts.hardware(HardwareKind::Registers, "attributes of a triangle", 3 * SET_UP_ATTRIBUTES, NUMBER);
        let c = &self.state.counters;
        facts.figure("bump_fragments", c.bump_fragments, "fragments", "Fragments of bump targets");
        facts.figure("normal_texels", c.texels, "texels", "Normal-map texels read");
        facts.figure("pseudo_normals", c.pseudo_normals, "pseudo-normals", "Pseudo-normals N' calculated");
        facts.figure(
            "distinct_pseudo_normals",
            u64::from(c.distinct.count()),
            "pseudo-normals",
            "Distinct ones; more are not told apart from `distinct_pseudo_normals_counted_to`",
        );
        facts.figure(
            "distinct_pseudo_normals_counted_to",
            u64::from(DistinctCounter::LIMIT),
            "pseudo-normals",
            "So many distinct ones are counted, and no more",
        );
    }
}

/// A number in single precision \[bits\].
const NUMBER: u32 = 32;
/// Normal, tangent, coordinates: each at the first vertex, and what the others add.
const SET_UP_ATTRIBUTES: u32 = 8;

#[cfg(test)]
mod tests;
