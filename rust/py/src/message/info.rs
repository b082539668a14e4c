//! The facts of a message class: its definition and the interned Python names that go with it.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use mavwire_core::codec::read;
use mavwire_schema::{Field, FieldType, Message as Definition};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyString, PyTuple};

/// The message that tells a parameter.
pub(crate) const PARAM_VALUE: &str = "PARAM_VALUE";

/// Messages that tell flight modes, parameters and the home position.
const CHANGES_STATE: [&str; 4] = ["HEARTBEAT", "HIGH_LATENCY2", "PARAM_VALUE", "GPS_RAW_INT"];

/// Python names of one field, interned once per message class.
pub(crate) struct FieldNames {
    /// The attribute.
    pub(crate) name: Py<PyString>,
    /// `_<field>_raw`, the bytes behind a text field.
    pub(crate) raw: Option<Py<PyString>>,
}

impl FieldNames {
    /// The one under which the instance dictionary holds what is sent.
    #[inline]
    pub(crate) fn stored(&self) -> &Py<PyString> {
        self.raw.as_ref().unwrap_or(&self.name)
    }
}

/// The place of a field in the payload. The values that are read most are close together in memory.
#[derive(Clone, Copy)]
pub(crate) struct Place {
    pub(crate) field_type: FieldType,
    pub(crate) offset: u8,
    /// Elements of an array or text; 0 for a scalar.
    pub(crate) array_length: u8,
}

impl Place {
    /// Bytes on the wire.
    pub(crate) fn wire_len(self) -> usize {
        self.field_type.size() * usize::from(self.array_length.max(1))
    }
}

/// A message definition with what Python needs to know of it.
pub(crate) struct Info {
    pub(crate) definition: Definition,
    /// Counts the definitions of the process from 0.
    pub(crate) number: usize,
    pub(crate) name: Py<PyString>,
    /// In XML order, like `definition.fields`.
    pub(crate) names: Vec<FieldNames>,
    /// In XML order as well.
    pub(crate) places: Vec<Place>,
    /// A lone `char` cannot be packed from an empty text, which `struct` must then say.
    pub(crate) has_char_scalar: bool,
    /// The definition has a field with this name; says where `uptime` comes from.
    pub(crate) usec: Option<usize>,
    pub(crate) time_boot_ms: Option<usize>,
    /// Changes more of a link's state than its table of newest messages.
    pub(crate) changes_state: bool,
}

/// Every definition that a message class was made for, by message id.
///
/// They stay for the life of the process, as interned strings do, so that each message can point to its own without
/// counting references. Equal definitions of several dialects, or of one that is loaded again and again, are one.
static INTERNED: Mutex<BTreeMap<u32, Vec<&'static Info>>> = Mutex::new(BTreeMap::new());

impl Info {
    /// The facts of a definition.
    pub(crate) fn of(py: Python<'_>, definition: &Definition) -> &'static Self {
        let find = |known: &BTreeMap<u32, Vec<&'static Self>>| {
            let same_id = known.get(&definition.id).into_iter().flatten();
            same_id.copied().find(|info| info.definition == *definition)
        };
        if let Some(info) = find(&INTERNED.lock().unwrap_or_else(PoisonError::into_inner)) {
            return info;
        }
        let mut made = Self::new(py, definition.clone());
        let mut known = INTERNED.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(info) = find(&known) {
            return info;
        }
        made.number = known.values().map(Vec::len).sum();
        let made: &'static Self = Box::leak(Box::new(made));
        known.entry(definition.id).or_default().push(made);
        made
    }

    fn new(py: Python<'_>, definition: Definition) -> Self {
        let names = definition
            .fields
            .iter()
            .map(|field| FieldNames {
                name: PyString::intern(py, &field.name).unbind(),
                raw: field
                    .is_char()
                    .then(|| PyString::intern(py, &format!("_{}_raw", field.name)).unbind()),
            })
            .collect();
        let place = |field: &Field| Place {
            field_type: field.field_type,
            offset: field.offset,
            array_length: field.array_length,
        };
        let position = |name: &str| definition.fields.iter().position(|f| f.name == name);
        Self {
            number: 0,
            name: PyString::intern(py, &definition.name).unbind(),
            names,
            places: definition.fields.iter().map(place).collect(),
            has_char_scalar: definition.fields.iter().any(|f| f.is_char() && f.array_length == 0),
            usec: position("usec"),
            time_boot_ms: position("time_boot_ms"),
            changes_state: CHANGES_STATE.contains(&definition.name.as_str()),
            definition,
        }
    }

    /// Seconds since boot that a payload tells: `time_boot_ms`, else `usec`.
    pub(crate) fn uptime(&self, payload: &[u8]) -> Option<f64> {
        use FieldType as T;
        let offset = |index: usize| usize::from(self.places[index].offset);
        let number = |index: usize| match self.places[index].field_type {
            T::U64 => Some(u64::from_le_bytes(read(payload, offset(index))) as f64),
            T::U32 => Some(f64::from(u32::from_le_bytes(read(payload, offset(index))))),
            T::Char | T::U8 | T::I8 | T::U16 | T::I16 | T::I32 | T::I64 | T::F32 | T::F64 => None,
        };
        let boot = self.time_boot_ms.and_then(number).map(|ms| ms * 1.0e-3);
        boot.or_else(|| self.usec.and_then(number).map(|us| us * 1.0e-6))
    }

    /// The message has a target system, and it is not 0.
    pub(crate) fn is_targeted(&self, payload: &[u8]) -> bool {
        let offset = self.definition.target_system_offset;
        offset.and_then(|at| payload.get(usize::from(at))).is_some_and(|&system| system != 0)
    }

    /// Field by attribute name.
    pub(crate) fn field(&self, name: &str) -> Option<(usize, &Field)> {
        self.definition.fields.iter().enumerate().find(|(_, f)| f.name == name)
    }
}

/// The schema of one message, as Python sees it: `cls._info`.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct MessageInfo {
    pub(crate) info: &'static Info,
}

impl MessageInfo {
    fn by_field<'py>(
        &self,
        py: Python<'py>,
        value: impl Fn(&Field) -> Option<&str>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (field, names) in self.info.definition.fields.iter().zip(&self.info.names) {
            if let Some(text) = value(field) {
                dict.set_item(names.name.bind(py), text)?;
            }
        }
        Ok(dict)
    }
}

#[pymethods]
impl MessageInfo {
    /// Field names in XML order.
    #[getter]
    fn fieldnames<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        PyList::new(py, self.info.names.iter().map(|n| n.name.bind(py)))
    }

    /// Field name to `display`.
    #[getter]
    fn fielddisplays_by_name<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.by_field(py, |f| f.display.as_deref())
    }

    /// Field name to enum name.
    #[getter]
    fn fieldenums_by_name<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.by_field(py, |f| f.enum_name.as_deref())
    }

    /// Field name to unit, without brackets.
    #[getter]
    fn fieldunits_by_name<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.by_field(py, |f| f.units.as_deref())
    }

    /// Name of the field that tells instances apart, and its payload offset.
    #[getter]
    fn instance(&self) -> (Option<&str>, i32) {
        let definition = &self.info.definition;
        match definition.instance_field.map(|i| &definition.fields[usize::from(i)]) {
            Some(field) => (Some(&field.name), i32::from(field.offset)),
            None => (None, -1),
        }
    }

    /// Constructor parameters, XML order: `(name, type, array_length, is_extension, mavlink_version)`.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let rows = self.info.definition.fields.iter().map(|f| {
            (
                f.name.as_str(),
                f.field_type.name(),
                u32::from(f.array_length),
                f.is_extension,
                f.mavlink_version.map(u32::from),
            )
                .into_pyobject(py)
        });
        PyList::new(py, rows.collect::<PyResult<Vec<Bound<'py, PyTuple>>>>()?)
    }
}

properties! {
    MessageInfo:

    /// Upper-case message name.
    name: Py<PyString> = |this, py| (field this.info.name.clone_ref(py));
    /// Message id.
    id: u32 = |this| (field this.info.definition.id);
    /// Checksum seed of the definition.
    crc_extra: u8 = |this| (field this.info.definition.crc_extra);
    /// Payload bytes of the base fields.
    min_len: u8 = |this| (field this.info.definition.min_len);
    /// Payload bytes with the extension fields.
    max_len: u8 = |this| (field this.info.definition.max_len);
    /// Field names in wire order.
    ordered_fieldnames: Vec<&str> =
        |this| (field this.info.definition.wire_fields().map(|(_, field)| field.name.as_str()).collect());
    /// Format of Python's `struct` module, wire order.
    unpacker_format: String = |this| (field this.info.definition.struct_format());
}
