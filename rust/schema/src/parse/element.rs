//! Helpers that reading any element needs: attributes, texts, names and errors with positions.

use roxmltree::Node;

use crate::definitions::{Deprecation, Status};
use crate::error::{Reason, SchemaError, excerpt};
use crate::limits::MAX_NAME_LEN;
use crate::parse::{ParseOptions, Rules};

/// A file being read: its name, its line starts, and what to keep.
pub(crate) struct Source<'a> {
    name: &'a str,
    text: &'a str,
    line_starts: Vec<usize>,
    keep_descriptions: bool,
    rules: Rules,
}

impl<'a> Source<'a> {
    pub(crate) fn new(name: &'a str, text: &'a str, options: &ParseOptions) -> Self {
        let breaks = text.bytes().enumerate().filter(|&(_, byte)| byte == b'\n');
        let line_starts = std::iter::once(0).chain(breaks.map(|(at, _)| at + 1)).collect();
        let ParseOptions { keep_descriptions, rules, .. } = *options;
        Self { name, text, line_starts, keep_descriptions, rules }
    }

    pub(super) fn name(&self) -> &'a str {
        self.name
    }

    pub(super) fn text(&self) -> &'a str {
        self.text
    }

    /// The result, or `value` in place of an error that `mavparse` does not see.
    pub(super) fn tolerate<T>(
        &self,
        node: Node<'_, '_>,
        result: Result<T, Reason>,
        value: T,
    ) -> Result<T, SchemaError> {
        match result {
            Err(_) if self.rules == Rules::Mavparse => Ok(value),
            result => result.map_err(|reason| self.error(node, reason)),
        }
    }

    /// Line of an element, from 1.
    pub(super) fn line(&self, node: Node<'_, '_>) -> u32 {
        self.line_at(node.range().start)
    }

    fn line_at(&self, position: usize) -> u32 {
        self.line_starts.partition_point(|&start| start <= position) as u32
    }

    pub(crate) fn error(&self, node: Node<'_, '_>, reason: Reason) -> SchemaError {
        self.error_at(node.range().start, reason)
    }

    pub(super) fn error_at(&self, position: usize, reason: Reason) -> SchemaError {
        let line = self.line_at(position);
        let start = self.line_starts[line as usize - 1];
        let column = self.text.get(start..position).map_or(0, |before| before.chars().count() + 1);
        SchemaError::at(self.name, line, column as u32, reason)
    }

    /// Refuses an element that has no place in `parent`.
    pub(super) fn unexpected(
        &self,
        node: Node<'_, '_>,
        parent: &'static str,
    ) -> Result<(), SchemaError> {
        if self.rules != Rules::Dialect {
            return Ok(());
        }
        let element = excerpt(node.tag_name().name());
        Err(self.error(node, Reason::UnexpectedElement { element, parent }))
    }

    /// The element's own text where descriptions are kept, else nothing.
    pub(super) fn description(&self, node: Node<'_, '_>) -> String {
        if self.keep_descriptions { own_text(node) } else { String::new() }
    }

    /// The `name` attribute, checked to be an identifier.
    pub(super) fn identifier(&self, node: Node<'_, '_>) -> Result<String, SchemaError> {
        let name = self.required(node, "name")?;
        let first_is_digit = name.starts_with(|first: char| first.is_ascii_digit());
        let is_word = name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
        if name.is_empty() || first_is_digit || !is_word || name.len() > MAX_NAME_LEN {
            let invalid = Err(Reason::InvalidName(excerpt(name)));
            return self.tolerate(node, invalid, name.to_owned());
        }
        Ok(name.to_owned())
    }

    /// The `name` of a field or of an enum entry, as `check` allows it.
    pub(super) fn variable(
        &self,
        node: Node<'_, '_>,
        check: fn(&str) -> Result<(), Reason>,
    ) -> Result<String, SchemaError> {
        let name = self.identifier(node)?;
        self.tolerate(node, check(&name), ())?;
        Ok(name)
    }

    pub(super) fn required<'n>(
        &self,
        node: Node<'n, '_>,
        attribute: &'static str,
    ) -> Result<&'n str, SchemaError> {
        node.attribute(attribute)
            .ok_or_else(|| self.error(node, Reason::MissingAttribute(attribute)))
    }

    /// Reads `<wip>`, `<deprecated>` and `<superseded>`; false where `node` is none of them.
    pub(super) fn status(&self, node: Node<'_, '_>, status: &mut Status) -> bool {
        match node.tag_name().name() {
            "wip" => status.wip = true,
            "deprecated" => {
                status.deprecated.get_or_insert_with(|| Box::new(self.deprecation(node)));
            }
            "superseded" => status.superseded = Some(Box::new(self.deprecation(node))),
            _ => return false,
        }
        true
    }

    fn deprecation(&self, node: Node<'_, '_>) -> Deprecation {
        Deprecation {
            since: optional(node, "since").unwrap_or_default(),
            replaced_by: optional(node, "replaced_by").unwrap_or_default(),
            explanation: self.description(node),
        }
    }
}

/// A boolean attribute; absent is false.
pub(super) fn boolean(node: Node<'_, '_>, what: &'static str) -> Result<bool, Reason> {
    match node.attribute(what).map(str::trim) {
        None | Some("" | "false" | "0" | "False") => Ok(false),
        Some("true" | "1" | "True") => Ok(true),
        Some(text) => Err(Reason::InvalidBoolean { what, text: excerpt(text) }),
    }
}

/// The element's own text, without that of elements in it.
pub(crate) fn own_text(node: Node<'_, '_>) -> String {
    node.children().filter(Node::is_text).filter_map(|child| child.text()).collect()
}

/// An attribute's value; an empty one counts as absent.
pub(super) fn optional(node: Node<'_, '_>, attribute: &str) -> Option<String> {
    node.attribute(attribute).filter(|value| !value.is_empty()).map(str::to_owned)
}
