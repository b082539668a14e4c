//! One line of a dump: mavlogdump's text, JSON and CSV forms of a message, of an unknown one and of BAD_DATA.

use std::borrow::Cow;
use std::fmt::Write;

use crate::frame::Header;
use crate::log::tlog::recordable;
use crate::pyfloat::write_repr;
use crate::signing::SETUP_SIGNING;
use crate::text;
use mavwire_schema::{Field, Message as Definition};

/// The subject of one line of a dump.
pub enum Item<'a> {
    /// A message of the dialect.
    Known {
        /// Index of its definition in the registry.
        index: u16,
        /// Its definition.
        message: &'a Definition,
        /// The labels of its fields.
        labels: &'a Labels,
        /// Its payload as it was on the wire.
        payload: &'a [u8],
        /// Its header.
        header: Header,
        /// The text joined from several messages, shown instead of this one's.
        text: Option<&'a [u8]>,
    },
    /// A frame whose id the dialect lacks.
    Unknown {
        /// Its id.
        msgid: u32,
        /// The whole frame.
        frame: &'a [u8],
    },
    /// Bytes that are no frame, or a rejected one.
    Bad {
        /// The bytes.
        frame: &'a [u8],
        /// Why they are rejected.
        reason: String,
    },
}

impl Item<'_> {
    /// The type name that filters see.
    pub fn name(&self) -> String {
        match self {
            Self::Known { message, .. } => message.name.clone(),
            Self::Unknown { msgid, .. } => format!("UNKNOWN_{msgid}"),
            Self::Bad { .. } => "BAD_DATA".to_owned(),
        }
    }

    /// System id, component id and sequence number; what is no message has none and shows zeros.
    pub fn source(&self) -> (u8, u8, u8) {
        match self {
            Self::Known { header, .. } => (header.sysid, header.compid, header.seq),
            _ => (0, 0, 0),
        }
    }
}

/// The format of the line that is written for each message.
pub enum Style {
    /// Nothing.
    Silent,
    /// mavlogdump's lines of text.
    Standard {
        /// Whether the sender is shown.
        show_source: bool,
        /// Whether the sequence number is shown.
        show_seq: bool,
    },
    /// A JSON object a line.
    Json {
        /// Whether the sender is shown.
        show_source: bool,
    },
    /// Rows with the columns of some types.
    Csv {
        /// Between two cells.
        separator: String,
        /// The types in their order.
        columns: Vec<Column>,
    },
}

impl Style {
    /// Whether lines begin with the local time.
    pub fn shows_clock(&self) -> bool {
        matches!(self, Self::Standard { .. })
    }
}

/// The text in front of each value of a message type. It is joined once per type: one write is cheaper than three.
pub struct Labels {
    head: String,
    /// Before the value of each field, XML order.
    fields: Vec<String>,
}

impl Labels {
    /// The labels of a message type.
    pub fn new(style: &Style, message: &Definition) -> Self {
        let name = &message.name;
        let (head, quote, colon) = match style {
            Style::Silent | Style::Csv { .. } => {
                return Self { head: String::new(), fields: Vec::new() };
            }
            Style::Standard { .. } => (format!(": {name} {{"), "", " : "),
            Style::Json { .. } => {
                (format!("{{\"meta\": {{\"type\": \"{name}\", \"timestamp\": "), "\"", "\": ")
            }
        };
        let label = |(n, field): (usize, &Field)| {
            format!("{}{quote}{}{colon}", if n > 0 { ", " } else { "" }, field.name)
        };
        Self { head, fields: message.fields.iter().enumerate().map(label).collect() }
    }

    /// Appends each field's label and value.
    fn write(
        &self,
        out: &mut String,
        message: &Definition,
        payload: &[u8],
        write_value: fn(&mut String, &Field, &[u8]),
    ) {
        for (field, label) in message.fields.iter().zip(&self.fields) {
            out.push_str(label);
            write_value(out, field, payload);
        }
    }
}

/// The columns of one message type in a CSV table.
pub struct Column {
    /// Index of the type in the registry.
    pub index: u16,
    /// The cells of a row that is about another type.
    pub blanks: String,
}

/// A message with its time in seconds since 1970, and what the local clock shows then.
pub struct Line<'a> {
    /// Seconds since 1970.
    pub time: f64,
    /// The local time, to the second.
    pub clock: &'a str,
    /// The message.
    pub item: &'a Item<'a>,
}

/// Appends the line with its newline.
pub fn write_line(out: &mut String, style: &Style, line: &Line<'_>) {
    match style {
        Style::Silent => return,
        Style::Standard { show_source, show_seq } => {
            write_standard(out, line, *show_source, *show_seq);
        }
        Style::Json { show_source } => write_json(out, line, *show_source),
        Style::Csv { separator, columns } => write_csv(out, line, separator, columns),
    }
    out.push('\n');
}

fn write_standard(out: &mut String, line: &Line<'_>, show_source: bool, show_seq: bool) {
    out.push_str(line.clock);
    out.push('.');
    let hundredths = (line.time * 100.0) as u64 % 100;
    out.push(char::from(b'0' + (hundredths / 10) as u8));
    out.push(char::from(b'0' + (hundredths % 10) as u8));
    match line.item {
        Item::Known { message, labels, payload, .. } => {
            out.push_str(&labels.head);
            labels.write(out, message, payload, text::write_field_text);
            out.push('}');
        }
        Item::Unknown { msgid, frame } => {
            append(out, format_args!(": UNKNOWN_{msgid} {{data:["));
            write_hex(out, &unkeyed(frame, *msgid));
            out.push_str("]}");
        }
        Item::Bad { frame, reason } => {
            append(out, format_args!(": BAD_DATA {{{reason}, data:["));
            write_hex(out, frame);
            out.push_str("]}");
        }
    }
    let (sysid, compid, seq) = line.item.source();
    if show_source {
        append(out, format_args!(" srcSystem={sysid} srcComponent={compid}"));
    }
    if show_seq {
        append(out, format_args!(" seq={seq}"));
    }
}

fn write_json(out: &mut String, line: &Line<'_>, show_source: bool) {
    match line.item {
        Item::Known { labels, .. } => out.push_str(&labels.head),
        other => {
            let name = other.name();
            append(out, format_args!("{{\"meta\": {{\"type\": \"{name}\", \"timestamp\": "));
        }
    }
    write_repr(out, line.time);
    if show_source {
        let (sysid, compid, _) = line.item.source();
        append(out, format_args!(", \"srcSystem\": {sysid}, \"srcComponent\": {compid}"));
    }
    out.push_str("}, \"data\": {");
    match line.item {
        Item::Known { message, labels, payload, text: None, .. } => {
            labels.write(out, message, payload, text::write_field_json);
        }
        Item::Known { message, labels, payload, text: Some(joined), .. } => {
            for (field, label) in message.fields.iter().zip(&labels.fields) {
                out.push_str(label);
                if field.is_char() {
                    let mut shown = String::new();
                    text::write_bytes_text(&mut shown, joined);
                    text::write_json_string(out, &shown);
                } else {
                    text::write_field_json(out, field, payload);
                }
            }
        }
        Item::Unknown { msgid, frame } => write_json_bytes(out, &unkeyed(frame, *msgid)),
        Item::Bad { frame, reason } => {
            write_json_bytes(out, frame);
            out.push_str(", \"reason\": ");
            text::write_json_string(out, reason);
        }
    }
    out.push_str("}}");
}

/// A row: the time, then the fields of every type in the table, empty but for the line's own type.
fn write_csv(out: &mut String, line: &Line<'_>, separator: &str, columns: &[Column]) {
    append(out, format_args!("{:.8}", line.time));
    for column in columns {
        match line.item {
            Item::Known { index, message, payload, .. } if *index == column.index => {
                for field in &message.fields {
                    out.push_str(separator);
                    text::write_field_text(out, field, payload);
                }
            }
            _ => out.push_str(&column.blanks),
        }
    }
}

/// The frame, without its secret key where it is a `SETUP_SIGNING` that the dialect lacks.
fn unkeyed(frame: &[u8], msgid: u32) -> Cow<'_, [u8]> {
    if msgid == SETUP_SIGNING { recordable(frame) } else { Cow::Borrowed(frame) }
}

/// `'fe', '9', '0'`
fn write_hex(out: &mut String, bytes: &[u8]) {
    for (n, byte) in bytes.iter().enumerate() {
        let comma = if n > 0 { ", " } else { "" };
        append(out, format_args!("{comma}'{byte:x}'"));
    }
}

/// `"data": [254, 9, 0]`
fn write_json_bytes(out: &mut String, bytes: &[u8]) {
    out.push_str("\"data\": [");
    for (n, byte) in bytes.iter().enumerate() {
        let comma = if n > 0 { ", " } else { "" };
        append(out, format_args!("{comma}{byte}"));
    }
    out.push(']');
}

/// Appends formatted text; a `String` takes all of it.
fn append(out: &mut String, arguments: std::fmt::Arguments<'_>) {
    let taken = out.write_fmt(arguments);
    debug_assert!(taken.is_ok());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin;
    use crate::registry::Registry;
    use mavwire_schema::WireVersion;

    fn lines(style: &Style) -> String {
        let registry = Registry::new(
            builtin::dialect("minimal", WireVersion::V2).expect("a built-in dialect"),
        );
        let entry = registry.lookup(0).expect("HEARTBEAT");
        let message = registry.message(entry.index);
        let payload = [1, 0, 0, 0, 2, 3, 81, 4, 3];
        let header = Header::new(WireVersion::V2, 7, 1, 2, 0);
        let labels = Labels::new(style, message);
        let item = Item::Known {
            index: entry.index,
            message,
            labels: &labels,
            payload: &payload,
            header,
            text: None,
        };
        let bad = Item::Bad { frame: &[0xAB], reason: "Bad prefix".to_owned() };
        let mut out = String::new();
        for item in [&item, &Item::Unknown { msgid: 9, frame: &[0xFD, 0] }, &bad] {
            let line = Line { time: 1.25, clock: "1970-01-01 00:00:01", item };
            write_line(&mut out, style, &line);
        }
        out
    }

    #[test]
    fn styles_show_messages_as_mavlogdump_does() {
        assert_eq!(lines(&Style::Silent), "");
        let text = lines(&Style::Standard { show_source: false, show_seq: false });
        let expected = [
            "1970-01-01 00:00:01.25: HEARTBEAT {type : 2, autopilot : 3, base_mode : 81, custom_mode : 1, \
             system_status : 4, mavlink_version : 3}",
            "1970-01-01 00:00:01.25: UNKNOWN_9 {data:['fd', '0']}",
            "1970-01-01 00:00:01.25: BAD_DATA {Bad prefix, data:['ab']}",
        ];
        assert_eq!(text.lines().collect::<Vec<_>>(), expected);
        let json = lines(&Style::Json { show_source: true });
        let expected = concat!(
            r#"{"meta": {"type": "HEARTBEAT", "timestamp": 1.25, "srcSystem": 1, "srcComponent": 2}, "#,
            r#""data": {"type": 2, "autopilot": 3, "base_mode": 81, "custom_mode": 1, "#,
            r#""system_status": 4, "mavlink_version": 3}}"#,
        );
        assert_eq!(json.lines().next(), Some(expected));
    }
}
