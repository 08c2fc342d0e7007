//! The host's search structures: built when first needed, never part of the state, as they follow from it.

use crate::NearestSearch;
use crate::state::TableKey;
use basrelief_shading::{LEVELS, TableError, TableSet};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Entries of all tables kept; beyond that the host starts anew (objects may each fix another number).
const MOST_ENTRIES: u64 = 1 << 20;

/// Search structures of the VQ tables (121).
#[derive(Clone, Debug)]
pub(crate) struct HostTables {
    set: TableSet,
    built: BTreeMap<TableKey, Arc<NearestSearch>>,
    /// Short cut: those of the object that fixes `object` entries.
    current: [Option<Arc<NearestSearch>>; LEVELS],
    object: Option<u32>,
}

impl HostTables {
    pub(crate) fn new(set: TableSet) -> Self {
        Self { set, built: BTreeMap::new(), current: Default::default(), object: None }
    }

    pub(crate) fn set(&self) -> &TableSet {
        &self.set
    }

    /// The table of a level for an object that fixes this number of entries, or none.
    #[inline]
    pub(crate) fn table(&mut self, level: u8, object: Option<u32>) -> Result<&NearestSearch, TableError> {
        if self.object != object {
            self.object = object;
            self.current = Default::default();
        }
        let slot = usize::from(level).min(LEVELS - 1);
        if self.current[slot].is_none() {
            self.current[slot] = Some(self.build(slot as u8)?);
        }
        self.current[slot].as_deref().ok_or(TableError::Entries(0))
    }

    fn build(&mut self, level: u8) -> Result<Arc<NearestSearch>, TableError> {
        let key = (level, self.set.entries(level, self.object));
        if let Some(found) = self.built.get(&key) {
            return Ok(Arc::clone(found));
        }
        let search = Arc::new(NearestSearch::new(&self.set.normals(level, key.1)?, usize::MAX));
        let kept: u64 = self.built.values().map(|s| u64::from(s.entries())).sum();
        if kept + u64::from(search.entries()) > MOST_ENTRIES {
            self.built.clear();
        }
        self.built.insert(key, Arc::clone(&search));
        Ok(search)
    }
}
