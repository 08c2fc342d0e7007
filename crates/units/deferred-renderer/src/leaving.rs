//! When the user leaves a viewpoint (475).

use crate::Page;
use crate::config::RendererConfig;
use std::fmt::Debug;
use std::sync::Arc;

/// Tiles that will be asked for, in order.
pub type Ahead<'a> = &'a mut dyn Iterator<Item = (Arc<Page>, u32)>;

/// Who looks at the pictures of a real path, by the clock. In the model nobody does: there it is told ahead.
pub trait User: Debug + Send + Sync {
    /// Waits until the user turns to this view, counted from 0.
    fn turn_to(&self, view: u64);
    /// Waits until the first of these tiles is there, or the user leaves the view without it: whether it is left.
    fn leaves(&self, tiles: Ahead<'_>) -> bool;
}

/// Where each viewpoint is left: what is drawn depends on counts, never on a cycle; or on who looks.
#[derive(Clone, Debug, Default)]
pub struct Leaving {
    at_tile: Vec<u32>,
    after_pictures: u32,
    user: Option<Arc<dyn User>>,
}

impl Leaving {
    /// As a configuration has it; who looks, where anybody does, is asked instead of counting tiles.
    pub fn new(config: &RendererConfig, user: Option<Arc<dyn User>>) -> Self {
        Self { at_tile: config.left_at_tile.clone(), after_pictures: config.pictures_per_view, user }
    }

    /// Whether it can be left ahead of a tile.
    pub(crate) fn is_by_tiles(&self) -> bool {
        self.user.is_some() || !self.at_tile.is_empty()
    }

    /// A view begins, counted from 0.
    pub(crate) fn turn_to(&self, view: u64) {
        if let Some(user) = &self.user {
            user.turn_to(view);
        }
    }

    /// Whether the view is left behind this picture, counted from 1.
    pub(crate) fn is_behind(&self, picture: u32) -> bool {
        self.after_pictures == picture
    }

    /// Whether this view is left in place of tile `number`, counted from 1, the first of these.
    pub(crate) fn is_in_place_of(&self, view: u64, number: u32, tiles: Ahead<'_>) -> bool {
        match &self.user {
            Some(user) => user.leaves(tiles),
            None => usize::try_from(view).ok().and_then(|view| self.at_tile.get(view)) == Some(&number),
        }
    }
}
