//! XML text to [`Definitions`]: one file, includes unresolved. Everything that can be judged without the other files is
//! checked here, so that an error carries the line and column of its element.

mod element;
mod enums;
mod messages;
mod reserved;

use roxmltree::{Document, Node, ParsingOptions};

use crate::definitions::Definitions;
use crate::error::{Reason, SchemaError, excerpt};
use crate::guard;
use crate::limits::{
    MAX_ENUM_ENTRIES, MAX_FILES, MAX_MESSAGES, MAX_NODES, MAX_PATH_LEN, MAX_TEXT_LEN,
};
use crate::number::parse_decimal;
pub(crate) use element::{Source, own_text};
pub use messages::field_type;

/// The texts to keep, and the most text to accept.
#[derive(Debug, Clone)]
pub struct ParseOptions {
    /// Keep the free text of descriptions and explanations.
    pub keep_descriptions: bool,
    /// Longest text in bytes.
    pub max_text_len: usize,
    /// The rules that the text has to keep.
    pub rules: Rules,
}

/// The rules that a file has to keep.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Rules {
    /// Files that a dialect can be made of.
    #[default]
    Dialect,
    /// The same, but unknown elements are passed over, as [`standalone`](crate::standalone) leaves them out.
    Module,
    /// Files that pymavlink's `mavparse` takes too: unknown elements, any names, messages that fit no frame.
    Mavparse,
}

impl Default for ParseOptions {
    fn default() -> Self {
        Self { keep_descriptions: true, max_text_len: MAX_TEXT_LEN, rules: Rules::Dialect }
    }
}

/// Reads one XML file. `name` is its path or name, with or without `.xml`, as errors shall show it; the base name
/// becomes the name of the definitions. Takes linear time and refuses hostile texts: see the limits.
///
/// # Errors
/// Where the text is too large, not well-formed, has a document type, or breaks a rule of the MAVLink schema.
pub fn parse_definitions(
    name: &str,
    text: &str,
    options: &ParseOptions,
) -> Result<Definitions, SchemaError> {
    if text.len() > options.max_text_len {
        let reason = Reason::TooLarge { size: text.len(), limit: options.max_text_len };
        return Err(SchemaError::new(name, reason));
    }
    let source = Source::new(name, text, options);
    read_root(&source, read_xml(&source)?.root_element())
}

/// The tree of a text, within the limits.
pub(crate) fn read_xml<'a>(source: &Source<'a>) -> Result<Document<'a>, SchemaError> {
    let text = source.text();
    if text.trim_start_matches('\u{feff}').trim().is_empty() {
        return Err(source.error_at(0, Reason::Empty));
    }
    guard::check(text).map_err(|(position, reason)| source.error_at(position, reason))?;
    let parsing = ParsingOptions { nodes_limit: MAX_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, parsing).map_err(|error| xml_error(source.name(), &error))
}

/// The XML reader's complaint. Its texts end with the position, which the error carries already.
fn xml_error(name: &str, error: &roxmltree::Error) -> SchemaError {
    match error {
        roxmltree::Error::DtdDetected => SchemaError::new(name, Reason::DocumentType),
        roxmltree::Error::NodesLimitReached => {
            let limit = MAX_NODES as usize;
            SchemaError::new(name, Reason::TooMany { what: "XML nodes", limit })
        }
        other => {
            let at = other.pos();
            let text = other.to_string();
            let bare = text.strip_suffix(&format!(" at {at}")).unwrap_or(&text);
            SchemaError::at(name, at.row, at.col, Reason::Xml(excerpt(bare)))
        }
    }
}

fn read_root(source: &Source<'_>, root: Node<'_, '_>) -> Result<Definitions, SchemaError> {
    let tag = root.tag_name().name();
    if tag != "mavlink" {
        return Err(source.error(root, Reason::NotMavlink(excerpt(tag))));
    }
    let mut definitions =
        Definitions { name: dialect_name(source.name()).to_owned(), ..Definitions::default() };
    for child in root.children().filter(Node::is_element) {
        match child.tag_name().name() {
            "include" => definitions.includes.push(include(source, child)?),
            "version" => {
                let version = number(child, "version");
                definitions.version = Some(version.map_err(|reason| source.error(child, reason))?);
            }
            "dialect" => {
                let dialect = number(child, "dialect").map(Some);
                definitions.dialect = source.tolerate(child, dialect, None)?;
            }
            "enums" => enums::read_enums(source, child, &mut definitions.enums)?,
            "messages" => messages::read_messages(source, child, &mut definitions.messages)?,
            _ => source.unexpected(child, "mavlink")?,
        }
    }
    check_counts(source, root, &definitions)?;
    Ok(definitions)
}

/// The path of an include.
fn include(source: &Source<'_>, node: Node<'_, '_>) -> Result<String, SchemaError> {
    let path = own_text(node).trim().to_owned();
    let invalid = path.is_empty() || path.len() > MAX_PATH_LEN;
    let checked = if invalid { Err(Reason::InvalidPath(excerpt(&path))) } else { Ok(()) };
    source.tolerate(node, checked, ())?;
    Ok(path)
}

/// A number that is an element's text, as small as `T` demands.
fn number<T: TryFrom<u32>>(node: Node<'_, '_>, what: &'static str) -> Result<T, Reason> {
    let text = own_text(node);
    let max = if size_of::<T>() == 1 { u32::from(u8::MAX) } else { u32::from(u16::MAX) };
    parse_decimal(&text, max).and_then(|value| T::try_from(value).ok()).ok_or_else(|| {
        let text = excerpt(&text);
        Reason::InvalidNumber { what, text, min: 0, max: max.into() }
    })
}

fn check_counts(
    source: &Source<'_>,
    node: Node<'_, '_>,
    definitions: &Definitions,
) -> Result<(), SchemaError> {
    let entries = definitions.enums.iter().map(|definition| definition.entries.len()).sum();
    for (what, count, limit) in [
        ("includes", definitions.includes.len(), MAX_FILES),
        ("messages", definitions.messages.len(), MAX_MESSAGES),
        ("enum entries", entries, MAX_ENUM_ENTRIES),
    ] {
        if count > limit {
            return Err(source.error(node, Reason::TooMany { what, limit }));
        }
    }
    Ok(())
}

/// The name of the dialect of a path: its last component without `.xml`.
///
/// ```
/// assert_eq!(mavwire_schema::dialect_name("../v1.0/common.xml"), "common");
/// ```
pub fn dialect_name(path: &str) -> &str {
    let file = path.rsplit(['/', '\\']).next().unwrap_or(path);
    match file.len().checked_sub(4).and_then(|stem| file.get(stem..).map(|end| (stem, end))) {
        Some((stem, end)) if stem > 0 && end.eq_ignore_ascii_case(".xml") => &file[..stem],
        _ => file,
    }
}
