//! Parameters of the figure shading device (200).

use basrelief_parameters::{parameter_groups, parameters};
use basrelief_signals::{ShadingMode, ShadingSettings};
use serde::{Deserialize, Serialize};

/// Stage at which N.L below 0 is clamped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SumClamp {
    /// Clamped at the sample points.
    #[default]
    Vertex,
    /// Not clamped.
    None,
}

/// Work saved if the specular term is negligible.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SpecularSkip {
    /// Circuit (50) is not started.
    #[default]
    NoStart,
    /// Circuit (50) works, and gate (51) blocks its output.
    Gate,
}

/// Method by which circuit (50) computes the power n.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PowerMethod {
    /// Repeated squaring and multiplication.
    #[default]
    Iteration,
    /// A table, loaded when n changes.
    Table,
}

parameters! {
    /// Shading method.
    pub struct ShadingConfig {
        /// Mode register (14): normal, brightness or polyhedron. Display lists and scenes can override it.
        mode: ShadingMode = ShadingMode::Normal, unit: "", Stated("process 13 writes the mode register (14)");
        /// Clamp of N.L below 0: vertex (at the sample points) or none.
        clamp: SumClamp = SumClamp::Vertex, unit: "", Assumed("a light behind the surface takes no light away; none makes the theorem hold exactly");
        /// True if interpolated normals are normalised before the inner product.
        renormalise: bool = false, unit: "", Stated("equations (12) to (14) take the weighted sum as it is");
        /// Work saved if the specular term is negligible: no_start (circuit (50) is not started) or gate (its output is blocked).
        specular_skip: SpecularSkip = SpecularSkip::NoStart, unit: "", Assumed("the patent's gate (51) blocks the output; only not starting saves cycles");
        /// True if flat polygons take the mean in brightness-interpolation mode too.
        flat_in_brightness_mode: bool = false, unit: "", Derived("in Figure 1 selector (53) lies before (28), which takes (21) in this mode; the text would allow it");
        /// Ambient intensity Ia. Display lists and scenes can override it.
        ia: f32 = 1.0, unit: "", Assumed("the coefficients carry the scale"), range: 0.0..=ShadingSettings::MAX_INTENSITY;
        /// Light intensity Is. It multiplies the intensity of every light. Display lists and scenes can override it.
        is: f32 = 1.0, unit: "", Assumed("the coefficients carry the scale"), range: 0.0..=ShadingSettings::MAX_INTENSITY;
    }
}

parameters! {
    /// Short cut 1: specular term negligible, specular register (18).
    pub struct SpecularNegligibleConfig {
        /// True if process 17 decides. False: the specular term always counts.
        enabled: bool = true, unit: "", Stated("process 17 writes the specular register (18)");
        /// Brightness below which the specular term is negligible. Full scale is 1.
        threshold: f32 = 1.0 / 510.0, unit: "", Assumed("half a step of 8 bits: no output changes by more than 1"), range: 0.0..=1.0;
    }
}

parameters! {
    /// Short cut 2: flat polygons, flatness register (16).
    pub struct FlatnessConfig {
        /// True if process 15 decides. False: no polygon is flat.
        enabled: bool = true, unit: "", Stated("process 15 writes the flatness register (16)");
        /// Largest distance of any normal from the first one in a flat polygon.
        tolerance: f32 = 1e-5, unit: "", Assumed("distance of unit vectors; far above rounding, and n = 200 makes 0.002 of it"), range: 0.0..=2.0;
    }
}

parameters! {
    /// Short cut 3: same plane as the previous flat polygon (Figure 7).
    pub struct SamePlaneConfig {
        /// True if step 92 decides. False: every flat polygon is calculated.
        enabled: bool = true, unit: "", Stated("Figure 7");
        /// Largest distance of any normal from the stored normal for the same plane.
        normal_tolerance: f32 = 1e-5, unit: "", Assumed("as shortcut.flatness.tolerance"), range: 0.0..=2.0;
        /// Largest difference of any point's depth from the stored plane for the same plane.
        constant_tolerance: f32 = 1e-4, unit: "depth", Assumed("depth 0..1 over the image; single-precision slopes of a polygon of some pixels, carried some hundred pixels on"), range: 0.0..=1.0;
    }
}

parameter_groups! {
    /// The three short cuts.
    pub struct ShortCutConfigs {
        /// Short cut for a negligible specular term.
        specular_negligible: SpecularNegligibleConfig = SpecularNegligibleConfig::default(),
        /// Short cut for flat polygons.
        flatness: FlatnessConfig = FlatnessConfig::default(),
        /// Short cut for polygons on the same plane as before.
        same_plane: SamePlaneConfig = SamePlaneConfig::default(),
    }
}

parameters! {
    /// Transfers from the host computer (100).
    pub struct HostConfig {
        /// Polygon buffers: 1 (a polygon is finished before the next is taken) or 2 (the next is taken during the current one).
        buffers: u32 = 1, unit: "polygons", Stated("the device finishes one polygon before it takes the next"), range: 1..=2;
        /// Bandwidth of the host bus.
        bytes_per_cycle: u32 = 4, unit: "bytes/cycle", Assumed("a bus of 32 bits"), range: 1..=1024;
        /// Size of a number on the bus.
        number_bytes: u32 = 4, unit: "bytes", Assumed("single precision"), range: 4..=8;
        /// Latency from the last byte to its use.
        latency: u32 = 2, unit: "cycles", Assumed("a register at either end"), range: 0..=65_536;
    }
}

parameters! {
    /// Scan of a polygon by the circuits and process 24.
    pub struct ScanConfig {
        /// Sub-pixel bits n: window coordinates are snapped to steps of 2^-n pixel.
        subpixel_bits: u32 = 8, unit: "bits", Assumed("as the bump-mapping processor's rasterizer"), range: 1..=10;
        /// Side of the square blocks in which a triangle is visited. 1: line by line.
        block: u32 = 4, unit: "pixels", Assumed("the block of the frame memory's layout, so that a line of it is finished before the next"), range: 1..=8;
        /// Width of depth values.
        z_bits: u32 = 24, unit: "bits", Assumed("as the bump-mapping processor's rasterizer"), range: 16..=32;
    }
}

parameters! {
    /// Brightness interpolation circuit (21).
    pub struct InterpolationConfig {
        /// Initiation interval of dots.
        initiation_interval: u32 = 1, unit: "cycles", Assumed("an interpolator for each component"), range: 1..=4096;
    }
}

parameters! {
    /// Normal-interpolation brightness circuit (50).
    pub struct NormalInterpolationConfig {
        /// Initiation interval of dots. A slow power unit can lengthen it.
        initiation_interval: u32 = 1, unit: "cycles", Assumed("inner product in a pipeline"), range: 1..=4096;
        /// Inner products per dot and light, with initiation_interval each: 1, or 2 to time full normal interpolation.
        inner_products: u32 = 1, unit: "", Derived("only N.H is left to circuit (50); full normal interpolation takes N.L as well, for terms that by the theorem are those of circuit (21), so the picture stays the same"), range: 1..=2;
        /// Method of the power: iteration or table.
        power: PowerMethod = PowerMethod::Iteration, unit: "", Assumed("the patent only says that the power is calculated");
        /// True if the iteration has separate multipliers for each step, so that it sustains initiation_interval.
        pipelined: bool = false, unit: "", Assumed("the smaller circuit");
        /// Entries of the table, evenly spaced over N.H = 0..1.
        table_entries: u32 = 1024, unit: "entries", Assumed("a step of the highlight at n = 200 is then at most 0.2"), range: 2..=65_536;
        /// Width of a table entry.
        table_bits: u32 = 12, unit: "bits", Assumed("four more than the output"), range: 1..=24;
    }
}

parameters! {
    /// Circuit without further parameters: gate (51), adder (52), selectors (53) and (28).
    pub struct CircuitConfig {
        /// Initiation interval of dots.
        initiation_interval: u32 = 1, unit: "cycles", Assumed("a dot per cycle"), range: 1..=4096;
        /// Latency of a dot. The adder (52) adds its addition to it.
        latency: u32 = 1, unit: "cycles", Assumed("a register"), range: 0..=4096;
    }
}
