//! When the user leaves a viewpoint (475).

use crate::config::RendererConfig;

/// After how many progressive pictures each viewpoint is left: what is drawn depends on counts, never on a cycle.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Leaving {
    of_views: Vec<u32>,
    of_others: u32,
}

impl Leaving {
    /// As a configuration has it.
    pub fn new(config: &RendererConfig) -> Self {
        Self { of_views: config.pictures_of_views.clone(), of_others: config.pictures_per_view }
    }

    /// Whether the user acts behind this picture, counted from 1, of this view, counted from 0.
    pub(crate) fn is_left(&self, view: u64, picture: u32) -> bool {
        let own = usize::try_from(view).ok().and_then(|view| self.of_views.get(view)).copied().filter(|pictures| *pictures > 0);
        own.unwrap_or(self.of_others) == picture
    }
}
