//! Files read from start to end, and files that appear whole or not at all.

use std::borrow::Cow;
use std::error::Error;
use std::ffi::OsStr;
use std::fmt;
use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::iter;
use std::ops::Range;
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

/// Opens a file for reading it once.
///
/// # Errors
/// Errors of the operating system. Pipes and sockets are refused, since opening one may never end, and devices, since
/// their bytes may not.
pub fn open(path: &Path) -> io::Result<Box<dyn Read + Send>> {
    check_kind(path)?;
    Ok(Box::new(File::open(path)?))
}

#[cfg(unix)]
fn check_kind(path: &Path) -> io::Result<()> {
    use std::os::unix::fs::{FileTypeExt, MetadataExt};

    let found = std::fs::metadata(path)?;
    let kind = found.file_type();
    let refused = |reason| Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
    if kind.is_fifo() || kind.is_socket() {
        return refused("a pipe or a socket is no log");
    }
    let is_null = || std::fs::metadata("/dev/null").is_ok_and(|null| null.rdev() == found.rdev());
    if (kind.is_char_device() || kind.is_block_device()) && !is_null() {
        return refused("a device is no log");
    }
    Ok(())
}

#[cfg(not(unix))]
fn check_kind(_: &Path) -> io::Result<()> {
    Ok(())
}

/// Opens some of the bytes of a file for reading them once. A file that ends in front of them has less.
///
/// # Errors
/// Those of [`open`].
pub fn open_part(path: &Path, bytes: Range<u64>) -> io::Result<Box<dyn Read + Send>> {
    check_kind(path)?;
    let mut file = File::open(path)?;
    file.seek(SeekFrom::Start(bytes.start))?;
    Ok(Box::new(file.take(bytes.end.saturating_sub(bytes.start))))
}

/// Why a file could not be written, and which; within an [`io::Error`] of the same kind.
#[derive(Debug)]
pub struct Unwritten {
    /// The path of the file that was to be written.
    pub path: PathBuf,
    /// The error of the operating system.
    pub error: io::Error,
}

impl fmt::Display for Unwritten {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.error)
    }
}

impl Error for Unwritten {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        Some(&self.error)
    }
}

/// Adds the name of the file to an error of writing it.
fn naming<T>(path: &Path, done: io::Result<T>) -> io::Result<T> {
    done.map_err(|error| io::Error::new(error.kind(), Unwritten { path: path.to_owned(), error }))
}

/// A file under construction, with a temporary name until it is committed. Dropping it without a commit removes it, and
/// the folders that were made for it. Its errors are [`Unwritten`].
#[derive(Debug)]
pub struct Draft {
    file: Option<BufWriter<File>>,
    path: PathBuf,
    /// Its current name: a temporary one, then `path`.
    name: PathBuf,
    /// Folders that were not there before, the innermost first.
    made: Vec<PathBuf>,
    /// It was committed: dropping it removes nothing.
    kept: bool,
}

impl Draft {
    /// Begins the file that is to be at `path`, with the folders on the way to it.
    ///
    /// # Errors
    /// Errors of the operating system.
    pub fn create(path: &Path) -> io::Result<Self> {
        let begun = match begin(path) {
            // Another draft, which was given up, has taken its folder with it.
            Err(error) if error.kind() == io::ErrorKind::NotFound => begin(path),
            begun => begun,
        };
        let (file, name, made) = naming(path, begun)?;
        if let Ok(before) = std::fs::metadata(path) {
            // The new file gets the permissions of the old one, where the file system has permissions.
            let _ = file.set_permissions(before.permissions());
        }
        let file = BufWriter::with_capacity(64 << 10, file);
        Ok(Self { file: Some(file), path: path.to_owned(), name, made, kept: false })
    }

    /// Gives the file its name, in place of any that has it.
    ///
    /// # Errors
    /// Errors of the operating system; the file is removed then.
    pub fn commit(mut self) -> io::Result<()> {
        self.sync()?;
        self.publish()?;
        self.kept = true;
        Ok(())
    }

    /// Waits until everything is on the disk.
    fn sync(&mut self) -> io::Result<()> {
        let Some(file) = &mut self.file else { return Ok(()) };
        naming(&self.path, file.flush().and_then(|()| file.get_ref().sync_data()))
    }

    fn publish(&mut self) -> io::Result<()> {
        drop(self.file.take());
        naming(&self.path, std::fs::rename(&self.name, &self.path))?;
        self.name.clone_from(&self.path);
        Ok(())
    }
}

fn remove_empty(folders: &[PathBuf]) {
    for folder in folders {
        let _ = std::fs::remove_dir(folder); // which is refused where others write to it
    }
}

/// Threads that wait for the disk at a time: it writes many files in little more than the time of one.
const WAITING: usize = 16;

/// Gives all files their names, once all of them are on the disk.
///
/// # Errors
/// Errors of the operating system about any of them. Then all are removed, and the folders that were made for them.
pub fn commit_all(mut drafts: Vec<Draft>) -> io::Result<()> {
    let done = sync_all(&mut drafts).and_then(|()| drafts.iter_mut().try_for_each(Draft::publish));
    // Backwards: the first of them made the folders that all are in, which go with it.
    while let Some(mut draft) = drafts.pop() {
        draft.kept = done.is_ok();
    }
    done
}

/// Waits until all of them are on the disk.
fn sync_all(drafts: &mut [Draft]) -> io::Result<()> {
    let threads = WAITING.min(drafts.len());
    let left = Mutex::new(drafts.iter_mut());
    let next = || left.lock().unwrap_or_else(PoisonError::into_inner).next();
    let sync = || iter::from_fn(next).try_for_each(Draft::sync);
    thread::scope(|scope| {
        // Where no further thread is to be had, those that are there do it.
        let start = |_| thread::Builder::new().spawn_scoped(scope, sync).ok();
        let started: Vec<_> = (1..threads).map_while(start).collect();
        let mut done = sync();
        for thread in started {
            done = done.and(thread.join().unwrap_or_else(|panic| resume_unwind(panic)));
        }
        done
    })
}

/// Bytes of a name that leave room for what a draft's name has more; file systems take 255.
const LONG_NAME: usize = 200;

/// The start of a file's temporary name: its final name, or a hash of it where that name is long.
pub fn draft_stem(name: &OsStr) -> Cow<'_, OsStr> {
    let bytes = name.as_encoded_bytes();
    if bytes.len() <= LONG_NAME {
        return Cow::Borrowed(name);
    }
    // FNV-1a, because it is the same in each version: a later one finds the files of a killed process by it.
    let hash = bytes.iter().fold(0xCBF2_9CE4_8422_2325_u64, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3)
    });
    Cow::Owned(format!("mavwire-{hash:016x}").into())
}

/// Makes the folder of `path`, and a file in it. Returns the file, its temporary name, and the folders that were not
/// there before, the innermost first.
fn begin(path: &Path) -> io::Result<(File, PathBuf, Vec<PathBuf>)> {
    let folders = path.ancestors().skip(1).filter(|folder| !folder.as_os_str().is_empty());
    let made: Vec<_> = folders.take_while(|folder| !folder.exists()).map(Path::to_owned).collect();
    let folder = path.parent().map_or(Ok(()), std::fs::create_dir_all);
    match folder.and_then(|()| create_beside(path)) {
        Ok((file, part)) => Ok((file, part, made)),
        Err(error) => {
            remove_empty(&made);
            Err(error)
        }
    }
}

/// Makes a file that nobody else has, in the folder of `path`: `STEM.PROCESS-NUMBER.part`.
fn create_beside(path: &Path) -> io::Result<(File, PathBuf)> {
    static NUMBER: AtomicU64 = AtomicU64::new(0);
    let stem = draft_stem(path.file_name().unwrap_or_default());
    loop {
        let mut part = stem.clone().into_owned();
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
        self.file.as_mut().map_or(Ok(0), |file| naming(&self.path, file.write(bytes)))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.as_mut().map_or(Ok(()), |file| naming(&self.path, file.flush()))
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        if self.kept {
            return;
        }
        drop(self.file.take());
        let _ = std::fs::remove_file(&self.name);
        remove_empty(&self.made);
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
    #[cfg(unix)]
    fn who_may_read_a_file_stays() {
        use std::os::unix::fs::PermissionsExt;
        let path = std::env::temp_dir().join(format!("mavwire-private-{}", std::process::id()));
        std::fs::write(&path, b"before").expect("writing");
        std::fs::set_permissions(&path, PermissionsExt::from_mode(0o640)).expect("permissions");
        Draft::create(&path).expect("creating").commit().expect("committing");
        let mode = std::fs::metadata(&path).expect("a file").permissions().mode();
        assert_eq!(mode & 0o777, 0o640);
        std::fs::remove_file(path).expect("removing");
    }

    #[test]
    fn a_name_may_be_as_long_as_names_are() {
        let folder = std::env::temp_dir().join(format!("mavwire-long-{}", std::process::id()));
        for len in [200, 201, 244, 255] {
            let path = folder.join("x".repeat(len));
            let mut draft = Draft::create(&path).expect("creating");
            draft.write_all(b"one").expect("writing");
            draft.commit().expect("committing");
            assert_eq!(std::fs::read(&path).expect("reading"), b"one");
        }
        assert_eq!(std::fs::read_dir(&folder).expect("listing").count(), 4);
        std::fs::remove_dir_all(folder).expect("removing");
    }

    #[test]
    fn folders_of_others_stay() {
        let folder = std::env::temp_dir().join(format!("mavwire-folders-{}", std::process::id()));
        let [empty, deep] = [folder.join("empty"), folder.join("new").join("deep")];
        std::fs::create_dir_all(&empty).expect("creating");
        drop(Draft::create(&empty.join("one")).expect("creating"));
        let given_up = Draft::create(&deep.join("one")).expect("creating");
        Draft::create(&deep.join("two")).expect("creating").commit().expect("committing");
        drop(given_up);
        assert!(empty.is_dir() && deep.join("two").is_file());
        std::fs::remove_dir_all(folder).expect("removing");
    }

    #[test]
    fn files_that_cannot_have_their_names_leave_no_folders() {
        let folder = std::env::temp_dir().join(format!("mavwire-unnamed-{}", std::process::id()));
        let draft = |name: &str| Draft::create(&folder.join(name).join("log")).expect("creating");
        for wrong in ["new/a", "new/b", "new/d"] {
            let drafts = ["new/a", "new/b", "new/c", "new/d"].map(draft);
            std::fs::create_dir(folder.join(wrong).join("log")).expect("creating");
            commit_all(drafts.into()).expect_err("a folder has the name");
            // The folder that another process made stays.
            std::fs::remove_dir(folder.join(wrong).join("log")).expect("it is there");
            std::fs::remove_dir(folder.join(wrong)).expect("it is there");
            std::fs::remove_dir(folder.join("new")).expect("nothing else is");
        }
        // The first made the folder that all are in, and is not the first to go.
        let outer = folder.join("outer");
        let drafts = ["a", "b"].map(|name| Draft::create(&outer.join(name)).expect("creating"));
        std::fs::remove_file(&drafts[0].name).expect("it is there");
        commit_all(drafts.into()).expect_err("there is nothing to be renamed");
        assert!(!outer.exists());
        // No file system takes such a name.
        let path = folder.join("new/a").join("x".repeat(300)).join("log");
        Draft::create(&path).expect_err("a folder of 300 bytes");
        assert!(!folder.join("new").exists());
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
    fn many_drafts_become_files() {
        let folder = std::env::temp_dir().join(format!("mavwire-drafts-{}", std::process::id()));
        let draft = |n: u8| {
            let mut draft = Draft::create(&folder.join(format!("{n}"))).expect("creating");
            draft.write_all(&[n]).expect("writing");
            draft
        };
        commit_all((0..40).map(draft).collect()).expect("committing");
        commit_all(Vec::new()).expect("committing nothing");
        for n in 0..40 {
            assert_eq!(std::fs::read(folder.join(format!("{n}"))).expect("reading"), [n]);
        }
        assert_eq!(std::fs::read_dir(&folder).expect("listing").count(), 40);
        // A folder in the way of one: none of them is left.
        std::fs::create_dir(folder.join("41")).expect("creating");
        commit_all((40..43).map(draft).collect()).expect_err("a folder has the name");
        assert_eq!(std::fs::read_dir(&folder).expect("listing").count(), 41);
        std::fs::remove_dir_all(folder).expect("removing");
    }

    #[test]
    fn a_draft_becomes_the_file_or_nothing() {
        let folder = std::env::temp_dir().join(format!("mavwire-draft-{}", std::process::id()));
        let path = folder.join("deep").join("table.csv");
        let mut draft = Draft::create(&path).expect("creating");
        draft.write_all(b"one").expect("writing");
        let left = || std::fs::read_dir(folder.join("deep")).expect("listing").count();
        assert_eq!(left(), 1);
        drop(draft);
        assert!(!folder.exists());
        let mut draft = Draft::create(&path).expect("creating");
        draft.write_all(b"two").expect("writing");
        assert!(!path.exists());
        draft.commit().expect("committing");
        assert_eq!(std::fs::read(&path).expect("reading"), b"two");
        assert_eq!(left(), 1);
        std::fs::remove_dir_all(folder).expect("removing");
    }
}
