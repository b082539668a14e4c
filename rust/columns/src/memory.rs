//! Whether there is memory for what comes. What allocates deep within arrow, parquet or zstd ends the process where there is
//! none, so it is asked for beforehand.

use std::collections::TryReserveError;
use std::hint::black_box;

/// What a block of a log may need beside its tables. It is more than the largest span that glibc's allocator keeps for
/// itself once it was given back, so that asking changes nothing.
const SPARE: usize = 40 << 20;

/// Whether so many bytes are to be had now.
///
/// # Errors
/// They are not.
pub fn check(bytes: usize) -> Result<(), TryReserveError> {
    let mut room = Vec::<u8>::new();
    room.try_reserve_exact(bytes)?;
    black_box(&room); // else the compiler may leave both out, asking and giving back
    Ok(())
}

/// Whether so many bytes, beside what a block may need, are to be had now.
pub(crate) fn check_beside_spare(bytes: usize) -> Result<(), TryReserveError> {
    check(SPARE.saturating_add(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_is_an_end_to_memory() {
        check_beside_spare(1).expect("some");
        check(1 << 60).expect_err("more than any");
    }
}
