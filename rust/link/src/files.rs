//! Files read from start to end, and files that appear whole or not at all.

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

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
        let (file, part) = create_beside(path)?;
        let file = BufWriter::with_capacity(64 << 10, file);
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

/// Makes a file that nobody else has, in the folder of `path`: `NAME.PROCESS-NUMBER.part`.
fn create_beside(path: &Path) -> io::Result<(File, PathBuf)> {
    static NUMBER: AtomicU64 = AtomicU64::new(0);
    let name = path.file_name().unwrap_or_default();
    loop {
        let mut part = name.to_owned();
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        part.push(format!(".{}-{number}.part", std::process::id()));
        let part = path.with_file_name(part);
        match File::create_new(&part) {
            // Left by a process that had this number before, or made by one of another machine.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            made => return Ok((made?, part)),
        }
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
    fn two_writers_of_one_file_do_not_meet() {
        let folder = std::env::temp_dir().join(format!("mavwire-twice-{}", std::process::id()));
        let path = folder.join("table.csv");
        let mut drafts = [(); 2].map(|()| Draft::create(&path).expect("creating"));
        for (text, draft) in ["one one one", "two"].into_iter().zip(&mut drafts) {
            draft.write_all(text.as_bytes()).expect("writing");
        }
        for (draft, expected) in drafts.into_iter().zip(["one one one", "two"]) {
            draft.commit().expect("committing");
            assert_eq!(std::fs::read_to_string(&path).expect("reading"), expected);
        }
        assert_eq!(std::fs::read_dir(&folder).expect("listing").count(), 1);
        std::fs::remove_dir_all(folder).expect("removing");
    }

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
