//! Properties over generated definitions and damaged texts.

mod common;

use common::{field, lay_out, message, messages, parse, resolve_files};
use mavwire_schema::{FieldType, WireVersion};
use proptest::collection::vec;
use proptest::prelude::*;

const TYPES: [&str; 11] = [
    "char", "uint8_t", "int8_t", "uint16_t", "int16_t", "uint32_t", "int32_t", "uint64_t",
    "int64_t", "float", "double",
];

/// Fields that fit a payload: (type index, array length or 0 for a scalar).
fn fields() -> impl Strategy<Value = Vec<(usize, u8)>> {
    vec((0..TYPES.len(), 0_u8..6), 1..30).prop_filter("fits a payload", |fields| {
        let size = |&(index, length): &(usize, u8)| {
            FieldType::ALL[index].size() * usize::from(length.max(1))
        };
        fields.iter().map(size).sum::<usize>() <= 255
    })
}

fn xml((position, &(index, length)): (usize, &(usize, u8))) -> String {
    let array = if length == 0 { String::new() } else { format!("[{length}]") };
    field(&format!("{}{array}", TYPES[index]), &format!("f{position}"))
}

proptest! {
    #[test]
    fn layouts_have_no_gaps_and_base_sizes_descend(base in fields(), split in 0_usize..30) {
        let mut parts: Vec<String> = base.iter().enumerate().map(xml).collect();
        let split = split.min(parts.len());
        parts.insert(split, "<extensions/>".into());
        let message = lay_out(&parts.concat());
        let mut offset = 0;
        for (_, field) in message.wire_fields() {
            prop_assert_eq!(usize::from(field.offset), offset);
            offset += field.wire_len();
        }
        prop_assert_eq!(usize::from(message.max_len), offset);
        let in_base: Vec<(usize, usize)> = message
            .wire_fields()
            .filter(|(_, field)| !field.is_extension)
            .map(|(index, field)| (field.field_type.size(), index))
            .collect();
        prop_assert_eq!(in_base.len(), split);
        for pair in in_base.windows(2) {
            let [(size, index), (next_size, next_index)] = pair else { unreachable!() };
            prop_assert!(size > next_size || (size == next_size && index < next_index));
        }
        for (n, (index, _)) in message.wire_fields().skip(split).enumerate() {
            prop_assert_eq!(index, split + n);
        }
    }

    #[test]
    fn damaged_texts_never_panic(
        base in fields(),
        cuts in vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), "[ -~<>\"'&é\n]{0,3}"), 1..6),
    ) {
        let parts: String = base.iter().enumerate().map(xml).collect();
        let mut text = messages(&message(1, "Q", &parts));
        for (from, length, insert) in cuts {
            let mut from = from.index(text.len());
            while !text.is_char_boundary(from) { from -= 1; }
            let mut to = (from + length.index(8)).min(text.len());
            while !text.is_char_boundary(to) { to += 1; }
            text.replace_range(from..to, &insert);
        }
        if let Err(error) = parse(&text) {
            prop_assert!(error.to_string().starts_with("my.xml:"));
        }
        let _ = resolve_files(&[("m.xml", text)], WireVersion::V1);
    }

    #[test]
    fn any_text_is_judged(text in "\\PC{0,80}", markup in "[<>/!?\\[\\]a=\"' -]{0,80}") {
        let _ = parse(&text);
        let _ = parse(&markup);
        let _ = parse(&format!("<mavlink>{markup}</mavlink>"));
    }
}
