//! The files that a log is converted to: one for each table, or one for all.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fmt::Write;
use std::path::PathBuf;

use mavwire_columns::Error;
use mavwire_columns::arrow::array::RecordBatch;
use mavwire_columns::convert::{Compression, Format, Sink, write_all};
use mavwire_columns::mcap::{Descriptions, McapSink};
use mavwire_columns::reader::Batch;
use mavwire_columns::scan::UNKNOWN;
use mavwire_columns::unknown_table;
use mavwire_io::files::{Draft, commit_all};
use pyo3::prelude::*;

/// Largest number of types of a log that become files without `--types`. A log with more types is likely made to do harm.
const MAX_UNNAMED_TYPES: usize = 1000;

/// The files of a log, which appear when all of them are complete, and are gone if that never happens.
pub(crate) enum Output {
    /// A file for each table.
    Tables(Tables),
    /// A file for all, begun by the first message.
    Mcap {
        path: PathBuf,
        compression: Compression,
        descriptions: Descriptions,
        sink: Option<Box<McapSink<Draft>>>,
    },
}

/// `folder/MESSAGE/file` for each message.
pub(crate) struct Tables {
    folder: PathBuf,
    file: String,
    format: Format,
    compression: Compression,
    /// Largest number of files.
    limit: usize,
    /// By message index.
    sinks: BTreeMap<u16, (PathBuf, Sink<Draft>)>,
}

impl Output {
    pub(crate) fn tables(
        folder: PathBuf,
        file: String,
        format: Format,
        compression: Compression,
        types_are_named: bool,
    ) -> Self {
        let limit = if types_are_named { usize::MAX } else { MAX_UNNAMED_TYPES };
        Self::Tables(Tables { folder, file, format, compression, limit, sinks: BTreeMap::new() })
    }

    pub(crate) fn mcap(
        path: PathBuf,
        compression: Compression,
        descriptions: Descriptions,
    ) -> Self {
        Self::Mcap { path, compression, descriptions, sink: None }
    }

    /// Writes the batches of a stretch of the log.
    pub(crate) fn write(&mut self, batches: &[Batch]) -> Result<(), Error> {
        match self {
            Self::Tables(tables) => tables.write(batches),
            Self::Mcap { .. } if batches.is_empty() => Ok(()),
            Self::Mcap { path, compression, descriptions, sink } => {
                let sink = match sink {
                    Some(open) => open,
                    None => {
                        let draft = Draft::create(path)?;
                        let new = McapSink::new(draft, *compression)?;
                        sink.insert(Box::new(new.described(std::mem::take(descriptions))))
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
        let files = self.sinks.len();
        if let Entry::Vacant(missing) = self.sinks.entry(batch.index) {
            if files == self.limit {
                return Err(Error::TooManyFiles(self.limit));
            }
            let folder = match batch.index {
                UNKNOWN => unknown_table::NAME.to_owned(),
                _ => folder_of(&batch.message),
            };
            let path = self.folder.join(folder).join(&self.file);
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

/// Whether Windows treats the name of a file or folder as a device, such as `nul` or `COM1.txt`.
#[pyfunction]
pub(crate) fn is_device(name: &str) -> bool {
    let stem = name.split('.').next().unwrap_or_default();
    let name = stem.trim_end_matches(' ').to_ascii_uppercase();
    let numbered = |kind| {
        name.strip_prefix(kind).is_some_and(|number| matches!(number.as_bytes(), [b'0'..=b'9']))
    };
    matches!(&*name, "CON" | "PRN" | "AUX" | "NUL") || numbered("COM") || numbered("LPT")
}

/// The folder of a type. A log names its types, and must not choose where files go.
fn folder_of(name: &str) -> String {
    let mut folder = String::with_capacity(name.len());
    let device = is_device(name);
    for (place, byte) in name.bytes().enumerate() {
        let is_plain = byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-');
        if is_plain && !(device && place == 0) {
            folder.push(char::from(byte));
        } else {
            let _ = write!(folder, "%{byte:02X}");
        }
    }
    folder
}

#[cfg(test)]
mod tests {
    use super::folder_of;

    #[test]
    fn no_type_chooses_its_folder() {
        for (name, folder) in [
            ("ATT", "ATT"),
            ("..", "%2E%2E"),
            ("a/b", "a%2Fb"),
            ("NUL", "%4EUL"),
            ("con", "%63on"),
            ("Aux", "%41ux"),
            ("COM1", "%43OM1"),
            ("LPT9", "%4CPT9"),
            ("COMX", "COMX"),
            ("NUL.x", "%4EUL%2Ex"),
            ("COM", "COM"),
        ] {
            assert_eq!(folder_of(name), folder);
        }
    }
}
