//! Demo scenes, all generated: the same on every machine, to the bit.

mod brick;
mod coin;
mod corridor;
mod cut_plane;
mod ellipsoid;
mod gallery;
mod goblet;
mod golf_ball;
mod lettering;
mod mixed;
mod paintings;
mod pattern;
mod sphere;
mod spline;
mod stage;
mod turntable;

use crate::model::bounds;
use crate::view::{LightSource, ViewHints};
use crate::{SceneError, SceneSubject, ViewOptions};
use basrelief_parameters::nearest;
use basrelief_signals::{Scene, ShadingSettings};
use stage::DemoScene;
use std::ops::RangeInclusive;

/// Divisions per side of a demo's surfaces, as in `goblet@8`. Twice the number gives four times the polygons.
const TESSELLATIONS: RangeInclusive<u32> = 1..=16;

/// Tessellation of a demo name without a number.
const DEFAULT_TESSELLATION: u32 = 4;

/// A demo scene.
#[derive(Clone, Copy, Debug)]
pub struct DemoInfo {
    /// Name as given to [`demo`].
    pub name: &'static str,
    /// Description, in a sentence.
    pub about: &'static str,
    build: DemoBuild,
}

#[derive(Clone, Copy, Debug)]
enum DemoBuild {
    /// There is one form of it.
    Fixed(fn() -> DemoScene),
    /// By its tessellation.
    Tessellated(fn(u32) -> DemoScene),
}

impl DemoInfo {
    const fn fixed(name: &'static str, about: &'static str, build: fn() -> DemoScene) -> Self {
        Self { name, about, build: DemoBuild::Fixed(build) }
    }

    const fn tessellated(name: &'static str, about: &'static str, build: fn(u32) -> DemoScene) -> Self {
        Self { name, about, build: DemoBuild::Tessellated(build) }
    }

    /// Tessellations N that [`demo`] takes as `NAME@N`; `None` where there is only one.
    pub fn tessellations(&self) -> Option<RangeInclusive<u32>> {
        match self.build {
            DemoBuild::Fixed(_) => None,
            DemoBuild::Tessellated(_) => Some(TESSELLATIONS),
        }
    }

    fn stage(&self, tessellation: Option<&str>) -> Result<DemoScene, SceneError> {
        let refused = |text: &str, expected: String| {
            Err(SceneError::at("demo", format!("`{}` has no tessellation `{text}`", self.name)).expected(expected))
        };
        match (self.build, tessellation) {
            (DemoBuild::Fixed(build), None) => Ok(build()),
            (DemoBuild::Fixed(_), Some(text)) => refused(text, format!("`{}`", self.name)),
            (DemoBuild::Tessellated(build), None) => Ok(build(DEFAULT_TESSELLATION)),
            (DemoBuild::Tessellated(build), Some(text)) => match text.parse() {
                Ok(n) if TESSELLATIONS.contains(&n) => Ok(build(n)),
                _ => refused(text, format!("`{0}@{1}` to `{0}@{2}`", self.name, TESSELLATIONS.start(), TESSELLATIONS.end())),
            },
        }
    }
}

/// All demos. Any machine draws any of them. Each machine names its default demo.
pub const DEMOS: &[DemoInfo] = &[
    DemoInfo::fixed("golf-ball", "A golf ball: 336 dimples in a normal map on a smooth sphere.", golf_ball::build),
    DemoInfo::fixed(
        "coin",
        "Relief on a coin while the light circles around it: the tables of brightness change with every frame.",
        coin::build,
    ),
    DemoInfo::fixed(
        "brick",
        "A brick wall and a paved floor that run to the horizon, so that every LOD 0..=63 occurs.",
        brick::build,
    ),
    DemoInfo::fixed("mixed", "Bump targets, textured and plain polygons in front of each other.", mixed::build),
    DemoInfo::fixed(
        "sphere",
        "The benchmark: a woven sphere of 20,000 triangles with a normal map of 512 x 512 texels.",
        sphere::build,
    ),
    DemoInfo::tessellated(
        "ellipsoid",
        "A lacquered ellipsoid (Figure 3 of the shading device); `ellipsoid@1` to `@16` set the tessellation, 4 is the default.",
        ellipsoid::build,
    ),
    DemoInfo::tessellated(
        "cut-plane",
        "A plane that a curve cuts into many facets, beside a curved body; tessellation as above.",
        cut_plane::build,
    ),
    DemoInfo::tessellated(
        "goblet",
        "A spline surface of revolution with narrow highlights; tessellation as above.",
        goblet::build,
    ),
    DemoInfo::fixed("corridor", "A corridor with checkered floor, walls and ceiling, to the vanishing point.", corridor::build),
    DemoInfo::fixed("turntable", "A box with an image on every side, turning close to the eye.", turntable::build),
    DemoInfo::fixed(
        "gallery",
        "A hall with many large paintings, most of them hidden, oblique or far; `--frames` walks around in it.",
        gallery::build,
    ),
];

/// Builds a demo scene, by its name or as `NAME@N` with tessellation N. The demo supplies missing view options.
///
/// # Errors
/// No demo of this name; a tessellation that it does not have; options out of range.
pub fn demo(name: &str, options: &ViewOptions) -> Result<Scene, SceneError> {
    SceneSubject::demo(name)?.seen(options)
}

impl SceneSubject {
    /// Builds a demo scene as [`demo`](crate::demo) does, to be looked at later.
    ///
    /// # Errors
    /// No demo of this name; a tessellation that it does not have.
    pub fn demo(name: &str) -> Result<Self, SceneError> {
        subject(name)
    }
}

fn subject(name: &str) -> Result<SceneSubject, SceneError> {
    let (title, tessellation) = name.split_once('@').map_or((name, None), |(title, n)| (title, Some(n)));
    let info = DEMOS.iter().find(|d| d.name == title).ok_or_else(|| {
        let names: Vec<&str> = DEMOS.iter().map(|d| d.name).collect();
        let near = nearest(title, names.iter().copied()).map_or_else(String::new, |near| format!("did you mean `{near}`?"));
        SceneError::at("demo", format!("no demo is called `{title}`")).expected(names.join(", ")).cure(near)
    })?;
    let stage = info.stage(tessellation)?;
    let hints = ViewHints {
        bounds: bounds(&stage.objects),
        camera: Some(stage.camera),
        lamps: vec![(LightSource::Directional(stage.to_light), 1.0)],
        frames: stage.frames,
        orbit: stage.orbit,
        light_orbit: stage.light_orbit,
        shading: ShadingSettings::default(),
    };
    Ok(SceneSubject { name: name.into(), objects: stage.objects, hints, camera_ratio: None, warnings: Vec::new() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_signals::{Mesh, Object};
    use glam::{DVec2, DVec3};

    fn all() -> impl Iterator<Item = Scene> {
        DEMOS.iter().map(|d| demo(d.name, &ViewOptions::default()).unwrap())
    }

    fn corners(mesh: &Mesh) -> impl Iterator<Item = [usize; 3]> + '_ {
        mesh.indices.as_chunks::<3>().0.iter().map(|t| t.map(|i| i as usize))
    }

    fn vector(v: [f32; 3]) -> DVec3 {
        DVec3::from_array(v.map(f64::from))
    }

    /// Positions per u and per v over a triangle; `None` where the texture has no area there.
    fn gradients(mesh: &Mesh, t: [usize; 3]) -> Option<[DVec3; 2]> {
        let p = t.map(|i| vector(mesh.positions[i]));
        let uv = t.map(|i| DVec2::from_array(mesh.uv_normal[i].map(f64::from)));
        let (a, b) = (uv[1] - uv[0], uv[2] - uv[0]);
        let area = a.perp_dot(b);
        let (e, f) = (p[1] - p[0], p[2] - p[0]);
        (area.abs() > 1e-12).then(|| [(e * b.y - f * a.y) / area, (f * a.x - e * b.x) / area])
    }

    fn check_object(object: &Object) {
        let mesh = &object.mesh;
        for t in corners(mesh) {
            let [a, b, c] = t.map(|i| vector(mesh.positions[i]));
            let face = (b - a).cross(c - a).normalize();
            for i in t {
                let normal = vector(mesh.normals[i]);
                assert!((normal.length() - 1.0).abs() < 1e-6);
                assert!(face.dot(normal) > 0.5, "{}: the front is counter-clockwise", object.name);
            }
            if object.material.normal_map.is_none() {
                continue;
            }
            let Some([along_u, along_v]) = gradients(mesh, t) else { continue };
            for i in t {
                let [x, y, z, w] = mesh.tangents[i];
                let (normal, tangent) = (vector(mesh.normals[i]), vector([x, y, z]));
                let bitangent = normal.cross(tangent) * f64::from(w);
                assert!(tangent.dot(normal).abs() < 1e-6 && (tangent.length() - 1.0).abs() < 1e-6);
                assert!(tangent.dot(along_u.normalize()) > 0.7, "{}: tangents follow u", object.name);
                assert!(bitangent.dot(along_v.normalize()) < -0.7, "{}: bitangents oppose v", object.name);
            }
        }
    }

    #[test]
    fn tangent_frames_follow_the_texture() {
        all().flat_map(|s| s.objects).for_each(|o| check_object(&o));
    }

    #[test]
    fn demos_are_the_same_every_time() {
        let again = |name| demo(name, &ViewOptions::default()).unwrap();
        assert_eq!(again("coin"), again("coin"));
        assert_eq!(again("goblet@7"), again("goblet@7"));
        assert!(again("coin").frames.len() > 1, "its light circles");
    }

    #[test]
    fn unknown_demo_error_lists_known_demos() {
        let error = demo("bricks", &ViewOptions::default()).unwrap_err().to_string();
        assert!(
            error.contains("golf-ball, coin, brick, mixed, sphere, ellipsoid, cut-plane, goblet, corridor, turntable, gallery"),
            "{error}"
        );
    }

    #[test]
    fn mistyped_demo_error_names_nearest_demo() {
        let error = |name| demo(name, &ViewOptions::default()).unwrap_err().to_string();
        assert!(error("golf-bal").ends_with("gallery; did you mean `golf-ball`?"), "{}", error("golf-bal"));
        assert!(error("teapot").ends_with("turntable, gallery"), "{}", error("teapot"));
    }

    fn triangles(scene: &Scene) -> usize {
        scene.objects.iter().map(|o| o.mesh.indices.len() / 3).sum()
    }

    #[test]
    fn tessellation_is_part_of_the_name() {
        for info in DEMOS.iter().filter(|d| d.tessellations().is_some()) {
            let count = |suffix: &str| triangles(&demo(&format!("{}{suffix}", info.name), &ViewOptions::default()).unwrap());
            assert_eq!(info.tessellations(), Some(1..=16));
            assert_eq!(count(""), count("@4"));
            let [coarse, fine] = ["@8", "@16"].map(count);
            assert!((3.7..4.3).contains(&(fine as f64 / coarse as f64)), "{}: {coarse}, {fine}", info.name);
            assert!(count("@1") > 60 && fine < 120_000);
        }
    }

    #[test]
    fn wrong_tessellation_error_lists_valid_values() {
        let says = |name: &str| demo(name, &ViewOptions::default()).unwrap_err().to_string();
        for wrong in ["0", "17", "-1", "", "4x", "4@4", "99999999999"] {
            let expected = format!("demo: `goblet` has no tessellation `{wrong}`; expected `goblet@1` to `goblet@16`");
            assert_eq!(says(&format!("goblet@{wrong}")), expected);
        }
        assert_eq!(says("coin@4"), "demo: `coin` has no tessellation `4`; expected `coin`");
        assert!(says("teapot@4").contains("no demo is called `teapot`"));
    }

    /// Demo of the shading device: no textures, highlights as sharp as its page says, n 50..=200.
    #[test]
    fn demos_of_the_shading_device_shine_and_have_no_textures() {
        for scene in ["ellipsoid", "cut-plane", "goblet"].map(|name| demo(name, &ViewOptions::default()).unwrap()) {
            for material in scene.objects.iter().map(|o| &o.material) {
                assert!(material.color_texture.is_none() && material.normal_map.is_none());
                assert!((50.0..=200.0).contains(&material.lighting.n) && material.lighting.ks > 0.0);
            }
        }
        assert_eq!(triangles(&demo("goblet", &ViewOptions::default()).unwrap()), 6_864);
    }

    /// Polygons in front of the near plane and behind it, texture coordinates in the hundreds.
    #[test]
    fn corridor_begins_behind_the_eye_and_repeats_its_texture() {
        let scene = demo("corridor", &ViewOptions::default()).unwrap();
        let camera = glam::DMat4::from_cols_array(&scene.frames[0].camera.view_projection).transpose();
        for object in scene.objects.iter().filter(|o| o.material.color_texture.is_some()) {
            let mesh = &object.mesh;
            let w: Vec<f64> = mesh.positions.iter().map(|p| (camera * vector(*p).extend(1.0)).w).collect();
            assert!(w.iter().any(|w| *w < 0.0) && w.iter().any(|w| *w > 1000.0), "{}", object.name);
            assert!(mesh.uv.iter().flatten().any(|c| c.abs() >= 999.0), "{}", object.name);
        }
    }

    #[test]
    fn turntable_turns_once_under_fixed_light() {
        let frames = |options: &ViewOptions| demo("turntable", options).unwrap().frames;
        let own = frames(&ViewOptions::default());
        let asked = frames(&ViewOptions { frames: Some(3), ..ViewOptions::default() });
        assert_eq!((own.len(), asked.len()), (8, 3));
        let side = |f: &basrelief_signals::Frame| libm::atan2(f.camera.to_viewer[0], f.camera.to_viewer[2]).to_degrees();
        assert!(((side(&asked[1]) - side(&asked[0])).rem_euclid(360.0) - 120.0).abs() < 1e-9);
        let scene = demo("turntable", &ViewOptions::default()).unwrap();
        let positions: Vec<_> = scene.objects.iter().flat_map(|o| &o.mesh.positions).map(|p| vector(*p).extend(1.0)).collect();
        let cameras = own.iter().map(|f| glam::DMat4::from_cols_array(&f.camera.view_projection).transpose());
        let nearest = cameras.flat_map(|camera| positions.iter().map(move |p| (camera * *p).w));
        assert!(nearest.fold(f64::INFINITY, f64::min) < 0.8, "close to the eye");
    }

    /// Demo of the rate-limited renderer.
    #[test]
    fn gallery_has_pictures_of_all_sizes_and_plain_polygons() {
        let scene = demo("gallery", &ViewOptions { frames: Some(12), ..ViewOptions::default() }).unwrap();
        let pictures: Vec<_> = scene.objects.iter().filter_map(|o| o.material.color_texture.as_ref()).collect();
        let sizes: Vec<_> = pictures.iter().map(|t| (t.levels[0].width, t.levels[0].height)).collect();
        assert!(pictures.len() >= 30 && scene.objects.iter().any(|o| o.material.color_texture.is_none()));
        assert!(sizes.iter().any(|(w, h)| w > h) && sizes.iter().any(|(w, h)| w < h) && sizes.iter().any(|(w, h)| w == h));
        assert!(sizes.iter().filter(|(w, h)| !w.is_power_of_two() || !h.is_power_of_two()).count() > 10);
        assert!(sizes.iter().any(|(w, _)| w % 2 == 1) && sizes.iter().any(|(w, h)| w * h > 500_000));
        let mut eyes: Vec<_> = scene.frames.iter().map(|f| f.camera.to_viewer.map(|c| (c * 1e6).round() as i64)).collect();
        eyes.dedup();
        assert_eq!(eyes.len(), 12, "it walks around");
    }

    #[test]
    fn benchmark_has_twenty_thousand_triangles() {
        let scene = demo("sphere", &ViewOptions::default()).unwrap();
        assert_eq!(triangles(&scene), 20_000);
        let map = scene.objects[0].material.normal_map.as_ref().unwrap();
        assert_eq!((map.levels[0].width, map.levels[0].height, map.levels.len()), (512, 512, 8));
    }

    #[test]
    fn mixed_has_every_kind_of_polygon() {
        let scene = demo("mixed", &ViewOptions::default()).unwrap();
        let kinds: Vec<_> =
            scene.objects.iter().map(|o| (o.material.normal_map.is_some(), o.material.color_texture.is_some())).collect();
        for kind in [(true, true), (true, false), (false, true), (false, false)] {
            assert!(kinds.contains(&kind), "{kind:?}");
        }
        assert!(scene.objects.iter().any(|o| o.entries.is_some()) && scene.objects.iter().any(|o| o.bump == Some(false)));
    }

    /// LOD of every triangle that lies within the picture: 8 log2 of the texels per pixel.
    #[test]
    fn brick_reaches_every_lod() {
        let scene = demo("brick", &ViewOptions::default()).unwrap();
        let camera = glam::DMat4::from_cols_array(&scene.frames[0].camera.view_projection).transpose();
        let mut seen = [false; 64];
        for object in &scene.objects {
            let texels = f64::from(object.material.normal_map.as_ref().unwrap().levels[0].width);
            for t in corners(&object.mesh) {
                let clip = t.map(|i| camera * vector(object.mesh.positions[i]).extend(1.0));
                if clip.iter().any(|c| c.truncate().abs().max_element() > c.w) {
                    continue;
                }
                let window = clip.map(|c| DVec2::new(c.x / c.w * 320.0, c.y / c.w * 240.0));
                let uv = t.map(|i| DVec2::from_array(object.mesh.uv_normal[i].map(f64::from)) * texels);
                let area = |p: [DVec2; 3]| (p[1] - p[0]).perp_dot(p[2] - p[0]).abs();
                let lod = (4.0 * libm::log2(area(uv) / area(window))).round().clamp(0.0, 63.0);
                seen[lod as usize] = true;
            }
        }
        let missing: Vec<_> = (0..64).filter(|l| !seen[*l]).collect();
        assert!(missing.is_empty(), "LODs that do not occur: {missing:?}");
    }
}
