//! The built-in definitions as one compact blob. Files stay encoded until they are asked for: a program that uses one
//! dialect decodes only the files that dialect includes.

use serde::{Deserialize, Serialize};

use crate::definitions::Definitions;
use crate::dialect::{Dialect, WireVersion};
use crate::error::{Reason, SchemaError};
use crate::parse::dialect_name;
use crate::resolve::resolve;

/// Encodes files for [`Library`] and [`decode_blob`]. The build script of `mavwire-core` does this once.
///
/// # Panics
/// Never: encoding plain data into memory cannot fail.
pub fn encode_blob(files: &[Definitions]) -> Vec<u8> {
    let bodies: Vec<Vec<u8>> = files.iter().map(encode).collect();
    let table: Vec<Encoded<'_>> =
        files.iter().zip(&bodies).map(|(file, body)| Encoded { name: &file.name, body }).collect();
    encode(&table)
}

fn encode<T: Serialize>(value: &T) -> Vec<u8> {
    postcard::to_allocvec(value).expect("encoding plain data into memory cannot fail")
}

/// Decodes all files of a blob made by [`encode_blob`].
///
/// # Errors
/// [`Reason::Blob`] where the bytes are not a blob of this version.
pub fn decode_blob(blob: &[u8]) -> Result<Vec<Definitions>, SchemaError> {
    Library::from_blob(blob)?.files.iter().map(Encoded::decode).collect()
}

/// A file of the blob.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Encoded<'a> {
    name: &'a str,
    body: &'a [u8],
}

impl Encoded<'_> {
    fn decode(&self) -> Result<Definitions, SchemaError> {
        postcard::from_bytes(self.body)
            .map_err(|error| SchemaError::new(self.name, Reason::Blob(error.to_string())))
    }
}

/// A set of definition files in a blob.
#[derive(Debug, Clone)]
pub struct Library<'a> {
    files: Vec<Encoded<'a>>,
}

impl<'a> Library<'a> {
    /// Opens a blob made by [`encode_blob`].
    ///
    /// # Errors
    /// [`Reason::Blob`] where the bytes are not a blob of this version.
    pub fn from_blob(blob: &'a [u8]) -> Result<Self, SchemaError> {
        match postcard::from_bytes(blob) {
            Ok(files) => Ok(Self { files }),
            Err(error) => Err(SchemaError::new("built-in", Reason::Blob(error.to_string()))),
        }
    }

    /// Names of the files, which are the names of the dialects, in the order they were encoded.
    pub fn names(&self) -> impl Iterator<Item = &'a str> + '_ {
        self.files.iter().map(|file| file.name)
    }

    /// The content of one file. `path` may have folders and `.xml`.
    ///
    /// # Errors
    /// [`Reason::NotFound`] where there is no such file.
    pub fn definitions(&self, path: &str) -> Result<Definitions, SchemaError> {
        let name = dialect_name(path);
        match self.files.iter().find(|file| file.name == name) {
            Some(file) => file.decode(),
            None => Err(SchemaError::new(path, Reason::NotFound)),
        }
    }

    /// A dialect of the library.
    ///
    /// # Errors
    /// [`Reason::NotFound`] where there is no such dialect.
    pub fn resolve(&self, name: &str, wire_version: WireVersion) -> Result<Dialect, SchemaError> {
        resolve(name, &mut |path| self.definitions(path), wire_version)
    }
}
