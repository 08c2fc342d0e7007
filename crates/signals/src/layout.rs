//! Address map of the graphics-data memory (124) and limits of the picture size. All units that share this memory use it.
//! Addresses are in bytes and all assumed.

/// Start of the first two colour buffers.
const COLOR_BUFFERS: u64 = 0;
/// Distance between neighbouring colour buffers \[bytes\].
pub const COLOR_BUFFER_STRIDE: u64 = 1 << 27;
/// Start of the third and all further colour buffers.
const MORE_COLOR_BUFFERS: u64 = 1 << 40;
/// Start of the z-buffer. It lies four rows of 2 KiB behind a round number, so that colour and depth of one pixel lie in
/// different banks. At 1 << 28 every change between them was a row conflict: 966 k cycles instead of 791 k on the sphere demo.
pub const Z_BUFFER: u64 = (1 << 28) + (4 << 11);
/// Start of the colour textures. `Texture::offset` counts from here. The two extra rows have the same reason as those of the
/// z-buffer.
pub const COLOR_TEXTURES: u64 = (1 << 29) + (2 << 11);
/// Start of the entries of fragments that wait to be drawn (`graphics.draw = after_list`).
pub const HELD_RESULTS: u64 = 1 << 30;

/// Largest width and height of a picture \[pixels\].
pub const MAX_SIDE: u32 = 1 << 14;
/// Maximum number of pixels of a picture. With 4 bytes per pixel, and sides rounded up to whole blocks, such a picture fits its buffer.
pub const MAX_PIXELS: u64 = 1 << 24;

/// Returns the start of colour buffer `number`, from 0. The frames of a swap chain go through the buffers in turn.
pub fn color_buffer(number: u64) -> u64 {
    let start = if number < 2 { COLOR_BUFFERS } else { MORE_COLOR_BUFFERS };
    start + number * COLOR_BUFFER_STRIDE
}

/// Returns true if a picture of this size fits its buffer.
pub fn fits(width: u32, height: u32) -> bool {
    width <= MAX_SIDE && height <= MAX_SIDE && u64::from(width) * u64::from(height) <= MAX_PIXELS
}
