//! Cameras and lights of a document.

use super::json::{CameraDef, GltfDocument, LightDef};
use super::nodes::PlacedNode;
use crate::SceneError;
use crate::camera::{Projection, Viewpoint};
use crate::error::ImportWarnings;
use crate::view::LightSource;
use glam::{DMat4, DVec3};

/// The camera of the first node that has one, and its ratio of width to height if it states one.
pub(crate) fn camera(
    document: &GltfDocument,
    nodes: &[PlacedNode],
    warnings: &mut ImportWarnings,
) -> Result<Option<(Viewpoint, Option<f64>)>, SceneError> {
    for (i, definition) in document.cameras.iter().enumerate() {
        lens(definition, i)?;
    }
    let mut used = nodes.iter().filter_map(|n| Some((n, document.nodes.get(n.index)?.camera?)));
    let Some((node, index)) = used.next() else { return Ok(None) };
    if used.next().is_some() {
        warnings.add(format!("several nodes have cameras: that of /nodes/{} is used", node.index));
    }
    let definition = super::check::resolve(&document.cameras, "cameras", index, || format!("/nodes/{}/camera", node.index))?;
    let viewpoint = Viewpoint::placed(node.world, lens(definition, index.index())?);
    if viewpoint.is_none() {
        warnings.add(format!("the transform of /nodes/{} flattens its camera: not used", node.index));
    }
    Ok(viewpoint.map(|viewpoint| (viewpoint, ratio(definition))))
}

/// Ratio of width to height that a camera states.
fn ratio(CameraDef { perspective, orthographic, .. }: &CameraDef) -> Option<f64> {
    let of_perspective = perspective.and_then(|camera| camera.aspect_ratio);
    let ratio = of_perspective.or(orthographic.map(|camera| (camera.xmag / camera.ymag).abs()));
    ratio.filter(|ratio| *ratio > 0.0 && ratio.is_finite())
}

fn lens(camera: &CameraDef, i: usize) -> Result<Projection, SceneError> {
    let fail =
        |field: &str, what: String, expected: &str| Err(SceneError::at(format!("/cameras/{i}/{field}"), what).expected(expected));
    match (camera.kind.as_str(), camera.perspective, camera.orthographic) {
        ("perspective", Some(p), _) => {
            let far = p.zfar.unwrap_or(f64::INFINITY);
            if !(p.yfov > 0.0 && p.yfov < std::f64::consts::PI) {
                return fail("perspective/yfov", format!("is {}", p.yfov), "an angle between 0 and pi");
            }
            if !(p.znear > 0.0 && far > p.znear) {
                return fail("perspective/znear", format!("is {}, zfar {far}", p.znear), "0 < znear < zfar");
            }
            Ok(Projection::Perspective { field: p.yfov, near: p.znear, far })
        }
        ("orthographic", _, Some(o)) => {
            if o.xmag == 0.0 || o.ymag == 0.0 {
                let field = if o.xmag == 0.0 { "orthographic/xmag" } else { "orthographic/ymag" };
                return fail(field, "is 0".into(), "half the size of the view");
            }
            if !(o.znear >= 0.0 && o.zfar > o.znear) {
                return fail("orthographic", format!("znear is {}, zfar {}", o.znear, o.zfar), "0 <= znear < zfar");
            }
            Ok(Projection::Orthographic { half_height: o.ymag.abs(), near: o.znear, far: o.zfar })
        }
        ("perspective" | "orthographic", ..) => fail(&camera.kind, "is missing".into(), "an object with the camera's numbers"),
        (other, ..) => fail("type", format!("`{other}`"), "perspective or orthographic"),
    }
}

/// The lights of the visible nodes. Intensities in a file are physical (lux, candela). The devices have a factor in the
/// lighting formula, so intensities are scaled: the strongest is 1 at the centre of the model.
pub(crate) fn lamps(
    document: &GltfDocument,
    nodes: &[PlacedNode],
    centre: DVec3,
    warnings: &mut ImportWarnings,
) -> Result<Vec<(LightSource, f64)>, SceneError> {
    let definitions = document.extensions.lights.as_ref().map_or(&[][..], |l| &l.lights);
    for (i, definition) in definitions.iter().enumerate() {
        check_light(definition, i)?;
    }
    let (mut lamps, mut placed) = (Vec::new(), 0);
    for node in nodes.iter().filter(|node| node.visible) {
        let reference = document.nodes.get(node.index).and_then(|n| n.extensions.as_ref()?.light.as_ref());
        let Some(definition) = reference.and_then(|r| definitions.get(r.light.index())) else { continue };
        placed += 1;
        let lamp = lamp(definition, node, warnings)?;
        let illuminance = luminance(definition, warnings) * falloff(lamp, centre);
        if !illuminance.is_finite() {
            return Err(SceneError::at(format!("/nodes/{}", node.index), "its light is infinitely strong at the model's centre")
                .expected("a light whose color, intensity and distance are of ordinary size"));
        }
        if illuminance > 0.0 {
            lamps.push((lamp, illuminance));
        }
    }
    if placed > 0 && lamps.is_empty() {
        warnings.add("all lights of the file are dark: the default light is used");
    }
    let strongest = lamps.iter().map(|(_, i)| *i).fold(0.0, f64::max);
    if lamps.iter().any(|(_, i)| *i != 1.0) {
        warnings.add("intensities of lights are physical: scaled so that the strongest is 1 at the model's centre");
    }
    if lamps.iter().any(|(lamp, _)| matches!(lamp, LightSource::Point(_))) {
        warnings.add(
            "point lights have no falloff with distance, and one direction for each object: each is as strong everywhere as at the \
             model's centre, and shines on a whole object from where it stands as seen from the object's centre",
        );
    }
    Ok(lamps.into_iter().map(|(lamp, i)| (lamp, i / strongest)).collect())
}

fn check_light(light: &LightDef, i: usize) -> Result<(), SceneError> {
    let place = |field: &str| format!("/extensions/KHR_lights_punctual/lights/{i}/{field}");
    if !["directional", "point", "spot"].contains(&light.kind.as_str()) {
        return Err(SceneError::at(place("type"), format!("`{}`", light.kind)).expected("directional, point or spot"));
    }
    if light.intensity < 0.0 || light.color.iter().any(|c| *c < 0.0) {
        return Err(SceneError::at(place("intensity"), "a light that takes light away").expected("no negative number"));
    }
    Ok(())
}

fn lamp(light: &LightDef, node: &PlacedNode, warnings: &mut ImportWarnings) -> Result<LightSource, SceneError> {
    let DMat4 { z_axis, w_axis, .. } = node.world;
    if light.kind == "directional" {
        // It shines along -z.
        return Ok(LightSource::Directional(z_axis.truncate().normalize_or(DVec3::Z)));
    }
    if light.range.is_some() {
        warnings.add("`range` of lights is not used: they reach everywhere");
    }
    if light.kind == "spot" {
        warnings.add(format!("the spot light of /nodes/{} is drawn as a point light", node.index));
    }
    let position = w_axis.truncate();
    if !position.as_vec3().is_finite() {
        return Err(SceneError::at(format!("/nodes/{}", node.index), "its light lies beyond single precision")
            .expected("a transform of ordinary size"));
    }
    Ok(LightSource::Point(position))
}

/// Brightness of a light of this colour (Rec. 709); these devices have white light only.
fn luminance(light: &LightDef, warnings: &mut ImportWarnings) -> f64 {
    let [r, g, b] = light.color;
    if r != g || g != b {
        warnings.add("coloured lights are drawn white, with the luminance of their colour (Rec. 709)");
    }
    (0.2126 * r + 0.7152 * g + 0.0722 * b) * light.intensity
}

/// Factor of the intensity of a light at the centre of the model, by its distance.
fn falloff(lamp: LightSource, centre: DVec3) -> f64 {
    match lamp {
        LightSource::Directional(_) => 1.0,
        LightSource::Point(p) => {
            let squared = (p - centre).length_squared();
            if squared.is_normal() { 1.0 / squared } else { 1.0 }
        }
    }
}
