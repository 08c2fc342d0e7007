//! The tool that draws with Mesa, and how far a picture is from its.
//!
//! The tool is `tests/oracles/pictures.py`. It needs a Python (`BASRELIEF_PYTHON`, default `python3`) that can open a headless
//! OpenGL context. Without it, the tests print SKIPPED. Models made by others come from the folder that `BASRELIEF_INPUTS`
//! names. Light and camera are the defaults of both sides, so the tests compare these, too.

use basrelief_reference::metrics::psnr;
use basrelief_reference::{RenderStyle, RgbPicture, ShadingModel, TextureFilter};
use basrelief_scene::{ViewOptions, load_path};
use basrelief_signals::{Material, Object, Scene};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Arc, OnceLock};

/// Width and height of the pictures \[pixels\].
pub const SIDE: u32 = 512;

/// Imports everything that the tool needs, including an OpenGL context.
const PROBE: &str = "import numpy, PIL, OpenGL, pygltflib, trimesh, scipy, moderngl; \
    moderngl.create_context(standalone=True, backend='egl', libgl='libGL.so.1', libegl='libEGL.so.1')";

/// The tool and the Python that runs it.
#[derive(Clone)]
pub struct Mesa {
    python: PathBuf,
    tool: PathBuf,
}

/// Returns the folder of models made by others, or prints that their checks are skipped.
pub fn foreign_models() -> Option<PathBuf> {
    let default = || workspace().join("../shared/inputs");
    let models = std::env::var_os("BASRELIEF_INPUTS").map_or_else(default, PathBuf::from).join("models");
    if models.is_dir() {
        return Some(models);
    }
    println!("SKIPPED: {} does not exist; BASRELIEF_INPUTS names the folder of foreign inputs", models.display());
    None
}

/// Returns the models of this repository, then those of `foreign` that exist.
pub fn models(foreign: &[&str]) -> Vec<PathBuf> {
    let own = ["patch.gltf", "alcove.gltf"].map(|name| workspace().join("tests/models").join(name));
    let foreign = foreign_models().into_iter().flat_map(|folder| foreign.iter().map(move |name| folder.join(name)));
    own.into_iter().chain(foreign).collect()
}

pub fn name_of(model: &Path) -> String {
    model.file_name().expect("a model file").to_string_lossy().into_owned()
}

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

impl Mesa {
    /// Returns the tool, or prints the reason why it cannot run.
    pub fn find() -> Option<Self> {
        static MESA: OnceLock<Result<Mesa, String>> = OnceLock::new();
        MESA.get_or_init(Self::probe).clone().map_err(|reason| println!("SKIPPED: no picture by Mesa: {reason}")).ok()
    }

    /// Returns the tool, or the reason why it cannot run.
    fn probe() -> Result<Self, String> {
        let python = std::env::var_os("BASRELIEF_PYTHON").map_or("python3".into(), PathBuf::from);
        let probe = Command::new(&python).args(["-c", PROBE]).output();
        let probe = probe.map_err(|error| format!("{}: {error}", python.display()))?;
        if !probe.status.success() {
            let reason = String::from_utf8_lossy(&probe.stderr);
            return Err(format!("{}: {}", python.display(), reason.lines().last().unwrap_or("fails")));
        }
        Ok(Self { python, tool: workspace().join("tests/oracles/pictures.py") })
    }

    pub fn draw(&self, model: &Path, style: RenderStyle, cull: bool) -> RgbPicture {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = |name: &str| folder.path().join(name);
        let mut draw = Command::new(&self.python);
        draw.arg(&self.tool).arg(model).arg(file("mesa.png")).arg("--raw").arg(file("mesa.raw"));
        draw.args(["--mode", mode(style.shading), "--filter", filter(style.options.filter)]);
        draw.args(["--size", &SIDE.to_string(), &SIDE.to_string()]);
        draw.args(cull.then_some("--cull"));
        draw.args((style.options.filter == TextureFilter::None).then_some("--unlit-base"));
        let output = draw.output().expect("python starts");
        assert!(output.status.success(), "{draw:?}: {}", String::from_utf8_lossy(&output.stderr));
        let bytes = std::fs::read(file("mesa.raw")).expect("pixels");
        let mut picture = RgbPicture::new(SIDE, SIDE);
        for (i, pixel) in bytes.chunks_exact(4).enumerate() {
            picture.rgb[i].copy_from_slice(&pixel[..3]);
            picture.covered[i] = pixel[3] != 0;
        }
        picture
    }
}

/// Returns the tool's name for a shading. The tool cannot draw [`ShadingModel::Mean`].
pub fn mode(shading: ShadingModel) -> &'static str {
    match shading {
        ShadingModel::NormalMap => "bump",
        ShadingModel::Phong => "phong",
        ShadingModel::Gouraud => "gouraud",
        ShadingModel::Face => "flat",
        ShadingModel::Texture => "tex",
        ShadingModel::Mean => panic!("no mode of the tool"),
    }
}

/// Returns the tool's name for a filter.
fn filter(filter: TextureFilter) -> &'static str {
    match filter {
        TextureFilter::None | TextureFilter::Bilinear => "bilinear",
        TextureFilter::Nearest => "nearest",
        TextureFilter::Trilinear => "trilinear",
        other => panic!("{other:?}: no filter of the tool"),
    }
}

/// Returns the same scene with all back faces drawn.
pub fn double_sided(scene: &Scene) -> Scene {
    let open = |object: &Arc<Object>| {
        let material = Arc::new(Material { double_sided: true, ..Material::clone(&object.material) });
        Arc::new(Object { material, ..Object::clone(object) })
    };
    Scene { objects: scene.objects.iter().map(open).collect(), ..scene.clone() }
}

pub fn load(model: &Path) -> Scene {
    load_path(model, &ViewOptions { size: [SIDE, SIDE], ..ViewOptions::default() }).expect("a valid model")
}

/// Returns the PSNR inside the common coverage \[dB\], and the share of all pixels that only one picture covers.
pub fn agreement(exact: &RgbPicture, mesa: &RgbPicture) -> (f64, f64) {
    let both: Vec<_> = exact.covered.iter().zip(&mesa.covered).map(|(a, b)| *a && *b).collect();
    let differing = exact.covered.iter().zip(&mesa.covered).filter(|(a, b)| a != b).count();
    let within = |picture: &RgbPicture| RgbPicture { covered: both.clone(), ..picture.clone() };
    let db = psnr(&within(exact), &within(mesa)).expect("same size");
    assert!(both.iter().filter(|&&c| c).count() > 10_000, "hardly anything was drawn");
    (db, differing as f64 / both.len() as f64)
}
