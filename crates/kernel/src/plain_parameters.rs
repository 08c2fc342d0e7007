//! Parameter declarations without the feature `config`: the struct and its defaults, and nothing else.
//!
//! The syntax is that of the macros of `basrelief-parameters`, so each parameter is declared once.

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
    };
}

macro_rules! parameter_groups {
    ($(#[doc = $about:literal])* pub struct $name:ident {
        $($(#[doc = $doc:literal])* $field:ident : $type:ty = $default:expr,)*
    }) => {
        $(#[doc = $about])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $name { $($(#[doc = $doc])* pub $field: $type,)* }

        impl Default for $name {
            fn default() -> Self { Self { $($field: $default,)* } }
        }
    };
}

pub(crate) use {parameter_groups, parameters};
