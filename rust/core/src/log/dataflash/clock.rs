//! Times of records: a log counts from the autopilot's start, and a GPS record tells when that was.
//!
//! The answers are those of `DFReader` of the Python package, in whole microseconds. Logs of very old firmware whose records
//! carry no time at all have no clock here.

use super::field::FieldKind;
use super::layout::{Field, Layout};

/// Unix time of 1980-01-06, when GPS weeks begin, less the seconds that UTC has been set back since.
const GPS_EPOCH: f64 = 315_964_800.0 - 18.0;
const WEEK: f64 = 7.0 * 86_400.0;

/// What the time of a record of some type is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeRule {
    /// The field with this index, so many microseconds for each unit, behind the log's start.
    Field(usize, i64),
    /// The same, but never before the time of the record in front.
    NotBefore(usize, i64),
    /// That of the record in front.
    Before,
}

/// What the clock of a log counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Unit {
    /// `TimeUS`.
    Micros,
    /// `TimeMS`, and `T` in GPS records.
    Millis,
    /// `StartTime` of TIME records.
    Start,
}

/// The clock of a log.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Clock {
    unit: Unit,
    /// Microseconds since 1970 at the log's zero; 0 where no GPS record tells.
    pub base: i64,
    /// The time of records in front of the first one that has a time.
    pub first: i64,
}

impl Clock {
    /// What the time of a type's records is.
    pub fn rule(&self, layout: &Layout) -> TimeRule {
        let field = |name: &str| layout.field_index(name).filter(|&i| is_number(&layout.fields[i]));
        let of =
            |name, micros| field(name).map_or(TimeRule::Before, |i| TimeRule::Field(i, micros));
        match self.unit {
            Unit::Micros if layout.field_index("TimeUS").is_some() => of("TimeUS", 1),
            Unit::Micros => match layout.time.filter(|&(i, _)| is_number(&layout.fields[i])) {
                Some((index, _)) => TimeRule::NotBefore(index, 1000),
                None => TimeRule::Before,
            },
            Unit::Millis => of(millis_of(layout), 1000),
            Unit::Start if layout.name == "TIME" => of("StartTime", 1),
            Unit::Start => TimeRule::Before,
        }
    }

    /// The time of a record by its rule; `count` gives the number in a field, `newest` is the time of the record in front.
    #[inline]
    pub fn stamp(&self, rule: TimeRule, newest: i64, count: impl Fn(usize) -> Option<i64>) -> i64 {
        let time = |index, micros| {
            count(index).map(|n| self.base.saturating_add(n.saturating_mul(micros)))
        };
        match rule {
            TimeRule::Field(index, micros) => time(index, micros).unwrap_or(newest),
            TimeRule::NotBefore(index, micros) => {
                time(index, micros).map_or(newest, |time| time.max(newest))
            }
            TimeRule::Before => newest,
        }
    }
}

/// What has the milliseconds since the log's start; `TimeMS` of GPS records are those of the week.
fn millis_of(layout: &Layout) -> &'static str {
    if is_gps(&layout.name) { "T" } else { "TimeMS" }
}

fn is_gps(name: &str) -> bool {
    matches!(name, "GPS" | "GPS2")
}

fn is_number(field: &Field) -> bool {
    !matches!(field.kind, FieldKind::Text(_) | FieldKind::Array)
}

/// Finds the clock of a log in one run over its records.
#[derive(Debug, Clone, Default)]
pub struct ClockFinder {
    first_us: Option<f64>,
    first_ms: Option<f64>,
    start: Option<f64>,
    /// `GPSTime` of the newest GPS record, before a TIME record says what the log counts.
    gps_time: Option<f64>,
    /// By the first GPS record that tells the time: what its log counts, and microseconds since 1970 at its zero.
    found: Option<(Unit, f64)>,
}

impl ClockFinder {
    /// Whether records of a type may say something, as far as is known now. What has been found is not looked for again.
    pub fn wants(&self, layout: &Layout) -> bool {
        let has = |name: &str| layout.field_index(name).is_some();
        (self.found.is_none() && (is_gps(&layout.name) || layout.name == "TIME"))
            || (self.first_us.is_none() && has("TimeUS"))
            || (self.first_ms.is_none() && has(millis_of(layout)))
    }

    /// Whether a GPS record told when the log began: no later record changes the clock then.
    pub fn is_settled(&self) -> bool {
        self.found.is_some()
    }

    /// Takes in a record whose fields `value` gives by their index. True if what is wanted changed.
    pub fn add(&mut self, layout: &Layout, value: impl Fn(usize) -> Option<f64>) -> bool {
        let finite = |index| value(index).filter(|number| number.is_finite());
        let named = |name: &str| layout.field_index(name).and_then(finite);
        let before = (self.found.is_some(), self.first_us.is_some(), self.first_ms.is_some());
        self.first_us = self.first_us.or_else(|| named("TimeUS"));
        self.first_ms = self.first_ms.or_else(|| named(millis_of(layout)));
        if self.found.is_none() {
            if layout.name == "TIME" {
                self.start = named("StartTime").or(self.start);
            } else if is_gps(&layout.name) {
                self.found = self.by_gps(layout, named);
            }
            if self.found.is_none() {
                let zero = self.gps_time.zip(self.start).map(|(time, start)| time - start);
                self.found = zero.map(|zero| (Unit::Start, zero));
            }
        }
        before != (self.found.is_some(), self.first_us.is_some(), self.first_ms.is_some())
    }

    fn by_gps(
        &mut self,
        layout: &Layout,
        named: impl Fn(&str) -> Option<f64>,
    ) -> Option<(Unit, f64)> {
        let has = |name: &str| layout.field_index(name).is_some();
        let zero = |week: &str, msec: &str, since: f64| {
            Some(((GPS_EPOCH + WEEK * named(week)?) * 1e6 + named(msec)? * 1e3) - since)
        };
        if has("TimeUS") && has("GWk") && has("GMS") {
            named("GWk").filter(|&week| week > 0.0)?;
            return Some((Unit::Micros, zero("GWk", "GMS", named("TimeUS")?)?));
        }
        if has("T") && has("Week") && has("TimeMS") {
            named("Week").filter(|&week| week != 0.0)?;
            return Some((Unit::Millis, zero("Week", "TimeMS", named("T")? * 1e3)?));
        }
        self.gps_time = named("GPSTime").filter(|&time| time != 0.0).or(self.gps_time);
        None
    }

    /// The clock; `None` where no record carries a time.
    pub fn finish(self) -> Option<Clock> {
        let (unit, base) = match self.found {
            Some(found) => found,
            None if self.first_us.is_some() => return Some(Clock::from_start(Unit::Micros)),
            None => {
                self.first_ms?;
                return Some(Clock::from_start(Unit::Millis));
            }
        };
        let first = match unit {
            Unit::Micros => self.first_us.unwrap_or(0.0),
            Unit::Millis => self.first_ms.unwrap_or(0.0) * 1e3,
            Unit::Start => self.start.unwrap_or(0.0),
        };
        let base = base.round() as i64;
        Some(Clock { unit, base, first: base.saturating_add(first.round() as i64) })
    }
}

impl Clock {
    /// The clock of a log whose start nobody knows.
    fn from_start(unit: Unit) -> Self {
        Self { unit, base: 0, first: 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(name: &str, columns: &str) -> Layout {
        let columns: Vec<String> = columns.split(',').map(str::to_owned).collect();
        let format = "Q".repeat(columns.len());
        Layout::new(1, 0, name.to_owned(), format, columns).expect("a layout")
    }

    #[test]
    fn a_gps_record_tells_when_the_log_began() {
        let (gps, imu) = (layout("GPS", "TimeUS,GMS,GWk"), layout("IMU", "TimeUS,X"));
        let mut finder = ClockFinder::default();
        assert!(finder.wants(&imu));
        finder.add(&imu, |index| [Some(4000.0), None][index]);
        assert!(!finder.wants(&imu));
        finder.add(&gps, |index| [Some(5e6), Some(1000.0), Some(0.0)][index]);
        assert!(finder.wants(&gps), "week 0 is no time");
        finder.add(&gps, |index| [Some(5e6), Some(100_000.0), Some(2200.0)][index]);
        let clock = finder.finish().expect("a clock");
        assert_eq!(clock.base, (315_964_782 + 2200 * 604_800 + 100 - 5) * 1_000_000);
        assert_eq!(clock.first, clock.base + 4000);
        assert_eq!(clock.rule(&imu), TimeRule::Field(0, 1));
        assert_eq!(clock.rule(&layout("X", "TimeMS")), TimeRule::NotBefore(0, 1000));
        assert_eq!(clock.rule(&layout("ACC1", "TimeMS")), TimeRule::Before);
        let stamp = |rule, count| clock.stamp(rule, clock.base + 9000, |_| count);
        assert_eq!(stamp(TimeRule::Field(0, 1), Some(7)), clock.base + 7);
        assert_eq!(stamp(TimeRule::Field(0, 1), Some(i64::MAX)), i64::MAX);
        assert_eq!(stamp(TimeRule::NotBefore(0, 1000), Some(7)), clock.base + 9000);
        assert_eq!(stamp(TimeRule::NotBefore(0, 1000), Some(11)), clock.base + 11_000);
        assert_eq!(stamp(TimeRule::Field(0, 1), None), clock.base + 9000);
    }

    #[test]
    fn without_gps_times_count_from_the_start() {
        for (columns, unit) in [("TimeUS", Unit::Micros), ("TimeMS", Unit::Millis)] {
            let mut finder = ClockFinder::default();
            finder.add(&layout("A", columns), |_| Some(7.0));
            assert_eq!(finder.finish(), Some(Clock::from_start(unit)));
        }
        let mut finder = ClockFinder::default();
        assert!(!finder.add(&layout("A", "B"), |_| Some(7.0)));
        assert_eq!(finder.finish(), None);
    }
}
