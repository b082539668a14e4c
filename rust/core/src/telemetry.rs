//! Facts that a receiver derives from messages: counts, losses, status texts, reboots and times.

mod boot_clocks;
mod boot_time;
mod newest;
mod reception;
mod repeats;
mod status_texts;
mod steady_time;
mod stream_clock;

pub use boot_clocks::BootClocks;
pub use boot_time::BootTimes;
pub use newest::{Kept, Newest, Room, Source};
pub use reception::{RADIO, Reception, Sender};
pub use repeats::Repeats;
pub use status_texts::{MOST_OPEN, STATUSTEXT, StatusTexts, TextFields};
pub use steady_time::{SteadyTime, is_jump_forward};
pub use stream_clock::StreamClock;
