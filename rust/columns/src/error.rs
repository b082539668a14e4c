//! Errors of this crate.

use crate::common_schema::MixedColumn;

/// Why columns could not be made or written.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The log could not be read, or the output not be written.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// An error of arrow.
    #[error(transparent)]
    Arrow(#[from] arrow::error::ArrowError),
    /// An error of parquet.
    #[error(transparent)]
    Parquet(#[from] parquet::errors::ParquetError),
    /// An error of the `mcap` crate.
    #[error("MCAP: {0}")]
    Mcap(mcap::McapError),
    /// An MCAP file of a log without times.
    #[error(
        "MCAP needs a time stamp for each message, and this log has no time stamps: convert it to another format"
    )]
    NoTimes,
    /// `start` or `end` was given for a raw stream, or for a dataflash log without a clock.
    #[error("the records of this log have no time stamps: read it without start and end")]
    Untimed,
    /// More message types and senders than an MCAP file has room for.
    #[error("MCAP has room for {0} message types and senders: choose some types or systems")]
    TooManyChannels(usize),
    /// The log has more message types than the limit of files.
    #[error("more than {0} message types, and each would become a file: choose some types")]
    TooManyFiles(usize),
    /// A column that the message does not have.
    #[error("{message} has no column {column:?}")]
    NoColumn {
        /// The message.
        message: String,
        /// The column that was asked for.
        column: String,
    },
    /// The types of a column in two logs have no common type.
    #[error(transparent)]
    MixedColumn(#[from] Box<MixedColumn>),
    /// More columns of several logs than a frame may have.
    #[error(
        "the logs describe {columns} columns of {message}, and one frame has {most} at most: read fewer logs at \
         once, or choose columns (fields=, columns=)"
    )]
    TooManyColumns {
        /// The message.
        message: String,
        /// The columns of all logs.
        columns: usize,
        /// The limit.
        most: usize,
    },
}

impl From<mcap::McapError> for Error {
    fn from(error: mcap::McapError) -> Self {
        match error {
            mcap::McapError::Io(error) => Self::Io(error),
            error => Self::Mcap(error),
        }
    }
}
