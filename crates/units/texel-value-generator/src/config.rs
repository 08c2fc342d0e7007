//! Parameters of the texture mapping system (300).

use basrelief_parameters::parameters;
use basrelief_signals::TexelFilter;
use serde::{Deserialize, Serialize};

/// Declares a choice of behaviour: a fieldless enum, in snake case in files, whose first variant is the default.
macro_rules! choice {
    ($(#[doc = $about:literal])* $name:ident { $(#[doc = $first_doc:literal])* $first:ident, $($(#[doc = $doc:literal])* $other:ident,)* }) => {
        $(#[doc = $about])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
        #[serde(rename_all = "snake_case")]
        pub enum $name {
            $(#[doc = $first_doc])* #[default] $first,
            $($(#[doc = $doc])* $other,)*
        }
    };
}

choice! {
    /// Position of division points along a scan line.
    Method {
        /// As far apart as the accuracy criterion allows (Figures 4A, 4B).
        Adaptive,
        /// At every pixel.
        Exact,
        /// At a fixed distance, or a fixed number per scan line (Figure 2).
        Fixed,
        /// At the edges of equal child polygons that the scan line crosses (Figure 1).
        Subpolygon,
    }
}

choice! {
    /// Equation of the step.
    StepForm {
        /// `2 sqrt(e w / |dw|) + e` for dw > 0, `- e` for dw < 0.
        Exact,
        /// `2 sqrt(e w / |dw|)`.
        Approximate,
    }
}

choice! {
    /// Conversion of a span's real ends to integer pixels (step 410).
    Snap {
        /// Up: the pixels with centres between the ends.
        Ceil,
        /// To the nearest.
        Round,
        /// Down.
        Floor,
        /// Towards zero: down, because no pixel lies left of the screen.
        Truncate,
    }
}

choice! {
    /// Direction of marching along a scan line.
    March {
        /// From the left end.
        LeftToRight,
        /// From the right end.
        RightToLeft,
    }
}

choice! {
    /// Computation of u = U/W and v = V/W.
    Division {
        /// Two divisions.
        Two,
        /// One reciprocal and two multiplications.
        Reciprocal,
    }
}

choice! {
    /// Selection by the MIP-map selector (320).
    MipMode {
        /// Level 0, always.
        Off,
        /// The level nearest to the computed one.
        Nearest,
        /// The two levels around the computed one, weighted.
        Trilinear,
    }
}

choice! {
    /// Scope of a MIP level.
    MipPer {
        /// A segment, because the mapping is affine within one.
        Segment,
        /// A pixel, by the exact derivative there.
        Pixel,
    }
}

choice! {
    /// Output of the illuminance value generator (340).
    IlluminanceMode {
        /// Brightness at the vertices, interpolated along edges and scan lines, times the colours.
        Gouraud,
        /// Colours only.
        Off,
    }
}

choice! {
    /// Combination of a new value with the old one in the pixel value buffer (360) by the combiner (350).
    CombineMode {
        /// The new value.
        Replace,
        /// Product of both.
        Modulate,
        /// Both, weighted by the alpha of the new one.
        Blend,
    }
}

parameters! {
    /// Scan converter.
    pub struct ScanConverterConfig {
        /// Sub-pixel bits n: window coordinates are snapped to steps of 2^-n pixel.
        subpixel_bits: u32 = 8, unit: "bits", Assumed("as the bump-mapping processor's rasterizer"), range: 1..=10;
        /// Width of depth values.
        z_bits: u32 = 24, unit: "bits", Assumed("as the bump-mapping processor's rasterizer"), range: 16..=32;
        /// Dividers (`operators.divide`) for the set-up of a triangle: slopes of its three edges, and reciprocal of its area.
        dividers: u32 = 4, unit: "dividers", Assumed("all four at a time; a single one would keep the unit four times as long by each triangle"), range: 1..=4;
        /// Multipliers for the set-up of a triangle.
        multipliers: u32 = 4, unit: "multipliers", Derived("46 products take 12 cycles, within the 16 of a division"), range: 1..=64;
        /// Adders for the set-up of a triangle and for the ends of spans.
        adders: u32 = 7, unit: "adders", Derived("13 additions per span take 2 cycles"), range: 1..=64;
        /// Latency of a span.
        latency: u32 = 4, unit: "cycles", Assumed("addition and step 410"), range: 0..=4096;
    }
}

parameters! {
    /// Texel value generator (310): position of division points.
    pub struct TexelConfig {
        /// Method that positions division points: adaptive, exact, fixed or subpolygon.
        method: Method = Method::Adaptive, unit: "", Stated("claims 1 to 3, Figures 4A, 4B, 5 and 6; the patent compares its method with the others");
        /// Accuracy criterion e in the storage element (step 442): largest distance between a pixel and the position of its
        /// texel. A frame or an object of a display list can select another.
        error_bound: f64 = 0.5, unit: "pixels", Stated("a fitting value of e is 0.5, half a pixel"), range: 0.001..=1024.0;
        /// Equation of the step: exact or approximate.
        step_form: StepForm = StepForm::Exact, unit: "", Derived("the longest step that keeps e, by the sign of dw; the patent's second equation leaves e out of the sum");
        /// Longest span that is not subdivided (step 430).
        min_span: u32 = 2, unit: "pixels", Assumed("between the ends of two pixels there is nothing to interpolate; the patent says: too short to gain much"), range: 1..=16_384;
        /// Longest segment. (310a) has a table with a reciprocal for each length.
        longest_segment: u32 = 1024, unit: "pixels", Assumed("a scan line of a workstation's screen of the time, 1,280 pixels, has two; 16,384 words would be sixteen times the table"), range: 16..=16_384;
        /// Division points between the ends of every scan line, with `fixed`. 0: one every `interval` pixels.
        points: u32 = 0, unit: "points", Assumed("Figure 2 draws seven; an interval is the common variant"), range: 0..=16_384;
        /// Distance of division points with `fixed`, or longest edge of a child polygon with `subpolygon`.
        interval: u32 = 16, unit: "pixels", Assumed("the common choice of renderers of the time"), range: 1..=16_384;
        /// Rounding in step 410: ceil, round, floor or truncate.
        snap: Snap = Snap::Ceil, unit: "", Assumed("the patent names truncation, rounding down and rounding up; only up covers the pixels whose centres are inside");
        /// Direction of marching: left_to_right or right_to_left.
        march: March = March::LeftToRight, unit: "", Stated("step 444 begins at one end of the scan line");
        /// Width of u and v with a sign: quotients, and the values interpolated between them. The binary point is that of their
        /// triangle.
        coordinate_bits: u32 = 29, unit: "bits", Derived("the narrowest that keeps the bound of 0.5 pixel on the demos"), range: 12..=44;
        /// Significant bits of e / |dw| and of the root of a step, rounded down.
        step_bits: u32 = 16, unit: "bits", Assumed("a step is whole pixels, at most 16,384: 14 bits, and two that rounding down twice may cost"), range: 6..=32;
        /// Entries of a table that replaces the square root. 0: a square-root unit.
        step_table: u32 = 0, unit: "entries", Assumed("the patent leaves it open"), range: 0..=65_536;
        /// Latency of a look-up in the table of steps.
        table_cycles: u32 = 2, unit: "cycles", Assumed("normalisation, look-up"), range: 1..=4096;
        /// Multipliers of the step calculator, besides those of its points.
        multipliers: u32 = 2, unit: "multipliers", Derived("the four products that decide about a span take 2 cycles, as a span of the scan converter"), range: 1..=16;
    }
}

parameters! {
    /// Dividers of the texel value generator (310).
    pub struct DividerConfig {
        /// Number of dividers.
        count: u32 = 2, unit: "dividers", Assumed("one each for u and v"), range: 1..=64;
        /// Bits of a quotient or root computed per iteration: a result of w bits takes w over this, rounded up. Applies to all
        /// dividers and roots of the generator.
        bits_per_cycle: u32 = 2, unit: "bits", Assumed("radix 4, of the class of iterative dividers of the time"), range: 1..=8;
        /// True if a division can start every cycle. False: iterative, after the previous one.
        pipelined: bool = false, unit: "", Assumed("iterative; a pipeline has the iteration's hardware as often as it has cycles");
        /// Computation of u and v: two (divisions) or reciprocal (and two multiplications).
        division: Division = Division::Two, unit: "", Stated("two divisions, or an equivalent such as a reciprocal and multiplication");
    }
}

parameters! {
    /// Approximate calculator (310a).
    pub struct ApproximationConfig {
        /// Initiation interval of pixels.
        initiation_interval: u32 = 1, unit: "cycles", Assumed("two adders step u and v"), range: 1..=4096;
        /// Significant bits of the reciprocal of w for the gradient of a pixel, on a divider of its own. With gradients per
        /// pixel, its iterations limit the rate.
        reciprocal_bits: u32 = 12, unit: "bits", Derived("a relative error of 2^-12 moves a level by 2^-11.5, less than its fraction of 8 bits tells"), range: 6..=48;
    }
}

parameters! {
    /// MIP-map selector (320).
    pub struct MipConfig {
        /// Selected level: off, nearest or trilinear.
        mode: MipMode = MipMode::Off, unit: "", Assumed("an option of the patent: in some embodiments");
        /// Scope of a level: segment or pixel.
        per: MipPer = MipPer::Segment, unit: "", Stated("the mapping of a segment is affine, so its level is constant");
        /// Latency of a packet.
        latency: u32 = 2, unit: "cycles", Assumed("position of the leading one of the larger gradient, look-up of its fraction"), range: 0..=4096;
    }
}

parameters! {
    /// Texture look-up table (330).
    pub struct LookUpConfig {
        /// Filter within a level: nearest or bilinear.
        filter: TexelFilter = TexelFilter::Bilinear, unit: "", Assumed("the patent leaves it open");
        /// Size of a texel.
        texel_bytes: u32 = 4, unit: "bytes", Assumed("RGBA, 8 bits each"), range: 4..=16;
        /// Samples filtered per cycle, each of one level: with 1, the two samples of a trilinear pixel take two cycles. A pixel
        /// takes at least one cycle, and the cycles of its ports (`cache.texture.lookups_per_cycle`).
        samples_per_cycle: u32 = 1, unit: "samples", Assumed("one bilinear filter"), range: 1..=2;
        /// Latency of a packet with all texels in the cache.
        latency: u32 = 6, unit: "cycles", Assumed("addressing and filter"), range: 0..=4096;
        /// Part of the latency that needs the texels.
        filter_latency: u32 = 4, unit: "cycles", Derived("the filter: two means, each a product and a sum; addressing takes the other two"), range: 0..=4096;
    }
}

parameters! {
    /// Illuminance value generator (340).
    pub struct IlluminanceConfig {
        /// Generated value: gouraud or off (colours only).
        mode: IlluminanceMode = IlluminanceMode::Gouraud, unit: "", Assumed("the usual one; the patent leaves it open");
        /// Initiation interval of pixels.
        initiation_interval: u32 = 1, unit: "cycles", Assumed("adders step the components along the line"), range: 1..=4096;
        /// Multipliers for the set-up of a span.
        multipliers: u32 = 8, unit: "multipliers", Derived("20 products per span take 3 cycles, and a packet behind it hides them"), range: 1..=64;
        /// Adders for the set-up of a span.
        adders: u32 = 8, unit: "adders", Derived("20 sums per span, as the products"), range: 1..=64;
        /// Latency of a pixel.
        latency: u32 = 3, unit: "cycles", Assumed("product and sum"), range: 0..=4096;
    }
}

parameters! {
    /// Combiner (350).
    pub struct CombinerConfig {
        /// Combination of new and old value: replace, modulate or blend.
        mode: CombineMode = CombineMode::Replace, unit: "", Assumed("the patent feeds the old value back and states no purpose");
        /// Initiation interval of pixels.
        initiation_interval: u32 = 1, unit: "cycles", Assumed("a multiplier per component"), range: 1..=4096;
        /// Latency of a pixel, with the old value available.
        latency: u32 = 3, unit: "cycles", Assumed("two products and a sum"), range: 0..=4096;
        /// Part of the latency that needs the old pixel value.
        blend_latency: u32 = 2, unit: "cycles", Derived("the second product and the sum; the first product needs no old value"), range: 0..=4096;
        /// Cycles that the look-up of a line's flag takes before the line is read.
        flag_latency: u32 = 0, unit: "cycles", Derived("the flag is read in the cycle that searches the lines on their way to memory; a read of the line depends on both"), range: 0..=4096;
    }
}
