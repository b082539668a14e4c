//! `decompress`: a compressed file as a plain one, for readers that go to and fro in a log; and what files are called until they
//! are complete.

use std::ffi::OsString;
use std::io::Write;
use std::path::PathBuf;

use mavwire_columns::input::Blocks;
use mavwire_io::files::{self, Draft};
use pyo3::prelude::*;

use crate::python::error::Result;
use crate::tables::columns::Teller;

/// Writes what a file holds that is compressed with gzip or zstd to `out`, which appears when it is complete. Returns what
/// is wrong with the compressed file, of which everything before that was written; None for nothing.
#[pyfunction]
pub(crate) fn decompress(py: Python<'_>, path: PathBuf, out: PathBuf) -> Result<Option<String>> {
    let tell = Teller(None);
    py.detach(|| {
        let mut blocks = Blocks::new(files::open(&path)?)?;
        let mut draft = Draft::create(&out)?;
        let mut write = |block: &[u8], _: bool| (block.len(), draft.write_all(block));
        while let Some(written) = blocks.next(&mut write)? {
            written?;
            tell.tell(0)?;
        }
        draft.commit()?;
        Ok(blocks.damage().map(str::to_owned))
    })
}

/// The start of a file's temporary name: its final name, or a hash of it where that name is long.
#[pyfunction]
pub(crate) fn draft_stem(name: OsString) -> OsString {
    files::draft_stem(&name).into_owned()
}
