//! Times of records: a log counts from the autopilot's start, and a GPS record tells when that was.
//!
//! [`ClockFinder`] finds the record for tables and for `DFReader` of the Python package. Logs of very old firmware whose records
//! carry no time have no [`Clock`]. `DFReader` then reckons with the rates of the record types.

use super::field::FieldKind;
use super::layout::{Field, Layout, TimeUnit};

/// Unix time of 1980-01-06, when GPS weeks begin.
const GPS_EPOCH: f64 = 315_964_800.0;
/// GPS time is ahead of UTC by these seconds.
const LEAP_SECONDS: f64 = 18.0;
const WEEK: f64 = 7.0 * 86_400.0;

/// Unix time of a GPS week and the milliseconds in it.
pub fn gps_time(week: f64, msec: f64) -> f64 {
    // In pymavlink's order: another one differs in the last digit.
    GPS_EPOCH + WEEK * week + msec * 0.001 - LEAP_SECONDS
}

/// The rule for the time of a type's records.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeRule {
    /// The log's start plus the field with this index, whose unit has so many microseconds.
    Field(usize, i64),
    /// The same, but never before the time of the previous record.
    NotBefore(usize, i64),
    /// The time of the previous record.
    Before,
}

/// The time that the records of a log count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ClockUnit {
    /// `TimeUS`.
    Micros,
    /// `TimeMS`, and `T` in GPS records.
    Millis,
    /// `StartTime` of TIME records.
    Start,
    /// None: only GPS records have a time, which is not that of the log.
    Rates,
}

/// A record that tells when the log began.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Told {
    /// The time that the log counts.
    pub unit: ClockUnit,
    /// Where the record starts in the log.
    pub at: u64,
    /// Microseconds since 1970 at the log's zero.
    zero: f64,
}

/// The clock of a log.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Clock {
    /// The time that the log counts.
    pub unit: ClockUnit,
    /// Microseconds since 1970 at the log's zero; 0 if no GPS record tells it.
    pub base: i64,
    /// The time of the records before the first one with a time.
    pub first: i64,
}

impl Clock {
    /// The rule for the time of a type's records.
    pub fn rule(&self, layout: &Layout) -> TimeRule {
        let number = |index: &usize| is_number(&layout.fields[*index]);
        let starts_with = |name| layout.fields.first().is_some_and(|field| field.name == name);
        let (name, micros) = match self.unit {
            ClockUnit::Micros => {
                return match layout.time.filter(|(index, _)| number(index)) {
                    Some((index, TimeUnit::Micros)) => TimeRule::Field(index, 1),
                    Some((index, TimeUnit::Millis)) => TimeRule::NotBefore(index, 1000),
                    None => TimeRule::Before,
                };
            }
            ClockUnit::Millis if starts_with("TimeMS") => ("TimeMS", 1000),
            ClockUnit::Millis if is_gps(&layout.name) => ("T", 1000),
            ClockUnit::Start if layout.name == "TIME" => ("StartTime", 1),
            _ => return TimeRule::Before,
        };
        let index = layout.field_index(name).filter(number);
        index.map_or(TimeRule::Before, |index| TimeRule::Field(index, micros))
    }

    /// The time of a record by its rule. `count` gives the number in a field, so many times. `newest` is the time of the
    /// previous record.
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
            TimeRule::NotBefore(index, micros) => time(index, micros).unwrap_or(newest).max(newest),
            TimeRule::Before => newest,
        }
    }
}

/// Whether GPS records have the columns that tell the time in microseconds.
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
    /// Unix time of the first GPS record with `Week` and `TimeMS`. A second time gives rates.
    rates_from: Option<f64>,
    /// The first record that tells the time.
    found: Option<Told>,
    /// The first record of GPS2 that counts microseconds, unless `found` came before it.
    by_second: Option<Told>,
    /// GPS has such records. Those of GPS2 do not count then.
    has_first: bool,
}

impl ClockFinder {
    /// Whether records of a type may change the clock, as far as is known now.
    pub fn wants(&self, layout: &Layout) -> bool {
        let has = |name: &str| layout.field_index(name).is_some();
        (!self.is_settled() && (is_gps(&layout.name) || layout.name == "TIME"))
            || (self.first_us.is_none() && has("TimeUS"))
            || (self.first_ms.is_none() && !is_gps(&layout.name) && has("TimeMS"))
    }

    /// Whether a record told when the log began. No later record changes the clock then.
    pub fn is_settled(&self) -> bool {
        self.found.is_some() && (self.by_second.is_none() || self.has_first)
    }

    /// Takes in a record that starts at `at`. `value` gives its fields by their index. True if [`Self::wants`] changed.
    pub fn add(&mut self, layout: &Layout, at: u64, value: impl Fn(usize) -> Option<f64>) -> bool {
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
            }
            let mut told = is_gps(&layout.name).then(|| self.by_gps(layout, named)).flatten();
            if told.is_none() {
                let zero = self.gps_time.zip(self.start).map(|(time, start)| time - start);
                told = zero.map(|zero| (ClockUnit::Start, zero));
            }
            let told = told.or_else(|| self.by_rates(layout, named));
            let told = told.map(|(unit, zero)| Told { unit, at, zero });
            if told.is_some_and(|told| told.unit == ClockUnit::Micros) && layout.name != "GPS" {
                self.by_second = self.by_second.or(told);
            } else {
                self.found = told;
            }
        }
        before != (self.is_settled(), self.first_us.is_some(), self.first_ms.is_some())
    }

    fn by_gps(
        &mut self,
        layout: &Layout,
        named: impl Fn(&str) -> Option<f64>,
    ) -> Option<(ClockUnit, f64)> {
        let zero = |week: &str, msec: &str, since: f64| {
            let time = gps_time(named(week)?, named(msec)?) * 1e6;
            time.is_finite().then_some(time - since)
        };
        if counts_micros(layout) {
            named("GWk").filter(|&week| week > 0.0)?;
            return Some((ClockUnit::Micros, zero("GWk", "GMS", named("TimeUS")?)?));
        }
        if has_all(layout, ["T", "Week", "TimeMS"]) {
            named("Week").filter(|&week| week != 0.0)?;
            let since = named("T").filter(|&since| since != 0.0)?;
            let zero = zero("Week", "TimeMS", since * 1e3)?;
            self.first_ms = self.first_ms.or(Some(since));
            return Some((ClockUnit::Millis, zero));
        }
        self.gps_time = named("GPSTime").filter(|&time| time != 0.0).or(self.gps_time);
        None
    }

    /// Two GPS times of records that have no time of the log.
    fn by_rates(
        &mut self,
        layout: &Layout,
        named: impl Fn(&str) -> Option<f64>,
    ) -> Option<(ClockUnit, f64)> {
        let week = named("Week").filter(|&week| week != 0.0 && is_gps(&layout.name))?;
        let time = Some(gps_time(week, named("TimeMS")?)).filter(|time| time.is_finite())?;
        let first = *self.rates_from.get_or_insert(time);
        first.total_cmp(&time).is_ne().then_some((ClockUnit::Rates, 0.0))
    }

    /// The record that tells when the log began.
    pub fn told(&self) -> Option<Told> {
        self.by_second.filter(|_| !self.has_first).or(self.found)
    }

    /// The clock. `None` if no record carries a time of the log.
    pub fn finish(self) -> Option<Clock> {
        let Some(told) = self.told().filter(|told| told.unit != ClockUnit::Rates) else {
            let millis = || self.first_ms.is_some() || self.has_gps_ms;
            let unit = self.first_us.map(|_| ClockUnit::Micros);
            return unit.or_else(|| millis().then_some(ClockUnit::Millis)).map(Clock::from_start);
        };
        let first = match told.unit {
            ClockUnit::Micros => self.first_us.unwrap_or(0.0),
            ClockUnit::Millis => self.first_ms.unwrap_or(0.0) * 1e3,
            _ => self.start.unwrap_or(0.0),
        };
        let base = told.zero.round() as i64;
        Some(Clock { unit: told.unit, base, first: base.saturating_add(first.round() as i64) })
    }
}

impl Clock {
    /// The clock of a log whose start is unknown.
    fn from_start(unit: ClockUnit) -> Self {
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
        finder.add(&imu, 0, |index| [Some(4000.0), None][index]);
        assert!(!finder.wants(&imu));
        finder.add(&gps, 0, |index| [Some(5e6), Some(1000.0), Some(0.0)][index]);
        assert!(finder.wants(&gps), "week 0 is no time");
        finder.add(&gps, 0, |index| [Some(5e6), Some(100_000.0), Some(2200.0)][index]);
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
        finder.add(layout, 0, |index| values.get(index).copied());
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
        assert_eq!(finder.clone().finish(), Some(Clock::from_start(ClockUnit::Micros)));
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
        assert_eq!(finder.clone().finish(), Some(Clock::from_start(ClockUnit::Millis)));
        add(&mut finder, &att, &[400.5]);
        add(&mut finder, &gps, &[2200.0, 1000.0, 500.0]);
        let clock = finder.finish().expect("a clock");
        assert_eq!(clock.first, clock.base + 400_500);
        assert_eq!(clock.rule(&att), TimeRule::Field(0, 1000));
        assert_eq!(clock.rule(&layout("ATT", "X,TimeMS")), TimeRule::Before);
        assert_eq!(clock.rule(&gps), TimeRule::Field(2, 1000));
    }

    #[test]
    fn two_gps_times_without_a_time_of_the_log_give_rates() {
        let (gps, att) = (layout("GPS", "TimeMS,Week"), layout("ATT", "TimeUS"));
        let mut finder = ClockFinder::default();
        for (at, values) in [[1000.0, 0.0], [1000.0, 1800.0], [1000.0, 1800.0]].iter().enumerate() {
            finder.add(&gps, at as u64, |index| values.get(index).copied());
            assert_eq!(finder.told(), None);
        }
        finder.add(&gps, 7, |index| [Some(900.0), Some(1800.0)][index]);
        let told = finder.told().expect("rates");
        assert_eq!((told.unit, told.at), (ClockUnit::Rates, 7));
        assert_eq!(finder.clone().finish(), None, "no record has a time of the log");
        add(&mut finder, &att, &[4000.0]);
        assert_eq!(finder.finish(), Some(Clock::from_start(ClockUnit::Micros)));
    }

    #[test]
    fn without_gps_times_count_from_the_start() {
        for (columns, unit) in [("TimeUS", ClockUnit::Micros), ("TimeMS", ClockUnit::Millis)] {
            let mut finder = ClockFinder::default();
            finder.add(&layout("A", columns), 0, |_| Some(7.0));
            assert_eq!(finder.finish(), Some(Clock::from_start(unit)));
        }
        let mut finder = ClockFinder::default();
        assert!(!finder.add(&layout("A", "B"), 0, |_| Some(7.0)));
        assert_eq!(finder.finish(), None);
    }
}
