//! The files that a log is converted to: one for each table, or one for all.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fmt::Write;
use std::path::PathBuf;

use mavwire_columns::Error;
use mavwire_columns::arrow::array::RecordBatch;
use mavwire_columns::convert::{Compression, Format, Sink, write_all};
use mavwire_columns::mcap::McapSink;
use mavwire_columns::reader::Batch;
use mavwire_link::files::{Draft, commit_all};

/// The files of a log, which appear when all of them are complete, and are gone if that never happens.
pub(crate) enum Output {
    /// A file for each table.
    Tables(Tables),
    /// A file for all, begun by the first message.
    Mcap { path: PathBuf, compression: Compression, sink: Option<Box<McapSink<Draft>>> },
}

/// `folder/MESSAGE/file` for each message.
pub(crate) struct Tables {
    folder: PathBuf,
    file: String,
    format: Format,
    compression: Compression,
    /// By message index.
    sinks: BTreeMap<u16, (PathBuf, Sink<Draft>)>,
}

impl Output {
    pub(crate) fn tables(
        folder: PathBuf,
        file: String,
        format: Format,
        compression: Compression,
    ) -> Self {
        Self::Tables(Tables { folder, file, format, compression, sinks: BTreeMap::new() })
    }

    pub(crate) fn mcap(path: PathBuf, compression: Compression) -> Self {
        Self::Mcap { path, compression, sink: None }
    }

    /// Writes the batches of a stretch of the log.
    pub(crate) fn write(&mut self, batches: &[Batch]) -> Result<(), Error> {
        match self {
            Self::Tables(tables) => tables.write(batches),
            Self::Mcap { .. } if batches.is_empty() => Ok(()),
            Self::Mcap { path, compression, sink } => {
                let sink = match sink {
                    Some(open) => open,
                    None => {
                        let draft = Draft::create(path)?;
                        sink.insert(Box::new(McapSink::new(draft, *compression)?))
                    }
                };
                sink.write(batches)
            }
        }
    }

    /// Gives all files their names: which, and the rows in them.
    pub(crate) fn commit(self) -> Result<Vec<(PathBuf, u64)>, Error> {
        match self {
            Self::Tables(tables) => tables.commit(),
            Self::Mcap { sink: None, .. } => Ok(Vec::new()),
            Self::Mcap { path, sink: Some(sink), .. } => {
                let rows = sink.rows();
                sink.finish()?.commit()?;
                Ok(vec![(path, rows)])
            }
        }
    }
}

impl Tables {
    fn write(&mut self, batches: &[Batch]) -> Result<(), Error> {
        let mut by_type: BTreeMap<u16, Vec<&RecordBatch>> = BTreeMap::new();
        for batch in batches {
            self.begin(batch)?;
            by_type.entry(batch.index).or_default().push(&batch.rows);
        }
        let sinks = self.sinks.iter_mut();
        let due = sinks.filter_map(|(index, (_, sink))| Some((sink, by_type.remove(index)?)));
        write_all(due.collect())
    }

    /// Begins the file of a batch where there is none yet.
    fn begin(&mut self, batch: &Batch) -> Result<(), Error> {
        if let Entry::Vacant(missing) = self.sinks.entry(batch.index) {
            let path = self.folder.join(folder_of(&batch.message)).join(&self.file);
            let draft = Draft::create(&path)?;
            let sink = Sink::new(draft, &batch.rows.schema(), self.format, self.compression)?;
            missing.insert((path, sink));
        }
        Ok(())
    }

    fn commit(self) -> Result<Vec<(PathBuf, u64)>, Error> {
        let (mut files, mut drafts) = (Vec::new(), Vec::new());
        for (path, sink) in self.sinks.into_values() {
            files.push((path, sink.rows()));
            drafts.push(sink.finish()?);
        }
        commit_all(drafts)?;
        Ok(files)
    }
}

/// The folder of a type: a log names its types, and whoever made the log shall not choose where files go.
fn folder_of(name: &str) -> String {
    let mut folder = String::with_capacity(name.len());
    for byte in name.bytes() {
        if byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-') {
            folder.push(char::from(byte));
        } else {
            let _ = write!(folder, "%{byte:02X}");
        }
    }
    folder
}
