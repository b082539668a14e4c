//! `LogColumns`: a log as tables, batch by batch; and `log_summary`, what is in it.

use std::collections::{BTreeMap, HashSet};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use mavwire_columns::Error;
use mavwire_columns::input::Steps;
use mavwire_columns::layout::{Invalid, Layout, Layouts, Options};
use mavwire_columns::mcap::Descriptions;
use mavwire_columns::reader::{Batch, Decode, Limits, Plan, reader};
use mavwire_columns::select::Wanted;
use mavwire_columns::summary::{Count, Sender, Summary};
use mavwire_columns::unknown;
use mavwire_core::unknown::UnknownCounts;
use mavwire_io::files;
use mavwire_io::memory::Freed;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::dialect::registry::Dialect;
use crate::python::calling::Calling;
use crate::python::error::Result;
use crate::python::lists::optional_list;
use crate::tables::source::Source;
use crate::tables::table::RecordBatches;

/// The wanted part of a log: the attributes of the object that `LogColumns` is given.
#[derive(Default, FromPyObject)]
#[allow(clippy::struct_excessive_bools)] // the fields are attributes of a Python object
pub(crate) struct Query {
    /// Message ids; `None` for all.
    #[pyo3(from_py_with = optional_list)]
    types: Option<Vec<u32>>,
    /// Ids that the dialect lacks; `None` for all of them.
    #[pyo3(from_py_with = optional_list)]
    unknown_ids: Option<Vec<u32>>,
    /// The same for dataflash logs: names of record types.
    #[pyo3(from_py_with = optional_list)]
    pub(crate) names: Option<Vec<String>>,
    #[pyo3(from_py_with = optional_list)]
    systems: Option<Vec<u8>>,
    pub(crate) start: Option<f64>,
    pub(crate) end: Option<f64>,
    /// Names of columns; `None` for all.
    #[pyo3(from_py_with = optional_list)]
    columns: Option<Vec<String>>,
    /// Columns, and a function that says which rows of a table with these are wanted: a table of their numbers.
    predicate: Option<(Vec<String>, Py<PyAny>)>,
    si: bool,
    enum_names: bool,
    #[pyo3(from_py_with = invalid_of)]
    invalid: Invalid,
    /// Cells of CSV files are no formulas.
    pub(crate) csv_safe: bool,
    /// Texts for the schemas of MCAP files.
    pub(crate) descriptions: Option<Descriptions>,
    /// The treatment of messages that the dialect does not define: `"table"` makes a table of them.
    unknown: Option<String>,
    /// Rows of a batch at most; 0 for those of each block of the log, `None` for one batch of each type.
    batch_rows: Option<usize>,
    /// Bytes that all batches under way may have.
    batch_bytes: Option<usize>,
}

fn invalid_of(word: &Bound<'_, PyAny>) -> PyResult<Invalid> {
    match word.extract()? {
        "null" => Ok(Invalid::Null),
        "keep" => Ok(Invalid::Keep),
        other => Err(PyValueError::new_err(format!("invalid is 'null' or 'keep', not '{other}'"))),
    }
}

impl Query {
    /// Which records are wanted. The record types of a dataflash log need no dialect.
    pub(crate) fn wanted(&self, dialect: Option<&Dialect>) -> Wanted {
        let types = self.types.as_ref().zip(dialect).map(|(ids, dialect)| {
            let names: Option<HashSet<&str>> =
                self.names.as_ref().map(|names| names.iter().map(String::as_str).collect());
            let is_named = |name: &str| names.as_ref().is_none_or(|names| names.contains(name));
            let own = dialect.registry.own_messages().iter();
            let own: HashSet<u32> =
                own.filter(|one| is_named(&one.name)).map(|one| one.id).collect();
            // A message comes with the other layouts of its id. Such a layout comes alone.
            let is_wanted =
                |id, name: &str| ids.contains(&id) && (own.contains(&id) || is_named(name));
            let messages = dialect.registry.dialect().messages.iter();
            messages.map(|message| is_wanted(message.id, &message.name)).collect()
        });
        let systems = self.systems.as_ref();
        Wanted {
            types,
            unknown: self.unknown_ids.clone(),
            names: self.names.clone(),
            systems: systems.map(|ids| {
                Box::new(std::array::from_fn(|id| ids.iter().any(|&one| usize::from(one) == id)))
            }),
            start: self.start.unwrap_or(f64::NEG_INFINITY),
            end: self.end.unwrap_or(f64::INFINITY),
        }
    }

    pub(crate) fn options(&self) -> Options {
        Options {
            si: self.si,
            enum_names: self.enum_names,
            invalid: self.invalid,
            text_parts: false,
            columns: self.columns.clone(),
            predicate: self.predicate.as_ref().map(|(columns, _)| columns.clone()),
        }
    }

    /// The plan for reading a log of `size` bytes.
    pub(crate) fn plan(&self, dialect: Option<&Dialect>, size: u64) -> Plan {
        let limits = Limits {
            rows: self.batch_rows.unwrap_or(usize::MAX),
            bytes: self.batch_bytes.unwrap_or(usize::MAX),
            ..Limits::NONE
        };
        let unknown_table = self.unknown.as_deref() == Some("table");
        let (wanted, options) = (self.wanted(dialect), self.options());
        let layouts = dialect.map(|dialect| layouts(dialect, &options));
        Plan { wanted, options, layouts, limits, unknown_table, size }
    }

    /// Only records of some time are wanted.
    pub(crate) fn is_timed(&self) -> bool {
        self.start.is_some() || self.end.is_some()
    }

    /// Refuses a log without times if only records of some time are wanted.
    pub(crate) fn check_times(&self, has_times: bool) -> Result<(), Error> {
        if has_times || !self.is_timed() { Ok(()) } else { Err(Error::Untimed) }
    }
}

/// The columns of messages: made once for logs that are read with the same options.
fn layouts(dialect: &Dialect, options: &Options) -> Arc<Layouts> {
    let mut last = dialect.layouts.lock().unwrap_or_else(PoisonError::into_inner);
    match &*last {
        Some(layouts) if layouts.options() == options => Arc::clone(layouts),
        _ => {
            let layouts = Arc::new(Layouts::new(&dialect.registry, options.clone()));
            Arc::clone(last.insert(layouts))
        }
    }
}

/// One run over a log, giving tables.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct LogColumns {
    reader: Mutex<Box<dyn Decode>>,
    predicate: Option<Py<PyAny>>,
    freed: Freed,
}

impl LogColumns {
    /// A run that `open` begins without the interpreter. An error if the log has no times and `query` needs them.
    pub(crate) fn begin(
        py: Python<'_>,
        query: &Query,
        open: impl FnOnce() -> Result<Box<dyn Decode>, Error> + Send,
    ) -> Result<Self> {
        let reader = py.detach(open)?;
        query.check_times(reader.has_times())?;
        let predicate = query.predicate.as_ref().map(|(_, keeps)| keeps.clone_ref(py));
        Ok(Self { reader: Mutex::new(reader), predicate, freed: Freed::default() })
    }

    fn advance(&self) -> Result<Option<Vec<Batch>>, Error> {
        let batches = self.with(|reader| reader.advance_a_while())?;
        // The caller has mostly dropped the batches before these. Giving memory back takes time. The blocks of ordinary logs
        // come whole and do not need it.
        if self.with(|reader| reader.is_within_block()) {
            self.freed.add(batches.as_deref().map_or(0, bytes_of));
        }
        Ok(batches)
    }

    /// The rows that the predicate keeps.
    fn kept(&self, py: Python<'_>, batch: Batch) -> Result<Batch> {
        let Some(keeps) = &self.predicate else { return Ok(batch) };
        let (_, asked) = table(batch.clone());
        let numbers = keeps.bind(py).invoke1((asked,))?.cast_into::<RecordBatches>()?;
        let numbers = numbers.get().whole(py)?.column(0);
        Ok(py.detach(|| batch.kept(numbers))?)
    }

    pub(crate) fn with<T>(&self, read: impl FnOnce(&mut dyn Decode) -> T) -> T {
        read(&mut **self.reader.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Memory that batches take.
pub(crate) fn bytes_of(batches: &[Batch]) -> usize {
    batches.iter().map(|batch| batch.rows.get_array_memory_size()).sum()
}

pub(crate) fn table(batch: Batch) -> (String, RecordBatches) {
    (batch.message.to_string(), RecordBatches::new(batch.rows.schema(), vec![batch.rows]))
}

#[pymethods]
impl LogColumns {
    #[new]
    fn open(py: Python<'_>, log: Source, dialect: &Dialect, query: Query) -> Result<Self> {
        let (registry, plan) =
            (Arc::clone(&dialect.registry), query.plan(Some(dialect), log.size()));
        Self::begin(py, &query, || {
            reader(Steps::default(), log.open()?, log.framing(), registry, plan)
        })
    }

    fn __iter__(slf: Bound<'_, Self>) -> Bound<'_, Self> {
        slf
    }

    /// The tables that are ready after some more blocks of the log, `[(message, table), ...]`, perhaps none.
    fn __next__(&self, py: Python<'_>) -> Result<Option<Vec<(String, RecordBatches)>>> {
        py.check_signals()?;
        let Some(batches) = py.detach(|| self.advance())? else { return Ok(None) };
        let kept = batches.into_iter().map(|batch| Ok(table(self.kept(py, batch)?)));
        kept.collect::<Result<_>>().map(Some)
    }

    /// Bytes of the log, decompressed, that are consumed; how many of them belong to no record; the damage of a compressed
    /// file; `{(message id, CRC_EXTRA): messages}` that the dialect does not define, under `None` those that are not listed.
    fn progress(&self, py: Python<'_>) -> (u64, u64, Option<String>, UnknownById) {
        let progress = |reader: &mut dyn Decode| {
            let unknown = unknown_of_log(&reader.unknown());
            let damage = reader.damage().map(str::to_owned);
            (reader.position(), reader.bad_bytes(), damage, unknown)
        };
        py.detach(|| self.with(progress))
    }
}

pub(crate) type UnknownById = BTreeMap<Option<(u32, u8)>, u64>;

/// The counts of a bridge or a log.
pub(crate) fn unknown_counts<C>(
    counts: &UnknownCounts<C>,
    messages: impl Fn(&C) -> u64,
) -> UnknownById {
    let listed = counts.listed.iter();
    let listed = listed.map(|(kind, one)| (Some((kind.msgid, kind.crc_extra)), messages(one)));
    listed.chain((counts.unlisted > 0).then_some((None, counts.unlisted))).collect()
}

/// The same of a log.
pub(crate) fn unknown_of_log(counts: &unknown::UnknownCounts) -> UnknownById {
    unknown_counts(counts, |count| count.messages)
}

/// A table without rows of a message, with the columns that `query` asks for.
#[pyfunction]
pub(crate) fn empty_table(dialect: &Dialect, msgid: u32, query: Query) -> Result<RecordBatches> {
    let registry = &dialect.registry;
    let unknown = || PyValueError::new_err(format!("no message has the id {msgid}"));
    let index = registry.lookup(msgid).ok_or_else(unknown)?.index;
    if let Some(columns) = &query.columns {
        Layout::check(registry, index, columns)?;
    }
    let layout = Layout::new(registry, index, &query.options());
    Ok(RecordBatches::new(layout.schema, Vec::new()))
}

pub(crate) fn count_row(count: &Count) -> (u64, u64, u64, u64) {
    (count.messages, count.first, count.last, count.elapsed)
}

/// The summary of a log, as a dict: see `mavwire.logs.summary`. `pulse` takes the bytes read so far.
#[pyfunction]
pub(crate) fn log_summary<'py>(
    py: Python<'py>,
    path: PathBuf,
    dialect: &Dialect,
    gap: u64,
    pulse: Option<Py<PyAny>>,
) -> Result<Bound<'py, PyDict>> {
    let registry = Arc::clone(&dialect.registry);
    let tell = Teller(pulse);
    let sum = py.detach(|| -> Result<_> {
        let source = files::open(&path)?;
        Summary::read(source, registry, gap, |bytes| tell.tell(bytes))
    })?;
    let messages = &dialect.registry.dialect().messages;
    let types = PyDict::new(py);
    for (message, count) in messages.iter().zip(&sum.types).filter(|(_, c)| c.messages > 0) {
        types.set_item(&message.name, count_row(count))?;
    }
    for (msgid, count) in &unknown::by_id(&sum.unknown) {
        types.set_item(format!("UNKNOWN_{msgid}"), count_row(count))?;
    }
    let dict = summary_dict(py, &sum, types)?;
    dict.set_item("unknown", unknown_of_log(&sum.unknown))?;
    Ok(dict)
}

/// Tells Python how far a run is, and heeds the user's wish to stop.
pub(crate) struct Teller(pub(crate) Option<Py<PyAny>>);

impl Teller {
    pub(crate) fn tell(&self, bytes: u64) -> Result<()> {
        Python::attach(|py| {
            py.check_signals()?;
            if let Some(pulse) = &self.0 {
                pulse.bind(py).invoke1((bytes,))?;
            }
            Ok(())
        })
    }
}

/// A summary as Python takes it.
pub(crate) fn summary_dict<'py>(
    py: Python<'py>,
    sum: &Summary,
    types: Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let senders = PyDict::new(py);
    for (ids, sender) in &sum.senders {
        let Sender { lost, repeated, clocks, .. } = sender;
        let (reboots, shared) = (clocks.reboots(), clocks.is_shared());
        senders.set_item(ids, (count_row(&sender.count), lost, repeated, reboots, shared))?;
    }
    let bad = PyList::new(py, sum.bad.iter().map(|range| (range.start, range.end - range.start)))?;
    let dict = PyDict::new(py);
    dict.set_item("bytes", sum.bytes)?;
    dict.set_item("stamped", sum.stamped)?;
    dict.set_item("count", count_row(&sum.count))?;
    dict.set_item("types", types)?;
    dict.set_item("unlisted", sum.unknown.unlisted)?;
    dict.set_item("senders", senders)?;
    dict.set_item("gaps", &sum.gaps)?;
    dict.set_item("gap_count", sum.gap_count)?;
    dict.set_item("times_back", sum.times_back)?;
    dict.set_item("set_back", sum.steady.set_back as f64 * 1e-6)?;
    dict.set_item("times_forward", sum.steady.times_forward)?;
    dict.set_item("set_forward", sum.steady.set_forward as f64 * 1e-6)?;
    dict.set_item("distrusted", sum.distrusted)?;
    dict.set_item("bad", bad)?;
    dict.set_item("bad_count", sum.bad_count)?;
    dict.set_item("bad_bytes", sum.bad_bytes)?;
    dict.set_item("version1", sum.version1)?;
    dict.set_item("signed", sum.signed)?;
    dict.set_item("damage", &sum.damage)?;
    Ok(dict)
}
