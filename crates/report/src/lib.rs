//! Basrelief: what people read and open
