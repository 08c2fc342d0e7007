//! Memory (12) and its layout. The host interface writes it, and the processes of the CPU (11) read it, each at a port of its
//! own.
//!
//! | from | numbers | contents |
//! |---|---:|---|
//! | 0 | 16 | mode, Ia, V, Ka, Kd, Ks, n, colour |
//! | `LIGHTS` | 8 each | L, Is, H, largest negligible N.H |
//! | `PLANE` | 16 | Figure 7: normal, colour, point, slopes, brightness |
//! | `POLYGONS` | 769 each | points, their number; normals; colours; brightness |

use basrelief_kernel::MemoryPorts;

/// Maximum number of lights, the limit of a display list.
const MOST_LIGHTS: u64 = 1024;
/// Maximum number of points of a polygon, the limit of a display list.
const MOST_POINTS: u64 = 64;

pub(crate) const SETTINGS: u64 = 0;
pub(crate) const LIGHTS: u64 = 16;
/// Numbers stored per light.
pub(crate) const LIGHT: u64 = 8;
pub(crate) const PLANE: u64 = LIGHTS + MOST_LIGHTS * LIGHT;
/// Numbers stored per plane.
pub(crate) const PLANE_NUMBERS: u64 = 14;
const POLYGONS: u64 = PLANE + 16;
const PER_POINT: u64 = 3 * MOST_POINTS;

/// The buffer of a polygon.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PolygonBuffer(u64);

impl PolygonBuffer {
    /// Returns the buffer of the polygon with this number, counted from 0.
    pub(crate) fn of(polygon: u64, buffers: u32) -> Self {
        Self(POLYGONS + polygon % u64::from(buffers.max(1)) * (4 * PER_POINT + 1))
    }

    /// Returns the address of the number of points. The points follow it.
    pub(crate) fn points(self) -> u64 {
        self.0
    }

    pub(crate) fn normals(self) -> u64 {
        self.0 + 1 + PER_POINT
    }

    pub(crate) fn colors(self) -> u64 {
        self.0 + 1 + 2 * PER_POINT
    }

    pub(crate) fn brightness(self) -> u64 {
        self.0 + 1 + 3 * PER_POINT
    }
}

/// Returns the numbers in all buffers.
pub(crate) fn numbers(buffers: u32) -> u64 {
    POLYGONS + u64::from(buffers) * (4 * PER_POINT + 1)
}

/// A port, with the width of its numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalPort {
    pub(crate) number_bytes: u32,
}

impl LocalPort {
    /// Client of each unit that has a port.
    pub(crate) const CLIENT: u32 = 0;

    pub(crate) fn read(self, traffic: &mut MemoryPorts, from: u64, numbers: u64) {
        if numbers > 0 {
            traffic.read(Self::CLIENT, from * u64::from(self.number_bytes), self.bytes(numbers));
        }
    }

    pub(crate) fn write(self, traffic: &mut MemoryPorts, from: u64, numbers: u64) {
        if numbers > 0 {
            traffic.write(Self::CLIENT, from * u64::from(self.number_bytes), self.bytes(numbers));
        }
    }

    fn bytes(self, numbers: u64) -> u32 {
        u32::try_from(numbers).unwrap_or(u32::MAX).saturating_mul(self.number_bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_regions_do_not_overlap() {
        let [first, second] = [0, 1].map(|polygon| PolygonBuffer::of(polygon, 2));
        let from = [LIGHTS, PLANE, first.points(), first.normals(), first.colors(), first.brightness(), second.points()];
        assert!(from.is_sorted() && PLANE + PLANE_NUMBERS <= first.points());
        assert_eq!(second.brightness() + PER_POINT, numbers(2));
        assert_eq!(PolygonBuffer::of(7, 1).points(), first.points(), "one buffer serves all");
    }
}
