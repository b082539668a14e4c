//! Numbers to the names of enum entries.

use std::collections::HashMap;
use std::fmt::Write;
use std::sync::Arc;

use arrow::array::{ArrayRef, DictionaryArray, Int32Array, StringBuilder};
use arrow::buffer::NullBuffer;
use arrow::datatypes::Int32Type;
use mavwire_schema::Enum;

/// The entries of an enum.
#[derive(Debug, Clone)]
pub struct Names {
    bitmask: bool,
    by_value: HashMap<i128, String>,
    /// Entries of single bits, lowest first.
    bits: Vec<(i128, String)>,
    /// As [`mask_len`] says.
    pub(crate) mask_len: usize,
}

/// About how long the text of a value is of which half the bits are set: a log that has each value once makes a column of
/// them. 0 for what is no bit mask, whose texts are few.
pub(crate) fn mask_len(definition: &Enum, bitmask: bool) -> usize {
    if !bitmask && !definition.bitmask {
        return 0;
    }
    let bits = definition.entries.iter().filter(|entry| is_bit(entry.value));
    bits.map(|entry| entry.name.len() + 1).sum::<usize>() / 2
}

fn is_bit(value: i128) -> bool {
    u64::try_from(value).is_ok_and(u64::is_power_of_two)
}

impl Names {
    /// Of an enum; the first of two entries with one value counts.
    pub fn new(definition: &Enum, bitmask: bool) -> Self {
        let mut by_value = HashMap::new();
        for entry in &definition.entries {
            by_value.entry(entry.value).or_insert_with(|| entry.name.clone());
        }
        let mut bits: Vec<_> = by_value
            .iter()
            .filter(|(value, _)| is_bit(**value))
            .map(|(value, name)| (*value, name.clone()))
            .collect();
        bits.sort();
        let mask_len = mask_len(definition, bitmask);
        Self { bitmask: bitmask || definition.bitmask, by_value, bits, mask_len }
    }

    /// The entry with a value, the entries of a bit mask joined by `|`; what has no name is a number.
    pub fn text(&self, value: i128) -> String {
        if let Some(name) = self.by_value.get(&value) {
            return name.clone();
        }
        if !self.bitmask || value <= 0 {
            return value.to_string();
        }
        let (mut left, mut text) = (value, String::new());
        for (bit, name) in self.bits.iter().filter(|(bit, _)| value & bit != 0) {
            left &= !bit;
            text.push_str(if text.is_empty() { "" } else { "|" });
            text.push_str(name);
        }
        if left != 0 {
            let separator = if text.is_empty() { "" } else { "|" };
            let _ = write!(text, "{separator}{left}");
        }
        text
    }

    /// A dictionary column of values.
    pub fn dictionary(
        &self,
        values: impl Iterator<Item = i128>,
        valid: Option<NullBuffer>,
    ) -> ArrayRef {
        let mut keys: HashMap<i128, i32> = HashMap::new();
        let mut texts = StringBuilder::new();
        let keys: Vec<i32> = values
            .enumerate()
            .map(|(row, value)| {
                if valid.as_ref().is_some_and(|valid| valid.is_null(row)) {
                    return 0; // a key without a meaning
                }
                let next = keys.len() as i32;
                *keys.entry(value).or_insert_with(|| {
                    texts.append_value(self.text(value));
                    next
                })
            })
            .collect();
        let keys = Int32Array::new(keys.into(), valid);
        Arc::new(DictionaryArray::<Int32Type>::new(keys, Arc::new(texts.finish())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mavwire_schema::EnumEntry;

    fn names(bitmask: bool) -> Names {
        let entry = |(value, name): (i128, &str)| EnumEntry {
            value,
            name: name.into(),
            ..EnumEntry::default()
        };
        let entries = [(0, "NONE"), (1, "A"), (2, "B"), (8, "D"), (9, "AD")].map(entry).into();
        Names::new(&Enum { entries, bitmask, ..Enum::default() }, false)
    }

    #[test]
    fn unknown_values_keep_their_number() {
        assert_eq!([0, 1, 9, 7, -1].map(|v| names(false).text(v)), ["NONE", "A", "AD", "7", "-1"]);
    }

    #[test]
    fn bit_masks_are_taken_apart() {
        let texts = [0, 3, 9, 11, 20, 4, -2].map(|value| names(true).text(value));
        assert_eq!(texts, ["NONE", "A|B", "AD", "A|B|D", "20", "4", "-2"]);
        assert_eq!(names(true).text(0x13), "A|B|16");
    }
}
