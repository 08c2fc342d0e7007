//! Checks of a document before its data are read: version, extensions, references.

use super::json::{GltfDocument, GltfInteger, GltfNode, GltfPrimitive, MaterialDef, TextureInfo};
use super::pointer::escape;
use crate::SceneError;
use crate::error::ImportWarnings;
use crate::files::shorten;

/// Extensions that are fully supported.
pub(super) const SUPPORTED: [&str; 4] =
    ["KHR_lights_punctual", "KHR_texture_transform", "KHR_mesh_quantization", "KHR_node_visibility"];

/// Extensions that refine how light interacts with a metallic-roughness surface. The lighting formula of these devices
/// knows neither metal nor roughness, so a file that requires one of them is drawn without.
const REFINEMENTS: [&str; 10] = [
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_volume",
];

/// The element that a reference means, or an error that says how many there are.
pub(crate) fn resolve<'a, T>(
    list: &'a [T],
    name: &str,
    reference: GltfInteger,
    place: impl FnOnce() -> String,
) -> Result<&'a T, SceneError> {
    list.get(reference.index()).ok_or_else(|| {
        let expected = match list.len() {
            0 => format!("no reference, since the file has no {name}"),
            n => format!("0..={}, since the file has {n} {name}", n - 1),
        };
        SceneError::at(place(), format!("refers to element {} of /{name}, which does not exist", reference.0))
            .expected(expected)
            .cure("export the model again")
    })
}

/// Checks version, extensions, references and strides.
pub(crate) fn check(document: &GltfDocument, warnings: &mut ImportWarnings) -> Result<(), SceneError> {
    check_version(document, warnings)?;
    check_extensions(document, warnings)?;
    for (i, node) in document.nodes.iter().enumerate() {
        check_node(document, i, node)?;
    }
    for (i, scene) in document.scenes.iter().enumerate() {
        for (j, node) in scene.nodes.iter().enumerate() {
            resolve(&document.nodes, "nodes", *node, || format!("/scenes/{i}/nodes/{j}"))?;
        }
    }
    for (i, mesh) in document.meshes.iter().enumerate() {
        for (j, primitive) in mesh.primitives.iter().enumerate() {
            check_primitive(document, &format!("/meshes/{i}/primitives/{j}"), primitive)?;
        }
    }
    for (i, material) in document.materials.iter().enumerate() {
        check_material(document, i, material)?;
    }
    for (i, skin) in document.skins.iter().enumerate() {
        if let Some(matrices) = skin.inverse_bind_matrices {
            resolve(&document.accessors, "accessors", matrices, || format!("/skins/{i}/inverseBindMatrices"))?;
        }
        for (j, joint) in skin.joints.iter().enumerate() {
            resolve(&document.nodes, "nodes", *joint, || format!("/skins/{i}/joints/{j}"))?;
        }
    }
    check_textures(document)?;
    check_data(document)?;
    check_strides(document, warnings);
    if !document.animations.is_empty() {
        warnings.add("animations are ignored: the model is drawn at rest");
    }
    Ok(())
}

fn check_version(document: &GltfDocument, warnings: &mut ImportWarnings) -> Result<(), SceneError> {
    let asset = &document.asset;
    let parts = |version: &str| -> Option<(u32, u32)> {
        let (major, minor) = version.split_once('.')?;
        let digits = |s: &str| !s.is_empty() && s.bytes().all(|b| b.is_ascii_digit());
        if digits(major) && digits(minor) { Some((major.parse().ok()?, minor.parse().ok()?)) } else { None }
    };
    let fail = |name: &str, version: &str| {
        Err(SceneError::at(format!("/asset/{name}"), format!("glTF version `{version}`"))
            .expected("2.0")
            .cure("convert the model to glTF 2.0"))
    };
    match parts(&asset.version) {
        Some((2, 0)) => {}
        Some((2, _)) => warnings.add(format!("glTF version {} is read as 2.0", asset.version)),
        _ => return fail("version", &asset.version),
    }
    match asset.min_version.as_deref() {
        Some(least) if parts(least) != Some((2, 0)) => fail("minVersion", least),
        _ => Ok(()),
    }
}

fn check_extensions(document: &GltfDocument, warnings: &mut ImportWarnings) -> Result<(), SceneError> {
    for (i, name) in document.extensions_required.iter().enumerate() {
        let name = name.as_str();
        if !SUPPORTED.contains(&name) && !REFINEMENTS.contains(&name) {
            return Err(SceneError::at(
                format!("/extensionsRequired/{i}"),
                format!("requires the extension `{name}`, which is not supported"),
            )
            .expected(format!("only {}", SUPPORTED.join(", ")))
            .cure("export the model without it"));
        }
    }
    for name in document.extensions_used.iter().filter(|n| !SUPPORTED.contains(&n.as_str())) {
        warnings.add(unsupported(name));
    }
    Ok(())
}

/// Returns the warning of an extension that is left out.
pub(super) fn unsupported(name: &str) -> String {
    format!("the extension `{}` is not supported: drawn without it", shorten(name))
}

fn check_node(document: &GltfDocument, i: usize, node: &GltfNode) -> Result<(), SceneError> {
    let place = |field: &str| format!("/nodes/{i}/{field}");
    for (j, child) in node.children.iter().enumerate() {
        resolve(&document.nodes, "nodes", *child, || place(&format!("children/{j}")))?;
    }
    let parts =
        [("translation", node.translation.is_some()), ("rotation", node.rotation.is_some()), ("scale", node.scale.is_some())];
    if let (Some(_), Some((part, _))) = (&node.matrix, parts.iter().find(|(_, given)| *given)) {
        return Err(SceneError::at(place("matrix"), format!("stands beside `{part}`, and readers differ in which they take"))
            .expected("either a matrix, or any of translation, rotation and scale")
            .cure("remove the one that is not meant"));
    }
    if let Some(mesh) = node.mesh {
        resolve(&document.meshes, "meshes", mesh, || place("mesh"))?;
    }
    if let Some(camera) = node.camera {
        resolve(&document.cameras, "cameras", camera, || place("camera"))?;
    }
    if let Some(skin) = node.skin {
        resolve(&document.skins, "skins", skin, || place("skin"))?;
    }
    if let Some(light) = node.extensions.as_ref().and_then(|e| e.light.as_ref()) {
        let lights = document.extensions.lights.as_ref().map_or(&[][..], |l| &l.lights);
        resolve(lights, "extensions/KHR_lights_punctual/lights", light.light, || place("extensions/KHR_lights_punctual/light"))?;
    }
    Ok(())
}

fn check_primitive(document: &GltfDocument, place: &str, primitive: &GltfPrimitive) -> Result<(), SceneError> {
    for (name, accessor) in &primitive.attributes {
        resolve(&document.accessors, "accessors", *accessor, || format!("{place}/attributes/{}", escape(name)))?;
    }
    for (i, target) in primitive.targets.iter().enumerate() {
        for (name, accessor) in target {
            resolve(&document.accessors, "accessors", *accessor, || format!("{place}/targets/{i}/{}", escape(name)))?;
        }
    }
    if let Some(indices) = primitive.indices {
        resolve(&document.accessors, "accessors", indices, || format!("{place}/indices"))?;
    }
    if let Some(material) = primitive.material {
        resolve(&document.materials, "materials", material, || format!("{place}/material"))?;
    }
    match primitive.mode {
        Some(mode) if mode.0 > 6 => Err(SceneError::at(format!("{place}/mode"), format!("mode {}", mode.0)).expected("0..=6")),
        _ => Ok(()),
    }
}

fn check_material(document: &GltfDocument, i: usize, material: &MaterialDef) -> Result<(), SceneError> {
    let pbr = material.pbr_metallic_roughness.as_ref();
    let infos: [(&str, Option<&TextureInfo>); 5] = [
        ("pbrMetallicRoughness/baseColorTexture", pbr.and_then(|p| p.base_color_texture.as_ref())),
        ("pbrMetallicRoughness/metallicRoughnessTexture", pbr.and_then(|p| p.metallic_roughness_texture.as_ref())),
        ("normalTexture", material.normal_texture.as_ref()),
        ("occlusionTexture", material.occlusion_texture.as_ref()),
        ("emissiveTexture", material.emissive_texture.as_ref()),
    ];
    for (field, info) in infos.into_iter().filter_map(|(field, info)| Some((field, info?))) {
        resolve(&document.textures, "textures", info.index, || format!("/materials/{i}/{field}/index"))?;
    }
    Ok(())
}

fn check_textures(document: &GltfDocument) -> Result<(), SceneError> {
    for (i, texture) in document.textures.iter().enumerate() {
        if let Some(sampler) = texture.sampler {
            resolve(&document.samplers, "samplers", sampler, || format!("/textures/{i}/sampler"))?;
        }
        if let Some(source) = texture.source {
            resolve(&document.images, "images", source, || format!("/textures/{i}/source"))?;
        }
        for (name, other) in &texture.extensions {
            if let Some(source) = other.source {
                let place = || format!("/textures/{i}/extensions/{}/source", escape(name));
                resolve(&document.images, "images", source, place)?;
            }
        }
    }
    Ok(())
}

/// Warns of strides that glTF forbids. They still define the places of the elements.
fn check_strides(document: &GltfDocument, warnings: &mut ImportWarnings) {
    let strides = document.buffer_views.iter().enumerate().filter_map(|(i, view)| Some((i, view.byte_stride?.0)));
    for (i, stride) in strides.filter(|(_, stride)| !(4..=252).contains(stride) || !stride.is_multiple_of(4)) {
        warnings.add(format!("/bufferViews/{i}/byteStride: is {stride}, expected a multiple of 4 in 4..=252: read as it stands"));
    }
}

fn check_data(document: &GltfDocument) -> Result<(), SceneError> {
    for (i, image) in document.images.iter().enumerate() {
        if let Some(view) = image.buffer_view {
            resolve(&document.buffer_views, "bufferViews", view, || format!("/images/{i}/bufferView"))?;
        }
    }
    for (i, view) in document.buffer_views.iter().enumerate() {
        resolve(&document.buffers, "buffers", view.buffer, || format!("/bufferViews/{i}/buffer"))?;
    }
    for (i, accessor) in document.accessors.iter().enumerate() {
        let views = &document.buffer_views;
        if let Some(view) = accessor.buffer_view {
            resolve(views, "bufferViews", view, || format!("/accessors/{i}/bufferView"))?;
        }
        if let Some(sparse) = &accessor.sparse {
            let place = |part: &str| format!("/accessors/{i}/sparse/{part}/bufferView");
            resolve(views, "bufferViews", sparse.indices.buffer_view, || place("indices"))?;
            resolve(views, "bufferViews", sparse.values.buffer_view, || place("values"))?;
        }
    }
    Ok(())
}
