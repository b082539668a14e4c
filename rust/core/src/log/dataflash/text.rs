//! The text form of a dataflash log: a line for each record, `NAME, VALUE, VALUE`.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use super::definitions::MAX_DEFINITIONS;
use super::field::FieldKind;
use super::layout::{Layout, LayoutError, split_columns};

/// Bytes of the longest line that can be a record.
pub const MAX_LINE_LEN: usize = 64 * 1024;

/// The values of a FMT line; the last are the names of its columns, which have commas between them.
const FMT_FIELDS: usize = 5;

/// The separator of values in a text log: a comma and a space, or a comma alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Delimiter {
    /// `, `
    CommaSpace,
    /// `,`
    Comma,
}

impl Delimiter {
    /// The delimiter of the first FMT line in the head of a log.
    pub fn of(head: &[u8]) -> Self {
        let first = memchr::memmem::find(head, b"FMT,").and_then(|at| head.get(at + 4));
        if first.is_none_or(|&byte| byte == b' ') { Self::CommaSpace } else { Self::Comma }
    }

    /// The delimiter itself.
    pub fn text(self) -> &'static str {
        match self {
            Self::CommaSpace => ", ",
            Self::Comma => ",",
        }
    }
}

/// A line as text: UTF-8, or Latin-1 where it is none.
pub fn decode_line(line: &[u8]) -> String {
    match std::str::from_utf8(line) {
        Ok(text) => text.to_owned(),
        Err(_) => line.iter().copied().map(char::from).collect(),
    }
}

/// Columns of a type at most: no binary record has room for more.
const MAX_COLUMNS: usize = 255;

/// Bytes of a type's name at most; binary logs have 4.
const MAX_NAME_LEN: usize = 64;

/// Bytes of the names of all columns of a type at most; binary logs have 64.
const MAX_COLUMN_NAMES_LEN: usize = 16 * MAX_COLUMNS;

/// Bytes of UTF-8's byte order mark in front of a line, which Windows programs put at the start of a text.
pub fn mark_len(line: &[u8]) -> usize {
    const MARK: &[u8] = b"\xEF\xBB\xBF";
    if line.starts_with(MARK) { MARK.len() } else { 0 }
}

/// A line without the white space at its end.
///
/// The delimiter behind `FMT, 10, 3, STRT, ` or behind a name alone stays: the types of such lines have no fields.
pub fn trimmed(line: &[u8]) -> &[u8] {
    let end = line.iter().rposition(|byte| !byte.is_ascii_whitespace());
    let end = end.map_or(0, |end| end + 1);
    let (text, space) = line.split_at(end);
    let keeps_delimiter = text.ends_with(b",")
        && space.starts_with(b" ")
        && (text.starts_with(b"FMT,") || memchr::memchr(b',', text) == Some(end - 1));
    &line[..end + usize::from(keeps_delimiter)]
}

/// Where the values of a line stand, behind its name.
///
/// The last column of FMT has the rest of the line.
fn value_places(
    line: &[u8],
    delimiter: Delimiter,
    name: &str,
) -> impl Iterator<Item = Range<usize>> {
    let separator = delimiter.text().as_bytes();
    let most = if name == "FMT" { FMT_FIELDS } else { usize::MAX };
    let mut found = memchr::memmem::find_iter(line, separator);
    let mut start = found.next().map(|at| at + separator.len());
    (1..=most).map_while(move |number| {
        let from = start?;
        let end = if number == most { None } else { found.next() };
        start = end.map(|at| at + separator.len());
        Some(from..end.unwrap_or(line.len()))
    })
}

/// The values of a line.
pub fn values<'a>(line: &'a [u8], delimiter: Delimiter, name: &str) -> Vec<&'a [u8]> {
    value_places(line, delimiter, name).map(|place| &line[place]).collect()
}

/// The values of a line that is text.
pub fn text_values<'a>(line: &'a str, delimiter: Delimiter, name: &str) -> Vec<&'a str> {
    value_places(line.as_bytes(), delimiter, name).map(|place| &line[place]).collect()
}

/// The value at `index` among those of a line.
pub fn value_at<'a>(
    line: &'a [u8],
    delimiter: Delimiter,
    name: &str,
    index: usize,
) -> Option<&'a [u8]> {
    value_places(line, delimiter, name).nth(index).map(|place| &line[place])
}

/// The name in front of a line.
pub fn name(line: &[u8], delimiter: Delimiter) -> &[u8] {
    let end = memchr::memmem::find(line, delimiter.text().as_bytes());
    &line[..end.unwrap_or(line.len())]
}

/// The value at `index` of a line's values, with the spaces around it.
#[inline]
pub fn nth_value(line: &[u8], delimiter: Delimiter, index: usize) -> Option<&[u8]> {
    value_at(line, delimiter, "", index)
}

/// The number in a value of a field of some kind; `None` for what is none of that kind, such as a fraction among integers.
pub fn number(kind: FieldKind, value: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(value).ok()?.trim();
    match kind {
        FieldKind::Text(_) | FieldKind::Array | FieldKind::Mode => None,
        kind if kind.is_float() => text.parse().ok(),
        _ => {
            let digits = text.strip_prefix(['+', '-']).unwrap_or(text);
            digits.bytes().all(|digit| digit.is_ascii_digit()).then(|| text.parse().ok())?
        }
    }
}

/// Reads a FMT line.
///
/// # Errors
/// [`LayoutError`] names the first fault of the description.
pub fn layout(line: &str, delimiter: Delimiter) -> Result<Layout, LayoutError> {
    let values = text_values(line, delimiter, "FMT");
    let &[type_id, len, name, format, columns] = values.as_slice() else {
        return Err(LayoutError::Malformed);
    };
    let number = |text: &str| text.trim().parse::<u8>().map_err(|_| LayoutError::Malformed);
    let (type_id, len) = (number(type_id)?, number(len)?);
    if name.is_empty() || name.len() > MAX_NAME_LEN || columns.len() > MAX_COLUMN_NAMES_LEN {
        return Err(LayoutError::Malformed);
    }
    if name == "FMT" {
        return Ok(Layout::of_fmt());
    }
    // The length is that of the binary record; here it binds nothing.
    let columns = split_columns(columns);
    if columns.len() > MAX_COLUMNS {
        return Err(LayoutError::Malformed);
    }
    let mut layout = Layout::new(type_id, 0, name.to_owned(), format.to_owned(), columns)?;
    layout.len = len;
    Ok(layout)
}

/// The layouts of a text log, by name and place.
#[derive(Debug, Clone)]
pub struct TextDefinitions {
    delimiter: Delimiter,
    layouts: Vec<Arc<Layout>>,
    /// Name -> offsets from which layouts hold, and their indices, in the order of the log.
    by_name: HashMap<Vec<u8>, Vec<(u64, u16)>>,
}

impl TextDefinitions {
    /// Only what every log has: the layout of FMT itself.
    pub fn new(delimiter: Delimiter) -> Self {
        let mut new = Self { delimiter, layouts: Vec::new(), by_name: HashMap::new() };
        new.add(Layout::of_fmt(), 0);
        new
    }

    /// Takes in the line at `offset`, if it is a FMT line.
    pub fn collect(&mut self, line: &[u8], offset: u64) {
        if line.starts_with(b"FMT,")
            && let Ok(layout) = layout(&decode_line(trimmed(line)), self.delimiter)
        {
            self.add(layout, offset);
        }
    }

    fn add(&mut self, layout: Layout, offset: u64) {
        let known = self.by_name.get(layout.name.as_bytes()).and_then(|places| places.last());
        let known = known.map(|&(_, index)| &self.layouts[usize::from(index)]);
        if known.is_some_and(|known| **known == layout) || self.layouts.len() >= MAX_DEFINITIONS {
            return;
        }
        let places = self.by_name.entry(layout.name.as_bytes().to_vec()).or_default();
        let from = if places.is_empty() { 0 } else { offset };
        places.push((from, self.layouts.len() as u16));
        self.layouts.push(Arc::new(layout));
    }

    /// The separator of values in this log.
    pub fn delimiter(&self) -> Delimiter {
        self.delimiter
    }

    /// The layouts of the records.
    pub fn layouts(&self) -> &[Arc<Layout>] {
        &self.layouts
    }

    /// Index of the layout of a line that has all the values it should have.
    #[inline]
    pub fn of_line(&self, line: &[u8], offset: u64) -> Option<u16> {
        let places = self.by_name.get(name(line, self.delimiter))?;
        let behind = places.partition_point(|(from, _)| *from <= offset);
        let (_, index) = places.get(behind.checked_sub(1)?)?;
        let fields = self.layouts.get(usize::from(*index))?.columns.len();
        let complete = fields == 0 || nth_value(line, self.delimiter, fields - 1).is_some();
        complete.then_some(*index)
    }
}
