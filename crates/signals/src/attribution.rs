//! Attribution of tokens: the frame, object, polygon or pixels that a token belongs to. Units never read it. Observers of a run
//! use it to sum the cost per object and polygon.

/// Maximum number of pixels of a [`PixelSet`] value of any shape but a row.
const MAX_NON_ROW_PIXELS: usize = 16;

/// Attribution of a token. A token without an attribution of its own inherits that of the token from which it was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Attribution {
    /// The token inherits its attribution.
    #[default]
    Inherited,
    /// A frame begins.
    Frame {
        /// Frame number, counted from 0.
        index: u32,
        /// Width and height \[pixels\].
        size: [u32; 2],
    },
    /// The token concerns the whole frame: its end or its picture.
    Whole,
    /// The object of this number begins.
    Object(u32),
    /// A polygon begins. The number is its address in the host's memory, which all live tokens of one polygon share.
    Polygon(u64),
    /// The token carries these pixels.
    Pixels(PixelSet),
    /// The token has the pixels of its source token. The word holds the MIP level of each of the 16 pixels of a packet, 4 bits
    /// each.
    Levels(u64),
}

/// Arrangement of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PixelShape {
    /// Up to four pixels of a block of 4 x 4, in scan order. The bits hold a 4-bit number in the block per pixel, then the pixel
    /// count.
    Stamp,
    /// Pixels of 16 neighbours in a row. A set bit selects a pixel.
    Packet,
    /// Pixels of a block of 4 x 4. Bit 4 * row + column selects a pixel.
    Block,
    /// Neighbours in a row. The bits hold their count.
    Row,
}

const PIXEL_SHAPES: [PixelShape; 4] = [PixelShape::Stamp, PixelShape::Packet, PixelShape::Block, PixelShape::Row];

/// Pixels of a picture. Those of a stamp also carry the results of look-ups.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelSet {
    shape: PixelShape,
    /// Column and row of the first pixel.
    at: [u16; 2],
    bits: u32,
    /// MIP level of each pixel of the stamp.
    pub levels: Option<[u8; 4]>,
    /// Index of the reference normal of each pixel of the stamp.
    pub entries: Option<[u16; 4]>,
}

impl PixelSet {
    /// Creates a set of one pixel.
    pub fn one(x: u16, y: u16) -> Self {
        Self::stamp([[x, y]])
    }

    /// Creates a stamp of up to four pixels of one block of 4 x 4.
    pub fn stamp(pixels: impl IntoIterator<Item = [u16; 2]>) -> Self {
        let (mut at, mut lanes, mut count) = ([0; 2], 0, 0);
        for [x, y] in pixels.into_iter().take(4) {
            at = [x & !3, y & !3];
            lanes |= u32::from((y & 3) << 2 | x & 3) << (4 * count);
            count += 1;
        }
        Self { bits: count << 16 | lanes, ..Self::new(PixelShape::Stamp, at) }
    }

    /// Creates a packet: of the 16 neighbours in a row that start at this column and row, the pixels whose bits are set.
    pub fn packet(at: [u16; 2], mask: u16) -> Self {
        Self { bits: mask.into(), ..Self::new(PixelShape::Packet, at) }
    }

    /// Creates a block of 4 x 4 pixels. Bit 4 * row + column of the mask selects a pixel.
    pub fn block([x, y]: [u16; 2], mask: u16) -> Self {
        Self { bits: mask.into(), ..Self::new(PixelShape::Block, [4 * x, 4 * y]) }
    }

    /// Creates a row of `count` neighbours that starts at this column and row.
    pub fn row(at: [u16; 2], count: u16) -> Self {
        Self { bits: count.into(), ..Self::new(PixelShape::Row, at) }
    }

    fn new(shape: PixelShape, at: [u16; 2]) -> Self {
        Self { shape, at, bits: 0, levels: None, entries: None }
    }

    /// Returns the first pixel of a stamp.
    pub fn first(&self) -> [u16; 2] {
        self.places().next().map_or(self.at, |(_, pixel)| pixel)
    }

    /// Returns the number of pixels.
    pub fn count(&self) -> usize {
        match self.shape {
            PixelShape::Stamp => (self.bits >> 16) as usize,
            PixelShape::Packet | PixelShape::Block => self.bits.count_ones() as usize,
            PixelShape::Row => self.bits as usize,
        }
    }

    /// Returns each pixel with its position, counted from 0, in the stamp, packet, block or row.
    pub fn places(&self) -> impl Iterator<Item = (usize, [u16; 2])> + use<> {
        let Self { shape, at: [x, y], bits, .. } = *self;
        let places = match shape {
            PixelShape::Stamp => bits >> 16,
            PixelShape::Packet | PixelShape::Block => MAX_NON_ROW_PIXELS as u32,
            PixelShape::Row => bits,
        };
        let in_block = move |n: u16| [x.saturating_add(n & 3), y.saturating_add(n >> 2)];
        (0..places as u16).filter_map(move |n| match shape {
            PixelShape::Stamp => Some((usize::from(n), in_block((bits >> (4 * n) & 15) as u16))),
            PixelShape::Packet | PixelShape::Block if bits >> n & 1 == 0 => None,
            PixelShape::Block => Some((usize::from(n), in_block(n))),
            PixelShape::Packet | PixelShape::Row => Some((usize::from(n), [x.saturating_add(n), y])),
        })
    }

    fn words(&self) -> AttributionWords {
        let Self { shape, at: [x, y], bits, levels, entries } = *self;
        let flags = u64::from(levels.is_some()) << 12 | u64::from(entries.is_some()) << 13;
        let level_bits: u64 = (0..).zip(levels.unwrap_or_default()).map(|(i, level)| u64::from(level & 15) << (4 * i)).sum();
        let entry_bits: u64 = (0..).zip(entries.unwrap_or_default()).map(|(i, entry)| u64::from(entry) << (16 * i)).sum();
        let first = PIXELS | (shape as u64) << 8 | flags | u64::from(x) << 16 | u64::from(y) << 32;
        [first, u64::from(bits) | level_bits << 32, entry_bits]
    }

    fn from_words([first, second, third]: AttributionWords) -> Self {
        let levels = (first >> 12 & 1 == 1).then(|| std::array::from_fn(|i| (second >> (32 + 4 * i) & 15) as u8));
        let entries = (first >> 13 & 1 == 1).then(|| std::array::from_fn(|i| (third >> (16 * i)) as u16));
        let shape = PIXEL_SHAPES[(first >> 8) as usize % PIXEL_SHAPES.len()];
        Self { shape, at: [(first >> 16) as u16, (first >> 32) as u16], bits: second as u32, levels, entries }
    }
}

/// Encoded attribution. Three numbers are small enough to be reported with every step.
type AttributionWords = [u64; 3];

// Kinds of attribution, stored in the lowest byte.
const FRAME: u64 = 1;
const WHOLE: u64 = 2;
const OBJECT: u64 = 3;
const POLYGON: u64 = 4;
const PIXELS: u64 = 5;
const LEVELS: u64 = 6;

impl From<Attribution> for AttributionWords {
    fn from(attribution: Attribution) -> Self {
        match attribution {
            Attribution::Inherited => [0; 3],
            Attribution::Frame { index, size: [width, height] } => {
                [FRAME, u64::from(width) | u64::from(height) << 32, index.into()]
            }
            Attribution::Whole => [WHOLE, 0, 0],
            Attribution::Object(id) => [OBJECT, id.into(), 0],
            Attribution::Polygon(place) => [POLYGON, place, 0],
            Attribution::Pixels(pixels) => pixels.words(),
            Attribution::Levels(levels) => [LEVELS, levels, 0],
        }
    }
}

impl From<AttributionWords> for Attribution {
    fn from(words: AttributionWords) -> Self {
        let [first, second, third] = words;
        match first & 255 {
            FRAME => Self::Frame { index: third as u32, size: [second as u32, (second >> 32) as u32] },
            WHOLE => Self::Whole,
            OBJECT => Self::Object(second as u32),
            POLYGON => Self::Polygon(second),
            PIXELS => Self::Pixels(PixelSet::from_words(words)),
            LEVELS => Self::Levels(second),
            _ => Self::Inherited,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_follow_position_order() {
        let pixels = |pixels: PixelSet| pixels.places().collect::<Vec<_>>();
        let stamp = PixelSet::stamp([[9, 6], [8, 6], [11, 7]]);
        assert_eq!(pixels(stamp), [(0, [9, 6]), (1, [8, 6]), (2, [11, 7])]);
        assert_eq!(pixels(PixelSet::packet([16, 3], 0b1000_0000_0000_0101)), [(0, [16, 3]), (2, [18, 3]), (15, [31, 3])]);
        assert_eq!(pixels(PixelSet::block([2, 1], 0b1_0010)), [(1, [9, 4]), (4, [8, 5])]);
        assert_eq!(pixels(PixelSet::row([7, 2], 3)), [(0, [7, 2]), (1, [8, 2]), (2, [9, 2])]);
        for some in [stamp, PixelSet::packet([16, 3], 77), PixelSet::block([2, 1], 900), PixelSet::row([7, 2], 300)] {
            assert_eq!(some.places().count(), some.count());
        }
        assert_eq!(stamp.first(), [9, 6]);
    }

    #[test]
    fn attribution_survives_encoding() {
        let corner = PixelSet::stamp([[u16::MAX, u16::MAX], [u16::MAX - 3, u16::MAX - 3]]);
        let all = [
            Attribution::Inherited,
            Attribution::Frame { index: u32::MAX, size: [640, u32::MAX] },
            Attribution::Whole,
            Attribution::Object(u32::MAX),
            Attribution::Polygon(u64::MAX),
            Attribution::Pixels(corner),
            Attribution::Pixels(PixelSet { levels: Some([0, 7, 15, 3]), entries: Some([0, u16::MAX, 1, 256]), ..corner }),
            Attribution::Pixels(PixelSet { levels: Some([1; 4]), ..PixelSet::one(3, 4) }),
            Attribution::Pixels(PixelSet::row([u16::MAX, 5], u16::MAX)),
            Attribution::Levels(u64::MAX),
        ];
        for attribution in all {
            assert_eq!(Attribution::from(AttributionWords::from(attribution)), attribution);
        }
    }
}
