//! Parameters of the rate-limited renderer (100).

use crate::encoding::TileEncoding;
use crate::page::TexelCentre;
use basrelief_parameters::parameters;
use basrelief_signals::WrapMode;
use serde::{Deserialize, Serialize};

/// How a picture comes about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RenderMode {
    /// Best resolution (461-465): least load in all.
    #[default]
    Best,
    /// Progressive (471-477): a first picture soonest, then better ones.
    Progressive,
    /// All textures at full resolution first: what the patent compares itself with.
    Conventional,
}

/// Which jobs the pixel/depth buffer (124) has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DepthPixel {
    /// One memory: first the depth buffer, later the pixel buffer.
    #[default]
    Shared,
    /// A memory for each.
    Separate,
}

/// What the brightness coefficients hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Lighting {
    /// Colour of the material times that of the vertices.
    #[default]
    None,
    /// That times the brightness at the vertices, interpolated.
    Gouraud,
}

/// Wrap modes, by texture or for all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WrapOverride {
    /// What the texture's own sampler says.
    #[default]
    Sampler,
    /// All textures repeat.
    Repeat,
    /// All textures repeat mirrored.
    Mirror,
    /// The edge texel extends.
    Clamp,
}

impl WrapOverride {
    /// Wrap modes of a texture whose own are these.
    pub fn of(self, own: [WrapMode; 2]) -> [WrapMode; 2] {
        match self {
            Self::Sampler => own,
            Self::Repeat => [WrapMode::Repeat; 2],
            Self::Mirror => [WrapMode::Mirror; 2],
            Self::Clamp => [WrapMode::Clamp; 2],
        }
    }
}

/// Format of a number in a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NumberFormat {
    /// Two's complement with a fixed point.
    Fixed,
    /// Sign, 8 bits of exponent, the rest fraction.
    #[default]
    Float,
}

/// In which order tiles are asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TileOrder {
    /// As Figure 6 lists them: page by page, from layer Dmax down.
    #[default]
    Listed,
    /// Tiles seen nearest to the centre of the screen first.
    Centre,
    /// Tiles that most pixels want first.
    Pixels,
}

parameters! {
    /// The rendering device (100).
    pub struct RendererConfig {
        /// How a picture comes about: best, progressive or conventional.
        mode: RenderMode = RenderMode::Best, unit: "", Stated("Figure 4: the mode of best resolution or the progressive one; conventional: the prior art of the text");
        /// Where texel centres lie: half, or integer as in the patent.
        texel_centre: TexelCentre = TexelCentre::Half, unit: "", Assumed("at integers, coarse layers are shifted by 0.5, 1.5, 3.5 ... finest texels");
        /// Cap on Dmax (133), the depth of the finest layer: textures of more texels are kept at a lower resolution.
        dmax: u8 = 31, unit: "layers", Stated("[0033]: where the original resolution is higher than the use needs, the highest one kept may be lower; 31 leaves nothing out"), range: 0..=31;
        /// Jobs of the memory (124): shared (depth, then pixels) or separate.
        depth_pixel: DepthPixel = DepthPixel::Shared, unit: "", Stated("[0067], [0076]");
        /// What the brightness coefficients hold: none (colours of material and vertices) or gouraud (times the brightness at the vertices).
        lighting: Lighting = Lighting::None, unit: "", Assumed("what is fetched is told by the pictures alone; gouraud is the patent's use");
        /// Wrap modes: sampler (the texture's own), or repeat, mirror, clamp for all.
        wrap: WrapOverride = WrapOverride::Sampler, unit: "", Assumed("the scene knows");
        /// The viewpoint is left after this many progressive pictures (475: user input); 0: never.
        pictures_per_view: u32 = 0, unit: "pictures", Assumed("the user looks until the picture is as good as it gets"), range: 0..=64;
        /// Where each viewpoint is left, from the first on: in place of which tile that it would ask for, counted in the viewpoint from 1.
        /// What has come by then is shown. 0, and beyond the list: not ahead of a tile.
        left_at_tile: Vec<u32> = Vec::new(), unit: "tiles", Assumed("the user looks until the picture is as good as it gets");
        /// When each viewpoint is left for the next (475), from the first on, rising, counted from the start; the next begins no sooner. Runs
        /// ahead of the run find in place of which tiles that is; they take the place of `left_at_tile`.
        left_at_ms: Vec<f64> = Vec::new(), unit: "ms", Assumed("the user looks until the picture is as good as it gets");
    }
}

parameters! {
    /// Tiles.
    pub struct TileConfig {
        /// Width; a power of two.
        width: u32 = 64, unit: "texels", Stated("[0031]: tiles of a x b texels, 64 x 64 in the example"), range: 4..=512;
        /// Height; a power of two.
        height: u32 = 64, unit: "texels", Stated("[0031]: tiles of a x b texels, 64 x 64 in the example"), range: 4..=512;
        /// Encoding on the path: raw, png or jpeg.
        encoding: TileEncoding = TileEncoding::Raw, unit: "", Stated("pattern data may travel compressed, JPEG in the text; raw compares bytes with texels");
        /// Quality of JPEG.
        jpeg_quality: u8 = 85, unit: "", Assumed("common"), range: 1..=100;
        /// Order in which tiles are asked for: listed, centre (nearest to the screen's centre first), pixels (most pixels first).
        order: TileOrder = TileOrder::Listed, unit: "", Stated("Figure 6");
        /// Texels that expansion gives per cycle; raw tiles need none.
        expand_rate: u32 = 1, unit: "texels/cycle", Assumed("an inverse cosine transform of one sample of each channel per cycle"), range: 1..=64;
    }
}

parameters! {
    /// The path (104, 106, 108).
    pub struct PathConfig {
        /// Rate.
        bits_per_second: u64 = 10_000_000, unit: "bit/s", Assumed("a local network of the patent's time; 56,000 is a modem"), range: 100_u64..=1_000_000_000_000;
        /// From a request to the first bit of its answer.
        latency_us: u64 = 1000, unit: "us", Assumed("a local network; a modem has 100,000"), range: 0_u64..=10_000_000;
        /// Requests in flight.
        requests: u32 = 8, unit: "requests", Assumed("as a browser keeps connections"), range: 1..=4096;
        /// Tiles that one request asks for, at most; they are of one picture.
        tiles_per_request: u32 = 1, unit: "tiles", Assumed("raw tiles of 64 x 64 texels are forty times the head of an answer"), range: 1..=64;
        /// What an answer has on the path beside its tiles. Requests travel the other way, where nothing waits for them.
        head_bytes: u32 = 0, unit: "bytes", Assumed("a network that carries tiles alone; HTTP between `run --from` and `serve` has 310, measured"), range: 0..=65536;
        /// What a number of a mesh (451) or of the command of a frame or an object takes on the path; 0: all of them are in the device.
        number_bytes: u32 = 4, unit: "bytes", Assumed("single precision; indices into up to 65,536 vertices take half of it"), range: 0..=16;
        /// What the size of one texture takes on the path (452).
        texture_size_bytes: u32 = 8, unit: "bytes", Assumed("two words"), range: 0..=1024;
    }
}

parameters! {
    /// Cell of the reference buffer (126), Figures 3A and 3B.
    pub struct CellConfig {
        /// Texture page pointer (310).
        page_bits: u32 = 11, unit: "bits", Assumed("2,048 pictures; the cell then has 128 bits"), range: 1..=15;
        /// Format of S and T (312): fixed or float.
        coordinate_format: NumberFormat = NumberFormat::Float, unit: "", Stated("[0092]: fixed or floating point");
        /// S and T (312), each.
        coordinate_bits: u32 = 32, unit: "bits", Assumed("single precision"), range: 12..=32;
        /// Bits behind the point of a fixed S and T.
        coordinate_fraction_bits: u32 = 8, unit: "bits", Assumed("as many as a bilinear weight needs for 8 bits of colour"), range: 0..=24;
        /// Format of D (314): fixed or float.
        depth_format: NumberFormat = NumberFormat::Fixed, unit: "", Stated("[0092]: fixed or floating point");
        /// D (314).
        depth_bits: u32 = 24, unit: "bits", Assumed("the cell then has 128 bits"), range: 10..=32;
        /// Bits behind the point of a fixed D.
        depth_fraction_bits: u32 = 18, unit: "bits", Assumed("sign and five bits in front are more than any texture needs"), range: 0..=24;
        /// Brightness coefficients IR, IG, IB (316), each; direct colours have 8 bits.
        brightness_bits: u32 = 8, unit: "bits", Assumed("as the colours of the picture"), range: 4..=16;
    }
}

/// Wrap modes of a cell: three, in u and in v \[bits\].
pub(crate) const WRAP_BITS: u32 = 2 * 2;

impl CellConfig {
    /// Bits of a cell: the larger of Figures 3A and 3B.
    pub fn bits(&self) -> u32 {
        let textured = self.page_bits + WRAP_BITS + 2 * self.coordinate_bits + self.depth_bits + 3 * self.brightness_bits;
        1 + textured.max(24)
    }
}

parameters! {
    /// Rates of the rendering engine (120).
    pub struct EngineConfig {
        /// From start to delivery of each of its units.
        latency: u32 = 8, unit: "cycles", Assumed("as the units of the other machines"), range: 0..=4096;
        /// Cells made per cycle by the initial rasterization (454).
        fill_rate: u32 = 1, unit: "cells/cycle", Assumed("one pixel per cycle; more than dividers let pass it is not"), range: 1..=16;
        /// Dividers for the footprint of a pixel, which take turns.
        dividers: u32 = 17, unit: "dividers", Derived("one that starts every 17 cycles (operators.divide) for each of 17: a cell per cycle"), range: 1..=1024;
        /// Multipliers, and as many adders, that set triangles up, beside one divider.
        setup_units: u32 = 4, unit: "operators", Assumed("as many as geometry processing has"), range: 1..=256;
        /// Cells read per cycle by a pass over the reference buffer (126).
        scan_rate: u32 = 1, unit: "cells/cycle", Assumed("one pixel per cycle"), range: 1..=16;
        /// Blocks of 4 x 4 cells of the reference buffer (126) that gather writes; the least recently written one goes.
        write_lines: u32 = 8, unit: "blocks", Assumed("2 KiB of registers; the edge that two triangles share lies in blocks that both write"), range: 1..=64;
        /// Entries of the tile load list (136) looked at per cycle.
        list_rate: u32 = 16, unit: "tiles/cycle", Assumed("two bits each: a word per cycle"), range: 1..=1024;
        /// Bilinear interpolations per cycle; one between two layers comes with the second.
        interpolation_rate: u32 = 1, unit: "interpolations/cycle", Assumed("one interpolator"), range: 1..=16;
        /// Texels averaged or stored per cycle.
        average_rate: u32 = 1, unit: "texels/cycle", Assumed("three adders of four terms"), range: 1..=64;
        /// Room for tiles in the texture-data memory (130).
        texture_memory: u64 = 1_073_741_824, unit: "bytes", Assumed("holds the pyramids of any scene here; exceeding it ends the run"), range: 4096_u64..=1_099_511_627_776;
    }
}
