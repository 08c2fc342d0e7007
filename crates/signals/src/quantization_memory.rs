//! Layout of the quantization-vector memory (120), which the replacement unit (110) and the brightness fetch unit (112)
//! share (assumed; the patent says only that both kinds of table lie there).
//!
//! | from | what | room |
//! |---|---|---|
//! | 0 | VQ tables (121), one per level | 8 x 512 KiB: 65,536 entries of 8 bytes |
//! | 4 MiB | sets of CLUTs (122), one per level, close together: small ones share a row | 12 MiB |
//! | 16 MiB | gathered pseudo-normals of code books from here up, what is held beside them from the end of the room down | `replacement.gather_bytes` |

/// VQ tables (121) start here \[bytes\].
pub const VQ_TABLES: u64 = 0;

/// Distance of the VQ tables of two levels \[bytes\].
pub const VQ_TABLE_STRIDE: u64 = 512 << 10;

/// CLUTs (122) start here \[bytes\].
pub const CLUTS: u64 = 4 << 20;

/// Gathered pseudo-normals start here \[bytes\].
pub const GATHERED: u64 = 16 << 20;

/// Start of the VQ table of `level`.
#[inline]
pub fn vq_table(level: u8) -> u64 {
    VQ_TABLES + u64::from(level) * VQ_TABLE_STRIDE
}

/// Distance of the CLUTs of two levels, the largest of which has `entries` entries of `entry_bytes` bytes: rounded up to
/// 64, so that no two levels share a common cache line.
#[inline]
pub fn clut_stride(entries: usize, entry_bytes: u32) -> u64 {
    (entries as u64 * u64::from(entry_bytes)).next_multiple_of(64)
}
