//! Bit widths of tokens in hardware, which give the size of the FIFOs that hold them.
//!
//! Each token type lists its [fields](WireFields). Widths that depend on the configuration are in [`SignalWidths`].

mod control;
mod pixels;

pub use crate::wire_fields::NUMBER;
use crate::wire_fields::{BitWidth, SignalWidths, WireFields};
use crate::{Attribution, Control, Flow, PixelSet, Stamp};
pub use control::triangles;
use smallvec::{Array, SmallVec};
use std::sync::Arc;

/// Column or row of a picture \[bits\].
pub const COORDINATE: u32 = 16;
/// Colour of three components, 8 bits each \[bits\].
pub const COLOR: u32 = 24;
/// Level of detail of a polygon \[bits\].
const LOD: u32 = 6;
/// MIP level \[bits\].
pub const LEVEL: u32 = 3;
/// Share of a MIP level, in steps of the LOD \[bits\]. It has spare bits because several texels may have a share in the level.
pub const SHARE: u32 = 8;
/// Control token \[bits\]: its kind, and the number of its frame, object or polygon. Set-up registers of the units hold the data of
/// frames, objects and polygons. A FIFO of control tokens alone holds the data of polygons, too.
pub const CONTROL: u32 = 32;

/// A token without data: its arrival is the signal.
impl BitWidth for () {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        wire.flag("signal", token.map(|()| true));
    }
}

impl<T: BitWidth> BitWidth for Arc<T> {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        T::fields(token.map(|token| &**token), widths, wire);
    }

    fn attribution(&self) -> Attribution {
        T::attribution(self)
    }
}

impl BitWidth for f32 {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        wire.real("value", NUMBER, token.copied());
    }
}

/// Double precision exists on the host only. It represents numbers whose width is not specified.
impl BitWidth for f64 {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        wire.double("value", NUMBER, token.copied());
    }
}

/// Lists `count` parts by number, with the items that exist.
fn parts<'a, T: BitWidth + 'a>(count: u32, items: Option<&'a [T]>, widths: &SignalWidths, wire: &mut WireFields) {
    for i in 0..count as usize {
        wire.token(&i.to_string(), items.and_then(|items| items.get(i)), widths);
    }
}

impl<T: BitWidth, const N: usize> BitWidth for [T; N] {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        parts(N as u32, token.map(<[T; N]>::as_slice), widths, wire);
    }
}

/// All items side by side, and their count. A token with more items takes several cycles in the hardware; its wires show the first.
impl<A: Array<Item: BitWidth>> BitWidth for SmallVec<A> {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        let most = A::size() as u32;
        wire.number("count", count(most), token.map(|items| items.len().min(A::size()) as u64));
        parts(most, token.map(SmallVec::as_slice), widths, wire);
    }
}

/// One bit distinguishes control from items.
impl<T: BitWidth> BitWidth for Flow<T> {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        let (mut item, mut control) = (None, None);
        match token {
            Some(Self::Item(token)) => item = Some(token),
            Some(Self::Control(token)) => control = Some(token),
            None => {}
        }
        wire.flag("item", token.map(|_| item.is_some()));
        wire.one_of(&mut [&mut |wire| Control::fields(control, widths, wire), &mut |wire| T::fields(item, widths, wire)]);
    }

    fn attribution(&self) -> Attribution {
        match self {
            Self::Control(control) => control.attribution(),
            Self::Item(item) => item.attribution(),
        }
    }
}

/// Items and their count.
impl<T: BitWidth> BitWidth for Stamp<T> {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        wire.number("count", count(widths.stamp), token.map(|stamp| stamp.len() as u64));
        parts(widths.stamp, token.map(Stamp::as_slice), widths, wire);
    }

    /// Returns all pixels of the items.
    fn attribution(&self) -> Attribution {
        Attribution::Pixels(PixelSet::stamp(self.iter().filter_map(|item| match item.attribution() {
            Attribution::Pixels(pixel) => Some(pixel.first()),
            _ => None,
        })))
    }
}

/// Returns the bits of a counter from 0 to `most`.
pub fn count(most: u32) -> u32 {
    u32::BITS - most.leading_zeros()
}

/// Lists a position.
pub fn position(wire: &mut WireFields, at: Option<[u16; 2]>) {
    wire.number("x", COORDINATE, at.map(|[x, _]| x));
    wire.number("y", COORDINATE, at.map(|[_, y]| y));
}

/// Lists a colour.
fn color(wire: &mut WireFields, rgb: Option<[u8; 3]>) {
    wire.number("rgb", COLOR, rgb.map(|[r, g, b]| u32::from_le_bytes([r, g, b, 0])));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Fragment;
    use crate::fragment::{NormalIndexes, PseudoNormals};

    #[test]
    fn stamp_width_follows_lanes() {
        let one = SignalWidths { stamp: 1, ..SignalWidths::default() };
        assert_eq!(Fragment::bits(&one), 32 + 24 + 64 + 16);
        assert_eq!(Stamp::<Fragment>::bits(&one), Fragment::bits(&one) + 1);
        assert_eq!(Stamp::<Fragment>::bits(&SignalWidths::default()), 4 * Fragment::bits(&one) + 3);
    }

    #[test]
    fn finer_table_widens_only_indexes() {
        let (coarse, fine) =
            (SignalWidths { index: 4, ..SignalWidths::default() }, SignalWidths { index: 10, ..SignalWidths::default() });
        assert_eq!(NormalIndexes::bits(&fine) - NormalIndexes::bits(&coarse), 4 * 6);
        assert_eq!(PseudoNormals::bits(&fine), PseudoNormals::bits(&coarse));
    }

    #[test]
    fn control_sets_minimum_flow_width() {
        assert_eq!(Flow::<()>::bits(&SignalWidths::default()), 33);
    }
}
