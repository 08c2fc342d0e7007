//! Parameters of the rate-limited renderer (100).

use crate::encoding::{TileEncoding, TileFormat};
use crate::page::TexelCentre;
use basrelief_parameters::parameters;
use basrelief_signals::WrapMode;
use serde::{Deserialize, Serialize};

/// Order of loading and drawing a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RenderMode {
    /// Best resolution (461-465): smallest total load.
    #[default]
    Best,
    /// Progressive (471-477): a first picture as early as possible, then better ones.
    Progressive,
    /// All textures at full resolution first: the prior art of the patent.
    Conventional,
}

/// Functions of the pixel/depth buffer (124).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DepthPixel {
    /// One memory: first the depth buffer, later the pixel buffer.
    #[default]
    Shared,
    /// Separate memories.
    Separate,
}

/// Contents of the brightness coefficients.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LightingMode {
    /// Colour of the material times that of the vertices.
    #[default]
    None,
    /// Colours times the brightness at the vertices, interpolated.
    Gouraud,
}

/// Wrap modes, by texture or for all textures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WrapOverride {
    /// The modes of the texture's own sampler.
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
    /// Returns the wrap modes of a texture whose own modes are `own`.
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

/// Order in which tiles are requested.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TileOrder {
    /// As listed in Figure 6: page by page, from layer Dmax down.
    #[default]
    Listed,
    /// Tiles nearest to the centre of the screen first.
    Centre,
    /// Tiles that most pixels need first.
    Pixels,
}

parameters! {
    /// The rendering device (100).
    pub struct RendererConfig {
        /// Order of loading and drawing: best, progressive or conventional.
        mode: RenderMode = RenderMode::Best, unit: "", Stated("Figure 4: the mode of best resolution or the progressive one; conventional: the prior art of the text");
        /// Position of texel centres: half, or integer as in the patent.
        texel_centre: TexelCentre = TexelCentre::Half, unit: "", Assumed("at integers, coarse layers are shifted by 0.5, 1.5, 3.5 ... finest texels");
        /// Largest Dmax (133), the depth of the finest layer. Larger textures are kept at a lower resolution.
        dmax: u8 = 31, unit: "layers", Stated("[0033]: where the original resolution is higher than the use needs, the highest one kept may be lower; 31 leaves nothing out"), range: 0..=31;
        /// Functions of the memory (124): shared (depth, then pixels) or separate.
        depth_pixel: DepthPixel = DepthPixel::Shared, unit: "", Stated("[0067], [0076]");
        /// Contents of the brightness coefficients: none (colours of material and vertices) or gouraud (times the brightness at
        /// the vertices).
        lighting: LightingMode = LightingMode::None, unit: "", Assumed("brightness does not change the loaded tiles; gouraud is the patent's use");
        /// Wrap modes: sampler (the texture's own), or repeat, mirror, clamp for all.
        wrap: WrapOverride = WrapOverride::Sampler, unit: "", Assumed("the scene knows");
        /// Progressive pictures after which the viewpoint changes (475: user input). 0: never.
        pictures_per_view: u32 = 0, unit: "pictures", Assumed("the user looks until the picture is as good as it gets"), range: 0..=64;
        /// Tile at which each viewpoint ends, from the first on: the request of this number, counted in the viewpoint from 1, is
        /// not made. The picture shows the tiles loaded so far. 0, or no entry: no such end.
        left_at_tile: Vec<u32> = Vec::new(), unit: "tiles", Assumed("the user looks until the picture is as good as it gets");
        /// Time at which each viewpoint ends (475), from the first on, rising, counted from the start. The next begins no sooner.
        /// Preliminary runs find the matching tile numbers, which replace `left_at_tile`.
        left_at_ms: Vec<f64> = Vec::new(), unit: "ms", Assumed("the user looks until the picture is as good as it gets");
    }
}

parameters! {
    /// Tiles.
    pub struct TileConfig {
        /// Tile width, a power of two.
        width: u32 = 64, unit: "texels", Stated("[0031]: tiles of a x b texels, 64 x 64 in the example"), range: 4..=512;
        /// Tile height, a power of two.
        height: u32 = 64, unit: "texels", Stated("[0031]: tiles of a x b texels, 64 x 64 in the example"), range: 4..=512;
        /// Encoding on the path: raw, png or jpeg.
        encoding: TileEncoding = TileEncoding::Raw, unit: "", Stated("pattern data may travel compressed, JPEG in the text; raw compares bytes with texels");
        /// JPEG quality.
        jpeg_quality: u8 = 85, unit: "", Assumed("common"), range: 1..=100;
        /// Order in which tiles are requested: listed, centre (nearest to the screen's centre first), pixels (most pixels first).
        order: TileOrder = TileOrder::Listed, unit: "", Stated("Figure 6");
        /// Texels that expansion outputs per cycle. Raw tiles need none.
        expand_rate: u32 = 1, unit: "texels/cycle", Assumed("an inverse cosine transform of one sample of each channel per cycle"), range: 1..=64;
    }
}

impl TileConfig {
    /// Returns size and encoding of the tiles.
    pub fn format(&self) -> TileFormat {
        TileFormat { size: [self.width, self.height], encoding: self.encoding, quality: self.jpeg_quality }
    }
}

impl Default for TileFormat {
    /// Returns the format that the device fetches by default.
    fn default() -> Self {
        TileConfig::default().format()
    }
}

parameters! {
    /// The path (104, 106, 108).
    pub struct PathConfig {
        /// Bit rate of the path.
        bits_per_second: u64 = 10_000_000, unit: "bit/s", Assumed("a local network of the patent's time; 56,000 is a modem"), range: 100_u64..=1_000_000_000_000;
        /// Latency from a request to the first bit of its answer.
        latency_us: u64 = 1000, unit: "us", Assumed("a local network; a modem has 100,000"), range: 0_u64..=10_000_000;
        /// Requests in flight.
        requests: u32 = 8, unit: "requests", Assumed("as a browser keeps connections"), range: 1..=4096;
        /// Most tiles per request, all of one picture.
        tiles_per_request: u32 = 1, unit: "tiles", Assumed("raw tiles of 64 x 64 texels are forty times the head of an answer"), range: 1..=64;
        /// Bytes of an answer besides its tiles. Requests use the other direction, which is never a bottleneck.
        head_bytes: u32 = 0, unit: "bytes", Assumed("a network that carries tiles alone; HTTP between `run --from` and `serve` has 310, measured"), range: 0..=65536;
        /// Size of a number of a mesh (451) or of a frame or object command on the path. 0: the device already has all meshes and
        /// commands.
        number_bytes: u32 = 4, unit: "bytes", Assumed("single precision; indices into up to 65,536 vertices take half of it"), range: 0..=16;
        /// Size of one texture's dimensions on the path (452).
        texture_size_bytes: u32 = 8, unit: "bytes", Assumed("two words; two sides of 15 bits take 4 bytes"), range: 4..=1024;
    }
}

parameters! {
    /// Cell of the reference buffer (126), Figures 3A and 3B.
    pub struct CellConfig {
        /// Texture page pointer (310).
        page_bits: u32 = 11, unit: "bits", Assumed("2,048 textures; the cell then has 128 bits"), range: 1..=15;
        /// Format of S and T (312): fixed or float.
        coordinate_format: NumberFormat = NumberFormat::Float, unit: "", Stated("[0092]: fixed or floating point");
        /// Width of S and of T (312).
        coordinate_bits: u32 = 32, unit: "bits", Assumed("single precision"), range: 12..=32;
        /// Fraction bits of a fixed S and T.
        coordinate_fraction_bits: u32 = 8, unit: "bits", Assumed("as many as a bilinear weight needs for 8 bits of colour"), range: 0..=24;
        /// Format of D (314): fixed or float.
        depth_format: NumberFormat = NumberFormat::Fixed, unit: "", Stated("[0092]: fixed or floating point");
        /// Width of D (314).
        depth_bits: u32 = 24, unit: "bits", Assumed("the cell then has 128 bits"), range: 10..=32;
        /// Fraction bits of a fixed D.
        depth_fraction_bits: u32 = 18, unit: "bits", Assumed("sign and five bits in front are more than any texture needs"), range: 0..=24;
        /// Width of each brightness coefficient IR, IG, IB (316). Direct colours have 8 bits.
        brightness_bits: u32 = 8, unit: "bits", Assumed("as the colours of the image"), range: 4..=16;
    }
}

/// Width of the wrap modes of a cell: three modes, in u and in v \[bits\].
pub(crate) const WRAP_BITS: u32 = 2 * 2;

impl CellConfig {
    /// Returns the bits of a cell: the larger of Figures 3A and 3B. A bit of the padding (306) of a direct colour distinguishes it from
    /// an empty cell.
    pub fn bits(&self) -> u32 {
        let textured = self.page_bits + WRAP_BITS + 2 * self.coordinate_bits + self.depth_bits + 3 * self.brightness_bits;
        1 + textured.max(1 + 24)
    }
}

parameters! {
    /// Rates of the rendering engine (120).
    pub struct EngineConfig {
        /// Latency of each of its units.
        latency: u32 = 8, unit: "cycles", Assumed("as the units of the other machines"), range: 0..=4096;
        /// Part of the latency of the final rasterization that needs the texels.
        filter_latency: u32 = 6, unit: "cycles", Derived("Figure 7A: means in s, in t and between layers, and the product with the brightness; addressing takes the other two"), range: 0..=4096;
        /// Most cells per cycle from the initial rasterization (454). Dividers may limit it further.
        fill_rate: u32 = 1, unit: "cells/cycle", Assumed("one pixel per cycle; more than dividers let pass it is not"), range: 1..=16;
        /// Dividers for the footprint of a pixel, which take turns.
        dividers: u32 = 17, unit: "dividers", Derived("one that starts every 17 cycles (operators.divide) for each of 17: a cell per cycle"), range: 1..=1024;
        /// Multipliers, and as many adders, that set up triangles, besides one divider.
        setup_units: u32 = 4, unit: "operators", Assumed("as many as geometry processing has"), range: 1..=256;
        /// Cells read per cycle by a pass over the reference buffer (126).
        scan_rate: u32 = 1, unit: "cells/cycle", Assumed("one pixel per cycle"), range: 1..=16;
        /// Blocks of 4 x 4 cells of the reference buffer (126) that gather writes. The least recently written one is evicted.
        write_lines: u32 = 8, unit: "blocks", Assumed("2 KiB of registers; the edge that two triangles share lies in blocks that both write"), range: 1..=64;
        /// True if each block has a flag for "not written in this frame". A pass does not read a flagged block. False: the beginning of
        /// the frame clears all blocks by writes.
        clear_flags: bool = true, unit: "", Assumed("as the z-test: a fast clear that moves no data has to be kept somewhere, a bit per block");
        /// Number of flags. The beginning of the frame clears the blocks of a larger image beyond the last flag.
        flags: u32 = 131_072, unit: "bits", Assumed("as the z-test: images of 2 million pixels"), range: 1..=16_777_216;
        /// Flags that are set in a cycle.
        flags_per_cycle: u32 = 64, unit: "bits", Assumed("a word of the memory of the flags"), range: 1..=65_536;
        /// Entries of the tile load list (136) tested or reset per cycle.
        list_rate: u32 = 16, unit: "tiles/cycle", Assumed("two bits each: a word per cycle"), range: 1..=1024;
        /// Bilinear interpolations per cycle. An interpolation between two layers comes with the second.
        interpolation_rate: u32 = 1, unit: "interpolations/cycle", Assumed("one interpolator"), range: 1..=16;
        /// Texels averaged or stored per cycle.
        average_rate: u32 = 1, unit: "texels/cycle", Assumed("three adders of four terms"), range: 1..=64;
        /// Memory for tiles in the texture-data memory (130).
        texture_memory: u64 = 1_073_741_824, unit: "bytes", Assumed("holds the pyramids of any scene here; exceeding it ends the run"), range: 4096_u64..=1_099_511_627_776;
    }
}
