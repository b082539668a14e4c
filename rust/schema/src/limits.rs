//! Caps on what a definition may ask for. XML comes from users and downloads, so that everything whose cost grows with
//! its content has a bound, far above any real dialect (the largest shipped file has 0.6 MB and 1,700 enum entries).

/// Bytes of one XML text.
pub const MAX_TEXT_LEN: usize = 16 << 20;
/// Elements inside elements; a definition needs 6.
pub const MAX_DEPTH: usize = 16;
/// Attributes of one element; a definition needs 14.
pub const MAX_ATTRIBUTES: usize = 32;
/// Namespace declarations in one file; upstream files have at most one.
pub const MAX_NAMESPACES: usize = 8;
/// Nodes (elements, texts, comments) in one file.
pub const MAX_NODES: u32 = 500_000;
/// Characters of a name; the longest shipped one has 60.
pub const MAX_NAME_LEN: usize = 128;
/// Bytes of an include's path.
pub const MAX_PATH_LEN: usize = 4096;
/// Fields of one message.
pub const MAX_FIELDS: usize = 64;
/// Payload bytes of one message.
pub const MAX_PAYLOAD_LEN: usize = 255;
/// Largest message id: three bytes on the wire.
pub const MAX_MESSAGE_ID: u32 = (1 << 24) - 1;
/// Messages of one dialect.
pub const MAX_MESSAGES: usize = 16_384;
/// Enum entries of one dialect.
pub const MAX_ENUM_ENTRIES: usize = 131_072;
/// Files of one dialect; `all` has 19.
pub const MAX_FILES: usize = 64;
/// Levels of includes below the main file.
pub const MAX_INCLUDE_DEPTH: usize = 5;
