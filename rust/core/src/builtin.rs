//! The dialects that come with the crate, as the build script packed them. A file is decoded when a dialect asks for it.

use mavwire_schema::{
    Definitions, Dialect, Library, SchemaError, Union, WireVersion, decode_blob, resolve,
};
use std::sync::LazyLock;

static HISTORY: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/history.bin"));

static LIBRARY: LazyLock<Library<'static>> = LazyLock::new(|| {
    let blob = include_bytes!(concat!(env!("OUT_DIR"), "/definitions.bin"));
    Library::from_blob(blob).expect("the build script wrote the blob with the same code")
});

/// The dialect with every message of mavlink/mavlink and ArduPilot/mavlink.
pub const UPSTREAM: &str = "upstream";

/// Where the definitions come from: `message_definitions/sources.toml`.
pub const SOURCES: &str = include_str!("../../../message_definitions/sources.toml");

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

/// [`UPSTREAM`] with sets of newer definitions. Layouts that they replace are still known.
///
/// # Errors
/// The sets make no dialect.
pub fn upstream_with(
    sets: Vec<Vec<Definitions>>,
    wire_version: WireVersion,
) -> Result<Dialect, SchemaError> {
    let mut union = Union::default();
    for set in sets {
        union.add(set);
    }
    union.add(vec![LIBRARY.definitions(UPSTREAM)?]);
    for history in decode_blob(HISTORY)? {
        union.add_others(history.messages);
    }
    let (own, others) = union.finish(UPSTREAM);
    let mut dialect = resolve(UPSTREAM, &mut |_| Ok(own.clone()), wire_version)?;
    dialect.add_others(others)?;
    Ok(dialect)
}

/// The content of one definition file, with its includes unresolved. `path` may have folders and `.xml`.
///
/// # Errors
/// There is no file of that name.
pub fn definitions(path: &str) -> Result<Definitions, SchemaError> {
    LIBRARY.definitions(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registry::{Entry, Registry};
    use mavwire_schema::{ParseOptions, Reason, parse_definitions};
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
    fn newer_definitions_replace_and_add_messages() {
        let text = r#"<mavlink><messages>
            <message id="0" name="HEARTBEAT"><field type="uint16_t" name="type" enum="MAV_TYPE"/></message>
            <message id="54000" name="GREENHOUSE"><field type="float" name="moisture"/></message>
        </messages></mavlink>"#;
        let newer = parse_definitions("all.xml", text, &ParseOptions::default());
        let newer = newer.expect("it is well-formed");
        let before = dialect(UPSTREAM, WireVersion::V2).map(Registry::new).expect("built in");
        let after = upstream_with(vec![vec![newer]], WireVersion::V2).map(Registry::new);
        let after = after.expect("a dialect");
        assert_eq!(after.own_messages().len(), before.own_messages().len() + 1);
        let name = |entry: Entry| after.message(entry.index).name.clone();
        assert_eq!(after.lookup(54000).map(name).as_deref(), Some("GREENHOUSE"));
        assert_eq!(after.lookup(0).map(|entry| entry.max_len), Some(2));
        assert_eq!(after.other(0, 50).map(name).as_deref(), Some("HEARTBEAT_CRC50"));
        let same = upstream_with(Vec::new(), WireVersion::V1).map(Registry::new).expect("built in");
        let built_in = dialect(UPSTREAM, WireVersion::V1).map(Registry::new).expect("built in");
        assert_eq!(same.dialect().messages, built_in.dialect().messages);
    }

    #[test]
    fn a_missing_dialect_is_named() {
        let error = dialect("no_such_dialect", WireVersion::V2).err();
        assert!(error.is_some_and(|error| {
            *error.reason() == Reason::NotFound && error.to_string().contains("no_such_dialect")
        }));
    }
}
