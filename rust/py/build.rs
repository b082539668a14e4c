//! Passes on what PyO3 found out about the interpreter (`Py_GIL_DISABLED`), and puts the definitions beside the dialects.

use std::error::Error;
use std::fs;
use std::path::Path;

const DEFINITIONS: &str = "../../message_definitions/v1.0";
const DIALECTS: &str = "../../python/mavwire/dialects";

fn main() -> Result<(), Box<dyn Error>> {
    pyo3_build_config::use_pyo3_cfgs();
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed={DEFINITIONS}");
    for folder in ["v10", "v20"] {
        copy_definitions(&Path::new(DIALECTS).join(folder))?;
    }
    Ok(())
}

/// Programs read the XML beside pymavlink's dialects, which has the same files for both wire protocols.
fn copy_definitions(folder: &Path) -> Result<(), Box<dyn Error>> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let is_xml = entry.path().extension().is_some_and(|extension| extension == "xml");
        if is_xml && !Path::new(DEFINITIONS).join(entry.file_name()).exists() {
            fs::remove_file(entry.path())?;
        }
    }
    for entry in fs::read_dir(DEFINITIONS)? {
        let entry = entry?;
        let copy = folder.join(entry.file_name());
        println!("cargo::rerun-if-changed={}", copy.display());
        let text = fs::read(entry.path())?;
        if fs::read(&copy).is_ok_and(|before| before == text) {
            continue;
        }
        fs::write(&copy, text)?;
        // Cargo runs this again where a file is newer than the build.
        let file = fs::File::options().write(true).open(&copy)?;
        file.set_modified(entry.metadata()?.modified()?)?;
    }
    Ok(())
}
