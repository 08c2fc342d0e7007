//! Fields of tokens on wires: the only place that states the order and the width of each field.
//!
//! [`BitWidth::fields`] lists the fields of a token type. From that list follow the width of FIFOs, the bits of
//! recorded tokens, and the field offsets for SystemVerilog and C++ (see `docs/guide/rtl.md`).

use crate::Attribution;

/// Single-precision number \[bits\].
pub const NUMBER: u32 = 32;

/// Bit widths that a machine's configuration decides, and the number of items that travel side by side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SignalWidths {
    /// Depth value \[bits\].
    pub depth: u32,
    /// Fragments per [`Stamp`](crate::Stamp).
    pub stamp: u32,
    /// Samples per fragment.
    pub samples: u32,
    /// Component of a pseudo-normal N' \[bits\].
    pub normal: u32,
    /// Index of a reference normal \[bits\].
    pub index: u32,
    /// All brightness values of a fragment \[bits\].
    pub brightness: u32,
    /// Texture coordinate \[bits\].
    pub texture: u32,
    /// Data of a polygon beside its number, in a FIFO of polygons \[bits\].
    pub polygon: u32,
}

impl Default for SignalWidths {
    fn default() -> Self {
        Self { depth: 24, stamp: 4, samples: 1, normal: 16, index: 8, brightness: 8, texture: NUMBER, polygon: 0 }
    }
}

/// A token type with fields on a wire and an attribution.
pub trait BitWidth {
    /// Lists the fields of the token, with its values if there is a token.
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields);
    /// Returns the width of the token in the hardware \[bits\].
    fn bits(widths: &SignalWidths) -> u32 {
        WireFields::width::<Self>(widths).hardware
    }
    /// Returns the attribution of the token.
    fn attribution(&self) -> Attribution {
        Attribution::Inherited
    }
}

/// A field of a token on recorded wires.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WireField {
    /// Name, with an underscore between its parts, for example `stamp_0_x`.
    pub name: String,
    /// Number of its lowest bit.
    pub first: u32,
    /// Width on recorded wires \[bits\].
    pub bits: u32,
}

/// Width of a field \[bits\]: in the hardware, and on recorded wires. They differ if the model has more bits than the hardware (numbers
/// that it keeps in floating point), or if set-up registers of the units hold the value in the hardware.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FieldWidth {
    /// In the hardware.
    pub hardware: u32,
    /// On recorded wires.
    pub recorded: u32,
}

/// Visitor of the fields of a token, from bit 0 on.
#[derive(Debug, Default)]
pub struct WireFields {
    at: FieldWidth,
    scope: String,
    named: Option<Vec<WireField>>,
    packed: Option<Vec<u64>>,
}

impl WireFields {
    /// Returns the width of a token type.
    pub fn width<T: BitWidth + ?Sized>(widths: &SignalWidths) -> FieldWidth {
        let mut wire = Self::default();
        T::fields(None, widths, &mut wire);
        wire.at
    }

    /// Returns the fields of a token type.
    pub fn list<T: BitWidth>(widths: &SignalWidths) -> Vec<WireField> {
        let mut wire = Self { named: Some(vec![]), ..Self::default() };
        T::fields(None, widths, &mut wire);
        wire.named.unwrap_or_default()
    }

    /// Returns the bits of a token, the lowest first.
    pub fn pack<T: BitWidth>(token: &T, widths: &SignalWidths) -> Vec<u64> {
        let mut wire = Self { packed: Some(vec![]), ..Self::default() };
        T::fields(Some(token), widths, &mut wire);
        let mut packed = wire.packed.unwrap_or_default();
        packed.resize(wire.at.recorded.div_ceil(64) as usize, 0);
        packed
    }

    /// Adds a field of this width. `None` adds it without a value.
    pub fn field(&mut self, name: &str, width: FieldWidth, value: Option<u64>) {
        let (first, FieldWidth { recorded: bits, .. }) = (self.at.recorded, width);
        self.at = FieldWidth { hardware: self.at.hardware + width.hardware, recorded: first + bits };
        if let Some(named) = self.named.as_mut().filter(|_| bits > 0) {
            named.push(WireField { name: format!("{}{name}", self.scope), first, bits });
        }
        if let (Some(packed), Some(value)) = (&mut self.packed, value) {
            put(packed, first, bits, value);
        }
    }

    /// Adds a number that the hardware carries with all its bits.
    pub fn number(&mut self, name: &str, bits: u32, value: Option<impl Into<u64>>) {
        self.field(name, FieldWidth { hardware: bits, recorded: bits }, value.map(Into::into));
    }

    /// Adds a flag.
    pub fn flag(&mut self, name: &str, value: Option<bool>) {
        self.number(name, 1, value);
    }

    /// Adds a number that the model keeps in single precision and the hardware in so many bits.
    pub fn real(&mut self, name: &str, hardware: u32, value: Option<f32>) {
        self.field(name, FieldWidth { hardware, recorded: 32 }, value.map(|real| real.to_bits().into()));
    }

    /// Adds a number that the model keeps in double precision and the hardware in so many bits.
    pub fn double(&mut self, name: &str, hardware: u32, value: Option<f64>) {
        self.field(name, FieldWidth { hardware, recorded: 64 }, value.map(f64::to_bits));
    }

    /// Adds a value that set-up registers hold in the hardware.
    pub fn setup(&mut self, name: &str, bits: u32, value: Option<impl Into<u64>>) {
        self.field(name, FieldWidth { hardware: 0, recorded: bits }, value.map(Into::into));
    }

    /// Adds the fields of a part, with its name before theirs.
    pub fn part(&mut self, name: &str, fields: impl FnOnce(&mut Self)) {
        let length = self.scope.len();
        if self.named.is_some() {
            self.scope.push_str(name);
            self.scope.push('_');
        }
        fields(self);
        self.scope.truncate(length);
    }

    /// Adds the fields of a token within this token.
    pub fn token<T: BitWidth>(&mut self, name: &str, token: Option<&T>, widths: &SignalWidths) {
        self.part(name, |wire| T::fields(token, widths, wire));
    }

    /// Adds fields that set-up registers or buffers hold in the hardware.
    pub fn recorded_only(&mut self, fields: impl FnOnce(&mut Self)) {
        let hardware = self.at.hardware;
        fields(self);
        self.at.hardware = hardware;
    }

    /// Adds variants that share their bits. At most one of them has values.
    pub fn one_of(&mut self, variants: &mut [&mut dyn FnMut(&mut Self)]) {
        let start = self.at;
        let mut end = start;
        for variant in variants {
            self.at = start;
            variant(self);
            end.hardware = end.hardware.max(self.at.hardware);
            end.recorded = end.recorded.max(self.at.recorded);
        }
        self.at = end;
    }
}

/// Sets bits `first .. first + bits`, which are 0.
fn put(packed: &mut Vec<u64>, first: u32, bits: u32, value: u64) {
    let (word, shift) = ((first / 64) as usize, first % 64);
    let value = if bits < 64 { value & ((1 << bits) - 1) } else { value };
    if packed.len() < word + 2 {
        packed.resize(word + 2, 0);
    }
    packed[word] |= value << shift;
    if shift > 0 {
        packed[word + 1] |= value >> (64 - shift);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Control, Flow, Fragment, Stamp};

    #[test]
    fn packed_bits_follow_field_list() {
        let widths = SignalWidths::default();
        let fragment = Fragment { x: 0x1234, y: 0x5678, z: 0xab_cdef, weights: [0.5, -1.0], triangle: 3 };
        let token = Flow::Item(Stamp::from_iter([Fragment::default(), fragment]));
        let (packed, fields) = (WireFields::pack(&token, &widths), WireFields::list::<Flow<Stamp<Fragment>>>(&widths));
        let value = |name: &str| {
            let field = fields.iter().find(|field| field.name == name).unwrap();
            (0..field.bits)
                .map(|bit| field.first + bit)
                .rev()
                .fold(0, |value, bit| value << 1 | (packed[(bit / 64) as usize] >> (bit % 64) & 1))
        };
        assert_eq!((value("item"), value("count")), (1, 2));
        assert_eq!((value("1_x"), value("1_y"), value("1_z"), value("1_triangle")), (0x1234, 0x5678, 0xab_cdef, 3));
        assert_eq!(value("1_weight_1"), u64::from((-1.0_f32).to_bits()));
    }

    #[test]
    fn variants_share_their_bits() {
        let fields = WireFields::list::<Flow<Fragment>>(&SignalWidths::default());
        let first = |name: &str| fields.iter().find(|field| field.name == name).unwrap().first;
        assert_eq!((first("kind"), first("x")), (1, 1));
        let end = WireFields::pack(&Flow::<Fragment>::Control(Control::FrameEnd), &SignalWidths::default());
        assert_eq!(end[0], 4 << 1, "control, and the number of its kind");
    }

    #[test]
    fn setup_needs_no_wire_in_hardware() {
        let mut wire = WireFields::default();
        wire.setup("size", 16, None::<u64>);
        wire.real("share", 8, None);
        assert_eq!(wire.at, FieldWidth { hardware: 8, recorded: 48 });
    }
}
