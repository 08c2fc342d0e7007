//! Exhibits: what a machine shows beside its finished pictures. Each machine lists its own ([`ExhibitSpec`](spec::ExhibitSpec)):
//! a name, a form, and how it is made of an entry of the machine's log. Whoever runs the machine says which it wants, and is
//! handed those.

pub(crate) mod content;
pub(crate) mod costs;
pub(crate) mod defer;
mod heat_map;
mod lettering;
pub(crate) mod spec;
pub(crate) mod texel;
mod tile_lines;
mod tile_pictures;
