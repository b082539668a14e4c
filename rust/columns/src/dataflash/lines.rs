//! The lines of a text log, block by block.

use mavwire_core::log::dataflash::text::{MAX_LINE_LEN, mark_len, trimmed};

/// Splits blocks into lines; one that is longer than anything that is read is passed over.
#[derive(Debug, Clone, Default)]
pub(super) struct Lines {
    /// Within a line that is too long.
    within: bool,
    /// The start of the log was seen.
    is_begun: bool,
}

/// A line of a block.
pub(super) struct Line<'a> {
    /// Where it starts.
    pub(super) at: usize,
    /// Where the next one starts.
    pub(super) next: usize,
    /// Without the white space at its end; `None` for (a part of) one that is too long, and for one that nothing ends,
    /// but for white space: its last value may be cut off.
    pub(super) bytes: Option<&'a [u8]>,
}

impl Lines {
    /// Hands over the lines of a block. Returns the bytes consumed.
    pub(super) fn each(
        &mut self,
        block: &[u8],
        at_end: bool,
        mut line: impl FnMut(Line<'_>),
    ) -> usize {
        let mut at = 0;
        while at < block.len() {
            let rest = &block[at..];
            let mark = if self.is_begun { 0 } else { mark_len(rest) };
            let found = memchr::memchr(b'\n', rest);
            let len = found.unwrap_or(rest.len());
            let is_ended = found.is_some();
            if !is_ended && !at_end && len < MAX_LINE_LEN && !self.within {
                break;
            }
            let is_short = !self.within && len < MAX_LINE_LEN;
            let bytes = is_short.then(|| trimmed(&rest[mark..len]));
            let bytes = bytes.filter(|bytes| is_ended || bytes.is_empty());
            let next = at + len + usize::from(is_ended);
            line(Line { at: at + mark, next, bytes });
            self.is_begun = true;
            self.within = !is_ended;
            at = next;
        }
        at
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_the_same_in_any_blocks() {
        let endless = "x".repeat(MAX_LINE_LEN + 10);
        let log = format!("one\n\n two \r\n{endless}\nthree\n{endless}");
        let wanted = ["one", "", " two", "three"];
        for block in [1, 7, 100, 70_000, 1 << 20] {
            let (mut lines, mut start, mut end) = (Lines::default(), 0, 0);
            let (mut found, mut bad) = (Vec::new(), 0);
            while start < log.len() {
                let at_end = end == log.len();
                end = (end + block).min(log.len());
                start += lines.each(&log.as_bytes()[start..end], at_end, |line| match line.bytes {
                    Some(bytes) => found.push(String::from_utf8_lossy(bytes).into_owned()),
                    None => bad += line.next - line.at,
                });
            }
            assert_eq!(found, wanted, "blocks of {block}");
            assert_eq!(bad, 2 * endless.len() + 1);
        }
    }
}
