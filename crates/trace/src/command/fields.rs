//! Commands with optional fields.

/// Declares a command with optional fields, which take their type's default where missing. Text omits them then; the
/// binary form, which has no field names, always holds every field. (serde's own `skip_serializing_if` cannot tell
/// the two forms apart.)
macro_rules! fields {
    ($(#[$about:meta])* pub struct $name:ident {
        $($(#[$doc:meta])* $field:ident: $type:ty,)*
    } optional {
        $($(#[$optional_doc:meta])* $optional:ident: $optional_type:ty,)*
    }) => {
        $(#[$about])*
        #[derive(Clone, Debug, PartialEq, serde::Deserialize, schemars::JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub struct $name {
            $($(#[$doc])* pub $field: $type,)*
            $($(#[$optional_doc])* #[serde(default)] pub $optional: $optional_type,)*
        }

        impl serde::Serialize for $name {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                use serde::ser::SerializeStruct;
                let every = !serializer.is_human_readable();
                let fields: &[bool] = &[
                    $({ let _ = &self.$field; true },)*
                    $(every || self.$optional != <$optional_type as Default>::default(),)*
                ];
                let shown = fields.iter().filter(|shown| **shown).count();
                let mut out = serializer.serialize_struct(stringify!($name), shown)?;
                $(out.serialize_field(stringify!($field), &self.$field)?;)*
                $(if every || self.$optional != <$optional_type as Default>::default() {
                    out.serialize_field(stringify!($optional), &self.$optional)?;
                })*
                out.end()
            }
        }
    };
}

pub(super) use fields;
