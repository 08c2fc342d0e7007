//! What a token is about: which frame, object, polygon, pixels. Units do not ask; who watches a run does, and adds up what each costs.

/// Most pixels of [`Pixels`] that are no row.
const MOST: usize = 16;

/// What a token says that it is about. What it does not say, it has from the token that it was made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum About {
    /// Nothing of its own.
    #[default]
    Made,
    /// A frame begins.
    Frame {
        /// Its number, from 0.
        index: u32,
        /// Width and height \[pixels\].
        size: [u32; 2],
    },
    /// The frame as a whole: its end, or its picture.
    Whole,
    /// The object of this number begins.
    Object(u32),
    /// A polygon begins: where it lies in the host's memory, the same for all tokens of one polygon while any of them is under way.
    Polygon(u64),
    /// Pixels.
    Pixels(Pixels),
    /// The pixels of the token that it was made of, and the MIP level of each of the 16 of a packet, 4 bits each.
    Levels(u64),
}

/// How pixels lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    /// Up to four of a block of 4 x 4, in the order of the scan: in 4 bits each the number in the block, then how many.
    Stamp,
    /// Of 16 neighbours in a row those whose bit is set.
    Packet,
    /// Of a block of 4 x 4 those whose bit is set, 4 * row + column.
    Block,
    /// So many neighbours in a row.
    Row,
}

const SHAPES: [Shape; 4] = [Shape::Stamp, Shape::Packet, Shape::Block, Shape::Row];

/// Pixels of a picture, and what is looked up for each of a stamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pixels {
    shape: Shape,
    /// Column and row of the first.
    at: [u16; 2],
    bits: u32,
    /// MIP level by place in the stamp.
    pub levels: Option<[u8; 4]>,
    /// Index of the reference normal by place in the stamp.
    pub entries: Option<[u16; 4]>,
}

impl Pixels {
    /// A pixel.
    pub fn one(x: u16, y: u16) -> Self {
        Self::stamp([[x, y]])
    }

    /// Up to four pixels of one block of 4 x 4.
    pub fn stamp(pixels: impl IntoIterator<Item = [u16; 2]>) -> Self {
        let (mut at, mut lanes, mut count) = ([0; 2], 0, 0);
        for [x, y] in pixels.into_iter().take(4) {
            at = [x & !3, y & !3];
            lanes |= u32::from((y & 3) << 2 | x & 3) << (4 * count);
            count += 1;
        }
        Self { bits: count << 16 | lanes, ..Self::new(Shape::Stamp, at) }
    }

    /// Of 16 neighbours in a row, from this column and row on, those whose bit is set.
    pub fn packet(at: [u16; 2], mask: u16) -> Self {
        Self { bits: mask.into(), ..Self::new(Shape::Packet, at) }
    }

    /// Of this block of 4 x 4 pixels those whose bit is set, 4 * row + column.
    pub fn block([x, y]: [u16; 2], mask: u16) -> Self {
        Self { bits: mask.into(), ..Self::new(Shape::Block, [4 * x, 4 * y]) }
    }

    /// So many neighbours in a row, from this column and row on.
    pub fn row(at: [u16; 2], count: u16) -> Self {
        Self { bits: count.into(), ..Self::new(Shape::Row, at) }
    }

    fn new(shape: Shape, at: [u16; 2]) -> Self {
        Self { shape, at, bits: 0, levels: None, entries: None }
    }

    /// The first pixel of a stamp.
    pub fn first(&self) -> [u16; 2] {
        self.places().next().map_or(self.at, |(_, pixel)| pixel)
    }

    /// How many.
    pub fn count(&self) -> usize {
        match self.shape {
            Shape::Stamp => (self.bits >> 16) as usize,
            Shape::Packet | Shape::Block => self.bits.count_ones() as usize,
            Shape::Row => self.bits as usize,
        }
    }

    /// Each with its place in the token, from 0: in the stamp, in the packet, in the block, in the row.
    pub fn places(&self) -> impl Iterator<Item = (usize, [u16; 2])> + use<> {
        let Self { shape, at: [x, y], bits, .. } = *self;
        let places = match shape {
            Shape::Stamp => bits >> 16,
            Shape::Packet | Shape::Block => MOST as u32,
            Shape::Row => bits,
        };
        let in_block = move |n: u16| [x.saturating_add(n & 3), y.saturating_add(n >> 2)];
        (0..places as u16).filter_map(move |n| match shape {
            Shape::Stamp => Some((usize::from(n), in_block((bits >> (4 * n) & 15) as u16))),
            Shape::Packet | Shape::Block if bits >> n & 1 == 0 => None,
            Shape::Block => Some((usize::from(n), in_block(n))),
            Shape::Packet | Shape::Row => Some((usize::from(n), [x.saturating_add(n), y])),
        })
    }

    fn words(&self) -> Words {
        let Self { shape, at: [x, y], bits, levels, entries } = *self;
        let flags = u64::from(levels.is_some()) << 12 | u64::from(entries.is_some()) << 13;
        let level_bits: u64 = (0..).zip(levels.unwrap_or_default()).map(|(i, level)| u64::from(level & 15) << (4 * i)).sum();
        let entry_bits: u64 = (0..).zip(entries.unwrap_or_default()).map(|(i, entry)| u64::from(entry) << (16 * i)).sum();
        let first = PIXELS | (shape as u64) << 8 | flags | u64::from(x) << 16 | u64::from(y) << 32;
        [first, u64::from(bits) | level_bits << 32, entry_bits]
    }

    fn from_words([first, second, third]: Words) -> Self {
        let levels = (first >> 12 & 1 == 1).then(|| std::array::from_fn(|i| (second >> (32 + 4 * i) & 15) as u8));
        let entries = (first >> 13 & 1 == 1).then(|| std::array::from_fn(|i| (third >> (16 * i)) as u16));
        let shape = SHAPES[(first >> 8) as usize % SHAPES.len()];
        Self { shape, at: [(first >> 16) as u16, (first >> 32) as u16], bits: second as u32, levels, entries }
    }
}

/// What a token is about in three numbers: small enough to be told with every step.
type Words = [u64; 3];

// Kinds, in the lowest byte.
const FRAME: u64 = 1;
const WHOLE: u64 = 2;
const OBJECT: u64 = 3;
const POLYGON: u64 = 4;
const PIXELS: u64 = 5;
const LEVELS: u64 = 6;

impl From<About> for Words {
    fn from(about: About) -> Self {
        match about {
            About::Made => [0; 3],
            About::Frame { index, size: [width, height] } => [FRAME, u64::from(width) | u64::from(height) << 32, index.into()],
            About::Whole => [WHOLE, 0, 0],
            About::Object(id) => [OBJECT, id.into(), 0],
            About::Polygon(place) => [POLYGON, place, 0],
            About::Pixels(pixels) => pixels.words(),
            About::Levels(levels) => [LEVELS, levels, 0],
        }
    }
}

impl From<Words> for About {
    fn from(words: Words) -> Self {
        let [first, second, third] = words;
        match first & 255 {
            FRAME => Self::Frame { index: third as u32, size: [second as u32, (second >> 32) as u32] },
            WHOLE => Self::Whole,
            OBJECT => Self::Object(second as u32),
            POLYGON => Self::Polygon(second),
            PIXELS => Self::Pixels(Pixels::from_words(words)),
            LEVELS => Self::Levels(second),
            _ => Self::Made,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_come_in_the_order_of_their_places() {
        let pixels = |pixels: Pixels| pixels.places().collect::<Vec<_>>();
        let stamp = Pixels::stamp([[9, 6], [8, 6], [11, 7]]);
        assert_eq!(pixels(stamp), [(0, [9, 6]), (1, [8, 6]), (2, [11, 7])]);
        assert_eq!(pixels(Pixels::packet([16, 3], 0b1000_0000_0000_0101)), [(0, [16, 3]), (2, [18, 3]), (15, [31, 3])]);
        assert_eq!(pixels(Pixels::block([2, 1], 0b1_0010)), [(1, [9, 4]), (4, [8, 5])]);
        assert_eq!(pixels(Pixels::row([7, 2], 3)), [(0, [7, 2]), (1, [8, 2]), (2, [9, 2])]);
        for some in [stamp, Pixels::packet([16, 3], 77), Pixels::block([2, 1], 900), Pixels::row([7, 2], 300)] {
            assert_eq!(some.places().count(), some.count());
        }
        assert_eq!(stamp.first(), [9, 6]);
    }

    #[test]
    fn what_a_token_is_about_goes_through_three_numbers_and_back() {
        let corner = Pixels::stamp([[u16::MAX, u16::MAX], [u16::MAX - 3, u16::MAX - 3]]);
        let all = [
            About::Made,
            About::Frame { index: u32::MAX, size: [640, u32::MAX] },
            About::Whole,
            About::Object(u32::MAX),
            About::Polygon(u64::MAX),
            About::Pixels(corner),
            About::Pixels(Pixels { levels: Some([0, 7, 15, 3]), entries: Some([0, u16::MAX, 1, 256]), ..corner }),
            About::Pixels(Pixels { levels: Some([1; 4]), ..Pixels::one(3, 4) }),
            About::Pixels(Pixels::row([u16::MAX, 5], u16::MAX)),
            About::Levels(u64::MAX),
        ];
        for about in all {
            assert_eq!(About::from(Words::from(about)), about);
        }
    }
}
