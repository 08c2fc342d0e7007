//! Vertices and indices of meshes, as they lie behind the head: positions, normals, and where the mesh has them texture coordinates,
//! coordinates of the normal map, colours, each as numbers of 32 bits; then indices, of 16 bits where there are at most 65,536
//! vertices, of 32 otherwise.

use super::head::{MeshHead, NormalUv, place};
use crate::SceneError;
use crate::outside::over_budget;
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_signals::Mesh;

/// Maximum number of vertices that an index of two bytes tells apart.
const SHORT_INDEX: u32 = 1 << 16;

/// Writes the arrays of a mesh.
pub(super) fn write(mesh: &Mesh, bytes: &mut Vec<u8>) {
    let mut put = |numbers: &[f32]| bytes.extend(numbers.iter().flat_map(|n| n.to_le_bytes()));
    put(mesh.positions.as_flattened());
    put(mesh.normals.as_flattened());
    put(mesh.uv.as_flattened());
    if NormalUv::of(mesh) == NormalUv::Own {
        put(mesh.uv_normal.as_flattened());
    }
    put(mesh.colors.as_flattened());
    if mesh.positions.len() <= SHORT_INDEX as usize {
        bytes.extend(mesh.indices.iter().flat_map(|i| (*i as u16).to_le_bytes()));
    } else {
        bytes.extend(mesh.indices.iter().flat_map(|i| i.to_le_bytes()));
    }
}

/// Arrays that are read one after the other.
pub(super) struct ArrayReader<'a> {
    rest: &'a [u8],
    budget: MemoryPool,
    held: MemoryReservation,
}

impl<'a> ArrayReader<'a> {
    /// Creates a reader of these bytes, whose memory is added to a reservation.
    pub(super) fn new(rest: &'a [u8], budget: &MemoryPool, held: MemoryReservation) -> Self {
        Self { rest, budget: budget.clone(), held }
    }

    /// The next mesh.
    pub(super) fn mesh(&mut self, index: usize, head: &MeshHead) -> Result<Mesh, SceneError> {
        let vertices = head.vertices as usize;
        let when = |there: bool| if there { vertices } else { 0 };
        let positions = self.numbers(vertices, index, "positions")?;
        let normals = self.numbers(vertices, index, "normals")?;
        let uv: Vec<[f32; 2]> = self.numbers(when(head.uv), index, "uv")?;
        let own = self.numbers(when(head.uv_normal == NormalUv::Own), index, "uv_normal")?;
        let uv_normal = if head.uv_normal == NormalUv::Same { self.again(&uv, index)? } else { own };
        let colors = self.numbers(when(head.colors), index, "colors")?;
        let indices = self.indices(head, index)?;
        Ok(Mesh { positions, normals, tangents: vec![], uv, uv_normal, colors, indices })
    }

    fn again(&mut self, uv: &[[f32; 2]], index: usize) -> Result<Vec<[f32; 2]>, SceneError> {
        self.hold(size_of_val(uv), index, "uv_normal")?;
        Ok(uv.to_vec())
    }

    /// Reads this many groups of finite numbers.
    fn numbers<const N: usize>(&mut self, count: usize, index: usize, field: &str) -> Result<Vec<[f32; N]>, SceneError> {
        let bytes = self.take(count, 4 * N, index, field)?;
        let numbers: Vec<f32> = bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
        if let Some(i) = numbers.iter().position(|n| !n.is_finite()) {
            let place = place("meshes", index, &format!("{field}/{}", i / N));
            return Err(SceneError::at(place, numbers[i].to_string()).expected("finite numbers"));
        }
        Ok(numbers.as_chunks::<N>().0.to_vec())
    }

    fn indices(&mut self, head: &MeshHead, index: usize) -> Result<Vec<u32>, SceneError> {
        let count = (head.triangles as usize).saturating_mul(3);
        let indices: Vec<u32> = if head.vertices <= SHORT_INDEX {
            // In memory they are longer.
            self.hold(count.saturating_mul(2), index, "indices")?;
            let bytes = self.take(count, 2, index, "indices")?;
            bytes.as_chunks::<2>().0.iter().map(|b| u16::from_le_bytes(*b).into()).collect()
        } else {
            let bytes = self.take(count, 4, index, "indices")?;
            bytes.as_chunks::<4>().0.iter().map(|b| u32::from_le_bytes(*b)).collect()
        };
        if let Some(i) = indices.iter().position(|i| *i >= head.vertices) {
            let place = place("meshes", index, &format!("indices/{i}"));
            return Err(SceneError::at(place, indices[i].to_string()).expected(format!("below {}, the vertices", head.vertices)));
        }
        Ok(indices)
    }

    /// Returns the next `count * size` bytes. Their memory is counted first; numbers are copied once more while they are checked.
    fn take(&mut self, count: usize, size: usize, index: usize, field: &str) -> Result<&'a [u8], SceneError> {
        let bytes = count.saturating_mul(size);
        let Some((taken, rest)) = self.rest.split_at_checked(bytes) else {
            let what = format!("cut short: {} bytes are there", self.rest.len());
            return Err(SceneError::at(place("meshes", index, field), what).expected(format!("{bytes} bytes")));
        };
        self.hold(bytes.saturating_mul(2), index, field)?;
        self.rest = rest;
        Ok(taken)
    }

    fn hold(&mut self, bytes: usize, index: usize, field: &str) -> Result<(), SceneError> {
        let held = self
            .budget
            .try_reserve(bytes as u64, "meshes of a scene")
            .map_err(|e| over_budget(place("meshes", index, field), &e))?;
        self.held.join(held);
        Ok(())
    }

    /// Returns the reservation. Bytes that are left are an error.
    pub(super) fn finish(self) -> Result<MemoryReservation, SceneError> {
        match self.rest.len() {
            0 => Ok(self.held),
            more => Err(SceneError::at("meshes", format!("{more} bytes behind the last mesh")).expected("none")),
        }
    }
}
