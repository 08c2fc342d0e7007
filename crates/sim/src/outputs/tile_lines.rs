//! Reference buffer and tiles as JSON lines.

use basrelief_deferred_renderer::{FilledBuffer, TileOrigin, TileRecord};
use serde::Serialize;
use std::io::{self, Write};

/// A textured pixel of the reference buffer (126).
#[derive(Serialize)]
struct PixelLine {
    /// Omitted for the first frame.
    #[serde(skip_serializing_if = "is_zero")]
    frame: u32,
    x: u32,
    y: u32,
    texture: u32,
    s: f32,
    t: f32,
    depth: f32,
}

/// A tile that a frame acquired or reused.
#[derive(Serialize)]
struct TileLine {
    /// Omitted for the first frame.
    #[serde(skip_serializing_if = "is_zero")]
    frame: u32,
    texture: u32,
    width: u32,
    height: u32,
    layer: u8,
    tile: u32,
    state: &'static str,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands references")]
fn is_zero(frame: &u32) -> bool {
    *frame == 0
}

fn line(out: &mut dyn Write, line: &impl Serialize) -> io::Result<()> {
    serde_json::to_writer(&mut *out, line)?;
    out.write_all(b"\n")
}

/// Writes one line per textured pixel: `{"x", "y", "texture", "s", "t", "depth"}`. Texture coordinates are in texels of the finest layer,
/// without a half-texel offset. Lines of later frames begin with `"frame"`.
pub(super) fn write_reference_buffer(filled: &FilledBuffer, out: &mut dyn Write) -> io::Result<()> {
    for (i, cell) in (0..).zip(&filled.cells) {
        let Some(page) = cell.page().and_then(|p| filled.pages.get(usize::from(p))) else { continue };
        let [s, t] = cell.coordinates;
        let (x, y) = (i % filled.width, i / filled.width);
        line(out, &PixelLine { frame: filled.frame, x, y, texture: page.texture, s, t, depth: cell.depth })?;
    }
    Ok(())
}

/// Writes one line per tile of a frame: `{"texture", "width", "height", "layer", "tile", "state"}`. The size is that of the texture. The
/// state is `loaded`, `synthesized` or `reused`. Lines of later frames begin with `"frame"`.
pub(super) fn write_tiles(frame: u32, tiles: &[TileRecord], out: &mut dyn Write) -> io::Result<()> {
    for TileRecord { page, tile, acquired } in tiles {
        let [width, height] = page.texture_size;
        let state = match acquired {
            Some(TileOrigin::Loaded) => "loaded",
            Some(TileOrigin::Synthesized) => "synthesized",
            None => "reused",
        };
        let layer = page.layer_of(*tile);
        line(out, &TileLine { frame, texture: page.texture, width, height, layer, tile: *tile, state })?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_deferred_renderer::{PyramidCut, ReferenceCell, TexturePage};
    use basrelief_signals::{Image, Sampler, Texture};
    use std::sync::Arc;

    fn page() -> Arc<TexturePage> {
        let levels = vec![Image { width: 100, height: 60, texels: vec![] }];
        let texture = Texture { id: 5, name: "t".into(), sampler: Sampler::default(), levels, offset: 0, elsewhere: None };
        Arc::new(TexturePage::new(0, &texture, PyramidCut::default(), 0))
    }

    fn buffer(frame: u32) -> FilledBuffer {
        let cells = vec![
            ReferenceCell::textured(0, [1.5, 2.25], 0.5, [255; 3]),
            ReferenceCell::direct([1, 2, 3]),
            ReferenceCell::default(),
        ];
        FilledBuffer { frame, width: 3, height: 1, pages: vec![page()], cells }
    }

    fn text(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> String {
        let mut bytes = Vec::new();
        write(&mut bytes).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    // Claim: as defer_writes_round_images_maps_and_dumps.
    #[test]
    fn textured_pixel_is_one_line() {
        let first = text(|out| write_reference_buffer(&buffer(0), out));
        assert_eq!(first, "{\"x\":0,\"y\":0,\"texture\":5,\"s\":1.5,\"t\":2.25,\"depth\":0.5}\n");
        assert!(text(|out| write_reference_buffer(&buffer(2), out)).starts_with("{\"frame\":2,\"x\":0,"));
    }

    // Claim: as defer_writes_round_images_maps_and_dumps.
    #[test]
    fn tile_is_one_line() {
        let record = |tile, acquired| TileRecord { page: page(), tile, acquired };
        let all = [record(0, Some(TileOrigin::Synthesized)), record(1, Some(TileOrigin::Loaded)), record(2, None)];
        let lines = text(|out| write_tiles(0, &all, out));
        let states: Vec<&str> = lines.lines().map(|l| l.rsplit('"').nth(1).unwrap()).collect();
        assert_eq!(states, ["synthesized", "loaded", "reused"]);
        let second = "{\"texture\":5,\"width\":100,\"height\":60,\"layer\":1,\"tile\":1,\"state\":\"loaded\"}";
        assert_eq!(lines.lines().nth(1), Some(second));
        assert!(text(|out| write_tiles(3, &all, out)).starts_with("{\"frame\":3,\"texture\":5,"));
    }
}
