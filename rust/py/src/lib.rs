//! `mavwire._native`: the core as Python classes.
//!
//! The only crate that knows PyO3. It translates: bytes and errors in, objects and exceptions out; what MAVLink is stands
//! in `mavwire-core` and `mavwire-schema`. Public Python classes derive from the ones here, see
//! `python/mavwire/dialects/_classes.py`.

use pyo3::prelude::*;

// First, for its macro.
#[macro_use]
mod intern;

mod accept;
mod align;
#[cfg(unix)]
mod bridge;
#[cfg(unix)]
mod bridge_batch;
#[cfg(unix)]
mod bridge_options;
#[cfg(unix)]
mod bridge_stats;
mod calling;
mod classes;
mod column_view;
mod columns;
mod components;
mod convert;
mod convert_output;
mod create;
mod dataflash;
mod dataflash_tables;
mod dates;
mod decompress;
mod describe;
mod descriptors;
mod dialect;
mod dict;
mod dump;
mod dump_line;
mod encode;
mod extra;
mod file_error;
mod filter;
mod frame_bytes;
mod hang_up;
mod index_build;
mod info;
mod instances;
mod link;
mod link_turn;
mod lists;
mod live;
mod live_batch;
mod live_failure;
mod live_source;
mod lock;
mod log;
mod log_ahead;
mod log_index;
mod log_reader;
mod log_receive;
mod log_visits;
mod log_wanted;
mod mavlink;
mod message;
mod meta;
mod number;
mod odd;
mod open_log;
mod owner;
mod pack;
mod params;
mod parse;
mod parser;
mod peers;
mod ports;
mod raw;
mod receive;
mod recording;
mod replaced;
mod rewrite;
mod room;
mod section;
mod send;
mod sending;
mod sequence_gaps;
mod shared;
mod signing;
mod slot;
mod source;
mod status_texts;
mod stream_queue;
mod stream_writer;
mod system;
mod table;
mod text;
mod thread_lock;
mod thread_number;
mod tls_port;
mod track;
mod tracking;
mod trust;
mod turn;
mod values;
mod x25;

#[pymodule(gil_used = true)]
mod _native {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::accept::accept;
    #[pymodule_export]
    use crate::align::align_tables;
    #[cfg(unix)]
    #[pymodule_export]
    use crate::bridge::{BridgeCore, BridgeError, BridgeTap};
    #[cfg(unix)]
    #[pymodule_export]
    use crate::bridge_batch::FrameBatch;
    #[pymodule_export]
    use crate::classes::message_class;
    #[pymodule_export]
    use crate::column_view::ColumnView;
    #[pymodule_export]
    use crate::columns::{LogColumns, empty_table, log_summary};
    #[pymodule_export]
    use crate::convert::{Converter, csv_safe, write_table};
    #[pymodule_export]
    use crate::convert_output::is_device;
    #[pymodule_export]
    use crate::dataflash::clock::MicrosClock;
    #[pymodule_export]
    use crate::dataflash::message::DFMessage;
    #[pymodule_export]
    use crate::dataflash::reader::DataflashReader;
    #[pymodule_export]
    use crate::dataflash::shape::DataflashShape;
    #[pymodule_export]
    use crate::dataflash_tables::DataflashTables;
    #[pymodule_export]
    use crate::dates::{date_text, jump_text};
    #[pymodule_export]
    use crate::decompress::{
        begins_as_text_log, decompress, draft_stem, head_to_utf8, log_head, telemetry_kind,
    };
    #[pymodule_export]
    use crate::describe::describe;
    #[pymodule_export]
    use crate::descriptors::MetaAttr;
    #[pymodule_export]
    use crate::dialect::{DefinitionError, Dialect, reserved_name};
    #[pymodule_export]
    use crate::dict::{message_dict, restore};
    #[pymodule_export]
    use crate::dump::dump_log;
    #[pymodule_export]
    use crate::hang_up::hang_up;
    #[pymodule_export]
    use crate::info::MessageInfo;
    #[pymodule_export]
    use crate::instances::add_message_alone;
    #[pymodule_export]
    use crate::link::{Link, instance_dict};
    #[pymodule_export]
    use crate::link_turn::Turn;
    #[pymodule_export]
    use crate::live::LiveLink;
    #[pymodule_export]
    use crate::live_batch::receive_batch;
    #[pymodule_export]
    use crate::log::LogLink;
    #[pymodule_export]
    use crate::mavlink::MAVLink;
    #[pymodule_export]
    use crate::message::Message;
    #[pymodule_export]
    use crate::odd::OddField;
    #[pymodule_export]
    use crate::open_log::LogScan;
    #[pymodule_export]
    use crate::peers::peer_to_replace;
    #[pymodule_export]
    use crate::ports::{DescriptorPort, PortError, ask_port};
    #[pymodule_export]
    use crate::recording::recordable;
    #[pymodule_export]
    use crate::replaced::replace_function;
    #[pymodule_export]
    use crate::rewrite::LogRewrite;
    #[pymodule_export]
    use crate::section::Section;
    #[pymodule_export]
    use crate::sequence_gaps::SequenceGaps;
    #[pymodule_export]
    use crate::signing::Signing;
    #[pymodule_export]
    use crate::status_texts::StatusTexts;
    #[pymodule_export]
    use crate::stream_writer::StreamWriter;
    #[pymodule_export]
    use crate::system::{SystemState, forget_states};
    #[pymodule_export]
    use crate::table::RecordBatches;
    #[pymodule_export]
    use crate::tls_port::TlsPort;
    #[pymodule_export]
    use crate::track::Track;
    #[pymodule_export]
    use crate::x25::x25_accumulate;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::thread_number::follow_forks(module)?;
        crate::thread_lock::prepare(module.py())?;
        crate::replaced::prepare(module.py())?;
        module.add("FieldGetter", crate::descriptors::field_getter_type(module.py())?)?;
        let doc = c"build(message, /, *values)\n--\n\n\
            Stores the values of a new message's fields, in XML order.";
        crate::raw::add(module, c"build", doc, crate::pack::build)?;
        let doc = c"send_values(mav, info, force_mavlink1, /, *values)\n--\n\n\
            Sends a message made of the values, without making an object of it where nobody sees one.";
        crate::raw::add(module, c"send_values", doc, crate::send::send_values)
    }

    /// The package's version.
    #[pymodule_export]
    #[allow(non_upper_case_globals)]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
