//! Areas of polygons on the screen and in a texture, and the level of detail computed from them.

use crate::lod::lod;
use basrelief_signals::{Texture, Vertex};

/// Returns twice the signed area of a polygon. It is positive if the corners run from x towards y (clockwise on the screen, where
/// y runs down). Coordinates are taken relative to the first corner, so that a position far from the origin costs no precision.
pub fn doubled_area(corners: impl IntoIterator<Item = [f32; 2]>) -> f32 {
    let mut corners = corners.into_iter();
    let Some(origin) = corners.next() else { return 0.0 };
    let mut offsets = corners.map(|[x, y]| [x - origin[0], y - origin[1]]);
    let Some(mut last) = offsets.next() else { return 0.0 };
    let mut area = 0.0;
    for next in offsets {
        area += last[0] * next[1] - next[0] * last[1];
        last = next;
    }
    area
}

/// Returns the LOD of a polygon in window coordinates for `texture`, mapped by `uv`. It follows from the area ratio of the whole
/// polygon.
pub fn polygon_lod(vertices: &[Vertex], texture: &Texture, uv: impl Fn(&Vertex) -> [f32; 2]) -> u8 {
    let Some(finest) = texture.levels.first() else { return 0 };
    let pixels = doubled_area(vertices.iter().map(|v| [v.position[0], v.position[1]])).abs();
    let texels = doubled_area(vertices.iter().map(uv)).abs() * finest.width as f32 * finest.height as f32;
    lod(texels, pixels)
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_signals::{Image, Sampler};

    #[test]
    fn area_is_signed_and_translation_invariant() {
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 3.0], [0.0, 3.0]];
        assert_eq!(doubled_area(square), 12.0);
        assert_eq!(doubled_area(square.into_iter().rev()), -12.0);
        assert_eq!(doubled_area(square.map(|[x, y]| [x + 4096.0, y - 8192.0])), 12.0);
        assert_eq!(doubled_area(square.into_iter().take(2)), 0.0);
    }

    #[test]
    fn lod_follows_area_ratio() {
        let vertex =
            |x: f32, y: f32| Vertex { position: [x + 100.0, y + 50.0, 0.5, 1.0], uv: [x / 64.0, y / 64.0], ..Vertex::default() };
        let polygon = [vertex(0.0, 0.0), vertex(16.0, 0.0), vertex(16.0, 16.0), vertex(0.0, 16.0)];
        let at = |side: u32| {
            let texels = Vec::new();
            let levels = vec![Image { width: side, height: side, texels }];
            let texture = Texture { id: 0, name: String::new(), sampler: Sampler::default(), levels, offset: 0, elsewhere: None };
            polygon_lod(&polygon, &texture, |v| v.uv)
        };
        assert_eq!([at(32), at(64), at(128), at(256)], [0, 0, 8, 16]);
    }
}
