//! Address map of the graphics-data memory (124) and the size of a picture: the one place where the units that share
//! this memory agree. Byte addresses; all assumed.

/// Colour buffers: two, taken in turn by frames, so that video output reads the one that is not drawn.
pub const COLOR_BUFFERS: u64 = 0;
/// From one colour buffer to the other.
pub const COLOR_BUFFER_STRIDE: u64 = 1 << 27;
/// Z-buffer: four rows of 2 KiB further than a round number, so that colour and depth of one pixel lie in different banks.
/// (At 1 << 28 every change between them was a row conflict: 966 k cycles instead of 791 k on the sphere demo.)
pub const Z_BUFFER: u64 = (1 << 28) + (4 << 11);
/// Colour textures; `Texture::offset` counts from here; two rows further, for the same reason.
pub const COLOR_TEXTURES: u64 = (1 << 29) + (2 << 11);
/// Entries of fragments that wait to be drawn (`graphics.draw = after_list`).
pub const HELD_RESULTS: u64 = 1 << 30;

/// Widest and highest picture \[pixels\].
pub const MAX_SIDE: u32 = 1 << 14;
/// Largest picture \[pixels\]: with 4 bytes per pixel, and sides rounded up to whole blocks, it fits its buffer.
pub const MAX_PIXELS: u64 = 1 << 24;

/// Whether a picture of this size has room.
pub fn fits(width: u32, height: u32) -> bool {
    width <= MAX_SIDE && height <= MAX_SIDE && u64::from(width) * u64::from(height) <= MAX_PIXELS
}
