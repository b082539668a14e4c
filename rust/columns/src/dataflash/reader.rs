//! A dataflash log that was surveyed as record batches.

use std::sync::Arc;

use super::decoder::{Decoder, Wanted};
use super::record_times::Walked;
use super::survey::{Open, Survey, begin};
use crate::error::Error;
use crate::input::Blocks;
use crate::layout::Options;
use crate::reader::{Batch, Decode, Limits};
use crate::row_block::Rest;

/// A log being decoded.
pub struct Reader {
    survey: Arc<Survey>,
    blocks: Blocks,
    decoder: Decoder,
    rest: Option<Rest<Walked>>,
    position: u64,
    bad_bytes: u64,
}

impl Reader {
    /// A reader of a log that was surveyed.
    ///
    /// # Errors
    /// What reading says.
    pub fn new(
        survey: Arc<Survey>,
        open: Open<'_>,
        wanted: Wanted,
        options: &Options,
        limits: Limits,
    ) -> Result<Self, Error> {
        let (blocks, _) = begin(open, survey.steps)?;
        let decoder = Decoder::new(Arc::clone(&survey), wanted, options.clone(), limits);
        Ok(Self { survey, blocks, decoder, rest: None, position: 0, bad_bytes: 0 })
    }
}

impl Decode for Reader {
    fn position(&self) -> u64 {
        self.position
    }

    fn bad_bytes(&self) -> u64 {
        self.bad_bytes
    }

    fn is_within_block(&self) -> bool {
        self.rest.is_some()
    }

    fn has_times(&self) -> bool {
        self.survey.clock.is_some()
    }

    fn damage(&self) -> Option<&str> {
        self.blocks.damage()
    }

    fn advance(&mut self) -> Result<Option<Vec<Batch>>, Error> {
        let Self { survey, blocks, decoder, rest, position, .. } = self;
        if let Some(mut left) = rest.take()
            && let Some(some) = left.portions.next()
        {
            let batches = decoder.take_in(&left.block, &left.found.stretches[some], left.done);
            *rest = Some(left);
            return batches.map(Some);
        }
        let read = blocks.next(|block, at_end| {
            let walked = decoder.walk.block(block, at_end);
            let done = (*position + walked.consumed as u64) as f64 / survey.bytes as f64;
            let mut portions = decoder.portions(&walked);
            let batches = portions.next().map_or(Ok(Vec::new()), |some| {
                decoder.take_in(block, &walked.stretches[some], done)
            });
            let (consumed, bad) = (walked.consumed, walked.bad_bytes());
            *rest = Rest::of(&block[..consumed], walked, portions, done);
            (consumed, (consumed, bad, batches))
        })?;
        let Some((consumed, bad, batches)) = read else { return self.decoder.rest() };
        self.position += consumed as u64;
        self.bad_bytes += bad;
        batches.map(Some)
    }
}
