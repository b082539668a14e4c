//! Several files: order, merging, layout, and what only the whole can break. The expected orders, values and checksum
//! seeds were observed on pymavlink 2.4.50.

mod common;

use common::{
    entries, field, lay_out, mavlink, message, messages, names, resolve_error, resolve_files,
    resolve_v2,
};
use mavwire_schema::{Dialect, WireVersion};

fn include(paths: &[&str]) -> String {
    paths.iter().map(|path| format!("<include>{path}</include>")).collect::<Vec<_>>().concat()
}

/// A file with includes and one message.
fn file(includes: &[&str], id: u32, name: &str) -> String {
    let message = message(id, name, &field("uint8_t", "a"));
    mavlink(&format!("{}<messages>{message}</messages>", include(includes)))
}

/// A file with includes and one definition of the enum `E`.
fn enum_file(includes: &[&str], attributes: &str, content: &str) -> String {
    mavlink(&format!(
        "{}<enums><enum name=\"E\" {attributes}>{content}</enum></enums>",
        include(includes)
    ))
}

fn values(dialect: &Dialect) -> Vec<(&str, i128)> {
    dialect.enums[0].entries.iter().map(|entry| (entry.name.as_str(), entry.value)).collect()
}

#[test]
fn base_fields_are_ordered_by_size_and_extensions_follow() {
    let fields = [
        field("uint8_t", "target_system"),
        field("char[10]", "text"),
        field("uint16_t[2]", "words"),
        field("double", "big"),
        field("uint8_t", "target_component"),
        field("float", "f"),
        "<extensions/>".into(),
        field("uint8_t", "e1"),
        field("uint64_t", "e2"),
    ];
    let message = lay_out(&fields.concat());
    let order: Vec<&str> = message.wire_fields().map(|(_, field)| field.name.as_str()).collect();
    assert_eq!(
        order,
        ["big", "f", "words", "target_system", "text", "target_component", "e1", "e2"]
    );
    assert_eq!(message.struct_format(), "<df2HB10sBBQ");
    let offsets: Vec<u8> = message.wire_fields().map(|(_, field)| field.offset).collect();
    assert_eq!(offsets, [0, 8, 12, 16, 17, 27, 28, 29]);
    assert_eq!((message.min_len, message.max_len), (28, 37));
    assert_eq!(message.target_system_offset, Some(16));
    assert_eq!(message.target_component_offset, Some(27));
    for (index, field) in message.wire_fields() {
        assert_eq!(message.fields[index].name, field.name);
    }
}

#[test]
fn crc_extra_covers_names_types_and_lengths_of_base_fields() {
    let seed = |fields: &str| lay_out(fields).crc_extra;
    assert_eq!(seed(&field("uint8_t", "a")), 9);
    assert_eq!(seed(&field("uint8_t[1]", "a")), 138);
    assert_eq!(seed(&field("uint8_t[255]", "a")), 101);
    assert_eq!(seed(&field("char", "a")), 1);
    assert_eq!(seed(&(field("array[4]", "a") + &field("uint16_t", "b"))), 252);
    let extended = field("uint8_t", "b") + "<extensions/>" + &field("uint8_t", "a");
    assert_eq!(seed(&extended), seed(&field("uint8_t", "b")));
    assert_eq!(seed(&("<extensions/>".to_owned() + &field("uint8_t", "a"))), 142);
    // The name counts as written, and is upper case afterwards.
    let lower = resolve_v2(&[("m.xml", messages(&message(1, "qq", &field("uint8_t", "a"))))]);
    assert_eq!((lower.messages[0].name.as_str(), lower.messages[0].crc_extra), ("QQ", 13));
}

#[test]
fn the_last_instance_field_in_wire_order_wins() {
    let instance = |field_type: &str, name: &str| {
        format!("<field type=\"{field_type}\" name=\"{name}\" instance=\"true\"/>")
    };
    let message = lay_out(&(instance("uint8_t", "a") + &instance("uint32_t", "b")));
    assert_eq!(message.instance_field, Some(0));
    assert_eq!(message.fields[0].offset, 4);
    let none = lay_out("<field type=\"uint8_t\" name=\"a\" instance=\"false\"/>");
    assert_eq!(none.instance_field, None);
}

#[test]
fn targets_are_single_bytes() {
    let manual = lay_out(&(field("uint16_t", "b") + &field("uint8_t", "target")));
    assert_eq!((manual.target_system_offset, manual.target_component_offset), (Some(2), None));
    let wide = lay_out(&(field("uint16_t", "target_system") + &field("float", "target")));
    assert_eq!(wide.target_system_offset, None);
}

#[test]
fn files_come_breadth_first_and_once() {
    let dialect = resolve_v2(&[
        ("m.xml", file(&["a.xml", "b.xml"], 1, "M")),
        ("a.xml", file(&["c.xml"], 2, "A")),
        ("b.xml", file(&["d.xml", "c.xml"], 3, "B")),
        ("c.xml", file(&[], 4, "C")),
        ("d.xml", file(&[], 5, "D")),
    ]);
    assert_eq!(names(&dialect), ["M", "A", "B", "C", "D"]);
    assert_eq!(dialect.name, "m");
}

#[test]
fn includes_are_relative_to_their_file() {
    let dialect = resolve_v2(&[
        ("m.xml", file(&["sub/a.xml", "b.xml"], 1, "M")),
        ("sub/a.xml", file(&["../b.xml", "b.xml"], 2, "A")),
        ("b.xml", file(&[], 3, "TOP")),
        ("sub/b.xml", file(&[], 4, "SUB")),
    ]);
    assert_eq!(names(&dialect), ["M", "A", "TOP", "SUB"]);
}

#[test]
fn five_levels_of_includes_are_read() {
    let chain = |levels: usize| -> Vec<(String, String)> {
        (0..=levels)
            .map(|level| {
                let next = format!("n{}.xml", level + 1);
                let includes: &[&str] = if level < levels { &[&next] } else { &[] };
                let name = if level == 0 { "m.xml".into() } else { format!("n{level}.xml") };
                (name, file(includes, level as u32, &format!("N{level}")))
            })
            .collect()
    };
    let borrowed = |files: &[(String, String)]| -> Vec<(&'static str, String)> {
        files.iter().map(|(name, text)| (&*name.clone().leak(), text.clone())).collect()
    };
    assert_eq!(resolve_v2(&borrowed(&chain(5))).messages.len(), 6);
    assert_eq!(
        resolve_error(&borrowed(&chain(6))),
        "n5.xml: include 'n6.xml': more than 5 levels of includes"
    );
}

#[test]
fn circles_are_refused_with_their_path() {
    let cases: [(&[(&str, String)], &str); 3] = [
        (&[("m.xml", file(&["m.xml"], 1, "M"))], "m.xml: includes itself: m.xml -> m.xml"),
        (
            &[("m.xml", file(&["a.xml"], 1, "M")), ("a.xml", file(&["m.xml"], 2, "A"))],
            "m.xml: includes itself: m.xml -> a.xml -> m.xml",
        ),
        (
            &[
                ("m.xml", file(&["c.xml", "a.xml"], 1, "M")),
                ("a.xml", file(&["b.xml"], 2, "A")),
                ("b.xml", file(&["c.xml", "./a.xml"], 3, "B")),
                ("c.xml", file(&[], 4, "C")),
            ],
            "a.xml: includes itself: a.xml -> b.xml -> a.xml",
        ),
    ];
    for (files, expected) in cases {
        assert_eq!(resolve_error(files), expected);
    }
}

#[test]
fn what_is_missing_is_named_where_it_is_wanted() {
    let missing = [("m.xml", file(&["x/gone.xml"], 1, "M"))];
    assert_eq!(resolve_error(&missing), "m.xml: include 'x/gone.xml': no such definitions");
    assert_eq!(resolve_error(&[]), "m.xml: no such definitions");
    let bad = [("m.xml", file(&["a.xml"], 1, "M")), ("a.xml", "<mavlink".into())];
    assert!(resolve_error(&bad).starts_with("a.xml:1:"), "{}", resolve_error(&bad));
    let unknown = "<field type=\"uint8_t\" name=\"a\" enum=\"GONE\"/>";
    assert_eq!(
        resolve_error(&[("m.xml", messages(&message(1, "Q", unknown)))]),
        "m.xml:2: message Q: enum GONE is not defined"
    );
}

#[test]
fn ids_and_names_are_used_once() {
    let pair = |one: String, two: String| {
        resolve_error(&[
            ("m.xml", mavlink(&format!("<include>a.xml</include>\n<messages>{one}</messages>"))),
            ("a.xml", messages(&two)),
        ])
    };
    let f = field("uint8_t", "a");
    assert_eq!(
        pair(message(1, "Q", &f), message(1, "R", &f)),
        "a.xml:2: message R: id 1 is already used by Q (m.xml:3)"
    );
    assert_eq!(
        pair(message(1, "Q", &f), message(2, "q", &f)),
        "a.xml:2: message Q: the name is already used by m.xml:3"
    );
    // An identical redefinition is refused too, as pymavlink does.
    assert_eq!(
        pair(message(1, "Q", &f), message(1, "Q", &f)),
        "a.xml:2: message Q: id 1 is already used by Q (m.xml:3)"
    );
}

#[test]
fn version_1_leaves_out_what_its_frames_cannot_carry() {
    let fields = field("uint8_t", "a")
        + "<extensions/><field type=\"uint32_t\" name=\"b\" enum=\"GONE\" instance=\"true\"/>";
    let content = message(255, "SMALL", &fields)
        + &message(256, "LARGE", &field("uint8_t", "a"))
        + &message(256, "SAME_ID", &field("uint8_t", "a"))
        + &message(100, "EXTENDED", &("<extensions/>".to_owned() + &field("uint8_t", "a")));
    let dialect = resolve_files(&[("m.xml", messages(&content))], WireVersion::V1).unwrap();
    assert_eq!(names(&dialect), ["SMALL"]);
    let small = &dialect.messages[0];
    assert_eq!((small.fields.len(), small.max_len, small.instance_field), (1, 1, None));
    let extended = message(100, "EXTENDED", &("<extensions/>".to_owned() + &field("uint8_t", "a")));
    assert_eq!(names(&resolve_v2(&[("m.xml", messages(&extended))])), ["EXTENDED"]);
}

#[test]
fn the_version_is_that_of_the_message_s_own_file() {
    let version = "<field type=\"uint8_t_mavlink_version\" name=\"v\"/>";
    let with = |content: &str, id, name| {
        mavlink(&format!("{content}<messages>{}</messages>", message(id, name, version)))
    };
    let main = include(&["a.xml", "b.xml"]) + "<version>9</version>";
    let dialect = resolve_v2(&[
        ("m.xml", with(&main, 1, "M")),
        ("a.xml", with("", 2, "A")),
        ("b.xml", with(&(include(&["c.xml"]) + "<version>5</version>"), 3, "B")),
        ("c.xml", with("", 4, "C")),
    ]);
    let versions: Vec<Option<u8>> =
        dialect.messages.iter().map(|message| message.fields[0].mavlink_version).collect();
    assert_eq!(versions, [Some(9), Some(2), Some(5), Some(2)]);
}

#[test]
fn enums_are_merged_in_ascending_order() {
    let a = "<entry value=\"10\" name=\"A1\"/><entry name=\"A2\"/><entry value=\"3\" name=\"A3\"/>";
    let m = "<entry name=\"M1\"/><entry value=\"5\" name=\"M2\"/><entry name=\"M3\"/>";
    let dialect =
        resolve_v2(&[("m.xml", enum_file(&["a.xml"], "", m)), ("a.xml", enum_file(&[], "", a))]);
    let expected = [("A3", 3), ("M2", 5), ("A1", 10), ("A2", 11), ("M1", 12), ("M3", 13)];
    assert_eq!(values(&dialect), expected);
}

#[test]
fn missing_values_continue_after_the_highest_so_far() {
    let resolved = |content: &str| resolve_v2(&[("m.xml", entries(content))]);
    let first = resolved("<entry name=\"A\"/><entry value=\"5\" name=\"B\"/><entry name=\"C\"/>");
    assert_eq!(values(&first), [("A", 1), ("B", 5), ("C", 6)]);
    let negative = resolved("<entry value=\"-7\" name=\"A\"/><entry name=\"B\"/>");
    assert_eq!(values(&negative), [("A", -7), ("B", 1)]);
    let none_left = "<entry value=\"0xFFFFFFFFFFFFFFFF\" name=\"A\"/><entry name=\"B\"/>";
    let error = resolve_error(&[("m.xml", entries(none_left))]);
    assert!(error.starts_with("m.xml:2:"), "{error}");
    assert!(error.ends_with("enum E: entry B: no value is left above 18446744073709551615"));
}

#[test]
fn missing_values_move_behind_an_included_file_whose_range_meets_theirs() {
    let merged = |main: &str, included: &str| {
        let main = enum_file(&["a.xml"], "", main);
        resolve_v2(&[("m.xml", main), ("a.xml", enum_file(&[], "", included))])
    };
    let meet = merged(
        "<entry name=\"M1\"/><entry name=\"M2\"/>",
        "<entry value=\"0\" name=\"A1\"/><entry value=\"1\" name=\"A2\"/>",
    );
    assert_eq!(values(&meet), [("A1", 0), ("A2", 1), ("M1", 2), ("M2", 3)]);
    let apart = merged(
        "<entry name=\"M1\"/><entry value=\"4\" name=\"M2\"/>",
        "<entry value=\"10\" name=\"A1\"/>",
    );
    assert_eq!(values(&apart), [("M1", 1), ("M2", 4), ("A1", 10)]);
}

#[test]
fn entries_are_used_once() {
    let error = |main: &str, included: &str| {
        let main = enum_file(&["a.xml"], "", main);
        resolve_error(&[("m.xml", main), ("a.xml", enum_file(&[], "", included))])
    };
    let entry = |value: u8, name: &str| format!("<entry value=\"{value}\" name=\"{name}\"/>");
    assert_eq!(
        error(&entry(1, "A"), &entry(2, "A")),
        "m.xml:2: enum E: entry A: the name is already used by a.xml:2"
    );
    assert_eq!(
        error(&entry(1, "A"), &entry(1, "B")),
        "m.xml:2: enum E: entry A: value 1 is already used by B (a.xml:2)"
    );
    assert_eq!(error("", ""), "m.xml:2: enum E: no entries");
    // The same name in two enums is allowed, as the upstream definitions need it.
    let two = "<enums><enum name=\"E\"><entry value=\"1\" name=\"A\"/></enum>\
               <enum name=\"F\"><entry value=\"1\" name=\"A\"/></enum></enums>";
    assert_eq!(resolve_v2(&[("m.xml", mavlink(two))]).enums.len(), 2);
}

#[test]
fn the_first_definition_says_whether_an_enum_is_a_bitmask() {
    let resolved = |main: &str, included: &str| {
        let field = "<field type=\"uint8_t\" name=\"a\" enum=\"E\"/>\
                     <field type=\"uint8_t\" name=\"b\" enum=\"E\" display=\"other\"/>";
        let entry = |name: &str, value: u8| format!("<entry value=\"{value}\" name=\"{name}\"/>");
        let text = format!(
            "{}<enums><enum name=\"E\" {main}>{}</enum></enums><messages>{}</messages>",
            include(&["a.xml"]),
            entry("M", 1),
            message(1, "Q", field)
        );
        let included = enum_file(&[], included, &entry("A", 2));
        resolve_v2(&[("m.xml", mavlink(&text)), ("a.xml", included)])
    };
    for (main, included, bitmask) in [
        ("bitmask=\"true\"", "", true),
        ("", "bitmask=\"true\"", false),
        ("bitmask=\"false\"", "", false),
    ] {
        let dialect = resolved(main, included);
        assert_eq!(dialect.enums[0].bitmask, bitmask, "{main}");
        let fields = &dialect.messages[0].fields;
        assert_eq!(fields[0].display.as_deref(), bitmask.then_some("bitmask"), "{main}");
        assert_eq!(fields[1].display.as_deref(), Some("other"));
    }
}
