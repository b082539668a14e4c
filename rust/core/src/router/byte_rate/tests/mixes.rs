//! Random mixes of streams: how near each comes to its max-min share. The table that decision 8 is about:
//! `cargo test --release -p mavwire-core mixes -- --ignored --nocapture`.

use super::*;

const SECONDS: f64 = 300.0;
/// Streams come for so many seconds and rest for as many, half of them while the others rest.
const SPELL: f64 = 7.0;

/// When messages come.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Pattern {
    Evenly,
    AtRandomTimes,
    /// So many seconds from one batch to the next.
    InBatches(f64),
    WithRests,
}

use Pattern::{AtRandomTimes, Evenly, InBatches, WithRests};

/// Of each, what share of the streams must be within 20% of their share, and what the worst one has of it, and the best.
const PATTERNS: [(Pattern, f64, f64, f64); 7] = [
    (Evenly, 0.99, 0.3, 8.0),
    (AtRandomTimes, 0.98, 0.3, 8.0),
    (InBatches(0.1), 0.98, 0.3, 8.0),
    (InBatches(0.2), 0.95, 0.3, 8.0),
    (InBatches(0.5), 0.8, 0.2, 8.0),
    (InBatches(1.0), 0.6, 0.1, 10.0),
    (WithRests, 0.95, 0.1, 8.0),
];

struct Stream {
    len: usize,
    hertz: f64,
    times: Vec<f64>,
}

/// Numbers that look random, from 0 to 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        random(&mut self.0)
    }
}

/// Whether a stream comes at that time, where streams rest.
fn is_awake(stream: usize, time: f64) -> bool {
    ((time / SPELL) as usize + stream).is_multiple_of(2)
}

fn stream(number: usize, pattern: Pattern, random: &mut Random) -> Stream {
    let len = 12 + (268.0 * random.next()) as usize;
    let hertz = 0.1 * 500_f64.powf(random.next());
    let (mut time, mut times) = (random.next() / hertz, Vec::new());
    while time < SECONDS {
        if pattern != WithRests || is_awake(number, time) {
            times.push(match pattern {
                InBatches(interval) => (time / interval).floor() * interval,
                _ => time,
            });
        }
        let pauses = if pattern == AtRandomTimes { -(1.0 - random.next()).ln() } else { 1.0 };
        time += pauses / hertz;
    }
    Stream { len, hertz, times }
}

/// How many messages of each should pass.
fn shares(streams: &[Stream], pattern: Pattern, rate: f64) -> Vec<f64> {
    let shares = |hertz: &dyn Fn(usize, &Stream) -> f64| {
        let asked = streams.iter().enumerate().map(|(n, stream)| (hertz(n, stream), stream.len));
        fair(rate, &asked.collect::<Vec<_>>())
    };
    if pattern != WithRests {
        let all = shares(&|_, stream| stream.times.len() as f64 / SECONDS);
        return all.iter().map(|share| share * SECONDS).collect();
    }
    let while_awake = |spell: f64| {
        let hertz = |n, stream: &Stream| {
            if is_awake(n, spell * SPELL) { stream.hertz } else { 0.0 }
        };
        shares(&hertz)
    };
    let (even, odd) = (while_awake(0.0), while_awake(1.0));
    even.iter().zip(odd).map(|(one, other)| f64::midpoint(*one, other) * SECONDS).collect()
}

/// Messages that passed, divided by the fair share, for each stream of a mix whose share is 20 messages or more.
fn shares_got(seed: u64, pattern: Pattern) -> Vec<f64> {
    let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    let count = 2 + (30.0 * random.next()) as usize;
    let streams: Vec<_> = (0..count).map(|n| stream(n, pattern, &mut random)).collect();
    let asked: f64 = streams.iter().map(|stream| stream.hertz * stream.len as f64).sum();
    let rate = (asked * (0.1 + 1.1 * random.next())).max(200.0);
    let mut messages = Vec::new();
    for (n, stream) in streams.iter().enumerate() {
        messages.extend(stream.times.iter().map(|time| (1_000 * MS + (time * SECOND) as u64, n)));
    }
    messages.sort_unstable();
    let (mut link, mut counts) = (Link::new(rate), vec![0; count]);
    for (now, n) in messages {
        counts[n] += u32::from(link.passes(n as u32 + 1, streams[n].len, false, now));
    }
    let shares = shares(&streams, pattern, rate).into_iter().zip(counts);
    shares.filter(|&(share, _)| share >= 20.0).map(|(share, got)| f64::from(got) / share).collect()
}

#[expect(clippy::print_stdout, reason = "the table")]
fn check_mixes(count: u64) {
    for (pattern, near, least, most) in PATTERNS {
        let mut got: Vec<f64> = (1..=count).flat_map(|seed| shares_got(seed, pattern)).collect();
        got.sort_unstable_by(f64::total_cmp);
        let is_near = got.iter().filter(|got| (0.8..=1.2).contains(*got)).count() as f64;
        let is_near = is_near / got.len() as f64;
        let (first, last) = (got[0], got[got.len() - 1]);
        let told = format!(
            "{pattern:?}: {count} mixes of {} streams, {:.1}% within 20% of their share, all from {first:.2} to {last:.2}",
            got.len(),
            100.0 * is_near
        );
        println!("{told}");
        assert!(is_near >= near && first >= least && last <= most, "{told}");
    }
}

#[test]
fn of_any_mix_each_stream_gets_its_share() {
    check_mixes(20);
}

#[test]
#[ignore = "takes long: the numbers of decision 8"]
fn of_many_mixes_each_stream_gets_its_share() {
    check_mixes(1_000);
}
