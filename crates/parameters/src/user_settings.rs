//! Parameters that the user has set.

use toml::Table;

/// The parameters that the user has set. All others have their defaults.
#[derive(Clone, Copy, Debug)]
pub struct UserSettings<'a>(pub(crate) &'a Table);

impl UserSettings<'_> {
    /// Returns true if the user has set this parameter.
    pub fn contains(&self, key: &str) -> bool {
        let (path, leaf) = key.rsplit_once('.').unwrap_or(("", key));
        let group = path.split('.').filter(|p| !p.is_empty()).try_fold(self.0, |at, part| at.get(part)?.as_table());
        group.is_some_and(|group| group.contains_key(leaf))
    }
}
