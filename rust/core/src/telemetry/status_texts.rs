//! Long status texts, which are sent as STATUSTEXT messages of up to 50 bytes each.
//!
//! * `id` 0 is a text of one message. Other messages of one sender and `id` belong together, in the order of `chunk_seq`.
//! * A NUL in the text, or less than a whole field, ends it: then the text is complete. Chunks that never came are `...`.
//! * A text is given up, as far as it was heard, when its sender uses its `id` for another one or when [`MOST_OPEN`] newer
//!   texts are open. It ends in `...` then.

use mavwire_schema::Message;

use crate::codec::read;

/// Texts that may be incomplete at once.
pub const MOST_OPEN: usize = 16;
/// The replacement for bytes that were not received.
const MISSING: &[u8] = b"...";

/// Message id of STATUSTEXT.
pub const STATUSTEXT: u32 = 253;

/// Where the fields are in a payload.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TextFields {
    text: usize,
    text_len: usize,
    id: usize,
    seq: usize,
}

/// A part of a long text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Chunk<'a> {
    id: u16,
    seq: u8,
    text: &'a [u8],
    is_last: bool,
}

impl TextFields {
    /// Of STATUSTEXT as MAVLink has it.
    pub const STANDARD: Self = Self { text: 1, text_len: 50, id: 51, seq: 53 };

    /// Of STATUSTEXT in the definitions that have chunks; `None` for another message.
    pub fn of(message: &Message) -> Option<Self> {
        let field = |name: &str| message.fields.iter().find(|field| field.name == name);
        let (text, id, seq) = (field("text")?, field("id")?, field("chunk_seq")?);
        let fits = message.name == "STATUSTEXT"
            && text.is_char()
            && (id.wire_len(), seq.wire_len()) == (2, 1);
        fits.then(|| Self {
            text: text.offset.into(),
            text_len: text.wire_len(),
            id: id.offset.into(),
            seq: seq.offset.into(),
        })
    }

    /// The text of a message.
    pub fn text<'a>(&self, payload: &'a [u8]) -> &'a [u8] {
        let end = (self.text + self.text_len).min(payload.len());
        let text = payload.get(self.text..end).unwrap_or_default();
        &text[..memchr::memchr(0, text).unwrap_or(text.len())]
    }

    /// Whether a message has a whole text.
    #[inline]
    pub fn is_whole(&self, payload: &[u8]) -> bool {
        self.id(payload) == 0
    }

    #[inline]
    fn id(&self, payload: &[u8]) -> u16 {
        u16::from_le_bytes(read(payload, self.id))
    }

    /// The part that a message has; `None` where it has the whole text.
    fn chunk<'a>(&self, payload: &'a [u8]) -> Option<Chunk<'a>> {
        if self.is_whole(payload) {
            return None;
        }
        let id = self.id(payload);
        let (text, seq) = (self.text(payload), read::<1>(payload, self.seq)[0]);
        let is_last = text.len() < self.text_len;
        Some(Chunk { id, seq, text, is_last })
    }
}

/// Joins the parts of long texts; `T` is what is to be kept of the message with the first part.
#[derive(Debug)]
pub struct StatusTexts<T> {
    /// The oldest first.
    open: Vec<Open<T>>,
}

#[derive(Debug)]
struct Open<T> {
    sender: (u8, u8),
    id: u16,
    first: T,
    /// In order, each number once.
    chunks: Vec<(u8, Box<[u8]>)>,
}

impl<T> Default for StatusTexts<T> {
    fn default() -> Self {
        Self { open: Vec::new() }
    }
}

impl<T> StatusTexts<T> {
    /// Receives a message. Gives the texts that end with it: at most one that is given up, and its own.
    pub fn receive(
        &mut self,
        fields: TextFields,
        sender: (u8, u8),
        payload: &[u8],
        first: impl FnOnce() -> T,
    ) -> Vec<(T, Vec<u8>)> {
        match fields.chunk(payload) {
            None => vec![(first(), fields.text(payload).to_vec())],
            Some(chunk) => self.join(sender, chunk, first),
        }
    }

    fn join(
        &mut self,
        sender: (u8, u8),
        chunk: Chunk<'_>,
        first: impl FnOnce() -> T,
    ) -> Vec<(T, Vec<u8>)> {
        let is_same = |open: &Open<T>| (open.sender, open.id) == (sender, chunk.id);
        let mut place = self.open.iter().position(is_same);
        let mut given_up = None;
        if let Some(at) = place
            && let Ok(known) = self.open[at].place_of(chunk.seq)
            && *self.open[at].chunks[known].1 != *chunk.text
        {
            given_up = Some(self.open.remove(at).text(true));
            place = None;
        }
        let at = place.unwrap_or_else(|| {
            if self.open.len() == MOST_OPEN {
                given_up = Some(self.open.remove(0).text(true));
            }
            let (id, first) = (chunk.id, first());
            self.open.push(Open { sender, id, first, chunks: Vec::new() });
            self.open.len() - 1
        });
        if let Err(free) = self.open[at].place_of(chunk.seq) {
            self.open[at].chunks.insert(free, (chunk.seq, chunk.text.into()));
        }
        let done = chunk.is_last.then(|| self.open.remove(at).text(false));
        given_up.into_iter().chain(done).collect()
    }

    /// Gives up what is left.
    pub fn finish(&mut self) -> Vec<(T, Vec<u8>)> {
        std::mem::take(&mut self.open).into_iter().map(|open| open.text(true)).collect()
    }
}

impl<T> Open<T> {
    fn place_of(&self, seq: u8) -> Result<usize, usize> {
        self.chunks.binary_search_by_key(&seq, |&(seq, _)| seq)
    }

    fn text(self, is_cut: bool) -> (T, Vec<u8>) {
        let (mut text, mut expected) = (Vec::new(), 0);
        for (seq, chunk) in self.chunks {
            if u16::from(seq) != expected {
                text.extend_from_slice(MISSING);
            }
            text.extend_from_slice(&chunk);
            expected = u16::from(seq) + 1;
        }
        if is_cut {
            text.extend_from_slice(MISSING);
        }
        (self.first, text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin;
    use mavwire_schema::WireVersion::V2;

    fn fields() -> TextFields {
        let dialect = builtin::dialect("common", V2).expect("it is built in");
        let mut found = dialect.messages.iter().filter_map(TextFields::of);
        let fields = found.next().expect("STATUSTEXT");
        assert_eq!(fields, TextFields::STANDARD);
        fields
    }

    fn payload(id: u16, seq: u8, text: &str) -> Vec<u8> {
        let mut payload = vec![6];
        payload.extend_from_slice(text.as_bytes());
        payload.resize(51, 0);
        payload.extend_from_slice(&id.to_le_bytes());
        payload.push(seq);
        payload
    }

    struct Heard {
        texts: StatusTexts<usize>,
        count: usize,
        found: Vec<(usize, String)>,
    }

    impl Heard {
        fn new() -> Self {
            Self { texts: StatusTexts::default(), count: 0, found: Vec::new() }
        }

        fn receive(&mut self, compid: u8, id: u16, seq: u8, text: &str) {
            let payload = payload(id, seq, text);
            let found = self.texts.receive(fields(), (1, compid), &payload, || self.count);
            let found = found
                .into_iter()
                .map(|(first, text)| (first, String::from_utf8(text).expect("ASCII")));
            self.found.extend(found);
            self.count += 1;
        }
    }

    fn full(letter: char) -> String {
        String::from(letter).repeat(50)
    }

    #[test]
    fn parts_of_several_senders_and_texts_are_joined_by_number() {
        let (a, b) = (full('a'), full('b'));
        let mut heard = Heard::new();
        heard.receive(1, 7, 0, &a);
        heard.receive(1, 0, 0, "short"); // whole
        heard.receive(2, 7, 0, &b);
        heard.receive(1, 8, 1, &b);
        heard.receive(1, 7, 0, &a); // over another link
        heard.receive(1, 8, 0, &a);
        heard.receive(2, 7, 1, "end");
        heard.receive(1, 7, 1, "");
        heard.receive(1, 8, 2, "end");
        let joined = [(2, format!("{b}end")), (0, a.clone()), (3, format!("{a}{b}end"))];
        assert_eq!(heard.found[0], (1, "short".to_owned()));
        assert_eq!(heard.found[1..], joined);
        assert_eq!(heard.texts.finish(), []);
    }

    #[test]
    fn what_was_not_received_is_shown() {
        let (a, b) = (full('a'), full('b'));
        let mut heard = Heard::new();
        heard.receive(1, 7, 1, &a);
        heard.receive(1, 7, 3, "end");
        heard.receive(1, 7, 0, &a);
        heard.receive(1, 7, 0, &b); // another text
        assert_eq!(heard.found, [(0, format!("...{a}...end")), (2, format!("{a}..."))]);
        assert_eq!(heard.texts.finish(), [(3, format!("{b}...").into_bytes())]);
    }

    #[test]
    fn few_texts_are_open() {
        let mut heard = Heard::new();
        for id in 1..=1000 {
            heard.receive(1, id, 255, &full('a'));
        }
        assert_eq!((heard.found.len(), heard.texts.open.len()), (1000 - MOST_OPEN, MOST_OPEN));
        assert_eq!(heard.found[0], (0, format!("...{}...", full('a'))));
    }
}
