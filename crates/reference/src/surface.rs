//! Colour of interpolated attributes: the one pixel pipeline of both entries.

use crate::light::ObjectLight;
use crate::picture::to_8_bits;
use crate::pyramid::PyramidCache;
use crate::texture::{TextureFootprint, sample};
use crate::{BrightnessComponents, PyramidLevels, RenderOptions, RenderStyle, ShadingModel, TextureFilter};
use basrelief_signals::{Frame, Material, Texture};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// Values interpolated over a triangle besides depth.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PixelAttributes {
    pub normal: DVec3,
    pub tangent: DVec3,
    pub handedness: f64,
    pub uv: DVec2,
    pub uv_normal: DVec2,
    pub color: DVec3,
    /// Light on the vertex, unless it is computed per pixel.
    pub lit: LightTerms,
}

/// Light times a vertex colour: the two terms of the lighting formula, before factor and texture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LightTerms {
    /// Ambient and diffuse, times the vertex colour.
    pub diffuse: DVec3,
    /// Specular, times the vertex colour if the components are combined.
    pub specular: DVec3,
}

impl LightTerms {
    fn add(&mut self, other: &Self, weight: f64) {
        self.diffuse += other.diffuse * weight;
        self.specular += other.specular * weight;
    }
}

impl PixelAttributes {
    /// Returns the weighted sum.
    pub fn weighted<const N: usize>(parts: [&PixelAttributes; N], weights: [f64; N]) -> Self {
        let mut sum = Self::default();
        for (part, weight) in parts.into_iter().zip(weights) {
            sum.normal += part.normal * weight;
            sum.tangent += part.tangent * weight;
            sum.handedness += part.handedness * weight;
            sum.uv += part.uv * weight;
            sum.uv_normal += part.uv_normal * weight;
            sum.color += part.color * weight;
            sum.lit.add(&part.lit, weight);
        }
        sum
    }
}

/// A point of a surface: attributes, and the change of its texture coordinates per pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfacePoint {
    pub attributes: PixelAttributes,
    pub uv: TextureFootprint,
    pub uv_normal: TextureFootprint,
    /// True if the triangle is seen from behind.
    pub back: bool,
}

/// A material under the lights of its frame, at the position of its object.
#[derive(Clone, Debug)]
pub(crate) struct LitSurface {
    style: RenderStyle,
    base: DVec3,
    color_texture: Option<Arc<Texture>>,
    normal_map: Option<Arc<Texture>>,
    normal_scale: f64,
    light: ObjectLight,
}

impl LitSurface {
    pub fn new(style: RenderStyle, frame: &Frame, material: &Material, centre: [f32; 3], pyramids: &mut PyramidCache) -> Self {
        let [r, g, b, _] = material.base_color.map(f64::from);
        let mapped = style.shading == ShadingModel::NormalMap && style.options.filter != TextureFilter::None;
        Self {
            style,
            base: DVec3::new(r, g, b),
            color_texture: material.color_texture.as_ref().map(|texture| pyramids.of(texture, &style.options)),
            normal_map: material.normal_map.clone().filter(|_| mapped),
            normal_scale: f64::from(material.normal_scale),
            light: ObjectLight::new(frame, &material.lighting, centre),
        }
    }

    /// Lights the vertices of a polygon, unless lighting is per pixel. `face` returns its geometric normal, of any length. `back`
    /// is true if it is seen from behind.
    pub fn light<V: AsMut<PixelAttributes>>(&self, vertices: &mut [V], face: impl FnOnce(&[V]) -> DVec3, back: bool) {
        let normal = match self.style.shading {
            ShadingModel::NormalMap | ShadingModel::Phong | ShadingModel::Texture => return,
            ShadingModel::Face => Some(face(vertices)),
            ShadingModel::Gouraud | ShadingModel::Mean => None,
        };
        let weight = 1.0 / vertices.len() as f64;
        let mut mean = LightTerms::default();
        for vertex in vertices.iter_mut().map(AsMut::as_mut) {
            vertex.lit = self.lit(vertex.color, normal.unwrap_or(vertex.normal), back);
            mean.add(&vertex.lit, weight);
        }
        if self.style.shading == ShadingModel::Mean {
            vertices.iter_mut().for_each(|vertex| vertex.as_mut().lit = mean);
        }
    }

    /// Returns the colour of a point, 8 bits each.
    pub fn shade(&self, point: &SurfacePoint) -> [u8; 3] {
        let mut base = self.base;
        if let Some(texture) = &self.color_texture {
            base *= sample(texture, &self.style.options, &point.uv);
        }
        let lit = match self.style.shading {
            ShadingModel::NormalMap | ShadingModel::Phong => self.lit(point.attributes.color, self.normal(point), point.back),
            ShadingModel::Gouraud | ShadingModel::Face | ShadingModel::Mean => point.attributes.lit,
            ShadingModel::Texture => LightTerms { diffuse: point.attributes.color, specular: DVec3::ZERO },
        };
        let color = match self.style.options.components {
            BrightnessComponents::Combined => base * (lit.diffuse + lit.specular),
            BrightnessComponents::Separate => base * lit.diffuse + lit.specular,
        };
        color.to_array().map(to_8_bits)
    }

    /// Returns the light at a point of this colour. Normals need not have length 1.
    fn lit(&self, color: DVec3, normal: DVec3, back: bool) -> LightTerms {
        let unit = normal.normalize_or_zero();
        let (diffuse, specular) = self.light.on(if back && self.style.options.two_sided_lighting { -unit } else { unit });
        let highlight = match self.style.options.components {
            BrightnessComponents::Combined => color,
            BrightnessComponents::Separate => DVec3::ONE,
        };
        LightTerms { diffuse: color * diffuse, specular: highlight * specular }
    }

    /// Returns the normal before it is normalised.
    fn normal(&self, point: &SurfacePoint) -> DVec3 {
        let PixelAttributes { normal, tangent, handedness, .. } = point.attributes;
        self.normal_map.as_ref().map_or(normal, |map| {
            let options = RenderOptions { pyramid: PyramidLevels::Given, ..self.style.options };
            let texel = sample(map, &options, &point.uv_normal) * 2.0 - 1.0;
            let bitangent = normal.cross(tangent) * handedness;
            (tangent * texel.x + bitangent * texel.y) * self.normal_scale + normal * texel.z
        })
    }
}

/// Returns the geometric normal of a polygon, of any length. Its corners run counter-clockwise around it.
pub(crate) fn face_normal(corners: &[DVec3]) -> DVec3 {
    let Some((first, rest)) = corners.split_first() else { return DVec3::ZERO };
    rest.windows(2).map(|pair| (pair[0] - first).cross(pair[1] - first)).sum()
}
