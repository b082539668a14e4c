//! Sets of files as one: what counts, and what is kept beside it.

mod common;

use common::{field, mavlink, message};
use mavwire_schema::{
    Definitions, Layout, ParseOptions, Union, WireVersion, parse_definitions, resolve,
};

fn file(name: &str, content: &str) -> Definitions {
    parse_definitions(name, &mavlink(content), &ParseOptions::default()).expect("it is right")
}

fn of_messages(name: &str, includes: &str, content: &str) -> Definitions {
    file(name, &format!("{includes}<messages>{content}</messages>"))
}

fn union(sets: Vec<Vec<Definitions>>) -> (Definitions, Definitions) {
    let mut union = Union::default();
    for set in sets {
        union.add(set);
    }
    union.finish("union")
}

fn names(definitions: &Definitions) -> Vec<(u32, &str, usize)> {
    let rows = definitions.messages.iter();
    rows.map(|one| (one.id, one.name.as_str(), one.fields.len())).collect()
}

fn extended(fields: &str) -> String {
    format!("{}<extensions/>{fields}", field("uint8_t", "a"))
}

#[test]
fn the_first_set_counts_and_other_layouts_are_kept() {
    let newer = [
        message(1, "SAME", &field("uint8_t", "a")),
        message(2, "OTHER", &field("uint8_t", "a")),
        message(3, "MOVED", &field("uint8_t", "a")),
    ];
    let older = [
        message(1, "SAME", &field("uint8_t", "a")),
        message(2, "OTHER", &field("uint16_t", "a")),
        message(4, "MOVED", &field("uint8_t", "a")),
        message(5, "OLD", &field("uint8_t", "a")),
    ];
    let (own, others) = union(vec![
        vec![of_messages("a.xml", "", &newer.concat())],
        vec![of_messages("a.xml", "", &older.concat())],
    ]);
    let moved = Layout::of(&own.messages[3]).crc_extra;
    let renamed = format!("MOVED_CRC{moved}");
    let expected =
        [(1, "SAME", 1), (2, "OTHER", 1), (3, "MOVED", 1), (4, renamed.as_str(), 1), (5, "OLD", 1)];
    assert_eq!(names(&own), expected);
    assert_eq!(moved, Layout::of(&own.messages[2]).crc_extra, "the name in the file counts");
    assert_eq!(names(&others), [(2, "OTHER", 1)]);
    let dialect = resolve("union", &mut |_| Ok(own.clone()), WireVersion::V2);
    let mut dialect = dialect.expect("a dialect");
    dialect.add_others(others).expect("layouts");
    let others: Vec<_> = dialect.others.iter().map(|one| one.name.as_str()).collect();
    assert!(others[0].starts_with("OTHER_CRC"), "{others:?}");
}

#[test]
fn the_longer_list_of_extension_fields_counts() {
    let short = message(1, "M", &extended(""));
    let long = message(1, "M", &extended(&field("uint8_t", "b")));
    for (first, second) in [(&short, &long), (&long, &short)] {
        let sets = [first, second].map(|one| vec![of_messages("a.xml", "", one)]);
        let (own, others) = union(sets.to_vec());
        assert_eq!((names(&own), names(&others)), (vec![(1, "M", 2)], vec![]));
    }
}

#[test]
fn files_that_all_includes_come_first() {
    let of = |name: &str, fields| of_messages(name, "", &message(1, "M", fields));
    let set = vec![
        of("aa.xml", &field("uint16_t", "a")),
        of("zz.xml", &field("uint8_t", "a")),
        of_messages("all.xml", "<include>zz.xml</include><include>all.xml</include>", ""),
    ];
    let (own, others) = union(vec![set]);
    assert_eq!(own.messages[0].fields[0].field_type.name(), "uint8_t");
    assert_eq!(names(&others).len(), 1);
}

#[test]
fn entries_whose_name_or_value_is_taken_are_left_out() {
    let of = |entries: &str| {
        let text = format!("<enums><enum name=\"E\">{entries}</enum></enums>");
        vec![file("a.xml", &text)]
    };
    let first = r#"<entry name="E_A" value="1"/><entry name="E_B"/>"#;
    let second = r#"<entry name="E_A" value="7"/><entry name="E_C" value="2"/><entry name="E_D"/>"#;
    let (own, _) = union(vec![of(first), of(second)]);
    let entries: Vec<_> =
        own.enums[0].entries.iter().map(|one| (one.name.as_str(), one.value)).collect();
    assert_eq!(entries, [("E_A", 1), ("E_B", 2), ("E_D", 8)]);
    assert_eq!(own.enums.len(), 1);
}

#[test]
fn no_layout_is_kept_twice() {
    let mut union = Union::default();
    let one = of_messages("a.xml", "", &message(1, "M", &field("uint8_t", "a")));
    let other = of_messages("a.xml", "", &message(1, "M", &field("uint16_t", "a")));
    union.add(vec![one.clone()]);
    union.add_others([&one, &other, &other].map(|file| file.messages[0].clone()));
    assert_eq!(names(&union.finish("union").1), [(1, "M", 1)]);
}
