//! Inputs of the generator beside dialects: files by the rules of `mavparse`, the schema's check, complete texts.

mod common;

use common::{entries, field, message, messages, parse};
use mavwire_schema::{
    Definitions, Layout, ParseOptions, Rules, SchemaError, check_schema, parse_definitions,
    standalone,
};

fn parse_by(rules: Rules, text: &str) -> Result<Definitions, SchemaError> {
    parse_definitions("my.xml", text, &ParseOptions { rules, ..ParseOptions::default() })
}

#[test]
fn mavparse_takes_what_no_dialect_can_have() {
    for text in [
        "<mavlink><foo/><dialect>x</dialect></mavlink>".to_owned(),
        messages("<foo/>"),
        messages(&message(1, "A;B", &field("char", "lambda"))),
        messages(&message(1, "EMPTY", "")),
        messages(&message(1, "Q", &(field("char", "a") + &field("char", "a")))),
        messages(&message(1, "Q", &field("uint64_t[255]", "a"))),
        messages(&message(1, "Q", &field("uint8_t[0]", "a"))),
        messages(&message(1, "Q", "<field type='char' name='a' instance='yes'><foo/></field>")),
        entries("<foo/><entry name='None'><foo/><param index='9' reserved='yes'/></entry>"),
    ] {
        parse(&text).expect_err(&text);
        parse_by(Rules::Mavparse, &text).expect(&text);
    }
    for text in [
        messages("<message name='A'/>"),
        messages(&message(1, "Q", &field("uint9_t", "a"))),
        entries("<entry name='A' value='x'/>"),
        entries("<entry name='A' hasLocation='x'/>"),
    ] {
        parse_by(Rules::Mavparse, &text).expect_err(&text);
    }
}

#[test]
fn a_layout_needs_no_frame_that_holds_it() {
    let fields = field("uint8_t", "a") + &field("uint64_t[255]", "b");
    let file = parse_by(Rules::Mavparse, &messages(&message(1, "Q", &fields))).unwrap();
    let layout = Layout::of(&file.messages[0]);
    assert_eq!((layout.order, layout.offsets), (vec![1, 0], vec![2040, 0]));
}

#[test]
fn the_schema_is_checked_in_the_order_of_the_file() {
    let text = messages(
        "<message id='1'/>loose<message id='1' name='Q' colour='red'><description/></message>",
    );
    let problems: Vec<_> =
        check_schema("my.xml", &text, false).unwrap().iter().map(ToString::to_string).collect();
    assert_eq!(
        problems,
        [
            "my.xml:2:1: <messages> holds text: 'loose'",
            "my.xml:2:11: <message> needs the attribute 'name'",
            "my.xml:2:11: <message> needs <field>",
            "my.xml:2:33: <message> has no attribute 'colour'",
            "my.xml:2:33: <message> needs <field>",
        ]
    );
}

#[test]
fn a_text_that_stands_alone_has_facts_and_descriptions() {
    let text = "<?xml version='1.0'?><!-- a -->\n<mavlink><!-- b --><include> x/a.xml </include>\n\
                <foo><version>1</version></foo><?pi?><version>2</version></mavlink><!-- c -->";
    assert_eq!(
        standalone("my.xml", text, &["a_2".to_owned()]).unwrap(),
        "<mavlink><include>a_2</include>\n<version>2</version></mavlink>"
    );
}
