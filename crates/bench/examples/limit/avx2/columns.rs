//! Columns of visible fragments between the passes.

use super::block::Block;
use super::lanes::{F32x8, I32x8, LANES};
use super::shade::three;
use super::triangle::{ATTRIBUTES, Triangle};
use pulp::cast;
use pulp::x86::V3;
use std::arch::x86_64::__m256i;
use std::array;

/// Fragments that are shaded together.
pub(crate) const BATCH: usize = 1024;

/// Visible fragments of one level of the normal map, a column for each attribute.
pub(crate) struct Columns {
    pub(crate) count: usize,
    pub(crate) attributes: [Vec<f32>; ATTRIBUTES],
    pub(crate) handedness: Vec<f32>,
    /// Weights of the two levels.
    pub(crate) weights: [Vec<f32>; 2],
    /// Places in the picture.
    pub(crate) places: Vec<u32>,
    /// Numbers of the triangles.
    pub(crate) triangles: Vec<u32>,
}

impl Columns {
    pub(crate) fn new() -> Self {
        let room = BATCH + 2 * LANES;
        let floats = || vec![0.0; room];
        Self {
            count: 0,
            attributes: array::from_fn(|_| floats()),
            handedness: floats(),
            weights: [floats(), floats()],
            places: vec![0; room],
            triangles: vec![0; room],
        }
    }

    /// Appends the visible fragments of a block.
    #[inline(always)]
    pub(crate) fn push(&mut self, simd: V3, triangle: &Triangle, block: &Block) {
        if block.visible == 0 {
            return;
        }
        let (avx, avx2) = (simd.avx, simd.avx2);
        let order: __m256i = cast(PACKED[usize::from(block.visible)]);
        let at = self.count;
        let store = |to: &mut [f32], lanes: F32x8| to[at..][..LANES].copy_from_slice(&lanes.to_array());
        let shares = three(|i| block.areas[i] * triangle.inverse_w[i]);
        let scale = F32x8::splat(simd, 1.0) / (shares[0] + shares[1] + shares[2]);
        let (second, third) = (shares[1] * scale, shares[2] * scale);
        for (column, [value, by_second, by_third]) in self.attributes.iter_mut().zip(triangle.attributes) {
            let lanes = second * by_second + value + third * by_third;
            store(column, F32x8::new(simd, avx2._mm256_permutevar8x32_ps(lanes.lanes, order)));
        }
        store(&mut self.handedness, F32x8::splat(simd, triangle.handedness));
        store(&mut self.weights[0], F32x8::splat(simd, triangle.weights[0]));
        store(&mut self.weights[1], F32x8::splat(simd, triangle.weights[1]));
        let places = I32x8::splat(simd, block.place as i32) + I32x8::new(simd, order);
        write(&mut self.places[at..], places.lanes);
        write(&mut self.triangles[at..], avx._mm256_set1_epi32(triangle.number as i32));
        self.count += block.visible.count_ones() as usize;
    }

    /// Removes the first fragments.
    pub(crate) fn remove(&mut self, count: usize) {
        let of = count..self.count;
        let floats = self.attributes.iter_mut().chain([&mut self.handedness]).chain(&mut self.weights);
        floats.for_each(|column| column.copy_within(of.clone(), 0));
        [&mut self.places, &mut self.triangles].into_iter().for_each(|column| column.copy_within(of.clone(), 0));
        self.count -= count;
    }
}

/// Order of the lanes of each mask, set ones first.
static PACKED: [[u32; LANES]; 256] = packed();

const fn packed() -> [[u32; LANES]; 256] {
    let mut orders = [[0; LANES]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut count) = (0, 0);
        while lane < LANES {
            if mask >> lane & 1 == 1 {
                orders[mask][count] = lane as u32;
                count += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    orders
}

/// Reads the eight numbers at the start of a slice.
#[inline(always)]
pub(crate) fn read(from: &[u32]) -> __m256i {
    let eight: [u32; LANES] = array::from_fn(|i| from[..LANES][i]);
    cast(eight)
}

/// Writes eight numbers to the start of a slice.
#[inline(always)]
pub(crate) fn write(to: &mut [u32], lanes: __m256i) {
    let eight: [u32; LANES] = cast(lanes);
    to[..LANES].copy_from_slice(&eight);
}
