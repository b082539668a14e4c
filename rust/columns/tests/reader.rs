//! Limits of batches: however small they are, every record is in one batch, and reading ends.

mod common;

use std::collections::BTreeMap;
use std::io::Cursor;
use std::sync::LazyLock;

use common::{damage, log, registry};
use mavwire_columns::input::Steps;
use mavwire_columns::reader::{Decode, Limits, Plan};
use mavwire_columns::select::Wanted;

/// More than the block that is read at once.
const RECORDS: usize = 250_000;

static LOG: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let mut bytes = log(&registry(), 1, RECORDS, 8);
    damage(&mut bytes, 2, 50);
    bytes
});

fn reader(limits: Limits) -> Box<dyn Decode> {
    reader_of(Plan { limits, ..Plan::default() })
}

fn reader_of(plan: Plan) -> Box<dyn Decode> {
    let source = Box::new(Cursor::new(&LOG[..]));
    mavwire_columns::reader::reader(Steps::default(), source, None, registry(), plan)
        .expect("a reader")
}

/// Wanted messages that the dialect does not define.
fn unknown(wanted: Wanted) -> u64 {
    let mut reader = reader_of(Plan { wanted, ..Plan::default() });
    while reader.advance().expect("batches").is_some() {}
    let counts = reader.unknown();
    counts.unlisted + counts.listed.values().map(|count| count.messages).sum::<u64>()
}

/// Rows, and batches, by message index.
fn read(limits: Limits) -> BTreeMap<u16, (usize, usize)> {
    let (mut reader, mut found) = (reader(limits), BTreeMap::new());
    while let Some(batches) = reader.advance().expect("batches") {
        for batch in batches {
            let (rows, count) = found.entry(batch.index).or_insert((0, 0));
            *rows += batch.rows.num_rows();
            *count += 1;
        }
    }
    found
}

fn rows(found: &BTreeMap<u16, (usize, usize)>) -> Vec<(u16, usize)> {
    found.iter().map(|(&index, &(rows, _))| (index, rows)).collect()
}

#[test]
fn without_limits_a_type_is_one_batch() {
    let found = read(Limits::NONE);
    assert_eq!(found.len(), 3);
    assert!(found.values().all(|&(rows, batches)| rows > RECORDS / 5 && batches == 1));
}

#[test]
fn a_table_too_large_for_one_array_comes_in_pieces() {
    let found = read(Limits { table_bytes: 1000, ..Limits::NONE });
    assert_eq!(rows(&found), rows(&read(Limits::NONE)));
    assert!(found.values().all(|&(_, batches)| batches > 1), "{found:?}");
}

#[test]
fn batches_have_no_more_rows_than_wanted() {
    let whole = rows(&read(Limits::NONE));
    for most in [1000, 0] {
        let found = read(Limits { rows: most, ..Limits::NONE });
        assert_eq!(rows(&found), whole, "{most} rows");
        let least = |rows: usize| if most == 0 { 2 } else { rows.div_ceil(most) };
        assert!(found.values().all(|&(rows, batches)| batches >= least(rows)), "{found:?}");
    }
}

#[test]
fn reading_ends_with_the_smallest_of_limits() {
    let whole = rows(&read(Limits::NONE));
    for bytes in [0, 3, 100] {
        let found = read(Limits { bytes, ..Limits::NONE });
        assert_eq!(rows(&found), whole, "{bytes} bytes");
    }
}

#[test]
fn any_number_of_threads_makes_the_same_tables() {
    let tables = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let (mut reader, mut tables) = (reader(Limits::NONE), Vec::new());
            while let Some(batches) = reader.advance().expect("batches") {
                tables.extend(batches.into_iter().map(|batch| (batch.index, batch.rows)));
            }
            assert_eq!(reader.position(), LOG.len() as u64);
            (tables, reader.bad_bytes())
        })
    };
    let (alone, bad) = tables(1);
    assert!(alone.len() == 3 && bad > 0);
    for threads in [2, 5] {
        assert_eq!(tables(threads), (alone.clone(), bad), "{threads} threads");
    }
}

#[test]
fn unknown_messages_are_counted_if_they_are_wanted() {
    let all = unknown(Wanted::default());
    let of_system = |system: usize| {
        let mut systems = Box::new([false; 256]);
        systems[system] = true;
        unknown(Wanted { systems: Some(systems), ..Wanted::default() })
    };
    let parts = [1, 2, 3].map(of_system);
    assert_eq!((parts.iter().sum::<u64>(), of_system(4)), (all, 0));
    assert!(parts.iter().all(|&part| part > 0));
    let middle = 1_600_000_000.0 + 0xFD_FE as f64 * 1e-6 * RECORDS as f64 / 2.0;
    let before = unknown(Wanted { end: middle, ..Wanted::default() });
    let behind = unknown(Wanted { start: middle, ..Wanted::default() });
    assert!(before > 0 && behind > 0 && before + behind == all);
    assert_eq!(unknown(Wanted { unknown: Some(vec![0xABCD]), ..Wanted::default() }), all);
    assert_eq!(unknown(Wanted { unknown: Some(vec![]), ..Wanted::default() }), 0);
}
