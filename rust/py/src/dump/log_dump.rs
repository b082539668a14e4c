//! `dump_log`: a telemetry log as text, JSON lines, CSV rows or records, formatted from the frames where they stand.
//!
//! `mavwire dump` prints frames without making message objects. The output equals that of the command's ordinary loop over
//! `recv_match` byte for byte; tests compare the two.

use std::cell::OnceCell;
use std::rc::Rc;
use std::sync::Arc;

use mavwire_core::frame::Header;
use mavwire_core::parser::Step;
use mavwire_core::registry::Registry;
use mavwire_core::telemetry::{StatusTexts, TextFields};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::link::log_link::LogLink;
use crate::message::object::payload_of;
use crate::protocol::parse;
use crate::python::calling::Calling;
use crate::python::lists::list;
use crate::sync::gil_yield::GilYield;
use mavwire_core::dump_line::{Column, Item, Labels, Line, Style, write_line};
use mavwire_core::frame::FrameBytes;

/// Bytes collected before they are written.
const CHUNK: usize = 256 * 1024;
/// Messages between two looks whether others should have a turn; then the run tells how far it is, too.
const PULSE: u64 = 16 * 1024;

/// The options of a dump: the attributes of the object that `dump_log` is given.
#[derive(FromPyObject)]
struct Options<'py> {
    /// `standard`, `json`, `csv` or `none`.
    format: String,
    /// Takes the lines, as UTF-8 bytes.
    write: Bound<'py, PyAny>,
    /// Takes the matching messages as records of a telemetry log.
    record: Option<Bound<'py, PyAny>>,
    /// Says whether messages of a type name are dumped. Asked for each one that the dialect does not define.
    wanted: Bound<'py, PyAny>,
    /// Types to visit in an indexed log, as `recv_match` takes them.
    types: Option<Bound<'py, PyAny>>,
    /// Says what the local clock shows at a time in whole seconds since 1970.
    local_time: Bound<'py, PyAny>,
    /// Takes percentages.
    progress: Bound<'py, PyAny>,
    source_system: Option<i64>,
    source_component: Option<i64>,
    link: Option<i64>,
    show_source: bool,
    show_seq: bool,
    separator: String,
    /// Message types of a CSV table, in the order of its columns.
    #[pyo3(from_py_with = list)]
    columns: Vec<String>,
}

/// The content of a log at one place.
struct Found {
    step: Step,
    time: f64,
    link: u8,
}

/// The message types of the log's dialect.
struct Types {
    registry: Arc<Registry>,
    style: Style,
    labels: Vec<OnceCell<Labels>>,
    /// The message whose texts are joined.
    text: Option<(u16, TextFields)>,
}

/// The message with the first part of a text.
struct FirstPart {
    frame: FrameBytes,
    time: f64,
}

struct Dump<'a, 'py> {
    log: &'a Bound<'py, LogLink>,
    options: Options<'py>,
    types: Rc<Types>,
    /// Answers of `Options::wanted` by message index.
    wanted: Vec<Option<bool>>,
    texts: StatusTexts<FirstPart>,
    lines: String,
    records: Vec<u8>,
    /// Whole seconds and their text, of the message before.
    clock: (u64, String),
    gil_yield: GilYield,
}

/// Dumps a log from its position to its end. `options` has the attributes of `mavwire.cli.logs._dump_native.Options`.
///
/// # Errors
/// Where reading or a callback fails; what was read before is written first. `RuntimeError` if the log is not open, or
/// its protocol version is still to be found out.
#[pyfunction]
pub(crate) fn dump_log<'py>(
    log: &Bound<'py, LogLink>,
    options: &Bound<'py, PyAny>,
) -> PyResult<()> {
    let mut dump = Dump::new(log, options.extract()?)?;
    let result = dump.run();
    let left = dump.texts.finish();
    dump.write_texts(left);
    dump.flush()?;
    result
}

impl Types {
    fn known<'a>(&'a self, index: u16, frame: &'a [u8], header: Header) -> Item<'a> {
        let message = self.registry.message(index);
        let cell = &self.labels[usize::from(index)];
        let labels = cell.get_or_init(|| Labels::new(&self.style, message));
        let (payload, text) = (payload_of(frame), None);
        Item::Known { index, message, labels, payload, header, text }
    }
}

impl<'a, 'py> Dump<'a, 'py> {
    fn new(log: &'a Bound<'py, LogLink>, options: Options<'py>) -> PyResult<Self> {
        let link = log.as_super().get();
        if !link.state().knows_version || !link.is_quick() || !link.state().reads_log() {
            return Err(PyRuntimeError::new_err("the log is not ready to be dumped"));
        }
        let mav = link.mav(log.py())?;
        parse::obey_ignore_checksum(&mav)?;
        let registry = mav.get().dialect.get().registry.clone();
        let count = registry.dialect().messages.len();
        let style = style(&options, &registry)?;
        let labels = (0..count).map(|_| OnceCell::new()).collect();
        let messages = (0..).zip(&registry.dialect().messages);
        let mut text = messages.filter_map(|(index, one)| Some((index, TextFields::of(one)?)));
        let text = text.next().filter(|_| matches!(style, Style::Json { .. }));
        Ok(Self {
            log,
            options,
            types: Rc::new(Types { registry, style, labels, text }),
            wanted: vec![None; count],
            texts: StatusTexts::default(),
            lines: String::with_capacity(CHUNK + CHUNK / 4),
            records: Vec::new(),
            clock: (u64::MAX, String::new()),
            gil_yield: GilYield::new(),
        })
    }

    fn run(&mut self) -> PyResult<()> {
        let mut seen: u64 = 0;
        loop {
            if let Some(types) = &self.options.types {
                LogLink::skip_to_type(self.log, types)?;
            }
            let Some(found) = self.next()? else { return Ok(()) };
            self.take(&found)?;
            seen += 1;
            if seen.is_multiple_of(PULSE) {
                self.gil_yield.give_way(self.log.py())?;
                let percent = self.log.as_super().get().state().percent;
                self.options.progress.invoke1((percent,))?;
            }
        }
    }

    /// The content of the log at its place; `None` at its end.
    fn next(&self) -> PyResult<Option<Found>> {
        let mut guard = self.log.as_super().get().state();
        let state = &mut *guard;
        let (Some(reader), Some(mav)) = (state.reader.as_mut(), state.native_mav.as_ref()) else {
            return Ok(None);
        };
        state.percent = reader.percent();
        let (mut parser, registry) = (mav.get().parser(), &self.types.registry);
        let checks = mav.get().checks_signatures(self.log.py());
        let has_own_rules = parser.scanner.ignore_checksum || checks;
        if !has_own_rules
            && let Some(record) = reader.peek(&parser, registry)?
            && let Some(header) = Header::parse(record.stream)
        {
            let (len, time, link) = (record.len, record.time, record.link);
            let (bytes, entry) = (record.stream[..len].into(), registry.entry(record.index));
            parser.passed(record.stream[0]);
            reader.accept(len, time, link);
            return Ok(Some(Found { step: Step::Frame { bytes, header, entry }, time, link }));
        }
        let (step, _) = reader.next(&mut parser, registry, true)?;
        if matches!(step, Step::Nothing) {
            return Ok(None);
        }
        Ok(Some(Found { step, time: reader.time, link: reader.link }))
    }

    /// Writes what was found if it is wanted. Bytes that start no frame are never shown.
    fn take(&mut self, found: &Found) -> PyResult<()> {
        let types = self.types.clone();
        let (item, frame) = match &found.step {
            Step::Frame { bytes, header, entry: Some(entry) } => {
                (types.known(entry.index, bytes, *header), bytes)
            }
            Step::Frame { bytes, header, entry: None } => {
                (Item::Unknown { msgid: header.msgid, frame: bytes }, bytes)
            }
            Step::Bad { bytes, error: Some(error) } => {
                (Item::Bad { frame: bytes, reason: error.to_string() }, bytes)
            }
            _ => return Ok(()),
        };
        if !self.is_selected(&item, found.link) || !self.is_wanted(&item)? {
            return Ok(());
        }
        if self.options.record.is_some() {
            let micros = (found.time * 1.0e6) as u64;
            self.records.extend_from_slice(&micros.to_be_bytes());
            self.records.extend_from_slice(frame);
        }
        if let Some((index, fields)) = &types.text
            && let Item::Known { index: known, payload, header, .. } = &item
            && known == index
        {
            let first = || FirstPart { frame: frame.clone(), time: found.time };
            let sender = (header.sysid, header.compid);
            let done = self.texts.receive(*fields, sender, payload, first);
            self.write_texts(done);
        } else {
            self.set_clock(found.time)?;
            let line = Line { time: found.time, clock: &self.clock.1, item: &item };
            write_line(&mut self.lines, &types.style, &line);
        }
        if self.lines.len() >= CHUNK || self.records.len() >= CHUNK {
            self.flush()?;
        }
        Ok(())
    }

    /// Writes lines of texts that were sent in parts.
    fn write_texts(&mut self, texts: Vec<(FirstPart, Vec<u8>)>) {
        let types = self.types.clone();
        for (FirstPart { frame, time }, joined) in texts {
            if let Some((index, _)) = types.text
                && let Some(header) = Header::parse(&frame)
                && let Item::Known { message, labels, payload, .. } =
                    types.known(index, &frame, header)
            {
                let text = Some(&joined[..]);
                let item = Item::Known { index, message, labels, payload, header, text };
                write_line(&mut self.lines, &types.style, &Line { time, clock: "", item: &item });
            }
        }
    }

    fn is_wanted(&mut self, item: &Item<'_>) -> PyResult<bool> {
        let index = match item {
            Item::Known { index, .. } => Some(usize::from(*index)),
            _ => None,
        };
        if let Some(answer) = index.and_then(|index| self.wanted[index]) {
            return Ok(answer);
        }
        let answer = self.options.wanted.invoke1((item.name(),))?.is_truthy()?;
        if let Some(index) = index {
            self.wanted[index] = Some(answer);
        }
        Ok(answer)
    }

    /// It comes from the source and the link that were asked for.
    fn is_selected(&self, item: &Item<'_>, link: u8) -> bool {
        let fits =
            |asked: Option<i64>, value: u8| asked.is_none_or(|asked| asked == i64::from(value));
        let (sysid, compid, _) = item.source();
        fits(self.options.source_system, sysid)
            && fits(self.options.source_component, compid)
            && fits(self.options.link, link)
    }

    /// Asks for the text of a time if its second is a new one.
    fn set_clock(&mut self, time: f64) -> PyResult<()> {
        let second = time as u64;
        if second != self.clock.0 && self.types.style.shows_clock() {
            self.clock = (second, self.options.local_time.invoke1((second,))?.extract()?);
        }
        Ok(())
    }

    fn flush(&mut self) -> PyResult<()> {
        let py = self.log.py();
        if !self.lines.is_empty() {
            let bytes = PyBytes::new(py, self.lines.as_bytes());
            self.lines.clear();
            self.options.write.invoke1((bytes,))?;
        }
        if let Some(record) = &self.options.record
            && !self.records.is_empty()
        {
            let bytes = PyBytes::new(py, &self.records);
            self.records.clear();
            record.invoke1((bytes,))?;
        }
        self.gil_yield.give_way(py)
    }
}

fn style(options: &Options<'_>, registry: &Registry) -> PyResult<Style> {
    let (show_source, show_seq) = (options.show_source, options.show_seq);
    Ok(match options.format.as_str() {
        "none" => Style::Silent,
        "standard" => Style::Standard { show_source, show_seq },
        "json" => Style::Json { show_source },
        "csv" => {
            let column = |name: &String| column(registry, name, &options.separator);
            let columns = options.columns.iter().map(column).collect::<PyResult<_>>()?;
            Style::Csv { separator: options.separator.clone(), columns }
        }
        other => return Err(PyValueError::new_err(format!("no such format: {other:?}"))),
    })
}

fn column(registry: &Registry, name: &str, separator: &str) -> PyResult<Column> {
    let messages = &registry.dialect().messages;
    let found = messages.iter().zip(0..).find(|(message, _)| message.name == name);
    let (message, index) =
        found.ok_or_else(|| PyValueError::new_err(format!("no such message type: {name:?}")))?;
    Ok(Column { index, blanks: separator.repeat(message.fields.len()) })
}
