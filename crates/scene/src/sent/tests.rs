//! Scenes arrive as they were sent; other bytes are refused.

use super::*;
use crate::{MemoryFiles, ViewOptions};
use basrelief_signals::{Material, Scene, WrapMode};
use std::sync::Arc;

/// Test value for the hash of a picture.
fn hash(texture: &Texture) -> [u8; 32] {
    [texture.id as u8; 32]
}

fn sent(subject: &SceneSubject) -> Vec<u8> {
    subject.to_bytes(&mut |t| hash(t)).unwrap()
}

fn received(bytes: &[u8]) -> Result<SceneSubject, String> {
    SceneSubject::from_bytes(bytes, "there", &MemoryPool::default()).map(|(subject, _)| subject).map_err(|e| e.to_string())
}

/// The scene as the other side should see it.
fn without_texels(scene: Scene) -> Scene {
    let texture = |t: &Arc<Texture>| {
        let levels = t.levels[..1].iter().map(|l| basrelief_signals::Image { texels: vec![], ..*l }).collect();
        Arc::new(Texture { levels, name: t.name.clone(), elsewhere: Some(hash(t)), ..**t })
    };
    let object = |o: &Arc<basrelief_signals::Object>| {
        let mesh = Arc::new(Mesh { tangents: vec![], ..Mesh::clone(&o.mesh) });
        let (color, normal) = (o.material.color_texture.as_ref().map(texture), o.material.normal_map.as_ref().map(texture));
        let material = Arc::new(Material { color_texture: color, normal_map: normal, ..Material::clone(&o.material) });
        Arc::new(basrelief_signals::Object { mesh, material, ..(**o).clone() })
    };
    Scene { objects: scene.objects.iter().map(object).collect(), ..scene }
}

#[test]
fn sent_scene_arrives_unchanged_from_any_view() {
    let orbit = ViewOptions { frames: Some(3), orbit_degrees: Some(100.0), turn: Some([5.0, 7.0]), ..ViewOptions::default() };
    for name in ["mixed", "coin", "goblet@2", "turntable"] {
        let subject = SceneSubject::demo(name).unwrap();
        let there = received(&sent(&subject)).unwrap();
        for view in [&ViewOptions::default(), &orbit] {
            assert_eq!(there.seen(view).unwrap(), without_texels(subject.seen(view).unwrap()), "{name}");
        }
        assert_eq!(sent(&there), sent(&subject), "{name}");
    }
}

#[test]
fn shared_parts_are_sent_once() {
    let subject = SceneSubject::demo("gallery").unwrap();
    let there = received(&sent(&subject)).unwrap();
    let shared = |s: &SceneSubject| {
        let mut meshes: Vec<_> = s.objects.iter().map(|o| Arc::as_ptr(&o.mesh)).collect();
        meshes.sort_unstable();
        meshes.dedup();
        meshes.len()
    };
    assert_eq!(shared(&there), shared(&subject));
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn triangle() -> SceneSubject {
    let files = MemoryFiles::default();
    SceneSubject::load(TRIANGLE.as_bytes(), "t.obj", &files, &MemoryPool::default()).unwrap().0
}

#[test]
fn truncated_or_extended_scene_is_refused_with_its_place() {
    let bytes = sent(&triangle());
    for length in 0..bytes.len() {
        let error = received(&bytes[..length]).err().unwrap_or_else(|| panic!("{length} of {}", bytes.len()));
        assert!(error.starts_with("there: "), "{error}");
    }
    let error = received(&[&bytes[..], &[0]].concat()).err().unwrap();
    assert_eq!(error, "there: meshes: 1 bytes behind the last mesh; expected none");
}

#[test]
fn changed_byte_is_another_scene_or_an_error() {
    let bytes = sent(&triangle());
    for (i, bit) in (0..bytes.len()).flat_map(|i| (0..8).map(move |bit| (i, bit))) {
        let mut changed = bytes.clone();
        changed[i] ^= 1 << bit;
        if let Ok(subject) = received(&changed) {
            // A view of it is no reason to panic either.
            let _ = subject.seen(&ViewOptions::default());
        }
    }
}

/// The error of a triangle that is changed before it is sent.
fn refused(change: impl FnOnce(&mut basrelief_signals::Object)) -> String {
    let mut subject = triangle();
    change(Arc::make_mut(&mut subject.objects[0]));
    received(&sent(&subject)).err().expect("refused")
}

#[test]
fn values_out_of_range_are_refused_with_their_place() {
    let mesh = |change: fn(&mut Mesh)| refused(|o| change(Arc::make_mut(&mut o.mesh)));
    let material = |change: fn(&mut Material)| refused(|o| change(Arc::make_mut(&mut o.material)));
    assert_eq!(mesh(|m| m.indices[2] = 3), "there: /meshes/0/indices/2: 3; expected below 3, the vertices");
    assert_eq!(mesh(|m| m.positions[1][0] = f32::NAN), "there: /meshes/0/positions/1: NaN; expected finite numbers");
    assert!(material(|m| m.lighting.n = 0.0).starts_with("there: /materials/0/lighting: "));
    assert!(material(|m| m.base_color[3] = f32::INFINITY).starts_with("there: /materials/0/base_color: inf"));
    assert!(refused(|o| o.world[5] = f64::NAN).starts_with("there: /objects/0/world: NaN"));
    assert!(refused(|o| o.shading.ia = Some(17.0)).starts_with("there: /objects/0/shading: ia is 17"));
    let levels = vec![basrelief_signals::Image { width: 16_385, height: 1, texels: vec![] }];
    let sampler = basrelief_signals::Sampler { wrap: [WrapMode::Clamp; 2], ..Default::default() };
    let large = Arc::new(Texture { id: 0, name: String::new(), sampler, levels, offset: 0, elsewhere: None });
    let error = refused(move |o| Arc::make_mut(&mut o.material).color_texture = Some(large));
    assert_eq!(error, "there: /textures/0/size: 16385 x 1; expected 1..=16384 per side");
}

#[test]
fn declared_sizes_are_counted_before_allocation() {
    let bytes = sent(&SceneSubject::demo("sphere").unwrap());
    let budget = MemoryPool::new(bytes.len() as u64);
    let error = SceneSubject::from_bytes(&bytes, "there", &budget).map(|_| ()).unwrap_err();
    assert!(error.over_budget && error.to_string().contains("/meshes/0/"), "{error}");
    assert_eq!(budget.left(), bytes.len() as u64, "what was refused is not held");
}
