//! Which files make up a dialect: the main file, then its includes breadth-first, each once. Messages and enums of the
//! dialect are in this order.

use std::collections::{HashMap, VecDeque};

use crate::definitions::Definitions;
use crate::error::{Reason, SchemaError, excerpt};
use crate::limits::{MAX_FILES, MAX_INCLUDE_DEPTH};

/// A file of a dialect and the path it was looked up by, which errors name.
pub(crate) struct File {
    pub(crate) path: String,
    pub(crate) definitions: Definitions,
    depth: usize,
    /// Indices of the files it includes.
    includes: Vec<usize>,
}

/// Answers a path with what that file says.
pub(crate) type Lookup<'a> = dyn FnMut(&str) -> Result<Definitions, SchemaError> + 'a;

/// Looks up `main` and everything it includes. Include texts are relative to the file they stand in, so that `lookup`
/// sees paths relative to the main file.
pub(crate) fn collect(main: &str, lookup: &mut Lookup<'_>) -> Result<Vec<File>, SchemaError> {
    let mut files = vec![File {
        path: main.to_owned(),
        definitions: lookup(main)?,
        depth: 0,
        includes: Vec::new(),
    }];
    let mut known = HashMap::from([(key(main), 0)]);
    let mut unread = VecDeque::from([0]);
    while let Some(parent) = unread.pop_front() {
        for include in files[parent].definitions.includes.clone() {
            let path = join(&files[parent].path, &include);
            let index = if let Some(&index) = known.get(&key(&path)) {
                index
            } else {
                known.insert(key(&path), files.len());
                unread.push_back(files.len());
                let file = read(&files[parent], &include, path, lookup)?;
                files.push(file);
                files.len() - 1
            };
            files[parent].includes.push(index);
        }
        if files.len() > MAX_FILES {
            let reason = Reason::TooMany { what: "files", limit: MAX_FILES };
            return Err(SchemaError::new(main, reason));
        }
    }
    refuse_cycles(&files)?;
    Ok(files)
}

fn read(
    parent: &File,
    include: &str,
    path: String,
    lookup: &mut Lookup<'_>,
) -> Result<File, SchemaError> {
    let include = || excerpt(include);
    if parent.depth == MAX_INCLUDE_DEPTH {
        let reason = Reason::IncludeTooDeep { include: include(), limit: MAX_INCLUDE_DEPTH };
        return Err(SchemaError::new(&parent.path, reason));
    }
    let definitions = lookup(&path).map_err(|error| match error.reason() {
        Reason::NotFound => SchemaError::new(&parent.path, Reason::IncludeNotFound(include())),
        _ => error,
    })?;
    Ok(File { path, definitions, depth: parent.depth + 1, includes: Vec::new() })
}

/// Refuses a file that includes itself, directly or through others: the main file would not be the outermost.
fn refuse_cycles(files: &[File]) -> Result<(), SchemaError> {
    let mut done = vec![false; files.len()];
    visit(files, 0, &mut Vec::new(), &mut done)
}

/// Depth-first; `trail` is the way here from the main file. Recursion is bounded by the number of files.
fn visit(
    files: &[File],
    index: usize,
    trail: &mut Vec<usize>,
    done: &mut [bool],
) -> Result<(), SchemaError> {
    if let Some(start) = trail.iter().position(|&passed| passed == index) {
        let circle = trail[start..].iter().chain([&index]);
        let paths: Vec<&str> = circle.map(|&passed| files[passed].path.as_str()).collect();
        return Err(SchemaError::new(paths[0], Reason::IncludeCycle(paths.join(" -> "))));
    }
    if done[index] {
        return Ok(());
    }
    trail.push(index);
    for &include in &files[index].includes {
        visit(files, include, trail, done)?;
    }
    trail.pop();
    done[index] = true;
    Ok(())
}

/// The key of a file: paths with the same key, like `common` and `common.xml`, are the same file.
fn key(path: &str) -> String {
    path.strip_suffix(".xml").unwrap_or(path).to_owned()
}

/// The include text `include` of the file `parent` as a path from where `parent` is one, `..` and `.` resolved.
fn join(parent: &str, include: &str) -> String {
    let folder = match parent.rfind('/') {
        Some(slash) if !include.starts_with('/') => &parent[..=slash],
        _ => "",
    };
    let mut parts: Vec<&str> = Vec::new();
    let path = format!("{folder}{include}");
    for (position, part) in path.split('/').enumerate() {
        match part {
            "." => {}
            "" if position > 0 => {}
            ".." if parts.last().is_some_and(|&last| last != ".." && !last.is_empty()) => {
                parts.pop();
            }
            _ => parts.push(part),
        }
    }
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::join;

    #[test]
    fn includes_are_relative_to_the_file_they_stand_in() {
        for (parent, include, expected) in [
            ("all", "common.xml", "common.xml"),
            ("my.xml", "sub/a.xml", "sub/a.xml"),
            ("sub/a.xml", "b.xml", "sub/b.xml"),
            ("sub/a.xml", "../b.xml", "b.xml"),
            ("sub/a.xml", "./b.xml", "sub/b.xml"),
            ("/home/me/my.xml", "../b.xml", "/home/b.xml"),
            ("/my.xml", "../../b.xml", "/../../b.xml"),
            ("my.xml", "../../b.xml", "../../b.xml"),
            ("my.xml", "/abs/b.xml", "/abs/b.xml"),
            ("sub//a.xml", "b.xml", "sub/b.xml"),
        ] {
            assert_eq!(join(parent, include), expected, "{include} in {parent}");
        }
    }
}
