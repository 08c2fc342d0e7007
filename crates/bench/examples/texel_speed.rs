//! Host speed of the texture mapping system: a floor of 640 x 480 pixels that runs away, drawn twenty times over.
//!
//! `cargo run --release -p basrelief-bench --example texel_speed [KEY=VALUE ...]`

mod speed;

use basrelief_machines::texel::{TexelMachineConfig, TextureMappingSystem};
use basrelief_signals::{Camera, Control, Frame, Image, Light, LightKind, Material, Polygon, Sampler, Texture, Vertex};
use std::sync::Arc;

/// Size of the picture \[pixels\].
const SIZE: [u32; 2] = [640, 480];
/// Side of the texture \[texels\].
const SIDE: u32 = 256;

fn texture() -> Arc<Texture> {
    let level = |k: u32| {
        let side = SIDE >> k;
        Image {
            width: side,
            height: side,
            texels: (0..side * side).map(|i| [i as u8, (i >> 8) as u8, (i * 7) as u8, 255]).collect(),
        }
    };
    let levels = (0..=SIDE.ilog2()).map(level).collect();
    Arc::new(Texture { id: 0, name: "t".into(), sampler: Sampler::default(), levels, offset: 0, elsewhere: None })
}

/// A quad as large as the picture, ten times as far away at its right end, turned a little.
fn floor() -> Polygon {
    let [width, height] = SIZE.map(|side| side as f32);
    let corner = |x: f32, y: f32| {
        let w = 1.0 - 0.9 * x;
        Vertex { position: [x * width, y * height, 0.5, w], uv: [0.3 * x / w + 0.1 * y, (y - 0.5) / w], ..Vertex::default() }
    };
    let vertices = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| corner(x, y)).to_vec();
    let material = Arc::new(Material { color_texture: Some(texture()), ..Material::default() });
    Polygon { vertices, material, object: 0, lod: 0, bump: false, arrival: 0 }
}

fn display_list(frames: u32) -> Vec<Control> {
    let [width, height] = SIZE;
    let floor = Arc::new(floor());
    let frame = |index| {
        let camera = Camera { view_projection: [0.0; 16], to_light: [0.0, 0.0, 1.0], to_viewer: [0.0, 0.0, 1.0] };
        let lights = vec![Light { kind: LightKind::Directional { to_light: [0.36, 0.48, 0.8] }, intensity: 1.0 }];
        let begin = Control::Frame(Arc::new(Frame {
            index,
            width,
            height,
            camera,
            lights,
            textures: Vec::new(),
            shading: Default::default(),
        }));
        [begin, Control::Polygon(Arc::clone(&floor)), Control::FrameEnd]
    };
    (0..frames).flat_map(frame).collect()
}

fn main() -> Result<(), String> {
    let config: TexelMachineConfig = speed::config()?;
    let controls: Vec<Control> = display_list(20);
    speed::print_speed(|| TextureMappingSystem::new(speed::replay(&controls, &config), &config), "fragments", "pixels")
}
