//! From interpolated attributes to a colour: the one pixel pipeline of both entries.

use crate::light::Illumination;
use crate::picture::to_8_bits;
use crate::texture::{Footprint, sample};
use crate::{Components, Options};
use basrelief_signals::{Frame, Material, Texture};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// What is interpolated over a triangle, beside depth.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Attributes {
    pub normal: DVec3,
    pub tangent: DVec3,
    pub handedness: f64,
    pub uv: DVec2,
    pub uv_normal: DVec2,
    pub color: DVec3,
}

impl Attributes {
    /// Weighted sum.
    pub fn weighted<const N: usize>(parts: [&Attributes; N], weights: [f64; N]) -> Self {
        let mut sum = Self::default();
        for (part, weight) in parts.into_iter().zip(weights) {
            sum.normal += part.normal * weight;
            sum.tangent += part.tangent * weight;
            sum.handedness += part.handedness * weight;
            sum.uv += part.uv * weight;
            sum.uv_normal += part.uv_normal * weight;
            sum.color += part.color * weight;
        }
        sum
    }
}

/// A point of a surface: attributes, and how its texture coordinates change per pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    pub attributes: Attributes,
    pub uv: Footprint,
    pub uv_normal: Footprint,
    /// The triangle is seen from behind.
    pub back: bool,
}

/// A material under the lights of its frame, at the place of its object.
#[derive(Clone, Debug)]
pub(crate) struct Surface {
    options: Options,
    base: DVec3,
    color_texture: Option<Arc<Texture>>,
    normal_map: Option<Arc<Texture>>,
    normal_scale: f64,
    light: Illumination,
}

impl Surface {
    pub fn new(options: Options, frame: &Frame, material: &Material, centre: [f32; 3]) -> Self {
        let [r, g, b, _] = material.base_color.map(f64::from);
        Self {
            options,
            base: DVec3::new(r, g, b),
            color_texture: material.color_texture.clone(),
            normal_map: material.normal_map.clone(),
            normal_scale: f64::from(material.normal_scale),
            light: Illumination::new(frame, &material.lighting, centre),
        }
    }

    /// Colour of a point, 8 bits each.
    pub fn shade(&self, point: &Point) -> [u8; 3] {
        let mut base = self.base * point.attributes.color;
        if let Some(texture) = &self.color_texture {
            base *= sample(texture, self.options.filter, &point.uv);
        }
        let (diffuse, specular) = self.light.on(self.normal(point));
        let color = match self.options.components {
            Components::Combined => base * (diffuse + specular),
            Components::Separate => base * diffuse + specular,
        };
        color.to_array().map(to_8_bits)
    }

    fn normal(&self, point: &Point) -> DVec3 {
        let Attributes { normal, tangent, handedness, .. } = point.attributes;
        let bumped = self.normal_map.as_ref().map_or(normal, |map| {
            let texel = sample(map, self.options.filter, &point.uv_normal) * 2.0 - 1.0;
            let bitangent = normal.cross(tangent) * handedness;
            (tangent * texel.x + bitangent * texel.y) * self.normal_scale + normal * texel.z
        });
        let unit = bumped.normalize_or_zero();
        if point.back && self.options.two_sided_lighting { -unit } else { unit }
    }
}
