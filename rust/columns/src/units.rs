//! Units as MAVLink writes them, and what makes SI units of their values.
//!
//! Angles stay in degrees where the definition has degrees in some form, temperatures in degrees Celsius, shares in
//! percent, and revolutions stay per minute: these are what people read.

use mavwire_schema::Field;

/// `value * times / over`. Two numbers, so that scaling down by a power of ten gives the nearest number there is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    times: f64,
    over: f64,
}

impl Scale {
    const NONE: Self = Self { times: 1.0, over: 1.0 };

    /// A value, scaled.
    #[inline]
    pub fn apply(self, value: f64) -> f64 {
        value * self.times / self.over
    }

    /// Divides.
    pub(crate) const fn down(over: f64) -> Self {
        Self { times: 1.0, over }
    }

    /// Both.
    pub(crate) fn and(self, other: Self) -> Self {
        Self { times: self.times * other.times, over: self.over * other.over }
    }
}

/// Unit in a definition, unit of the result, what to multiply with, what to divide by.
const UNITS: &[(&str, &str, f64, f64)] = &[
    ("ns", "s", 1.0, 1e9),
    ("us", "s", 1.0, 1e6),
    ("ms", "s", 1.0, 1e3),
    ("cs", "s", 1.0, 1e2),
    ("ds", "s", 1.0, 1e1),
    ("degE7", "deg", 1.0, 1e7),
    ("degE5", "deg", 1.0, 1e5),
    ("cdeg", "deg", 1.0, 1e2),
    ("deg/2", "deg", 2.0, 1.0),
    ("cdeg/s", "deg/s", 1.0, 1e2),
    ("ddeg/s", "deg/s", 1.0, 1e1),
    ("mrad/s", "rad/s", 1.0, 1e3),
    ("mm", "m", 1.0, 1e3),
    ("cm", "m", 1.0, 1e2),
    ("dm", "m", 1.0, 1e1),
    ("dam", "m", 1e1, 1.0),
    ("mm/s", "m/s", 1.0, 1e3),
    ("cm/s", "m/s", 1.0, 1e2),
    ("dm/s", "m/s", 1.0, 1e1),
    ("m/s*5", "m/s", 1.0, 5.0),
    ("mG", "m/s/s", 9.806_65, 1e3),
    ("cm^2", "m^2", 1.0, 1e4),
    ("cm^3", "m^3", 1.0, 1e6),
    ("cm^3/min", "m^3/s", 1.0, 6e7),
    ("l", "m^3", 1.0, 1e3),
    ("g", "kg", 1.0, 1e3),
    ("mV", "V", 1.0, 1e3),
    ("cV", "V", 1.0, 1e2),
    ("mA", "A", 1.0, 1e3),
    ("cA", "A", 1.0, 1e2),
    ("mAh", "C", 3.6, 1.0),
    ("hJ", "J", 1e2, 1.0),
    ("mgauss", "T", 1.0, 1e7),
    ("gauss", "T", 1.0, 1e4),
    ("hPa", "Pa", 1e2, 1.0),
    ("kPa", "Pa", 1e3, 1.0),
    ("mbar", "Pa", 1e2, 1.0),
    ("cdegC", "degC", 1.0, 1e2),
    ("c%", "%", 1.0, 1e2),
    ("d%", "%", 1.0, 1e1),
    ("kHz", "Hz", 1e3, 1.0),
    ("MHz", "Hz", 1e6, 1.0),
    ("KiB", "bytes", 1024.0, 1.0),
    ("MiB", "bytes", 1_048_576.0, 1.0),
    ("KiB/s", "bytes/s", 1024.0, 1.0),
    ("MiB/s", "bytes/s", 1_048_576.0, 1.0),
];

/// The multiplier of a definition: a number or a fraction.
fn multiplier(text: &str) -> Option<Scale> {
    let number =
        |text: &str| text.trim().parse::<f64>().ok().filter(|v| v.is_finite() && *v != 0.0);
    if let Some((times, over)) = text.split_once('/') {
        return Some(Scale { times: number(times)?, over: number(over)? });
    }
    let times = number(text)?;
    let over = (1.0 / times).round();
    // 1E-2 is to divide by 100.
    let scales_down = times < 1.0 && (over * times - 1.0).abs() < 1e-12;
    Some(if scales_down { Scale { times: 1.0, over } } else { Scale { times, over: 1.0 } })
}

/// How the values of a field become SI, and their unit then; `None` where they are as they should be.
pub fn to_si(field: &Field) -> Option<(Scale, Option<&str>)> {
    let unit = field.units.as_deref();
    let known = unit.and_then(|unit| UNITS.iter().find(|(from, ..)| *from == unit));
    let by_unit = known.map_or(Scale::NONE, |&(_, _, times, over)| Scale { times, over });
    let by_field = field.multiplier.as_deref().and_then(multiplier).unwrap_or(Scale::NONE);
    let scale = by_unit.and(by_field);
    (scale != Scale::NONE).then_some((scale, known.map_or(unit, |&(_, to, ..)| Some(to))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scaled(units: Option<&str>, multiplier: Option<&str>, value: f64) -> Option<(f64, String)> {
        let text = |text: Option<&str>| text.map(str::to_owned);
        let field = Field { units: text(units), multiplier: text(multiplier), ..Field::default() };
        let (scale, unit) = to_si(&field)?;
        Some((scale.apply(value), unit.unwrap_or_default().to_owned()))
    }

    #[test]
    fn values_are_the_nearest_there_are() {
        let degrees = scaled(Some("degE7"), None, 473_977_418.0);
        assert_eq!(degrees, Some((47.397_741_8, "deg".into())));
        assert_eq!(scaled(Some("mV"), None, 12_345.0), Some((12.345, "V".into())));
        assert_eq!(scaled(None, Some("1E-2"), 121.0), Some((1.21, String::new())));
        assert_eq!(scaled(Some("deg"), Some("360/255"), 255.0), Some((360.0, "deg".into())));
    }

    #[test]
    fn what_is_si_or_senseless_stays() {
        for (unit, multiplier) in [
            (Some("m"), None),
            (Some("rpm"), None),
            (None, Some("1")),
            (None, Some("0")),
            (None, Some("1/0")),
            (None, Some("nonsense")),
            (Some("furlong"), None),
        ] {
            assert_eq!(scaled(unit, multiplier, 1.0), None, "{unit:?} {multiplier:?}");
        }
    }
}
