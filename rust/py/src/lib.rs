//! `mavwire._native`: the core as Python classes.
//!
//! The only crate that knows PyO3. It translates: bytes and errors in, objects and exceptions out; what MAVLink is stands
//! in `mavwire-core` and `mavwire-schema`. Public Python classes derive from the ones here, see
//! `python/mavwire/dialects/_classes.py`.

use pyo3::prelude::*;

// First, for its macro.
#[macro_use]
mod python;

#[cfg(unix)]
mod bridge;
mod dataflash;
mod dialect;
mod dump;
mod link;
mod message;
mod port;
mod protocol;
mod sync;
mod tables;

#[pymodule(gil_used = true)]
mod _native {
    use mavwire_schema::FieldType;
    use pyo3::exceptions::PyImportError;
    use pyo3::prelude::*;
    use pyo3::types::IntoPyDict;

    use crate::python::calling::Calling;

    #[cfg(unix)]
    #[pymodule_export]
    use crate::bridge::batch::FrameBatch;
    #[cfg(unix)]
    #[pymodule_export]
    use crate::bridge::core::{BridgeCore, BridgeTap};
    #[pymodule_export]
    use crate::dataflash::clock::{MicrosClock, gps_time};
    #[pymodule_export]
    use crate::dataflash::message::DFMessage;
    #[pymodule_export]
    use crate::dataflash::reader::DataflashReader;
    #[pymodule_export]
    use crate::dataflash::shape::DataflashShape;
    #[pymodule_export]
    use crate::dialect::definition_file::{
        DefinitionFile, builtin_definitions, crc_extra, definition_sources, definition_union,
        field_type, number_behind,
    };
    #[pymodule_export]
    use crate::dialect::describe::describe;
    #[pymodule_export]
    use crate::dialect::registry::Dialect;
    #[pymodule_export]
    use crate::dump::log_dump::dump_log;
    #[pymodule_export]
    use crate::link::instances::add_message;
    #[pymodule_export]
    use crate::link::live_batch::receive_batch;
    #[pymodule_export]
    use crate::link::live_link::LiveLink;
    #[pymodule_export]
    use crate::link::log_link::LogLink;
    #[pymodule_export]
    use crate::link::methods::instance_dict;
    #[pymodule_export]
    use crate::link::replaced::replace_function;
    #[pymodule_export]
    use crate::link::state::Link;
    #[pymodule_export]
    use crate::link::system::{SystemState, forget_states};
    #[pymodule_export]
    use crate::message::classes::message_class;
    #[pymodule_export]
    use crate::message::descriptors::MetaAttr;
    #[pymodule_export]
    use crate::message::dict::{message_dict, restore};
    #[pymodule_export]
    use crate::message::info::MessageInfo;
    #[pymodule_export]
    use crate::message::object::Message;
    #[pymodule_export]
    use crate::port::peers::peer_to_replace;
    #[pymodule_export]
    use crate::port::ports::DescriptorPort;
    #[pymodule_export]
    use crate::port::recording::recordable;
    #[pymodule_export]
    use crate::port::stream_writer::StreamWriter;
    #[pymodule_export]
    use crate::port::tls_port::TlsPort;
    #[pymodule_export]
    use crate::protocol::mavlink::MAVLink;
    #[pymodule_export]
    use crate::protocol::sequence_gaps::SequenceGaps;
    #[pymodule_export]
    use crate::protocol::signing::Signing;
    #[pymodule_export]
    use crate::protocol::status_texts::StatusTexts;
    #[pymodule_export]
    use crate::protocol::x25::x25_accumulate;
    #[cfg(unix)]
    #[pymodule_export]
    use crate::python::error::BridgeError;
    #[pymodule_export]
    use crate::python::error::DefinitionError;
    #[pymodule_export]
    use crate::sync::exclusive::Exclusive;
    #[pymodule_export]
    use crate::tables::align::align_tables;
    #[pymodule_export]
    use crate::tables::column_view::ColumnView;
    #[pymodule_export]
    use crate::tables::columns::{LogColumns, empty_table, log_summary};
    #[pymodule_export]
    use crate::tables::convert::{Converter, csv_safe, folder_of, is_device, write_table};
    #[pymodule_export]
    use crate::tables::dataflash::DataflashTables;
    #[pymodule_export]
    use crate::tables::dates::{date_text, jump_text};
    #[pymodule_export]
    use crate::tables::decompress::{decompress, draft_stem};
    #[pymodule_export]
    use crate::tables::identify::{LogKind, identify};
    #[pymodule_export]
    use crate::tables::lake_file::LakeFile;
    #[pymodule_export]
    use crate::tables::open_log::LogScan;
    #[pymodule_export]
    use crate::tables::rewrite::LogRewrite;
    #[pymodule_export]
    use crate::tables::table::RecordBatches;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        require_interpreter_lock(module.py())?;
        crate::sync::thread_number::follow_forks(module)?;
        crate::link::replaced::prepare(module.py())?;
        crate::message::create::check_layout(module.py())?;
        crate::message::descriptors::add_meta_attributes(module.py())?;
        let types = FieldType::ALL.iter().map(|one| (one.name(), one.is_float()));
        module.add("FIELD_TYPES", types.into_py_dict(module.py())?)?;
        module.add("FieldGetter", crate::message::descriptors::field_getter_type(module.py())?)?;
        let doc = c"build(message, /, *values)\n--\n\n\
            Stores the values of a new message's fields, in XML order.";
        crate::python::raw_function::add(module, c"build", doc, crate::protocol::pack::build)?;
        let doc = c"send_values(mav, info, force_mavlink1, /, *values)\n--\n\n\
            Sends a message made of the values, without making an object of it where nobody sees one.";
        crate::python::raw_function::add(
            module,
            c"send_values",
            doc,
            crate::protocol::send::send_values,
        )
    }

    /// `ImportError` where `PYTHON_GIL=0` keeps the lock off, which guards all state of this module.
    fn require_interpreter_lock(py: Python<'_>) -> PyResult<()> {
        let ask = py.import(intern!(py, "sys"))?.getattr_opt(intern!(py, "_is_gil_enabled"))?;
        if ask.map_or(Ok(true), |ask| ask.invoke1(())?.is_truthy())? {
            return Ok(());
        }
        Err(PyImportError::new_err(
            "mavwire needs the global interpreter lock: start Python without PYTHON_GIL=0 and -X gil=0",
        ))
    }

    /// The package's version.
    #[pymodule_export]
    #[allow(non_upper_case_globals)]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
