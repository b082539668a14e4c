//! Python's spelling of a float: shortest digits that read back as the same double, exponent form below 1e-4 and from
//! 1e16 on, two exponent digits at least. Texts and JSON that programs compare with pymavlink's depend on it.

/// Appends `repr(value)` as Python writes it.
pub fn write_repr(out: &mut String, value: f64) {
    if !value.is_finite() {
        out.push_str(match value {
            _ if value.is_nan() => "nan",
            _ if value > 0.0 => "inf",
            _ => "-inf",
        });
        return;
    }
    let mut buffer = zmij::Buffer::new();
    let text = buffer.format_finite(value);
    let magnitude = value.abs();
    // Without an exponent in `text` too, as the tests make sure.
    if magnitude == 0.0 || (1e-4..1e16).contains(&magnitude) {
        out.push_str(text);
    } else {
        write_exponent(out, text);
    }
}

/// Writes the number in `text` (digits, perhaps a point, perhaps an exponent) in exponent form.
fn write_exponent(out: &mut String, text: &str) {
    let (sign, text) = text.strip_prefix('-').map_or(("", text), |rest| ("-", rest));
    let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let all = [whole, fraction].concat();
    let leading = all.len() - all.trim_start_matches('0').len();
    let (first, rest) = all.trim_matches('0').split_at(1);
    let exponent = exponent.parse().unwrap_or(0) + whole.len() as i32 - leading as i32 - 1;
    out.push_str(sign);
    out.push_str(first);
    if !rest.is_empty() {
        out.push('.');
        out.push_str(rest);
    }
    out.push_str(if exponent < 0 { "e-" } else { "e+" });
    if exponent.abs() < 10 {
        out.push('0');
    }
    out.push_str(&exponent.abs().to_string());
}

#[cfg(test)]
mod tests {
    use super::*;

    fn repr(value: f64) -> String {
        let mut out = String::new();
        write_repr(&mut out, value);
        out
    }

    #[test]
    fn spelling_is_pythons() {
        let cases = [
            (0.0, "0.0"),
            (-0.0, "-0.0"),
            (1.0, "1.0"),
            (-1.5, "-1.5"),
            (100.0, "100.0"),
            (0.1, "0.1"),
            (f64::from(0.1_f32), "0.10000000149011612"),
            (f64::from(1e20_f32), "1.0000000200408773e+20"),
            (f64::from(1e-8_f32), "9.99999993922529e-09"),
            (123_456_792.0, "123456792.0"),
            (1e15, "1000000000000000.0"),
            (9_999_999_999_999_998.0, "9999999999999998.0"),
            (1e16, "1e+16"),
            (12_345_678_901_234_567_890.0, "1.2345678901234567e+19"),
            (1e22, "1e+22"),
            (1e100, "1e+100"),
            (1.5e300, "1.5e+300"),
            (0.0001, "0.0001"),
            (0.000_123, "0.000123"),
            (0.000_099_999, "9.9999e-05"),
            (0.00001, "1e-05"),
            (1.5e-7, "1.5e-07"),
            (5e-324, "5e-324"),
            (2.225_073_858_507_201_4e-308, "2.2250738585072014e-308"),
            (f64::MAX, "1.7976931348623157e+308"),
            (f64::NAN, "nan"),
            (f64::INFINITY, "inf"),
            (f64::NEG_INFINITY, "-inf"),
        ];
        for (value, text) in cases {
            assert_eq!(repr(value), text);
        }
    }

    proptest::proptest! {
        #[test]
        fn the_exponent_begins_where_pythons_does(value in 1e-4_f64..1e16, power in -4_i32..16) {
            for value in [value, value.fract() * 10.0_f64.powi(power)] {
                let expected = !(value == 0.0 || (1e-4..1e16).contains(&value));
                proptest::prop_assert_eq!(repr(value).contains('e'), expected, "{}", value);
            }
        }

        #[test]
        fn reads_back_as_the_same_number(value in proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL) {
            let text = repr(value);
            let back: f64 = text.parse().unwrap_or(f64::NAN);
            proptest::prop_assert_eq!(back.to_bits(), value.to_bits(), "{}", text);
            let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, ""));
            let decades = value.abs().log10().floor();
            proptest::prop_assert_eq!(exponent.is_empty(), (-4.0..16.0).contains(&decades), "{}", text);
            proptest::prop_assert!(exponent.is_empty() || exponent.len() >= 3);
            proptest::prop_assert!(!exponent.is_empty() || mantissa.contains('.'));
        }
    }
}
