//! The files that a log is converted to: one for each table, or one for all.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use arrow::array::RecordBatch;

use crate::convert::{Compression, Format, Sink, write_all};
use crate::error::Error;
use crate::mcap::{McapSink, Settings};
use crate::reader::Batch;
use crate::scan::UNKNOWN;
use crate::unknown_table;

/// Largest number of types of a log that become files without `--types`. A log with more types is likely made to do harm.
const MAX_UNNAMED_TYPES: usize = 1000;

/// Begins the file at a path.
pub type Create<W> = fn(&Path) -> io::Result<W>;

/// Paths, and the rows in each file.
pub type Files = Vec<(PathBuf, u64)>;

/// The files of a log.
pub enum Output<W: Write + Send> {
    /// A file for each table.
    Tables(Tables<W>),
    /// A file for all, begun by the first message.
    Mcap {
        /// The file.
        path: PathBuf,
        /// Begins it.
        create: Create<W>,
        /// Its encoding, compression and descriptions.
        settings: Settings,
        /// The file, once it is begun.
        sink: Option<Box<McapSink<W>>>,
    },
}

/// `folder/MESSAGE/file` for each message.
pub struct Tables<W: Write + Send> {
    folder: PathBuf,
    file: String,
    format: Format,
    compression: Compression,
    create: Create<W>,
    /// Largest number of files.
    limit: usize,
    /// By message index.
    sinks: BTreeMap<u16, (PathBuf, Sink<W>)>,
}

impl<W: Write + Send> Output<W> {
    /// A file for each table, with few of them unless the user named types.
    pub fn tables(
        folder: PathBuf,
        file: String,
        format: Format,
        compression: Compression,
        create: Create<W>,
        types_are_named: bool,
    ) -> Self {
        let limit = if types_are_named { usize::MAX } else { MAX_UNNAMED_TYPES };
        let sinks = BTreeMap::new();
        Self::Tables(Tables { folder, file, format, compression, create, limit, sinks })
    }

    /// A file for all tables.
    pub fn mcap(path: PathBuf, create: Create<W>, settings: Settings) -> Self {
        Self::Mcap { path, create, settings, sink: None }
    }

    /// Writes the batches of a stretch of the log.
    ///
    /// # Errors
    /// Errors of the writers; [`Error::TooManyFiles`].
    pub fn write(&mut self, batches: &[Batch]) -> Result<(), Error> {
        match self {
            Self::Tables(tables) => tables.write(batches),
            Self::Mcap { .. } if batches.is_empty() => Ok(()),
            Self::Mcap { path, create, settings, sink } => {
                let sink = match sink {
                    Some(open) => open,
                    None => sink.insert(Box::new(McapSink::new(create(path)?, settings.clone())?)),
                };
                sink.write(batches)
            }
        }
    }

    /// Writes the ends of all files, and gives them back.
    ///
    /// # Errors
    /// Errors of the writers.
    pub fn finish(self) -> Result<(Files, Vec<W>), Error> {
        let (mut files, mut outs) = (Vec::new(), Vec::new());
        match self {
            Self::Tables(tables) => {
                for (path, sink) in tables.sinks.into_values() {
                    files.push((path, sink.rows()));
                    outs.push(sink.finish()?);
                }
            }
            Self::Mcap { path, sink, .. } => {
                if let Some(sink) = sink {
                    files.push((path, sink.rows()));
                    outs.push(sink.finish()?);
                }
            }
        }
        Ok((files, outs))
    }
}

impl<W: Write + Send> Tables<W> {
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

    /// Begins the file of a batch if it is the first one of its type.
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
            let out = (self.create)(&path)?;
            let sink = Sink::new(out, &batch.rows.schema(), self.format, self.compression)?;
            missing.insert((path, sink));
        }
        Ok(())
    }
}

/// Whether Windows treats the name of a file or folder as a device, such as `nul` or `COM1.txt`.
pub fn is_device(name: &str) -> bool {
    let stem = name.split('.').next().unwrap_or_default();
    let name = stem.trim_end_matches(' ').to_ascii_uppercase();
    let numbered = |kind| {
        name.strip_prefix(kind).is_some_and(|number| matches!(number.as_bytes(), [b'0'..=b'9']))
    };
    matches!(&*name, "CON" | "PRN" | "AUX" | "NUL") || numbered("COM") || numbered("LPT")
}

/// The folder of a type. A log names its types, and must not choose where files go.
pub fn folder_of(name: &str) -> String {
    let is_device = is_device(name);
    let letter = |(place, byte): (usize, u8)| {
        let is_plain = byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-');
        if is_plain && !(is_device && place == 0) {
            char::from(byte).to_string()
        } else {
            format!("%{byte:02X}")
        }
    };
    name.bytes().enumerate().map(letter).collect()
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
