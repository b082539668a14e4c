//! Times of records: a log counts from the autopilot's start, and a GPS record tells when that was.
//!
//! The answers are those of `DFReader` of the Python package, in whole microseconds. Logs of very old firmware whose records
//! carry no time at all have no clock here.

use super::field::FieldKind;
use super::layout::{Field, Layout, TimeUnit};

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
            Unit::Micros => match layout.time.filter(|&(i, _)| is_number(&layout.fields[i])) {
                Some((index, TimeUnit::Micros)) => TimeRule::Field(index, 1),
                Some((index, TimeUnit::Millis)) => TimeRule::NotBefore(index, 1000),
                None => TimeRule::Before,
            },
            Unit::Millis if layout.fields.first().is_some_and(|first| first.name == "TimeMS") => {
                of("TimeMS", 1000)
            }
            Unit::Millis if is_gps(&layout.name) => of("T", 1000),
            Unit::Start if layout.name == "TIME" => of("StartTime", 1),
            Unit::Millis | Unit::Start => TimeRule::Before,
        }
    }

    /// The time of a record by its rule; `count` gives the number in a field, so many times, and `newest` is the time of
    /// the record in front.
    #[inline]
    pub fn stamp(
        &self,
        rule: TimeRule,
        newest: i64,
        count: impl Fn(usize, i64) -> Option<i64>,
    ) -> i64 {
        let time =
            |index, micros| count(index, micros).map(|since| self.base.saturating_add(since));
        match rule {
            TimeRule::Field(index, micros) => time(index, micros).unwrap_or(newest),
            TimeRule::NotBefore(index, micros) => {
                time(index, micros).map_or(newest, |time| time.max(newest))
            }
            TimeRule::Before => newest,
        }
    }
}

/// Whether GPS records have all that tells the time in microseconds.
fn counts_micros(layout: &Layout) -> bool {
    has_all(layout, ["TimeUS", "GWk", "GMS"])
}

fn has_all(layout: &Layout, names: [&str; 3]) -> bool {
    names.iter().all(|name| layout.field_index(name).is_some())
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
    /// `TimeMS`, or `T` of the GPS record that tells the time.
    first_ms: Option<f64>,
    /// Some GPS record has `T`.
    has_gps_ms: bool,
    start: Option<f64>,
    /// `GPSTime` of the newest GPS record, before a TIME record says what the log counts.
    gps_time: Option<f64>,
    /// By the first GPS record that tells the time: what its log counts, and microseconds since 1970 at its zero.
    found: Option<(Unit, f64)>,
    /// The zero by the first record of GPS2 that counts microseconds, unless `found` came before it.
    by_second: Option<f64>,
    /// There are such records of GPS, beside which those of GPS2 do not count.
    has_first: bool,
}

impl ClockFinder {
    /// Whether records of a type may say something, as far as is known now. What has been found is not looked for again.
    pub fn wants(&self, layout: &Layout) -> bool {
        let has = |name: &str| layout.field_index(name).is_some();
        (!self.is_settled() && (is_gps(&layout.name) || layout.name == "TIME"))
            || (self.first_us.is_none() && has("TimeUS"))
            || (self.first_ms.is_none() && !is_gps(&layout.name) && has("TimeMS"))
    }

    /// Whether a GPS record told when the log began: no later record changes the clock then.
    pub fn is_settled(&self) -> bool {
        self.found.is_some() && (self.by_second.is_none() || self.has_first)
    }

    /// Takes in a record whose fields `value` gives by their index. True if what is wanted changed.
    pub fn add(&mut self, layout: &Layout, value: impl Fn(usize) -> Option<f64>) -> bool {
        let finite = |index| value(index).filter(|number| number.is_finite());
        let named = |name: &str| layout.field_index(name).and_then(finite);
        let before = (self.is_settled(), self.first_us.is_some(), self.first_ms.is_some());
        self.first_us = self.first_us.or_else(|| named("TimeUS"));
        if is_gps(&layout.name) {
            self.has_first |= layout.name == "GPS" && counts_micros(layout);
            self.has_gps_ms |= named("T").is_some();
        } else {
            self.first_ms = self.first_ms.or_else(|| named("TimeMS"));
        }
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
        before != (self.is_settled(), self.first_us.is_some(), self.first_ms.is_some())
    }

    fn by_gps(
        &mut self,
        layout: &Layout,
        named: impl Fn(&str) -> Option<f64>,
    ) -> Option<(Unit, f64)> {
        let zero = |week: &str, msec: &str, since: f64| {
            let week = WEEK * named(week)?;
            let micros = (GPS_EPOCH + week) * 1e6 + named(msec)? * 1e3;
            week.is_finite().then_some(micros - since)
        };
        if counts_micros(layout) {
            named("GWk").filter(|&week| week > 0.0)?;
            let zero = zero("GWk", "GMS", named("TimeUS")?)?;
            if layout.name == "GPS" {
                return Some((Unit::Micros, zero));
            }
            self.by_second = self.by_second.or(Some(zero));
            return None;
        }
        if has_all(layout, ["T", "Week", "TimeMS"]) {
            named("Week").filter(|&week| week != 0.0)?;
            let since = named("T").filter(|&since| since != 0.0)?;
            let zero = zero("Week", "TimeMS", since * 1e3)?;
            self.first_ms = self.first_ms.or(Some(since));
            return Some((Unit::Millis, zero));
        }
        self.gps_time = named("GPSTime").filter(|&time| time != 0.0).or(self.gps_time);
        None
    }

    /// The clock; `None` where no record carries a time.
    pub fn finish(self) -> Option<Clock> {
        let second = self.by_second.filter(|_| !self.has_first).map(|zero| (Unit::Micros, zero));
        let (unit, base) = match second.or(self.found) {
            Some(found) => found,
            None if self.first_us.is_some() => return Some(Clock::from_start(Unit::Micros)),
            None if self.first_ms.is_some() || self.has_gps_ms => {
                return Some(Clock::from_start(Unit::Millis));
            }
            None => return None,
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
        let stamp = |rule, count: Option<i64>| {
            clock.stamp(rule, clock.base + 9000, |_, times| Some(count?.saturating_mul(times)))
        };
        assert_eq!(stamp(TimeRule::Field(0, 1), Some(7)), clock.base + 7);
        assert_eq!(stamp(TimeRule::Field(0, 1), Some(i64::MAX)), i64::MAX);
        assert_eq!(stamp(TimeRule::NotBefore(0, 1000), Some(7)), clock.base + 9000);
        assert_eq!(stamp(TimeRule::NotBefore(0, 1000), Some(11)), clock.base + 11_000);
        assert_eq!(stamp(TimeRule::Field(0, 1), None), clock.base + 9000);
    }

    /// Adds a record of the numbers in its fields.
    fn add(finder: &mut ClockFinder, layout: &Layout, values: &[f64]) {
        finder.add(layout, |index| values.get(index).copied());
    }

    #[test]
    fn a_second_receiver_counts_where_the_first_one_never_does() {
        let (first, second) = (layout("GPS", "TimeUS,GMS,GWk"), layout("GPS2", "TimeUS,GMS,GWk"));
        let mut finder = ClockFinder::default();
        add(&mut finder, &second, &[3e6, 1000.0, 2201.0]);
        assert!(!finder.is_settled() && finder.wants(&first));
        let by_second = finder.clone().finish().expect("a clock");
        assert_eq!(by_second.base, (315_964_782 + 2201 * 604_800 + 1 - 3) * 1_000_000);
        add(&mut finder, &first, &[4e6, 0.0, 0.0]);
        assert_eq!(finder.clone().finish(), Some(Clock::from_start(Unit::Micros)));
        add(&mut finder, &first, &[5e6, 1000.0, 2200.0]);
        assert!(finder.is_settled());
        let clock = finder.finish().expect("a clock");
        assert_eq!(clock.base, (315_964_782 + 2200 * 604_800 + 1 - 5) * 1_000_000);
    }

    #[test]
    fn a_gps_record_that_tells_nothing_is_no_first_time() {
        let (gps, att) = (layout("GPS", "Week,TimeMS,T"), layout("ATT", "TimeMS"));
        let mut finder = ClockFinder::default();
        add(&mut finder, &gps, &[0.0, 1000.0, 300.0]);
        add(&mut finder, &gps, &[2200.0, 1000.0, 0.0]);
        assert_eq!(finder.clone().finish(), Some(Clock::from_start(Unit::Millis)));
        add(&mut finder, &att, &[400.5]);
        add(&mut finder, &gps, &[2200.0, 1000.0, 500.0]);
        let clock = finder.finish().expect("a clock");
        assert_eq!(clock.first, clock.base + 400_500);
        assert_eq!(clock.rule(&att), TimeRule::Field(0, 1000));
        assert_eq!(clock.rule(&layout("ATT", "X,TimeMS")), TimeRule::Before);
        assert_eq!(clock.rule(&gps), TimeRule::Field(2, 1000));
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
