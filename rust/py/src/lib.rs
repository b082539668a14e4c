//! `mavwire._native`: the core as Python classes.
//!
//! The only crate that knows PyO3. It translates bytes and errors on the way in, objects and exceptions on the way out.
//! The rules of MAVLink are in `mavwire-core` and `mavwire-schema`. Public Python classes derive from the ones here,
//! see `python/mavwire/dialects/_classes.py`.

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
    use crate::{
        bridge::{
            batch::FrameBatch,
            core::{BridgeCore, BridgeTap},
        },
        python::error::BridgeError,
    };
    #[pymodule_export]
    use crate::{
        dataflash::{
            clock::{MicrosClock, gps_time},
            message::DFMessage,
            reader::DataflashReader,
            shape::DataflashShape,
        },
        dialect::{
            definition_file::{
                DefinitionFile, builtin_definitions, crc_extra, definition_sources,
                definition_union, field_type, number_behind,
            },
            describe::describe,
            registry::Dialect,
        },
        dump::log_dump::dump_log,
        link::{
            instances::add_message,
            live_batch::receive_batch,
            live_link::LiveLink,
            log_link::LogLink,
            replaced::replace_function,
            state::Link,
            system::{SystemState, forget_states},
        },
        message::{
            classes::message_class,
            descriptors::MetaAttr,
            dict::{message_dict, restore},
            info::MessageInfo,
            object::Message,
        },
        port::{
            peers::peer_to_replace, ports::DescriptorPort, recording::recordable,
            stream_writer::StreamWriter, tls_port::TlsPort,
        },
        protocol::{
            mavlink::MAVLink, sequence_gaps::SequenceGaps, signing::Signing,
            status_texts::StatusTexts, x25::x25_accumulate,
        },
        python::{error::DefinitionError, instance_dict::instance_dict},
        sync::exclusive::Exclusive,
        tables::{
            align::align_tables,
            column_view::ColumnView,
            columns::{LogColumns, empty_table, log_summary},
            convert::{Converter, csv_safe, folder_of, is_device, write_table},
            dataflash::DataflashTables,
            dates::{date_text, jump_text},
            decompress::{decompress, draft_stem},
            identify::{LogKind, identify},
            lake_file::LakeFile,
            open_log::LogScan,
            rewrite::LogRewrite,
            table::RecordBatches,
        },
    };

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        require_interpreter_lock(module.py())?;
        crate::sync::thread_number::follow_forks(module)?;
        crate::link::replaced::prepare(module.py())?;
        crate::message::create::check_layout(module.py())?;
        crate::message::descriptors::add_meta_attributes(module.py())?;
        crate::protocol::mavlink::add_callback_attributes(module.py())?;
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
