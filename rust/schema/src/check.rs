//! The rules of the MAVLink XML schema: elements, their order, their attributes. A dialect can be made of less strict
//! files. But a misspelt attribute would have no effect, and other generators refuse files that break these rules.

use roxmltree::Node;

use crate::error::{Reason, SchemaError, excerpt};
use crate::limits::MAX_MESSAGE_ID;
use crate::number::{parse_decimal, parse_value};
use crate::parse::{ParseOptions, Source, field_type, own_text, read_xml};

/// Errors of one file that are told.
const MAX_ERRORS: usize = 20;

/// Element | attributes with their rules (`!`: required, none: any text) | children in order | rule of the text.
const SHAPES: &str = "\
mavlink | file | include* version? dialect? enums? messages? |
include | | | any
version | | | byte
dialect | | | byte
description | | | any
extensions | | | any
enums | | enum* |
messages | | message* |
wip | since:month | description? | any
superseded | since!:month replaced_by! | description? | any
deprecated | since!:month replaced_by! remove_on_date | description? | any
enum | name!:name bitmask:boolean | wip/superseded/deprecated? description? entry+ |
entry | name!:name value:value hasLocation:boolean hasAltitudeOnly:boolean isDestination:boolean missionOnly:boolean \
mission:boolean fence:boolean rally:boolean command:boolean | wip/superseded/deprecated? description? param* |
param | index!:byte label units:units multiplier:multiplier instance:boolean enum decimalPlaces:byte reserved:boolean \
increment:float minValue:float maxValue:float default:default | | any
message | id!:id name!:name | wip/superseded/deprecated? description? field+ extensions? field* |
field | type!:type name!:name print_format enum display units:units multiplier:multiplier instance:boolean invalid \
increment:float minValue:float maxValue:float default:default | description? | any";

/// Time, frequency; distance, area, speed, acceleration; temperature, angle, rotation; electricity, magnetism, energy,
/// power, force, mass, pressure; ratio, data, flow, volume.
const UNITS: &str = "s ds cs ms us ns Hz MHz \
km dam m m^2 m/s m/s/s m/s*5 dm dm/s cm cm^2 cm/s mm mm/s mm/h \
K degC cdegC rad rad/s mrad/s deg deg/2 ddeg/s deg/s cdeg cdeg/s degE5 degE7 rpm \
V cV mV A cA mA mAh Ah mT gauss mgauss hJ W mG g kg Pa hPa kPa mbar \
% d% c% dB dBm KiB KiB/s MiB MiB/s bytes bytes/s bits/s pix dpix g/min cm^3/min L/h cm^3 l L";

/// Names, in any case, that generators for other languages cannot use.
const RESERVED_WORDS: &str = "await boolean break byte case catch char class const continue debugger default delete do \
double else extends final finally float for function goto if implements import in instanceof int interface let long \
native new package private protected public static super switch synchronized this throw transient try typeof var void \
volatile while with yield";

/// A file's errors by the schema, in order, at most 20. With `strict_units`, units that the schema does not list are
/// errors too.
///
/// # Errors
/// Where the text is not well-formed XML within the limits.
pub fn check_schema(
    name: &str,
    text: &str,
    strict_units: bool,
) -> Result<Vec<SchemaError>, SchemaError> {
    let source = Source::new(name, text, &ParseOptions::default());
    let document = read_xml(&source)?;
    let root = document.root_element();
    if root.tag_name().name() != "mavlink" {
        let tag = excerpt(root.tag_name().name());
        return Ok(vec![source.error(root, Reason::NotMavlink(tag))]);
    }
    let shapes: Vec<Shape> = SHAPES.lines().filter_map(Shape::new).collect();
    let known = root.descendants().filter_map(|node| {
        Some((node, shapes.iter().find(|shape| shape.tag == node.tag_name().name())?))
    });
    let mut errors: Vec<SchemaError> = known
        .clone()
        .flat_map(|(node, shape)| shape.problems(node, strict_units))
        .map(|(node, problem)| source.error(node, Reason::Schema(problem)))
        .take(MAX_ERRORS)
        .collect();
    if errors.is_empty() {
        let reserved = known.filter_map(|(node, _)| Some((node, reserved_word(node)?)));
        let described = reserved.map(|(node, why)| source.error(node, Reason::Schema(why)));
        errors.extend(described.take(MAX_ERRORS));
    }
    Ok(errors)
}

fn reserved_word(node: Node<'_, '_>) -> Option<String> {
    let (tag, name) = (node.tag_name().name(), node.attribute("name")?);
    let is_reserved = RESERVED_WORDS.split(' ').any(|word| word.eq_ignore_ascii_case(name));
    let why = "is a reserved word of a target language; choose another name";
    is_reserved.then(|| format!("{tag} name '{name}' {why}"))
}

/// Whether definitions are made of such elements.
pub(crate) fn is_known(tag: &str) -> bool {
    SHAPES.lines().any(|line| line.split(' ').next() == Some(tag))
}

/// A line of [`SHAPES`].
struct Shape {
    tag: &'static str,
    attributes: Vec<(&'static str, bool, &'static str)>,
    /// Groups of alternative tags, each with the least and the greatest number of children.
    children: Vec<(&'static str, usize, usize)>,
    text: Option<&'static str>,
}

/// An element and what is wrong with it.
type Problem<'a, 'i> = (Node<'a, 'i>, String);

impl Shape {
    fn new(line: &'static str) -> Option<Self> {
        let [tag, attributes, children, text] = *line.split('|').collect::<Vec<_>>() else {
            return None;
        };
        let attributes = attributes.split_whitespace().map(|one| {
            let (name, rule) = one.split_once(':').unwrap_or((one, "any"));
            (name.trim_end_matches('!'), name.ends_with('!'), rule)
        });
        let children = children.split_whitespace().map(|group| {
            let (tags, count) = group.split_at(group.len() - 1);
            (tags, usize::from(count == "+"), if count == "?" { 1 } else { usize::MAX })
        });
        Some(Self {
            tag: tag.trim(),
            attributes: attributes.collect(),
            children: children.collect(),
            text: Some(text.trim()).filter(|text| !text.is_empty()),
        })
    }

    fn problems<'a, 'i>(&self, node: Node<'a, 'i>, strict_units: bool) -> Vec<Problem<'a, 'i>> {
        let attributes = self.attribute_problems(node, strict_units).into_iter();
        let text = self.text_problem(node).map(|problem| (node, problem));
        attributes
            .map(|problem| (node, problem))
            .chain(self.child_problem(node))
            .chain(text)
            .collect()
    }

    fn attribute_problems(&self, node: Node<'_, '_>, strict_units: bool) -> Vec<String> {
        let tag = self.tag;
        let missing =
            self.attributes.iter().filter(|known| known.1 && !node.has_attribute(known.0));
        let missing = missing.map(|known| format!("<{tag}> needs the attribute '{}'", known.0));
        let wrong = node.attributes().filter_map(|attribute| {
            let (name, value) = (attribute.name(), attribute.value());
            let Some((.., rule)) = self.attributes.iter().find(|known| known.0 == name) else {
                return Some(format!("<{tag}> has no attribute '{}'", excerpt(name)));
            };
            let (is_kept, asked) = judge(rule, value);
            let is_wrong = !is_kept && (strict_units || *rule != "units");
            let value = || excerpt(value);
            is_wrong.then(|| format!("<{tag}> attribute '{name}': '{}' is not {asked}", value()))
        });
        missing.chain(wrong).collect()
    }

    fn child_problem<'a, 'i>(&self, node: Node<'a, 'i>) -> Option<Problem<'a, 'i>> {
        let mut children = node.children().filter(Node::is_element).peekable();
        let (tag, mut last) = (self.tag, "");
        for &(tags, least, most) in &self.children {
            let mut count = 0;
            let has = |child: &Node<'_, '_>| tags.split('/').any(|tag| child.has_tag_name(tag));
            while let Some(child) = children.next_if(|child| count < most && has(child)) {
                last = child.tag_name().name();
                count += 1;
            }
            if count < least {
                let needs = || (node, format!("<{tag}> needs {}", in_brackets(tags)));
                return children
                    .next()
                    .map(|child| self.misplaced(child))
                    .or_else(|| Some(needs()));
            }
        }
        let needs_field = "<extensions/> needs at least one <field> after it".to_owned();
        let incomplete = (last == "extensions").then_some((node, needs_field));
        children.next().map(|child| self.misplaced(child)).or(incomplete)
    }

    fn misplaced<'a, 'i>(&self, child: Node<'a, 'i>) -> Problem<'a, 'i> {
        let order: Vec<_> = self.children.iter().map(|group| in_brackets(group.0)).collect();
        let order = match order.join(", ") {
            order if order.is_empty() => " no elements".to_owned(),
            order => format!(", in this order, {order}"),
        };
        let found = excerpt(child.tag_name().name());
        (child, format!("<{found}> is not expected here: <{}> holds{order}", self.tag))
    }

    fn text_problem(&self, node: Node<'_, '_>) -> Option<String> {
        let (tag, text) = (self.tag, own_text(node));
        let shown = excerpt(text.trim());
        let Some((is_kept, asked)) = self.text.map(|rule| judge(rule, &text)) else {
            return (!shown.is_empty()).then(|| format!("<{tag}> holds text: '{shown}'"));
        };
        (!is_kept).then(|| format!("<{tag}>: '{shown}' is not {asked}"))
    }
}

fn in_brackets(tags: &str) -> String {
    format!("<{}>", tags.replace('/', "> or <"))
}

/// Whether an attribute or an element's text keeps a rule of [`SHAPES`], and what the rule asks for.
fn judge(rule: &str, text: &str) -> (bool, &'static str) {
    let trimmed = text.trim();
    let is_word = || text.chars().all(|c| c.is_alphanumeric() || c == '_');
    match rule {
        "name" => (!text.is_empty() && is_word(), "a name of letters, digits and underscores"),
        "boolean" => (matches!(trimmed, "true" | "false" | "0" | "1"), "true or false"),
        "byte" => (parse_decimal(text, u8::MAX.into()).is_some(), "a number from 0 to 255"),
        "float" => (matches!(trimmed, "NaN" | "INF" | "-INF") || is_float(trimmed), "a number"),
        "value" => (is_value(text), "a number such as 10, 0x0A, 0b1010 or 2**3"),
        "default" => (
            text == "NaN" || is_value(text) || text.contains('.') && is_float(text),
            "a number or NaN",
        ),
        "month" => (is_month(text), "a month such as 2024-01"),
        "id" => (parse_decimal(text, MAX_MESSAGE_ID).is_some(), "a number from 0 to 16777215"),
        "type" => (
            !text.starts_with("array") && field_type(text).is_ok(),
            "a type such as uint8_t or float[4]",
        ),
        "multiplier" => (matches!(text, "1E-2" | "2E-3" | "360/255"), "1E-2, 2E-3 or 360/255"),
        "units" => (UNITS.split(' ').any(|unit| unit == text), "a unit of the MAVLink schema"),
        _ => (true, "any text"),
    }
}

fn is_float(text: &str) -> bool {
    // Rust reads `inf` and `nan` too.
    text.bytes().all(|byte| b"+-.eE0123456789".contains(&byte)) && text.parse::<f64>().is_ok()
}

/// A value in the forms that other generators read.
fn is_value(text: &str) -> bool {
    let number = text.strip_prefix('-').unwrap_or(text);
    let is_power_of_2 = number.starts_with("2**") || text.starts_with("1<<");
    let is_plain = number.bytes().all(|byte| byte.is_ascii_alphanumeric()) && !number.contains('o');
    (is_power_of_2 && !text.contains(char::is_whitespace) || is_plain)
        && parse_value(text).is_some()
}

fn is_month(text: &str) -> bool {
    let Some((year, month)) = text.strip_prefix("20").and_then(|rest| rest.split_once('-')) else {
        return false;
    };
    let number = |digits: &str| parse_decimal(digits, 99).filter(|_| digits.len() == 2);
    number(year).is_some() && number(month).is_some_and(|month| (1..=12).contains(&month))
}
