//! Pictures of what a machine shows beside its own.

use basrelief_reference::Picture;
use basrelief_session::{Exhibit, layer_depth_picture, tile_map_picture};

/// The picture that an exhibit makes, and its name.
pub fn picture(exhibit: &Exhibit) -> Option<(String, Picture)> {
    match exhibit {
        Exhibit::Round(shown) => {
            let p = &shown.picture;
            let picture = Picture { width: p.width, height: p.height, rgb: p.rgb.clone(), covered: p.covered.clone() };
            Some((round_name(p.index, shown.round), picture))
        }
        Exhibit::ReferenceBuffer(filled) => Some((depth_name(filled.frame), layer_depth_picture(filled))),
        Exhibit::TileLists(lists) => Some(("tiles.png".into(), tile_map_picture(lists))),
        Exhibit::Tiles { .. } => None,
    }
}

/// `image-round-0.png`, and with the number of the frame for all but the first.
pub fn round_name(frame: u32, round: u32) -> String {
    if frame == 0 { format!("image-round-{round}.png") } else { format!("image-{:04}-round-{round}.png", frame + 1) }
}

/// `layer-depth.png`, and with the number of the frame for all but the first.
fn depth_name(frame: u32) -> String {
    if frame == 0 { "layer-depth.png".into() } else { format!("layer-depth-{:04}.png", frame + 1) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_of_later_frames_carry_their_number() {
        assert_eq!([round_name(0, 2), round_name(4, 0)], ["image-round-2.png", "image-0005-round-0.png"]);
        assert_eq!([depth_name(0), depth_name(1)], ["layer-depth.png", "layer-depth-0002.png"]);
    }
}
