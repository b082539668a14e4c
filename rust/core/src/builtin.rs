//! The dialects that come with the crate, as the build script packed them. A file is decoded when a dialect asks for it.

use mavwire_schema::{Definitions, Dialect, Library, SchemaError, WireVersion, decode_blob};
use std::sync::LazyLock;

static HISTORY: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/history.bin"));

static LIBRARY: LazyLock<Library<'static>> = LazyLock::new(|| {
    let blob = include_bytes!(concat!(env!("OUT_DIR"), "/definitions.bin"));
    Library::from_blob(blob).expect("the build script wrote the blob with the same code")
});

/// The dialect with every message of mavlink/mavlink and ArduPilot/mavlink.
pub const UPSTREAM: &str = "upstream";

/// Names of the dialects, sorted.
pub fn names() -> impl Iterator<Item = &'static str> {
    LIBRARY.names()
}

/// A dialect laid out for a wire version. [`UPSTREAM`] knows the layouts that message ids had before.
///
/// # Errors
/// There is no dialect of that name.
pub fn dialect(name: &str, wire_version: WireVersion) -> Result<Dialect, SchemaError> {
    let mut dialect = LIBRARY.resolve(name, wire_version)?;
    if name == UPSTREAM {
        for definitions in decode_blob(HISTORY)? {
            dialect.add_others(definitions)?;
        }
    }
    Ok(dialect)
}

/// What one definition file says, includes unresolved. `path` may have folders and `.xml`.
///
/// # Errors
/// There is no file of that name.
pub fn definitions(path: &str) -> Result<Definitions, SchemaError> {
    LIBRARY.definitions(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registry::Registry;
    use mavwire_schema::Reason;
    use std::collections::HashSet;

    #[test]
    fn every_dialect_resolves_for_both_versions() {
        let names: Vec<&str> = names().collect();
        assert!(names.len() >= 19, "{names:?}");
        assert!(names.is_sorted(), "{names:?}");
        for name in names {
            for version in [WireVersion::V1, WireVersion::V2] {
                let dialect = dialect(name, version);
                assert_eq!(dialect.as_ref().map(|d| d.name.as_str()), Ok(name));
                let dialect = dialect.map(Registry::new);
                assert!(dialect.is_ok_and(|registry| {
                    let messages = registry.own_messages();
                    messages.iter().all(|m| registry.lookup(m.id).is_some())
                }));
            }
        }
    }

    #[test]
    fn r7_checksum_seeds_of_well_known_messages() {
        let registry = dialect("all", WireVersion::V2).map(Registry::new);
        for (msgid, crc_extra) in [(0, 50), (22, 220), (30, 39), (110, 84), (253, 83), (17000, 103)]
        {
            let entry = registry.as_ref().map(|registry| registry.lookup(msgid));
            assert_eq!(entry.map(|entry| entry.map(|e| e.crc_extra)), Ok(Some(crc_extra)));
        }
    }

    #[test]
    fn earlier_layouts_have_names_of_their_own() {
        for version in [WireVersion::V1, WireVersion::V2] {
            let dialect = dialect(UPSTREAM, version).expect("it comes with the crate");
            let count = dialect.others.len();
            assert!(count > 150, "{count}");
            let registry = Registry::new(dialect);
            let messages = &registry.dialect().messages;
            let names: HashSet<_> = messages.iter().map(|message| &message.name).collect();
            assert_eq!(names.len(), messages.len());
            let others = &messages[registry.own_messages().len()..];
            assert!(others.iter().all(|one| {
                let found = registry.other(one.id, one.crc_extra);
                found.is_some_and(|entry| registry.message(entry.index).name == one.name)
            }));
        }
    }

    #[test]
    fn a_missing_dialect_is_named() {
        let error = dialect("no_such_dialect", WireVersion::V2).err();
        assert!(error.is_some_and(|error| {
            *error.reason() == Reason::NotFound && error.to_string().contains("no_such_dialect")
        }));
    }
}
