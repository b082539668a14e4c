//! How much a link remembers under names that whoever sends may make up: message types, instances, components.
//!
//! What is known is kept up to date whatever happens; new names need room. Every system, and every component of a system
//! with few of them, has some of its own, which is more than a vehicle needs, so that a flood of made-up ids shuts out
//! nobody. Beyond it the tables of a link share what there is, and what finds no room is counted.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering::Relaxed};

use pyo3::prelude::*;

/// Names in one table.
const MAX_NAMES: usize = 32_768;
/// Names that the table of a system or of a component has room for in any case.
pub(crate) const OWN_NAMES: usize = 128;
/// Components of a system that have a table in any case, each with room of its own while there are no more.
pub(crate) const OWN_COMPONENTS: usize = 4;
/// Names beyond those, in all tables of a link together.
const SHARED_NAMES: usize = 65_536;
/// Refusals between two looks at what is really there: programs may empty the tables.
const RECOUNT: u64 = 1024;

/// Room that the tables of a link share.
#[derive(Default)]
pub(crate) struct Budget {
    used: AtomicUsize,
    params: AtomicUsize,
    refused: AtomicU64,
}

impl Budget {
    /// Names that were not kept.
    pub(crate) fn refused(&self) -> u64 {
        self.refused.load(Relaxed)
    }

    /// Counts a parameter that is kept, unless there are `limit` already.
    pub(crate) fn take_param(&self, limit: usize) -> bool {
        let room = self.params.load(Relaxed) < limit;
        self.params.fetch_add(usize::from(room), Relaxed);
        room
    }

    /// Counts a name that is not kept.
    pub(crate) fn refuse(&self) -> u64 {
        self.refused.fetch_add(1, Relaxed)
    }
}

/// The tables of a link, which share a budget.
pub(crate) trait SharedTables {
    fn budget(&self) -> &Budget;

    /// Names in the tables beyond those that each has room for by itself.
    fn shared_names(&self) -> PyResult<usize>;
}

/// The room of one table.
pub(crate) struct NameBudget<'a> {
    /// The tables beside this one; `None` for a dictionary of the program's.
    tables: Option<&'a dyn SharedTables>,
    /// Names that it takes without a look at what the others have.
    own: usize,
}

impl<'a> NameBudget<'a> {
    /// Of one of a link's `tables`, with room of its own for some names.
    pub(crate) fn of(tables: &'a dyn SharedTables, own: usize) -> Self {
        Self { tables: Some(tables), own }
    }

    /// Of a table that is no link's.
    pub(crate) fn alone() -> Self {
        Self { tables: None, own: MAX_NAMES }
    }

    /// A table of `names` takes one more whatever the others have.
    #[inline]
    pub(crate) fn owns(&self, names: usize) -> bool {
        names < self.own
    }

    /// A table of `names` takes one more, which then counts as taken.
    #[inline]
    pub(crate) fn takes(&self, names: usize) -> PyResult<bool> {
        if self.owns(names) { Ok(true) } else { self.takes_shared(names) }
    }

    #[cold]
    fn takes_shared(&self, names: usize) -> PyResult<bool> {
        let Some(tables) = self.tables else { return Ok(false) };
        let budget = tables.budget();
        if names < MAX_NAMES && budget.used.load(Relaxed) < SHARED_NAMES {
            budget.used.fetch_add(1, Relaxed);
            return Ok(true);
        }
        if budget.refuse().is_multiple_of(RECOUNT) {
            budget.used.store(tables.shared_names()?, Relaxed);
        }
        Ok(false)
    }
}
