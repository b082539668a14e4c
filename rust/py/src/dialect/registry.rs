//! A dialect as Python holds it: the registry that scans frames, and one Python class per message, made on first use.

use std::collections::{HashMap, HashSet};
use std::sync::{Arc, Mutex, OnceLock};

use mavwire_columns::layout::Layouts;
use mavwire_core::builtin;
use mavwire_core::frame::{FrameRef, Header};
use mavwire_core::registry::Registry;
use mavwire_core::unknown::UnknownKind;
use mavwire_schema::{
    Definitions, InvalidRule, Message as SchemaMessage, ParseOptions, SchemaError, WireVersion,
    dialect_name, parse_definitions, resolve,
};
use pyo3::exceptions::{PyKeyError, PyRuntimeError, PyValueError};
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyDict, PyList, PyString, PyTuple, PyType};

use crate::dialect::definition_file::{FileSet, parse_sets};
use crate::message::create;
use crate::message::info::{Info, MessageInfo};
use crate::message::object::{Message, Origin};
use crate::python::calling::Calling;
use crate::python::error::Result;
use mavwire_core::frame::FrameBytes;

/// The Python class of one message, with its definition at hand.
pub(crate) struct MessageClass {
    pub(crate) class: Py<PyType>,
    pub(crate) info: &'static Info,
}

/// A resolved dialect, bound to the namespace of its Python module.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct Dialect {
    pub(crate) registry: Arc<Registry>,
    classes: Box<[OnceLock<MessageClass>]>,
    by_name: HashMap<String, u16>,
    namespace: OnceLock<Py<PyDict>>,
    make_class: OnceLock<Py<PyAny>>,
    /// The original `MAVLink_bad_data` and `MAVLink_unknown` of the module.
    special: OnceLock<Vec<Py<PyAny>>>,
    /// The columns of its messages, as they were last wanted.
    pub(crate) layouts: Mutex<Option<Arc<Layouts>>>,
}

/// A definition file by the path that an `<include>` gives: the user's first, else one that comes with mavwire.
pub(crate) fn lookup(
    sources: &HashMap<String, String>,
    path: &str,
) -> Result<Definitions, SchemaError> {
    match sources.get(dialect_name(path)) {
        Some(text) => parse_definitions(path, text, &ParseOptions::default()),
        None => builtin::definitions(path),
    }
}

fn wire_version(text: &str) -> PyResult<WireVersion> {
    match text {
        "1.0" => Ok(WireVersion::V1),
        "2.0" => Ok(WireVersion::V2),
        _ => Err(PyValueError::new_err(format!(
            "wire protocol must be \"1.0\" or \"2.0\", not {text:?}"
        ))),
    }
}

impl Dialect {
    fn new(registry: Registry) -> Self {
        let messages = &registry.dialect().messages;
        Self {
            classes: messages.iter().map(|_| OnceLock::new()).collect(),
            by_name: messages.iter().zip(0..).map(|(m, i)| (m.name.clone(), i)).collect(),
            registry: Arc::new(registry),
            namespace: OnceLock::new(),
            make_class: OnceLock::new(),
            special: OnceLock::new(),
            layouts: Mutex::default(),
        }
    }

    /// Globals of the Python module this dialect belongs to.
    pub(crate) fn namespace<'py>(&self, py: Python<'py>) -> PyResult<&Bound<'py, PyDict>> {
        let unbound = || PyRuntimeError::new_err("the dialect is not bound to a module");
        Ok(self.namespace.get().ok_or_else(unbound)?.bind(py))
    }

    /// A name of the Python module, looked up each time because user code may assign to it.
    pub(crate) fn global<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let value = self.namespace(py)?.get_item(name)?;
        value.ok_or_else(|| PyRuntimeError::new_err(format!("the dialect module lost its {name}")))
    }

    /// A message of the module's class called `name`, made of `message`. A class that the program put there is called with
    /// `arguments` instead.
    pub(crate) fn special<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        message: Message,
        arguments: impl FnOnce(&Message) -> PyResult<Bound<'py, PyTuple>>,
    ) -> PyResult<Bound<'py, Message>> {
        let class = self.global(py, name)?;
        let is_own = self.special.get().is_some_and(|own| own.iter().any(|own| class.is(own)));
        match class.cast::<PyType>() {
            Ok(class) if is_own => create::create(class, message),
            _ => Ok(class.invoke1(arguments(&message)?)?.cast_into::<Message>()?),
        }
    }

    /// The version in which frames are made: the module's `WIRE_PROTOCOL_VERSION`, which user code may change at any time.
    pub(crate) fn version(&self, py: Python<'_>, force_mavlink1: bool) -> PyResult<WireVersion> {
        if force_mavlink1 {
            return Ok(WireVersion::V1);
        }
        let version = self.namespace(py)?.get_item(intern!(py, "WIRE_PROTOCOL_VERSION"))?;
        let Some(version) = version else { return Ok(WireVersion::V2) };
        // The strings that modules start with are interned, so that comparing pointers is enough.
        if version.is(intern!(py, "2.0")) {
            return Ok(WireVersion::V2);
        }
        if version.is(intern!(py, "1.0")) {
            return Ok(WireVersion::V1);
        }
        let number = py.get_type::<pyo3::types::PyFloat>().invoke1((version,))?;
        let is_v2 = (number.extract::<f64>()? - 2.0).abs() < f64::EPSILON;
        Ok(if is_v2 { WireVersion::V2 } else { WireVersion::V1 })
    }

    /// The class of the message with this index, if it was used before.
    #[inline]
    pub(crate) fn known_class(&self, index: u16) -> Option<&MessageClass> {
        self.classes[usize::from(index)].get()
    }

    /// Whether it made this class, which is that of the message with the id.
    #[inline]
    pub(crate) fn made(&self, class: &Bound<'_, PyType>, msgid: u32) -> bool {
        let known = self.registry.lookup(msgid).and_then(|entry| self.known_class(entry.index));
        known.is_some_and(|known| known.class.is(class))
    }

    /// The class of the message with this index, made if it is the first use.
    #[inline]
    pub(crate) fn class(&self, py: Python<'_>, index: u16) -> PyResult<&MessageClass> {
        self.known_class(index).map_or_else(|| self.make_class(py, index), Ok)
    }

    #[cold]
    fn make_class(&self, py: Python<'_>, index: u16) -> PyResult<&MessageClass> {
        let cell = &self.classes[usize::from(index)];
        // Making the class runs Python, which may come back here. The first class stays.
        let info = Info::of(py, self.registry.message(index));
        let make = self.make_class.get().ok_or_else(|| PyRuntimeError::new_err("not bound"))?;
        let wrapped = Bound::new(py, MessageInfo { info })?;
        let class = make.bind(py).invoke1((wrapped,))?.cast_into::<PyType>()?.unbind();
        Ok(cell.get_or_init(|| MessageClass { class, info }))
    }

    /// A message object around a received frame, finished by `finish`; `index` is `None` for an unknown id.
    pub(crate) fn message<'py>(
        &self,
        py: Python<'py>,
        index: Option<u16>,
        frame: FrameBytes,
        finish: impl FnOnce(Message) -> Message,
    ) -> PyResult<Bound<'py, Message>> {
        if let Some(index) = index {
            let class = self.class(py, index)?;
            let message = Message::received(Some(class.info), frame, Origin::Decoded);
            return create::pooled(class.class.bind(py), finish(message));
        }
        let message = finish(Message::received(None, frame, Origin::Unknown));
        self.special(py, "MAVLink_unknown", message, |message| {
            let id = Header::parse(&message.frame).map_or(0, |header| header.msgid);
            (id, PyByteArray::new(py, &message.frame)).into_pyobject(py)
        })
    }
}

#[pymethods]
impl Dialect {
    /// A dialect that comes with mavwire, laid out for wire protocol "1.0" or "2.0".
    #[staticmethod]
    fn builtin(name: &str, wire_protocol: &str) -> Result<Self> {
        Ok(Self::new(Registry::new(builtin::dialect(name, wire_version(wire_protocol)?)?)))
    }

    /// A dialect from XML texts: `sources` maps file base names to texts, `main` names the one to start from. Includes
    /// are looked up in `sources` first and among the built-in dialects second.
    #[staticmethod]
    fn from_sources(
        main: &str,
        sources: HashMap<String, String>,
        wire_protocol: &str,
    ) -> Result<Self> {
        let mut lookup = |path: &str| lookup(&sources, path);
        Ok(Self::new(Registry::new(resolve(main, &mut lookup, wire_version(wire_protocol)?)?)))
    }

    /// One dialect of several: the first that knows a message id names it.
    #[staticmethod]
    fn merged(first: &Self, others: Vec<PyRef<'_, Self>>) -> Result<Self> {
        let mut registry = Registry::clone(&first.registry);
        for other in others {
            registry = registry.merged(&other.registry)?;
        }
        Ok(Self::new(registry))
    }

    /// The dialect `upstream` with newer sets of definitions: for each set the texts by file base names.
    #[staticmethod]
    fn upstream_with(sets: Vec<FileSet>, wire_protocol: &str) -> Result<Self> {
        let dialect = builtin::upstream_with(parse_sets(&sets)?, wire_version(wire_protocol)?)?;
        Ok(Self::new(Registry::new(dialect)))
    }

    /// Names of the built-in dialects.
    #[staticmethod]
    fn names() -> Vec<&'static str> {
        builtin::names().collect()
    }

    /// Ties the dialect to its module: `namespace` are the module's globals, `make_class(info)` makes a message class.
    fn bind(&self, py: Python<'_>, namespace: Py<PyDict>, make_class: Py<PyAny>) -> PyResult<()> {
        let mut special = Vec::new();
        for name in ["MAVLink_bad_data", "MAVLink_unknown"] {
            special.extend(namespace.bind(py).get_item(name)?.map(Bound::unbind));
        }
        let fresh = self.namespace.set(namespace).is_ok()
            & self.make_class.set(make_class).is_ok()
            & self.special.set(special).is_ok();
        if fresh { Ok(()) } else { Err(PyRuntimeError::new_err("the dialect is bound already")) }
    }

    /// Name of the main definition file.
    #[getter]
    fn name(&self) -> &str {
        &self.registry.dialect().name
    }

    /// "1.0" or "2.0".
    #[getter]
    fn wire_protocol<'py>(&self, py: Python<'py>) -> &Bound<'py, PyString> {
        match self.registry.dialect().wire_version {
            WireVersion::V1 => intern!(py, "1.0"),
            WireVersion::V2 => intern!(py, "2.0"),
        }
    }

    /// `[(name, id), ...]` in the dialect's order.
    fn messages(&self) -> Vec<(&str, u32)> {
        self.registry.own_messages().iter().map(|m| (m.name.as_str(), m.id)).collect()
    }

    /// Whether frames of a message id with this `crc_extra` are messages, also of an earlier layout.
    fn defines(&self, msgid: u32, crc_extra: u8) -> bool {
        let entry = self.registry.lookup(msgid);
        entry.is_some_and(|entry| entry.crc_extra == crc_extra)
            || self.registry.other(msgid, crc_extra).is_some()
    }

    /// Names of the layouts that ids have in other definitions.
    fn other_layouts(&self) -> Vec<&str> {
        let own = self.registry.own_messages().len();
        self.registry.dialect().messages.iter().skip(own).map(|m| m.name.as_str()).collect()
    }

    /// The message class of an upper-case name, or `KeyError`.
    fn message_class(&self, py: Python<'_>, name: &str) -> PyResult<Py<PyType>> {
        let index = self.by_name.get(name).ok_or_else(|| PyKeyError::new_err(name.to_owned()))?;
        Ok(self.class(py, *index)?.class.clone_ref(py))
    }

    /// Integer constants of the module: message ids and enum entries, `<ENUM>_ENUM_END` included.
    fn add_constants(&self, namespace: &Bound<'_, PyDict>) -> PyResult<()> {
        let py = namespace.py();
        let dialect = self.registry.dialect();
        for message in self.registry.own_messages() {
            namespace.set_item(format!("MAVLINK_MSG_ID_{}", message.name), message.id)?;
        }
        for definition in &dialect.enums {
            for entry in &definition.entries {
                namespace.set_item(&entry.name, number(py, entry.value)?)?;
            }
            namespace.set_item(end_name(definition), number(py, end_value(definition))?)?;
        }
        Ok(())
    }

    /// `[(enum name, bitmask, description, [(value, name, description, has_location, params), ...]), ...]`, where
    /// `params` is `[(index, label, description, reserved, default), ...]`; the end marker is the last entry.
    fn enums<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let rows = PyList::empty(py);
        for definition in &self.registry.dialect().enums {
            let entries = PyList::empty(py);
            for entry in &definition.entries {
                let params: Vec<_> = entry
                    .params
                    .iter()
                    .map(|p| (p.index, &p.label, &p.description, p.reserved, &p.default))
                    .collect();
                entries.append((
                    entry.value,
                    &entry.name,
                    &entry.description,
                    entry.has_location,
                    params,
                ))?;
            }
            let no_params: Vec<u8> = Vec::new();
            entries.append((end_value(definition), end_name(definition), "", false, no_params))?;
            rows.append((&definition.name, definition.bitmask, &definition.description, entries))?;
        }
        Ok(rows)
    }

    /// A text that differs where the tables of some messages, or of all, differ.
    #[pyo3(signature = (types=None))]
    fn layout_text(&self, types: Option<HashSet<u32>>) -> String {
        let messages = &self.registry.dialect().messages;
        let wanted =
            messages.iter().filter(|m| types.as_ref().is_none_or(|ids| ids.contains(&m.id)));
        let of_message = |m: &SchemaMessage| {
            let fields = m.fields.iter().map(|f| {
                let told = [&f.units, &f.enum_name, &f.display, &f.multiplier, &f.invalid];
                format!("{:?}", (&f.name, f.field_type, f.array_length, told))
            });
            let fields: Vec<_> = fields.collect();
            format!("{:?}", (m.id, &m.name, m.crc_extra, m.instance_field, fields))
        };
        wanted.map(of_message).collect()
    }

    /// The fields of a frame that have invalid values: for each element, whether it is invalid.
    fn invalid_fields(&self, frame: &[u8]) -> HashMap<&str, Vec<bool>> {
        let known = FrameRef::parse(frame).ok().and_then(|frame| {
            let other = UnknownKind::of(frame.bytes())
                .and_then(|kind| self.registry.other(kind.msgid, kind.crc_extra));
            let entry = other.or_else(|| self.registry.lookup(frame.header().msgid))?;
            Some((self.registry.message(entry.index), frame.payload()))
        });
        let Some((message, payload)) = known else { return HashMap::new() };
        let mut whole = payload.to_vec();
        whole.resize(payload.len().max(message.max_len.into()), 0);
        let enums = &self.registry.dialect().enums;
        let marked = message.fields.iter().filter_map(|field| {
            let (invalid, bytes) = (InvalidRule::of(field, enums)?, &whole[field.offset.into()..]);
            let marks: Vec<_> =
                (0..field.elements()).map(|n| invalid.is_invalid(bytes, n)).collect();
            marks.contains(&true).then_some((field.name.as_str(), marks))
        });
        marked.collect()
    }

    /// Descriptions that the definitions themselves carry: `(message text, {field: text})`; empty for built-in ones.
    fn descriptions(&self, name: &str) -> PyResult<(String, HashMap<String, String>)> {
        let index = self.by_name.get(name).ok_or_else(|| PyKeyError::new_err(name.to_owned()))?;
        let message = self.registry.message(*index);
        let fields = message.fields.iter().map(|f| (f.name.clone(), f.description.clone()));
        Ok((message.description.clone(), fields.collect()))
    }

    fn __repr__(&self) -> String {
        let dialect = self.registry.dialect();
        format!("<Dialect {} {:?}>", dialect.name, dialect.wire_version)
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        for class in self.classes.iter().filter_map(OnceLock::get) {
            visit.call(&class.class)?;
        }
        visit.call(self.namespace.get())?;
        visit.call(self.make_class.get())?;
        self.special.get().into_iter().flatten().try_for_each(|class| visit.call(class))
    }
}

fn end_name(definition: &mavwire_schema::Enum) -> String {
    format!("{}_ENUM_END", definition.name)
}

/// An enum value; nearly all are small, which is the quick conversion.
fn number(py: Python<'_>, value: i128) -> PyResult<Bound<'_, PyAny>> {
    Ok(match i64::try_from(value) {
        Ok(small) => small.into_pyobject(py)?.into_any(),
        Err(_) => value.into_pyobject(py)?.into_any(),
    })
}

fn end_value(definition: &mavwire_schema::Enum) -> i128 {
    definition.entries.iter().map(|entry| entry.value).max().map_or(1, |last| last + 1)
}
