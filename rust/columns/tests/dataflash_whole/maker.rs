//! Binary logs made up of what may stand in one, in any order.

use proptest::prelude::*;

/// A record type as it may be described: name, format, columns, length.
type Described = (&'static str, &'static str, &'static str, u8);

/// Descriptions of each type, from 1 on.
const TYPES: [&[Described]; 7] = [
    &[("A", "QI", "TimeUS,X", 15), ("A", "QIh", "TimeUS,X,Y", 17), ("A", "Qc", "TimeUS,Y", 13)],
    &[("B", "B", "X", 4), ("C", "B", "X", 4)],
    &[("GPS", "QIH", "TimeUS,GMS,GWk", 17)],
    &[("UNIT", "QbZ", "TimeUS,Id,Label", 76)],
    &[("MULT", "Qbd", "TimeUS,Id,Mult", 20)],
    &[("FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds", 44)],
    &[("D", "QiZ", "TimeUS,X,Text", 79), ("B", "QB", "TimeUS,X", 12)],
];

/// Bytes of a description.
const FMT_LEN: usize = 89;

/// Bytes of a description that a record hides.
const HIDDEN: usize = 40;

/// A week that is a time.
const WEEK: u16 = 2200;

/// One item of a log to make.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Item {
    /// A description of a type.
    Fmt(u8, u8),
    /// A record of a type.
    Record(u8),
    /// A record of GPS, with a time or without.
    Gps(bool),
    Unit(u8),
    Mult(u8),
    /// Units and multipliers of the fields of a type.
    Fmtu(u8, u8),
    /// Bytes of no record.
    Junk(u8),
    /// The bytes before that are lost.
    Cut(u8),
    /// A record of D at whose end a description of A begins, which the next records go on with.
    Hidden,
}

/// Anything, records before all.
pub(crate) fn any_item() -> impl Strategy<Value = Item> {
    prop_oneof![
        40 => (1..8_u8).prop_map(Item::Record),
        4 => any::<bool>().prop_map(Item::Gps),
        3 => (1..8_u8, any::<u8>()).prop_map(|(type_id, which)| Item::Fmt(type_id, which)),
        1 => (0..4_u8).prop_map(Item::Unit),
        1 => (0..4_u8).prop_map(Item::Mult),
        2 => (1..8_u8, 0..3_u8).prop_map(|(type_id, ids)| Item::Fmtu(type_id, ids)),
        1 => any::<u8>().prop_map(Item::Junk),
        1 => (1..40_u8).prop_map(Item::Cut),
        1 => Just(Item::Hidden),
    ]
}

/// A log of one vehicle, as far as it was written.
#[derive(Default)]
pub(crate) struct Maker {
    log: Vec<u8>,
    time: u64,
    /// The description of each type by now.
    lens: [u8; 8],
}

impl Maker {
    /// Only what every log begins with.
    pub(crate) fn new() -> Self {
        let mut maker = Self { lens: [4; 8], ..Self::default() };
        maker.describe(128, ("FMT", "BBnNZ", "Type,Length,Name,Format,Columns", 89));
        maker
    }

    pub(crate) fn with(mut self, items: &[Item]) -> Self {
        for &item in items {
            self.add(item);
        }
        self
    }

    pub(crate) fn log(self) -> Vec<u8> {
        self.log
    }

    fn add(&mut self, item: Item) {
        match item {
            Item::Fmt(type_id, which) => {
                let all = TYPES[usize::from(type_id) - 1];
                let one = all[usize::from(which) % all.len()];
                self.describe(type_id, one);
                self.lens[usize::from(type_id)] = one.3;
            }
            Item::Record(type_id) => self.record(type_id, &[]),
            Item::Gps(fix) => {
                let week = if fix { WEEK } else { 0 };
                let body = [&1000_u32.to_le_bytes()[..], &week.to_le_bytes()].concat();
                self.record(3, &body);
            }
            Item::Unit(n) => self.record(4, &[b'a' + n % 2, b'm', b'0' + n]),
            Item::Mult(n) => {
                let factor = [1.0_f64, 0.01, 100.0, 1e-7][usize::from(n)].to_le_bytes();
                self.record(5, &[&[b'a' + n % 2][..], &factor].concat());
            }
            Item::Fmtu(type_id, ids) => {
                let ids = [&b"-a#"[..], b"-ab", b"-ba"][usize::from(ids)];
                let mut body = [0; 33];
                body[0] = type_id;
                body[1..4].copy_from_slice(ids);
                body[17..20].copy_from_slice(ids);
                self.record(6, &body);
            }
            Item::Junk(len) => self.log.extend((0..len).map(|n| n.wrapping_mul(len))),
            Item::Hidden => {
                self.record(7, &[]);
                let end = self.log.len();
                self.describe(1, ("A", "IQ", "X,TimeUS", 15));
                self.log.drain(end - HIDDEN..end);
                self.log.truncate(end);
            }
            Item::Cut(len) => {
                // The first FMT record stays: without it this is not a dataflash log.
                self.log.truncate(self.log.len().saturating_sub(len.into()).max(FMT_LEN));
            }
        }
    }

    /// A record with its time, the body behind that, and noise as long as the type needs it.
    fn record(&mut self, type_id: u8, body: &[u8]) {
        self.time += 1000;
        let start = self.log.len();
        self.log.extend_from_slice(&[0xA3, 0x95, type_id]);
        self.log.extend_from_slice(&self.time.to_le_bytes());
        self.log.extend_from_slice(body);
        let filler = if body.is_empty() { self.time as u8 } else { 0 };
        self.log.resize(start + usize::from(self.lens[usize::from(type_id)]), filler);
    }

    fn describe(&mut self, type_id: u8, (name, format, columns, len): Described) {
        self.log.extend_from_slice(&[0xA3, 0x95, 0x80, type_id, len]);
        for (text, room) in [(name, 4), (format, 16), (columns, 64)] {
            let end = self.log.len() + room;
            self.log.extend_from_slice(text.as_bytes());
            self.log.resize(end, 0);
        }
    }
}
