//! Host speed of the figure shading device: a curved sheet of 102,400 dots in quads of 64, drawn ten times over.
//!
//! `cargo run --release -p basrelief-machines --example shade_speed [KEY=VALUE ...]`

use basrelief_kernel::{Engine, run, run_functional};
use basrelief_machines::shade::{FigureShadingDevice, FrontEnd, ShadeConfig, TraceFront};
use basrelief_signals::{Camera, Control, Frame, Light, LightKind, Polygon, Vertex};
use std::sync::Arc;
use std::time::Instant;

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
        let begin = Control::Frame(Arc::new(Frame { index, width: SIDE, height: SIDE, camera, lights, textures: Vec::new() }));
        let places = (0..SIDE).step_by(QUAD as usize).flat_map(|y| (0..SIDE).step_by(QUAD as usize).map(move |x| (x, y)));
        std::iter::once(begin).chain(places.map(|(x, y)| quad(x, y))).chain([Control::FrameEnd])
    })
}

fn machine(config: &ShadeConfig) -> Result<FigureShadingDevice<impl FrontEnd>, String> {
    let controls: Vec<Control> = display_list(10).collect();
    let front = TraceFront::new(controls.into_iter().map(|c| Ok::<_, String>((c, None))), config);
    FigureShadingDevice::new(front, config).map_err(|e| e.to_string())
}

fn main() -> Result<(), String> {
    let settings: Vec<String> = std::env::args().skip(1).collect();
    let settings: Vec<(&str, &str)> = settings.iter().filter_map(|s| s.split_once('=')).collect();
    let config: ShadeConfig = basrelief_parameters::load("", &settings).map_err(|e| e.to_string())?;
    let mut timed = machine(&config)?;
    let began = Instant::now();
    let report = run(&mut timed, Engine::Timed);
    let timed_s = began.elapsed().as_secs_f64();
    let mut functional = machine(&config)?;
    let began = Instant::now();
    run_functional(&mut functional, &mut |_| true)?;
    let functional_s = began.elapsed().as_secs_f64();
    let dots = timed.counts().number("fragments");
    println!("{:?}: {dots} dots, {} cycles", report.outcome, report.total);
    for (name, seconds) in [("timed", timed_s), ("functional", functional_s)] {
        println!("{name}: {seconds:.3} s, {:.2} M dots/s", dots as f64 / seconds * 1e-6);
    }
    Ok(())
}
