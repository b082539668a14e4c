//! What reading any element needs: attributes, texts, names and errors with positions.

use roxmltree::Node;

use crate::definitions::{Deprecation, Status};
use crate::error::{Reason, SchemaError, excerpt};
use crate::limits::MAX_NAME_LEN;

/// A file being read: its name, its line starts, and what to keep.
pub(super) struct Source<'a> {
    name: &'a str,
    text: &'a str,
    line_starts: Vec<usize>,
    keep_descriptions: bool,
}

impl<'a> Source<'a> {
    pub(super) fn new(name: &'a str, text: &'a str, keep_descriptions: bool) -> Self {
        let breaks = text.bytes().enumerate().filter(|&(_, byte)| byte == b'\n');
        let line_starts = std::iter::once(0).chain(breaks.map(|(at, _)| at + 1)).collect();
        Self { name, text, line_starts, keep_descriptions }
    }

    pub(super) fn name(&self) -> &'a str {
        self.name
    }

    /// Line of an element, from 1.
    pub(super) fn line(&self, node: Node<'_, '_>) -> u32 {
        self.line_at(node.range().start)
    }

    fn line_at(&self, position: usize) -> u32 {
        self.line_starts.partition_point(|&start| start <= position) as u32
    }

    pub(super) fn error(&self, node: Node<'_, '_>, reason: Reason) -> SchemaError {
        self.error_at(node.range().start, reason)
    }

    pub(super) fn error_at(&self, position: usize, reason: Reason) -> SchemaError {
        let line = self.line_at(position);
        let start = self.line_starts[line as usize - 1];
        let column = self.text.get(start..position).map_or(0, |before| before.chars().count() + 1);
        SchemaError::at(self.name, line, column as u32, reason)
    }

    pub(super) fn unexpected(&self, node: Node<'_, '_>, parent: &'static str) -> SchemaError {
        let element = excerpt(node.tag_name().name());
        self.error(node, Reason::UnexpectedElement { element, parent })
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
            return Err(self.error(node, Reason::InvalidName(excerpt(name))));
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
        check(&name).map_err(|reason| self.error(node, reason))?;
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

    /// A boolean attribute; absent is false.
    pub(super) fn boolean(
        &self,
        node: Node<'_, '_>,
        what: &'static str,
    ) -> Result<bool, SchemaError> {
        match node.attribute(what).map(str::trim) {
            None | Some("" | "false" | "0" | "False") => Ok(false),
            Some("true" | "1" | "True") => Ok(true),
            Some(text) => {
                Err(self.error(node, Reason::InvalidBoolean { what, text: excerpt(text) }))
            }
        }
    }

    /// Reads `<wip>`, `<deprecated>` and `<superseded>`; false where `node` is none of them.
    pub(super) fn status(&self, node: Node<'_, '_>, status: &mut Status) -> bool {
        match node.tag_name().name() {
            "wip" => status.wip = true,
            "deprecated" => status.deprecated = Some(Box::new(self.deprecation(node))),
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

/// The element's own text, without that of elements in it.
pub(super) fn own_text(node: Node<'_, '_>) -> String {
    node.children().filter(Node::is_text).filter_map(|child| child.text()).collect()
}

/// An attribute's value; an empty one counts as absent.
pub(super) fn optional(node: Node<'_, '_>, attribute: &str) -> Option<String> {
    node.attribute(attribute).filter(|value| !value.is_empty()).map(str::to_owned)
}
