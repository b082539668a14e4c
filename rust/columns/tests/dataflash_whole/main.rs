//! One pass over a dataflash log gives what two give: the same rows, schemas and bad bytes, and the same survey.

mod maker;

use std::collections::BTreeMap;
use std::io::{Cursor, Read};
use std::sync::Arc;

use maker::{Item, Maker, any_item};
use mavwire_columns::arrow::array::RecordBatch;
use mavwire_columns::arrow::compute::concat_batches;
use mavwire_columns::dataflash::{Survey, Whole, read_whole, reader};
use mavwire_columns::error::Error;
use mavwire_columns::input::Steps;
use mavwire_columns::reader::{Batch, Plan};
use proptest::prelude::*;

/// The tables by index, and how many bytes belong to no record.
type Rows = (BTreeMap<u16, RecordBatch>, u64);

fn source(log: &[u8]) -> Box<dyn Read + Send> {
    Box::new(Cursor::new(log.to_vec()))
}

fn tables(batches: Vec<Batch>) -> BTreeMap<u16, RecordBatch> {
    let mut by_index = BTreeMap::<u16, Vec<RecordBatch>>::new();
    for batch in batches {
        by_index.entry(batch.index).or_default().push(batch.rows);
    }
    let whole =
        |rows: &Vec<RecordBatch>| concat_batches(&rows[0].schema(), rows).expect("one schema");
    by_index.iter().map(|(&index, rows)| (index, whole(rows))).collect()
}

/// The log's description of itself, and its tables, from two passes.
fn in_two(log: &[u8], steps: Steps, plan: &Plan) -> (Survey, Rows) {
    let open = || Ok(source(log));
    let survey = Survey::read(steps, &open, || Ok::<_, Error>(()));
    let survey = Arc::new(survey.expect("reading").expect("a dataflash log"));
    let reader = reader(Arc::clone(&survey), &open, plan.clone());
    let (mut reader, mut batches) = (reader.expect("reading"), Vec::new());
    while let Some(some) = reader.advance().expect("reading") {
        batches.extend(some);
    }
    let bad = reader.bad_bytes();
    drop(reader);
    (Arc::into_inner(survey).expect("nobody else has it"), (tables(batches), bad))
}

fn in_one(log: &[u8], steps: Steps, plan: &Plan) -> (Survey, Option<Rows>) {
    let open = || Ok(source(log));
    let whole = read_whole(steps, &open, plan, || Ok::<_, Error>(()));
    let Whole { survey, rows } = whole.expect("reading").expect("a dataflash log");
    (survey, rows.map(|(batches, bad)| (tables(batches), bad)))
}

/// A survey as text, without the steps in which it was made.
fn told(survey: &Survey) -> String {
    let text = format!("{survey:?}");
    text[..text.rfind("steps").expect("its last field")].to_owned()
}

/// Whether one pass in these steps did; what it found then, and what it says about the log in any case, is that of two over
/// blocks that hold all of a small log.
fn agree(log: &[u8], steps: Steps, plan: &Plan) -> bool {
    let (survey, rows) = in_two(log, Steps::default(), plan);
    let (found, found_rows) = in_one(log, steps, plan);
    assert_eq!(told(&found), told(&survey));
    let did = found_rows.is_some();
    assert_eq!(found_rows.unwrap_or_else(|| rows.clone()), rows);
    did
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn one_pass_gives_what_two_give(
        first in proptest::collection::vec(any_item(), 0..30),
        items in proptest::collection::vec(any_item(), 0..250),
        is_sound in any::<bool>(),
        si in any::<bool>(),
        named in any::<bool>(),
        since in proptest::option::of(0..300_u32),
        (block, stretch) in (100..3000_usize, 1..900_usize),
        table_bytes in prop_oneof![Just(usize::MAX), 100..2000_usize],
    ) {
        let sound = if is_sound { &SOUND[..] } else { &[] };
        let log = Maker::new().with(sound).with(&first).with(&items).log();
        let steps = Steps { block, stretch };
        let mut plan = Plan::default();
        plan.options.si = si;
        plan.limits.table_bytes = table_bytes;
        plan.size = log.len() as u64;
        if named {
            plan.wanted.names = Some(vec!["A".to_owned(), "D".to_owned(), "none".to_owned()]);
        }
        if let Some(since) = since {
            plan.wanted.start = BASE + f64::from(since) / 1000.0;
        }
        agree(&log, steps, &plan);
    }
}

/// Seconds since 1970 at the start of a log with a fix, about.
const BASE: f64 = 1_646_524_782.0;

/// How a log begins: some types, the time, and more than a block of records.
const SOUND: [Item; 10] = [
    Item::Fmt(3, 0),
    Item::Fmt(4, 0),
    Item::Fmt(5, 0),
    Item::Fmt(6, 0),
    Item::Fmt(1, 0),
    Item::Unit(0),
    Item::Mult(1),
    Item::Fmtu(1, 0),
    Item::Gps(true),
    Item::Record(1),
];

/// Whether one pass does for a log that goes on like this behind its first blocks; it has records of A behind that.
fn does(items: &[Item]) -> bool {
    let rows = [Item::Record(1); 200];
    let log = Maker::new().with(&SOUND).with(&rows).with(items).with(&rows).log();
    agree(&log, Steps { block: 2000, stretch: 300 }, &Plan::default())
}

#[test]
fn what_describes_new_types_costs_no_pass() {
    assert!(does(&[]));
    assert!(does(&[Item::Fmt(2, 0), Item::Record(2), Item::Fmt(7, 0), Item::Record(7)]));
    assert!(does(&[Item::Fmt(7, 0), Item::Fmtu(7, 1), Item::Record(7)]));
    // Nor what was said before, what no field has, and a fix when there was one.
    assert!(does(&[Item::Fmt(1, 0), Item::Fmtu(1, 0), Item::Unit(0), Item::Gps(true)]));
    assert!(does(&[Item::Unit(1), Item::Mult(3), Item::Fmtu(2, 2)]));
    // Nor what is said of types without a record.
    assert!(does(&[Item::Fmt(7, 0), Item::Fmtu(7, 1), Item::Fmtu(7, 2), Item::Fmt(7, 1)]));
}

#[test]
fn what_changes_rows_that_are_there_takes_two() {
    assert!(!does(&[Item::Fmt(1, 1)]));
    assert!(!does(&[Item::Fmtu(1, 2)]));
    assert!(!does(&[Item::Unit(2)]));
    assert!(!does(&[Item::Mult(2)]));
    // Another type of the same name, in a later block.
    let rows = [Item::Record(1); 200];
    let late = [&[Item::Fmt(2, 0), Item::Record(2)][..], &rows, &[Item::Fmt(7, 1)]].concat();
    assert!(!does(&late));
}

#[test]
fn damage_takes_two_only_if_it_may_hold_what_is_described_behind_it() {
    assert!(does(&[Item::Junk(40), Item::Record(1), Item::Cut(3)]));
    let rows = [Item::Record(1); 200];
    let late = [&[Item::Junk(40)][..], &rows, &[Item::Fmt(7, 0)]].concat();
    assert!(!does(&late));
    let early = [&[Item::Record(7)][..], &rows, &[Item::Fmt(7, 0)]].concat();
    assert!(!does(&early));
}

#[test]
fn a_description_that_is_cut_in_two_holds_from_where_it_begins() {
    let hidden = [Item::Fmt(2, 0), Item::Fmt(7, 0), Item::Hidden, Item::Record(1), Item::Record(2)];
    let rest = [Item::Record(2), Item::Record(1)].repeat(60);
    let log = Maker::new().with(&SOUND).with(&hidden).with(&rest).log();
    let mut plan = Plan::default();
    plan.wanted.names = Some(vec!["B".to_owned()]);
    let did = (800..1200).filter(|&block| agree(&log, Steps { block, stretch: 300 }, &plan));
    assert_eq!(did.count(), 400);
    let (whole, _) = in_two(&log, Steps::default(), &plan);
    assert_eq!(whole.form.layouts().iter().filter(|layout| layout.name == "A").count(), 2);
}

#[test]
fn a_late_fix_takes_two_and_none_in_a_short_log_does_not() {
    let (described, rows) = ([Item::Fmt(3, 0), Item::Fmt(1, 0)], [Item::Record(1); 300]);
    let steps = Steps { block: 2000, stretch: 300 };
    let log = Maker::new().with(&described).with(&rows).with(&[Item::Gps(true)]).log();
    assert!(!agree(&log, steps, &Plan::default()));
    let short = Maker::new().with(&described).with(&rows[..50]).log();
    assert!(agree(&short, steps, &Plan::default()));
    // Where no record has a time nobody can say which are wanted.
    let untimed = Maker::new().with(&[Item::Fmt(2, 0), Item::Record(2), Item::Record(2)]).log();
    assert!(!agree(&untimed, steps, &Plan::default()));
}

#[test]
fn a_log_that_says_new_things_about_its_rows_again_and_again_is_given_up() {
    // Labels of no field: each time the tables are laid out anew, to the same end.
    let log = |times| {
        let label = |n: u8| [&[Item::Record(1); 150][..], &[Item::Unit(1 + 2 * (n % 2))]].concat();
        let items: Vec<Item> = (0..times).flat_map(label).collect();
        Maker::new().with(&SOUND).with(&items).log()
    };
    let steps = Steps { block: 2000, stretch: 300 };
    assert!(agree(&log(10), steps, &Plan::default()));
    assert!(!agree(&log(40), steps, &Plan::default()));
}

#[test]
fn compressed_logs_and_text_logs() {
    let log = Maker::new().with(&SOUND).with(&vec![Item::Record(1); 20_000]).log();
    let packed = zstd::encode_all(&log[..], 3).expect("memory");
    let steps = Steps { block: 60_000, stretch: 300 };
    assert!(agree(&packed, steps, &Plan::default()));
    assert!(agree(&packed[..packed.len() - 9], steps, &Plan::default()), "one that is cut off");
    let text = "FMT, 1, 15, A, QI, TimeUS,X\n".to_owned() + &"A, 1000, 7\n".repeat(300);
    let ((survey, _), (found, rows)) = (
        in_two(text.as_bytes(), steps, &Plan::default()),
        in_one(text.as_bytes(), steps, &Plan::default()),
    );
    assert!(found.tables == survey.tables && found.clock == survey.clock && rows.is_none());
    let nothing =
        read_whole(steps, &|| Ok(source(b"no log")), &Plan::default(), || Ok::<_, Error>(()));
    assert!(nothing.expect("reading").is_none());
}

#[test]
fn whoever_asks_is_asked_and_may_end_it() {
    let log = Maker::new().with(&SOUND).with(&vec![Item::Record(1); 300_000]).log();
    let open = || Ok(source(&log));
    let mut asked = 0;
    let steps = Steps { block: 5000, stretch: 500 };
    let stopped = read_whole(steps, &open, &Plan::default(), || {
        asked += 1;
        Err::<(), _>(Error::NoTimes)
    });
    assert!(matches!(stopped, Err(Error::NoTimes)) && asked == 1);
}

#[test]
fn real_logs() {
    let Some(folder) = std::env::var_os("MAVWIRE_LOGS") else { return };
    let files = std::fs::read_dir(folder).expect("the folder of real logs");
    for path in files.map(|file| file.expect("a file").path()) {
        if path.extension().is_some_and(|extension| extension == "BIN") {
            let log = std::fs::read(&path).expect("a log");
            for block in [4 << 20, 300_000, 100_000] {
                agree(&log, Steps { block, ..Steps::default() }, &Plan::default());
            }
        }
    }
}
