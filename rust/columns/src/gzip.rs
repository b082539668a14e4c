//! gzip as its own tool reads it: members one behind the other, and zeros as tapes and `dd` leave them behind or between.

use std::io::{self, BufRead, BufReader, Read};

use flate2::bufread::GzDecoder;

/// The first byte of a member.
const MAGIC: u8 = 0x1F;

/// What all members of a compressed file hold.
pub(crate) struct Members<R> {
    /// The one that is being read; `None` behind the last.
    member: Option<GzDecoder<BufReader<R>>>,
}

impl<R: Read> Members<R> {
    pub(crate) fn new(source: R) -> Self {
        Self { member: Some(GzDecoder::new(BufReader::new(source))) }
    }
}

impl<R: Read> Read for Members<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        while let Some(member) = &mut self.member {
            let len = member.read(into)?;
            if len > 0 || into.is_empty() {
                return Ok(len);
            }
            let rest = self.member.take().map(GzDecoder::into_inner);
            self.member = rest.map(following).transpose()?.flatten();
        }
        Ok(0)
    }
}

/// The member that follows, if one does.
fn following<R: Read>(mut rest: BufReader<R>) -> io::Result<Option<GzDecoder<BufReader<R>>>> {
    match skip_zeros(&mut rest)? {
        None => Ok(None),
        Some(MAGIC) => Ok(Some(GzDecoder::new(rest))),
        Some(_) => Err(io::Error::new(
            io::ErrorKind::InvalidData,
            "what follows its end is neither gzip nor padding",
        )),
    }
}

/// The first byte that is not zero, which stays unread.
fn skip_zeros(source: &mut impl BufRead) -> io::Result<Option<u8>> {
    loop {
        let bytes = match source.fill_buf() {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            bytes => bytes?,
        };
        let (zeros, len) = (bytes.iter().take_while(|&&byte| byte == 0).count(), bytes.len());
        let found = bytes.get(zeros).copied();
        source.consume(zeros);
        if found.is_some() || len == 0 {
            return Ok(found);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    fn packed(bytes: &[u8]) -> Vec<u8> {
        let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        gzip.write_all(bytes).expect("writing");
        gzip.finish().expect("writing")
    }

    /// What can be read, and why no more.
    fn unpacked(bytes: &[u8]) -> (Vec<u8>, Option<String>) {
        let mut read = Vec::new();
        let done = Members::new(bytes).read_to_end(&mut read);
        (read, done.err().map(|error| error.to_string()))
    }

    #[test]
    fn padding_is_no_damage() {
        let (one, two, zeros) = (packed(b"one"), packed(b"two"), vec![0; 20_000]);
        for parts in [vec![&one, &two], vec![&one, &zeros, &two], vec![&one, &two, &zeros]] {
            let all: Vec<u8> = parts.into_iter().flatten().copied().collect();
            assert_eq!(unpacked(&all), (b"onetwo".to_vec(), None));
        }
    }

    #[test]
    fn junk_behind_the_end_costs_nothing_before_it() {
        for junk in [&b"junk"[..], b"\0\0junk", b"\x1fjunk", b"\x1f"] {
            let (read, error) = unpacked(&[&packed(b"one"), junk].concat());
            assert_eq!(read, b"one");
            assert!(error.is_some(), "{junk:?}");
        }
    }

    #[test]
    fn a_cut_is_an_error() {
        let whole = packed(b"one");
        for len in 0..whole.len() {
            assert!(unpacked(&whole[..len]).1.is_some(), "{len} bytes");
        }
    }
}
