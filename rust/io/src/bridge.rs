//! A bridge: links of any kind with a router between them, on a thread of its own.
//!
//! [`Bridge`] is the handle. It opens what a link needs on the caller's thread, so that a port that is taken is told
//! at once, and hands it to the event loop. Frames are copied from the read buffer into the queue of each link they go
//! to, which for frames of 36 bytes costs less than counting references to them.
//!
//! | module | |
//! |---|---|
//! | `endpoint` | where a link leads, opening and dialling |
//! | `event_loop` | waiting, reading, writing |
//! | `connections` | links that are added and removed, connections that come and go |
//! | `switch` | bytes to frames to queues |
//! | `port`, `outbox`, `lane`, `send` | one peer, its queue, many datagrams in a call |
//! | `automation` | what the bridge says of its own accord |
//! | `report`, `latency` | what it tells about itself |
//! | `hub`, `tap`, `frames` | the newest frames, and taps for the program around the bridge |
//! | `home` | what a fork must not touch |
//! | `recorder` | telemetry logs |

mod automation;
mod connections;
mod endpoint;
mod event_loop;
mod frames;
mod home;
mod hub;
mod lane;
mod latency;
mod outbox;
mod port;
mod recorder;
mod report;
mod send;
mod serial;
mod socket_options;
mod stats;
mod switch;
mod tap;

pub use automation::AutomationOptions;
pub use endpoint::{Endpoint, LinkSpec, NetKind, PortSpec};
pub use frames::{FrameInfo, Frames};
pub use hub::{Hub, Kind, Latest};
pub use recorder::{Recording, RecordingStats};
pub use stats::{ComponentReport, LinkReport, Stats, Traffic};
pub use tap::Tap;

use std::io::{self, Write as _};
use std::os::unix::net::UnixStream;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use endpoint::Opened;
use event_loop::{Command, EventLoop};
use mavwire_core::frame::FrameError;
use mavwire_core::registry::Registry;
use mavwire_core::router::Settings;
use mavwire_core::scan::{Found, Resync, Scanner};
use recorder::Recorder;
use switch::Switch;

/// Commands that may wait. Further ones make their sender wait.
const MAX_COMMANDS: usize = 1024;
/// Bytes of whole frames in one command. The program's frames wait as such commands, 4 MiB at most, and links wait for
/// no more than the commands of a round.
const SENT_PIECE: usize = 4096;

/// The error number where the system gives none: for an unknown name, or a path that is not a device.
pub const NO_SUCH_ADDRESS: i32 = libc::ENXIO;

/// Why a bridge refused a request.
#[derive(Debug, thiserror::Error)]
pub enum BridgeError {
    /// A link could not be opened.
    #[error("{link}: {error}")]
    Io {
        /// Its name.
        link: String,
        /// The error of the operating system.
        error: io::Error,
    },
    /// Two links of one name.
    #[error("there is a link called {0:?} already")]
    NameTaken(String),
    /// A name that no link has.
    #[error("there is no link called {0:?}")]
    NoSuchLink(String),
    /// More links than a router can tell apart.
    #[error("there are too many links and peers; 255 are the limit")]
    TooManyLinks,
    /// The program sends bytes that are not a sequence of whole frames.
    #[error("no whole frame at byte {at} of {len}: send whole frames")]
    NoFrame {
        /// Where the frame ought to begin.
        at: usize,
        /// Bytes in all.
        len: usize,
    },
    /// The program sends a frame that receivers refuse.
    #[error("no good frame at byte {at} of {len}: {error}")]
    BadFrame {
        /// Where the frame begins.
        at: usize,
        /// Bytes in all.
        len: usize,
        /// The fault of the frame.
        error: FrameError,
    },
    /// The bridge runs no more.
    #[error("the bridge has stopped")]
    Stopped,
}

/// A link that is open and in no bridge yet.
#[derive(Debug)]
pub struct OpenLink {
    spec: LinkSpec,
    opened: Opened,
}

impl LinkSpec {
    /// Opens a link as far as that takes no time. Looking up a name takes as long as its servers do.
    ///
    /// # Errors
    /// Errors of the operating system.
    pub fn open(mut self) -> Result<OpenLink, BridgeError> {
        match self.endpoint.open() {
            Ok(opened) => Ok(OpenLink { spec: self, opened }),
            Err(error) => Err(BridgeError::Io { link: self.name, error }),
        }
    }
}

/// Sends commands to the event loop, and wakes it.
#[derive(Clone)]
struct Waker {
    commands: SyncSender<Command>,
    signal: Arc<UnixStream>,
}

impl Waker {
    fn send(&self, command: Command) -> Result<(), BridgeError> {
        self.commands.send(command).map_err(|_| BridgeError::Stopped)?;
        self.wake();
        Ok(())
    }

    /// Wakes the loop at once if the system lets it. Failing is no loss: with a full pipe the loop is about to wake
    /// anyway, and otherwise it obeys at its next tick.
    fn wake(&self) {
        let _ = (&*self.signal).write_all(&[0]);
    }
}

/// A running bridge. Dropping it stops it.
pub struct Bridge {
    registry: Arc<Registry>,
    waker: Waker,
    hub: Arc<Hub>,
    thread: Mutex<Option<JoinHandle<()>>>,
}

impl Bridge {
    /// Starts a bridge without links.
    ///
    /// # Errors
    /// Errors of the operating system, from the recording's files or the start of a thread.
    pub fn start(
        registry: Arc<Registry>,
        settings: Settings,
        recording: Option<Recording>,
    ) -> io::Result<Self> {
        let recorder = recording.map(Recorder::start).transpose()?;
        let (commands, receiver) = sync_channel(MAX_COMMANDS);
        let (signal, wake) = UnixStream::pair()?;
        signal.set_nonblocking(true)?;
        wake.set_nonblocking(true)?;
        let waker = Waker { commands, signal: Arc::new(signal) };
        let hub = Arc::new(Hub::new());
        let (for_loop, hub_of_loop) = (waker.clone(), Arc::clone(&hub));
        let registry_of_loop = Arc::clone(&registry);
        let run = move || {
            let switch = Switch::new(registry_of_loop, settings);
            EventLoop::new(switch, hub_of_loop, recorder, receiver, for_loop, wake).run();
        };
        let thread = std::thread::Builder::new().name("mavwire-bridge".into()).spawn(run)?;
        Ok(Self { registry, waker, hub, thread: Mutex::new(Some(thread)) })
    }

    fn tell(&self, command: Command) -> Result<(), BridgeError> {
        if self.hub.is_forked() { Err(BridgeError::Stopped) } else { self.waker.send(command) }
    }

    fn ask<T>(&self, command: impl FnOnce(SyncSender<T>) -> Command) -> Result<T, BridgeError> {
        let (answer, receiver) = sync_channel(1);
        self.tell(command(answer))?;
        receiver.recv().map_err(|_| BridgeError::Stopped)
    }

    /// Opens a link and adds it.
    ///
    /// # Errors
    /// It cannot be opened, its name is taken, or there are too many.
    pub fn add(&self, spec: LinkSpec) -> Result<(), BridgeError> {
        self.attach(spec.open()?)
    }

    /// Adds a link that is open.
    ///
    /// # Errors
    /// Its name is taken, or there are too many.
    pub fn attach(&self, OpenLink { spec, opened }: OpenLink) -> Result<(), BridgeError> {
        self.ask(|answer| Command::Add(Box::new(spec), opened, answer))?
    }

    /// Removes a link and closes it.
    ///
    /// # Errors
    /// There is none of that name.
    pub fn remove(&self, name: &str) -> Result<(), BridgeError> {
        self.ask(|answer| Command::Remove(name.to_owned(), answer))?
    }

    /// The statistics so far.
    ///
    /// # Errors
    /// The bridge has stopped.
    pub fn stats(&self) -> Result<Stats, BridgeError> {
        let (stats, heard) = self.ask(Command::Stats)?;
        let (components, hidden_components) = heard.reports();
        Ok(Stats { components, hidden_components, ..stats })
    }

    /// Routes frames as if they came over a link of their own. Waits while more than some MB of them wait.
    ///
    /// # Errors
    /// The bridge has stopped, or something is no whole frame or has a wrong checksum; then none is sent.
    pub fn send(&self, frames: &[u8]) -> Result<(), BridgeError> {
        let (mut scanner, len) = (Scanner::new(Resync::Skip), frames.len());
        let (mut at, mut start, mut pieces) = (0, 0, Vec::new());
        while at < len {
            let end = match scanner.next(&frames[at..], &self.registry) {
                Found::Frame { len, .. } => at + len,
                Found::Rejected { error, .. } => {
                    return Err(BridgeError::BadFrame { at, len, error });
                }
                _ => return Err(BridgeError::NoFrame { at, len }),
            };
            if end - start > SENT_PIECE {
                pieces.push(start..at);
                start = at;
            }
            at = end;
        }
        pieces.push(start..len);
        pieces.into_iter().try_for_each(|piece| self.tell(Command::Send(frames[piece].into())))
    }

    /// The frames that passed the bridge: the newest of each kind, and taps.
    ///
    /// # Errors
    /// The bridge runs in the process that this one was forked from. Here nothing comes by, and a lock that the thread
    /// there held is never released.
    pub fn hub(&self) -> Result<&Hub, BridgeError> {
        if self.hub.is_forked() { Err(BridgeError::Stopped) } else { Ok(&self.hub) }
    }

    /// Stops it: closes all links, ends all taps, writes what is left of a recording.
    pub fn stop(&self) {
        let thread = self.thread.lock().unwrap_or_else(PoisonError::into_inner).take();
        if self.hub.is_forked() {
            std::mem::forget(thread);
        } else if let Some(thread) = thread {
            let _ = self.waker.send(Command::Stop);
            let _ = thread.join();
        }
    }
}

impl Drop for Bridge {
    fn drop(&mut self) {
        self.stop();
    }
}

#[cfg(test)]
mod tests;
