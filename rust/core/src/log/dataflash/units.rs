//! Units of the fields, and the field that tells instances apart: UNIT, MULT and FMTU records.

use std::collections::BTreeMap;

use super::layout::Layout;

/// The id of the unit that marks the instance field.
const INSTANCE: char = '#';

/// Units and multipliers by their ids, and the ids of each type's fields.
#[derive(Debug, Clone, Default)]
pub struct Units {
    /// Ids of units and their labels, in the order of the log.
    pub labels: Vec<(char, String)>,
    /// Ids of multipliers and their factors, in the order of the log.
    pub multipliers: Vec<(char, f64)>,
    /// Type -> ids of units, ids of multipliers; a character for each field.
    pub fields: BTreeMap<u8, (String, String)>,
}

impl PartialEq for Units {
    fn eq(&self, other: &Self) -> bool {
        self.labels == other.labels && self.fields == other.fields && self.scales_like(other)
    }
}

/// Bytes of a unit at most: those of a binary record. Each column that is measured in it has a copy.
const MAX_LABEL_LEN: usize = 64;

impl Units {
    /// Whether the multipliers are the same; a NaN, which a log may have for one, is the same as itself.
    pub fn scales_like(&self, other: &Self) -> bool {
        let bits = |&(id, factor): &(char, f64)| (id, factor.to_bits());
        self.multipliers.iter().map(bits).eq(other.multipliers.iter().map(bits))
    }

    /// Takes in a record of any type. `value` gives its values as text by the names of the columns. Returns the type about whose
    /// fields the record says something new.
    pub fn add(&mut self, name: &str, value: impl Fn(&str) -> Option<String>) -> Option<u8> {
        let id = || Some(char::from(value("Id")?.trim().parse::<u8>().ok()?));
        match name {
            "UNIT" => {
                put(
                    &mut self.labels,
                    id().zip(value("Label").filter(|label| label.len() <= MAX_LABEL_LEN)),
                );
                None
            }
            "MULT" => {
                let factor = value("Mult").and_then(|factor| factor.trim().parse().ok());
                put(&mut self.multipliers, id().zip(factor.map(single_digits)));
                None
            }
            "FMTU" => self.add_fields(value),
            _ => None,
        }
    }

    fn add_fields(&mut self, value: impl Fn(&str) -> Option<String>) -> Option<u8> {
        let type_id = value("FmtType")?.trim().parse().ok()?;
        let ids = (value("UnitIds")?, value("MultIds")?);
        if self.fields.get(&type_id) == Some(&ids) {
            return None;
        }
        self.fields.insert(type_id, ids);
        Some(type_id)
    }

    /// Index of the field that tells the instances of a type apart.
    pub fn instance_field(&self, layout: &Layout) -> Option<usize> {
        let (ids, _) = self.fields.get(&layout.type_id)?;
        ids.chars().position(|id| id == INSTANCE).filter(|&index| index < layout.fields.len())
    }
}

/// A factor with the digits that single precision has. ArduPilot 4.7 writes 0.001 as 0.0010000000474974513.
fn single_digits(factor: f64) -> f64 {
    format!("{factor:.6e}").parse().unwrap_or(factor)
}

/// Adds an entry, or renews the one with its id. There are at most 256 ids.
fn put<T>(entries: &mut Vec<(char, T)>, entry: Option<(char, T)>) {
    let Some((id, value)) = entry else { return };
    match entries.iter_mut().find(|(known, _)| *known == id) {
        Some(known) => known.1 = value,
        None => entries.push((id, value)),
    }
}
