//! Every input of the corpus through its target, as it is and a little changed: fuzzing for any toolchain, without a look
//! at what is covered. `FUZZ_MUTATIONS` says how many changed copies of each input are tried, `FUZZ_TARGET` of which target
//! alone.

use std::fs;
use std::panic::catch_unwind;
use std::path::Path;

use mavwire_fuzz::{TARGETS, Target};

/// All targets, or the one that is asked for.
fn targets() -> impl Iterator<Item = (&'static str, Target)> {
    let only = std::env::var("FUZZ_TARGET").ok();
    let all = TARGETS.iter().copied();
    all.filter(move |(name, _)| only.as_ref().is_none_or(|only| only == name))
}

/// Name and bytes of a target's inputs, sorted.
fn inputs(name: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(name);
    let paths = fs::read_dir(&folder).expect(name).map(|entry| entry.expect(name).path());
    let mut found: Vec<_> =
        paths.map(|path| (path.display().to_string(), fs::read(path).expect(name))).collect();
    found.sort();
    assert!(!found.is_empty(), "no corpus for {name}");
    found
}

fn holds(name: &str, target: Target, input: &[u8]) {
    assert!(catch_unwind(|| target(input)).is_ok(), "{name} does not hold for {input:?}");
}

#[test]
fn the_corpus_is_replayed() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    let folders = fs::read_dir(&corpus).expect("the corpus").count();
    assert_eq!(folders, TARGETS.len(), "a folder for each target");
    for (name, target) in targets() {
        target(b"");
        for (path, input) in inputs(name) {
            holds(&path, target, &input);
        }
    }
}

/// Numbers that look random and are the same each time.
struct Noise(u64);

impl Noise {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % end.max(1)
    }
}

/// A copy of `input` with bits flipped, bytes set, pieces lost and pieces of `other` put in.
fn mutated(input: &[u8], other: &[u8], noise: &mut Noise) -> Vec<u8> {
    let mut copy = input.to_vec();
    for _ in 0..=noise.below(6) {
        let at = noise.below(copy.len() + 1);
        let end = (at + noise.below(40)).min(copy.len());
        let from = noise.below(other.len() + 1);
        match noise.below(5) {
            0 if at < copy.len() => copy[at] ^= 1 << noise.below(8),
            1 if at < copy.len() => copy[at] = [0, 1, 0xA3, 0xFD, 0xFE, 0xFF][noise.below(6)],
            2 => drop(copy.drain(at..end)),
            3 => copy.truncate(at.max(copy.len() / 2)),
            _ => {
                let piece = &other[from..(from + noise.below(80)).min(other.len())];
                copy.splice(at..at, piece.iter().copied());
            }
        }
    }
    copy
}

#[test]
fn the_corpus_is_replayed_with_changes() {
    let wanted = std::env::var("FUZZ_MUTATIONS").ok().and_then(|count| count.parse().ok());
    let mut noise = Noise(88_172_645_463_325_252);
    for (name, target) in targets() {
        let inputs = inputs(name);
        for (_, input) in &inputs {
            for _ in 0..wanted.unwrap_or((120 / inputs.len()).clamp(4, 20)) {
                let other = &inputs[noise.below(inputs.len())].1;
                holds(name, target, &mutated(input, other, &mut noise));
            }
        }
    }
}

/// The programs in the manifest: their names and paths.
fn programs() -> Vec<(String, String)> {
    let manifest = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml"));
    let manifest = manifest.expect("the manifest");
    let value = |lines: &str, key: &str| {
        let line = lines.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(" = "));
        line.expect(key).trim_matches('"').to_owned()
    };
    let bins = manifest.split("[[bin]]\n").skip(1);
    bins.map(|lines| (value(lines, "name"), value(lines, "path"))).collect()
}

#[test]
fn every_target_has_a_program_of_its_own() {
    let names: Vec<_> = TARGETS.iter().map(|&(name, _)| name).collect();
    assert!(names.is_sorted(), "{names:?}");
    let expected = |name: &&str| (String::from(*name), format!("fuzz_targets/{name}.rs"));
    assert_eq!(programs(), names.iter().map(expected).collect::<Vec<_>>());
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let files = fs::read_dir(root.join("fuzz_targets")).expect("the programs");
    assert_eq!(files.count(), names.len());
    for name in names {
        let path = root.join(format!("fuzz_targets/{name}.rs"));
        let program = fs::read_to_string(&path).expect(name);
        let call = format!("|data: &[u8]| mavwire_fuzz::{name}(data));");
        assert!(program.contains(&call), "{name}.rs runs another target");
    }
}
