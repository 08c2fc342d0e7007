//! The table of parameters and the macros that fill it.

use crate::fields::{Fields, to_json};
use crate::{ConfigError, RangeError, UserSettings};
use std::borrow::Cow;

/// Origin of a value or a behaviour.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Provenance {
    /// Fixed by the patent. The text names the place.
    Stated(Cow<'static, str>),
    /// Follows from the patent or from a data sheet. The text shows how.
    Derived(Cow<'static, str>),
    /// Our modelling choice. The text gives the reason.
    Assumed(Cow<'static, str>),
}

impl Provenance {
    /// `stated`, `derived` or `assumed`.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Stated(_) => "stated",
            Self::Derived(_) => "derived",
            Self::Assumed(_) => "assumed",
        }
    }

    /// The place, derivation or reason.
    pub fn text(&self) -> &str {
        match self {
            Self::Stated(t) | Self::Derived(t) | Self::Assumed(t) => t,
        }
    }
}

/// The part of a run that a parameter changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// The work of the units: images, memory requests, durations of steps.
    Work,
    /// Only the timing: a recording can be resimulated with another value.
    Timing,
    /// Only the area of the hardware.
    Cost,
}

impl Effect {
    /// `work`, `timing` or `cost`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Work => "work",
            Self::Timing => "timing",
            Self::Cost => "cost",
        }
    }
}

/// Every fact about one parameter.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Dotted name, as in `--set KEY=VALUE` and in TOML.
    pub key: String,
    /// Description.
    pub doc: String,
    /// Unit of measure; empty for a switch or a choice.
    pub unit: &'static str,
    /// Allowed values in words; empty if the type determines them.
    pub range: String,
    /// The default, as JSON.
    pub default: serde_json::Value,
    /// Origin of the default.
    pub provenance: Provenance,
    /// The part of a run that it changes.
    pub effect: Effect,
}

impl Parameter {
    /// Returns the default in the syntax of `--set`.
    pub fn as_option(&self) -> String {
        as_option(&self.default)
    }
}

/// Returns a value in the syntax of `--set`.
pub fn as_option(value: &serde_json::Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// A configuration declared with [`parameters!`](crate::parameters) or [`parameter_groups!`](crate::parameter_groups).
pub trait Parameters: Fields + Default {
    /// Returns all parameters in order of declaration, with keys relative to this struct.
    fn table() -> Vec<Parameter>;
    /// Checks every range. `prefix` precedes each key in errors.
    fn check(&self, prefix: &str) -> Result<(), RangeError>;

    /// Sets dependent parameters that the user has not `given`. All values are in their ranges before the call, and
    /// [`load`](crate::load) checks them again after it. By default no parameter depends on others.
    ///
    /// # Errors
    /// [`ConfigError::Unfit`] if no value is possible.
    fn complete(&mut self, given: &UserSettings<'_>) -> Result<(), ConfigError> {
        let _ = given;
        Ok(())
    }

    /// Returns old names of parameters or groups, each with its new name; an empty new name means that the value is ignored. They are read
    /// like the new names, and are listed nowhere. By default there are none.
    fn renamed() -> &'static [(&'static str, &'static str)] {
        &[]
    }

    /// Sets the provenance of dependent parameters in this configuration's `table`.
    fn explain(&self, table: &mut [Parameter]) {
        let _ = table;
    }
}

/// Returns the value of a parameter of a configuration as JSON, by its dotted name.
pub fn value_of<'a>(config: &'a serde_json::Value, key: &str) -> Option<&'a serde_json::Value> {
    key.split('.').try_fold(config, |group, name| group.get(name))
}

/// Returns all parameters of this configuration with its values in place of the defaults, and their provenance.
pub fn resolved<C: Parameters>(config: &C) -> Vec<Parameter> {
    let mut table = C::table();
    let values = to_json(config).unwrap_or_default();
    for parameter in &mut table {
        if let Some(value) = value_of(&values, &parameter.key).filter(|value| **value != parameter.default) {
            let Parameter { default, provenance, .. } = &*parameter;
            let set = format!("set; the default is {default} ({}: {})", provenance.kind(), provenance.text());
            parameter.provenance = Provenance::Assumed(set.into());
            parameter.default = value.clone();
        }
    }
    config.explain(&mut table);
    table
}

/// Declares one unit's configuration: struct, defaults, ranges and provenance in one place. See the crate's example.
#[macro_export]
macro_rules! parameters {
    ($(#[doc = $about:literal])* pub struct $name:ident {
        $($(#[doc = $doc:literal])* $field:ident : $type:ty = $default:expr, unit: $unit:literal,
          $kind:ident($why:literal) $(, range: $range:expr)? $(, effect: $effect:ident)?;)*
    }) => {
        $(#[doc = $about])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $name {
            $($(#[doc = $doc])* #[doc = concat!("\n\nUnit: ", $unit, ". ", stringify!($kind), ": ", $why, ".")] pub $field: $type,)*
        }

        impl Default for $name {
            fn default() -> Self { Self { $($field: $default,)* } }
        }

        $crate::fields! { Value [$($about)*] $name {
            $($field: $type [$($doc,)* concat!("\n\nUnit: ", $unit, ". ", stringify!($kind), ": ", $why, ".")])*
        } }

        impl $crate::Parameters for $name {
            fn table() -> Vec<$crate::Parameter> {
                let default = Self::default();
                let mut table = Vec::new();
                $($crate::private::add_parameter(
                    &mut table,
                    (stringify!($field), concat!($($doc),*), $unit),
                    [$(Some(&$range as &dyn ::std::fmt::Debug),)? None][0],
                    &default.$field,
                    ($crate::Provenance::$kind($why.into()), [$($crate::Effect::$effect,)? $crate::Effect::Work][0]),
                );)*
                table
            }

            #[allow(unused_variables, reason = "a struct without ranges needs no prefix")]
            fn check(&self, prefix: &str) -> Result<(), $crate::RangeError> {
                $($(if !($range).contains(&self.$field) {
                    return Err($crate::private::range_error(prefix, stringify!($field), &self.$field, &$range, $unit));
                })?)*
                Ok(())
            }
        }
    };
}

/// Declares a configuration that is made of others, one per named group.
///
/// A group's default may state the provenance of its own values: `clock: Clock = Clock { hz: 5 } => [hz: Assumed("why")],`.
/// Two functions and a constant implement [`Parameters::complete`], [`Parameters::explain`] and [`Parameters::renamed`]:
/// `pub struct Config completed(FUNCTION) explained(FUNCTION) renamed(CONSTANT) { ... }`.
#[macro_export]
macro_rules! parameter_groups {
    ($(#[doc = $about:literal])* pub struct $name:ident $(completed($complete:path) explained($explain:path) renamed($renamed:path))? {
        $($(#[doc = $doc:literal])* $field:ident : $type:ty = $default:expr $(=> [$($($inner:ident).+: $kind:ident($why:literal)),+ $(,)?])?,)*
    }) => {
        $(#[doc = $about])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $name { $($(#[doc = $doc])* pub $field: $type,)* }

        impl Default for $name {
            fn default() -> Self { Self { $($field: $default,)* } }
        }

        $crate::fields! { Group [$($about)*] $name { $($field: $type [$($doc,)*])* } }

        impl $crate::Parameters for $name {
            fn table() -> Vec<$crate::Parameter> {
                let defaults = $crate::to_json(&Self::default()).unwrap_or_default();
                let mut table = Vec::new();
                $($crate::private::add_group(
                    &mut table,
                    stringify!($field),
                    <$type as $crate::Parameters>::table(),
                    &defaults,
                    &[$($((&[$(stringify!($inner)),+], $crate::Provenance::$kind($why.into())),)+)?],
                );)*
                table
            }

            fn check(&self, prefix: &str) -> Result<(), $crate::RangeError> {
                $($crate::Parameters::check(&self.$field, &$crate::private::group_prefix(prefix, stringify!($field)))?;)*
                Ok(())
            }

            $(fn complete(&mut self, given: &$crate::UserSettings<'_>) -> Result<(), $crate::ConfigError> {
                $complete(self, given)
            }

            fn explain(&self, table: &mut [$crate::Parameter]) {
                $explain(self, table)
            }

            fn renamed() -> &'static [(&'static str, &'static str)] {
                $renamed
            })?
        }
    };
}

/// Implements the field list, serde's traits and the JSON schema of a configuration.
#[doc(hidden)]
#[macro_export]
macro_rules! fields {
    ($kind:ident [$($about:literal)*] $name:ident { $($field:ident : $type:ty [$($doc:expr),* $(,)?])* }) => {
        impl $crate::private::Fields for $name {
            fn fields(&self) -> Vec<(&'static str, $crate::private::Field<'_>)> {
                vec![$((stringify!($field), $crate::private::Field::$kind(&self.$field))),*]
            }

            fn fields_mut(&mut self) -> Vec<(&'static str, $crate::private::FieldMut<'_>)> {
                vec![$((stringify!($field), $crate::private::FieldMut::$kind(&mut self.$field))),*]
            }
        }

        impl $crate::private::serde::Serialize for $name {
            fn serialize<S: $crate::private::serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                $crate::private::serialize(self, serializer)
            }
        }

        impl<'de> $crate::private::serde::Deserialize<'de> for $name {
            fn deserialize<D: $crate::private::serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                $crate::private::deserialize(deserializer, stringify!($name), &[$(stringify!($field)),*])
            }
        }

        impl $crate::private::schemars::JsonSchema for $name {
            fn schema_name() -> ::std::borrow::Cow<'static, str> {
                stringify!($name).into()
            }

            fn schema_id() -> ::std::borrow::Cow<'static, str> {
                concat!(module_path!(), "::", stringify!($name)).into()
            }

            fn json_schema(generator: &mut $crate::private::schemars::SchemaGenerator) -> $crate::private::schemars::Schema {
                let fields: &[$crate::private::FieldSchema<'_>] = &[
                    $((&[$($doc),*], $crate::private::schemars::SchemaGenerator::subschema_for::<$type>)),*
                ];
                $crate::private::schema(generator, &[$($about),*], &Self::default(), fields)
            }
        }
    };
}
