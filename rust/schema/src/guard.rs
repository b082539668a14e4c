//! A look over the raw XML before a tree is built from it. The XML reader keeps every node and compares each attribute
//! with its neighbours, so a hostile text could cost memory and quadratic time; one linear pass over the bytes bounds
//! size, depth, attributes and namespaces, and refuses document types (entities) with their position. Text that is
//! merely malformed passes: the XML reader says what is wrong with it.

use crate::error::Reason;
use crate::limits::{MAX_ATTRIBUTES, MAX_DEPTH, MAX_NAMESPACES};

/// A reason and the byte position it was found at.
pub(crate) type Refusal = (usize, Reason);

/// Checks `text`, whose size is already bounded. O(n), no allocation.
pub(crate) fn check(text: &str) -> Result<(), Refusal> {
    if let Some((position, _)) = text.match_indices("xmlns").nth(MAX_NAMESPACES) {
        return Err((position, Reason::TooMany { what: "namespaces", limit: MAX_NAMESPACES }));
    }
    let bytes = text.as_bytes();
    let mut depth = 0_usize;
    let mut position = 0;
    while let Some(start) = find(text, position, "<") {
        let Some((end, step)) = tag(text, bytes, start)? else { return Ok(()) };
        match step {
            Step::In if depth == MAX_DEPTH => {
                return Err((start, Reason::TooDeep { limit: MAX_DEPTH }));
            }
            Step::In => depth += 1,
            Step::Out => depth = depth.saturating_sub(1),
            Step::Stay => {}
        }
        position = end;
    }
    Ok(())
}

/// How a piece of markup changes the depth.
enum Step {
    In,
    Out,
    Stay,
}

/// The markup starting at `start`: where it ends and what it does to the depth; `None` where it does not end.
fn tag(text: &str, bytes: &[u8], start: usize) -> Result<Option<(usize, Step)>, Refusal> {
    let rest = &bytes[start..];
    let skip_to = |terminator: &str| find(text, start, terminator).map(|at| at + terminator.len());
    if rest.starts_with(b"<!--") {
        // `<!-->` is no comment: the end may not overlap the beginning.
        return Ok(find(text, start + 4, "-->").map(|at| (at + 3, Step::Stay)));
    }
    if rest.starts_with(b"<![CDATA[") {
        return Ok(skip_to("]]>").map(|end| (end, Step::Stay)));
    }
    if rest.starts_with(b"<!") {
        return Err((start, Reason::DocumentType));
    }
    if rest.starts_with(b"<?") {
        return Ok(skip_to("?>").map(|end| (end, Step::Stay)));
    }
    if rest.starts_with(b"</") {
        return Ok(skip_to(">").map(|end| (end, Step::Out)));
    }
    start_tag(bytes, start)
}

/// A start tag: quoted values may contain `>`, and each counts as an attribute.
fn start_tag(bytes: &[u8], start: usize) -> Result<Option<(usize, Step)>, Refusal> {
    let mut quote = None;
    let mut attributes = 0;
    for (offset, &byte) in bytes[start..].iter().enumerate() {
        match (quote, byte) {
            (Some(open), _) if byte == open => quote = None,
            (None, b'"' | b'\'') => {
                attributes += 1;
                if attributes > MAX_ATTRIBUTES {
                    let reason = Reason::TooMany { what: "attributes", limit: MAX_ATTRIBUTES };
                    return Err((start, reason));
                }
                quote = Some(byte);
            }
            (None, b'>') => {
                let closed = bytes[start + offset - 1] == b'/';
                return Ok(Some((start + offset + 1, if closed { Step::Stay } else { Step::In })));
            }
            _ => {}
        }
    }
    Ok(None)
}

/// Byte position of `needle` at or after `from`.
fn find(text: &str, from: usize, needle: &str) -> Option<usize> {
    text.get(from..)?.find(needle).map(|at| from + at)
}
