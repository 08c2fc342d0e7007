//! Layout of the quantization-vector memory (120), which the replacement unit (110) and the brightness fetch unit (112) share
//! (assumed; the patent states only that the memory holds both kinds of table).
//!
//! | from | contents | room |
//! |---|---|---|
//! | 0 | VQ tables (121), one per level | 8 x 512 KiB: 65,536 entries of 8 bytes |
//! | 4 MiB | sets of CLUTs (122), one per level, close together: small ones share a row | 12 MiB |
//! | 16 MiB | VQ tables of other sizes, which objects or a policy select | 16 MiB |
//! | 32 MiB | gathered pseudo-normals of code books, growing up; data held beside them, growing down from the end | `replacement.gather_bytes` |

/// Start of the VQ tables (121) \[bytes\].
pub const VQ_TABLES: u64 = 0;

/// Distance between the VQ tables of two levels \[bytes\].
pub const VQ_TABLE_STRIDE: u64 = 512 << 10;

/// Start of the CLUTs (122) \[bytes\].
pub const CLUTS: u64 = 4 << 20;

/// Start of the VQ tables (121) whose size is not the configured one \[bytes\].
pub const OTHER_TABLES: u64 = 16 << 20;

/// Start of the gathered pseudo-normals \[bytes\].
pub const GATHERED: u64 = 32 << 20;

/// Returns the start of the VQ table of `level` \[bytes\].
#[inline]
pub fn vq_table(level: u8) -> u64 {
    VQ_TABLES + u64::from(level) * VQ_TABLE_STRIDE
}

/// Returns the distance between the CLUTs of two levels \[bytes\]. The largest has `entries` entries of `entry_bytes` bytes,
/// rounded up to 64 bytes so that no two levels share a common cache line.
#[inline]
pub fn clut_stride(entries: usize, entry_bytes: u32) -> u64 {
    (entries as u64 * u64::from(entry_bytes)).next_multiple_of(64)
}
