//! Every input of the corpus through its target.

use std::fs;
use std::path::Path;

use mavwire_fuzz::TARGETS;

#[test]
fn the_corpus_is_replayed() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    let folders = fs::read_dir(&corpus).expect("the corpus").count();
    assert_eq!(folders, TARGETS.len(), "a folder for each target");
    for (name, target) in TARGETS {
        target(b"");
        let inputs = fs::read_dir(corpus.join(name)).expect(name);
        let mut count = 0;
        for input in inputs.map(|input| input.expect(name).path()) {
            // Shown where the target panics.
            println!("{}", input.display());
            target(&fs::read(&input).expect(name));
            count += 1;
        }
        assert!(count > 0, "no corpus for {name}");
    }
}

#[test]
fn every_target_has_a_program() {
    let manifest = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml"));
    let manifest = manifest.expect("the manifest");
    for (name, _) in TARGETS {
        assert!(manifest.contains(&format!("fuzz_targets/{name}.rs")), "{name}");
    }
}
