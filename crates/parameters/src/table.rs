//! The table of parameters and the macros that fill it.

use serde::{Serialize, de::DeserializeOwned};

/// Where a number or a behaviour comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Provenance {
    /// Fixed by the patent; the text says where.
    Stated(&'static str),
    /// Follows from the patent; the text shows how.
    Derived(&'static str),
    /// Our modelling choice; the text says why.
    Assumed(&'static str),
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
    pub fn text(&self) -> &'static str {
        match self {
            Self::Stated(t) | Self::Derived(t) | Self::Assumed(t) => t,
        }
    }
}

/// Every fact about one parameter.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Dotted name, as in `--set KEY=VALUE` and in TOML.
    pub key: String,
    /// What it is.
    pub doc: String,
    /// Unit of measure; empty for a switch or a choice.
    pub unit: &'static str,
    /// Allowed values in words; empty when the type says all.
    pub range: String,
    /// The default, as JSON.
    pub default: serde_json::Value,
    /// Where the default comes from.
    pub provenance: Provenance,
}

/// A value outside its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{key}` is {value}, expected {expected}")]
pub struct RangeError {
    /// Dotted name.
    pub key: String,
    /// What was given.
    pub value: String,
    /// What is allowed.
    pub expected: String,
}

/// A configuration declared with [`parameters!`](crate::parameters) or [`parameter_groups!`](crate::parameter_groups).
pub trait Parameters: Serialize + DeserializeOwned + Default {
    /// All parameters, in order of declaration, keys relative to this struct.
    fn table() -> Vec<Parameter>;
    /// Checks every range; `prefix` is put before each key.
    fn check(&self, prefix: &str) -> Result<(), RangeError>;
}

/// Declares one unit's configuration: struct, defaults, ranges and provenance in one place. See the crate's example.
#[macro_export]
macro_rules! parameters {
    ($(#[doc = $about:literal])* pub struct $name:ident {
        $($(#[doc = $doc:literal])* $field:ident : $type:ty = $default:expr, unit: $unit:literal,
          $kind:ident($why:literal) $(, range: $range:expr)?;)*
    }) => {
        $(#[doc = $about])*
        #[derive(Clone, Debug, PartialEq, $crate::private::serde::Serialize, $crate::private::serde::Deserialize, $crate::private::schemars::JsonSchema)]
        #[serde(crate = "basrelief_parameters::private::serde", default, deny_unknown_fields)]
        #[schemars(crate = "basrelief_parameters::private::schemars")]
        pub struct $name {
            $($(#[doc = $doc])* #[doc = concat!("\n\nUnit: ", $unit, ". ", stringify!($kind), ": ", $why, ".")] pub $field: $type,)*
        }

        impl Default for $name {
            fn default() -> Self { Self { $($field: $default,)* } }
        }

        impl $crate::Parameters for $name {
            fn table() -> Vec<$crate::Parameter> {
                let default = Self::default();
                vec![$($crate::Parameter {
                    key: stringify!($field).into(),
                    doc: concat!($($doc),*).trim().into(),
                    unit: $unit,
                    range: String::new() $(+ &format!("{:?}", $range))?,
                    default: $crate::private::serde_json::to_value(&default.$field).unwrap_or_default(),
                    provenance: $crate::Provenance::$kind($why),
                }),*]
            }

            #[allow(unused_variables, reason = "a struct without ranges needs no prefix")]
            fn check(&self, prefix: &str) -> Result<(), $crate::RangeError> {
                $($(if !($range).contains(&self.$field) {
                    return Err($crate::RangeError {
                        key: format!("{prefix}{}", stringify!($field)),
                        value: match $crate::private::serde_json::to_value(&self.$field).unwrap_or_default() {
                            // What is not finite has no JSON.
                            $crate::private::serde_json::Value::Null => format!("{:?}", self.$field),
                            value => value.to_string(),
                        },
                        expected: format!("{:?} {}", $range, $unit).trim_end().into(),
                    });
                })?)*
                Ok(())
            }
        }
    };
}

/// Declares a configuration that is made of others, one per named group.
#[macro_export]
macro_rules! parameter_groups {
    ($(#[doc = $about:literal])* pub struct $name:ident { $($(#[doc = $doc:literal])* $field:ident : $type:ty = $default:expr,)* }) => {
        $(#[doc = $about])*
        #[derive(Clone, Debug, PartialEq, $crate::private::serde::Serialize, $crate::private::serde::Deserialize, $crate::private::schemars::JsonSchema)]
        #[serde(crate = "basrelief_parameters::private::serde", default, deny_unknown_fields)]
        #[schemars(crate = "basrelief_parameters::private::schemars")]
        pub struct $name { $($(#[doc = $doc])* pub $field: $type,)* }

        impl Default for $name {
            fn default() -> Self { Self { $($field: $default,)* } }
        }

        impl $crate::Parameters for $name {
            fn table() -> Vec<$crate::Parameter> {
                let whole = $crate::private::serde_json::to_value(Self::default()).unwrap_or_default();
                let mut table = Vec::new();
                $(for mut p in <$type as $crate::Parameters>::table() {
                    let inner = format!("/{}", p.key.replace('.', "/"));
                    if let Some(d) = whole[stringify!($field)].pointer(&inner) { p.default = d.clone(); }
                    p.key = format!("{}.{}", stringify!($field), p.key);
                    table.push(p);
                })*
                table
            }

            fn check(&self, prefix: &str) -> Result<(), $crate::RangeError> {
                $($crate::Parameters::check(&self.$field, &format!("{prefix}{}.", stringify!($field)))?;)*
                Ok(())
            }
        }
    };
}
