//! Basrelief: rasterizer
