//! The rate-limited renderer as a [`MachineSpec`].

use super::{DeferConfig, DeferredRenderer, RunAhead};
use crate::front::{FrontConfig, FrontEnd};
use crate::problem::ConfigProblem;
use crate::spec::{CostPoints, LoggingMachine, MachineSpec, PictureRecord, RunSummary, TileFetch};
use basrelief_deferred_renderer::{FilledBuffer, PicturePreview, RenderMode, TexturePage, TileList, TileRecord, TileSource};
use basrelief_frame_buffer::FinishedFrame;
use basrelief_kernel::AreaModel;
use basrelief_kernel::stats::{FigureGroup, FigureValue, UnitStats};
use std::sync::Arc;

/// Entry of the log.
#[derive(Debug)]
pub enum DeferLog {
    /// The reference buffer (126), filled by a frame.
    ReferenceBuffer(FilledBuffer),
    /// Tiles acquired for a frame, and tiles of earlier frames that it reused.
    Tiles(Vec<TileRecord>),
    /// Tile load lists (136) of all pages (132) at the end of the run.
    TileLists(Vec<(Arc<TexturePage>, TileList)>),
}

impl MachineSpec for DeferConfig {
    const NAME: &'static str = super::NAME;
    const ABOUT: &'static str = "HP's renderer for a rate-limited path";
    const DIAGRAM: &'static str = super::DIAGRAM;
    const DEMOS: &'static [&'static str] = &["gallery"];
    const FETCHES_TILES: bool = true;
    const LEFT_AT: Option<&'static str> = Some("defer.left_at_ms");
    const TAKES_TILES: &'static str = "expander";
    const PIXEL_BYTES: u64 = 80;
    /// Layers at the server, the pyramid (134) with the states of its tiles, tile lists, and the pyramid of the reference image: 3.3
    /// times a texture of a single level.
    const TEXTURE_COPIES: u64 = 4;
    const COST_POINTS: CostPoints = CostPoints { drawn: "fragments", shown: &["cells"] };
    type Machine = DeferredRenderer;
    type Log = DeferLog;

    fn build(&self, front: FrontEnd) -> Result<DeferredRenderer, ConfigProblem> {
        DeferredRenderer::new(front, self)
    }

    fn build_remote(&self, front: FrontEnd, tiles: Box<dyn TileSource>) -> Result<DeferredRenderer, ConfigProblem> {
        DeferredRenderer::with_source(front, self, tiles)
    }

    fn tile_fetch(&self) -> Option<TileFetch> {
        let path = &self.path;
        Some(TileFetch {
            format: self.tile.format(),
            requests: path.requests,
            tiles_per_request: path.tiles_per_request,
            left_at_ms: if self.acts_at_times() { self.defer.left_at_ms.clone() } else { vec![] },
        })
    }

    fn preview(&self) -> Option<PicturePreview> {
        Some(DeferConfig::preview(self))
    }

    fn front(&self) -> FrontConfig {
        self.into()
    }

    fn area_model(&self) -> AreaModel {
        AreaModel { area: self.area.clone(), operators: self.operators.clone(), hz: self.clock.hz }
    }

    fn warnings(&self, facts: &UnitStats) -> Vec<String> {
        super::warnings(self, facts)
    }

    /// Adds the time of each picture from the end of the previous frame, and its PSNR against the last picture of its frame.
    fn figures(&self, summary: &RunSummary<'_>, facts: &mut UnitStats) {
        let shown = summary.pictures;
        let mut column = |title, values: FigureValue, unit, about| {
            facts.figure(&format!("picture_{title}"), values, unit, about).part(FigureGroup::Column { table: "picture", title });
        };
        let count = |of: fn(&PictureRecord) -> u32| shown.iter().map(|s| u64::from(of(s))).collect::<Vec<_>>();
        column("frame", count(|s| s.frame).into(), "", "Frame number, from 0");
        column("round", count(|s| s.round).into(), "", "Picture number within its frame, from 0");
        let cycles = summary.run.map(|run| summary.cycles_of_frames(run));
        let ms = |cycles: u64| milliseconds(cycles, self.clock.hz);
        if let Some(cycles) = &cycles {
            column("cycles", cycles.clone().into(), "cycles", "Cycles from the end of the previous frame to the picture");
            column(
                "ms",
                cycles.iter().map(|c| ms(*c)).collect::<Vec<_>>().into(),
                "ms",
                "Time from the end of the previous frame to the picture",
            );
        }
        if let Some(run) = summary.run.filter(|_| self.acts_at_times()) {
            let pictures: Vec<_> = run.marks.iter().copied().zip(shown.iter().map(|s| s.last)).collect();
            let at = self.shown_at(&pictures).into_iter().map(ms).collect::<Vec<_>>();
            column(
                "at_ms",
                at.into(),
                "ms",
                "Time from the start to the picture, including the time in which the user only looks",
            );
        }
        let psnr_db = shown.iter().map(|s| s.psnr_db).collect::<Vec<_>>();
        column("psnr_db", psnr_db.into(), "dB", "PSNR against the last picture of its frame");
        let cycles = cycles.unwrap_or_default();
        let last = shown.iter().position(|s| s.last).and_then(|i| cycles.get(i));
        if let Some((&first, &last)) = cycles.first().zip(last) {
            facts.figure("first_picture_cycles", first, "cycles", "Cycles to the first picture");
            facts.figure("first_picture_ms", ms(first), "ms", "Time to the first picture");
            facts.figure("final_picture_cycles", last, "cycles", "Cycles to the last picture of the first frame");
            facts.figure("final_picture_ms", ms(last), "ms", "Time to the last picture of the first frame");
        }
    }

    fn acts_at_times(&self) -> bool {
        DeferConfig::acts_at_times(self)
    }

    fn never_left(&self, views: usize) -> Self {
        DeferConfig::never_left(self, views)
    }

    fn left_once_more(&self, ahead: &RunAhead) -> Option<Self> {
        DeferConfig::left_once_more(self, ahead)
    }

    fn shows_rounds(&self) -> bool {
        self.defer.mode == RenderMode::Progressive
    }
}

/// Converts cycles to milliseconds, rounded to the nanosecond.
fn milliseconds(cycles: u64, hz: u64) -> f64 {
    (cycles as f64 * 1e9 / hz as f64).round() / 1e6
}

impl LoggingMachine<DeferLog> for DeferredRenderer {
    fn drain_rounds(&mut self) -> Vec<FinishedFrame> {
        DeferredRenderer::drain_rounds(self)
    }

    fn keep_log(&mut self) {
        self.keep();
    }

    fn drain_log(&mut self, _: &[FinishedFrame]) -> Vec<(u32, DeferLog)> {
        let filled = self.drain_filled().into_iter().map(|filled| (filled.frame, DeferLog::ReferenceBuffer(filled)));
        let mut log: Vec<_> = filled.collect();
        log.extend(self.drain_records().into_iter().map(|(frame, tiles)| (frame, DeferLog::Tiles(tiles))));
        log
    }

    fn last_log(&mut self) -> Option<DeferLog> {
        Some(DeferLog::TileLists(self.lists().map(|(page, list)| (Arc::clone(page), list.clone())).collect()))
    }

    fn lost(&self) -> Option<String> {
        DeferredRenderer::lost(self).map(str::to_owned)
    }
}
