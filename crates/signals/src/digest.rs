//! Digest of a mesh, by which instances are recognized.

use crate::Mesh;

/// Multiplier of the 64-bit Fowler-Noll-Vo hash.
const PRIME: u64 = 0x0000_0100_0000_01b3;
/// Start of the hash.
const OFFSET: u64 = 0xcbf2_9ce4_8422_2325;

impl Mesh {
    /// Returns a digest of the contents, 1..2^53: exact in any JSON reader. It is that of the bits, so it is equal on every
    /// computer.
    pub fn digest(&self) -> u64 {
        let Self { positions, normals, tangents, uv, uv_normal, colors, indices } = self;
        let sizes = [positions.len(), normals.len(), tangents.len(), uv.len(), uv_normal.len(), colors.len()];
        let hash = sizes.iter().fold(OFFSET, |hash, &size| mixed(hash, size as u64));
        let hash = numbers(numbers(hash, positions), normals);
        let hash = numbers(numbers(numbers(numbers(hash, tangents), uv), uv_normal), colors);
        let hash = indices.iter().fold(hash, |hash, &index| mixed(hash, index.into()));
        (hash >> 11).max(1)
    }
}

fn numbers<const N: usize>(hash: u64, values: &[[f32; N]]) -> u64 {
    values.as_flattened().iter().fold(hash, |hash, value| mixed(hash, value.to_bits().into()))
}

fn mixed(hash: u64, word: u64) -> u64 {
    let hash = (hash ^ word).wrapping_mul(PRIME);
    hash ^ hash >> 32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digest_follows_contents() {
        let mesh = Mesh { positions: vec![[0.0; 3], [1.0, 0.0, 0.0]], indices: vec![0, 1, 0], ..Mesh::default() };
        assert_eq!(mesh.digest(), mesh.clone().digest());
        let others = [
            Mesh { positions: vec![[0.0; 3], [1.0, 0.0, 1e-9]], ..mesh.clone() },
            Mesh { indices: vec![0, 0, 1], ..mesh.clone() },
            Mesh { positions: vec![[0.0; 3]], normals: vec![[1.0, 0.0, 0.0]], ..mesh.clone() },
        ];
        assert!(others.iter().all(|other| other.digest() != mesh.digest() && other.digest() < 1 << 53));
    }
}
