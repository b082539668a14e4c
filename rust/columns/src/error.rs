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
    /// A column that the message does not have.
    #[error("{message} has no column {column:?}")]
    NoColumn {
        /// The message.
        message: String,
        /// What was asked for.
        column: String,
    },
}
