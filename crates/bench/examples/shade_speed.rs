//! Host speed of the figure shading device: a curved sheet of 102,400 dots in quads of 64, drawn ten times over.
//!
//! `cargo run --release -p basrelief-bench --example shade_speed [KEY=VALUE ...]`

mod speed;

use basrelief_machines::shade::{FigureShadingDevice, ShadeConfig};
use basrelief_signals::{Camera, Control, Frame, Light, LightKind, Polygon, Vertex};
use std::sync::Arc;

/// Side of the picture and of a quad \[pixels\].
const SIDE: u32 = 320;
const QUAD: u32 = 8;

/// A sheet that is curved to and fro.
fn vertex(x: u32, y: u32) -> Vertex {
    let slope = |c: u32| (c % 160) as f32 / 160.0 - 0.5;
    let normal = glam::Vec3::new(slope(x), slope(y), 1.0).normalize().to_array();
    Vertex { position: [x as f32, y as f32, 0.5, 1.0], normal, ..Vertex::default() }
}

fn quad(x: u32, y: u32) -> Control {
    let corners = [[x, y], [x + QUAD, y], [x + QUAD, y + QUAD], [x, y + QUAD]];
    let vertices = corners.map(|[x, y]| vertex(x, y)).to_vec();
    Control::Polygon(Arc::new(Polygon { vertices, material: Arc::default(), object: 0, lod: 0, bump: false, arrival: 0 }))
}

fn display_list(frames: u32) -> impl Iterator<Item = Control> {
    (0..frames).flat_map(|index| {
        let camera = Camera { view_projection: [0.0; 16], to_light: [0.0, 0.0, 1.0], to_viewer: [0.0, 0.0, 1.0] };
        let lights = vec![Light { kind: LightKind::Directional { to_light: [0.36, 0.48, 0.8] }, intensity: 1.0 }];
        let begin = Control::Frame(Arc::new(Frame {
            index,
            width: SIDE,
            height: SIDE,
            camera,
            lights,
            textures: Vec::new(),
            shading: Default::default(),
        }));
        let places = (0..SIDE).step_by(QUAD as usize).flat_map(|y| (0..SIDE).step_by(QUAD as usize).map(move |x| (x, y)));
        std::iter::once(begin).chain(places.map(|(x, y)| quad(x, y))).chain([Control::FrameEnd])
    })
}

fn main() -> Result<(), String> {
    let config: ShadeConfig = speed::config()?;
    let controls: Vec<Control> = display_list(10).collect();
    speed::print_speed(|| FigureShadingDevice::new(speed::replay(&controls, &config), &config), "fragments", "dots")
}
