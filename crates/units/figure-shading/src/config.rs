//! Parameters of the figure shading device (200).

use basrelief_parameters::{parameter_groups, parameters};
use basrelief_signals::{ShadingMode, ShadingSettings};
use serde::{Deserialize, Serialize};

/// Where N.L below 0 is cut off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Clamp {
    /// At the sample points.
    #[default]
    Vertex,
    /// Nowhere.
    None,
}

/// What is saved where the specular term is negligible.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SpecularSkip {
    /// Circuit (50) is not started.
    #[default]
    NoStart,
    /// Circuit (50) works, gate (51) holds its output back.
    Gate,
}

/// How circuit (50) raises to the power n.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PowerMethod {
    /// By repeated squaring and multiplication.
    #[default]
    Iteration,
    /// By a table, loaded when n changes.
    Table,
}

parameters! {
    /// What is shaded, and how.
    pub struct ShadingConfig {
        /// Mode register (14): normal, brightness or polyhedron; where a display list or a scene does not say.
        mode: ShadingMode = ShadingMode::Normal, unit: "", Stated("process 13 writes the mode register (14)");
        /// N.L below 0 is cut off: vertex (at the sample points) or none.
        clamp: Clamp = Clamp::Vertex, unit: "", Assumed("a light behind the surface takes no light away; none makes the theorem hold exactly");
        /// Interpolated normals are brought to length 1 before the inner product.
        renormalise: bool = false, unit: "", Stated("equations (12) to (14) take the weighted sum as it is");
        /// Where the specular term is negligible: no_start (circuit (50) is not started) or gate (its output is held back).
        specular_skip: SpecularSkip = SpecularSkip::NoStart, unit: "", Assumed("the patent's gate (51) blocks the output; only not starting saves cycles");
        /// Flat polygons take the mean in brightness-interpolation mode, too.
        flat_in_brightness_mode: bool = false, unit: "", Derived("in Figure 1 selector (53) lies before (28), which takes (21) in this mode; the text would allow it");
        /// Ambient intensity Ia, where a display list or a scene does not say.
        ia: f32 = 1.0, unit: "", Assumed("the coefficients carry the scale"), range: 0.0..=ShadingSettings::MAX_INTENSITY;
        /// Light intensity Is, where a display list or a scene does not say; multiplies the intensity of every light.
        is: f32 = 1.0, unit: "", Assumed("the coefficients carry the scale"), range: 0.0..=ShadingSettings::MAX_INTENSITY;
    }
}

parameters! {
    /// Short cut 1: specular term negligible, specular register (18).
    pub struct SpecularNegligibleConfig {
        /// Process 17 decides; off: the specular term always counts.
        enabled: bool = true, unit: "", Stated("process 17 writes the specular register (18)");
        /// Negligible below this brightness, full scale being 1.
        threshold: f32 = 1.0 / 510.0, unit: "", Assumed("half a step of 8 bits: no output changes by more than 1"), range: 0.0..=1.0;
    }
}

parameters! {
    /// Short cut 2: flat polygons, flatness register (16).
    pub struct FlatnessConfig {
        /// Process 15 decides; off: no polygon is flat.
        enabled: bool = true, unit: "", Stated("process 15 writes the flatness register (16)");
        /// A polygon is flat when no normal is farther than this from the first one.
        tolerance: f32 = 1e-5, unit: "", Assumed("distance of unit vectors; far above rounding, and n = 200 makes 0.002 of it"), range: 0.0..=2.0;
    }
}

parameters! {
    /// Short cut 3: same plane as the flat polygon before (Figure 7).
    pub struct SamePlaneConfig {
        /// Step 92 decides; off: every flat polygon is calculated.
        enabled: bool = true, unit: "", Stated("Figure 7");
        /// Same normal: no normal is farther than this from the stored one.
        normal_tolerance: f32 = 1e-5, unit: "", Assumed("as shortcut.flatness.tolerance"), range: 0.0..=2.0;
        /// Same plane constant: the depth of no point is farther than this from the stored plane.
        constant_tolerance: f32 = 1e-4, unit: "depth", Assumed("depth 0..1 over the picture; single-precision slopes of a polygon of some pixels, carried some hundred pixels on"), range: 0.0..=1.0;
    }
}

parameter_groups! {
    /// The three short cuts.
    pub struct ShortCutConfigs {
        /// Specular term negligible.
        specular_negligible: SpecularNegligibleConfig = SpecularNegligibleConfig::default(),
        /// Flat.
        flatness: FlatnessConfig = FlatnessConfig::default(),
        /// Same plane as before.
        same_plane: SamePlaneConfig = SamePlaneConfig::default(),
    }
}

parameters! {
    /// Transfers from the host computer (100).
    pub struct HostConfig {
        /// Polygon buffers: 1 (a polygon is finished before the next is taken) or 2 (the next is taken meanwhile).
        buffers: u32 = 1, unit: "polygons", Stated("the device finishes one polygon before it takes the next"), range: 1..=2;
        /// Bandwidth.
        bytes_per_cycle: u32 = 4, unit: "bytes/cycle", Assumed("a bus of 32 bits"), range: 1..=1024;
        /// A number on the bus.
        number_bytes: u32 = 4, unit: "bytes", Assumed("single precision"), range: 1..=8;
        /// From the last byte to its use.
        latency: u32 = 2, unit: "cycles", Assumed("a register at either end"), range: 0..=65_536;
    }
}

parameters! {
    /// How the circuits and process 24 scan a polygon.
    pub struct ScanConfig {
        /// Window coordinates are snapped to steps of 2^-n pixel.
        subpixel_bits: u32 = 8, unit: "bits", Assumed("as the bump-mapping processor's rasterizer"), range: 1..=10;
        /// Side of the square blocks in which a triangle is visited; 1: line by line.
        block: u32 = 4, unit: "pixels", Assumed("the block of the frame memory's layout, so that a line of it is finished before the next"), range: 1..=8;
        /// Depth values.
        z_bits: u32 = 24, unit: "bits", Assumed("as the bump-mapping processor's rasterizer"), range: 16..=32;
    }
}

parameters! {
    /// Brightness interpolation circuit (21).
    pub struct InterpolationConfig {
        /// A dot may start this often.
        initiation_interval: u32 = 1, unit: "cycles", Assumed("an interpolator for each component"), range: 1..=4096;
    }
}

parameters! {
    /// Normal-interpolation brightness circuit (50).
    pub struct NormalInterpolationConfig {
        /// A dot may start this often, as far as the power allows.
        initiation_interval: u32 = 1, unit: "cycles", Assumed("inner product in a pipeline"), range: 1..=4096;
        /// Inner products per dot and light, initiation_interval each: 1, or 2 to time full normal interpolation.
        inner_products: u32 = 1, unit: "", Derived("only N.H is left to circuit (50); full normal interpolation takes N.L as well, for terms that by the theorem are those of circuit (21), so the picture stays the same"), range: 1..=2;
        /// Power: iteration or table.
        power: PowerMethod = PowerMethod::Iteration, unit: "", Assumed("the patent only says that the power is calculated");
        /// The iteration has multipliers of its own for each step, and keeps up with initiation_interval.
        pipelined: bool = false, unit: "", Assumed("the smaller circuit");
        /// Entries of the table, evenly over N.H = 0..1.
        table_entries: u32 = 1024, unit: "entries", Assumed("a step of the highlight at n = 200 is then at most 0.2"), range: 2..=65_536;
        /// Width of an entry.
        table_bits: u32 = 12, unit: "bits", Assumed("four more than the output"), range: 1..=24;
    }
}

parameters! {
    /// A circuit without further parameters: gate (51), adder (52), selectors (53) and (28).
    pub struct CircuitConfig {
        /// A dot may start this often.
        initiation_interval: u32 = 1, unit: "cycles", Assumed("a dot per cycle"), range: 1..=4096;
        /// From start to delivery of a dot; in the adder (52) the addition comes on top.
        latency: u32 = 1, unit: "cycles", Assumed("a register"), range: 0..=4096;
    }
}
