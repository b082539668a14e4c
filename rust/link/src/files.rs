//! Files read from start to end, and files that appear whole or not at all.

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Opens a file for reading it once.
///
/// # Errors
/// What the operating system says.
pub fn open(path: &Path) -> io::Result<Box<dyn Read + Send>> {
    Ok(Box::new(File::open(path)?))
}

/// Opens some of the bytes of a file for reading them once. A file that ends in front of them has less.
///
/// # Errors
/// What the operating system says.
pub fn open_part(path: &Path, bytes: Range<u64>) -> io::Result<Box<dyn Read + Send>> {
    let mut file = File::open(path)?;
    file.seek(SeekFrom::Start(bytes.start))?;
    Ok(Box::new(file.take(bytes.end.saturating_sub(bytes.start))))
}

/// A file under construction: it bears another name until it is committed, and is removed where that never happens.
#[derive(Debug)]
pub struct Draft {
    file: Option<BufWriter<File>>,
    path: PathBuf,
    part: PathBuf,
}

impl Draft {
    /// Begins the file that is to be at `path`, with the folders it stands in.
    ///
    /// # Errors
    /// What the operating system says.
    pub fn create(path: &Path) -> io::Result<Self> {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        let mut name = path.file_name().unwrap_or_default().to_owned();
        name.push(".part");
        let part = path.with_file_name(name);
        let file = BufWriter::with_capacity(64 << 10, File::create(&part)?);
        Ok(Self { file: Some(file), path: path.to_owned(), part })
    }

    /// Gives the file its name, in place of any that has it.
    ///
    /// # Errors
    /// What the operating system says; the file is removed then.
    pub fn commit(mut self) -> io::Result<()> {
        let Some(file) = self.file.take() else { return Ok(()) };
        let file = file.into_inner().map_err(io::IntoInnerError::into_error);
        let renamed = file
            .and_then(|file| file.sync_data())
            .and_then(|()| std::fs::rename(&self.part, &self.path));
        if renamed.is_err() {
            let _ = std::fs::remove_file(&self.part);
        }
        renamed
    }
}

impl Write for Draft {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.as_mut().map_or(Ok(0), |file| file.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.as_mut().map_or(Ok(()), Write::flush)
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        if self.file.take().is_some() {
            let _ = std::fs::remove_file(&self.part);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_is_what_is_there_of_it() {
        let path = std::env::temp_dir().join(format!("mavwire-part-{}", std::process::id()));
        std::fs::write(&path, b"0123456789").expect("writing");
        let part = |bytes: Range<u64>| {
            let mut read = String::new();
            open_part(&path, bytes).expect("opening").read_to_string(&mut read).expect("reading");
            read
        };
        let backwards = Range { start: 5, end: 3 };
        let parts = [0..10, 3..5, 8..20, 30..40, backwards].map(part);
        assert_eq!(parts, ["0123456789", "34", "89", "", ""]);
        std::fs::remove_file(path).expect("removing");
    }

    #[test]
    fn a_draft_becomes_the_file_or_nothing() {
        let folder = std::env::temp_dir().join(format!("mavwire-draft-{}", std::process::id()));
        let path = folder.join("deep").join("table.csv");
        let mut draft = Draft::create(&path).expect("creating");
        draft.write_all(b"one").expect("writing");
        drop(draft);
        let left = || std::fs::read_dir(folder.join("deep")).expect("listing").count();
        assert_eq!(left(), 0);
        let mut draft = Draft::create(&path).expect("creating");
        draft.write_all(b"two").expect("writing");
        assert!(!path.exists());
        draft.commit().expect("committing");
        assert_eq!(std::fs::read(&path).expect("reading"), b"two");
        assert_eq!(left(), 1);
        std::fs::remove_dir_all(folder).expect("removing");
    }
}
