//! What the normal-vector mapping unit (108) keeps between steps.

use crate::DistinctCounter;
use basrelief_kernel::Derived;
use basrelief_shading::{Gradient, LevelPlace, LevelSet, fan_triangle};
use basrelief_signals::{MAX_SAMPLES, Polygon};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Attributes over a triangle; follows from polygon and triangle.
#[derive(Clone, Debug)]
pub(crate) struct Setup {
    pub(crate) triangle: u16,
    /// Normal, tangent, coordinates of the normal map.
    pub(crate) attributes: Gradient<8>,
    pub(crate) handedness: f32,
}

impl Setup {
    pub(crate) fn new(polygon: &Polygon, triangle: u16) -> Option<Self> {
        let corners = fan_triangle(polygon, triangle)?;
        let [a, b, c] = corners.map(|v| {
            let ([nx, ny, nz], [tx, ty, tz, _], [u, v]) = (v.normal, v.tangent, v.uv_normal);
            [nx, ny, nz, tx, ty, tz, u, v]
        });
        Some(Self { triangle, attributes: Gradient::new([&a, &b, &c]), handedness: corners[0].tangent[3] })
    }
}

/// The polygon being mapped, what follows from it, and the counters.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NormalMappingState {
    /// The fragments that come are of this polygon.
    pub polygon: Option<Arc<Polygon>>,
    /// MIP levels that its LOD selects.
    pub levels: LevelSet,
    /// Where each selected level of its normal map lies.
    pub places: [LevelPlace; MAX_SAMPLES],
    /// Of the triangle that the last fragment was in.
    #[serde(skip)]
    pub(crate) setup: Derived<Setup>,
    /// What it has counted.
    pub counters: NormalMappingCounters,
}

/// What the normal-vector mapping unit (108) has counted.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NormalMappingCounters {
    /// Fragments mapped.
    pub fragments: u64,
    /// Of these, fragments of bump targets.
    pub bump_fragments: u64,
    /// Texels used; several may lie in one cache line.
    pub texels: u64,
    /// Pseudo-normals handed on.
    pub pseudo_normals: u64,
    /// How many of them were distinct.
    pub distinct: DistinctCounter,
}
