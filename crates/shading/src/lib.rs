//! Basrelief: pure graphics arithmetic
