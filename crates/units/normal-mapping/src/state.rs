//! State of the normal-vector mapping unit (108) between steps.

use crate::DistinctCounter;
use basrelief_kernel::Cached;
use basrelief_shading::{AttributeGradient, LevelPlace, LevelSet, fan_triangle};
use basrelief_signals::{MAX_SAMPLES, Polygon};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Attributes over a triangle, computed from polygon and triangle.
#[derive(Clone, Debug)]
pub(crate) struct TriangleSetup {
    pub(crate) triangle: u16,
    /// Normal, tangent, coordinates of the normal map.
    pub(crate) attributes: AttributeGradient<8>,
    pub(crate) handedness: f32,
}

impl TriangleSetup {
    pub(crate) fn new(polygon: &Polygon, triangle: u16) -> Option<Self> {
        let corners = fan_triangle(polygon, triangle)?;
        let [a, b, c] = corners.map(|v| {
            let ([nx, ny, nz], [tx, ty, tz, _], [u, v]) = (v.normal, v.tangent, v.uv_normal);
            [nx, ny, nz, tx, ty, tz, u, v]
        });
        Some(Self { triangle, attributes: AttributeGradient::new([&a, &b, &c]), handedness: corners[0].tangent[3] })
    }
}

/// Polygon being mapped, values computed from it, and the counters.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NormalMappingState {
    /// Polygon of the next fragments.
    pub polygon: Option<Arc<Polygon>>,
    /// MIP levels selected by the polygon's LOD.
    pub levels: LevelSet,
    /// Position of each selected level of the polygon's normal map.
    pub places: [LevelPlace; MAX_SAMPLES],
    /// Set-up of the triangle of the last fragment.
    #[serde(skip)]
    pub(crate) setup: Cached<TriangleSetup>,
    /// Counters.
    pub counters: NormalMappingCounters,
}

/// Counters of the normal-vector mapping unit (108).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NormalMappingCounters {
    /// Fragments mapped.
    pub fragments: u64,
    /// Of these, fragments of bump targets.
    pub bump_fragments: u64,
    /// Texels used. Several may lie in one cache line.
    pub texels: u64,
    /// Pseudo-normals sent.
    pub pseudo_normals: u64,
    /// Distinct pseudo-normals.
    pub distinct: DistinctCounter,
}
