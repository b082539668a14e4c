//! The summary of a dataflash log, counted in one pass.

use std::sync::Arc;

use super::record_times::RecordTimes;
use super::survey::{NO_TABLE, Open, Survey, begin};
use crate::error::Error;
use crate::summary::{Count, Summary};

/// Reads a log to its end; types are counted by table. See [`Summary::read`].
///
/// # Errors
/// Errors of reading, and the error that `pulse` returns.
pub fn summary<E: From<Error>>(
    survey: &Arc<Survey>,
    open: Open<'_>,
    gap: u64,
    mut pulse: impl FnMut(u64) -> Result<(), E>,
) -> Result<Summary, E> {
    let (mut blocks, _) = begin(open, survey.steps).map_err(Error::from)?;
    let mut walk = RecordTimes::new(Arc::clone(survey));
    let types = vec![Count::default(); survey.tables.len()];
    let mut sum = Summary { stamped: survey.clock.is_some(), types, ..Summary::default() };
    loop {
        let next = blocks.next(|block, at_end| {
            let walked = walk.block(block, at_end);
            for (place, time) in walked.stretches.iter().flat_map(|some| walk.timed(block, some)) {
                let time = survey.clock.is_some().then(|| u64::try_from(time).unwrap_or(0));
                let moment = sum.add_time(time, gap);
                let table = survey.table_of[usize::from(place.layout)];
                if table == NO_TABLE {
                    sum.unknown.unlisted += 1;
                } else {
                    sum.types[usize::from(table)].add(moment);
                }
            }
            sum.add_bad(&walked.bad);
            sum.bytes += walked.consumed as u64;
            (walked.consumed, ())
        });
        if next.map_err(Error::from)?.is_none() {
            sum.damage = blocks.damage().map(str::to_owned);
            return Ok(sum);
        }
        pulse(sum.bytes)?;
    }
}
