//! A definition file for a generated module to carry: nothing but what definitions are made of, and includes by names that
//! the module knows.

use roxmltree::Node;

use crate::check::is_known;
use crate::error::SchemaError;
use crate::parse::{ParseOptions, Source, read_xml};

/// The root element of `text` without comments, processing instructions and unknown elements. The file's includes, in
/// order, get the names `includes`.
///
/// # Errors
/// Where the text is not well-formed XML within the limits.
pub fn standalone(name: &str, text: &str, includes: &[String]) -> Result<String, SchemaError> {
    let source = Source::new(name, text, &ParseOptions::default());
    let document = read_xml(&source)?;
    let root = document.root_element();
    let mut includes = includes.iter();
    let mut result = String::with_capacity(text.len());
    let mut position = root.range().start;
    for node in root.descendants().filter(|node| !node.is_text()) {
        let range = node.range();
        if range.start < position {
            continue; // in an element that is left out
        }
        let name = is_include(node, root).then(|| includes.next()).flatten();
        if name.is_none() && node.is_element() && is_known(node.tag_name().name()) {
            continue;
        }
        result += &text[position..range.start];
        if let Some(name) = name {
            result.extend(["<include>", name, "</include>"]);
        }
        position = range.end;
    }
    Ok(result + &text[position..root.range().end])
}

fn is_include(node: Node<'_, '_>, root: Node<'_, '_>) -> bool {
    node.tag_name().name() == "include" && node.parent() == Some(root)
}
