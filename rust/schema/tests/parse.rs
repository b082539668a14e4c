//! One file: what is read, and what is refused with which line.

mod common;

use common::{entries, field, mavlink, message, messages, parse, parse_error};
use mavwire_schema::{
    Deprecation, FieldType, ParseOptions, Reason, dialect_name, parse_definitions,
};

#[test]
fn everything_a_file_states_is_read() {
    let text = r#"<?xml version="1.0" encoding="UTF-8"?>
<mavlink>
  <include> common.xml </include>
  <version>3</version>
  <dialect>7</dialect>
  <enums>
    <enum name="MAV_CMD" bitmask="true">
      <deprecated since="2020-01" replaced_by="OTHER">why</deprecated>
      <description>an <![CDATA[<enum>]]> &amp; more</description>
      <entry value="0x10" name="MAV_CMD_ONE" hasLocation="true" isDestination="true">
        <wip/>
        <description>one</description>
        <param index="1" label="Hold" units="s" enum="E" minValue="0" maxValue="9" increment="1"
               default="NaN" multiplier="1E-2" reserved="true">first</param>
      </entry>
    </enum>
  </enums>
  <messages>
    <message id="300" name="ping">
      <superseded since="2011-08" replaced_by="TIMESYNC"/>
      <description>hello</description>
      <field type="uint16_t[3]" name="a" units="m/s" enum="E" display="bitmask" print_format="0x%04x"
             invalid="UINT16_MAX" multiplier="1E-2" minValue="1" maxValue="2" increment="3"
             default="4" instance="true">about a</field>
      <extensions/>
      <field type="uint8_t_mavlink_version" name="v"/>
    </message>
  </messages>
</mavlink>"#;
    let file = parse_definitions("dir/my.xml", text, &ParseOptions::default()).unwrap();
    assert_eq!((file.name.as_str(), file.version, file.dialect), ("my", Some(3), Some(7)));
    assert_eq!(file.includes, ["common.xml"]);

    let definition = &file.enums[0];
    assert_eq!(
        (definition.name.as_str(), definition.line, definition.bitmask),
        ("MAV_CMD", 7, true)
    );
    assert_eq!(definition.description, "an <enum> & more");
    let deprecation = |since: &str, replaced_by: &str, explanation: &str| {
        Some(Box::new(Deprecation {
            since: since.into(),
            replaced_by: replaced_by.into(),
            explanation: explanation.into(),
        }))
    };
    assert_eq!(definition.status.deprecated, deprecation("2020-01", "OTHER", "why"));
    let entry = &definition.entries[0];
    assert_eq!((entry.value, entry.line, entry.status.wip), (16, 10, true));
    assert!(entry.has_location && entry.is_destination);
    let param = &entry.params[0];
    assert_eq!((param.index, param.reserved, param.description.as_str()), (1, true, "first"));
    let attributes = [
        &param.label,
        &param.units,
        &param.enum_name,
        &param.min_value,
        &param.max_value,
        &param.increment,
        &param.default,
        &param.multiplier,
    ];
    let values = ["Hold", "s", "E", "0", "9", "1", "NaN", "1E-2"];
    assert_eq!(attributes.map(|value| value.as_deref().unwrap()), values);

    let ping = &file.messages[0];
    assert_eq!((ping.id, ping.name.as_str(), ping.line), (300, "ping", 19));
    assert_eq!(ping.status.superseded, deprecation("2011-08", "TIMESYNC", ""));
    assert_eq!(ping.description, "hello");
    let a = &ping.fields[0];
    assert_eq!((a.field_type, a.array_length, a.is_instance), (FieldType::U16, 3, true));
    let attributes = [
        &a.units,
        &a.enum_name,
        &a.display,
        &a.print_format,
        &a.invalid,
        &a.multiplier,
        &a.min_value,
        &a.max_value,
        &a.increment,
        &a.default,
    ];
    let values = ["m/s", "E", "bitmask", "0x%04x", "UINT16_MAX", "1E-2", "1", "2", "3", "4"];
    assert_eq!(attributes.map(|value| value.as_deref().unwrap()), values);
    assert_eq!(a.description, "about a");
    let v = &ping.fields[1];
    assert_eq!((v.field_type, v.is_mavlink_version, v.is_extension), (FieldType::U8, true, true));
}

#[test]
fn descriptions_can_be_left_out() {
    let text = messages(&message(1, "Q", &field("uint8_t", "a")));
    let options = ParseOptions { keep_descriptions: false, ..ParseOptions::default() };
    let bare = &parse_definitions("my.xml", &text, &options).unwrap().messages[0];
    assert_eq!((bare.description.as_str(), bare.fields[0].description.as_str()), ("", ""));
    let full = &parse(&text).unwrap().messages[0];
    assert_eq!((full.description.as_str(), full.fields[0].description.as_str()), ("d", "text"));
}

#[test]
fn values_have_a_few_fixed_forms() {
    for (text, value) in [
        ("42", 42),
        (" 7 ", 7),
        ("010", 10),
        ("-1", -1),
        ("+5", 5),
        ("0x2A", 42),
        ("0XfF", 255),
        ("0b101", 5),
        ("0o17", 15),
        ("2**6", 64),
        ("2 ** 63", 1 << 63),
        ("1&lt;&lt;31", 1 << 31),
        ("3 &lt;&lt; 4", 48),
        ("0xFFFFFFFFFFFFFFFF", i128::from(u64::MAX)),
        ("-9223372036854775808", i128::from(i64::MIN)),
    ] {
        let file = parse(&entries(&format!("<entry value=\"{text}\" name=\"A\"/>"))).unwrap();
        assert_eq!(file.enums[0].entries[0].value, value, "{text}");
    }
    let missing =
        parse(&entries("<entry name=\"A\"/><entry value=\"7\" name=\"B\"/><entry name=\"C\"/>"));
    let entries = &missing.unwrap().enums[0].entries;
    let values: Vec<_> = entries.iter().map(|one| (one.value, one.is_automatic)).collect();
    assert_eq!(values, [(1, true), (7, false), (8, true)]);
}

#[test]
fn values_are_never_evaluated() {
    for text in [
        "",
        "x",
        "1+1",
        "(1)",
        "1e3",
        "5.0",
        "--1",
        "+-1",
        "0x",
        "0xG",
        "1_000",
        "2**64",
        "2**-1",
        "9**9**9",
        "2**999999999",
        "1&lt;&lt;65",
        "__import__('os').system('true')",
        "18446744073709551616",
        "-9223372036854775809",
        "١",
        "é",
    ] {
        let error = parse(&entries(&format!("<entry value=\"{text}\" name=\"A\"/>")));
        let error = error.expect_err(text);
        assert!(matches!(error.reason(), Reason::InvalidValue(_)), "{text}");
    }
}

#[test]
fn types_are_the_eleven_with_lengths_from_1_to_255() {
    for (text, field_type, length) in [
        ("char", FieldType::Char, 0),
        ("char[10]", FieldType::Char, 10),
        ("uint8_t[1]", FieldType::U8, 1),
        ("array[4]", FieldType::I8, 4),
        ("double[31]", FieldType::F64, 31),
        ("uint8_t[255]", FieldType::U8, 255),
        ("int64_t", FieldType::I64, 0),
    ] {
        let file = parse(&messages(&message(1, "Q", &field(text, "a")))).unwrap();
        let read = &file.messages[0].fields[0];
        assert_eq!((read.field_type, read.array_length), (field_type, length), "{text}");
    }
    for (text, reason) in [
        ("uint9_t", "unknown type 'uint9_t'"),
        ("array", "unknown type 'array'"),
        ("bool[2]", "unknown type 'bool[2]'"),
        ("uint8_t [2]", "unknown type 'uint8_t [2]'"),
        ("uint8_t[2", "unknown type 'uint8_t[2'"),
        ("uint8_t_mavlink_version[2]", "unknown type 'uint8_t_mavlink_version[2]'"),
        ("uint8_t[0]", "array length '0' is not from 1 to 255"),
        ("uint8_t[]", "array length '' is not from 1 to 255"),
        ("uint8_t[-1]", "array length '-1' is not from 1 to 255"),
        ("uint8_t[256]", "array length '256' is not from 1 to 255"),
        ("uint8_t[1000000000]", "array length '1000000000' is not from 1 to 255"),
        ("uint8_t[2][2]", "array length '2][2' is not from 1 to 255"),
    ] {
        let error = parse_error(&messages(&message(1, "Q", &field(text, "a"))));
        assert!(error.ends_with(&format!("message Q: field a: {reason}")), "{error}");
    }
}

#[test]
fn an_error_names_file_line_column_and_element() {
    let text = "<mavlink>\n  <messages>\n    <message id=\"1\" name=\"FOO\">\n      é<field type=\"uint9_t\" name=\"bar\"/></message></messages></mavlink>";
    let error = parse(text).unwrap_err();
    assert_eq!((error.file(), error.line(), error.column()), ("my.xml", 4, 8));
    assert_eq!(error.to_string(), "my.xml:4:8: message FOO: field bar: unknown type 'uint9_t'");
    // A dialect's name and a path show as files too.
    let named = |name| parse_definitions(name, text, &ParseOptions::default()).unwrap_err();
    assert_eq!(named("my").file(), "my.xml");
    assert_eq!(named("a/b.xml").file(), "a/b.xml");
}

#[test]
fn names_are_identifiers_that_python_can_have() {
    for name in ["", "1a", "a-b", "a b", "a.b", "é", "a\u{0}b", &"a".repeat(129)] {
        let error = parse(&messages(&message(1, "Q", &field("uint8_t", name))));
        assert!(error.is_err(), "{name:?}");
    }
    for (name, why) in [
        ("class", "a reserved word"),
        ("None", "a reserved word"),
        ("self", "a reserved word"),
        ("force_mavlink1", "a reserved word"),
        ("get_type", "a method of messages"),
        ("to_json", "a method of messages"),
        ("_info", "no name for a field: the underscore"),
        ("_fieldnames", "no name for a field: the underscore"),
        ("__class__", "no name for a field: the underscore"),
    ] {
        let error = parse_error(&messages(&message(1, "Q", &field("uint8_t", name))));
        assert!(error.starts_with("my.xml:2:"), "{error}");
        assert!(error.contains(&format!("message Q: '{name}' is {why}")), "{error}");
    }
    for name in ["id", "type", "len", "name", "x_", &"a".repeat(128)] {
        parse(&messages(&message(1, "Q", &field("uint8_t", name)))).expect(name);
    }
}

#[test]
fn entries_have_names_that_modules_leave_to_them() {
    let entry = |name: &str| entries(&format!("<entry value=\"1\" name=\"{name}\"/>"));
    let error = parse_error(&entry("import"));
    assert!(error.ends_with("enum E: 'import' is a reserved word"), "{error}");
    for name in [
        "__name__",
        "WIRE_PROTOCOL_VERSION",
        "MAVLink_foo_message",
        "MAVLink",
        "MAVLINK_MSG_ID_FOO",
        "enums",
        "x25crc",
    ] {
        let error = parse_error(&entry(name));
        assert!(error.starts_with("my.xml:2:"), "{error}");
        let reason = format!("'{name}' is a name that dialect modules have for something else");
        assert!(error.ends_with(&reason), "{error}");
    }
    for name in ["MAV_TYPE_GENERIC", "MAVLINK_DATA_STREAM_IMG_JPEG", "_X", "self", "get_type"] {
        parse(&entry(name)).expect(name);
    }
}

#[test]
fn structure_is_checked() {
    for (content, reason) in [
        ("<message name=\"Q\"/>", "message Q: attribute 'id' is missing"),
        ("<message id=\"1\"/>", "attribute 'name' is missing"),
        ("<message id=\"1\" name=\"Q\"/>", "message Q: no fields"),
        (
            "<message id=\"-1\" name=\"Q\"/>",
            "message Q: id '-1' is not a number from 0 to 16777215",
        ),
        (
            "<message id=\"0x1\" name=\"Q\"/>",
            "message Q: id '0x1' is not a number from 0 to 16777215",
        ),
        (
            "<message id=\"16777216\" name=\"Q\"/>",
            "message Q: id '16777216' is not a number from 0 to 16777215",
        ),
        (
            "<message id=\"1\" name=\"Q\"><feild/></message>",
            "message Q: unexpected element <feild> in <message>",
        ),
        (
            "<message id=\"1\" name=\"Q\"><field name=\"a\"/></message>",
            "message Q: field a: attribute 'type' is missing",
        ),
        (
            "<message id=\"1\" name=\"Q\"><field type=\"char\"/></message>",
            "message Q: attribute 'name' is missing",
        ),
        (
            "<message id=\"1\" name=\"Q\"><field type=\"char\" name=\"a\" instance=\"yes\"/></message>",
            "message Q: field a: instance 'yes' is neither true nor false",
        ),
        ("<enum/>", "unexpected element <enum> in <messages>"),
    ] {
        let error = parse_error(&messages(content));
        assert!(error.ends_with(&format!(" {reason}")), "{error}");
    }
    for (text, reason) in [
        ("<mavlnk/>", "my.xml:1:1: the root element is <mavlnk>, not <mavlink>"),
        (
            "<mavlink><version>256</version></mavlink>",
            "version '256' is not a number from 0 to 255",
        ),
        ("<mavlink><dialect>x</dialect></mavlink>", "dialect 'x' is not a number from 0 to 65535"),
        ("<mavlink><include> </include></mavlink>", "include '' is not the path of a file"),
        ("<mavlink><foo/></mavlink>", "my.xml:1:10: unexpected element <foo> in <mavlink>"),
        ("<mavlink><enums><enum/></enums></mavlink>", "attribute 'name' is missing"),
    ] {
        let error = parse_error(text);
        assert!(error.ends_with(reason), "{error}");
    }
    for index in ["0", "8", "x", ""] {
        let error = parse_error(&entries(&format!(
            "<entry value=\"1\" name=\"A\"><param index=\"{index}\"/></entry>"
        )));
        let expected = format!("entry A: param index '{index}' is not a number from 1 to 7");
        assert!(error.ends_with(&expected), "{error}");
    }
}

#[test]
fn a_message_fits_a_frame() {
    let fields = |count: usize| -> String {
        (0..count).map(|index| field("uint8_t", &format!("f{index}"))).collect()
    };
    assert!(parse(&messages(&message(1, "Q", &fields(64)))).is_ok());
    let error = parse_error(&messages(&message(1, "Q", &fields(65))));
    assert!(error.ends_with("message Q: more than 64 fields"), "{error}");

    let full = field("uint8_t[254]", "a") + &field("uint8_t", "b");
    assert!(parse(&messages(&message(1, "Q", &full))).is_ok());
    let over = full + "<extensions/>" + &field("char", "c");
    let error = parse_error(&messages(&message(1, "Q", &over)));
    assert!(error.ends_with("message Q: payload of 256 bytes; at most 255 fit a frame"), "{error}");

    let twice = field("uint8_t", "a") + &field("uint16_t", "a");
    let error = parse_error(&messages(&message(1, "Q", &twice)));
    assert!(error.ends_with("message Q: field a: duplicate field"), "{error}");
}

#[test]
fn harmless_variations_are_read() {
    for text in [
        "\u{feff}<mavlink/>".to_owned(),
        "<?xml version=\"1.0\"?>\r\n<!-- c -->\r\n<mavlink>\r\n</mavlink>\r\n".to_owned(),
        "<mavlink xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" xsi:noNamespaceSchemaLocation=\"x\"/>".to_owned(),
        mavlink("<enums/><messages/>"),
        messages("loose text <!-- > and a comment -->"),
        messages(&message(1, "Q", "<field type='uint8_t' name='a' units='' unknown='a>b'>x<description/></field>")),
    ] {
        parse(&text).expect(&text);
    }
}

#[test]
fn dialect_names_are_base_names() {
    for (path, name) in [
        ("common", "common"),
        ("common.xml", "common"),
        ("a/b.XML", "b"),
        ("C:\\x\\y.xml", "y"),
        (".xml", ".xml"),
        ("a/", ""),
        ("é.xml", "é"),
    ] {
        assert_eq!(dialect_name(path), name, "{path}");
    }
}
