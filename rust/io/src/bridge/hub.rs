//! Where a bridge's frames meet the program around it: the newest frame of each kind, and taps that get a copy of what
//! comes by. The event loop takes the lock once for all frames of a round.

use std::collections::{HashMap, VecDeque};
use std::sync::{Arc, Mutex};

use mavwire_core::frame::Header;
use mavwire_core::kind_hash::KindHash;
use mavwire_core::router::Filter;
use mavwire_core::telemetry::{STATUSTEXT, StatusTexts, TextFields};

use super::frames::{FrameInfo, Frames};
use super::home::{Home, lock};
use super::tap::{Tap, TapShared};

/// Kinds of frames whose newest is kept: message ids times components. A thousand components of 65 types are half of that.
const MAX_LATEST: usize = 1 << 17;
/// Removed links whose names are kept, for frames that came over them.
const MAX_RETIRED: usize = 1024;

/// The newest frame of its kind.
#[derive(Debug, Clone)]
pub struct Latest {
    /// Its description.
    pub info: FrameInfo,
    /// Its bytes.
    pub frame: Vec<u8>,
    /// The last complete text of a STATUSTEXT; several messages may have carried it.
    pub text: Option<Vec<u8>>,
    /// Frames of its kind so far.
    count: u64,
    /// Number of frames before it. It orders the frames of a round, which have the same time.
    order: u64,
}

/// A message from a component, and how often it came.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Kind {
    /// The newest one.
    pub info: FrameInfo,
    /// How many came.
    pub count: u64,
    /// Name of the link that it came over.
    pub link: String,
}

#[derive(Debug, Default)]
struct State {
    /// By [`key`].
    latest: HashMap<u64, Latest, KindHash>,
    count: u64,
    /// Parts of long texts by sender.
    texts: StatusTexts<(u8, u8)>,
    taps: Vec<Arc<TapShared>>,
    link_names: HashMap<u32, String>,
    /// Removed links, oldest first.
    retired: VecDeque<u32>,
    stopped: bool,
}

/// The key of a kind of message. One number is hashed faster than three.
#[inline]
fn key(msgid: u32, sysid: u8, compid: u8) -> u64 {
    u64::from(msgid) << 16 | u64::from(sysid) << 8 | u64::from(compid)
}

/// Makes room for as many kinds again as a tenth of those that there are, so that the cost for each stays small.
fn forget_oldest(latest: &mut HashMap<u64, Latest, KindHash>) {
    let mut orders: Vec<u64> = latest.values().map(|one| one.order).collect();
    let tenth = orders.len() / 10;
    let (_, &mut last, _) = orders.select_nth_unstable(tenth);
    latest.retain(|_, one| one.order > last);
}

/// The text that a STATUSTEXT completes.
fn text_of(texts: &mut StatusTexts<(u8, u8)>, frame: &[u8]) -> Option<Vec<u8>> {
    let header = Header::parse(frame)?;
    let payload = &frame.get(header.len()..)?.get(..usize::from(header.payload_len))?;
    let sender = (header.sysid, header.compid);
    let ended = texts.receive(TextFields::STANDARD, sender, payload, || sender).into_iter();
    ended.rev().find(|&(of, _)| of == sender).map(|(_, text)| text)
}

/// The newest frames and the taps, shared by the event loop and the program.
#[derive(Debug)]
pub struct Hub {
    home: Home,
    state: Mutex<State>,
}

impl Hub {
    pub(super) fn new() -> Self {
        Self { home: Home::here(), state: Mutex::default() }
    }

    /// Whether this is the copy of a fork, which nothing comes to.
    pub(super) fn is_forked(&self) -> bool {
        self.home.is_elsewhere()
    }

    pub(super) fn deliver(&self, frames: &Frames) {
        let mut guard = lock(&self.state);
        let state = &mut *guard;
        for (info, bytes) in frames.iter().filter(|(info, _)| info.index.is_some()) {
            state.count += 1;
            let order = state.count;
            let key = key(info.msgid, info.sysid, info.compid);
            let text =
                if info.msgid == STATUSTEXT { text_of(&mut state.texts, bytes) } else { None };
            if let Some(latest) = state.latest.get_mut(&key) {
                (latest.info, latest.order) = (*info, order);
                if text.is_some() {
                    latest.text = text;
                }
                latest.count += 1;
                latest.frame.clear();
                latest.frame.extend_from_slice(bytes);
            } else {
                if state.latest.len() >= MAX_LATEST {
                    forget_oldest(&mut state.latest); // someone makes up addresses
                }
                let frame = bytes.to_vec();
                state.latest.insert(key, Latest { info: *info, frame, text, count: 1, order });
            }
        }
        state.taps.retain(|tap| !tap.is_closed());
        state.taps.iter().for_each(|tap| tap.deliver(frames));
    }

    pub(super) fn stop(&self) {
        let mut state = lock(&self.state);
        state.stopped = true;
        state.taps.drain(..).for_each(|tap| tap.close());
    }

    pub(super) fn name_link(&self, number: u32, name: &str) {
        lock(&self.state).link_names.insert(number, name.to_owned());
    }

    /// Notes that a link is no more. Names of the last of these stay.
    pub(super) fn retire_link(&self, number: u32) {
        let mut state = lock(&self.state);
        state.retired.push_back(number);
        if state.retired.len() > MAX_RETIRED
            && let Some(oldest) = state.retired.pop_front()
        {
            state.link_names.remove(&oldest);
        }
    }

    /// The name of the link with a number, also after it was removed.
    pub fn link_name(&self, number: u32) -> Option<String> {
        lock(&self.state).link_names.get(&number).cloned()
    }

    /// The newest frame with a message id, from a system and component or from any.
    pub fn latest(&self, msgid: u32, sysid: Option<u8>, compid: Option<u8>) -> Option<Latest> {
        let state = lock(&self.state);
        if let (Some(sysid), Some(compid)) = (sysid, compid) {
            return state.latest.get(&key(msgid, sysid, compid)).cloned();
        }
        let matching = state.latest.values().filter(|latest| {
            latest.info.msgid == msgid
                && sysid.is_none_or(|sysid| sysid == latest.info.sysid)
                && compid.is_none_or(|compid| compid == latest.info.compid)
        });
        matching.max_by_key(|latest| latest.order).cloned()
    }

    /// The kinds of messages that came last, `most` of them, by system, component and message id; how many there are
    /// besides.
    pub fn kinds(&self, most: usize) -> (Vec<Kind>, usize) {
        let all = |state: &State| {
            let kinds = state.latest.values();
            kinds.map(|one| (one.order, one.info, one.count)).collect::<Vec<_>>()
        };
        let mut kinds = all(&lock(&self.state)); // the event loop does not wait for the rest
        let hidden = kinds.len().saturating_sub(most);
        if hidden > 0 {
            kinds.select_nth_unstable_by_key(hidden - 1, |&(order, ..)| order);
            kinds.drain(..hidden);
        }
        kinds.sort_unstable_by_key(|(_, info, _)| (info.sysid, info.compid, info.msgid));
        let state = lock(&self.state);
        let named = |(_, info, count): (u64, FrameInfo, u64)| {
            let link = state.link_names.get(&info.link).cloned().unwrap_or_default();
            Kind { info, count, link }
        };
        (kinds.into_iter().map(named).collect(), hidden)
    }

    /// A tap for what comes from now on.
    pub fn tap(&self, filter: Filter) -> Tap {
        let mut state = lock(&self.state);
        let tap = Arc::new(TapShared::new(self.home, filter, state.stopped));
        if !state.stopped {
            state.taps.push(Arc::clone(&tap));
        }
        Tap(tap)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bridge::frames::testing::frames;

    #[test]
    fn names_of_removed_links_do_not_pile_up() {
        let hub = Hub::new();
        hub.name_link(0, "stays");
        for number in 1..=2_000 {
            hub.name_link(number, "guest");
            hub.retire_link(number);
        }
        let named = |number| hub.link_name(number).is_some();
        assert_eq!((named(0), named(1), named(2_000)), (true, false, true));
        assert_eq!(lock(&hub.state).link_names.len(), MAX_RETIRED + 1);
    }

    #[test]
    fn where_there_are_too_many_kinds_the_oldest_go() {
        let hub = Hub::new();
        let mut made_up = frames((0..MAX_LATEST).map(|_| 7));
        for (n, info) in (0_u32..).zip(&mut made_up.infos) {
            [info.sysid, info.compid] = [n as u8, (n >> 8) as u8];
            info.msgid = 1_000 + (n >> 16);
        }
        hub.deliver(&frames([30]));
        hub.deliver(&made_up);
        hub.deliver(&frames([30, 31]));
        let (kinds, _) = hub.kinds(MAX_LATEST);
        assert!((MAX_LATEST * 8 / 10..MAX_LATEST).contains(&kinds.len()), "{}", kinds.len());
        assert!(hub.latest(31, None, None).is_some(), "what came last is there");
        let newest = made_up.infos.last().expect("it is not empty");
        let known = |info: &FrameInfo| hub.latest(info.msgid, Some(info.sysid), Some(info.compid));
        assert!(known(newest).is_some() && known(&made_up.infos[1]).is_none());
    }

    #[test]
    fn the_newest_of_each_kind_is_kept() {
        let hub = Hub::new();
        let mut second = frames([30, 30]);
        second.infos[1].compid = 9;
        hub.deliver(&frames([30, 0, 30, 5_000]));
        hub.deliver(&second);
        let time = |sysid, compid| hub.latest(30, sysid, compid).map(|latest| latest.info.time);
        assert_eq!((time(Some(1), Some(1)), time(None, None)), (Some(0), Some(1)));
        assert_eq!(
            (time(Some(1), None), time(None, Some(9)), time(Some(2), None)),
            (Some(1), Some(1), None)
        );
        assert!(hub.latest(5_000, None, None).is_none(), "the dialect does not know it");
        hub.name_link(second.infos[0].link, "radio");
        let told = |most| {
            let (kinds, hidden) = hub.kinds(most);
            assert!(kinds.iter().all(|kind| kind.link == "radio"));
            let rows = kinds.iter().map(|kind| (kind.info.msgid, kind.info.compid, kind.count));
            (rows.collect::<Vec<_>>(), hidden)
        };
        assert_eq!(told(3), (vec![(0, 1, 1), (30, 1, 3), (30, 9, 1)], 0));
        assert_eq!(told(2), (vec![(30, 1, 3), (30, 9, 1)], 1), "those that came last");
        assert_eq!(told(0), (vec![], 3));
    }
}
