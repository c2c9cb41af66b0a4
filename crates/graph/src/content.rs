//! Recognises formats of pose graphs and trajectories by the first bytes of a file.

use std::fmt;

use crate::error::Problem;

/// The first bytes of a zip archive.
const ZIP: &[u8] = b"PK\x03\x04";

/// Keys that the object of a JRL dataset has, and no record of JSON Lines.
const JRL_KEYS: [&[u8]; 8] = [
    b"robots",
    b"measurements",
    b"groundtruth",
    b"initialization",
    b"potential_outlier_factors",
    b"outlier_factors",
    b"dataset_name",
    b"solutions",
];

/// What a file contains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// Pose-graph JSON Lines.
    JsonLines,
    /// A g2o graph: `VERTEX_SE2`, `EDGE_SE3:QUAT`, …
    G2o,
    /// A TORO graph: `VERTEX2`, `EDGE3`, …
    Toro,
    /// A JSON Robot Log: one JSON object.
    Jrl,
    /// A TUM trajectory: eight numbers a line.
    Tum,
    /// A KITTI trajectory: twelve numbers a line.
    Kitti,
    /// A zip archive, such as evo's results.
    Zip,
    /// CBOR, the binary form of JSON, such as a compressed JRL dataset.
    Cbor,
}

impl Content {
    /// Recognises content by its first bytes: the more, the surer. `None` if it is of none of these formats, or too little is known.
    /// Comments (`#`) and blank lines at the start do not count.
    pub fn of(head: &[u8]) -> Option<Self> {
        if head.starts_with(ZIP) {
            return Some(Self::Zip);
        }
        // The major type of CBOR's maps is 5. In UTF-8 no character starts with such a byte.
        if head.first().is_some_and(|byte| byte >> 5 == 5) {
            return Some(Self::Cbor);
        }
        let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
        let line = head
            .split(|&byte| byte == b'\n')
            .map(<[u8]>::trim_ascii)
            .find(|line| !line.is_empty() && !line.starts_with(b"#"))?;
        if line.starts_with(b"{") {
            // A comment before the object has no place in JSON.
            return Some(head.trim_ascii_start()).filter(|head| head.starts_with(b"{")).and_then(of_object);
        }
        of_words(line)
    }
}

impl fmt::Display for Content {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::JsonLines => "JSON Lines",
            Self::G2o => "a g2o graph",
            Self::Toro => "a TORO graph",
            Self::Jrl => "a JRL file",
            Self::Tum => "a TUM trajectory",
            Self::Kitti => "a KITTI trajectory",
            Self::Zip => "a zip archive",
            Self::Cbor => "CBOR",
        })
    }
}

/// The problem of a file in another format, by its first line. The remedy is a command.
pub(crate) fn foreign(line: &[u8], source_name: &str) -> Option<Problem> {
    // Standard input has no name that a command could take.
    let file = if source_name.contains(char::is_whitespace) { "FILE" } else { source_name };
    if line.starts_with(b"#") {
        return Some(Problem::new(
            "the line is a comment, which JSON Lines does not have",
            format!("convert other formats first: posecut convert {file} --to jsonl"),
        ));
    }
    let content = Content::of(line).filter(|content| *content != Content::JsonLines)?;
    let remedy = match content {
        Content::Zip | Content::Cbor => "unpack it, or export the graph as g2o".to_owned(),
        _ => format!("convert it first: posecut convert {file} --to jsonl"),
    };
    Some(Problem::new(format!("this is {content}, not pose-graph JSON Lines"), remedy))
}

/// The format of a line of words or numbers.
fn of_words(line: &[u8]) -> Option<Content> {
    let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    let first = words.next()?;
    if is_number(first) {
        let numbers = words.try_fold(1, |count, word| is_number(word).then_some(count + 1))?;
        return match numbers {
            8 => Some(Content::Tum),
            12 => Some(Content::Kitti),
            _ => None,
        };
    }
    let starts_with = |tag: &str| first.starts_with(tag.as_bytes());
    match first {
        b"VERTEX2" | b"VERTEX3" | b"EDGE2" | b"EDGE3" => Some(Content::Toro),
        b"FIX" => Some(Content::G2o),
        _ => ["VERTEX_", "EDGE_", "PARAMS_"].into_iter().any(starts_with).then_some(Content::G2o),
    }
}

fn is_number(word: &[u8]) -> bool {
    std::str::from_utf8(word).is_ok_and(|word| word.parse::<f64>().is_ok())
}

/// The format of a JSON object by its keys, as far as they are known.
fn of_object(bytes: &[u8]) -> Option<Content> {
    let mut depth = 0;
    let mut rest = bytes;
    while let Some((&byte, after)) = rest.split_first() {
        rest = after;
        match byte {
            b'{' | b'[' => depth += 1,
            b'}' | b']' if depth == 1 => return None,
            b'}' | b']' => depth -= 1,
            b'"' => {
                let end = end_of_string(rest)?;
                let (text, after) = (&rest[..end], &rest[end + 1..]);
                rest = after;
                // At depth 1 only a key is followed by a colon.
                if depth == 1 && after.trim_ascii_start().starts_with(b":") {
                    match text {
                        b"kind" => return Some(Content::JsonLines),
                        key if JRL_KEYS.contains(&key) => return Some(Content::Jrl),
                        _ => {}
                    }
                }
            }
            _ => {}
        }
    }
    None
}

/// The position of the quotation mark that ends a string.
fn end_of_string(bytes: &[u8]) -> Option<usize> {
    let mut escaped = false;
    bytes.iter().position(|&byte| {
        let ends = byte == b'"' && !escaped;
        escaped = byte == b'\\' && !escaped;
        ends
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_recognised_by_their_first_words() {
        for (text, expected) in [
            ("VERTEX_SE2 0 0 0 0\n", Some(Content::G2o)),
            ("\u{feff}\n  # made by hand\n\nEDGE_SE3:QUAT 0 1", Some(Content::G2o)),
            ("FIX 0\n", Some(Content::G2o)),
            ("PARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\n", Some(Content::G2o)),
            ("VERTEX2 0 0 0 0\n", Some(Content::Toro)),
            ("# time x y z\n1.5 0 0 0 0 0 0 1\n", Some(Content::Tum)),
            ("1 0 0 0 0 1 0 0 0 0 1 0\n", Some(Content::Kitti)),
            ("{\"kind\":\"header\"}\n", Some(Content::JsonLines)),
            ("{\"a\":{\"robots\":1},\"b\":\"robots\",\"kind\":\"header\"}\n", Some(Content::JsonLines)),
            ("{\n  \"name\": \"\\\"kind\\\":\",\n  \"robots\" : [97]", Some(Content::Jrl)),
            ("{\"groundtruth\":{\"a\":[{\"key\":1", Some(Content::Jrl)),
            ("PK\u{3}\u{4}", Some(Content::Zip)),
            ("# a comment\n{\"kind\":\"header\"}\n", None),
            ("{\"name\":\"a\"}\n{\"robots\":1}", None),
            ("{\"name\":\"a", None),
            ("1 2 3\n", None),
            ("1 0 0 0 0 0 0 x\n", None),
            ("1 0 0 0 0 0 0 1 x\n", None),
            ("frame_i,frame_j\n", None),
            ("# only a comment\n", None),
            ("", None),
        ] {
            assert_eq!(Content::of(text.as_bytes()), expected, "{text}");
        }
        assert_eq!(Content::of(b"\xa5dname"), Some(Content::Cbor));
    }
}
