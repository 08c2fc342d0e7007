//! Tile load lists (136) of all pages, and the acquisition of tiles (462, 477), Figure 6.

use crate::acquisition::{AcquiredTile, TileList, TileOrigin};
use crate::config::{EngineConfig, RenderMode, TileOrder};
use crate::tokens::{MarkFlow, PassRound, StoreOrder, TileMark, TileRequest};
use crate::{TableSizes, TexturePage, ViewpointEnds, twin_tables};
use basrelief_kernel::stats::{FigureGroup, UnitStats};
use basrelief_kernel::{Demand, MemoryPorts, Step, Unit, UnitTable};
use serde::{Deserialize, Serialize};
use std::cmp::Reverse;
use std::collections::VecDeque;
use std::sync::Arc;

/// Priority of a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct TilePriority {
    pixels: u32,
    distance: u32,
}

const UNWANTED: TilePriority = TilePriority { pixels: 0, distance: u32::MAX };

impl TilePriority {
    fn and(self, more: Self) -> Self {
        Self { pixels: self.pixels.saturating_add(more.pixels), distance: self.distance.min(more.distance) }
    }
}

/// A page and its tile load list (136).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct ListedPage {
    page: Arc<TexturePage>,
    list: TileList,
    /// Priorities of the tiles in state L. Empty if the order does not use them.
    wanted: Vec<TilePriority>,
}

impl ListedPage {
    /// Marks a tile. The first mark replaces the priority of an earlier view, so priorities need no reset.
    #[inline]
    fn mark(&mut self, tile: u32, priority: TilePriority) {
        let is_first = self.list.mark(tile);
        if let Some(wanted) = self.wanted.get_mut(tile as usize) {
            *wanted = if is_first { priority } else { wanted.and(priority) };
        }
    }
}

/// Phase of the lists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
enum ListPhase {
    /// Receives pages and marks of the identification (461), up to its end.
    #[default]
    Identified,
    /// Acquires the planned tiles.
    Acquire,
    /// Receives marks of a progressive picture (472), up to its end.
    Improved,
}

/// Counters of the lists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TileListsCounters {
    /// Tiles loaded.
    pub loaded: u64,
    /// Tiles synthesized.
    pub synthesized: u64,
    /// Acquisitions with at least one tile.
    pub acquisitions: u64,
}

/// Tiles that a view has listed for loading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ViewTiles {
    /// Loaded.
    pub loaded: u32,
    /// Tiles not requested because the view was left.
    pub abandoned: u32,
    /// True if the view was left before one of the tiles.
    pub is_left: bool,
}

/// State of the lists between steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TileListsState {
    phase: ListPhase,
    pages: Vec<ListedPage>,
    /// Tiles to be acquired, in order: page and tile.
    pub plan: VecDeque<(u16, AcquiredTile)>,
    /// Views begun, and their tiles.
    pub views: Vec<ViewTiles>,
    /// Pictures of the current frame whose marks have been received.
    pub pictures: u32,
    /// Counters.
    pub counters: TileListsCounters,
}

/// Tile load lists (136): marks tiles, and acquires those in state L.
///
/// Inputs: marks of the identification and marks of a progressive picture. Outputs: requests to the server (110), orders to the
/// texture-data memory (130), and the news of another round. The path keeps the order of requests. So a requested tile exists for
/// all later orders.
///
/// Two bits per tile: the lists are stored in the unit, in words of `engine.list_rate` entries, and cause no traffic in the
/// texture-data memory (assumed). The search of the final rasterization reads them through ports of its own.
#[derive(Clone, Debug)]
pub struct TileLists {
    /// Parameters.
    pub config: EngineConfig,
    mode: RenderMode,
    order: TileOrder,
    leaving: ViewpointEnds,
    sizes: TableSizes,
    /// State between steps.
    pub state: TileListsState,
}

type Out = (Option<TileRequest>, Option<StoreOrder>, Option<PassRound>);

impl TileLists {
    /// Creates the lists in their power-on state.
    pub fn new(config: EngineConfig, mode: RenderMode, order: TileOrder, sizes: TableSizes, leaving: ViewpointEnds) -> Self {
        Self { config, mode, order, leaving, sizes, state: TileListsState::default() }
    }

    /// Returns the pages and their lists.
    pub fn lists(&self) -> impl Iterator<Item = (&Arc<TexturePage>, &TileList)> {
        self.state.pages.iter().map(|l| (&l.page, &l.list))
    }

    fn add(&mut self, page: Arc<TexturePage>) {
        let tiles = page.tiles();
        let wanted = if self.order == TileOrder::Listed { Vec::new() } else { vec![UNWANTED; tiles as usize] };
        self.state.pages.push(ListedPage { page, list: TileList::new(tiles), wanted });
    }

    #[inline]
    fn mark(&mut self, mark: &TileMark) {
        if let Some(listed) = self.state.pages.get_mut(usize::from(mark.page)) {
            listed.mark(mark.tile, TilePriority { pixels: mark.pixels, distance: mark.distance });
        }
    }

    /// Begins a new viewpoint (482): planned loads are cancelled. Tiles in flight are already E. Returns the cycles of resetting the
    /// lists.
    fn forget(&mut self) -> u64 {
        self.leaving.turn_to(self.state.views.len() as u64);
        self.state.views.push(ViewTiles::default());
        self.state.pictures = 0;
        for listed in &mut self.state.pages {
            listed.list.forget();
        }
        self.word_cycles()
    }

    /// Returns the cycles of passing over all lists, a word per cycle.
    fn word_cycles(&self) -> u64 {
        let tiles: u64 = self.state.pages.iter().map(|listed| u64::from(listed.page.tiles())).sum();
        tiles.div_ceil(self.config.list_rate.into()).max(1)
    }

    /// Marks whole layers: all of them (conventional) or the top tiles (471).
    fn mark_layers(&mut self) {
        let whole = self.mode == RenderMode::Conventional;
        for listed in &mut self.state.pages {
            let end = if whole { listed.page.tiles() } else { listed.page.layers[0].pitch * listed.page.layers[0].rows };
            (0..end).for_each(|tile| listed.mark(tile, UNWANTED));
        }
    }

    /// Runs Figure 6 for every page. Returns the cycles of testing the lists and sorting the results.
    fn acquire(&mut self) -> u64 {
        for listed in &mut self.state.pages {
            let number = listed.page.number;
            self.state.plan.extend(listed.list.acquire(&listed.page).into_iter().map(|a| (number, a)));
        }
        let sorted = if self.order == TileOrder::Listed { 0 } else { self.sort() };
        if !self.state.plan.is_empty() {
            self.state.counters.acquisitions += 1;
        }
        self.word_cycles() + sorted
    }

    /// Sorts the loads in the selected order, with averages behind them. Equal loads keep their order. Returns the cycles: one
    /// for each comparison of a merge sort, n log2 n of them.
    fn sort(&mut self) -> u64 {
        let pages = &self.state.pages;
        let order = self.order;
        self.state.plan.make_contiguous().sort_by_key(|(page, acquired)| {
            let wanted = pages[usize::from(*page)].wanted.get(acquired.tile as usize).copied().unwrap_or(UNWANTED);
            match (acquired.how, order) {
                (TileOrigin::Synthesized, _) | (_, TileOrder::Listed) => (1, 0, Reverse(0)),
                (TileOrigin::Loaded, TileOrder::Centre) => (0, wanted.distance, Reverse(0)),
                (TileOrigin::Loaded, TileOrder::Pixels) => (0, 0, Reverse(wanted.pixels)),
            }
        });
        let planned = self.state.plan.len() as u64;
        planned * u64::from(planned.max(1).next_power_of_two().trailing_zeros())
    }

    /// Returns the loads of the plan.
    fn loads(&self) -> impl Iterator<Item = (Arc<TexturePage>, u32)> {
        let loaded = self.state.plan.iter().filter(|(_, a)| a.how == TileOrigin::Loaded);
        loaded.map(|(page, a)| (Arc::clone(&self.state.pages[usize::from(*page)].page), a.tile))
    }

    /// Returns the announcement for a real server.
    fn announcement(&self) -> Option<TileRequest> {
        let tiles: Arc<[_]> = self.loads().collect();
        (!tiles.is_empty()).then_some(TileRequest::Announce(tiles))
    }

    /// Handles the end of the marks of the identification.
    fn end_of_identification(&mut self) -> (u64, Out) {
        if self.mode != RenderMode::Best {
            self.mark_layers();
        }
        let cycles = self.acquire();
        self.state.phase = ListPhase::Acquire;
        (cycles, (self.announcement(), None, None))
    }

    /// Handles the end of the marks of a progressive picture (476): another round follows, unless no tile is marked or the user
    /// moves on (475).
    fn end_of_picture(&mut self) -> (u64, Out) {
        self.state.pictures += 1;
        let is_left = self.state.views.last().is_some_and(|view| view.is_left);
        if is_left || self.leaving.is_behind(self.state.pictures) {
            self.state.phase = ListPhase::Identified;
            return (1, (Some(TileRequest::End), None, Some(PassRound::Done)));
        }
        let cycles = self.acquire();
        if self.state.plan.is_empty() {
            self.state.phase = ListPhase::Identified;
            return (cycles, (Some(TileRequest::End), None, Some(PassRound::Done)));
        }
        self.state.phase = ListPhase::Acquire;
        (cycles, (self.announcement(), None, Some(PassRound::Again)))
    }

    /// Returns the next tile of the plan, unless the user moves on (475), and the cycles.
    fn next(&mut self) -> (u64, Out) {
        let cycles = if self.is_left_here() { self.abandon() } else { 1 };
        let Some((page, AcquiredTile { tile, how })) = self.state.plan.pop_front() else {
            return (cycles, self.end_of_acquisition());
        };
        (cycles, self.acquired(page, tile, how))
    }

    /// Returns the orders for a tile of the plan.
    fn acquired(&mut self, page: u16, tile: u32, how: TileOrigin) -> Out {
        match how {
            TileOrigin::Loaded => {
                self.state.counters.loaded += 1;
                if let Some(view) = self.state.views.last_mut() {
                    view.loaded += 1;
                }
                let request = TileRequest::Tile(Arc::clone(&self.state.pages[usize::from(page)].page), tile);
                (Some(request), Some(StoreOrder::Load { page, tile }), None)
            }
            TileOrigin::Synthesized => {
                self.state.counters.synthesized += 1;
                (None, Some(StoreOrder::Synthesize { page, tile }), None)
            }
        }
    }

    /// Returns true if the view ends before the next tile of the plan.
    fn is_left_here(&self) -> bool {
        let loads = matches!(self.state.plan.front(), Some((_, AcquiredTile { how: TileOrigin::Loaded, .. })));
        let Some((number, view)) = self.state.views.iter().enumerate().next_back().filter(|_| loads) else { return false };
        self.mode == RenderMode::Progressive && self.leaving.is_in_place_of(number as u64, view.loaded + 1, &mut self.loads())
    }

    /// Resets all planned tiles to N. Returns the cycles, one for each.
    fn abandon(&mut self) -> u64 {
        let (planned, abandoned) = (self.state.plan.len() as u64, self.loads().count() as u32);
        for (page, acquired) in self.state.plan.drain(..) {
            self.state.pages[usize::from(page)].list.abandon(acquired.tile);
        }
        if let Some(view) = self.state.views.last_mut() {
            *view = ViewTiles { abandoned, is_left: true, ..*view };
        }
        planned
    }

    fn end_of_acquisition(&mut self) -> Out {
        if self.mode == RenderMode::Progressive {
            let is_left = self.state.views.last().is_some_and(|view| view.is_left);
            self.state.phase = ListPhase::Improved;
            (None, Some(if is_left { StoreOrder::Left } else { StoreOrder::End }), None)
        } else {
            self.state.phase = ListPhase::Identified;
            (Some(TileRequest::End), Some(StoreOrder::End), Some(PassRound::Done))
        }
    }

    fn tell_views(&self, stats: &mut UnitStats) {
        let count = |of: fn(&ViewTiles) -> u32| self.state.views.iter().map(|view| u64::from(of(view))).collect::<Vec<_>>();
        let mut column = |title, values: Vec<u64>, about| {
            stats.figure(&format!("view_{title}"), values, "tiles", about).part(FigureGroup::Column { table: "view", title });
        };
        column("tiles", count(|view| view.loaded), "Tiles loaded for the view");
        column("abandoned", count(|view| view.abandoned), "Listed for it, and not asked for any more when it was left");
        let left_at = |view: &ViewTiles| if view.is_left { view.loaded + 1 } else { 0 };
        column("left_at_tile", count(left_at), "In place of which tile it was left, counted from 1; 0: it was not");
    }

    fn take(&mut self, token: MarkFlow) -> (u64, Out) {
        match token {
            MarkFlow::Frame => return (self.forget(), (None, None, None)),
            MarkFlow::Page(page) => self.add(page),
            MarkFlow::Marks(marks) => {
                marks.iter().for_each(|mark| self.mark(mark));
                return (marks.len() as u64, (None, None, None));
            }
            MarkFlow::End if self.state.phase == ListPhase::Identified => return self.end_of_identification(),
            MarkFlow::End => return self.end_of_picture(),
        }
        (1, (None, None, None))
    }
}

impl Unit for TileLists {
    basrelief_kernel::unit_info!("N, L or E per tile; loads or synthesizes (Figure 6)");
    type In = (Option<MarkFlow>, Option<MarkFlow>);
    type Out = Out;

    #[inline]
    fn demand(&self) -> Demand {
        match self.state.phase {
            ListPhase::Identified => Demand::Only(0),
            ListPhase::Acquire => Demand::Nothing,
            ListPhase::Improved => Demand::Only(1),
        }
    }

    #[inline]
    fn step(&mut self, (identified, improved): Self::In, _: &mut MemoryPorts) -> Step<Out> {
        let latency = u64::from(self.config.latency);
        let (cycles, out) = match identified.or(improved) {
            Some(token) => self.take(token),
            None => self.next(),
        };
        Step::during(cycles, latency, out)
    }

    fn is_empty(&self) -> bool {
        self.state.phase == ListPhase::Identified
    }

    fn twin_tables(&self) -> Vec<UnitTable> {
        self.state.pages.iter().flat_map(|listed| twin_tables::of_page(&listed.page)).collect()
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        let c = &self.state.counters;
        stats.figure("tiles_loaded", c.loaded, "tiles", "Tiles loaded");
        stats.figure("tiles_synthesized", c.synthesized, "tiles", "Tiles synthesized");
        stats.figure("acquisitions", c.acquisitions, "acquisitions", "Times that the lists were worked off");
        if self.leaving.is_by_tiles() {
            self.tell_views(stats);
        }
        self.sizes.tell_lists(&self.config, self.mode, self.order, stats);
    }
}
