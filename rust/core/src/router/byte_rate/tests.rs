use super::*;
use crate::testing::header;
use mavwire_schema::WireVersion::V2;

/// The longest frame.
const MAX_LEN: f64 = 280.0;
const MS: u64 = 1_000_000;
const HEARTBEAT: u32 = 0;

/// A message type: id, bytes, how often in ten seconds.
type Kind = (u32, usize, u64);

struct Passed {
    /// Messages of each kind.
    counts: Vec<u64>,
    bytes: usize,
    /// How far ahead of the rate frames left, in seconds: on average.
    lead: f64,
}

/// What passes of a vehicle's messages, which come one behind the other in each tenth of a second.
fn passed(rate: f64, kinds: &[Kind], urgent: &[u32], seconds: u64) -> Passed {
    let bytes = ByteRate::new(rate);
    let (mut counts, mut total, mut lead, mut number) = (vec![0; kinds.len()], 0, 0.0, 0);
    for tenth in 0..10 * seconds {
        let mut now = (1_000 + 100 * tenth) * MS;
        for (&(msgid, len, often), count) in kinds.iter().zip(&mut counts) {
            // Evenly spread, as far as tenths go.
            let is_due = |tenth: u64| tenth * often / 100;
            for _ in is_due(tenth)..is_due(tenth + 1) {
                now += MS / 10;
                number += 1;
                let header = header(V2, msgid, 0);
                let is_urgent = urgent.contains(&msgid);
                if bytes.allows(&header, len, is_urgent, number, now) {
                    lead += bytes.account().ordinary.lead(now) / SECOND;
                    bytes.charge(len, now);
                    *count += 1;
                    total += len;
                }
            }
        }
    }
    let mean = lead / counts.iter().sum::<u64>().max(1) as f64;
    Passed { counts, bytes: total, lead: mean }
}

/// What should pass a second of each of these: as much as there is of it, or as often as the others.
fn fair(rate: f64, kinds: &[Kind]) -> Vec<f64> {
    let hertz = |kind: &Kind| kind.2 as f64 / 10.0;
    let bytes =
        |most: f64| -> f64 { kinds.iter().map(|kind| hertz(kind).min(most) * kind.1 as f64).sum() };
    let (mut low, mut high) = (0.0, 1e6);
    for _ in 0..100 {
        let middle = f64::midpoint(low, high);
        *(if bytes(middle) > rate { &mut high } else { &mut low }) = middle;
    }
    kinds.iter().map(|kind| hertz(kind).min(low)).collect()
}

fn check(name: &str, rate: f64, kinds: &[Kind], urgent: &[u32]) {
    let seconds = 300;
    let Passed { counts, bytes, lead } = passed(rate, kinds, urgent, seconds);
    let told = format!("{name} at {rate}: {counts:?}, {bytes} bytes, {lead:.2} s ahead");
    assert!(bytes as f64 <= rate * (seconds as f64 + 2.0) + MAX_LEN, "{told}");
    let longest = kinds.iter().map(|kind| kind.1).max().unwrap_or(0) as f64 / rate;
    assert!(lead < 1.0 + longest, "{told}");
    let (first, others): (Vec<Kind>, Vec<Kind>) =
        kinds.iter().partition(|kind| urgent.contains(&kind.0));
    let first_share = fair(rate, &first);
    let taken: f64 = first.iter().zip(&first_share).map(|(kind, hz)| kind.1 as f64 * hz).sum();
    let others_share = fair((rate - taken).max(0.0), &others);
    let shares = first_share.into_iter().chain(others_share);
    for (kind, share) in first.iter().chain(&others).zip(shares) {
        let got = kinds.iter().zip(&counts).find(|one| one.0 == kind).unwrap().1;
        let expected = share * seconds as f64;
        let near = expected * 0.85 - 2.0..=expected * 1.1 + 10.0;
        assert!(near.contains(&(*got as f64)), "{kind:?}, not {expected:.0}: {told}");
        assert!(kind.0 != HEARTBEAT || taken > rate * 0.9 || *got == 300, "{told}");
    }
}

const RATES: [f64; 9] = [40.0, 60.0, 100.0, 200.0, 300.0, 600.0, 1_200.0, 5_760.0, 100_000.0];
const VEHICLE: [Kind; 9] = [
    (30, 40, 100),
    (27, 41, 100),
    (33, 40, 50),
    (74, 32, 40),
    (1, 43, 20),
    (111, 28, 10),
    (253, 60, 10),
    (2, 24, 10),
    (HEARTBEAT, 21, 10),
];

#[test]
fn each_stream_gets_what_it_asks_for_or_its_share() {
    let mut backwards = VEHICLE;
    backwards.reverse();
    let heartbeat = [(HEARTBEAT, 21, 10)];
    let of_all_lengths = (1..31).map(|n| (n, 14 + 7 * n as usize, 40)).chain(heartbeat);
    let slow = (1..31).map(|n| (n, 50, 10)).chain(heartbeat);
    let long = (1..16).map(|n| (n, 280, 40)).chain(heartbeat);
    let kinds: [(&str, Vec<Kind>); 6] = [
        ("vehicle", VEHICLE.into()),
        ("backwards", backwards.into()),
        ("files", VEHICLE.into_iter().chain([(110, 263, 50)]).collect()),
        ("of all lengths", of_all_lengths.collect()),
        ("slow", slow.collect()),
        ("long", long.collect()),
    ];
    for (name, kinds) in kinds {
        for rate in RATES {
            check(name, rate, &kinds, &[HEARTBEAT]);
        }
    }
}

#[test]
fn urgent_streams_share_among_themselves_too() {
    for rate in [100.0, 200.0, 300.0, 600.0] {
        check("one", rate, &VEHICLE, &[30, HEARTBEAT]);
        check("two", rate, &VEHICLE, &[30, 27, HEARTBEAT]);
        check("all", rate, &VEHICLE, &VEHICLE.map(|kind| kind.0));
    }
}

#[test]
fn turns_that_were_long_for_a_while_are_forgotten() {
    let bytes = ByteRate::new(150.0);
    let (mut number, mut passed) = (0, vec![0; 8]);
    for tenth in 0..900_u64 {
        let now = (1_000 + 100 * tenth) * MS;
        let mut asks = |header: &Header, len, is_urgent| {
            number += 1;
            let is_allowed = bytes.allows(header, len, is_urgent, number, now);
            if is_allowed {
                bytes.charge(len, now);
            }
            is_allowed
        };
        for (compid, _) in (1..21).zip(0..20).filter(|_| (200..230).contains(&tenth)) {
            asks(&Header { compid, ..header(V2, 22, 0) }, 37, true);
        }
        for (&(msgid, len, _), count) in VEHICLE.iter().zip(&mut passed) {
            let got = asks(&header(V2, msgid, 0), len, false);
            *count += u32::from(got && tenth >= 300);
        }
    }
    // A minute of 9,000 bytes for frames of 308 in all.
    assert!(passed.iter().all(|count| (24..=34).contains(count)), "{passed:?}");
}

#[test]
fn a_stream_that_asks_for_little_may_ask_for_it_at_once() {
    let bytes = ByteRate::new(300.0);
    let (mut number, mut passed) = (0, [0; 2]);
    for tenth in 0..1_800_u64 {
        let mut now = (1_000 + 100 * tenth) * MS;
        let mut asks = |header: &Header, len| {
            number += 1;
            now += MS / 10;
            let is_allowed = bytes.allows(header, len, false, number, now);
            if is_allowed {
                bytes.charge(len, now);
            }
            u32::from(is_allowed)
        };
        for msgid in 30..34 {
            asks(&header(V2, msgid, 0), 40);
        }
        // A text in three pieces each ten seconds, eight parameters each fifteen.
        for _ in (0..3).filter(|_| tenth % 100 == 50) {
            passed[0] += asks(&header(V2, 253, 0), 60);
        }
        for _ in (0..8).filter(|_| tenth % 150 == 70) {
            passed[1] += asks(&header(V2, 22, 0), 37);
        }
    }
    assert!(passed[0] >= 50 && passed[1] >= 84, "{passed:?} of [54, 96]");
}

#[test]
fn made_up_streams_take_what_others_leave() {
    let bytes = ByteRate::new(1_000.0);
    let (mut passed, mut number) = (0, 0);
    let mut asks = |header: &Header, now| {
        number += 1;
        let is_allowed = bytes.allows(header, 40, false, number, now);
        if is_allowed {
            bytes.charge(40, now);
        }
        is_allowed
    };
    for tenth in 0..1_200_u64 {
        let now = (1_000 + 100 * tenth) * MS;
        for n in 0..10 {
            let made_up = (tenth * 10 + n) as u32;
            let header =
                Header { sysid: (made_up >> 8) as u8, compid: made_up as u8, ..header(V2, 30, 0) };
            asks(&header, now);
        }
        for msgid in 100..110 {
            passed += u32::from(tenth % 10 == 0 && asks(&header(V2, msgid, 0), now));
        }
    }
    // 400 bytes a second are those of the vehicle.
    assert!(passed > 1_100, "{passed} of 1,200");
}

/// A link at which messages come at stated times.
struct Link {
    bytes: ByteRate,
    number: u64,
}

impl Link {
    fn new(rate: f64) -> Self {
        Self { bytes: ByteRate::new(rate), number: 0 }
    }

    /// Whether a message passes.
    fn passes(&mut self, msgid: u32, len: usize, is_urgent: bool, now: u64) -> bool {
        self.number += 1;
        let passes = self.bytes.allows(&header(V2, msgid, 0), len, is_urgent, self.number, now);
        if passes {
            self.bytes.charge(len, now);
        }
        passes
    }

    /// How many messages of each kind pass that come in batches, so many seconds from one to the next: those of a batch
    /// in the order in which they were sent, at one moment.
    fn in_batches(&mut self, kinds: &[Kind], interval: f64, from: u64, seconds: u64) -> Vec<u64> {
        let mut messages = Vec::new();
        for (kind, &(.., often)) in kinds.iter().enumerate() {
            let sent = (0..seconds * often / 10).map(|n| 10.0 * n as f64 / often as f64);
            messages.extend(sent.map(|sent| ((sent / interval).floor(), sent, kind)));
        }
        messages.sort_by(|one, other| one.partial_cmp(other).unwrap());
        let mut counts = vec![0; kinds.len()];
        for (batch, _, kind) in messages {
            let now = from * 1_000 * MS + (batch * interval * SECOND) as u64;
            let (msgid, len, _) = kinds[kind];
            counts[kind] += u64::from(self.passes(msgid, len, msgid == HEARTBEAT, now));
        }
        counts
    }
}

const FAST_VEHICLE: [Kind; 8] = [
    (30, 40, 500),
    (27, 41, 500),
    (33, 40, 100),
    (74, 32, 40),
    (1, 43, 20),
    (111, 28, 10),
    (253, 60, 10),
    (HEARTBEAT, 21, 10),
];

#[test]
fn batches_are_shared_like_single_messages() {
    for interval in [0.02, 0.1, 0.2, 0.5] {
        let counts = Link::new(2_000.0).in_batches(&FAST_VEHICLE, interval, 1, 300);
        for ((&count, kind), share) in
            counts.iter().zip(FAST_VEHICLE).zip(fair(2_000.0, &FAST_VEHICLE))
        {
            let share = share * 300.0;
            let near = share * 0.75 - 2.0..share * 1.25;
            assert!(
                near.contains(&(count as f64)),
                "{kind:?}, not {share:.0}: {counts:?}, {interval} s"
            );
        }
    }
}

#[test]
fn of_rare_bursts_that_are_too_long_all_get_something() {
    let kinds = |often| (100..110).map(move |msgid| (msgid, 40, often)).collect::<Vec<Kind>>();
    for (often, interval, rate) in
        [(2, 5.0, 100.0), (2, 5.0, 60.0), (5, 2.0, 180.0), (5, 2.0, 210.0)]
    {
        let counts = Link::new(rate).in_batches(&kinds(often), interval, 1, 600);
        let most = counts.iter().max().unwrap();
        assert!(counts.iter().all(|count| 5 * count > 2 * most), "{counts:?} at {rate}");
    }
    for interval in [2.0, 3.0, 5.0, 10.0] {
        let counts = Link::new(300.0).in_batches(&VEHICLE, interval, 1, 600);
        let bursts = (600.0 / interval) as u64;
        assert!(counts.iter().all(|&count| count >= bursts), "{counts:?} each {interval} s");
    }
}

#[test]
fn after_an_absence_all_have_their_share_at_once() {
    for absence in [0, 30, 300, 3_600] {
        let mut link = Link::new(200.0);
        link.in_batches(&VEHICLE, 0.1, 1, 60);
        let counts = link.in_batches(&VEHICLE, 0.1, 61 + absence, 10);
        assert!(
            counts.iter().all(|count| (4..=10).contains(count)),
            "{counts:?} after {absence} s"
        );
    }
}

#[test]
fn a_rare_type_passes_that_comes_behind_others() {
    let kinds: [Kind; 4] = [(HEARTBEAT, 21, 10), (148, 72, 5), (253, 30, 10), (2, 24, 1)];
    let counts = Link::new(66.0).in_batches(&kinds, 1.0, 1, 300);
    assert!(counts[3] >= 28, "{counts:?}");
}

/// Numbers that look random, from 0 to 1.
fn random(state: &mut u64) -> f64 {
    for shift in [13, 7, 17] {
        *state ^= if shift == 7 { *state >> shift } else { *state << shift };
    }
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

#[test]
fn urgent_ones_pass_as_if_there_were_no_others() {
    for rate in [25.0, 100.0, 200.0, 600.0] {
        let (mut alone, mut beside, mut state) = (Link::new(rate), Link::new(rate), 1);
        let (mut now, mut at) = (1_000 * MS, 0);
        for _ in 0..1_000 {
            now += (-(1.0 - random(&mut state)).ln() * SECOND / 3.0) as u64;
            while at < now {
                beside.passes(27, 40, false, at);
                at += 90 * MS;
            }
            let passes = alone.passes(76, 33, true, now);
            assert_eq!(beside.passes(76, 33, true, now), passes, "{rate} at {now}");
        }
    }
}

#[test]
fn of_any_mix_each_stream_gets_its_share() {
    for seed in 1..400_u64 {
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        let mut next = || random(&mut state);
        let kinds: Vec<Kind> = (0..2 + (30.0 * next()) as u32)
            .map(|msgid| (msgid + 1, 12 + (268.0 * next()) as usize, (500_f64.powf(next())) as u64))
            .collect();
        let wanted: f64 = kinds.iter().map(|kind| kind.1 as f64 * kind.2 as f64 / 10.0).sum();
        let rate = (wanted * (0.1 + 1.1 * next())).max(200.0);
        let interval = [0.001, 0.01, 0.1, 0.2][seed as usize % 4];
        let counts = Link::new(rate).in_batches(&kinds, interval, 1, 300);
        for ((&count, share), kind) in counts.iter().zip(fair(rate, &kinds)).zip(&kinds) {
            let share = share * 300.0;
            let near = share * 0.45 - 5.0..share * 1.4 + 5.0;
            assert!(near.contains(&(count as f64)), "{seed}: {count} of {kind:?}, not {share:.0}");
        }
    }
}

#[test]
fn whoever_is_silent_for_long_takes_a_few_rounds_at_once_and_no_more() {
    let mut link = Link::new(1_000.0);
    for second in 1..5 {
        link.passes(1, 40, false, 1_000 * second * MS);
    }
    for hundredth in 0..60_000_u64 {
        link.passes(30, 40, false, (5_000 + 10 * hundredth) * MS);
    }
    let now = 605_000 * MS;
    let burst = (0..100).filter(|_| link.passes(1, 40, false, now)).count();
    assert!((8..=36).contains(&burst), "{burst}");
    // Then both alike.
    let mut passed = [0; 2];
    for hundredth in 300..1_300_u64 {
        let now = now + 10 * hundredth * MS;
        passed[0] += u32::from(link.passes(30, 40, false, now));
        passed[1] += u32::from(link.passes(1, 40, false, now));
    }
    assert!(passed.iter().all(|passed| (100..=150).contains(passed)), "{passed:?}");
}

#[test]
fn what_a_stream_that_ended_had_is_the_others() {
    let mut link = Link::new(200.0);
    let nine: Vec<Kind> = (1..10).map(|msgid| (msgid, 40, 50)).collect();
    link.in_batches(&nine, 0.1, 1, 60);
    let counts = link.in_batches(&nine[..2], 0.1, 61, 10);
    assert!(counts.iter().all(|count| (20..=32).contains(count)), "{counts:?}");
}

#[test]
fn types_that_come_several_times_in_a_rare_burst_all_get_something() {
    // Of each kind in a burst, milliseconds between two, and bytes a second.
    for (times, apart, rate) in
        [(2, 2, 60.0), (2, 2, 100.0), (12, 0, 60.0), (12, 0, 100.0), (12, 2, 100.0)]
    {
        let (mut link, mut counts) = (Link::new(rate), [0; 10]);
        for burst in 0..120_u64 {
            for n in 0..10 * times {
                let now = (1_000 + 5_000 * burst + apart * (n / 10)) * MS;
                let kind = n as usize % 10;
                counts[kind] += u32::from(link.passes(kind as u32 + 1, 40, false, now));
            }
        }
        let (least, most) = (counts.iter().min().unwrap(), counts.iter().max().unwrap());
        assert!(3 * least > *most, "{counts:?}, {times} each {apart} ms at {rate}");
    }
}

#[test]
fn rare_types_pass_beside_steady_ones_and_do_not_stop_them() {
    // Rare types, bytes of each, tenths of a second between, bytes a second.
    for (rare, len, each, rate) in
        [(30, 40, 100, 300.0), (20, 50, 500, 100.0), (100, 40, 300, 600.0)]
    {
        let (mut link, mut counts, mut bytes) = (Link::new(rate), vec![0; rare as usize], 0);
        let (mut passed_at, mut longest) = (0, 0);
        for tenth in 0..6_000_u64 {
            let now = (1_000 + 100 * tenth) * MS;
            for msgid in 1_000..1_004 {
                if link.passes(msgid, 40, false, now) {
                    (bytes, passed_at) = (bytes + 40, tenth);
                }
            }
            for msgid in (0..rare).filter(|_| tenth % each == 50) {
                if link.passes(msgid + 1, len, false, now) {
                    counts[msgid as usize] += 1;
                    (bytes, passed_at) = (bytes + len, tenth);
                }
            }
            longest = longest.max(tenth - passed_at);
        }
        let told =
            format!("{rare} at {rate}: {counts:?}, {bytes} bytes, {longest} tenths of silence");
        assert!(bytes as f64 > 600.0 * rate * 0.9 && longest <= 50, "{told}");
        assert!(each > 100 || counts.iter().all(|&count| count > 6), "{told}");
    }
}

#[test]
fn made_up_streams_that_come_again_do_not_shut_out_the_others() {
    // How often each comes, after how many tenths of a second, and bytes.
    for (times, again, len) in
        [(2, 10, 40), (2, 50, 40), (2, 50, 280), (2, 200, 280), (4, 20, 40), (8, 20, 40)]
    {
        let (mut link, mut passed) = (Link::new(1_000.0), 0);
        for tenth in 0..3_000_u64 {
            let now = (1_000 + 100 * tenth) * MS;
            for since in (0..times).map(|n| n * again).filter(|&since| since <= tenth) {
                for n in 0..10 {
                    link.passes(1_000 + ((tenth - since) * 10 + n) as u32, len, false, now);
                }
            }
            for msgid in (100..110).filter(|_| tenth % 10 == 0) {
                passed += u32::from(link.passes(msgid, 40, false, now));
            }
        }
        // From the fifth message on a made-up stream is one like all.
        let least = if times < 5 { 2_400 } else { 500 };
        assert!(passed > least, "{passed} of 3,000 beside {times} of {len} bytes each {again}");
    }
}

#[test]
fn a_frame_for_several_peers_takes_one_turn() {
    let bytes = ByteRate::new(1_000.0);
    let mut passed = [0; 2];
    for (number, hundredth) in (0..12_000_u64).enumerate() {
        let now = (1_000 + 10 * hundredth) * MS;
        let kind = number % 2;
        for _ in 0..[5, 1][kind] {
            if bytes.allows(&header(V2, kind as u32 + 1, 0), 40, false, 1 + number as u64, now) {
                bytes.charge(40, now);
                passed[kind] += 1;
            }
        }
    }
    // 120,000 bytes: as many frames of 200 as of 40.
    assert!(passed[0] % 5 == 0 && (2_350..=2_650).contains(&passed[0]), "{passed:?}");
    assert!((470..=530).contains(&passed[1]), "{passed:?}");
}

#[test]
fn streams_that_are_too_many_are_forgotten_with_time() {
    let mut rounds = Rounds::new(1e6);
    for key in 0..2 * rounds::MAX_STREAMS as u64 {
        rounds.arrive(key, 40.0, key);
    }
    assert_eq!(rounds.known(), rounds::MAX_STREAMS);
    rounds.arrive(u64::MAX, 40.0, 2 * rounds::FORGOTTEN);
    assert_eq!(rounds.known(), 1);
}
