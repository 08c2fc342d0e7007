//! Deserializer that accepts only objects as structs.
//!
//! serde's derived code also accepts a list, field by field: `"asset": ["2.0", null]` would be glTF, and a trace could leave
//! its keys out. This module refuses lists for all structs. An attribute at each struct would be forgotten at the next one.

use serde::de::{DeserializeSeed, Deserializer, EnumAccess, Error, MapAccess, SeqAccess, VariantAccess, Visitor};
use std::cell::Cell;
use std::fmt;

/// Forwards every call to the wrapped value, and wraps the result.
pub(crate) struct RejectSeqForStruct<'t, T>(pub T, pub &'t FaultTrail);

/// Way of an error from the faulty value outwards.
#[derive(Default)]
pub(crate) struct FaultTrail {
    /// Number of lists and objects around the faulty value.
    depth: Cell<usize>,
    /// True if the value's error has no line, because a conversion made it. The list or object around the value gives it the line behind
    /// the value, or behind all of the list or object if nothing else stands there.
    lacks_line: Cell<bool>,
}

impl FaultTrail {
    /// Takes in an error on its way out of a list or an object. (The text of an error may be as long as the file, so only the first list or
    /// object reads it.)
    fn pass(&self, error: &impl fmt::Display) {
        if self.depth.get() == 0 {
            self.lacks_line.set(!has_line(&error.to_string()));
        }
        self.depth.set(self.depth.get() + 1);
    }

    /// Depth of a value whose error lacks a line.
    pub(crate) fn depth_without_line(&self) -> Option<usize> {
        self.lacks_line.get().then_some(self.depth.get())
    }
}

/// Returns true if the text of an error of `serde_json` ends with its line and column.
fn has_line(text: &str) -> bool {
    let place = text.rsplit_once(" at line ").and_then(|(_, place)| place.split_once(" column "));
    place.is_some_and(|(line, column)| [line, column].iter().all(|number| number.bytes().all(|byte| byte.is_ascii_digit())))
}

macro_rules! pass_on {
    ($($method:ident($($argument:ident: $type:ty),*);)*) => {$(
        fn $method<V: Visitor<'de>>(self, $($argument: $type,)* visitor: V) -> Result<V::Value, D::Error> {
            self.0.$method($($argument,)* RejectSeqForStruct(visitor, self.1))
        }
    )*};
}

impl<'de, D: Deserializer<'de>> Deserializer<'de> for RejectSeqForStruct<'_, D> {
    type Error = D::Error;

    pass_on! {
        deserialize_any();
        deserialize_bool();
        deserialize_i8();
        deserialize_i16();
        deserialize_i32();
        deserialize_i64();
        deserialize_i128();
        deserialize_u8();
        deserialize_u16();
        deserialize_u32();
        deserialize_u64();
        deserialize_u128();
        deserialize_f32();
        deserialize_f64();
        deserialize_char();
        deserialize_str();
        deserialize_string();
        deserialize_bytes();
        deserialize_byte_buf();
        deserialize_option();
        deserialize_unit();
        deserialize_unit_struct(name: &'static str);
        deserialize_newtype_struct(name: &'static str);
        deserialize_seq();
        deserialize_tuple(length: usize);
        deserialize_tuple_struct(name: &'static str, length: usize);
        deserialize_map();
        deserialize_enum(name: &'static str, variants: &'static [&'static str]);
        deserialize_identifier();
        deserialize_ignored_any();
    }

    /// The only call that is not forwarded: a list is refused.
    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        self.0.deserialize_map(RejectSeqForStruct(visitor, self.1))
    }
}

macro_rules! visit {
    ($($method:ident($type:ty);)*) => {$(
        fn $method<E: Error>(self, value: $type) -> Result<V::Value, E> {
            self.0.$method(value)
        }
    )*};
}

impl<'de, V: Visitor<'de>> Visitor<'de> for RejectSeqForStruct<'_, V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.expecting(f)
    }

    visit! {
        visit_bool(bool);
        visit_i8(i8);
        visit_i16(i16);
        visit_i32(i32);
        visit_i64(i64);
        visit_i128(i128);
        visit_u8(u8);
        visit_u16(u16);
        visit_u32(u32);
        visit_u64(u64);
        visit_u128(u128);
        visit_f32(f32);
        visit_f64(f64);
        visit_char(char);
        visit_str(&str);
        visit_borrowed_str(&'de str);
        visit_string(String);
        visit_bytes(&[u8]);
        visit_borrowed_bytes(&'de [u8]);
        visit_byte_buf(Vec<u8>);
    }

    fn visit_none<E: Error>(self) -> Result<V::Value, E> {
        self.0.visit_none()
    }

    fn visit_unit<E: Error>(self) -> Result<V::Value, E> {
        self.0.visit_unit()
    }

    fn visit_some<D: Deserializer<'de>>(self, deserializer: D) -> Result<V::Value, D::Error> {
        self.0.visit_some(RejectSeqForStruct(deserializer, self.1))
    }

    fn visit_newtype_struct<D: Deserializer<'de>>(self, deserializer: D) -> Result<V::Value, D::Error> {
        self.0.visit_newtype_struct(RejectSeqForStruct(deserializer, self.1))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<V::Value, A::Error> {
        self.0.visit_seq(RejectSeqForStruct(list, self.1))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<V::Value, A::Error> {
        self.0.visit_map(RejectSeqForStruct(map, self.1))
    }

    fn visit_enum<A: EnumAccess<'de>>(self, choice: A) -> Result<V::Value, A::Error> {
        self.0.visit_enum(RejectSeqForStruct(choice, self.1))
    }
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for RejectSeqForStruct<'_, S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<S::Value, D::Error> {
        self.0.deserialize(RejectSeqForStruct(deserializer, self.1))
    }
}

impl<'de, A: SeqAccess<'de>> SeqAccess<'de> for RejectSeqForStruct<'_, A> {
    type Error = A::Error;

    fn next_element_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>, A::Error> {
        self.0.next_element_seed(RejectSeqForStruct(seed, self.1)).inspect_err(|error| self.1.pass(error))
    }

    fn size_hint(&self) -> Option<usize> {
        self.0.size_hint()
    }
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for RejectSeqForStruct<'_, A> {
    type Error = A::Error;

    fn next_key_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>, A::Error> {
        self.0.next_key_seed(RejectSeqForStruct(seed, self.1))
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, A::Error> {
        self.0.next_value_seed(RejectSeqForStruct(seed, self.1)).inspect_err(|error| self.1.pass(error))
    }

    fn size_hint(&self) -> Option<usize> {
        self.0.size_hint()
    }
}

impl<'de, 't, A: EnumAccess<'de>> EnumAccess<'de> for RejectSeqForStruct<'t, A> {
    type Error = A::Error;
    type Variant = RejectSeqForStruct<'t, A::Variant>;

    fn variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> Result<(S::Value, Self::Variant), A::Error> {
        self.0.variant_seed(RejectSeqForStruct(seed, self.1)).map(|(value, variant)| (value, RejectSeqForStruct(variant, self.1)))
    }
}

impl<'de, A: VariantAccess<'de>> VariantAccess<'de> for RejectSeqForStruct<'_, A> {
    type Error = A::Error;

    fn unit_variant(self) -> Result<(), A::Error> {
        self.0.unit_variant()
    }

    fn newtype_variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> Result<S::Value, A::Error> {
        self.0.newtype_variant_seed(RejectSeqForStruct(seed, self.1)).inspect_err(|error| self.1.pass(error))
    }

    fn tuple_variant<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, A::Error> {
        self.0.tuple_variant(length, RejectSeqForStruct(visitor, self.1))
    }

    /// Reads a variant as a value of its own, because `serde_json` accepts a list for its fields, too.
    fn struct_variant<V: Visitor<'de>>(self, _: &'static [&'static str], visitor: V) -> Result<V::Value, A::Error> {
        self.0.newtype_variant_seed(VariantFields(visitor, self.1)).inspect_err(|error| self.1.pass(error))
    }
}

/// The fields of a variant.
struct VariantFields<'t, V>(V, &'t FaultTrail);

impl<'de, V: Visitor<'de>> DeserializeSeed<'de> for VariantFields<'_, V> {
    type Value = V::Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<V::Value, D::Error> {
        deserializer.deserialize_map(RejectSeqForStruct(self.0, self.1))
    }
}
