//! One error type for everything that can be wrong with definitions: which file, where in it, in which message or enum,
//! and a typed reason. It prints as one line that an editor can jump to:
//! `my.xml:12:5: message FOO: field bar: unknown type 'uint9_t'`.

use std::fmt;

/// Why a definition was refused, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SchemaError(Box<Details>);

#[derive(Debug, Clone, PartialEq, Eq)]
struct Details {
    file: String,
    line: u32,
    column: u32,
    context: Vec<String>,
    reason: Reason,
}

impl SchemaError {
    /// An error about a file as a whole.
    pub fn new(file: &str, reason: Reason) -> Self {
        Self::at(file, 0, 0, reason)
    }

    /// An error at a line and column, both from 1; 0 where they are not known.
    pub fn at(file: &str, line: u32, column: u32, reason: Reason) -> Self {
        Self(Box::new(Details { file: file_name(file), line, column, context: Vec::new(), reason }))
    }

    /// The same error, known to be inside `outer`, such as `message FOO`.
    #[must_use]
    pub fn within(mut self, outer: impl Into<String>) -> Self {
        self.0.context.push(outer.into());
        self
    }

    /// File the error is in, with its `.xml`.
    pub fn file(&self) -> &str {
        &self.0.file
    }

    /// Line from 1; 0 where the error is about the whole file.
    pub fn line(&self) -> u32 {
        self.0.line
    }

    /// Column in characters from 1; 0 where it is not known.
    pub fn column(&self) -> u32 {
        self.0.column
    }

    /// The fault in the definition.
    pub fn reason(&self) -> &Reason {
        &self.0.reason
    }
}

impl std::error::Error for SchemaError {}

impl fmt::Display for SchemaError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Details { file, line, column, context, reason } = &*self.0;
        write!(f, "{file}:")?;
        if *line > 0 {
            write!(f, "{line}:")?;
        }
        if *column > 0 {
            write!(f, "{column}:")?;
        }
        for outer in context.iter().rev() {
            write!(f, " {outer}:")?;
        }
        write!(f, " {reason}")
    }
}

/// `name` with `.xml` if it has no suffix, so that errors name a file whether the caller gave a path or a dialect's name.
fn file_name(name: &str) -> String {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    if file.contains('.') { name.to_owned() } else { format!("{name}.xml") }
}

/// `text` as an error shows it: a hostile attribute may have megabytes.
pub(crate) fn excerpt(text: &str) -> String {
    match text.char_indices().nth(EXCERPT_LEN) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

/// Characters of a text that an error shows.
const EXCERPT_LEN: usize = 80;

/// A fault in a definition.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "each variant's message is its documentation")]
pub enum Reason {
    #[error("{size} bytes of XML; at most {limit} are read")]
    TooLarge { size: usize, limit: usize },
    #[error("the file is empty")]
    Empty,
    #[error("a document type declaration (<!DOCTYPE>) has no place in definitions: remove it")]
    DocumentType,
    #[error("elements nested deeper than {limit} levels")]
    TooDeep { limit: usize },
    #[error("more than {limit} {what}")]
    TooMany { what: &'static str, limit: usize },
    #[error("not well-formed XML: {0}")]
    Xml(String),
    #[error("the root element is <{0}>, not <mavlink>")]
    NotMavlink(String),
    #[error("unexpected element <{element}> in <{parent}>")]
    UnexpectedElement { element: String, parent: &'static str },
    #[error("attribute '{0}' is missing")]
    MissingAttribute(&'static str),
    #[error("{0:?} is not a name: letters, digits and underscores are, up to 128, no digit first")]
    InvalidName(String),
    #[error("include '{0}' is not the path of a file")]
    InvalidPath(String),
    #[error("'{name}' is {why}")]
    ReservedName { name: String, why: &'static str },
    #[error("{what} '{text}' is not a number from {min} to {max}")]
    InvalidNumber { what: &'static str, text: String, min: i128, max: i128 },
    #[error("value '{0}' is not a number of 64 bits: write it as 10, 0x0A, 0b1010, 2**3 or 1<<3")]
    InvalidValue(String),
    #[error("{0}")]
    Schema(String),
    #[error("{what} '{text}' is neither true nor false")]
    InvalidBoolean { what: &'static str, text: String },
    #[error("unknown type '{0}'")]
    UnknownType(String),
    #[error("array length '{0}' is not from 1 to 255")]
    ArrayLength(String),
    #[error("no fields")]
    NoFields,
    #[error("no entries")]
    NoEntries,
    #[error("payload of {0} bytes; at most 255 fit a frame")]
    PayloadTooLong(usize),
    #[error("duplicate field")]
    DuplicateField,
    #[error("id {id} is already used by {other}")]
    DuplicateMessageId { id: u32, other: String },
    #[error("the name is already used by {other}")]
    DuplicateMessageName { other: String },
    #[error("the name is already used by {other}")]
    DuplicateEntryName { other: String },
    #[error("value {value} is already used by {other}")]
    DuplicateEntryValue { value: i128, other: String },
    #[error("no value is left above {0}")]
    NoValueLeft(i128),
    #[error("enum {0} is not defined")]
    UnknownEnum(String),
    #[error("no such definitions")]
    NotFound,
    #[error("include '{0}': no such definitions")]
    IncludeNotFound(String),
    #[error("include '{include}': more than {limit} levels of includes")]
    IncludeTooDeep { include: String, limit: usize },
    #[error("includes itself: {0}")]
    IncludeCycle(String),
    #[error("cannot be read: {0}")]
    Unreadable(String),
    #[error("the built-in definitions are damaged: {0}")]
    Blob(String),
}
