//! `basrelief import-gl`: turns state dumps of an OpenGL frame into a scene.

use crate::args::{GlSceneArgs, ImportGlArgs};
use crate::error::{CommandError, CommandResult, print};
use crate::global::GlobalOptions;
use crate::outputs::{PartialFile, check_outputs_keep_inputs};
use crate::terminal;
use basrelief_input::{MemoryPool, MemoryReservation, read_to_end};
use basrelief_opengl::{ApplicationPicture, DumpFile, GlFrame, Mapping, PictureComparison, compare, import};
use basrelief_report::number::thousands;
use basrelief_scene::{MemoryFiles, ViewOptions, load, write_camera};
use basrelief_sim::to_png;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Imports dumps from files.
pub fn import_gl(args: &ImportGlArgs, global: &GlobalOptions) -> CommandResult {
    let paths = OutputPaths::new(&args.scene.out)?;
    let inputs: Vec<_> = args.dumps.iter().map(|path| ("DUMP", path.as_path())).collect();
    let outputs: Vec<_> = paths.all().into_iter().map(|path| ("--out", path)).collect();
    check_outputs_keep_inputs(None, &outputs, &inputs).map_err(CommandError::Usage)?;
    let dumps = args.dumps.iter().map(|path| Dump::read(path, &global.budget)).collect::<CommandResult<Vec<_>>>()?;
    import_dumps(&dumps, &args.scene, global)
}

/// A dump in memory.
pub struct Dump {
    name: String,
    bytes: Vec<u8>,
    _held: MemoryReservation,
}

impl Dump {
    /// Reads a dump.
    pub fn read(path: &Path, budget: &MemoryPool) -> CommandResult<Self> {
        let file = File::open(path).map_err(CommandError::at_file(path, "be read"))?;
        let expected = file.metadata().map_or(0, |facts| facts.len());
        let (bytes, held) =
            read_to_end(&mut &file, expected, budget, "a dump").map_err(CommandError::at_file(path, "be read"))?;
        Ok(Self::new(path, bytes, held))
    }

    /// Takes the content of a file that was just written.
    pub fn new(path: &Path, bytes: Vec<u8>, held: MemoryReservation) -> Self {
        Self { name: path.display().to_string(), bytes, _held: held }
    }
}

/// Paths of the files that an import writes.
pub struct OutputPaths {
    scene: PathBuf,
    camera: PathBuf,
    /// Application, exact, difference.
    pictures: [PathBuf; 3],
}

impl OutputPaths {
    /// Derives the paths from that of the scene.
    pub fn new(out: &Path) -> CommandResult<Self> {
        if out.extension().is_none_or(|ending| ending != "gltf") {
            return Err(CommandError::Usage(format!("--out {}: expected a name that ends in .gltf", out.display())));
        }
        let pictures = ["application.png", "exact.png", "difference.png"].map(|ending| out.with_extension(ending));
        Ok(Self { scene: out.into(), camera: out.with_extension("camera.json"), pictures })
    }

    fn all(&self) -> Vec<&Path> {
        [&self.scene, &self.camera].into_iter().chain(&self.pictures).map(PathBuf::as_path).collect()
    }
}

/// Imports dumps, writes the scene, and compares its reference image with the application's.
pub fn import_dumps(dumps: &[Dump], args: &GlSceneArgs, global: &GlobalOptions) -> CommandResult {
    let paths = OutputPaths::new(&args.out)?;
    let files: Vec<_> = dumps.iter().map(|dump| DumpFile { name: &dump.name, bytes: &dump.bytes }).collect();
    let frame = import(&files, &Mapping(args.entries.clone()), &global.budget).map_err(CommandError::bad_input)?;
    if !global.quiet {
        frame.warnings.iter().for_each(|text| terminal::print_note(&format!("warning: {text}")));
    }
    let found =
        frame.application.as_ref().map(|application| comparison(&frame, application, &paths, &global.budget)).transpose()?;
    write_outputs(&frame, found.as_ref(), &paths)?;
    let removed = if found.is_some() { Vec::new() } else { remove_pictures(&paths)? };
    if !global.quiet {
        print(&summary(&frame, found.as_ref(), &paths))?;
        removed.iter().try_for_each(|path| print(&format!("Removed {}, an image of an earlier import\n", path.display())))?;
    }
    check_agreement(args.agree, found.as_ref())
}

/// Writes all files under temporary names before it publishes the first.
fn write_outputs(frame: &GlFrame, found: Option<&PictureComparison>, paths: &OutputPaths) -> CommandResult {
    let mut files = Vec::new();
    let mut add = |path: &PathBuf, bytes: &[u8]| {
        let write = |mut file: PartialFile| file.write_all(bytes).map(|()| file);
        let file = PartialFile::create(path).and_then(write).map_err(CommandError::at_file(path, "be written"))?;
        files.push((path.clone(), file));
        CommandResult::Ok(())
    };
    add(&paths.scene, frame.gltf.as_bytes())?;
    add(&paths.camera, write_camera(&frame.camera).as_bytes())?;
    if let (Some(found), Some(application)) = (found, &frame.application) {
        for (path, picture) in paths.pictures.iter().zip([&application.picture, &found.exact, &found.difference]) {
            add(path, &to_png(picture).map_err(CommandError::BadInput)?)?;
        }
    }
    files.into_iter().try_for_each(|(path, file)| file.publish().map_err(CommandError::at_file(&path, "be written")))
}

/// Removes the images of an earlier import, which do not belong to the new scene. Returns their paths.
fn remove_pictures(paths: &OutputPaths) -> CommandResult<Vec<&Path>> {
    let old: Vec<&Path> = paths.pictures.iter().map(PathBuf::as_path).filter(|path| path.is_file()).collect();
    old.iter().try_for_each(|path| fs::remove_file(path).map_err(CommandError::at_file(path, "be removed")))?;
    Ok(old)
}

/// Loads the scene as `run` would, and compares its reference image.
fn comparison(
    frame: &GlFrame,
    application: &ApplicationPicture,
    paths: &OutputPaths,
    budget: &MemoryPool,
) -> CommandResult<PictureComparison> {
    let view = ViewOptions { size: frame.size, camera: Some(frame.camera), ..ViewOptions::default() };
    let name = paths.scene.display().to_string();
    let (scene, _held) =
        load(frame.gltf.as_bytes(), &name, &MemoryFiles::default(), &view, budget).map_err(CommandError::bad_input)?;
    let drawn = scene.frames.first().ok_or_else(|| CommandError::BadInput(format!("{name}: has no frame")))?;
    compare(&scene, drawn, frame.filter, application).map_err(CommandError::bad_input)
}

fn summary(frame: &GlFrame, found: Option<&PictureComparison>, paths: &OutputPaths) -> String {
    let mut text: String = frame.notes.iter().map(|note| format!("{note}\n")).collect();
    // (Writing to a string cannot fail.)
    if let Some(found) = found {
        let quality = found.quality;
        let _ = writeln!(
            text,
            "Application's image against the reference image: PSNR {:.2} dB, FLIP {:.4}, largest difference {}",
            quality.psnr_db, quality.flip, found.largest
        );
        let _ = match (found.shown_agreement(), found.geometry) {
            (Some(percent), Some(geometry)) => writeln!(
                text,
                "Geometry agrees on {percent} % of {} pixels: {} differ in coverage, {} in depth",
                thousands(found.pixels),
                thousands(geometry.coverage),
                thousands(geometry.depth)
            ),
            _ => writeln!(text, "Geometry is not compared, because the dump has no depth"),
        };
    } else {
        text.push_str("Nothing is compared, because the dump has no image\n");
    }
    let [width, height] = frame.size;
    let (scene, camera) = (paths.scene.display(), paths.camera.display());
    let _ = writeln!(text, "Written to {scene}. Draw it with\n  basrelief run {scene} --camera {camera} --size {width}x{height}");
    text
}

fn check_agreement(least: Option<f64>, found: Option<&PictureComparison>) -> CommandResult {
    let Some(least) = least else { return Ok(()) };
    if found.and_then(PictureComparison::agreement).is_some_and(|percent| percent >= least) {
        return Ok(());
    }
    match found.and_then(PictureComparison::shown_agreement) {
        Some(percent) => {
            Err(CommandError::BadInput(format!("--agree {least}: geometry agrees on {percent} % of the pixels only")))
        }
        None => Err(CommandError::BadInput(format!("--agree {least}: the dump has no image with depth"))),
    }
}
