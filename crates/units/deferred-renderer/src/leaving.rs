//! Ends of viewpoints (475).

use crate::TexturePage;
use crate::config::RendererConfig;
use std::fmt::Debug;
use std::sync::Arc;

/// Tiles to be requested, in order.
pub type UpcomingTiles<'a> = &'a mut dyn Iterator<Item = (Arc<TexturePage>, u32)>;

/// A user who looks at the pictures of a real path in real time. The model has none: its configuration states the ends of
/// viewpoints.
pub trait ViewUser: Debug + Send + Sync {
    /// Waits until the user turns to this view, counted from 0.
    fn turn_to(&self, view: u64);
    /// Waits until the first of these tiles arrives, or the user leaves the view without it. Returns true if the view is left.
    fn leaves(&self, tiles: UpcomingTiles<'_>) -> bool;
}

/// Ends of viewpoints. The picture depends on counts, never on a cycle, or on the user of a real path.
#[derive(Clone, Debug, Default)]
pub struct ViewpointEnds {
    at_tile: Vec<u32>,
    after_pictures: u32,
    user: Option<Arc<dyn ViewUser>>,
}

impl ViewpointEnds {
    /// Creates the ends of a configuration. A user, if present, replaces the tile counts.
    pub fn new(config: &RendererConfig, user: Option<Arc<dyn ViewUser>>) -> Self {
        Self { at_tile: config.left_at_tile.clone(), after_pictures: config.pictures_per_view, user }
    }

    /// Returns true if a view can end before a tile.
    pub(crate) fn is_by_tiles(&self) -> bool {
        self.user.is_some() || !self.at_tile.is_empty()
    }

    /// Begins a view, counted from 0.
    pub(crate) fn turn_to(&self, view: u64) {
        if let Some(user) = &self.user {
            user.turn_to(view);
        }
    }

    /// Returns true if the view ends behind this picture, counted from 1.
    pub(crate) fn is_behind(&self, picture: u32) -> bool {
        self.after_pictures == picture
    }

    /// Returns true if this view ends instead of loading tile `number`, counted from 1, the first of these.
    pub(crate) fn is_in_place_of(&self, view: u64, number: u32, tiles: UpcomingTiles<'_>) -> bool {
        match &self.user {
            Some(user) => user.leaves(tiles),
            None => usize::try_from(view).ok().and_then(|view| self.at_tile.get(view)) == Some(&number),
        }
    }
}
