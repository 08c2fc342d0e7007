//! The unit and its step.

use crate::DistinctCounter;
use crate::rotate::{FixedPoint, TangentFrame};
use crate::state::TriangleSetup;
use crate::work::MappingTiming;
use crate::{FilterAt, NormalMappingConfig, NormalMappingState};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, OperandWidth, Operators, Step, Unit, UnitTable};
use basrelief_shading::{
    BlockLayout, FootprintLines, LEVELS, SampleFootprints, decode_normal, footprints, select_levels, stored, weights, wrapped,
};
use basrelief_signals::MapInline as _;
use basrelief_signals::{
    Control, Flow, Fragment, Image, MAX_SAMPLES, MAX_STAMP, Polygon, PseudoNormals, Stamp, StampLanes, StampNormals, StampSample,
    StampSamples,
};
use std::sync::Arc;
use wide::f32x4;

/// Client of the cache in front of the normal-map memory (116).
const NORMAL_MAP: u32 = 0;
/// Stands for a texel missing from an image, whose array is short: a normal that points straight up.
const STRAIGHT_UP: [u8; 4] = [128, 128, 255, 255];

/// Normal-vector mapping unit (108).
///
/// Client 0 is the cache in front of the normal-map memory (116). A step takes one stamp. The rate of fragments follows from the
/// operators that their pseudo-normals need.
#[derive(Clone, Debug)]
pub struct NormalMapping {
    /// Parameters.
    pub config: NormalMappingConfig,
    timing: MappingTiming,
    levels: u8,
    stamp: u32,
    lines: FootprintLines,
    layout: BlockLayout,
    fixed_point: FixedPoint,
    /// State between steps.
    pub state: NormalMappingState,
}

impl NormalMapping {
    /// Creates a unit that selects `levels` MIP levels per polygon (`brightness.levels`) for stamps of at most `stamp` fragments.
    /// Its cache has lines of `line_bytes` bytes (a power of two).
    ///
    /// If [`NormalMappingConfig::samples`] exceeds [`MAX_SAMPLES`], the coarsest samples are dropped. The machine's configuration
    /// rejects this.
    pub fn new(config: NormalMappingConfig, operators: &Operators, levels: u8, stamp: u32, line_bytes: u32) -> Self {
        let lines = FootprintLines::new(0, config.texel_bytes, line_bytes);
        let fixed_point = FixedPoint::new(config.normal_bits);
        let timing = MappingTiming::new(&config, operators);
        let (layout, state) = (BlockLayout::default(), NormalMappingState::default());
        Self { config, timing, levels, stamp, lines, layout, fixed_point, state }
    }

    /// Sets the memory layout of normal maps.
    pub fn with_layout(self, layout: BlockLayout) -> Self {
        Self { layout, ..self }
    }

    fn begin_polygon(&mut self, polygon: &Arc<Polygon>) {
        let map = polygon.material.normal_map.as_deref();
        // Without a map N' = N at every level, but the levels still have different VQ tables.
        let set = select_levels(polygon.lod, self.levels, map.map_or(LEVELS, |m| m.levels.len()));
        if let Some(map) = map {
            for (place, level) in self.state.places.iter_mut().zip(set.level).take(set.count.into()) {
                *place = self.layout.level(map, level.into());
            }
        }
        self.state.levels = set;
        self.state.polygon = Some(Arc::clone(polygon));
        *self.state.setup = None;
    }

    /// Computes the samples of a stamp.
    #[inline(always)]
    fn map(&mut self, PseudoNormals { stamp, samples }: &mut PseudoNormals, traffic: &mut MemoryPorts) {
        if self.sample(stamp, samples, traffic).is_none() {
            // No polygon was announced, or it has no such triangle or level: the normal has no direction.
            samples.clear();
            samples.push(StampSample::all(0, 1.0, [0; 3]));
        }
        let counters = &mut self.state.counters;
        counters.fragments += stamp.len() as u64;
        counters.pseudo_normals += (stamp.len() * samples.len()) as u64;
        for sample in samples.iter() {
            (0..stamp.len()).for_each(|lane| counters.distinct.insert(sample.value.lane(lane)));
        }
    }

    /// Samples the fragments of a stamp side by side. Returns `None` if nothing can be sampled.
    #[inline(always)]
    fn sample(&mut self, stamp: &Stamp<Fragment>, out: &mut StampSamples<StampNormals>, traffic: &mut MemoryPorts) -> Option<()> {
        let NormalMappingState { polygon, levels, places, setup, counters } = &mut self.state;
        let polygon = polygon.as_deref()?;
        let triangle = stamp.first()?.triangle;
        if setup.as_ref().is_none_or(|s| s.triangle != triangle) {
            **setup = TriangleSetup::new(polygon, triangle);
        }
        let setup = setup.as_ref()?;
        counters.bump_fragments += u64::from(polygon.bump) * stamp.len() as u64;
        let [nx, ny, nz, tx, ty, tz, u, v] = setup.attributes.side_by_side(weights(stamp));
        let selected = (0..usize::from(levels.count)).map(|i| (levels.level[i], levels.weight[i], places[i]));
        let Some(map) = polygon.material.normal_map.as_deref() else {
            let value = self.fixed_point.quantize([nx, ny, nz]);
            out.extend(selected.map(|(level, weight, _)| StampSample { level, weight: [weight; MAX_STAMP], value }));
            return Some(());
        };
        let frame = TangentFrame::new([nx, ny, nz], [tx, ty, tz], f32x4::splat(setup.handedness));
        let scale = polygon.material.normal_scale;
        let uv = wrapped(&map.sampler, [u, v]);
        for (level, weight, place) in selected {
            let image = map.levels.get(usize::from(level))?;
            let footprints = footprints(image, &map.sampler, self.config.filter, uv);
            if !traffic.is_discarding() {
                let look_up = |address, bytes| traffic.look_up(NORMAL_MAP, address, bytes);
                self.lines.each(place, &footprints, stamp.len(), look_up);
            }
            counters.texels += u64::from(footprints.count) * stamp.len() as u64;
            let value = |stored: [f32x4; 3]| {
                let [x, y, z] = stored.map_inline(decode_normal);
                self.fixed_point.quantize(frame.rotate([x * scale, y * scale, z]))
            };
            match self.config.filter_at {
                FilterAt::Normal => {
                    let value = value(filtered(image, &footprints));
                    out.push(StampSample { level, weight: [weight; MAX_STAMP], value });
                }
                FilterAt::Brightness => {
                    let taps =
                        footprints.weights().into_iter().zip(footprints.numbers(image.width)).take(footprints.count.into());
                    out.extend(taps.map(|(share, numbers)| StampSample {
                        level,
                        weight: (share * weight).to_array(),
                        value: value(stored(image, numbers, STRAIGHT_UP)),
                    }));
                }
            }
        }
        // A ninth sample is dropped.
        out.truncate(MAX_SAMPLES);
        Some(())
    }
}

/// Returns the filtered stored values: the weighted sum of the taps. Decoding is linear, so it can follow.
#[inline(always)]
fn filtered(image: &Image, footprints: &SampleFootprints) -> [f32x4; 3] {
    let numbers = footprints.numbers(image.width);
    if footprints.count == 1 {
        return stored(image, numbers[0], STRAIGHT_UP);
    }
    let weights = footprints.weights();
    let weighted = |tap: usize| stored(image, numbers[tap], STRAIGHT_UP).map_inline(|component| component * weights[tap]);
    let sum = |[ax, ay, az]: [f32x4; 3], [bx, by, bz]: [f32x4; 3]| [ax + bx, ay + by, az + bz];
    sum(sum(weighted(0), weighted(1)), sum(weighted(2), weighted(3)))
}

impl Unit for NormalMapping {
    basrelief_kernel::unit_info!("maps the normals of the selected MIP levels: pseudo-normals N'");
    type In = Option<Flow<Stamp<Fragment>>>;
    type Out = Option<Flow<PseudoNormals>>;

    fn demand(&self) -> Demand {
        Demand::All
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        let latency = self.timing.latency;
        match input {
            Some(Flow::Item(stamp)) => {
                let fragments = stamp.len();
                let mut out = PseudoNormals { stamp, samples: StampSamples::new() };
                self.map(&mut out, traffic);
                let is_mapped = self.state.polygon.as_ref().is_some_and(|polygon| polygon.material.normal_map.is_some());
                let pace = self.timing.pace(is_mapped, out.samples.len());
                Step::over(fragments, pace, latency, Some(Flow::Item(out))).after_data(self.timing.after_texels)
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
        self.stamp * u32::from(self.levels.clamp(1, LEVELS as u8)) * self.config.taps() * self.lines.per_texel()
    }

    /// Returns the latency, the part of it that needs texels, and the cycles of a fragment: without a map, then with a map by its number
    /// of pseudo-normals.
    fn twin_tables(&self) -> Vec<UnitTable> {
        let pace = (0..=MAX_SAMPLES).map(|samples| vec![self.timing.pace(samples > 0, samples)]).collect();
        let numbers = [("latency", self.timing.latency), ("after", self.timing.after_texels.into())];
        let pace = UnitTable { name: "pace".into(), bits: 64, entries: pace };
        numbers.into_iter().map(|(name, value)| UnitTable::number(name, value)).chain([pace]).collect()
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        stats.rate(0, self.timing.latency, 1_u64);
        let work = self.config.work(self.levels);
        stats.shared_operators("filter, rotate, scale", self.config.operators(), work, OperandWidth::SINGLE);
        stats.hardware(HardwareKind::Registers, "attributes of a triangle", 3 * SET_UP_ATTRIBUTES, NUMBER);
        let c = &self.state.counters;
        stats.figure("bump_fragments", c.bump_fragments, "fragments", "Fragments of bump targets");
        stats.figure("normal_texels", c.texels, "texels", "Normal-map texels read");
        stats.figure("pseudo_normals", c.pseudo_normals, "pseudo-normals", "Pseudo-normals N' calculated");
        stats.figure(
            "distinct_pseudo_normals",
            u64::from(c.distinct.count()),
            "pseudo-normals",
            "Distinct pseudo-normals, counted up to `distinct_pseudo_normals_counted_to`",
        );
        stats.figure(
            "distinct_pseudo_normals_counted_to",
            u64::from(DistinctCounter::LIMIT),
            "pseudo-normals",
            "Limit of the count of distinct pseudo-normals",
        );
    }
}

/// Single-precision number \[bits\].
const NUMBER: u32 = 32;
/// Normal, tangent, coordinates: each is stored as the value at the first vertex and two differences.
const SET_UP_ATTRIBUTES: u32 = 8;

#[cfg(test)]
mod tests;
