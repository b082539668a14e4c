//! Enums of a dialect. Several files may add entries to an enum of the same name; what the first of them (main file
//! first) says of the enum itself holds.

use std::collections::HashMap;
use std::fmt;
use std::rc::Rc;

use crate::definitions::{Enum, EnumEntry};
use crate::error::{Reason, SchemaError};
use crate::includes::File;
use crate::limits::MAX_ENUM_ENTRIES;
use crate::number::MAX_VALUE;

/// File and line of something, for errors.
#[derive(Debug, Clone)]
pub(crate) struct Place {
    pub(crate) file: Rc<str>,
    pub(crate) line: u32,
}

impl Place {
    pub(crate) fn error(&self, reason: Reason) -> SchemaError {
        SchemaError::at(&self.file, self.line, 0, reason)
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.file, self.line)
    }
}

/// The merged enums, in the order of their first definitions.
#[derive(Default)]
pub(crate) struct EnumMerger {
    enums: Vec<Enum>,
    by_name: HashMap<String, usize>,
}

/// The definitions of one enum with the file of each.
type Parts = Vec<(Rc<str>, Enum)>;

impl EnumMerger {
    /// Takes the enums out of `files` and merges them.
    pub(crate) fn merge(files: &mut [File]) -> Result<Self, SchemaError> {
        let mut merger = Self::default();
        let mut groups: Vec<Parts> = Vec::new();
        let mut entries = 0;
        for file in files {
            let path: Rc<str> = file.path.as_str().into();
            for definition in std::mem::take(&mut file.definitions.enums) {
                entries += definition.entries.len();
                let index = *merger.by_name.entry(definition.name.clone()).or_insert(groups.len());
                if index == groups.len() {
                    groups.push(Vec::new());
                }
                groups[index].push((Rc::clone(&path), definition));
            }
            if entries > MAX_ENUM_ENTRIES {
                let reason = Reason::TooMany { what: "enum entries", limit: MAX_ENUM_ENTRIES };
                return Err(SchemaError::new(&file.path, reason));
            }
        }
        merger.enums = groups.into_iter().map(merge_parts).collect::<Result<_, _>>()?;
        Ok(merger)
    }

    pub(crate) fn is_defined(&self, name: &str) -> bool {
        self.by_name.contains_key(name)
    }

    pub(crate) fn is_bitmask(&self, name: &str) -> bool {
        self.by_name.get(name).is_some_and(|&index| self.enums[index].bitmask)
    }

    pub(crate) fn into_enums(self) -> Vec<Enum> {
        self.enums
    }
}

fn merge_parts(mut parts: Parts) -> Result<Enum, SchemaError> {
    let (file, first) = &mut parts[0];
    let entries = std::mem::take(&mut first.entries);
    let mut merged = std::mem::replace(first, Enum { entries, ..Enum::default() });
    let place = Place { file: Rc::clone(file), line: merged.line };
    let within = |error: SchemaError| error.within(format!("enum {}", merged.name));
    let mut entries = number_entries(parts).map_err(within)?;
    if entries.is_empty() {
        return Err(within(place.error(Reason::NoEntries)));
    }
    refuse_duplicates(&mut entries).map_err(within)?;
    merged.entries = entries.into_iter().map(|(_, entry)| entry).collect();
    Ok(merged)
}

/// All entries with their values. Entries of included files come first.
fn number_entries(parts: Parts) -> Result<Vec<(Place, EnumEntry)>, SchemaError> {
    let mut merged: Option<NumberedPart> = None;
    for (file, definition) in parts {
        let part = NumberedPart::new(&file, definition);
        match &mut merged {
            Some(merged) => merged.extend(part)?,
            None => merged = Some(part),
        }
    }
    Ok(merged.map(|merged| merged.entries).unwrap_or_default())
}

/// The entries of an enum in one file, each with a value. The values are those of pymavlink's generator: the other side uses
/// its modules and headers.
struct NumberedPart {
    entries: Vec<(Place, EnumEntry)>,
    /// Indices of entries that have no value in the definitions. Those of the main file come first.
    automatic: Vec<usize>,
    /// The lowest and the highest value.
    range: (i128, i128),
}

impl NumberedPart {
    fn new(file: &Rc<str>, definition: Enum) -> Self {
        let mut part = Self { entries: Vec::new(), automatic: Vec::new(), range: (i128::MAX, 0) };
        for entry in definition.entries {
            let place = Place { file: Rc::clone(file), line: entry.line };
            if entry.is_automatic {
                part.automatic.push(part.entries.len());
            }
            part.range = (part.range.0.min(entry.value), part.range.1.max(entry.value));
            part.entries.push((place, entry));
        }
        part
    }

    /// Puts the entries of an included file in front.
    fn extend(&mut self, included: Self) -> Result<(), SchemaError> {
        let automatic: Vec<_> = self.automatic.iter().map(|&at| self.entries[at].1.value).collect();
        let moved = number_behind(&automatic, self.range, included.range);
        for (&index, value) in self.automatic.iter().zip(moved) {
            let (place, entry) = &mut self.entries[index];
            entry.value = in_range(place, value)?;
        }
        let count = included.entries.len();
        self.automatic.iter_mut().for_each(|index| *index += count);
        self.automatic.extend(included.automatic);
        self.entries.splice(0..0, included.entries);
        Ok(())
    }
}

/// The values of entries that have none in the definitions, after an included file adds to their enum. They move behind
/// the range of the included file if it overlaps the range of the `own` file.
pub fn number_behind(automatic: &[i128], own: (i128, i128), included: (i128, i128)) -> Vec<i128> {
    let overlaps = own.0 <= included.1 && included.0 <= own.1;
    let mut highest = included.1;
    let moved = automatic.iter().map(|&value| {
        if !overlaps || value > highest {
            return value;
        }
        highest = highest.saturating_add(1);
        highest
    });
    moved.collect()
}

fn in_range(place: &Place, value: i128) -> Result<i128, SchemaError> {
    let error = || place.error(Reason::NoValueLeft(value - 1));
    if value <= MAX_VALUE { Ok(value) } else { Err(error()) }
}

/// Sorts by value and refuses a name or a value that two entries have.
fn refuse_duplicates(entries: &mut [(Place, EnumEntry)]) -> Result<(), SchemaError> {
    let mut names: HashMap<&str, &Place> = HashMap::with_capacity(entries.len());
    for (place, entry) in entries.iter() {
        if let Some(other) = names.insert(&entry.name, place) {
            let reason = Reason::DuplicateEntryName { other: other.to_string() };
            return Err(place.error(reason).within(format!("entry {}", entry.name)));
        }
    }
    entries.sort_by_key(|(_, entry)| entry.value);
    for pair in entries.windows(2) {
        let [(first, one), (second, two)] = pair else { continue };
        if one.value == two.value {
            let other = format!("{} ({first})", one.name);
            let reason = Reason::DuplicateEntryValue { value: two.value, other };
            return Err(second.error(reason).within(format!("entry {}", two.name)));
        }
    }
    Ok(())
}
