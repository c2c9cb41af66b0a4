//! Lines of text files, with a limit on their length.

use std::io::{self, BufRead, Read as _};

use crate::LONGEST_LINE;

/// The lines of a text without their ends, like [`BufRead::lines`]. A line above [`LONGEST_LINE`] is an error, because a file
/// without line ends would otherwise fill memory. The iterator ends after an error.
pub fn bounded_lines(mut reader: impl BufRead) -> impl Iterator<Item = io::Result<String>> {
    let mut failed = false;
    std::iter::from_fn(move || {
        if failed {
            return None;
        }
        let line = next(&mut reader);
        failed = line.is_err();
        line.transpose()
    })
}

fn next(reader: &mut impl BufRead) -> io::Result<Option<String>> {
    let mut bytes = Vec::new();
    let read = reader.by_ref().take(LONGEST_LINE + 1).read_until(b'\n', &mut bytes)?;
    if read == 0 {
        return Ok(None);
    }
    if read as u64 > LONGEST_LINE {
        let message = format!("a line is longer than {} MiB; write one record per line", LONGEST_LINE >> 20);
        return Err(io::Error::new(io::ErrorKind::InvalidData, message));
    }
    if bytes.last() == Some(&b'\n') {
        bytes.pop();
        if bytes.last() == Some(&b'\r') {
            bytes.pop();
        }
    }
    let text = String::from_utf8(bytes).map_err(|_| {
        io::Error::new(io::ErrorKind::InvalidData, "a line is not UTF-8; save the file as text in UTF-8")
    })?;
    Ok(Some(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_those_of_the_standard_library() {
        let text = "a\n\nb\r\nc\r\r\nd\r";
        let ours: Vec<String> = bounded_lines(text.as_bytes()).map(Result::unwrap).collect();
        assert_eq!(ours, text.as_bytes().lines().map(Result::unwrap).collect::<Vec<_>>());
    }

    #[test]
    fn a_file_without_line_ends_is_refused_before_it_fills_memory() {
        let mut lines = bounded_lines(io::BufReader::new(io::repeat(b'x')));
        assert!(lines.next().unwrap().unwrap_err().to_string().contains("16 MiB"));
        assert!(lines.next().is_none(), "an endless file ends with its error");
        assert!(bounded_lines(&b"\xff\n"[..]).next().unwrap().unwrap_err().to_string().contains("UTF-8"));
    }
}
