//! Several tables on one clock: a wide table with a row for each tick.

use std::sync::Arc;

use arrow::array::{
    Array, ArrayRef, Float64Array, RecordBatch, TimestampMicrosecondArray, UInt64Array,
};
use arrow::compute::{cast, max, min, take};
use arrow::datatypes::{DataType, Field, Schema};
use arrow::error::ArrowError;

use crate::dates::jump_text;
use crate::layout::HEADER;

/// Which row of a table belongs to a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// The last one before it, or at it.
    Ffill,
    /// The one closest to it, the earlier of two.
    Nearest,
    /// For quantities, the straight line between the rows before and after it; for others the one before.
    Linear,
}

/// Values of an aligned table at most, some 4 GiB: what a mistaken rate, or a log made for it, may cost.
const MOST_VALUES: u64 = 1 << 29;

/// The source of the times at which an aligned table has a row.
#[derive(Debug, Clone)]
pub enum Clock {
    /// The times of a table.
    Table(RecordBatch),
    /// Every so many microseconds, from the first time of all tables to the last.
    Step(i64),
}

impl Clock {
    fn ticks(&self, tables: &[(String, RecordBatch)]) -> Result<Vec<i64>, ArrowError> {
        let step = match self {
            Self::Table(table) => {
                let ticks = clock_of(table)?;
                check_size(ticks.len() as u64, tables)?;
                return Ok(ticks);
            }
            Self::Step(step) => *step,
        };
        let Some((first, last)) = span_of(tables)? else { return Ok(Vec::new()) };
        let count = last.saturating_sub(first) / step;
        check_size(count.unsigned_abs() + 1, tables)?;
        Ok((0..=count).map(|n| first + n * step).collect())
    }
}

fn check_size(ticks: u64, tables: &[(String, RecordBatch)]) -> Result<(), ArrowError> {
    let values = values_of(tables) as u64;
    if ticks.saturating_mul(values) <= MOST_VALUES {
        return Ok(());
    }
    let seconds = |time: i64| time as f64 * 1e-6;
    let gap = widest_gap(tables)?;
    let jump = gap.and_then(|(before, after)| jump_text(seconds(before), seconds(after)));
    let cause = jump.unwrap_or_else(|| "choose a longer rate or fewer types and fields".to_owned());
    let text = format!(
        "a clock of {ticks} ticks with {values} values at each is more than {MOST_VALUES} values: {cause}"
    );
    Err(ArrowError::InvalidArgumentError(text))
}

/// The rows of a table in the order of their times, of those of one time the last.
struct Ordered {
    times: Vec<i64>,
    rows: Vec<u64>,
}

impl Ordered {
    fn of(table: &RecordBatch) -> Result<Self, ArrowError> {
        let times = times_of(table)?;
        let mut rows: Vec<u64> =
            (0..times.len() as u64).filter(|&row| times.is_valid(row as usize)).collect();
        let time_of = |row: u64| times.value(row as usize);
        rows.sort_by_key(|&row| time_of(row));
        rows.dedup_by(|later, kept| {
            let is_same = time_of(*later) == time_of(*kept);
            if is_same {
                *kept = *later;
            }
            is_same
        });
        let times = rows.iter().map(|&row| time_of(row)).collect();
        Ok(Self { times, rows })
    }

    /// The rows around a tick, as places in this order.
    fn around(&self, tick: i64) -> (Option<usize>, Option<usize>) {
        let after = self.times.partition_point(|&time| time <= tick);
        (after.checked_sub(1), (after < self.times.len()).then_some(after))
    }

    fn within(&self, place: Option<usize>, tick: i64, tolerance: u64) -> Option<usize> {
        place.filter(|&place| self.times[place].abs_diff(tick) <= tolerance)
    }

    fn choose(&self, tick: i64, nearest: bool, tolerance: u64) -> Option<usize> {
        let (before, after) = self.around(tick);
        let distance = |place: Option<usize>| place.map(|place| self.times[place].abs_diff(tick));
        let later = nearest
            && match (distance(before), distance(after)) {
                (Some(before), Some(after)) => after < before,
                (before, after) => before.is_none() && after.is_some(),
            };
        self.within(if later { after } else { before }, tick, tolerance)
    }
}

fn times_of(table: &RecordBatch) -> Result<&TimestampMicrosecondArray, ArrowError> {
    table
        .column_by_name("timestamp")
        .and_then(|column| column.as_any().downcast_ref())
        .ok_or_else(|| ArrowError::SchemaError("a table without timestamps".to_owned()))
}

/// The ticks of a table: its times in order, each once.
fn clock_of(table: &RecordBatch) -> Result<Vec<i64>, ArrowError> {
    let ordered = Ordered::of(table)?;
    check_times(&ordered, table, "the clock")?;
    Ok(ordered.times)
}

/// Rows that belong to no time cannot be put beside others.
fn check_times(ordered: &Ordered, table: &RecordBatch, what: &str) -> Result<(), ArrowError> {
    if ordered.rows.is_empty() && table.num_rows() > 0 {
        let text = format!("the rows of {what} have no times: nothing can be aligned with them");
        return Err(ArrowError::InvalidArgumentError(text));
    }
    Ok(())
}

/// First and last time of all tables; `None` where there is no row.
fn span_of(tables: &[(String, RecordBatch)]) -> Result<Option<(i64, i64)>, ArrowError> {
    let mut span: Option<(i64, i64)> = None;
    for (_, table) in tables {
        let times = times_of(table)?;
        if let (Some(first), Some(last)) = (min(times), max(times)) {
            let (low, high) = span.unwrap_or((first, last));
            span = Some((low.min(first), high.max(last)));
        }
    }
    Ok(span)
}

/// The two times in a row, of those of all tables, that are furthest apart.
fn widest_gap(tables: &[(String, RecordBatch)]) -> Result<Option<(i64, i64)>, ArrowError> {
    let mut times = Vec::new();
    for (_, table) in tables {
        times.extend(times_of(table)?.iter().flatten());
    }
    times.sort_unstable();
    let gaps = times.windows(2).map(|pair| (pair[0], pair[1]));
    Ok(gaps.max_by_key(|&(before, after)| after.abs_diff(before)))
}

/// Values in a row of the wide table, those of lists one by one.
fn values_of(tables: &[(String, RecordBatch)]) -> usize {
    let fields = tables.iter().flat_map(|(_, table)| table.schema_ref().fields());
    let values = fields.filter(|field| is_measured(field)).map(|field| match field.data_type() {
        DataType::FixedSizeList(_, length) => usize::try_from(*length).unwrap_or(0),
        _ => 1,
    });
    1 + values.sum::<usize>()
}

fn is_measured(field: &Field) -> bool {
    !HEADER.contains(&field.name().as_str())
}

/// Whether what lies between two values means anything: it does not between modes, sets of bits or the numbers of instances.
fn is_quantity(field: &Field) -> bool {
    let named =
        ["enum", "bitmask", "instance"].iter().any(|told| field.metadata().contains_key(told));
    field.data_type().is_numeric() && !named && field.name() != "custom_mode"
}

/// A row for each tick: `timestamp`, then the fields of each table as `TYPE.field`. Where no row is within `tolerance`
/// microseconds there are nulls.
///
/// # Errors
/// A table has no timestamps or its rows have none, or what arrow says.
pub fn align(
    tables: &[(String, RecordBatch)],
    clock: &Clock,
    method: Method,
    tolerance: u64,
) -> Result<RecordBatch, ArrowError> {
    let clock = clock.ticks(tables)?;
    let mut fields = Vec::new();
    let mut arrays: Vec<ArrayRef> = Vec::new();
    for (name, table) in tables {
        let ordered = Ordered::of(table)?;
        check_times(&ordered, table, name)?;
        let nearest = method == Method::Nearest;
        let chosen: UInt64Array = clock
            .iter()
            .map(|&tick| ordered.choose(tick, nearest, tolerance).map(|place| ordered.rows[place]))
            .collect();
        for (field, column) in table.schema().fields().iter().zip(table.columns()) {
            if !is_measured(field) {
                continue;
            }
            let array = if method == Method::Linear && is_quantity(field) {
                interpolated(&ordered, column, &clock, tolerance)?
            } else {
                take(column, &chosen, None)?
            };
            let label = format!("{name}.{}", field.name());
            let label = Field::new(label, array.data_type().clone(), true);
            fields.push(label.with_metadata(field.metadata().clone()));
            arrays.push(array);
        }
    }
    let times = TimestampMicrosecondArray::from(clock).with_timezone("UTC");
    fields.insert(0, Field::new("timestamp", times.data_type().clone(), true));
    arrays.insert(0, Arc::new(times));
    RecordBatch::try_new(Arc::new(Schema::new(fields)), arrays)
}

fn interpolated(
    ordered: &Ordered,
    column: &ArrayRef,
    clock: &[i64],
    tolerance: u64,
) -> Result<ArrayRef, ArrowError> {
    let numbers = cast(column, &DataType::Float64)?;
    let numbers: &Float64Array = numbers
        .as_any()
        .downcast_ref()
        .ok_or_else(|| ArrowError::CastError("no numbers".to_owned()))?;
    let value = |place: usize| {
        let row = ordered.rows[place] as usize;
        numbers.is_valid(row).then(|| numbers.value(row))
    };
    let at = |&tick: &i64| {
        let (before, after) = ordered.around(tick);
        let before = ordered.within(before, tick, tolerance)?;
        if ordered.times[before] == tick {
            return value(before);
        }
        let after = ordered.within(after, tick, tolerance)?;
        let span = ordered.times[after].abs_diff(ordered.times[before]) as f64;
        let share = tick.abs_diff(ordered.times[before]) as f64 / span;
        let (first, second) = (value(before)?, value(after)?);
        Some(first + (second - first) * share)
    };
    Ok(Arc::new(clock.iter().map(at).collect::<Float64Array>()))
}
