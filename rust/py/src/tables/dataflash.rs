//! `DataflashTables`: what a dataflash log says about itself, and its records as tables.

use std::sync::Arc;

use mavwire_columns::dataflash::{self, Form, Survey, Whole, table_layout};
use mavwire_columns::input::Steps;
use mavwire_columns::layout::Options;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::python::error::Result;
use crate::tables::columns::{LogColumns, Query, Teller, count_row, summary_dict, table};
use crate::tables::identify::kind_in;
use crate::tables::source::Source;
use crate::tables::table::RecordBatches;

/// A dataflash log, binary or text, that was gone through once for what it says about itself.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct DataflashTables {
    log: Source,
    survey: Arc<Survey>,
}

/// Tables and the names of their types.
type Tables = Vec<(String, RecordBatches)>;

#[pymethods]
impl DataflashTables {
    /// A log's description of itself, with the tables that `query` asks for. None if it is no dataflash log. The tables
    /// are None without a query, or if they need another pass over the log, by `columns`.
    #[staticmethod]
    #[pyo3(signature = (log, query=None))]
    fn read(
        py: Python<'_>,
        log: Source,
        query: Option<Query>,
    ) -> Result<Option<(Self, Option<Tables>)>> {
        let tell = Teller(None);
        let plan = query.map(|query| query.plan(None, log.size()));
        let whole = py.detach(|| -> Result<_> {
            if !kind_in(&log)?.is_dataflash() {
                return Ok(None);
            }
            let (open, steps, pulse) = (|| log.open(), Steps::default(), || tell.tell(0));
            if let Some(plan) = plan {
                return dataflash::read_whole(steps, &open, &plan, pulse);
            }
            let survey = Survey::read(steps, &open, pulse)?;
            Ok(survey.map(|survey| Whole { survey, rows: None }))
        })?;
        Ok(whole.map(|Whole { survey, rows }| {
            let tables = rows.map(|(batches, _)| batches.into_iter().map(table).collect());
            (Self { log, survey: Arc::new(survey) }, tables)
        }))
    }

    /// The columns of each record type that the log describes, `{name: [column, ...]}`.
    fn types<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let columns = |table| -> Vec<String> {
            let layout = table_layout(&self.survey, table, &Options::default()).layout;
            layout.columns.iter().map(|column| column.name().to_owned()).collect()
        };
        let types = PyDict::new(py);
        for (table, name) in self.survey.tables.iter().enumerate() {
            // Of thousands of types each is made without the interpreter: other threads go on meanwhile.
            types.set_item(&**name, py.detach(|| columns(table)))?;
            py.check_signals()?;
        }
        Ok(types)
    }

    /// A table without rows of a record type, with the columns that `query` asks for. `KeyError` for no such type.
    fn empty(&self, name: &str, query: Query) -> PyResult<RecordBatches> {
        let missing = || PyKeyError::new_err(name.to_owned());
        let table = self.survey.table(name).ok_or_else(missing)?;
        let layout = table_layout(&self.survey, table, &query.options()).layout;
        Ok(RecordBatches::new(Arc::clone(&layout.schema), Vec::new()))
    }

    /// One run over the log, giving tables.
    fn columns(&self, py: Python<'_>, query: Query) -> Result<LogColumns> {
        let (survey, plan) = (Arc::clone(&self.survey), query.plan(None, 0));
        LogColumns::begin(py, &query, || dataflash::reader(survey, &|| self.log.open(), plan))
    }

    /// The summary of the log, as a dict: see `mavwire.logs.summary`. `pulse` takes the bytes read so far.
    fn summary<'py>(
        &self,
        py: Python<'py>,
        gap: u64,
        pulse: Option<Py<PyAny>>,
    ) -> Result<Bound<'py, PyDict>> {
        let tell = Teller(pulse);
        let open = || self.log.open();
        let sum =
            py.detach(|| dataflash::summary(&self.survey, &open, gap, |bytes| tell.tell(bytes)))?;
        let types = PyDict::new(py);
        let counted = self.survey.tables.iter().zip(&sum.types);
        for (name, count) in counted.filter(|(_, count)| count.messages > 0) {
            types.set_item(&**name, count_row(count))?;
        }
        Ok(summary_dict(py, &sum, types)?)
    }
}

properties! {
    DataflashTables:

    /// Whether it is a binary log; else it is text.
    is_binary: bool = |log| (field matches!(log.survey.form, Form::Binary(_)));
    /// The record types that the log describes.
    names: Vec<&str> = |log| (field log.survey.tables.iter().map(|name| &**name).collect());
}
