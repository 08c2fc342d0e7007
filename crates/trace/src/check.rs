//! Checks of a command by itself: finite numbers, ranges, lengths. Every command passes them on its way in and out.

use crate::command::*;
use crate::error::{CommandFault, ErrorKind};
use basrelief_signals::{MAX_PICTURE_PIXELS, Object, ShadingSettings};
use std::fmt::Display;
use std::ops::RangeInclusive;

/// Window coordinates lie within this many pixels around the origin: beyond any geometry processor's guard band, and
/// small enough for exact fixed-point edge functions in 64 bits.
pub const GUARD_BAND: f32 = (1 << 19) as f32;
/// Depth is 0..=1. Corners cut at the near or far plane may exceed it by the rounding of z / w, which is large if w is
/// small. The machine clamps the depth of each pixel.
const DEPTH: RangeInclusive<f32> = -1.0..=2.0;
/// A polygon whose depths are all larger lies behind the far plane. Depths of a recorded polygon exceed 1 by rounding only: w is large at
/// the far plane.
const FARTHEST: f32 = 1.0 + 1.0 / 1024.0;
/// Largest arrival \[cycles\]: minutes at any clock. A display reads its buffer while the machine waits, and a run of ten billion cycles of
/// waiting takes about 8 s.
const MAX_ARRIVAL: u64 = 100_000_000_000;
const MAX_OFFSET: u64 = 1 << 40;
const MAX_LIGHTS: usize = 1024;
/// Accuracy criteria \[pixels\], as those of `texel.error_bound`.
const CRITERIA: RangeInclusive<f64> = 0.001..=1024.0;
const SIDES: RangeInclusive<u32> = 1..=MAX_SIDE;

pub(crate) fn check(command: &TraceCommand) -> Result<(), CommandFault> {
    match command {
        TraceCommand::Begin(begin) => check_begin(begin),
        TraceCommand::Texture(texture) => check_texture(texture),
        TraceCommand::Material(material) => check_material(material),
        TraceCommand::Frame(frame) => check_frame(frame),
        TraceCommand::Object(object) => check_object(object),
        TraceCommand::Polygon(polygon) => check_polygon(polygon),
        TraceCommand::Expect(expectation) => check_expectation(expectation),
        TraceCommand::Shading(shading) => check_shading(&shading.into()),
        TraceCommand::Importance(importance) => within("bias", importance.bias, Object::BIAS),
        TraceCommand::Criterion(criterion) => within("error_bound", criterion.error_bound, CRITERIA),
        TraceCommand::FrameEnd(_) | TraceCommand::End(_) => Ok(()),
    }
}

fn check_begin(begin: &BeginCommand) -> Result<(), CommandFault> {
    if begin.format != FORMAT {
        return Err(CommandFault::new("format", format!("is {:?}, expected {FORMAT:?}: no display list", begin.format)));
    }
    check_version(begin.version)?;
    within("width", begin.width, SIDES)?;
    within("height", begin.height, SIDES)?;
    if u64::from(begin.width) * u64::from(begin.height) > MAX_PICTURE_PIXELS {
        let message = format!("makes images of {} x {} pixels, expected at most {MAX_PICTURE_PIXELS}", begin.width, begin.height);
        return Err(CommandFault::new("height", message));
    }
    Ok(())
}

pub(crate) fn check_version(version: u32) -> Result<(), CommandFault> {
    if version != VERSION {
        let message = format!("is {version}, this reader knows {VERSION}: record the trace again, or update");
        return Err(CommandFault::new("version", message).of_kind(ErrorKind::Unsupported));
    }
    Ok(())
}

fn check_texture(texture: &TextureDefinition) -> Result<(), CommandFault> {
    within("width", texture.width, SIDES)?;
    within("height", texture.height, SIDES)?;
    within("levels", texture.levels, 1..=texture.width.max(texture.height).ilog2() + 1)?;
    if !texture.offset.is_multiple_of(16) || texture.offset >= MAX_OFFSET {
        let message = format!("is {}, expected a multiple of 16 below 2^40 (levels fill whole 4 x 4 blocks)", texture.offset);
        return Err(CommandFault::new("offset", message));
    }
    match (&texture.data, &texture.file) {
        (Some(data), None) => check_length(texture, data.0.len() as u64, "data"),
        (None, Some(file)) => check_file_name(file),
        (None, None) => Err(CommandFault::new("data", "missing: give `data` (base64) or `file`")),
        (Some(_), Some(_)) => Err(CommandFault::new("file", "stands beside `data`: give one of the two")),
    }
}

/// Checks that the levels need `bytes` bytes. `field` is the source of the bytes.
pub(crate) fn check_length(texture: &TextureDefinition, bytes: u64, field: &str) -> Result<(), CommandFault> {
    let expected = texture.texel_count() * texture.kind.texel_bytes();
    if bytes != expected {
        let (levels, width, height) = (texture.levels, texture.width, texture.height);
        let message = format!("holds {bytes} bytes, expected {expected}: {levels} level(s) from {width} x {height} on");
        return Err(CommandFault::new(field, message));
    }
    Ok(())
}

/// Refuses paths that lead out of the folder of the trace.
fn check_file_name(file: &str) -> Result<(), CommandFault> {
    let plain = |part: &str| !matches!(part, "" | "." | "..") && !part.contains(['\\', ':', '\0']);
    if file.split('/').all(plain) {
        return Ok(());
    }
    Err(CommandFault::new(
        "file",
        format!("is {file:?}, expected a relative path below the trace's folder, such as \"wall.rgb\""),
    ))
}

fn check_material(material: &MaterialDefinition) -> Result<(), CommandFault> {
    finite("base_color", &[material.base_color])?;
    material.base_color.into_iter().try_for_each(|component| within("base_color", component, 0.0..=1.0))?;
    finite("normal_scale", &[[material.normal_scale]])?;
    let lighting = &material.lighting;
    within("lighting.ka", lighting.ka, 0.0..=1.0)?;
    within("lighting.kd", lighting.kd, 0.0..=1.0)?;
    within("lighting.ks", lighting.ks, 0.0..=1.0)?;
    within("lighting.n", lighting.n, 1.0..=1000.0)
}

fn check_frame(frame: &FrameBegin) -> Result<(), CommandFault> {
    let camera = &frame.camera;
    let values =
        [("view_projection", &camera.view_projection[..]), ("to_light", &camera.to_light), ("to_viewer", &camera.to_viewer)];
    for (field, row) in values {
        if !row.iter().all(|value| value.is_finite()) {
            return Err(CommandFault::new(format!("camera.{field}"), "holds a number that is not finite"));
        }
    }
    direction("camera.to_light", &camera.to_light)?;
    direction("camera.to_viewer", &camera.to_viewer)?;
    if !(1..=MAX_LIGHTS).contains(&frame.lights.len()) {
        return Err(CommandFault::new("lights", format!("holds {} lights, expected 1..={MAX_LIGHTS}", frame.lights.len())));
    }
    for (i, light) in frame.lights.iter().enumerate() {
        let (LightRecord::Directional { to_light: [x, y, z], intensity } | LightRecord::Point { position: [x, y, z], intensity }) =
            *light;
        finite(&format!("lights[{i}]"), &[[x, y, z, intensity]])?;
        if intensity < 0.0 {
            return Err(CommandFault::new(format!("lights[{i}].intensity"), format!("is {intensity}, expected 0 or more")));
        }
        if let LightRecord::Directional { to_light, .. } = light {
            direction(&format!("lights[{i}].to_light"), to_light)?;
        }
    }
    Ok(())
}

/// Refuses a vector without a direction.
fn direction<T: PartialEq + Default>(field: &str, vector: &[T; 3]) -> Result<(), CommandFault> {
    if vector.iter().any(|component| *component != T::default()) {
        return Ok(());
    }
    Err(CommandFault::new(field, "is 0, 0, 0, expected a unit vector"))
}

fn check_object(object: &ObjectBegin) -> Result<(), CommandFault> {
    finite("centre", &[object.centre])?;
    object.entries.map_or(Ok(()), |entries| within("entries", entries, Object::ENTRIES))
}

fn check_shading(shading: &ShadingSettings) -> Result<(), CommandFault> {
    shading.out_of_range().map_or(Ok(()), |(name, value)| within(name, value, 0.0..=ShadingSettings::MAX_INTENSITY))
}

fn check_polygon(polygon: &PolygonRecord) -> Result<(), CommandFault> {
    within("lod", polygon.lod, 0..=63)?;
    within("arrival", polygon.arrival, 0..=MAX_ARRIVAL)?;
    let count = polygon.position.len();
    if !(3..=MAX_VERTICES).contains(&count) {
        return Err(CommandFault::new("position", format!("holds {count} vertices, expected 3..={MAX_VERTICES}")));
    }
    for (i, position) in polygon.position.iter().enumerate() {
        check_position(position).map_err(|message| CommandFault::new(format!("position[{i}]"), message))?;
    }
    if polygon.position.iter().all(|[_, _, depth, _]| *depth > FARTHEST) {
        let message =
            "has depths above 1 only, expected at least one in 0..=1: the polygon lies behind the far plane, leave it out";
        return Err(CommandFault::new("position", message));
    }
    attribute("normal", &polygon.normal, count)?;
    attribute("tangent", &polygon.tangent, count)?;
    attribute("uv", &polygon.uv, count)?;
    attribute("uv_normal", &polygon.uv_normal, count)?;
    attribute("color", &polygon.color, count)?;
    attribute("brightness", &polygon.brightness, count)
}

fn check_position(&[x, y, depth, reciprocal_w]: &[f32; 4]) -> Result<(), String> {
    let band = -GUARD_BAND..=GUARD_BAND;
    if !band.contains(&x) || !band.contains(&y) {
        return Err(format!("x, y is {x}, {y}, expected within +-{GUARD_BAND} pixels: clip the polygon"));
    }
    if !DEPTH.contains(&depth) {
        return Err(format!(
            "depth is {depth}, expected 0..=1, and for rounded corners at the near or far plane -1..=2: clip the polygon"
        ));
    }
    if !(reciprocal_w > 0.0 && reciprocal_w.is_finite()) {
        return Err(format!("1 / w is {reciprocal_w}, expected a positive number: clip the polygon"));
    }
    Ok(())
}

fn attribute<const N: usize>(field: &str, rows: &[[f32; N]], count: usize) -> Result<(), CommandFault> {
    if !rows.is_empty() && rows.len() != count {
        return Err(CommandFault::new(
            field,
            format!("holds {} vertices, expected {count} as in `position`, or none", rows.len()),
        ));
    }
    finite(field, rows)
}

fn check_expectation(expectation: &ExpectedResults) -> Result<(), CommandFault> {
    match expectation.config.iter().find(|(_, setting)| !setting.is_finite()) {
        Some((key, _)) => Err(CommandFault::new(format!("config.{key}"), "holds a number that is not finite")),
        None => Ok(()),
    }
}

fn within<T: PartialOrd + Display>(field: &str, value: T, range: RangeInclusive<T>) -> Result<(), CommandFault> {
    if range.contains(&value) {
        return Ok(());
    }
    Err(CommandFault::new(field, format!("is {value}, expected {}..={}", range.start(), range.end())))
}

fn finite<const N: usize>(field: &str, rows: &[[f32; N]]) -> Result<(), CommandFault> {
    if rows.as_flattened().iter().all(|value| value.is_finite()) {
        return Ok(());
    }
    let bad = rows.iter().position(|row| !row.iter().all(|value| value.is_finite())).unwrap_or(0);
    let place = if rows.len() > 1 { format!("{field}[{bad}]") } else { field.into() };
    Err(CommandFault::new(place, "holds a number that is not finite (too large for 32 bits, or NaN)"))
}
