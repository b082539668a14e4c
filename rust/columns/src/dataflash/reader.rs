//! A dataflash log that was surveyed as record batches.

use std::sync::Arc;

use super::decoder::Decoder;
use super::survey::{Open, Survey, begin};
use crate::error::Error;
use crate::reader::{Decode, Plan, Reader};

/// A reader of a log that was surveyed.
///
/// # Errors
/// Errors of reading.
pub fn reader(survey: Arc<Survey>, open: Open<'_>, plan: Plan) -> Result<Box<dyn Decode>, Error> {
    let (blocks, _) = begin(open, survey.steps)?;
    let (has_times, size) = (survey.clock.is_some(), survey.bytes);
    let decoder = Decoder::new(survey, plan);
    Ok(Box::new(Reader::new(blocks, decoder, has_times, size)))
}
