//! Puts the facts of all dialects into the crate: every file of `message_definitions` is read by the functions that read
//! a user's XML at run time, and written as one compact blob.

use mavwire_schema::{ParseOptions, encode_blob, parse_definitions};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// The dialects of pymavlink, and the union of what both upstreams define.
const DEFINITIONS: [&str; 2] =
    ["../../message_definitions/v1.0", "../../message_definitions/upstream"];

/// Layouts that message ids had before. An id occurs several times, so that this is no dialect.
const HISTORY: &str = "upstream/history.xml";

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    let mut paths = Vec::new();
    for folder in DEFINITIONS {
        println!("cargo::rerun-if-changed={folder}");
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            let is_xml = path.extension().is_some_and(|extension| extension == "xml");
            if is_xml && !path.ends_with(HISTORY) {
                paths.push(path);
            }
        }
    }
    paths.sort_by(|a, b| a.file_name().cmp(&b.file_name()));
    write("definitions.bin", &paths)?;
    write("history.bin", &[Path::new("../../message_definitions").join(HISTORY)])
}

fn write(name: &str, paths: &[PathBuf]) -> Result<(), Box<dyn Error>> {
    let mut files = Vec::new();
    for path in paths {
        let text = fs::read_to_string(path)?;
        files.push(parse_definitions(&path.to_string_lossy(), &text, &ParseOptions::default())?);
    }
    let out = env::var("OUT_DIR")?;
    fs::write(Path::new(&out).join(name), encode_blob(&files))?;
    Ok(())
}
