//! Errors of the operating system in words.

use std::io;

/// The text of an error without the number that Rust adds: "Connection refused", not "(os error 111)".
#[must_use]
pub fn in_words(error: &io::Error) -> String {
    let mut text = error.to_string();
    if let Some(code) = error.raw_os_error() {
        let number = format!(" (os error {code})");
        text.truncate(text.strip_suffix(&number).unwrap_or(&text).len());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaves_the_number_out() {
        let numbered = io::Error::from_raw_os_error(2);
        assert!(numbered.to_string().ends_with(" (os error 2)"));
        assert_eq!(format!("{} (os error 2)", in_words(&numbered)), numbered.to_string());
        assert_eq!(
            in_words(&io::Error::other("its own words (os error 2)")),
            "its own words (os error 2)"
        );
    }
}
