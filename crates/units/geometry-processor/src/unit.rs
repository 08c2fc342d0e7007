//! Geometry processor (102).

use crate::clip::{ClipResult, clip};
use crate::config::{BumpConfig, BumpTargets, BumpUnit, GeometryConfig};
use crate::link::POLYGON_BYTES;
use crate::object_lod::{self, object_lod};
use crate::state::GeometryProcessorState;
use crate::transform::{ClipCorner, ObjectTransform, centre};
use crate::window::WindowTransform;
use crate::work::{self, StepCharge, index_bytes, vertex_bytes};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, MemoryPorts, Operators, Step, Unit};
use basrelief_shading::{brightness, doubled_area, light_vectors, polygon_lod};
use basrelief_signals::{Control, Draw, Frame, LightingStage, MeshInfo, Object, ObjectInfo, Polygon, Vertex, VertexAttributes};
use glam::Vec3;
use std::sync::Arc;

/// Geometry processor (102): transforms, clips, culls and projects indexed triangles. It gives each polygon its LOD and decides
/// on bump targets. A triangle becomes one convex polygon or none.
///
/// Degenerate triangles are dropped: a triangle without object or frame, or with a missing vertex; one with a clip-space
/// coordinate that is not finite; a polygon with fewer than three corners, a w that is not positive, or a window area that is
/// zero or not finite.
///
/// The occupancy of a step is the longest of its arithmetic, of fetching its vertices and indices, and of the link for its
/// polygon. All three run in parallel. A polygon is delivered when its last part has arrived. Frame and frame-end commands take a
/// cycle, and an object takes the time of its matrices and lights.
///
/// Polygons that are not bump targets carry their brightness at the vertices (Gouraud). A display list has it for every machine,
/// but it costs time only if the machine accepts it.
#[derive(Clone, Debug, Default)]
pub struct GeometryProcessor {
    /// Parameters.
    pub config: GeometryConfig,
    /// Parameters of the bump decision.
    pub bump: BumpConfig,
    /// Vertex attributes that the machine accepts.
    pub taken: VertexAttributes,
    /// Latencies of the operators.
    pub operators: Operators,
    /// State between steps.
    pub state: GeometryProcessorState,
}

/// Reason for which a triangle is dropped.
enum DropReason {
    Outside,
    Culled,
    Degenerate,
}

impl GeometryProcessor {
    /// Creates a geometry processor in its power-on state, for a machine that accepts these vertex attributes.
    pub fn new(config: GeometryConfig, bump: BumpConfig, taken: VertexAttributes, operators: Operators) -> Self {
        Self { config, bump, taken, operators, state: GeometryProcessorState::default() }
    }

    fn begin_object(&mut self, object: Arc<Object>) -> ObjectInfo {
        let centre = centre(&object);
        if let Some(frame) = &self.state.frame {
            self.state.transform = ObjectTransform::new(&frame.camera.view_projection, &object.world);
            self.state.lights = light_vectors(frame, centre);
        }
        self.state.cache.clear();
        let by_object = (self.bump.unit == BumpUnit::Object).then_some(self.state.frame.as_ref()).flatten();
        self.state.object_lod = by_object.map(|frame| object_lod(&object, centre, frame));
        let info = ObjectInfo {
            id: object.id,
            name: object.name.clone(),
            centre,
            entries: object.entries,
            bias: object.bias,
            shading: object.shading,
            mesh: Some(mesh_of(&object)),
        };
        self.state.object = Some(object);
        info
    }

    /// Returns the polygon of triangle `number` of the current object, and its occupancy in cycles.
    fn triangle(&mut self, number: u32) -> (Option<Polygon>, u64) {
        self.state.counters.triangles += 1;
        // Both are moved out during the step. Counting their references would cost a twentieth of it.
        let drawn = (self.state.object.take(), self.state.frame.take());
        let mut charge = StepCharge::default();
        let polygon = match &drawn {
            (Some(object), Some(frame)) => self.polygon(object, frame, number, &mut charge),
            _ => Err(DropReason::Degenerate),
        };
        (self.state.object, self.state.frame) = drawn;
        let counters = &mut self.state.counters;
        counters.vertex_bytes += charge.fetched;
        let polygon = match polygon {
            Ok(polygon) => Some(polygon),
            Err(reason) => {
                *match reason {
                    DropReason::Outside => &mut counters.outside,
                    DropReason::Culled => &mut counters.culled,
                    DropReason::Degenerate => &mut counters.degenerate,
                } += 1;
                None
            }
        };
        let bytes = polygon.as_ref().map_or(0, |polygon| polygon.bytes(self.taken));
        counters.polygon_bytes += bytes;
        (polygon, self.kept(charge, bytes))
    }

    fn polygon(&mut self, object: &Object, frame: &Frame, number: u32, charge: &mut StepCharge) -> Result<Polygon, DropReason> {
        let mut triangle = [ClipCorner::default(); 3];
        self.corners(object, number, &mut triangle, charge).ok_or(DropReason::Degenerate)?;
        if !triangle.iter().all(|c| c.clip.is_finite()) {
            return Err(DropReason::Degenerate);
        }
        let clipped = clip(&triangle);
        let corners = match &clipped {
            ClipResult::Outside => return Err(DropReason::Outside),
            ClipResult::Whole => &triangle[..],
            ClipResult::Cut { corners, made } => {
                self.state.counters.clipped += 1;
                charge.add(work::cut_vertex(self.fetched(object)).times(*made));
                corners
            }
        };
        charge.add(work::area(corners.len()));
        let window = WindowTransform::new(frame);
        // Half of all triangles face away, so attributes are computed only for the others.
        let is_back = self.faces_back(object, corners, &window)?;
        let mut vertices: Vec<Vertex> = corners.iter().map(|c| Vertex { position: window.place(c), ..c.vertex }).collect();
        let is_turned = is_back && self.config.two_sided_lighting;
        if is_turned {
            turn_round(&mut vertices);
        }
        let lod = self.lod(object, &vertices, charge);
        let bump = object.bump.unwrap_or(self.is_target(object, lod));
        if !bump {
            // Vertices that were clipped or turned round belong to this polygon only.
            let own = is_turned || matches!(clipped, ClipResult::Cut { .. });
            let unlit = if own { vertices.len() } else { self.unlit(object, number) };
            self.light(object, &mut vertices, unlit as u32, charge);
        }
        self.state.counters.polygons += 1;
        self.state.counters.bump_polygons += u64::from(bump);
        Ok(Polygon { vertices, material: Arc::clone(&object.material), object: object.id, lod, bump, arrival: 0 })
    }

    /// Returns the LOD of a polygon. It is charged if the machine has maps whose levels it selects.
    fn lod(&self, object: &Object, vertices: &[Vertex], charge: &mut StepCharge) -> u8 {
        if let Some(lod) = self.state.object_lod {
            return lod;
        }
        let lod = match (&object.material.normal_map, &object.material.color_texture) {
            (Some(map), _) => polygon_lod(vertices, map, |v| v.uv_normal),
            (None, Some(texture)) => polygon_lod(vertices, texture, |v| v.uv),
            (None, None) => return 0,
        };
        if self.taken.normal_maps {
            charge.add(work::lod(vertices.len()));
        }
        lod
    }

    /// Lights the vertices of a polygon that is not a bump target. `unlit` vertices are charged if the machine accepts the
    /// brightness.
    fn light(&mut self, object: &Object, vertices: &mut [Vertex], unlit: u32, charge: &mut StepCharge) {
        let (lighting, lights) = (&object.material.lighting, &self.state.lights);
        for vertex in vertices {
            vertex.brightness = brightness(Vec3::from(vertex.normal), lighting, lights);
        }
        if matches!(self.taken.lit, LightingStage::AtVertices | LightingStage::Targets) {
            self.state.counters.vertices_lit += u64::from(unlit);
            charge.add(work::lighting(lighting, lights.len() as u32).times(unlit));
        }
    }

    /// Returns the number of vertices of a triangle that were not lit in the vertex cache, and marks them as lit.
    fn unlit(&mut self, object: &Object, number: u32) -> usize {
        let indices = indices(object, number).unwrap_or_default();
        indices.into_iter().filter(|index| !self.state.cache.light(*index)).count()
    }

    /// Computes the transformed corners of a triangle, from the vertex cache if present. (Returned, they would be copied more
    /// than once.)
    fn corners(&mut self, object: &Object, number: u32, corners: &mut [ClipCorner; 3], charge: &mut StepCharge) -> Option<()> {
        let indices = indices(object, number)?;
        charge.fetched += index_bytes(object);
        for (corner, index) in corners.iter_mut().zip(indices) {
            if let Some(found) = self.state.cache.get(index) {
                self.state.counters.vertex_cache_hits += 1;
                *corner = *found;
            } else {
                *corner = self.state.transform.vertex(&object.mesh, index)?;
                self.state.counters.vertices += 1;
                let fetched = self.fetched(object);
                charge.fetched += vertex_bytes(fetched);
                charge.add(work::vertex(fetched));
                self.state.cache.insert(index, corner, self.config.vertex_cache as usize);
            }
        }
        Some(())
    }

    /// Drops a triangle that is not in front of the viewer, has no area, or faces away and is invisible from behind. Returns true
    /// if a kept triangle faces away.
    fn faces_back(&self, object: &Object, corners: &[ClipCorner], window: &WindowTransform) -> Result<bool, DropReason> {
        if corners.len() < 3 || !corners.iter().all(|c| c.clip.w >= f32::MIN_POSITIVE) {
            return Err(DropReason::Degenerate);
        }
        let area = doubled_area(corners.iter().map(|c| {
            let [x, y, ..] = window.place(c);
            [x, y]
        }));
        if area == 0.0 || !area.is_finite() {
            return Err(DropReason::Degenerate);
        }
        // As y runs down, counter-clockwise is negative.
        let front = (area < 0.0) != self.state.transform.mirrored;
        if !front && !object.material.double_sided {
            return Err(DropReason::Culled);
        }
        Ok(!front)
    }

    pub(crate) fn is_candidate(&self, object: &Object) -> bool {
        self.bump.targets == BumpTargets::All || object.material.normal_map.is_some()
    }

    fn is_target(&self, object: &Object, lod: u8) -> bool {
        self.is_candidate(object) && lod <= self.bump.max_lod
    }
}

/// Returns the vertex numbers of a triangle.
fn indices(object: &Object, number: u32) -> Option<[u32; 3]> {
    let first = (number as usize).checked_mul(3)?;
    object.mesh.indices.get(first..first.checked_add(3)?)?.try_into().ok()
}

/// Returns the contents of an object's mesh, as far as the picture needs them.
fn mesh_of(object: &Object) -> MeshInfo {
    let mesh = &object.mesh;
    MeshInfo {
        vertices: mesh.positions.len() as u32,
        indices: mesh.indices.len() as u32,
        uv: !mesh.uv.is_empty() && object.material.color_texture.is_some(),
        colors: !mesh.colors.is_empty(),
        digest: mesh.digest(),
    }
}

/// Turns the surface round: normal, tangent and bitangent = cross(normal, tangent) * w.
fn turn_round(vertices: &mut [Vertex]) {
    for vertex in vertices {
        vertex.normal = vertex.normal.map(|c| -c);
        vertex.tangent = vertex.tangent.map(|c| -c);
    }
}

impl Unit for GeometryProcessor {
    basrelief_kernel::unit_info!("transforms, clips, culls, projects; LOD; marks bump targets");
    type In = Option<Draw>;
    type Out = Option<Control>;

    fn demand(&self) -> Demand {
        Demand::All
    }

    fn step(&mut self, input: Self::In, _: &mut MemoryPorts) -> Step<Self::Out> {
        let mut polygon = None;
        let (mut out, occupancy) = match input {
            Some(Draw::Frame(frame)) => {
                self.state.frame = Some(Arc::clone(&frame));
                self.state.object = None;
                (Some(Control::Frame(frame)), 1)
            }
            Some(Draw::Object(object)) => {
                let info = self.begin_object(object);
                let mut work = work::object(self.state.lights.len() as u32);
                if self.state.object_lod.is_some() {
                    work = work.and(object_lod::WORK);
                }
                (Some(Control::Object(Arc::new(info))), self.kept(StepCharge { work, fetched: 0 }, 0))
            }
            Some(Draw::Triangle(number)) => {
                let (made, cycles) = self.triangle(number);
                polygon = made;
                (None, cycles)
            }
            Some(Draw::FrameEnd) => (Some(Control::FrameEnd), 1),
            None => (None, 1),
        };
        let latency = self.latency() + occupancy - 1;
        self.state.arrival = self.state.elapsed + latency;
        self.state.elapsed += occupancy;
        if let Some(polygon) = polygon {
            out = Some(Control::Polygon(Arc::new(Polygon { arrival: self.state.arrival, ..polygon })));
        }
        Step::after(latency, out).busy(occupancy)
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        self.tell_rate(stats);
        self.tell_hardware(stats);
        let c = &self.state.counters;
        stats.figure("triangles", c.triangles, "triangles", "Triangles of the scene");
        stats.figure("triangles_outside", c.outside, "triangles", "Triangles outside the view");
        stats.figure("triangles_culled", c.culled, "triangles", "Triangles that face away and are culled");
        stats.figure("triangles_degenerate", c.degenerate, "triangles", "Triangles without area");
        stats.figure("polygons_clipped", c.clipped, "polygons", "Polygons that were clipped");
        stats.figure("polygons", c.polygons, "polygons", "Polygons handed on");
        stats.figure("bump_polygons", c.bump_polygons, "polygons", "Polygons that are bump targets");
        stats.figure("vertices_transformed", c.vertices, "vertices", "Vertices transformed");
        stats.figure("vertex_cache_hits", c.vertex_cache_hits, "vertices", "Vertices found transformed in the vertex cache");
        stats.figure("vertices_lit", c.vertices_lit, "vertices", "Vertices lit for polygons that are no bump target");
        stats.figure("vertex_bytes", c.vertex_bytes, "bytes", "Vertices and indices fetched");
        stats.figure("polygon_bytes", c.polygon_bytes, "bytes", POLYGON_BYTES);
    }
}

#[cfg(test)]
mod tests;
