//! A whole log in one pass, where the log says about itself what matters before it matters.
//!
//! Most do: they describe a type before its first record, and have a GPS fix in the first block. So the records of a block are
//! decoded by what is known by then, and what later blocks add is taken in if it changes nothing about the rows that are
//! there already. If it does, these are thrown away, and the pass goes on as a survey alone: nothing was handed out.

use std::sync::Arc;

use super::decoder::Decoder;
use super::run::Run;
use super::survey::{Form, Open, Survey, begin};
use crate::error::Error;
use crate::input::{Blocks, Steps};
use crate::pool;
use crate::reader::{Batch, Plan, TakeIn};

/// A log that was gone through.
pub struct Whole {
    /// The log's description of itself.
    pub survey: Survey,
    /// Its rows, and how many bytes belong to no record; `None` where they take another pass, by what is known now.
    pub rows: Option<(Vec<Batch>, u64)>,
}

/// Reads a log in one pass, or surveys it where that does not do; `None` if it is no dataflash log. `pulse` is asked now and
/// then whether to go on.
///
/// # Errors
/// Errors of reading, and the error that `pulse` returns.
pub fn read_whole<E: From<Error>>(
    steps: Steps,
    open: Open<'_>,
    plan: &Plan,
    mut pulse: impl FnMut() -> Result<(), E>,
) -> Result<Option<Whole>, E> {
    let (mut blocks, form) = begin(open, steps).map_err(Error::from)?;
    let Some(form) = form else { return Ok(None) };
    let mut pass = Pass::new(Run::new(form, steps), plan, blocks.is_whole());
    while pool::a_while(|| pass.advance(&mut blocks))? {
        pulse()?;
    }
    let Pass { run, decoder, mut batches, bad_bytes, .. } = pass;
    let Some(mut decoder) = decoder else {
        let survey = run.finish(blocks, open, pulse)?;
        return Ok(Some(Whole { survey, rows: None }));
    };
    batches.extend(decoder.rest()?.unwrap_or_default());
    Ok(Some(Whole { survey: run.survey(), rows: Some((batches, bad_bytes)) }))
}

/// A pass over a log.
struct Pass<'a> {
    run: Run,
    plan: &'a Plan,
    /// Whether the first block is the whole log, as far as can be said.
    is_short: bool,
    /// `None` before the first block, and where one pass does not do.
    decoder: Option<Box<Decoder>>,
    /// Batches that are held back: there may be other ones in their place.
    batches: Vec<Batch>,
    bad_bytes: u64,
}

impl<'a> Pass<'a> {
    fn new(run: Run, plan: &'a Plan, is_short: bool) -> Self {
        Self { run, plan, is_short, decoder: None, batches: Vec::new(), bad_bytes: 0 }
    }

    /// Takes in another block; false at the end of the log, or where there is no use in going on.
    fn advance(&mut self, blocks: &mut Blocks) -> Result<bool, Error> {
        let more = blocks.next(|block, at_end| {
            let is_first = self.run.offset == 0;
            let seen = self.run.add(block, at_end);
            self.decoder = if is_first { self.begin() } else { self.extended() };
            if let Some(decoder) = &mut self.decoder {
                let walked = decoder.walk.follow(seen.bytes, seen.hops);
                let done = self.run.offset as f64 / self.plan.size as f64;
                self.bad_bytes += walked.bad_bytes();
                let portions = decoder.portions(&walked);
                let take_in = |some| decoder.take_in(seen.bytes, &walked, some, done);
                return (seen.consumed, portions.map(take_in).collect::<Result<Vec<_>, _>>());
            }
            (seen.consumed, Ok(Vec::new()))
        })?;
        if self.decoder.is_none() {
            self.batches.clear();
            return Ok(false);
        }
        let Some(batches) = more else { return Ok(false) };
        self.batches.extend(batches?.into_iter().flatten());
        Ok(true)
    }

    /// A decoder that starts with what the first block says, if that tells all times.
    fn begin(&self) -> Option<Box<Decoder>> {
        let survey = self.run.survey();
        let is_binary = matches!(survey.form, Form::Binary(_));
        let is_told = self.is_short || self.run.finder.is_settled();
        let does = is_binary && is_told && survey.clock.is_some();
        does.then(|| Box::new(Decoder::new(Arc::new(survey), self.plan.clone())))
    }

    /// The decoder with what is new in this block, unless that makes other rows of what it has had.
    fn extended(&mut self) -> Option<Box<Decoder>> {
        let mut decoder = self.decoder.take()?;
        let goes_on = !self.run.knows_more_than(decoder.survey())
            || (!self.run.missed && decoder.extend(self.run.survey()));
        goes_on.then_some(decoder)
    }
}
