//! The tool that draws with Mesa, and how far a picture is from its.
//!
//! It runs where the models and the tool are found (`BASRELIEF_INPUTS`, `BASRELIEF_PICTURE_ORACLE`; by default beside the
//! workspace, in `../shared`) and `BASRELIEF_PYTHON` (default `python3`) can open a headless OpenGL context; says
//! loudly that it was skipped where not. Light and camera are the defaults of both sides, which are to agree, too.

use basrelief_reference::metrics::psnr;
use basrelief_reference::{Picture, Shading, Style, TextureFilter};
use basrelief_scene::{ViewOptions, load_path};
use basrelief_signals::{Material, Object, Scene};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

/// Width and height of the pictures \[pixels\].
pub const SIDE: u32 = 512;

/// Needs everything that the tool needs, a context included.
const PROBE: &str = "import numpy, PIL, OpenGL, pygltflib, trimesh, scipy, moderngl; \
    moderngl.create_context(standalone=True, backend='egl', libgl='libGL.so.1', libegl='libEGL.so.1')";

/// Colours of the PNG and the triangle numbers, as bytes that need no decoder.
const UNPACK: &str = "import sys, numpy as np; from PIL import Image; png, npz, out = sys.argv[1:]; \
    rgb = np.asarray(Image.open(png).convert('RGB')); hit = np.load(npz)['prim'] > 0; \
    np.concatenate([rgb, hit[..., None].astype('u1')], 2).tofile(out)";

/// The tool, and the models that it draws.
pub struct Mesa {
    python: PathBuf,
    tool: PathBuf,
    pub models: PathBuf,
}

impl Mesa {
    /// The tool; where something is missing, says so.
    pub fn find() -> Option<Self> {
        Self::look().map_err(|missing| println!("SKIPPED, Mesa was not asked: {missing}")).ok()
    }

    /// The tool, or what is missing.
    fn look() -> Result<Self, String> {
        let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
        let path = |variable: &str, default: PathBuf| std::env::var_os(variable).map_or(default, PathBuf::from);
        let python = path("BASRELIEF_PYTHON", "python3".into());
        let tool = path("BASRELIEF_PICTURE_ORACLE", beside.join("tools/picture_oracle.py"));
        let models = path("BASRELIEF_INPUTS", beside.join("inputs")).join("models");
        for needed in [&tool, &models] {
            if !needed.exists() {
                return Err(format!("{} is not there", needed.display()));
            }
        }
        let probe = Command::new(&python).args(["-c", PROBE]).output();
        let probe = probe.map_err(|error| format!("{}: {error}", python.display()))?;
        if !probe.status.success() {
            let reason = String::from_utf8_lossy(&probe.stderr);
            return Err(format!("{}: {}", python.display(), reason.lines().last().unwrap_or("fails")));
        }
        Ok(Self { python, tool, models })
    }

    fn run(&self, command: &mut Command) {
        let output = command.output().expect("python starts");
        assert!(output.status.success(), "{command:?}: {}", String::from_utf8_lossy(&output.stderr));
    }

    pub fn draw(&self, model: &Path, style: Style, cull: bool) -> Picture {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = |name: &str| folder.path().join(name);
        let mut draw = Command::new(&self.python);
        draw.arg(&self.tool).arg(model).arg(file("mesa.png")).arg("--npz").arg(file("mesa.npz"));
        draw.args(["--mode", mode(style.shading), "--filter", filter(style.options.filter)]);
        draw.args(["--size", &SIDE.to_string(), &SIDE.to_string()]);
        draw.args(cull.then_some("--cull"));
        draw.args((style.options.filter == TextureFilter::None).then_some("--unlit-base"));
        self.run(&mut draw);
        let files = [file("mesa.png"), file("mesa.npz"), file("mesa.raw")];
        self.run(Command::new(&self.python).args(["-c", UNPACK]).args(&files));
        let bytes = std::fs::read(&files[2]).expect("unpacked picture");
        let mut picture = Picture::new(SIDE, SIDE);
        for (i, pixel) in bytes.chunks_exact(4).enumerate() {
            picture.rgb[i].copy_from_slice(&pixel[..3]);
            picture.covered[i] = pixel[3] != 0;
        }
        picture
    }
}

/// What the tool calls it. It cannot draw [`Shading::Mean`].
pub fn mode(shading: Shading) -> &'static str {
    match shading {
        Shading::NormalMap => "bump",
        Shading::Phong => "phong",
        Shading::Gouraud => "gouraud",
        Shading::Face => "flat",
        Shading::Texture => "tex",
        Shading::Mean => panic!("no mode of the tool"),
    }
}

/// What the tool calls it.
fn filter(filter: TextureFilter) -> &'static str {
    match filter {
        TextureFilter::None | TextureFilter::Bilinear => "bilinear",
        TextureFilter::Nearest => "nearest",
        TextureFilter::Trilinear => "trilinear",
        other => panic!("{other:?}: no filter of the tool"),
    }
}

/// The same scene with no back face left out.
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

/// PSNR inside the common coverage \[dB\], and the share of all pixels that only one picture covers.
pub fn agreement(exact: &Picture, mesa: &Picture) -> (f64, f64) {
    let both: Vec<_> = exact.covered.iter().zip(&mesa.covered).map(|(a, b)| *a && *b).collect();
    let differing = exact.covered.iter().zip(&mesa.covered).filter(|(a, b)| a != b).count();
    let within = |picture: &Picture| Picture { covered: both.clone(), ..picture.clone() };
    let db = psnr(&within(exact), &within(mesa)).expect("same size");
    assert!(both.iter().filter(|&&c| c).count() > 10_000, "hardly anything was drawn");
    (db, differing as f64 / both.len() as f64)
}
