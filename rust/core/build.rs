//! Puts the facts of all dialects into the crate: every file of `message_definitions` is read by the functions that read
//! a user's XML at run time, and written as one compact blob.

use mavwire_schema::{ParseOptions, encode_blob, parse_definitions};
use std::error::Error;
use std::path::Path;
use std::{env, fs};

/// The dialects of pymavlink, and the union of what both upstreams define.
const DEFINITIONS: [&str; 2] =
    ["../../message_definitions/v1.0", "../../message_definitions/upstream"];

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    let mut paths = Vec::new();
    for folder in DEFINITIONS {
        println!("cargo::rerun-if-changed={folder}");
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            if path.extension().is_some_and(|extension| extension == "xml") {
                paths.push(path);
            }
        }
    }
    paths.sort();
    let mut files = Vec::new();
    for path in paths {
        let text = fs::read_to_string(&path)?;
        files.push(parse_definitions(&path.to_string_lossy(), &text, &ParseOptions::default())?);
    }
    let out = env::var("OUT_DIR")?;
    fs::write(Path::new(&out).join("definitions.bin"), encode_blob(&files))?;
    Ok(())
}
