//! Second pass: normals of the map, rotation, search, brightness and blending of fragments in columns.

use super::block::Canvas;
use super::columns::Columns;
use super::drawing::{Drawing, MapLevel};
use super::lanes::{F32x8, I32x8, LANES};
use super::search::NormalGrid;
use pulp::NullaryFnOnce;
use pulp::x86::V3;

/// Shades the first fragments of a level, and removes them.
pub(crate) struct Shading<'a> {
    pub(crate) simd: V3,
    pub(crate) drawing: &'a Drawing,
    pub(crate) level: usize,
    pub(crate) columns: &'a mut Columns,
    pub(crate) count: usize,
    pub(crate) grids: &'a mut [NormalGrid],
    pub(crate) canvas: &'a mut Canvas,
}

impl NullaryFnOnce for Shading<'_> {
    type Output = ();

    #[inline(always)]
    fn call(mut self) {
        for first in (0..self.count).step_by(LANES) {
            let fragments = LANES.min(self.count - first);
            let brightness = self.brightness(first, fragments);
            self.write(first, fragments, brightness);
        }
        self.columns.remove(self.count);
    }
}

impl Shading<'_> {
    /// Returns the brightness of eight fragments, of which these are used.
    #[inline(always)]
    fn brightness(&mut self, first: usize, fragments: usize) -> F32x8 {
        let (simd, map) = (self.simd, &self.drawing.map);
        let read = |column: &[f32]| F32x8::read(simd, &column[first..]);
        let attribute = |i: usize| read(&self.columns.attributes[i]);
        let (normal, tangent) = (three(attribute), three(|i| attribute(3 + i)));
        let frame = TangentFrame::new(normal, tangent, read(&self.columns.handedness));
        let coordinates = [wrapped(simd, attribute(6)), wrapped(simd, attribute(7))];
        let mut sum = F32x8::splat(simd, 0.0);
        for (i, weights) in self.columns.weights.iter().enumerate() {
            let level = (self.level + i).min(map.len() - 1);
            let sample = sample(simd, &map[level], coordinates);
            let normal = quantized(simd, frame.rotated(sample, self.drawing.material.normal_scale));
            let grid = &mut self.grids[level];
            let cells = grid.cells_of(simd, three(|i| normal[i].to_floats())).to_array();
            let [x, y, z] = three(|i| normal[i].to_array());
            let table = &self.drawing.brightness[level];
            let mut values = [0.0; LANES];
            for (lane, value) in values[..fragments].iter_mut().enumerate() {
                let normal = [x[lane] as i16, y[lane] as i16, z[lane] as i16];
                *value = table[usize::from(grid.nearest(simd, cells[lane] as u32, normal))];
            }
            sum = sum + read(weights) * F32x8::read(simd, &values);
        }
        sum
    }

    /// Writes the fragments that are still visible.
    #[inline(always)]
    fn write(&mut self, first: usize, fragments: usize, brightness: F32x8) {
        let s = |number| F32x8::splat(self.simd, number);
        let [red, green, blue] = three(
            #[inline(always)]
            |i| {
                let bright = s(self.drawing.material.base_color[i]) * brightness + 0.0;
                (bright * 255.0 + 0.5).max(s(0.0)).min(s(255.0)).truncate().to_array()
            },
        );
        for lane in 0..fragments {
            let place = self.columns.places[first + lane] as usize;
            if self.canvas.visible[place] == self.columns.triangles[first + lane] {
                self.canvas.rgb[place] = [red[lane] as u8, green[lane] as u8, blue[lane] as u8];
            }
        }
    }
}

/// Makes three values, in line.
#[inline(always)]
pub(crate) fn three<T>(make: impl Fn(usize) -> T) -> [T; 3] {
    [make(0), make(1), make(2)]
}

/// Wraps coordinates to 0..=1.
#[inline(always)]
fn wrapped(simd: V3, coordinate: F32x8) -> F32x8 {
    let fraction = coordinate - coordinate.floor();
    let zero = F32x8::splat(simd, 0.0);
    fraction.gt(zero).select(fraction, zero).min(F32x8::splat(simd, 1.0))
}

/// Normal, bitangent and tangent of eight fragments.
struct TangentFrame {
    normal: [F32x8; 3],
    bitangent: [F32x8; 3],
    tangent: [F32x8; 3],
}

impl TangentFrame {
    #[inline(always)]
    fn new(normal: [F32x8; 3], tangent: [F32x8; 3], handedness: F32x8) -> Self {
        let ([nx, ny, nz], [tx, ty, tz]) = (normal, tangent);
        let cross = [ny * tz - nz * ty, nz * tx - nx * tz, nx * ty - ny * tx];
        Self { normal, bitangent: three(|i| cross[i] * handedness), tangent }
    }

    /// Rotates the normal that eight texels encode.
    #[inline(always)]
    fn rotated(&self, texel: [F32x8; 3], scale: f32) -> [F32x8; 3] {
        let [x, y, z] = three(|i| texel[i] * (1.0 / 127.5) - 1.0);
        let (x, y) = (x * scale, y * scale);
        three(|i| self.tangent[i] * x + self.bitangent[i] * y + self.normal[i] * z)
    }
}

/// Returns bilinear samples of eight fragments, in steps of a channel.
#[inline(always)]
fn sample(simd: V3, level: &MapLevel, [u, v]: [F32x8; 2]) -> [F32x8; 3] {
    let ([left, right], x) = texels(simd, u, level.size[0]);
    let ([top, bottom], y) = texels(simd, v, level.size[1]);
    let shift = level.size[0].trailing_zeros();
    let (top, bottom) = (top.shift_left(shift), bottom.shift_left(shift));
    let one = F32x8::splat(simd, 1.0);
    let weighted = |place: I32x8, weight: F32x8| {
        let texel = channels(simd, level, place);
        three(|i| texel[i] * weight)
    };
    let (a, b) = (weighted(top + left, (one - x) * (one - y)), weighted(top + right, x * (one - y)));
    let (c, d) = (weighted(bottom + left, (one - x) * y), weighted(bottom + right, x * y));
    three(|i| (a[i] + b[i]) + (c[i] + d[i]))
}

/// Returns the two texels around each coordinate, and the place between them.
#[inline(always)]
fn texels(simd: V3, coordinate: F32x8, size: u32) -> ([I32x8; 2], F32x8) {
    let size = size as f32;
    let place = coordinate * size - 0.5;
    let first = place.small_floor();
    let next = first + 1.0;
    let zero = F32x8::splat(simd, 0.0);
    let wrapped_first = first.lt(zero).select(first + size, first);
    let wrapped_next = next.ge(F32x8::splat(simd, size)).select(next - size, next);
    ([wrapped_first.round_to_int(), wrapped_next.round_to_int()], place - first)
}

/// Reads eight texels.
#[inline(always)]
fn channels(simd: V3, level: &MapLevel, places: I32x8) -> [F32x8; 3] {
    let texels = places.to_array().map(|place| level.texels[place as usize]);
    let texels = I32x8::new(simd, pulp::cast(texels));
    let channels = [texels & 255, texels.shift_right::<8>() & 255, texels.shift_right::<16>()];
    three(|i| channels[i].to_floats())
}

/// Scales normals so that the largest component is 32767. Normals without a direction become zero.
#[inline(always)]
fn quantized(simd: V3, normal: [F32x8; 3]) -> [I32x8; 3] {
    let [x, y, z] = normal;
    let s = |number| F32x8::splat(simd, number);
    let largest = x.abs().max(y.abs()).max(z.abs());
    let is_sound = (x + y + z).abs().le(largest * 3.0) & largest.ge(s(1e-30)) & largest.le(s(1e30));
    let scale = s(32_767.0) / largest;
    three(|i| (is_sound & (normal[i] * scale)).round_to_int().sign_extend_16())
}
