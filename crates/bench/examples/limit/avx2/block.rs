//! Eight pixels of a row: coverage, depth and areas.

use super::columns::{read, write};
use super::lanes::{F32x8, LANES};
use super::shade::three;
use super::triangle::{Edge, MAX_DEPTH, Triangle};
use pulp::cast;
use pulp::x86::V3;
use std::arch::x86_64::{__m128i, __m256d, __m256i};

/// The picture under way. Each list has a few more pixels, so that eight can be read anywhere.
pub(crate) struct Canvas {
    depth: Vec<u32>,
    /// Number of the visible triangle at each pixel.
    pub(crate) visible: Vec<u32>,
    pub(crate) rgb: Vec<[u8; 3]>,
}

/// Eight pixels of a row.
pub(crate) struct Block {
    /// Place of the first pixel in the picture.
    pub(crate) place: usize,
    /// Mask of the visible fragments.
    pub(crate) visible: u8,
    /// Doubled areas opposite each vertex.
    pub(crate) areas: [F32x8; 3],
}

/// Growth of edge functions from lane to lane.
pub(crate) struct LaneSteps {
    coverage: [__m256i; 3],
    /// For the second and the third edge, four lanes each.
    areas: [[__m256d; 2]; 2],
}

impl LaneSteps {
    #[inline(always)]
    pub(crate) fn new(simd: V3, triangle: &Triangle) -> Self {
        let [_, second, third] = &triangle.edges;
        let four = |step: f64, first: f64| cast([first * step, (first + 1.0) * step, (first + 2.0) * step, (first + 3.0) * step]);
        let coverage = |edge: &Edge| {
            let lanes: __m256i = cast([0, 1, 2, 3, 4, 5, 6, 7]);
            simd.avx2._mm256_mullo_epi32(lanes, simd.avx._mm256_set1_epi32(edge.step[0] as i32))
        };
        Self {
            coverage: [coverage(&triangle.edges[0]), coverage(second), coverage(third)],
            areas: [second, third].map(|edge| [four(edge.per_column() as f64, 0.0), four(edge.per_column() as f64, 4.0)]),
        }
    }

    /// Returns a mask of the pixels from this one on whose centres the triangle covers.
    #[inline(always)]
    pub(crate) fn covered(&self, simd: V3, triangle: &Triangle, pixel: [i64; 2]) -> u8 {
        let (avx, avx2) = (simd.avx, simd.avx2);
        let at = |i: usize| {
            let first = triangle.edges[i].coverage(pixel) as i32;
            avx2._mm256_add_epi32(self.coverage[i], avx._mm256_set1_epi32(first))
        };
        let outside = avx2._mm256_or_si256(avx2._mm256_or_si256(at(0), at(1)), at(2));
        let inside = !avx._mm256_movemask_ps(avx._mm256_castsi256_ps(outside)) as u8;
        let columns = triangle.columns[1] - pixel[0];
        if columns < LANES as i64 { inside & ((1 << columns) - 1) } else { inside }
    }

    /// Tests the depths of the covered pixels from this one on.
    #[inline(always)]
    pub(crate) fn block(
        &self,
        simd: V3,
        triangle: &Triangle,
        pixel: [i64; 2],
        covered: u8,
        place: usize,
        canvas: &mut Canvas,
    ) -> Block {
        let (depth, areas) = self.depth(simd, triangle, pixel);
        Block { place, visible: canvas.test(simd, place, covered, depth, triangle.number), areas }
    }

    /// Returns the depths of eight pixels, and their doubled areas opposite each vertex.
    #[inline(always)]
    fn depth(&self, simd: V3, triangle: &Triangle, pixel: [i64; 2]) -> (__m256i, [F32x8; 3]) {
        let (avx, avx2) = (simd.avx, simd.avx2);
        let (low, low_areas) = self.half(simd, triangle, pixel, 0);
        let (high, high_areas) = self.half(simd, triangle, pixel, 1);
        let depth = avx2._mm256_max_epi32(avx._mm256_set_m128i(high, low), avx._mm256_set1_epi32(0));
        let depth = avx2._mm256_min_epu32(depth, avx._mm256_set1_epi32(MAX_DEPTH as i32));
        let single = |four| avx._mm256_cvtpd_ps(four);
        let areas = three(|i| F32x8::new(simd, avx._mm256_set_m128(single(high_areas[i]), single(low_areas[i]))));
        (depth, areas)
    }

    #[inline(always)]
    fn half(&self, simd: V3, triangle: &Triangle, pixel: [i64; 2], half: usize) -> (__m128i, [__m256d; 3]) {
        let avx = simd.avx;
        let splat = |number: f64| avx._mm256_set1_pd(number);
        let area = |i: usize| avx._mm256_add_pd(splat(triangle.edges[i + 1].at(pixel) as f64), self.areas[i][half]);
        let (second, third) = (area(0), area(1));
        let first = avx._mm256_sub_pd(avx._mm256_sub_pd(splat(triangle.doubled_area as f64), second), third);
        let share = |i: usize, area: __m256d| avx._mm256_mul_pd(area, splat(triangle.depths[i]));
        let depth = avx._mm256_add_pd(avx._mm256_add_pd(share(0, first), share(1, second)), share(2, third));
        (avx._mm256_cvttpd_epi32(avx._mm256_add_pd(depth, splat(0.5))), [first, second, third])
    }
}

impl Canvas {
    pub(crate) fn new(pixels: usize) -> Self {
        let room = pixels + LANES;
        Self { depth: vec![MAX_DEPTH; room], visible: vec![u32::MAX; room], rgb: vec![[0; 3]; pixels] }
    }

    /// Tests eight depths, and keeps the smaller ones. Returns a mask of the visible fragments.
    #[inline(always)]
    fn test(&mut self, simd: V3, place: usize, covered: u8, depth: __m256i, triangle: u32) -> u8 {
        let (avx, avx2) = (simd.avx, simd.avx2);
        let before: __m256i = read(&self.depth[place..]);
        let lane_bits: __m256i = cast([1, 2, 4, 8, 16, 32, 64, 128]);
        let is_covered =
            avx2._mm256_cmpeq_epi32(avx2._mm256_and_si256(avx._mm256_set1_epi32(i32::from(covered)), lane_bits), lane_bits);
        let is_visible = avx2._mm256_and_si256(avx2._mm256_cmpgt_epi32(before, depth), is_covered);
        write(&mut self.depth[place..], avx2._mm256_blendv_epi8(before, depth, is_visible));
        let number = avx._mm256_set1_epi32(triangle as i32);
        let visible = avx2._mm256_blendv_epi8(read(&self.visible[place..]), number, is_visible);
        write(&mut self.visible[place..], visible);
        avx._mm256_movemask_ps(avx._mm256_castsi256_ps(is_visible)) as u8
    }
}
