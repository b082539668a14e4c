//! A dataflash log's description of itself: record types, units, clock.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::io::{self, Read};
use std::iter::repeat;
use std::sync::Arc;

use mavwire_core::log::dataflash::text::{Delimiter, TextDefinitions};
use mavwire_core::log::dataflash::{Clock, Definitions, Field, FieldKind, Layout, Units};
use mavwire_core::log::kind::{Kind, Verdict};

use super::run::Run;
use crate::error::Error;
use crate::input::{Blocks, Steps, decompressed};

/// Opens the log from its start; a log is read more than once.
pub type Open<'a> = &'a (dyn Fn() -> io::Result<Box<dyn Read + Send>> + 'a);

/// Descriptions of one name that have rows in its table, as many as a type has: a hostile log chooses the names.
const MAX_OF_NAME: usize = 16;
/// Bytes of a row of theirs, if there are several: each row has the columns of all of them.
const MAX_ROW_LEN: usize = 512;
/// Columns of all tables beyond those of their first descriptions.
const MAX_MORE_COLUMNS: usize = 2048;
/// The ids of a field of which the log says no unit.
const NO_ID: char = '\0';

/// [`Survey::table_of`] a layout that has no table.
pub(super) const NO_TABLE: u16 = u16::MAX;

/// How records are written.
#[derive(Debug, Clone)]
pub enum Form {
    /// Records of bytes.
    Binary(Box<Definitions>),
    /// A line for each record.
    Text(TextDefinitions),
}

impl Form {
    /// The form of a log, perhaps one of which nothing can be read; `None` for something else.
    pub fn of(verdict: Verdict<'_>) -> Option<Self> {
        verdict.kind.is_dataflash().then(|| match verdict.kind {
            Kind::DataflashText => Self::Text(TextDefinitions::new(Delimiter::of(verdict.telling))),
            _ => Self::Binary(Box::default()),
        })
    }

    /// The layouts of the records.
    pub fn layouts(&self) -> &[Arc<Layout>] {
        match self {
            Self::Binary(definitions) => definitions.layouts(),
            Self::Text(definitions) => definitions.layouts(),
        }
    }
}

/// The key of a column: name and kind of a field, ids of its unit and multiplier, which scale it in SI units, and its
/// number among fields that are alike.
type ColumnKey<'a> = (&'a str, FieldKind, [char; 2], usize);

/// The columns that a description needs.
fn columns_of<'a>(layout: &'a Layout, units: &Units) -> Vec<ColumnKey<'a>> {
    let mut counts = HashMap::new();
    let (unit_ids, mult_ids) = units
        .fields
        .get(&layout.type_id)
        .map_or(("", ""), |(unit_ids, mult_ids)| (unit_ids, mult_ids));
    let ids = unit_ids.chars().chain(repeat(NO_ID)).zip(mult_ids.chars().chain(repeat(NO_ID)));
    let column = |(field, (unit, mult)): (&'a Field, _)| {
        let (name, ids) = (field.name.as_str(), [unit, mult]);
        let count = counts.entry((name, field.kind, ids)).or_insert(0);
        *count += 1;
        (name, field.kind, ids, *count)
    };
    layout.fields.iter().zip(ids).map(column).collect()
}

/// Bytes of a value in a table at most, or of what says where a text is.
fn value_len(kind: FieldKind) -> usize {
    if kind == FieldKind::Array { kind.size() } else { size_of::<f64>() }
}

/// A log's description of itself.
#[derive(Debug, Clone)]
pub struct Survey {
    /// The layouts of its records.
    pub form: Form,
    /// The units of fields.
    pub units: Units,
    /// The source of the records' times; `None` for a log without times.
    pub clock: Option<Clock>,
    /// Names of the tables, in the order in which the log describes them.
    pub tables: Vec<Arc<str>>,
    /// Table of each layout.
    pub(super) table_of: Vec<u16>,
    /// Bytes of the values in a row of each table, without texts.
    pub(super) row_lens: Vec<usize>,
    /// Bytes of the log, decompressed.
    pub(super) bytes: u64,
    /// In what steps it is read.
    pub(super) steps: Steps,
}

impl Survey {
    /// Goes through a log; `None` if it is no dataflash log. It is read in the same steps afterwards. `pulse` is asked
    /// now and then whether to go on.
    ///
    /// # Errors
    /// Errors of reading, and the error that `pulse` returns.
    pub fn read<E: From<Error>>(
        steps: Steps,
        open: Open<'_>,
        pulse: impl FnMut() -> Result<(), E>,
    ) -> Result<Option<Self>, E> {
        let (blocks, form) = begin(open, steps).map_err(Error::from)?;
        let Some(form) = form else { return Ok(None) };
        Run::new(form, steps).finish(blocks, open, pulse).map(Some)
    }

    /// The description that the first `bytes` bytes of a log give.
    pub(super) fn new(
        form: Form,
        units: Units,
        clock: Option<Clock>,
        bytes: u64,
        steps: Steps,
    ) -> Self {
        let (mut tables, mut known) = (Vec::<Arc<str>>::new(), HashMap::new());
        let mut more_columns = 0;
        let (mut table_of, mut row_lens) = (Vec::new(), Vec::<usize>::new());
        for layout in form.layouts() {
            let next = tables.len() as u16;
            let (table, layouts, columns) =
                known.entry(layout.name.as_str()).or_insert((next, 0, HashSet::new()));
            if *table == next {
                tables.push(layout.name.as_str().into());
                row_lens.push(0);
            }
            let mut own = columns_of(layout, &units);
            own.retain(|column| !columns.contains(column));
            let row_len = &mut row_lens[usize::from(*table)];
            let with_new = *row_len + own.iter().map(|column| value_len(column.1)).sum::<usize>();
            let is_first = *layouts == 0;
            let more = if is_first { 0 } else { own.len() };
            let fits = is_first
                || (*layouts < MAX_OF_NAME
                    && with_new <= MAX_ROW_LEN
                    && more_columns + more <= MAX_MORE_COLUMNS);
            table_of.push(if fits { *table } else { NO_TABLE });
            if fits {
                (*layouts, *row_len) = (*layouts + 1, with_new);
                more_columns += more;
                columns.extend(own);
            }
        }
        Self { form, units, clock, tables, table_of, row_lens, bytes, steps }
    }

    /// Index of a table.
    pub fn table(&self, name: &str) -> Option<usize> {
        self.tables.iter().position(|one| **one == *name)
    }

    /// The layouts of a table, by their indices; one, unless the log describes a type anew.
    pub fn layouts_of(&self, table: usize) -> impl Iterator<Item = (usize, &Arc<Layout>)> {
        let all = self.form.layouts().iter().enumerate();
        all.filter(move |&(index, _)| usize::from(self.table_of[index]) == table)
    }

    /// The tables about which more is known by `later`, which is of the same log.
    pub(super) fn changed_by(&self, later: &Self) -> BTreeSet<usize> {
        let (units, others) = (&self.units, &later.units);
        let all = units.labels != others.labels || !units.scales_like(others);
        let is_changed = |layout: &Layout| {
            all || units.fields.get(&layout.type_id) != others.fields.get(&layout.type_id)
        };
        let before = self.table_of.iter().copied().map(Some).chain(repeat(None));
        let tables = later.table_of.iter().copied().zip(before);
        let layouts = later.form.layouts().iter().zip(tables);
        let changed = layouts.filter_map(|(layout, (now, before))| {
            // One that has no room any more had a table.
            let table = if now == NO_TABLE { before? } else { now };
            (Some(now) != before || is_changed(layout)).then_some(table)
        });
        changed.filter(|&table| table != NO_TABLE).map(usize::from).collect()
    }
}

pub(super) fn begin(open: Open<'_>, steps: Steps) -> io::Result<(Blocks, Option<Form>)> {
    Blocks::of_size(decompressed(open()?)?, steps.block).with_verdict(Form::of)
}
