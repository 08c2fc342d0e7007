//! The input: polygons, normal map and tables of W1, and the picture of the machine.

use basrelief_bench::machines::demo_scene;
use basrelief_geometry_processor::SceneDraws;
use basrelief_machines::bump::{BumpProcessor, BumpProcessorConfig};
use basrelief_machines::{FrontEnd, MachineEngines as _, PictureMachine as _};
use basrelief_shading::{LEVELS, LightVector, brightness, light_vectors};
use basrelief_signals::{Control, Lighting, Material, Polygon, Scene};
use basrelief_sim::{MachineConfig, display_list};
use glam::Vec3;
use std::sync::Arc;

/// A level of the normal map.
pub(crate) struct MapLevel {
    /// Width and height, powers of two.
    pub(crate) size: [u32; 2],
    /// Red, green and blue in the low bytes.
    pub(crate) texels: Vec<u32>,
}

/// A drawing with one material, and one table and CLUT per level.
pub(crate) struct Drawing {
    /// Width and height of the picture.
    pub(crate) size: [usize; 2],
    pub(crate) material: Arc<Material>,
    pub(crate) map: Vec<MapLevel>,
    /// Reference normals by level.
    pub(crate) normals: Vec<Vec<[i16; 3]>>,
    /// Brightness by level and reference normal.
    pub(crate) brightness: Vec<Vec<f32>>,
    pub(crate) polygons: Vec<Arc<Polygon>>,
    /// The picture of the machine.
    pub(crate) picture: Vec<[u8; 3]>,
}

impl Drawing {
    /// Makes the drawing of W1.
    pub(crate) fn w1() -> Self {
        let config = BumpProcessorConfig::default();
        let scene = Arc::new(demo_scene("sphere", [640, 480]));
        let (mut polygons, mut lights) = (vec![], vec![]);
        let mut frame = None;
        for control in display_list(&scene, &MachineConfig::Bump(config.clone())) {
            match control {
                Control::Frame(begun) => frame = Some(begun),
                Control::Object(object) => lights = frame.iter().flat_map(|frame| light_vectors(frame, object.centre)).collect(),
                Control::Polygon(polygon) => polygons.push(polygon),
                _ => (),
            }
        }
        let material = Arc::clone(&polygons[0].material);
        let of_one_kind = |polygon: &Arc<Polygon>| polygon.bump && polygon.material == material;
        assert!(polygons.iter().all(of_one_kind) && material.color_texture.is_none(), "W1 has one material without texture");
        let normals = normals(&config);
        let values = |level: &Vec<[i16; 3]>| entries(level, &material.lighting, &lights, config.brightness.bits);
        Self {
            size: [640, 480],
            map: map(&material),
            brightness: normals.iter().map(values).collect(),
            normals,
            polygons,
            picture: picture(&scene, &config),
            material,
        }
    }
}

fn map(material: &Material) -> Vec<MapLevel> {
    let levels = material.normal_map.iter().flat_map(|map| &map.levels);
    let packed = |[red, green, blue, _]: [u8; 4]| u32::from_le_bytes([red, green, blue, 0]);
    levels
        .map(|level| MapLevel { size: [level.width, level.height], texels: level.texels.iter().copied().map(packed).collect() })
        .collect()
}

fn normals(config: &BumpProcessorConfig) -> Vec<Vec<[i16; 3]>> {
    let tables = config.replacement.table_set();
    let of = |level| tables.normals(level, tables.entries(level, None)).expect("the default tables are there");
    (0..LEVELS as u8).map(of).collect()
}

/// Returns the brightness of each normal, rounded to a number of bits.
fn entries(normals: &[[i16; 3]], lighting: &Lighting, lights: &[LightVector], bits: u32) -> Vec<f32> {
    let steps = ((1 << bits) - 1) as f32;
    let intensity: f32 = lights.iter().map(|light| light.intensity).sum();
    let full = lighting.ka + (lighting.kd + lighting.ks) * intensity;
    let entry = |normal: &[i16; 3]| {
        let [diffuse, specular] = brightness(Vec3::from(normal.map(|c| f32::from(c) / 32_767.0)), lighting, lights);
        ((diffuse + specular) / full * steps).round().clamp(0.0, steps) / steps * full
    };
    normals.iter().map(entry).collect()
}

/// Draws the scene with the machine.
fn picture(scene: &Arc<Scene>, config: &BumpProcessorConfig) -> Vec<[u8; 3]> {
    let front = FrontEnd::of_scene(SceneDraws::new(Arc::clone(scene)), config);
    let mut machine = BumpProcessor::new(front, config).expect("the defaults fit together");
    machine.run_functional(&mut |_| true).expect("W1 runs to its end");
    machine.drain_finished().pop().expect("W1 has a frame").rgb
}
