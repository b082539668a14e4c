//! Hostile texts: refused quickly, with a typed reason, in bounded memory and without a panic.

mod common;

use common::{entries, field, mavlink, message, messages, parse};
use mavwire_schema::{Library, ParseOptions, Reason, SchemaError, decode_blob, limits};
use mavwire_schema::{WireVersion, encode_blob, parse_definitions, resolve};

fn refused(text: &str) -> SchemaError {
    parse(text).expect_err("hostile text is refused")
}

/// The texts of 0 to `count - 1`, one after the other.
fn numbered(count: u32, text: impl FnMut(u32) -> String) -> String {
    (0..count).map(text).collect::<Vec<_>>().concat()
}

#[test]
fn document_types_and_entities_are_refused() {
    let laughs = "<!DOCTYPE m [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;\">]>\n<mavlink>&b;</mavlink>";
    for text in [
        laughs,
        "<!DOCTYPE mavlink SYSTEM \"file:///etc/passwd\"><mavlink/>",
        "<!doctype x><mavlink/>",
    ] {
        assert_eq!(refused(text).reason(), &Reason::DocumentType);
    }
    let error = refused(&format!("<?xml version=\"1.0\"?>\n  {laughs}"));
    assert_eq!((error.line(), error.column()), (2, 3));
    assert!(matches!(refused("<mavlink>&b;</mavlink>").reason(), Reason::Xml(_)));
}

#[test]
fn nesting_is_bounded_before_anything_is_built() {
    let deep = "<a>".repeat(200_000);
    let limit = limits::MAX_DEPTH;
    assert_eq!(refused(&deep).reason(), &Reason::TooDeep { limit });
    assert_eq!(refused(&mavlink(&deep)).reason(), &Reason::TooDeep { limit });
    let hidden = "<x y='/>'><!-- </x> --><![CDATA[</x>]]><?pi </x> ?>".repeat(100);
    assert_eq!(refused(&mavlink(&hidden)).reason(), &Reason::TooDeep { limit });
}

#[test]
fn size_is_checked_first() {
    let text = " ".repeat(limits::MAX_TEXT_LEN + 1);
    let size = text.len();
    let limit = limits::MAX_TEXT_LEN;
    assert_eq!(refused(&text).reason(), &Reason::TooLarge { size, limit });
    let options = ParseOptions { max_text_len: 10, ..ParseOptions::default() };
    let error = parse_definitions("my", "<mavlink />", &options).unwrap_err();
    assert_eq!(error.to_string(), "my.xml: 11 bytes of XML; at most 10 are read");
}

#[test]
fn attributes_and_namespaces_are_bounded() {
    let attributes = numbered(100_000, |n| format!(" a{n}=''"));
    let error = refused(&mavlink(&format!("<enums{attributes}/>")));
    assert!(matches!(error.reason(), Reason::TooMany { what: "attributes", .. }));
    let namespaces = numbered(10_000, |n| format!("<enums xmlns:a{n}='{n}'/>"));
    let error = refused(&mavlink(&namespaces));
    assert!(matches!(error.reason(), Reason::TooMany { what: "namespaces", .. }));
}

#[test]
fn counts_are_bounded() {
    let many = |item: &str, count: usize| item.repeat(count);
    let comments = many("<!---->", 600_000);
    assert!(matches!(
        refused(&mavlink(&comments)).reason(),
        Reason::TooMany { what: "XML nodes", .. }
    ));
    let entry = "<entry name='A'/>";
    let error = refused(&entries(&many(entry, limits::MAX_ENUM_ENTRIES + 1)));
    assert!(matches!(error.reason(), Reason::TooMany { what: "enum entries", .. }));
    let q = message(1, "Q", &field("uint8_t", "a"));
    let error = refused(&messages(&many(&q, limits::MAX_MESSAGES + 1)));
    assert!(matches!(error.reason(), Reason::TooMany { what: "messages", .. }));
    let error = refused(&mavlink(&many("<include>a.xml</include>", limits::MAX_FILES + 1)));
    assert!(matches!(error.reason(), Reason::TooMany { what: "includes", .. }));
}

#[test]
fn a_fan_of_includes_is_bounded() {
    let mut asked = 0;
    let mut lookup = |path: &str| {
        asked += 1;
        // Every file includes 64 more that nobody has seen.
        let includes = numbered(64, |n| format!("<include>{asked}_{n}.xml</include>"));
        parse_definitions(path, &mavlink(&includes), &ParseOptions::default())
    };
    let error = resolve("m", &mut lookup, WireVersion::V2).unwrap_err();
    assert!(matches!(error.reason(), Reason::TooMany { what: "files", .. }));
    assert!(asked <= 2 * limits::MAX_FILES, "{asked} files were read");
}

#[test]
fn unfinished_markup_is_reported_by_the_reader() {
    for text in [
        "",
        "<",
        "<!",
        "<!-",
        "<!--",
        "<!-->",
        "<![CDATA[",
        "<?",
        "<?xml",
        "</",
        "<a",
        "<a b",
        "<a b='",
        "<a b=\"x",
        "<mavlink",
        "<mavlink>",
        "<mavlink></a>",
        "<mavlink/><mavlink/>",
        "text",
        "\u{0}",
        "<mavlink>\u{1}</mavlink>",
        "<mavlink>&#0;</mavlink>",
        "<mavlink a='1' a='2'/>",
        "<a:b/>",
    ] {
        let error = parse(text).expect_err(text);
        let reason = error.reason();
        assert!(
            matches!(reason, Reason::Xml(_) | Reason::Empty | Reason::DocumentType),
            "{text}: {error}"
        );
        assert!(error.to_string().starts_with("my.xml:"), "{error}");
    }
}

#[test]
fn megabytes_in_one_piece_are_read_to_their_end() {
    // 8 MB of one long attribute, one long text, many short lines, and quotes that never close:
    // with work that grows with the square of the length this test would not end within a day.
    for text in [
        mavlink(&format!("<enums x='{}'/>", "a".repeat(8 << 20))),
        mavlink(&"é".repeat(4 << 20)),
        mavlink(&"\n".repeat(8 << 20)),
        mavlink(&format!("<enums {}", "x".repeat(8 << 20))),
        mavlink(&format!("<enums x='{}", "> ".repeat(4 << 20))),
        mavlink(&"]]".repeat(4 << 20)),
        mavlink(&format!("<!--{}", "-".repeat(8 << 20))),
    ] {
        let _ = parse(&text);
    }
}

#[test]
fn errors_show_an_excerpt_of_long_texts() {
    let long = "é".repeat(1 << 20);
    for text in [
        format!("<{long}/>"),
        mavlink(&format!("<{long}/>")),
        mavlink(&format!("<include>{long}</include>")),
        mavlink(&format!("<version>{long}</version>")),
        entries(&format!("<entry name='{long}'/>")),
        entries(&format!("<entry name='A' value='{long}'/>")),
        entries(&format!("<entry name='A' value='1' hasLocation='{long}'/>")),
        entries(&format!("<entry name='A' value='1'><param index='{long}'/></entry>")),
        messages(&format!("<message name='Q' id='{long}'/>")),
        messages(&message(1, "Q", &field(&long, "a"))),
        messages(&message(1, "Q", &field(&format!("char[{long}]"), "a"))),
        mavlink(&format!("&{long};")),
        mavlink(&format!("</{long}>")),
    ] {
        let shown = refused(&text).to_string();
        assert!(shown.len() < 1000 && shown.contains("..."), "{shown:.200}");
    }
    let unknown = format!("<field type='char' name='a' enum='{long}'/>");
    assert!(common::resolve_error(&[("m.xml", messages(&message(1, "Q", &unknown)))]).len() < 1000);
}

#[test]
fn a_damaged_blob_is_a_typed_error() {
    let file = parse(&messages(&message(1, "Q", &field("uint8_t", "a")))).unwrap();
    let blob = encode_blob(std::slice::from_ref(&file));
    assert_eq!(decode_blob(&blob).unwrap(), [file]);
    for end in 0..blob.len() {
        let error = decode_blob(&blob[..end]).expect_err("a cut blob");
        assert!(matches!(error.reason(), Reason::Blob(_)), "{error}");
    }
    for at in 0..blob.len() {
        let mut damaged = blob.clone();
        damaged[at] ^= 0xFF;
        // Some damage only changes a text; what matters is that nothing panics.
        if let Ok(library) = Library::from_blob(&damaged) {
            let _ = library.resolve("my", WireVersion::V2);
        }
    }
}
