//! The host's search structures. They are built at first use and never part of the state, because they follow from it.

use crate::NearestSearch;
use crate::state::TableKey;
use basrelief_shading::{LEVELS, TableError, TableSet};

/// Maximum number of entries of all stored tables. Beyond this number the host discards all tables, as each object may fix another number.
const MOST_ENTRIES: u64 = 1 << 20;

/// Search structures of the VQ tables (121).
#[derive(Clone, Debug)]
pub(crate) struct HostTables {
    set: TableSet,
    built: Vec<(TableKey, NearestSearch)>,
    /// Short cut: positions in `built` of the tables of the object that fixes `object` entries, by level.
    current: [Option<usize>; LEVELS],
    object: Option<u32>,
}

impl HostTables {
    pub(crate) fn new(set: TableSet) -> Self {
        Self { set, built: Vec::new(), current: Default::default(), object: None }
    }

    pub(crate) fn set(&self) -> &TableSet {
        &self.set
    }

    /// Returns the table of a level for an object that fixes this number of entries, if any.
    #[inline]
    pub(crate) fn table(&mut self, level: u8, object: Option<u32>) -> Result<&mut NearestSearch, TableError> {
        if self.object != object {
            self.object = object;
            self.current = Default::default();
        }
        let level = level.min(LEVELS as u8 - 1);
        let place = match self.current[usize::from(level)] {
            Some(place) => place,
            None => self.find(level)?,
        };
        self.built.get_mut(place).map(|(_, search)| search).ok_or(TableError::Entries(0))
    }

    #[cold]
    fn find(&mut self, level: u8) -> Result<usize, TableError> {
        let key = (level, self.set.entries(level, self.object));
        let place = match self.built.iter().position(|(k, _)| *k == key) {
            Some(place) => place,
            None => {
                let search = NearestSearch::new(&self.set.normals(level, key.1)?, usize::MAX);
                let kept: u64 = self.built.iter().map(|(_, s)| u64::from(s.entries())).sum();
                if kept + u64::from(search.entries()) > MOST_ENTRIES {
                    self.built.clear();
                    self.current = Default::default();
                }
                self.built.push((key, search));
                self.built.len() - 1
            }
        };
        self.current[usize::from(level)] = Some(place);
        Ok(place)
    }
}
