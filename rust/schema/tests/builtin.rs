//! The definitions that the project ships, through the blob as the core uses them.

use std::path::Path;

use mavwire_schema::{
    Definitions, Library, ParseOptions, WireVersion, encode_blob, parse_definitions, resolve,
};

fn shipped() -> Vec<Definitions> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../message_definitions/v1.0");
    let mut paths: Vec<_> = folder
        .read_dir()
        .expect("the definitions are in the tree")
        .map(|entry| entry.expect("readable").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "xml"))
        .collect();
    paths.sort();
    let read = |path: &std::path::PathBuf| {
        let text = std::fs::read_to_string(path).expect("readable");
        let name = path.file_name().and_then(|name| name.to_str()).expect("a UTF-8 name");
        parse_definitions(name, &text, &ParseOptions::default()).expect("valid definitions")
    };
    paths.iter().map(read).collect()
}

/// Messages, enums and entries (without end markers) of pymavlink 2.4.50's modules, v10 messages last.
const COUNTS: [(&str, usize, usize, usize, usize); 6] = [
    ("common", 210, 146, 1669 - 146, 140),
    ("ardupilotmega", 301, 207, 2190 - 207, 188),
    ("all", 353, 232, 2362 - 232, 194),
    ("minimal", 1, 6, 237 - 6, 1),
    ("standard", 3, 9, 268 - 9, 3),
    ("test", 1, 0, 0, 0),
];

#[test]
fn every_shipped_dialect_resolves_from_the_blob() {
    let files = shipped();
    assert_eq!(files.len(), 19);
    let blob = encode_blob(&files);
    let library = Library::from_blob(&blob).unwrap();
    for (name, file) in library.names().zip(&files) {
        assert_eq!(&library.definitions(name).unwrap(), file);
        for version in [WireVersion::V1, WireVersion::V2] {
            let dialect = library.resolve(name, version).unwrap();
            assert_eq!(dialect.name, name);
        }
    }
    for (name, messages, enums, entries, v1_messages) in COUNTS {
        let dialect = library.resolve(name, WireVersion::V2).unwrap();
        let count = dialect.enums.iter().map(|definition| definition.entries.len()).sum::<usize>();
        assert_eq!(
            (dialect.messages.len(), dialect.enums.len(), count),
            (messages, enums, entries)
        );
        let dialect = library.resolve(name, WireVersion::V1).unwrap();
        assert_eq!(dialect.messages.len(), v1_messages, "{name}");
    }
}

#[test]
fn seeds_of_well_known_messages() {
    let blob = encode_blob(&shipped());
    let library = Library::from_blob(&blob).unwrap();
    // From the MAVLink C headers of the same dialects.
    for (dialect, name, crc_extra) in [
        ("common", "HEARTBEAT", 50),
        ("common", "ATTITUDE", 39),
        ("common", "GLOBAL_POSITION_INT", 104),
        ("common", "COMMAND_LONG", 152),
        ("common", "STATUSTEXT", 83),
        ("test", "TEST_TYPES", 103),
        ("python_array_test", "ARRAY_TEST_8", 106),
    ] {
        let dialect = library.resolve(dialect, WireVersion::V2).unwrap();
        let message = dialect.messages.iter().find(|message| message.name == name).unwrap();
        assert_eq!(message.crc_extra, crc_extra, "{name}");
    }
}

#[test]
fn the_shipped_definitions_carry_no_prose() {
    for file in shipped() {
        let params = |entry: &mavwire_schema::EnumEntry| {
            entry.params.iter().all(|param| param.description.is_empty())
        };
        assert!(file.enums.iter().all(|definition| {
            definition.description.is_empty()
                && definition
                    .entries
                    .iter()
                    .all(|entry| entry.description.is_empty() && params(entry))
        }));
        assert!(file.messages.iter().all(|message| message.description.is_empty()
            && message.fields.iter().all(|field| field.description.is_empty())));
    }
}

#[test]
fn a_user_s_file_may_include_shipped_ones() {
    let blob = encode_blob(&shipped());
    let library = Library::from_blob(&blob).unwrap();
    let text = "<mavlink><include>common.xml</include><messages><message id=\"999999\" name=\"MINE\">\
                <field type=\"uint8_t\" name=\"a\" enum=\"MAV_TYPE\"/></message></messages></mavlink>";
    let mut lookup = |path: &str| match path {
        "dir/my.xml" => parse_definitions(path, text, &ParseOptions::default()),
        _ => library.definitions(path),
    };
    let dialect = resolve("dir/my.xml", &mut lookup, WireVersion::V2).unwrap();
    assert_eq!(dialect.name, "my");
    assert_eq!(dialect.messages.len(), 211);
    assert_eq!(dialect.messages[0].name, "MINE");
}
