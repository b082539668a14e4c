//! The records of a piece of a log by table, their bytes side by side.
//!
//! A gather for each field goes over the records of one table, which in the log are far apart: fetching them from memory
//! table by table took a third of the time that a log takes. So they are copied once, in the order of the log.

use std::ops::Range;
use std::vec::IntoIter;

/// Records of a piece: few enough to stay in the second cache, enough for most tables to have some.
pub(crate) const PIECE: usize = 8192;

/// Bytes of rows that are made of a block in one go. A block of very short records may make hundreds of times its own size.
const PORTION: usize = 32 << 20;

/// The ranges of parts of a block that are taken in one after the other; `rows_len` says how many bytes of rows a part has.
pub(crate) fn portions<T>(parts: &[T], rows_len: impl Fn(&T) -> usize) -> Vec<Range<usize>> {
    let (mut portions, mut bytes) = (Vec::new(), 0);
    let mut first = 0;
    for (number, part) in parts.iter().enumerate() {
        let more = rows_len(part);
        if number > first && bytes + more > PORTION {
            portions.push(first..number);
            (first, bytes) = (number, 0);
        }
        bytes += more;
    }
    if first < parts.len() {
        portions.push(first..parts.len());
    }
    portions
}

/// The rest of a block of which one portion was taken in. The batches of that portion come first.
pub(crate) struct Rest<T> {
    pub(crate) block: Vec<u8>,
    /// Where its records are.
    pub(crate) found: T,
    pub(crate) portions: IntoIter<Range<usize>>,
    /// The share of the log that is consumed behind the block.
    pub(crate) done: f64,
}

impl<T> Rest<T> {
    /// A copy of the block, if there is anything left of it.
    pub(crate) fn of(
        block: &[u8],
        found: T,
        portions: IntoIter<Range<usize>>,
        done: f64,
    ) -> Option<Self> {
        (portions.len() > 0).then(|| Self { block: block.to_vec(), found, portions, done })
    }
}

/// A record on its way to its table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Chosen {
    /// Index of the table.
    pub(crate) table: u16,
    /// Which kind of record of the table it is.
    pub(crate) kind: u16,
    /// Where it starts.
    pub(crate) at: u32,
    /// Microseconds since 1970, or [`crate::gather::NO_TIME`].
    pub(crate) time: i64,
}

/// The records of one table in a piece.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Side<'a> {
    pub(crate) times: &'a [i64],
    pub(crate) kinds: &'a [u16],
    /// `stride` bytes for each.
    pub(crate) bytes: &'a [u8],
    pub(crate) stride: usize,
}

/// The sorted records of a piece; used again and again, since fresh memory is dear.
#[derive(Debug, Default)]
pub(crate) struct RowBlock {
    chosen: Vec<Chosen>,
    spans: Vec<Span>,
    times: Vec<i64>,
    kinds: Vec<u16>,
    bytes: Vec<u8>,
}

/// Where the rows of a table are in a piece.
#[derive(Debug, Clone, Copy, Default)]
struct Span {
    first_row: u32,
    rows: u32,
    first_byte: usize,
    stride: usize,
}

impl RowBlock {
    /// Replaces the content. `strides` are the bytes of a row by table; `fill` makes a row of a record. Bytes that it
    /// does not write are left from earlier rows.
    pub(crate) fn sort(
        &mut self,
        chosen: impl Iterator<Item = Chosen>,
        strides: &[usize],
        fill: impl Fn(Chosen, &mut [u8]),
    ) {
        self.take_in(chosen, strides);
        self.lay_out();
        let Self { chosen, spans, times, kinds, bytes } = self;
        for &record in &*chosen {
            let span = &mut spans[usize::from(record.table)];
            let row = (span.first_row + span.rows) as usize;
            (times[row], kinds[row]) = (record.time, record.kind);
            let start = span.first_byte + span.rows as usize * span.stride;
            fill(record, &mut bytes[start..start + span.stride]);
            span.rows += 1;
        }
    }

    /// Counts the rows of each table.
    fn take_in(&mut self, records: impl Iterator<Item = Chosen>, strides: &[usize]) {
        let Self { chosen, spans, .. } = self;
        chosen.clear();
        spans.clear();
        spans.extend(strides.iter().map(|&stride| Span { stride, ..Span::default() }));
        // Not `extend`: records would go through memory in parts and be read again as a whole, which stalls.
        records.for_each(|record| {
            spans[usize::from(record.table)].rows += 1;
            chosen.push(record);
        });
    }

    /// Gives each table its room.
    fn lay_out(&mut self) {
        let Self { chosen, spans, times, kinds, bytes } = self;
        let (mut row, mut byte) = (0, 0);
        for span in &mut *spans {
            (span.first_row, span.first_byte) = (row, byte);
            row += span.rows;
            byte += span.rows as usize * span.stride;
            span.rows = 0;
        }
        times.resize(chosen.len(), 0);
        kinds.resize(chosen.len(), 0);
        bytes.resize(byte, 0);
    }

    /// How many records of a table there are.
    pub(crate) fn rows(&self, table: usize) -> usize {
        self.spans[table].rows as usize
    }

    /// The records of a table.
    pub(crate) fn of(&self, table: usize) -> Side<'_> {
        let Span { first_row, rows, first_byte, stride } = self.spans[table];
        let first = first_row as usize;
        let range = first..first + rows as usize;
        let bytes = &self.bytes[first_byte..first_byte + range.len() * stride];
        Side { times: &self.times[range.clone()], kinds: &self.kinds[range], bytes, stride }
    }
}

impl<'a> Side<'a> {
    /// Some of the records.
    pub(crate) fn slice(self, rows: Range<usize>) -> Self {
        Self {
            times: &self.times[rows.clone()],
            kinds: &self.kinds[rows.clone()],
            bytes: &self.bytes[rows.start * self.stride..rows.end * self.stride],
            stride: self.stride,
        }
    }

    /// The same in groups of at most so many rows.
    pub(crate) fn groups(self, most: usize) -> impl Iterator<Item = Side<'a>> {
        let rows = self.times.len();
        (0..rows).step_by(most).map(move |first| self.slice(first..rows.min(first + most)))
    }

    /// The same in runs of one kind.
    pub(crate) fn runs(self) -> impl Iterator<Item = Side<'a>> {
        let mut first = 0;
        self.kinds.chunk_by(|one, other| one == other).map(move |run| {
            first += run.len();
            self.slice(first - run.len()..first)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(records: &[(u16, u16)]) -> RowBlock {
        let mut piece = RowBlock::default();
        let chosen = (0_u32..).zip(records);
        let chosen =
            chosen.map(|(at, &(table, kind))| Chosen { table, kind, at, time: 10 * i64::from(at) });
        piece.sort(chosen, &[1, 3, 2], |record, row| {
            row.fill(0);
            row[0] = record.at as u8;
        });
        piece
    }

    #[test]
    fn records_keep_their_order_in_their_table() {
        let piece = sorted(&[(2, 0), (0, 5), (2, 0), (2, 1), (0, 5)]);
        assert_eq!([piece.rows(0), piece.rows(1), piece.rows(2)], [2, 0, 3]);
        let last = piece.of(2);
        assert_eq!((last.times, last.kinds), (&[0, 20, 30][..], &[0, 0, 1][..]));
        assert_eq!(last.bytes, [0, 0, 2, 0, 3, 0]);
        assert_eq!(piece.of(0).bytes, [1, 4]);
        assert!(piece.of(1).times.is_empty());
        let runs: Vec<_> = last.runs().map(|run| (run.times, run.bytes)).collect();
        assert_eq!(runs, [(&[0, 20][..], &[0, 0, 2, 0][..]), (&[30], &[3, 0])]);
        let groups: Vec<_> = last.groups(2).map(|group| group.times.len()).collect();
        assert_eq!(groups, [2, 1]);
    }

    #[test]
    fn a_piece_used_again_has_its_own_rows() {
        let mut piece = sorted(&[(1, 0), (1, 0), (1, 0)]);
        let one = Chosen { table: 1, kind: 0, at: 0, time: 7 };
        piece.sort(std::iter::once(one), &[1, 3, 2], |_, row| row.copy_from_slice(&[4, 5, 6]));
        assert_eq!((piece.of(1).times, piece.of(1).bytes), (&[7][..], &[4, 5, 6][..]));
        assert_eq!(piece.rows(0), 0);
    }
}
