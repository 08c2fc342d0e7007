//! Host speed of the rate-limited renderer: a floor of textured quads to the horizon and a wall behind it, 640 x 480, ten views.
//!
//! `cargo run --release -p basrelief-bench --example defer_speed [KEY=VALUE ...]`

mod speed;

use basrelief_machines::defer::{DeferConfig, DeferredRenderer};
use basrelief_signals::{Camera, Control, Frame, Image, Material, Polygon, Sampler, Texture, Vertex};
use std::sync::Arc;

/// Picture \[pixels\].
const SIZE: [u32; 2] = [640, 480];
/// Side of a quad on the screen \[pixels\].
const QUAD: u32 = 32;

fn material(id: u32) -> Arc<Material> {
    let texel = |i: u32| [(i * 7) as u8, (i / 512) as u8, (i ^ i >> 9) as u8, 255];
    let levels = vec![Image { width: 512, height: 512, texels: (0..512 * 512).map(texel).collect() }];
    let texture = Texture { id, name: format!("texture {id}"), sampler: Sampler::default(), levels, offset: 0, elsewhere: None };
    Arc::new(Material { color_texture: Some(Arc::new(texture)), ..Material::default() })
}

/// A corner of a sheet that is seen in perspective: further away towards the top.
fn vertex(x: u32, y: u32) -> Vertex {
    let q = 0.2 + 0.8 * y as f32 / SIZE[1] as f32;
    let uv = [x as f32 / (q * 400.0), 1.0 / q];
    Vertex { position: [x as f32, y as f32, 1.0 - q, q], uv, ..Vertex::default() }
}

fn quad(x: u32, y: u32, material: &Arc<Material>) -> Control {
    let corners = [[x, y], [x + QUAD, y], [x + QUAD, y + QUAD], [x, y + QUAD]];
    let vertices = corners.map(|[x, y]| vertex(x, y)).to_vec();
    let material = Arc::clone(material);
    Control::Polygon(Arc::new(Polygon { vertices, material, object: 0, lod: 0, bump: false, arrival: 0 }))
}

fn display_list(frames: u32) -> Vec<Control> {
    let materials: Vec<_> = (0..8).map(material).collect();
    let camera = Camera { view_projection: [0.0; 16], to_light: [0.0, 0.0, 1.0], to_viewer: [0.0, 0.0, 1.0] };
    let mut list = Vec::new();
    for index in 0..frames {
        list.push(Control::Frame(Arc::new(Frame {
            index,
            width: SIZE[0],
            height: SIZE[1],
            camera,
            lights: vec![],
            textures: Vec::new(),
            shading: Default::default(),
        })));
        for y in (0..SIZE[1]).step_by(QUAD as usize) {
            list.extend((0..SIZE[0]).step_by(QUAD as usize).map(|x| quad(x, y, &materials[((x + y) / 128) as usize % 8])));
        }
        list.push(Control::FrameEnd);
    }
    list
}

fn main() -> Result<(), String> {
    let config: DeferConfig = speed::config()?;
    let controls: Vec<Control> = display_list(10);
    speed::print_speed(|| DeferredRenderer::new(speed::replay(&controls, &config), &config), "pixels", "pixels")
}
