//! An output of any format that cannot be written fails with the operating system's error.

use std::error::Error;
use std::io::{self, Write};
use std::sync::Arc;

use mavwire_columns::Error as Failed;
use mavwire_columns::arrow::array::{ArrayRef, Int64Array, RecordBatch};
use mavwire_columns::convert::{Compression, Format, Sink};

const ENOSPC: i32 = 28;

/// A disk with so much room.
struct Disk(usize);

impl Write for Disk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let full = || io::Error::from_raw_os_error(ENOSPC);
        self.0 = self.0.checked_sub(bytes.len()).ok_or_else(full)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn write(disk: Disk, format: Format, compression: Compression) -> Result<(), Failed> {
    // Neither the numbers nor the differences repeat.
    let numbers = (1..20_000_i64).map(|n| n.wrapping_mul(n).wrapping_mul(0x1E37_79B9_7F4A_7C15));
    let numbers = numbers.map(|n| n ^ (n >> 29));
    let column: ArrayRef = Arc::new(Int64Array::from_iter_values(numbers));
    let rows = RecordBatch::try_from_iter([("n", column)])?;
    let mut sink = Sink::new(disk, &rows.schema(), format, compression)?;
    for _ in 0..3 {
        sink.write(&rows)?;
    }
    sink.finish()?;
    Ok(())
}

#[test]
fn every_format_says_that_a_disk_is_full() {
    let ways = [
        (Format::Parquet, Compression::Zstd),
        (Format::Csv, Compression::None),
        (Format::Csv, Compression::Gzip),
        (Format::JsonLines, Compression::None),
        (Format::JsonLines, Compression::Zstd),
        (Format::Arrow, Compression::None),
    ];
    for (format, compression) in ways {
        write(Disk(usize::MAX), format, compression).expect("a file");
        for room in [0, 100_000] {
            let error = write(Disk(room), format, compression).expect_err("a full disk");
            let first: &(dyn Error + 'static) = match &error {
                Failed::Io(error) => error,
                Failed::Arrow(error) => error,
                Failed::Parquet(error) => error,
                other => other,
            };
            let causes = std::iter::successors(Some(first), |&error| error.source());
            let codes =
                |cause: &(dyn Error + 'static)| cause.downcast_ref::<io::Error>()?.raw_os_error();
            let mut codes = causes.filter_map(codes);
            assert_eq!(codes.next(), Some(ENOSPC), "{format:?} with {compression:?}: {error}");
        }
    }
}
