//! Tap between a trace and the machine: hashes the commands and draws the reference images in one pass, because a trace can be read only
//! once.

use super::memory_estimates;
use crate::options::RunOptions;
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_reference::{PolygonRenderer, RenderStyle, RgbPicture};
use basrelief_signals::{Control, Frame};
use basrelief_trace::{
    BeginCommand, CanonicalHash, DentedPolygons, Digest, ExpectedResults, TextureFiles, TraceError, TraceResolver,
};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::io::Read;
use std::rc::Rc;
use std::sync::Arc;

/// Results of the tap.
#[derive(Default)]
pub(crate) struct TraceNotes {
    /// Number of commands so far.
    pub(crate) commands: u64,
    /// Reference images of passed frames that have not been fetched yet.
    pub(crate) exact: VecDeque<(RgbPicture, MemoryReservation)>,
    /// The last frame so far.
    pub(crate) frame: Option<Arc<Frame>>,
    /// Hash of all commands; `None` until the end.
    pub(crate) digest: Option<Digest>,
    pub(crate) expectations: Vec<ExpectedResults>,
    /// Polygons so far that are not convex.
    pub(crate) dented: Option<DentedPolygons>,
    /// Error in the trace.
    pub(crate) error: Option<TraceError>,
    /// Time of reading, hashing and exact drawing \[s\], which is not simulation time.
    pub(crate) seconds: f64,
}

type InputResolver = TraceResolver<Box<dyn Read>, Box<dyn TextureFiles>>;

/// Iterator over the commands of a trace.
pub(crate) struct TraceTap {
    resolver: InputResolver,
    hash: Option<CanonicalHash>,
    renderer: Option<PolygonRenderer>,
    seen: Rc<RefCell<TraceNotes>>,
    clock: fn() -> f64,
    budget: MemoryPool,
}

impl TraceTap {
    pub(crate) fn new(
        resolver: InputResolver,
        exact: Option<RenderStyle>,
        seen: Rc<RefCell<TraceNotes>>,
        settings: &RunOptions,
    ) -> Self {
        let begin = resolver.begin();
        Self {
            hash: Some(CanonicalHash::new(begin)),
            renderer: exact.map(|style| PolygonRenderer::new(begin.width, begin.height, style)),
            resolver,
            seen,
            clock: settings.clock,
            budget: settings.budget.clone(),
        }
    }

    fn advance(&mut self, seen: &mut TraceNotes) -> Option<Result<(Control, Option<u64>), String>> {
        let next = match self.resolver.next() {
            Some(Ok((control, arrival))) => self.pass(&control, seen).map(|()| (control, arrival)),
            Some(Err(error)) => Err(error),
            None => {
                seen.digest = self.hash.take().map(CanonicalHash::finish);
                seen.expectations = self.resolver.expectations().iter().map(|placed| placed.results.clone()).collect();
                return None;
            }
        };
        Some(next.map_err(|error| {
            let text = error.to_string();
            seen.error = Some(error);
            text
        }))
    }

    fn pass(&mut self, control: &Control, seen: &mut TraceNotes) -> Result<(), TraceError> {
        seen.commands += 1;
        seen.dented = self.resolver.dented_polygons();
        if let Some(hash) = &mut self.hash {
            hash.update(control)?;
        }
        if let Control::Frame(frame) = control {
            seen.frame = Some(Arc::clone(frame));
        }
        let Some(renderer) = &mut self.renderer else { return Ok(()) };
        match control {
            Control::Frame(frame) => renderer.frame(frame),
            Control::Object(object) => renderer.object(object),
            Control::Polygon(polygon) => renderer.polygon(polygon),
            Control::FrameEnd => {
                let &BeginCommand { width, height, .. } = self.resolver.begin();
                let bytes = memory_estimates::WAITING_PIXEL * u64::from(width) * u64::from(height);
                let held = self.budget.try_reserve(bytes, "reference images that wait for the machine");
                let held = held.map_err(|error| self.resolver.over_budget(&error))?;
                seen.exact.push_back((renderer.finish(), held));
            }
            Control::CodeBook(_) | Control::Criterion(_) => {}
        }
        Ok(())
    }
}

impl Iterator for TraceTap {
    type Item = Result<(Control, Option<u64>), String>;

    fn next(&mut self) -> Option<Self::Item> {
        let began = (self.clock)();
        let seen = Rc::clone(&self.seen);
        let mut seen = seen.borrow_mut();
        let item = self.advance(&mut seen);
        seen.seconds += (self.clock)() - began;
        item
    }
}
