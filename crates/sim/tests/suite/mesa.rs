//! The machines' own pictures against Mesa, drawn by an independent tool from the same model file: textures alone.

#[path = "../../../reference/tests/suite/mesa/tool.rs"]
mod tool;

use basrelief_reference::{RenderOptions, RenderStyle, RgbPicture, ShadingModel, TextureFilter};
use basrelief_signals::Scene;
use basrelief_sim::{FramePictures, MachineInfo, Observer, RunInput, RunOptions, run};
use std::path::Path;
use std::sync::Arc;
use tool::{Mesa, agreement, double_sided, foreign_models, load, models, name_of};

/// Keeps the machine's image.
#[derive(Default)]
struct Kept(Option<RgbPicture>);

impl Observer for Kept {
    fn frame(&mut self, pictures: &FramePictures<'_>) -> Result<(), String> {
        self.0 = Some(pictures.machine.clone());
        Ok(())
    }
}

/// Draws a scene on the functional model with these settings.
fn draw(machine: &str, settings: &[(&str, &str)], scene: &Arc<Scene>) -> RgbPicture {
    let config = MachineInfo::named(machine).expect("a machine").load("", settings).expect("valid parameters");
    let settings = RunOptions { config, engine: None, exact: false, ..RunOptions::default() };
    let mut kept = Kept::default();
    run(RunInput::scene(Arc::clone(scene)), &settings, &mut kept, None).expect("a picture");
    kept.0.expect("a picture")
}

/// With textures that have many texels per pixel, few of them, and that repeat; their sides are powers of two.
const MODELS: [&str; 4] = [
    "Avocado/Avocado.gltf",
    "TwoSidedPlane/TwoSidedPlane.gltf",
    "TextureCoordinateTest/TextureCoordinateTest.gltf",
    "ClearcoatWicker.glb",
];

/// Draws a model with the machine and with Mesa; PSNR inside the common coverage \[dB\].
fn decibels(mesa: &Mesa, path: &Path, machine: &str, settings: &[(&str, &str)], filter: TextureFilter) -> f64 {
    let model = name_of(path);
    let scene = Arc::new(double_sided(&load(path)));
    let style = RenderStyle { shading: ShadingModel::Texture, options: RenderOptions { filter, ..RenderOptions::default() } };
    let (db, differing) = agreement(&draw(machine, settings, &scene), &mesa.draw(path, style, false));
    println!("{machine} {settings:?}, {model}: {db:.2} dB, {:.4} % of coverage differs", 100.0 * differing);
    assert!(differing <= 0.001, "{machine}, {model}: {differing} of the coverage differs");
    db
}

/// Measured: 51.8 to 75.3 dB. On the avocado it is two pixels on edges between skin and flesh: window positions of single
/// precision, half a step of the grid of 1/256 pixel from it, snap the other way. Without the two it is 70.8 dB.
// Claim: texel, exact mapping: Device images agree with Mesa, bilinear: at least 51.8 dB on four models (45 required).
#[test]
fn texture_mapping_system_matches_mesa() {
    let Some(mesa) = Mesa::find() else { return };
    let exact = &[("texel.method", "exact"), ("illuminance.mode", "off"), ("look_up.filter", "bilinear")][..];
    for model in models(&MODELS) {
        let db = decibels(&mesa, &model, "texel", exact, TextureFilter::Bilinear);
        assert!(db >= 45.0, "{}: {db:.2} dB", model.display());
    }
}

/// Measured: 48.2 to 61.8 dB with the standard tiles. The pyramid ends with one tile of 64 x 64 texels (section 3), and
/// Mesa's pyramid with one texel. If a pixel spans more, at the rim of the wicker ball, the machine takes the top tile. With tiles of
/// 4 x 4 there is a coarser one: 56.1 dB. The remaining differences are derivatives and means of texels: Mesa takes derivatives as
/// differences between neighbouring pixels, and rounds means differently. The reference image differs by as much.
// Claim: defer, modes: Images agree with Mesa, trilinear: at least 48.2 dB on four models (45 required).
#[test]
fn rate_limited_renderer_matches_mesa() {
    let Some(mesa) = Mesa::find() else { return };
    let small_tiles = &[("tile.width", "4"), ("tile.height", "4")][..];
    for model in models(&MODELS) {
        // Its textures are smaller than a standard tile, so only small tiles give it a pyramid.
        let is_alcove = name_of(&model) == "alcove.gltf";
        let settings = if is_alcove { small_tiles } else { &[] };
        let db = decibels(&mesa, &model, "defer", settings, TextureFilter::Trilinear);
        assert!(db >= 45.0, "{}: {db:.2} dB", model.display());
    }
    let Some(folder) = foreign_models() else { return };
    let db = decibels(&mesa, &folder.join("ClearcoatWicker.glb"), "defer", small_tiles, TextureFilter::Trilinear);
    assert!(db >= 54.0, "tiles of 4 x 4: {db:.2} dB");
}
