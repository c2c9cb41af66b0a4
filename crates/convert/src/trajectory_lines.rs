//! Trajectory files: one pose a line, with a fixed number of numbers.

use std::io::BufRead;

use crate::ConvertError;
use crate::error::number;
use crate::lines::lines;

/// The layout of a format's lines.
pub(crate) struct Layout {
    /// How many numbers a line has.
    pub(crate) count: usize,
    /// The numbers in words, for messages.
    pub(crate) described: &'static str,
    /// The format's name.
    pub(crate) format: &'static str,
    /// Whether a line that starts with `#` is a comment.
    pub(crate) comments: bool,
}

/// The numbers of each line that is neither blank nor a comment, with its line number, counted from 1.
pub(crate) fn numbers<'a>(
    file: &'a str,
    reader: impl BufRead + 'a,
    layout: &'a Layout,
) -> impl Iterator<Item = Result<(u64, Vec<f64>), ConvertError>> + 'a {
    lines(file, reader).filter_map(move |read| {
        let (place, line) = match read {
            Ok(read) => read,
            Err(error) => return Some(Err(error)),
        };
        let fields: Vec<&str> = line.split_whitespace().collect();
        let first = fields.first()?;
        if layout.comments && first.starts_with('#') {
            return None;
        }
        if fields.len() != layout.count {
            return Some(Err(ConvertError::line(
                file,
                place,
                format!("expected {}, found {}", layout.described, fields.len()),
                format!("the line is cut short, or the file is not a {} trajectory", layout.format),
            )));
        }
        let parsed: Result<Vec<f64>, _> = fields.iter().map(|field| number(file, place, field)).collect();
        Some(parsed.map(|numbers| (place, numbers)))
    })
}
