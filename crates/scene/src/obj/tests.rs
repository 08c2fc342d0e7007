//! Whole models.

use crate::files::MemoryFiles;
use crate::picture::tests::png;
use crate::{SceneError, ViewOptions, load};
use basrelief_input::MemoryPool;
use basrelief_signals::{Scene, WrapMode};
use image::{DynamicImage, ImageBuffer, ImageFormat, Luma};
use proptest::prelude::*;
use std::io::Cursor;

const SQUARE: &str = "mtllib lib/m.mtl\no wall\nusemtl stone\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";

fn import(text: &str, files: &MemoryFiles) -> Result<Scene, SceneError> {
    load(text.as_bytes(), "m.obj", files, &ViewOptions::default(), &MemoryPool::default()).map(|(scene, _)| scene)
}

#[test]
fn materials_are_read_through_the_given_files() {
    let mtl = "newmtl stone\nKd 0.5 0.6 0.7\nmap_Kd -clamp on c.png\nmap_Bump -bm 2 h.png\n";
    let ramp = png(4, 4, |x, _| [(x * 20) as u8, (x * 20) as u8, (x * 20) as u8, 255]);
    let files =
        MemoryFiles::default().with("lib/m.mtl", mtl).with("lib/c.png", png(2, 2, |x, _| [x as u8; 4])).with("lib/h.png", ramp);
    let scene = import(SQUARE, &files).unwrap();
    assert_eq!(scene.warnings, [""; 0]);
    let object = &scene.objects[0];
    assert_eq!(object.name, "wall / stone");
    assert_eq!(object.mesh.uv, [[0., 1.], [1., 1.], [1., 0.], [0., 0.]], "v runs down here");
    assert_eq!(object.mesh.tangents, [[1., 0., 0., 1.]; 4]);
    assert_eq!(object.mesh.normals, [[0., 0., 1.]; 4]);
    let material = &object.material;
    assert!(material.double_sided);
    assert_eq!(material.base_color, [0.5, 0.6, 0.7, 1.0]);
    assert_eq!(material.color_texture.as_ref().unwrap().sampler.wrap, [WrapMode::Clamp; 2]);
    // The ramp rises by 20/255 per texel, twice the standard height: it leans to the left.
    let red = material.normal_map.as_ref().unwrap().levels[0].texels[5][0];
    let slope: f64 = 20.0 / 255.0 * 8.0;
    assert_eq!(f64::from(red), (127.5 * (1.0 - slope / (1.0 + slope * slope).sqrt())).round());
}

/// Steps of the ramp are a quarter of a step of 8 bits.
#[test]
fn height_map_of_sixteen_bits_has_smooth_slope() {
    let ramp = ImageBuffer::from_fn(16, 4, |x, _| Luma([64 * x as u16]));
    let mut bytes = Cursor::new(Vec::new());
    DynamicImage::ImageLuma16(ramp).write_to(&mut bytes, ImageFormat::Png).unwrap();
    let files =
        MemoryFiles::default().with("lib/m.mtl", "newmtl stone\nbump -bm 100 h.png\n").with("lib/h.png", bytes.into_inner());
    let scene = import(SQUARE, &files).unwrap();
    let map = scene.objects[0].material.normal_map.clone().unwrap();
    let slope: f64 = 64.0 / 65535.0 * 400.0;
    let red = (127.5 * (1.0 - slope / (1.0 + slope * slope).sqrt())).round() as u8;
    assert_eq!(map.levels[0].texels[1..15].iter().map(|texel| texel[0]).collect::<Vec<_>>(), [red; 14]);
}

#[test]
fn missing_libraries_and_pictures_are_warnings() {
    let scene = import(SQUARE, &MemoryFiles::default()).unwrap();
    assert!(scene.warnings[0].contains("cannot read `lib/m.mtl`"), "{:?}", scene.warnings);
    let files = MemoryFiles::default().with("lib/m.mtl", "newmtl stone\nmap_Kd gone.png\n");
    let scene = import(SQUARE, &files).unwrap();
    assert!(scene.warnings[0].contains("cannot read `lib/gone.png`"), "{:?}", scene.warnings);
    assert!(scene.objects[0].material.color_texture.is_none() && scene.objects[0].mesh.uv.is_empty());
}

#[test]
fn height_map_beside_normal_map_is_a_warning() {
    let warnings = |mtl: &str| {
        let files = MemoryFiles::default().with("lib/m.mtl", mtl).with("lib/h.png", png(2, 2, |_, _| [128, 128, 255, 255]));
        import(SQUARE, &files).unwrap().warnings
    };
    let unused = ["material `stone`: its `bump` is not used, because its `norm` is a normal map too"];
    assert_eq!(warnings("newmtl stone\nbump h.png\nnorm h.png\n"), unused);
    assert_eq!(warnings("newmtl stone\nbump h.png\n"), [""; 0]);
    assert_eq!(warnings("newmtl stone\nnorm h.png\n"), [""; 0]);
}

#[test]
fn corrupt_picture_is_an_error_that_names_it() {
    let files = MemoryFiles::default().with("lib/m.mtl", "newmtl stone\nmap_Kd c.png\n").with("lib/c.png", *b"GIF89a");
    assert!(import(SQUARE, &files).unwrap_err().to_string().starts_with("lib/c.png: neither PNG nor JPEG (a GIF image)"));
}

#[test]
fn texture_seams_keep_smooth_normals() {
    // A roof: two faces that share the ridge 2-3 in space, but not in the texture.
    let roof = "v -1 0 0\nv 0 1 0\nv 0 1 -1\nv 1 0 0\nvt 0 0\nvt 1 0\nf 1/1 2/1 3/1\nf 2/2 4/2 3/2\n";
    let scene = import(roof, &MemoryFiles::default()).unwrap();
    let mesh = &scene.objects[0].mesh;
    let ridge: Vec<_> = mesh.positions.iter().zip(&mesh.normals).filter(|(p, _)| **p == [0., 1., 0.]).collect();
    assert_eq!(ridge.len(), 2);
    assert_eq!(ridge[0].1, ridge[1].1);
}

#[test]
fn nothing_to_draw_is_an_error() {
    assert!(import("v 0 0 0\nl 1 1\n", &MemoryFiles::default()).unwrap_err().to_string().contains("lines and points"));
    assert!(import("", &MemoryFiles::default()).is_err());
}

/// Each line uses a material of its own. A linear search in a list took minutes.
#[test]
fn lookup_of_many_materials_is_fast() {
    const MATERIALS: usize = 100_000;
    let library: String = (0..MATERIALS).map(|i| format!("newmtl m{i}\nKd 0 0 1\nmap_Kd {i}.png\n")).collect();
    let faces: String = (0..MATERIALS).map(|i| format!("usemtl m{i}\nf 1 2 3\n")).collect();
    let text = format!("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}");
    let began = std::time::Instant::now();
    let scene = import(&text, &MemoryFiles::default().with("m.mtl", library)).unwrap();
    assert_eq!(scene.objects.len(), MATERIALS);
    assert_eq!(scene.objects[MATERIALS - 1].material.base_color, [0.0, 0.0, 1.0, 1.0]);
    assert!(began.elapsed().as_secs() < 15, "{:?}", began.elapsed());
}

#[test]
fn first_of_two_equal_material_names_is_used() {
    let files = MemoryFiles::default().with("lib/m.mtl", "newmtl stone\nKd 1 0 0\nnewmtl stone\nKd 0 1 0\n");
    let scene = import(SQUARE, &files).unwrap();
    assert_eq!(scene.objects[0].material.base_color, [1.0, 0.0, 0.0, 1.0]);
    assert_eq!(scene.warnings, ["material `stone` is defined twice: its first definition is used"]);
}

#[test]
fn material_without_definition_is_a_warning() {
    let files = MemoryFiles::default().with("lib/m.mtl", "# empty");
    let missing = ["material `stone` is in no library: drawn white"];
    assert_eq!(import(SQUARE, &files).unwrap().warnings, missing);
    assert_eq!(import(SQUARE.trim_start_matches("mtllib lib/m.mtl\n"), &MemoryFiles::default()).unwrap().warnings, missing);
}

#[test]
fn utf_16_library_is_named() {
    let text: Vec<u8> = "\u{feff}newmtl stone\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let warnings = import(SQUARE, &MemoryFiles::default().with("lib/m.mtl", text)).unwrap().warnings;
    let cure = "save the file as UTF-8 or ASCII text; drawn without its materials";
    assert_eq!(warnings, [format!("lib/m.mtl: byte 3: UTF-16 text; expected MTL text; {cure}")]);
}

/// Vertex colours do not change the colour of an OBJ surface that only emits.
#[test]
fn obj_emission_has_neither_vertex_colours_nor_highlight() {
    let colored =
        SQUARE.replace("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0", "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 1 0 0\nv 0 1 0 1 0 0");
    let object = |mtl: &str| {
        let scene = import(&colored, &MemoryFiles::default().with("lib/m.mtl", mtl)).unwrap();
        assert_eq!(scene.warnings, [""; 0]);
        scene.objects[0].clone()
    };
    assert_eq!(object("newmtl stone\nKd 1 1 1\n").mesh.colors, [[1.0, 0.0, 0.0, 1.0]; 4]);
    let emits = object("newmtl stone\nKd 0 0 0\nKe 0.5 0.25 0\n");
    assert!(emits.mesh.colors.is_empty());
    assert_eq!(emits.material.base_color, [0.5, 0.25, 0.0, 1.0]);
    assert_eq!((emits.material.lighting.ka, emits.material.lighting.kd, emits.material.lighting.ks), (1.0, 0.0, 0.0));
    assert_eq!(object("newmtl stone\nKd 0 0 0\nKe 1 1 1\nKs 0.5 0.5 0.5\n").material.lighting.ks, 0.5, "as stated");
}

proptest! {
    #[test]
    fn any_text_is_read_or_refused(text in "([vfou#][tn]?( [-0-9/.x\\\\]{1,6}){0,5}\n){0,20}") {
        let _ = import(&text, &MemoryFiles::default());
    }

    #[test]
    fn any_library_is_read_or_refused(text in "newmtl stone\n((Kd|map_Kd|bump|d|norm) ?(-bm|-s|-clamp|-mm)?( [-0-9a.]{1,4}){0,4}\n){0,9}") {
        let _ = import(SQUARE, &MemoryFiles::default().with("lib/m.mtl", text));
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        for name in ["a.obj", "a.glb", "a.gltf", "a"] {
            let _ = load(&bytes, name, &MemoryFiles::default(), &ViewOptions::default(), &MemoryPool::default());
        }
    }
}
