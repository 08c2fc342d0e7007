//! Pictures of a dump: PNG, and PFM for depth, in base64.

use crate::dump::{GlDump, ImageRecord};
use crate::state::Parameters;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_reference::RgbPicture;
use basrelief_scene::{SceneError, decode_picture, over_budget};
use basrelief_signals::Image;

/// Frame buffer of the application behind a draw call, cut to the viewport.
#[derive(Debug)]
pub struct ApplicationPicture {
    /// The colours. Covered are the pixels that the application has drawn since it cleared the depth buffer; all, if the dump has no depth.
    pub picture: RgbPicture,
    /// Depth of each pixel, 0..=1, top row first, if the dump has it.
    pub depth: Option<Vec<f32>>,
    /// Colour that the application clears its picture with.
    pub background: [u8; 3],
    _held: MemoryReservation,
}

/// Returns the file of a picture record.
pub(crate) fn file_of(
    record: &ImageRecord,
    place: &str,
    budget: &MemoryPool,
) -> Result<(Vec<u8>, MemoryReservation), SceneError> {
    let held = budget.try_reserve(2 * record.data.len() as u64, "an image file").map_err(|e| over_budget(place, &e))?;
    let text: String = record.data.chars().filter(|c| !c.is_ascii_whitespace()).collect();
    let bytes = STANDARD.decode(text).map_err(|e| {
        SceneError::at(format!("{place}/__data__"), format!("not base64: {e}")).expected("base64").cure("write the dump again")
    })?;
    Ok((bytes, held))
}

/// Decodes a PNG record.
pub(crate) fn decode(record: &ImageRecord, place: &str, budget: &MemoryPool) -> Result<(Image, MemoryReservation), SceneError> {
    let (bytes, _file) = file_of(record, place, budget)?;
    if record.depth != 1 {
        let what = format!("an image of depth {}", record.depth);
        return Err(SceneError::at(format!("{place}/__depth__"), what).expected("1: a two-dimensional image"));
    }
    let (image, held) = decode_picture(&bytes, "", budget).map_err(|e| SceneError { place: format!("{place}/__data__"), ..e })?;
    if [image.width, image.height] != [record.width, record.height] {
        let what = format!("{} x {} texels, but the dump states {} x {}", image.width, image.height, record.width, record.height);
        return Err(SceneError::at(place, what).expected("equal sizes"));
    }
    Ok((image, held))
}

/// Reads the frame buffer of a dump; `None` if it has no colours.
pub(crate) fn application_picture(
    dump: &GlDump,
    viewport: [u32; 4],
    budget: &MemoryPool,
) -> Result<Option<ApplicationPicture>, SceneError> {
    let of = |prefixes: &[&str]| {
        let mut names = dump.framebuffer.keys().filter(|name| prefixes.iter().any(|prefix| name.starts_with(prefix)));
        names.next().and_then(|name| Some((format!("/framebuffer/{name}"), dump.framebuffer.get(name)?)))
    };
    let Some((place, record)) = of(&["GL_BACK", "GL_COLOR_ATTACHMENT0", "GL_FRONT", "GL_COLOR_ATTACHMENT"]) else {
        return Ok(None);
    };
    let (image, _image) = decode(record, &place, budget)?;
    let window = Window::new(viewport, [image.width, image.height], &place)?;
    let held = budget.try_reserve(window.pixels() * 8, "the application's image").map_err(|e| over_budget(&*place, &e))?;
    let rgb: Vec<[u8; 3]> = window.cut(&image.texels).map(|[r, g, b, _]| [r, g, b]).collect();
    let depth = of(&["GL_DEPTH"]).map(|(place, record)| depths(record, &place, budget)).transpose()?;
    let depth: Option<Vec<f32>> =
        depth.filter(|(size, ..)| *size == [image.width, image.height]).map(|(_, all, _)| window.cut(&all).collect());
    let parameters = Parameters(dump);
    let cleared = parameters.value("GL_DEPTH_CLEAR_VALUE").and_then(|value| value.as_f64()).unwrap_or(1.0) as f32;
    let covered = depth.as_ref().map_or_else(|| vec![true; rgb.len()], |depth| depth.iter().map(|d| *d != cleared).collect());
    let [red, green, blue, _] = parameters.numbers("GL_COLOR_CLEAR_VALUE").unwrap_or([0.0; 4]);
    let background = [red, green, blue].map(|channel| (channel.clamp(0.0, 1.0) * 255.0 + 0.5).floor() as u8);
    let picture = RgbPicture::drawn([viewport[2], viewport[3]], rgb, covered);
    Ok(Some(ApplicationPicture { picture, depth, background, _held: held }))
}

/// Rows and columns of the viewport in a frame buffer, from the top.
struct Window {
    left: usize,
    top: usize,
    size: [usize; 2],
    width: usize,
}

impl Window {
    fn new([left, bottom, width, height]: [u32; 4], frame: [u32; 2], place: &str) -> Result<Self, SceneError> {
        if left + width > frame[0] || bottom + height > frame[1] {
            let what = format!("{} x {} pixels do not hold the viewport", frame[0], frame[1]);
            return Err(SceneError::at(place, what).expected(format!("{width} x {height} pixels from {left}, {bottom}")));
        }
        let top = frame[1] - bottom - height;
        let [left, top, width, height, row] = [left, top, width, height, frame[0]].map(|n| n as usize);
        Ok(Self { left, top, size: [width, height], width: row })
    }

    fn pixels(&self) -> u64 {
        self.size[0] as u64 * self.size[1] as u64
    }

    fn cut<T: Copy>(&self, all: &[T]) -> impl Iterator<Item = T> {
        let rows = all.chunks_exact(self.width).skip(self.top).take(self.size[1]);
        rows.flat_map(|row| row.iter().skip(self.left).take(self.size[0]).copied())
    }
}

/// Depths of a frame buffer with their size and reservation.
type DepthRecord = ([u32; 2], Vec<f32>, MemoryReservation);

/// Reads a PFM record with one channel: a text of three lines, then little-endian numbers, top row first, as apitrace writes it.
fn depths(record: &ImageRecord, place: &str, budget: &MemoryPool) -> Result<DepthRecord, SceneError> {
    let (bytes, held) = file_of(record, place, budget)?;
    let fault = |what: &str| {
        SceneError::at(format!("{place}/__data__"), what).expected("a PFM image with one channel, of the stated size")
    };
    let mut parts = bytes.splitn(4, |byte| *byte == b'\n');
    let mut line = || parts.next().and_then(|line| std::str::from_utf8(line).ok()).unwrap_or_default().to_owned();
    let [kind, size, _scale] = [line(), line(), line()];
    let rest = parts.next().unwrap_or_default();
    if kind != "Pf" || size != format!("{} {}", record.width, record.height) {
        return Err(fault("another kind or size of image"));
    }
    if rest.len() as u64 != u64::from(record.width) * u64::from(record.height) * 4 {
        return Err(fault("has another number of bytes"));
    }
    let depths = rest.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
    Ok(([record.width, record.height], depths, held))
}
