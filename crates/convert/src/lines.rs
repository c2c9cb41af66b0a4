//! Reads the lines of a text file with their numbers.

use std::io::BufRead;

use posecut_graph::bounded_lines;

use crate::ConvertError;

/// Editors on Windows write this before the text.
const BYTE_ORDER_MARK: char = '\u{feff}';

/// The lines of a file with their numbers, counted from 1, without a byte order mark. Errors name the line.
pub(crate) fn lines(
    file: &str,
    reader: impl BufRead,
) -> impl Iterator<Item = Result<(u64, String), ConvertError>> {
    bounded_lines(reader).zip(1..).map(move |(read, line)| match read {
        Ok(text) => Ok((
            line,
            text.strip_prefix(BYTE_ORDER_MARK).filter(|_| line == 1).map(str::to_owned).unwrap_or(text),
        )),
        Err(error) => Err(ConvertError::Io { file: file.to_owned(), line, error }),
    })
}
