//! A log as one MCAP file, for Foxglove, `PlotJuggler` and other tools of robotics.
//!
//! A channel for each message type and sender, `/SYSID/COMPID/TYPE`, or `/TYPE` of a dataflash log, whose messages are the
//! fields as Protocol Buffers ([`protobuf`]) or JSON objects. Positions and texts have a channel more, in the form that
//! Foxglove shows on a map and as a log ([`foxglove`]). The names and schemas of the channels are in
//! [`channels`].
//!
//! Messages are sorted by time within each block of the log, so that a reader need not have many chunks open at a time.
//! They are encoded on all processors while those before are compressed, some thousand at a time: memory depends neither
//! on the log nor on how large its messages become.

mod channels;
mod foxglove;
mod protobuf;

use std::io::Write;
use std::sync::Arc;

use arrow::array::{Array, StructArray, TimestampMicrosecondArray, UInt8Array};
use arrow::datatypes::{DataType, Field};
use arrow::json::{EncoderOptions, writer::make_encoder};
use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use mcap::{WriteOptions, Writer};
use rayon::prelude::*;

use crate::convert::Compression;
use crate::error::Error;
use crate::pool;
use crate::reader::Batch;

use channels::Channels;
pub use channels::Descriptions;
use foxglove::Extra;

/// Messages whose JSON is in memory at a time, twice.
const WINDOW: usize = 8192;
/// Bytes of a chunk before it is compressed: what a reader holds at least.
const CHUNK: u64 = 4 << 20;

/// Whether chunks can be compressed like this.
pub fn takes(compression: Compression) -> bool {
    matches!(compression, Compression::None | Compression::Zstd | Compression::Lz4)
}

/// How messages are encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Protocol Buffers.
    Protobuf,
    /// JSON objects.
    Json,
}

/// The settings of a file.
#[derive(Clone)]
pub struct Settings {
    /// How messages are encoded.
    pub encoding: Encoding,
    /// How chunks are compressed.
    pub compression: Compression,
    /// Texts for the schemas of messages.
    pub descriptions: Descriptions,
}

/// An MCAP file being written.
pub struct McapSink<W: Write> {
    writer: Writer<NoSeek<W>>,
    channels: Channels,
    rows: u64,
}

/// A batch, and where its rows go.
struct Source {
    times: TimestampMicrosecondArray,
    seq: Option<UInt8Array>,
    /// The fields of the message.
    body: StructArray,
    /// The channel of each row.
    channels: Vec<u16>,
    extra: Option<(Extra, Vec<u16>)>,
}

/// A row of a batch; sorted by time, rows of one time by type, as they come in the log.
struct Row {
    time: i64,
    source: u32,
    at: u32,
}

/// Appends a row of a source.
type Put<'a> = Box<dyn FnMut(usize, &mut Vec<u8>) + 'a>;

/// Rows encoded, in order, one behind the other.
#[derive(Default)]
struct Encoded {
    bytes: Vec<u8>,
    ends: Vec<usize>,
}

impl<W: Write> McapSink<W> {
    /// Begins a file.
    ///
    /// # Errors
    /// Errors of writing.
    pub fn new(out: W, settings: Settings) -> Result<Self, Error> {
        let Settings { encoding, compression, descriptions } = settings;
        let compression = match compression {
            Compression::Zstd => Some(mcap::Compression::Zstd),
            Compression::Lz4 => Some(mcap::Compression::Lz4),
            _ => None,
        };
        let options = WriteOptions::new()
            .compression(compression)
            .compression_level(1)
            .compression_threads(0)
            .chunk_size(Some(CHUNK))
            .library(concat!("mavwire ", env!("CARGO_PKG_VERSION")))
            .disable_seeking(true);
        let writer = options.create(NoSeek::new(out))?;
        Ok(Self { writer, channels: Channels::new(encoding, descriptions), rows: 0 })
    }

    /// Rows so far, those of additional channels not counted.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Writes batches of one stretch of the log, sorted by time.
    ///
    /// # Errors
    /// Errors of writing; [`Error::NoTimes`] and [`Error::TooManyChannels`].
    pub fn write(&mut self, batches: &[Batch]) -> Result<(), Error>
    where
        W: Send,
    {
        let sources =
            batches.iter().map(|batch| self.source(batch)).collect::<Result<Vec<_>, _>>()?;
        let mut order: Vec<Row> = (0..).zip(&sources).flat_map(|(n, one)| one.rows(n)).collect();
        order.sort_by_key(|row| row.time);
        let mut windows = order.chunks(WINDOW);
        let encoding = self.channels.encoding;
        let mut ahead =
            windows.next().map(|window| (window, pool::run(|| encode(&sources, window, encoding))));
        while let Some((window, texts)) = ahead {
            let next = windows.next();
            let texts = texts?;
            let (written, texts) = pool::run(|| {
                rayon::join(
                    || self.write_window(&sources, window, &texts),
                    || next.map(|next| (next, encode(&sources, next, encoding))),
                )
            });
            written?;
            ahead = texts;
        }
        self.rows += order.len() as u64;
        Ok(())
    }

    fn source(&mut self, batch: &Batch) -> Result<Source, Error> {
        let rows = &batch.rows;
        let column = |name: &str| rows.column_by_name(name).map(Array::as_any);
        let times = column("timestamp").and_then(|array| array.downcast_ref());
        let times: &TimestampMicrosecondArray = times.ok_or(Error::NoTimes)?;
        if times.null_count() > 0 {
            return Err(Error::NoTimes);
        }
        let extra = Extra::of(batch)
            .map(|extra| {
                let channels = self.channels.of_extra(&mut self.writer, batch, &extra)?;
                Ok::<_, Error>((extra, channels))
            })
            .transpose()?;
        Ok(Source {
            times: times.clone(),
            seq: column("seq").and_then(|array| array.downcast_ref()).cloned(),
            body: body(batch),
            channels: self.channels.of_rows(&mut self.writer, batch)?,
            extra,
        })
    }

    fn write_window(
        &mut self,
        sources: &[Source],
        window: &[Row],
        encoded: &[(Encoded, Encoded)],
    ) -> Result<(), Error> {
        let mut next = vec![0; sources.len()];
        for row in window {
            let (number, source) = (row.source as usize, &sources[row.source as usize]);
            let (message, extra) = (encoded[number].0.at(next[number]), &encoded[number].1);
            let mut header = source.header(row);
            self.writer.write_to_known_channel(&header, message)?;
            if let Some((_, channels)) = &source.extra {
                let text = extra.at(next[number]);
                if !text.is_empty() {
                    header.channel_id = channels[row.at as usize];
                    self.writer.write_to_known_channel(&header, text)?;
                }
            }
            next[number] += 1;
        }
        Ok(())
    }

    /// Writes what belongs at the end, and gives the output back.
    ///
    /// # Errors
    /// Errors of writing.
    pub fn finish(mut self) -> Result<W, Error> {
        self.writer.finish()?;
        Ok(self.writer.into_inner().into_inner())
    }
}

/// The columns of a batch that are fields of the message.
fn body(batch: &Batch) -> StructArray {
    let schema = batch.rows.schema();
    let (fields, arrays): (Vec<_>, Vec<_>) = schema
        .fields()
        .iter()
        .zip(batch.rows.columns())
        .filter(|(field, _)| channels::is_body(field.name()))
        .map(|(field, array)| (Arc::clone(field), Arc::clone(array)))
        .unzip();
    if fields.is_empty() {
        return StructArray::new_empty_fields(batch.rows.num_rows(), None);
    }
    StructArray::new(fields.into(), arrays, None)
}

impl Encoding {
    fn of_messages(self) -> &'static str {
        match self {
            Self::Protobuf => "protobuf",
            Self::Json => "json",
        }
    }

    fn of_schemas(self) -> &'static str {
        match self {
            Self::Protobuf => "protobuf",
            Self::Json => "jsonschema",
        }
    }
}

impl Source {
    fn rows(&self, source: u32) -> impl Iterator<Item = Row> {
        let times = self.times.values().iter();
        (0..).zip(times).map(move |(at, &time)| Row { time, source, at })
    }

    fn header(&self, row: &Row) -> MessageHeader {
        let at = row.at as usize;
        let nanoseconds = u64::try_from(row.time).unwrap_or(0).saturating_mul(1000);
        MessageHeader {
            channel_id: self.channels[at],
            sequence: self.seq.as_ref().map_or(0, |seq| seq.value(at).into()),
            log_time: nanoseconds,
            publish_time: nanoseconds,
        }
    }

    fn encode(&self, rows: &[u32], encoding: Encoding) -> Result<(Encoded, Encoded), Error> {
        let (mut messages, mut extras) = (Encoded::default(), Encoded::default());
        let options = EncoderOptions::default();
        let field = Arc::new(Field::new("", DataType::clone(self.body.data_type()), false));
        let mut put: Put<'_> = match encoding {
            Encoding::Protobuf => protobuf::encoder(&self.body)?,
            Encoding::Json => {
                let mut encoder = make_encoder(&field, &self.body, &options)?;
                Box::new(move |row, out| encoder.encode(row, out))
            }
        };
        for &row in rows {
            put(row as usize, &mut messages.bytes);
            messages.ends.push(messages.bytes.len());
            if let Some((extra, _)) = &self.extra {
                let time = self.times.value(row as usize);
                extra.encode(row as usize, time, &mut extras.bytes);
                extras.ends.push(extras.bytes.len());
            }
        }
        Ok((messages, extras))
    }
}

impl Encoded {
    fn at(&self, index: usize) -> &[u8] {
        let start = index.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.bytes[start..self.ends[index]]
    }
}

/// The messages of some rows, by source.
fn encode(
    sources: &[Source],
    window: &[Row],
    encoding: Encoding,
) -> Result<Vec<(Encoded, Encoded)>, Error> {
    let mut rows = vec![Vec::new(); sources.len()];
    for row in window {
        rows[row.source as usize].push(row.at);
    }
    sources.par_iter().zip(&rows).map(|(source, rows)| source.encode(rows, encoding)).collect()
}
