//! First pass: coverage, depth, and the attributes of visible fragments, packed into columns.

use crate::drawing::Drawing;
use crate::lanes::{F32x8, I32x8, LANES};
use crate::search::NormalGrid;
use crate::shade::{Shading, three};
use crate::triangle::{ATTRIBUTES, Edge, MAX_DEPTH, Triangle, triangles};
use pulp::x86::V3;
use pulp::{NullaryFnOnce, cast};
use std::arch::x86_64::{__m128i, __m256d, __m256i};
use std::array;

/// Fragments that are shaded together.
const BATCH: usize = 1024;
/// Numbers of triangles per polygon.
const PER_POLYGON: u32 = 16;

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

/// The picture under way. Each list has a few more pixels, so that eight can be read anywhere.
pub(crate) struct Canvas {
    depth: Vec<u32>,
    /// Number of the visible triangle at each pixel.
    pub(crate) visible: Vec<u32>,
    pub(crate) rgb: Vec<[u8; 3]>,
}

/// Draws the picture. Also returns the number of fragments.
pub(crate) struct Drawer<'a>(pub(crate) V3, pub(crate) &'a Drawing);

impl NullaryFnOnce for Drawer<'_> {
    type Output = (Vec<[u8; 3]>, u64);

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self(simd, drawing) = self;
        let mut canvas = Canvas::new(drawing.size[0] * drawing.size[1]);
        let mut grids: Vec<NormalGrid> = drawing.normals.iter().map(|normals| NormalGrid::new(normals)).collect();
        let mut levels: Vec<Columns> = (0..grids.len()).map(|_| Columns::new()).collect();
        let mut fragments = 0;
        let mut shade = |level: usize, columns: &mut Columns, count: usize, canvas: &mut Canvas| {
            simd.vectorize(Shading { simd, drawing, level, columns, count, grids: &mut grids, canvas });
        };
        for (polygon, number) in drawing.polygons.iter().zip(0..) {
            for triangle in triangles(polygon, drawing.size, number * PER_POLYGON) {
                let columns = &mut levels[triangle.level];
                let steps = LaneSteps::new(simd, &triangle);
                for y in triangle.rows[0]..triangle.rows[1] {
                    for x in (triangle.columns[0]..triangle.columns[1]).step_by(LANES) {
                        let covered = steps.covered(simd, &triangle, [x, y]);
                        fragments += u64::from(covered.count_ones());
                        if covered == 0 {
                            continue;
                        }
                        let block = steps.block(simd, &triangle, [x, y], (covered, &mut canvas, drawing.size[0]));
                        columns.push(simd, &triangle, &block);
                        if columns.count > BATCH {
                            shade(triangle.level, columns, columns.count / LANES * LANES, &mut canvas);
                        }
                    }
                }
            }
        }
        levels.iter_mut().enumerate().for_each(|(level, columns)| shade(level, columns, columns.count, &mut canvas));
        (canvas.rgb, fragments)
    }
}

/// Eight pixels of a row.
pub(crate) struct Block {
    /// Place of the first pixel in the picture.
    place: usize,
    /// Mask of the visible fragments.
    visible: u8,
    /// Doubled areas opposite each vertex.
    areas: [F32x8; 3],
}

/// Growth of edge functions from lane to lane.
struct LaneSteps {
    coverage: [__m256i; 3],
    /// For the second and the third edge, four lanes each.
    areas: [[__m256d; 2]; 2],
}

impl LaneSteps {
    #[inline(always)]
    fn new(simd: V3, triangle: &Triangle) -> Self {
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
    fn covered(&self, simd: V3, triangle: &Triangle, pixel: [i64; 2]) -> u8 {
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
    fn block(&self, simd: V3, triangle: &Triangle, pixel: [i64; 2], (covered, canvas, width): (u8, &mut Canvas, usize)) -> Block {
        let place = pixel[1] as usize * width + pixel[0] as usize;
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
    fn new(pixels: usize) -> Self {
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

#[inline(always)]
fn read(from: &[u32]) -> __m256i {
    let eight: [u32; LANES] = array::from_fn(|i| from[..LANES][i]);
    cast(eight)
}

#[inline(always)]
fn write(to: &mut [u32], lanes: __m256i) {
    let eight: [u32; LANES] = cast(lanes);
    to[..LANES].copy_from_slice(&eight);
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

impl Columns {
    fn new() -> Self {
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
    fn push(&mut self, simd: V3, triangle: &Triangle, block: &Block) {
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
