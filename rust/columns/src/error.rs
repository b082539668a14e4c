//! What can go wrong.

/// Why columns could not be made or written.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The log could not be read, or the output not be written.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// What arrow says.
    #[error(transparent)]
    Arrow(#[from] arrow::error::ArrowError),
    /// What parquet says.
    #[error(transparent)]
    Parquet(#[from] parquet::errors::ParquetError),
    /// What mcap says.
    #[error("MCAP: {0}")]
    Mcap(mcap::McapError),
    /// An MCAP file of a log without times.
    #[error("MCAP needs a time for each message, and this log has none: convert to another format")]
    NoTimes,
    /// Some time is wanted of a raw stream, or of a dataflash log without a clock.
    #[error("the records of this log have no times: leave start and end out")]
    Untimed,
    /// More message types and senders than an MCAP file has room for.
    #[error("MCAP has room for {0} message types and senders: choose some types or systems")]
    TooManyChannels(usize),
    /// A column that the message does not have.
    #[error("{message} has no column {column:?}")]
    NoColumn {
        /// The message.
        message: String,
        /// What was asked for.
        column: String,
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
