//! The geometry processor (102).

use crate::clip::{Clipped, clip};
use crate::config::{BumpConfig, GeometryConfig, Targets};
use crate::state::GeometryProcessorState;
use crate::transform::{Corner, Transform, centre};
use basrelief_kernel::facts::Facts;
use basrelief_kernel::{Demand, Step, Traffic, Unit};
use basrelief_shading::{brightness, doubled_area, light_vectors, polygon_lod};
use basrelief_signals::{Control, Draw, Frame, MeshInfo, Object, ObjectInfo, Polygon, Vertex};
use glam::Vec3;
use std::sync::Arc;

/// Geometry processor (102): transforms, clips, culls and projects indexed triangles; gives each polygon its LOD and
/// decides whether it is a bump target. A triangle becomes one convex polygon or none.
///
/// Dropped as degenerate: a triangle without object or frame, or with a vertex that is not there; one with a clip-space
/// coordinate that is not finite; a polygon with fewer than three corners, a w that is not positive, or a window area
/// that is zero or not finite.
///
/// Frame, object and frame-end commands take one cycle, triangles what their vertices and set-up take, and at least one.
/// Polygons that are no bump target carry their brightness at the vertices (Gouraud), at the same cost (assumed).
#[derive(Clone, Debug, Default)]
pub struct GeometryProcessor {
    /// Parameters.
    pub config: GeometryConfig,
    /// Parameters of the bump decision.
    pub bump: BumpConfig,
    /// Everything it remembers.
    pub state: GeometryProcessorState,
}

/// Why a triangle became no polygon.
enum Dropped {
    Outside,
    Culled,
    Degenerate,
}

impl GeometryProcessor {
    /// A geometry processor at power-on.
    pub fn new(config: GeometryConfig, bump: BumpConfig) -> Self {
        Self { config, bump, state: GeometryProcessorState::default() }
    }

    fn begin_object(&mut self, object: Arc<Object>) -> ObjectInfo {
        let centre = centre(&object);
        if let Some(frame) = &self.state.frame {
            self.state.transform = Transform::new(&frame.camera.view_projection, &object.world);
            self.state.lights = light_vectors(frame, centre);
        }
        self.state.cache.clear();
        let info = ObjectInfo {
            id: object.id,
            name: object.name.clone(),
            centre,
            entries: object.entries,
            mesh: Some(mesh_of(&object)),
        };
        self.state.object = Some(object);
        info
    }

    /// Triangle `number` of the current object, and the cycles it keeps the unit.
    fn triangle(&mut self, number: u32) -> (Option<Polygon>, u64) {
        let before = self.state.counters.vertices;
        self.state.counters.triangles += 1;
        // Taken out for the time, rather than counted: that would cost a twentieth of the step.
        let drawn = (self.state.object.take(), self.state.frame.take());
        let polygon = match &drawn {
            (Some(object), Some(frame)) => self.polygon(object, frame, number),
            _ => Err(Dropped::Degenerate),
        };
        (self.state.object, self.state.frame) = drawn;
        let polygon = match polygon {
            Ok(polygon) => Some(polygon),
            Err(reason) => {
                let counters = &mut self.state.counters;
                *match reason {
                    Dropped::Outside => &mut counters.outside,
                    Dropped::Culled => &mut counters.culled,
                    Dropped::Degenerate => &mut counters.degenerate,
                } += 1;
                None
            }
        };
        let vertices = self.state.counters.vertices - before;
        let cycles = vertices * u64::from(self.config.cycles_per_vertex) + u64::from(self.config.cycles_per_polygon);
        (polygon, cycles.max(1))
    }

    fn polygon(&mut self, object: &Object, frame: &Frame, number: u32) -> Result<Polygon, Dropped> {
        let triangle = self.corners(object, number).ok_or(Dropped::Degenerate)?;
        if !triangle.iter().all(|c| c.clip.is_finite()) {
            return Err(Dropped::Degenerate);
        }
        let clipped = clip(&triangle);
        let corners = match &clipped {
            Clipped::Outside => return Err(Dropped::Outside),
            Clipped::Whole => &triangle[..],
            Clipped::Cut(corners) => corners,
        };
        self.state.counters.clipped += u64::from(matches!(clipped, Clipped::Cut(_)));
        let window = Window::new(frame);
        // Half of all triangles face away: attributes are for those that do not.
        let is_back = self.faces_back(object, corners, &window)?;
        let mut vertices: Vec<Vertex> = corners.iter().map(|c| Vertex { position: window.place(c), ..c.vertex }).collect();
        if is_back && self.config.two_sided_lighting {
            turn_round(&mut vertices);
        }
        let material = Arc::clone(&object.material);
        let lod = match (&material.normal_map, &material.color_texture) {
            (Some(map), _) => polygon_lod(&vertices, map, |v| v.uv_normal),
            (None, Some(texture)) => polygon_lod(&vertices, texture, |v| v.uv),
            (None, None) => 0,
        };
        let bump = object.bump.unwrap_or(self.is_target(object, lod));
        if !bump {
            for vertex in &mut vertices {
                vertex.brightness = brightness(Vec3::from(vertex.normal), &material.lighting, &self.state.lights);
            }
        }
        self.state.counters.polygons += 1;
        self.state.counters.bump_polygons += u64::from(bump);
        Ok(Polygon { vertices, material, object: object.id, lod, bump, arrival: self.state.arrival })
    }

    /// Transformed corners of a triangle, from the vertex cache where they are there.
    fn corners(&mut self, object: &Object, number: u32) -> Option<[Corner; 3]> {
        let first = (number as usize).checked_mul(3)?;
        let &[a, b, c] = object.mesh.indices.get(first..first.checked_add(3)?)? else { return None };
        let mut corners = [Corner::default(); 3];
        for (corner, index) in corners.iter_mut().zip([a, b, c]) {
            if let Some(found) = self.state.cache.get(index) {
                self.state.counters.vertex_cache_hits += 1;
                *corner = *found;
            } else {
                *corner = self.state.transform.vertex(&object.mesh, index)?;
                self.state.counters.vertices += 1;
                self.state.cache.insert(index, corner, self.config.vertex_cache as usize);
            }
        }
        Some(corners)
    }

    /// Drops what is not in front of the viewer, has no area, or faces away and is not seen from there; whether it faces away.
    fn faces_back(&self, object: &Object, corners: &[Corner], window: &Window) -> Result<bool, Dropped> {
        if corners.len() < 3 || !corners.iter().all(|c| c.clip.w >= f32::MIN_POSITIVE) {
            return Err(Dropped::Degenerate);
        }
        let area = doubled_area(corners.iter().map(|c| {
            let [x, y, ..] = window.place(c);
            [x, y]
        }));
        if area == 0.0 || !area.is_finite() {
            return Err(Dropped::Degenerate);
        }
        // y runs down: counter-clockwise is negative.
        let front = (area < 0.0) != self.state.transform.mirrored;
        if !front && !object.material.double_sided {
            return Err(Dropped::Culled);
        }
        Ok(!front)
    }

    fn is_target(&self, object: &Object, lod: u8) -> bool {
        let candidate = self.bump.targets == Targets::All || object.material.normal_map.is_some();
        candidate && lod <= self.bump.max_lod
    }
}

/// What the mesh of an object consists of, as far as the picture needs it.
fn mesh_of(object: &Object) -> MeshInfo {
    let mesh = &object.mesh;
    MeshInfo {
        vertices: mesh.positions.len() as u32,
        indices: mesh.indices.len() as u32,
        uv: !mesh.uv.is_empty() && object.material.color_texture.is_some(),
        colors: !mesh.colors.is_empty(),
    }
}

/// From clip space to the window.
struct Window {
    /// Half width and height \[pixels\].
    half: [f32; 2],
}

impl Window {
    fn new(frame: &Frame) -> Self {
        Self { half: [0.5 * frame.width as f32, 0.5 * frame.height as f32] }
    }

    /// Window coordinates of a corner in front of the viewer.
    #[inline]
    fn place(&self, corner: &Corner) -> [f32; 4] {
        let inverse_w = 1.0 / corner.clip.w;
        let [x, y, z] = (corner.clip.truncate() * inverse_w).to_array();
        [self.half[0] + self.half[0] * x, self.half[1] - self.half[1] * y, 0.5 + 0.5 * z, inverse_w]
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
    basrelief_kernel::role!("transforms, clips, culls, projects; LOD; marks bump targets");
    type In = Option<Draw>;
    type Out = Option<Control>;

    fn demand(&self) -> Demand {
        Demand::All
    }

    fn step(&mut self, input: Self::In, _: &mut Traffic) -> Step<Self::Out> {
        let latency = u64::from(self.config.latency);
        self.state.arrival = self.state.elapsed + latency;
        let (out, occupancy) = match input {
            Some(Draw::Frame(frame)) => {
                self.state.frame = Some(Arc::clone(&frame));
                self.state.object = None;
                (Some(Control::Frame(frame)), 1)
            }
            Some(Draw::Object(object)) => (Some(Control::Object(Arc::new(self.begin_object(object)))), 1),
            Some(Draw::Triangle(number)) => {
                let (polygon, cycles) = self.triangle(number);
                (polygon.map(|p| Control::Polygon(Arc::new(p))), cycles)
            }
            Some(Draw::FrameEnd) => (Some(Control::FrameEnd), 1),
            None => (None, 1),
        };
        self.state.elapsed += occupancy;
        Step::after(latency, out).busy(occupancy)
    }

    fn tell(&self, facts: &mut Facts) {
        facts.rate(0, self.config.latency, self.config.cycles_per_polygon.max(1));
        let c = &self.state.counters;
        facts.figure("triangles", c.triangles, "triangles", "Triangles of the scene");
        facts.figure("triangles_outside", c.outside, "triangles", "Those outside the view");
        facts.figure("triangles_culled", c.culled, "triangles", "Those that face away and are culled");
        facts.figure("triangles_degenerate", c.degenerate, "triangles", "Those without area");
        facts.figure("polygons_clipped", c.clipped, "polygons", "Those of `polygons` that were clipped");
        facts.figure("polygons", c.polygons, "polygons", "Polygons handed on");
        facts.figure("bump_polygons", c.bump_polygons, "polygons", "Those of `polygons` that are bump targets");
        facts.figure("vertices_transformed", c.vertices, "vertices", "Vertices transformed");
        facts.figure("vertex_cache_hits", c.vertex_cache_hits, "vertices", "Vertices found transformed in the vertex cache");
    }
}

#[cfg(test)]
mod tests;
