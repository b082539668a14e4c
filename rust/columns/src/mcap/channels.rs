//! Channels and their schemas: what a file says of its messages.

use std::collections::{BTreeMap, HashMap};
use std::io::{Seek, Write};

use arrow::array::{Array, UInt8Array};
use arrow::datatypes::{DataType, Field, Schema};
use mcap::Writer;
use serde_json::{Map, Value, json};

use super::foxglove::Extra;
use super::{Encoding, protobuf};
use crate::error::Error;
use crate::layout::HEADER;
use crate::reader::Batch;

/// Ids of channels are 16 bits wide.
const MOST_CHANNELS: usize = 65_535;

/// System and component; `None` in a dataflash log, which is of one vehicle.
type Sender = Option<(u8, u8)>;

/// The description of a message, and those of its fields.
pub(super) type Texts = (String, HashMap<String, String>);

/// The descriptions of messages by name.
pub type Descriptions = HashMap<String, Texts>;

/// The channels of a file.
pub(super) struct Channels {
    pub(super) encoding: Encoding,
    /// Descriptions for the schemas.
    descriptions: Descriptions,
    /// By table, whether it is the additional channel, and sender.
    known: HashMap<(u16, bool, Sender), u16>,
}

impl Channels {
    pub(super) fn new(encoding: Encoding, descriptions: Descriptions) -> Self {
        Self { encoding, descriptions, known: HashMap::new() }
    }

    /// The channel of each row of a batch.
    pub(super) fn of_rows<W: Write + Seek>(
        &mut self,
        writer: &mut Writer<W>,
        batch: &Batch,
    ) -> Result<Vec<u16>, Error> {
        each_row(batch, |sender| {
            self.get((batch.index, false, sender), |encoding, descriptions| {
                let texts = descriptions.get(&*batch.message);
                let (name, schema) = match encoding {
                    Encoding::Protobuf => {
                        let name = protobuf::identifier(&batch.message);
                        let schema = protobuf::descriptor(&name, &batch.rows.schema(), texts);
                        (name, schema)
                    }
                    Encoding::Json => {
                        let text = schema(&batch.message, &batch.rows.schema(), texts).to_string();
                        (batch.message.to_string(), text.into_bytes())
                    }
                };
                let id = writer.add_schema(&name, encoding.of_schemas(), &schema)?;
                add(writer, id, &topic(&batch.message, sender), encoding, batch, sender)
            })
        })
    }

    /// The additional channel of each row.
    pub(super) fn of_extra<W: Write + Seek>(
        &mut self,
        writer: &mut Writer<W>,
        batch: &Batch,
        extra: &Extra,
    ) -> Result<Vec<u16>, Error> {
        each_row(batch, |sender| {
            self.get((batch.index, true, sender), |_, _| {
                let (json, text) = (Encoding::Json, extra.schema().to_string());
                let id = writer.add_schema(extra.name(), json.of_schemas(), text.as_bytes())?;
                let topic = format!("{}/{}", topic(&batch.message, sender), extra.topic());
                add(writer, id, &topic, json, batch, sender)
            })
        })
    }

    fn get(
        &mut self,
        key: (u16, bool, Sender),
        add: impl FnOnce(Encoding, &Descriptions) -> Result<u16, Error>,
    ) -> Result<u16, Error> {
        if let Some(&id) = self.known.get(&key) {
            return Ok(id);
        }
        if self.known.len() == MOST_CHANNELS {
            return Err(Error::TooManyChannels(MOST_CHANNELS));
        }
        let id = add(self.encoding, &self.descriptions)?;
        self.known.insert(key, id);
        Ok(id)
    }
}

/// The id of each row's sender. `id_of` is called only where the sender differs from that of the row before.
fn each_row(
    batch: &Batch,
    mut id_of: impl FnMut(Sender) -> Result<u16, Error>,
) -> Result<Vec<u16>, Error> {
    let ids = |name| batch.rows.column_by_name(name)?.as_any().downcast_ref::<UInt8Array>();
    let (Some(systems), Some(components)) = (ids("sysid"), ids("compid")) else {
        return Ok(vec![id_of(None)?; batch.rows.num_rows()]);
    };
    let (mut newest, mut channels) = (None, Vec::with_capacity(systems.len()));
    for sender in systems.values().iter().copied().zip(components.values().iter().copied()) {
        let id = match newest {
            Some((known, id)) if known == sender => id,
            _ => id_of(Some(sender))?,
        };
        newest = Some((sender, id));
        channels.push(id);
    }
    Ok(channels)
}

fn add<W: Write + Seek>(
    writer: &mut Writer<W>,
    schema: u16,
    topic: &str,
    encoding: Encoding,
    batch: &Batch,
    sender: Sender,
) -> Result<u16, Error> {
    let mut metadata = BTreeMap::from([("message".to_owned(), batch.message.to_string())]);
    if let Some((sysid, compid)) = sender {
        metadata.insert("sysid".to_owned(), sysid.to_string());
        metadata.insert("compid".to_owned(), compid.to_string());
    }
    Ok(writer.add_channel(schema, topic, encoding.of_messages(), &metadata)?)
}

fn topic(message: &str, sender: Sender) -> String {
    match sender {
        Some((sysid, compid)) => format!("/{sysid}/{compid}/{message}"),
        None => format!("/{message}"),
    }
}

/// The JSON Schema of a message: the types of its fields, and as descriptions their texts, units and enums.
fn schema(message: &str, schema: &Schema, texts: Option<&Texts>) -> Value {
    let fields = schema.fields().iter().filter(|field| is_body(field.name()));
    let properties: Map<_, _> =
        fields.map(|field| (field.name().clone(), property(field, texts))).collect();
    let mut schema = json!({"title": message, "type": "object", "properties": properties});
    if let Some((text, _)) = texts.filter(|(text, _)| !text.is_empty()) {
        schema["description"] = text.as_str().into();
    }
    schema
}

/// Whether a column is a field of the message.
pub(super) fn is_body(column: &str) -> bool {
    !HEADER.contains(&column)
}

fn property(field: &Field, texts: Option<&Texts>) -> Value {
    let mut property = match field.data_type() {
        DataType::FixedSizeList(item, _) => {
            json!({"type": "array", "items": {"type": type_of(item.data_type())}})
        }
        scalar => json!({"type": type_of(scalar)}),
    };
    let mut said = said_of(field, texts);
    if field.data_type() == &DataType::Binary {
        said.push_str(if said.is_empty() { "hexadecimal" } else { ", hexadecimal" });
    }
    if !said.is_empty() {
        property["description"] = said.into();
    }
    property
}

/// A schema's text about a field: its description, unit and enum.
pub(super) fn said_of(field: &Field, texts: Option<&Texts>) -> String {
    let text = texts.and_then(|(_, fields)| fields.get(field.name())).cloned().unwrap_or_default();
    match (text.is_empty(), facts(field)) {
        (true, facts) => facts,
        (false, facts) if facts.is_empty() => text,
        (false, facts) => format!("{text} ({facts})"),
    }
}

fn type_of(data_type: &DataType) -> &'static str {
    match data_type {
        float if float.is_floating() => "number",
        integer if integer.is_integer() => "integer",
        _ => "string",
    }
}

fn facts(field: &Field) -> String {
    let metadata = field.metadata();
    let mut said = Vec::new();
    if let Some(unit) = metadata.get("unit") {
        said.push(unit.clone());
    }
    if let Some(multiplier) = metadata.get("multiplier") {
        said.push(format!("times {multiplier}"));
    }
    if let Some(name) = metadata.get("enum") {
        let kind = if metadata.contains_key("bitmask") { "bits of" } else { "one of" };
        said.push(format!("{kind} {name}"));
    }
    said.join(", ")
}
