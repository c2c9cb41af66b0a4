//! Files of relations: a line `t1 t2 x y z roll pitch yaw` each, in seconds, metres and radians; `#` begins a comment.

use std::io::BufRead;

use posecut_geometry::SE3;
use posecut_graph::bounded_lines;

/// The motion of the robot between two times.
#[derive(Clone, Debug, PartialEq)]
pub struct Relation {
    /// The two times, microseconds.
    pub times: [i64; 2],
    /// The pose at the second time in the frame of the robot at the first.
    pub motion: SE3,
}

/// A file of relations or a trajectory that cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum RelationError {
    /// A line does not have its numbers.
    #[error("{place}, line {line}: {problem}; each line has {expected}")]
    Line {
        /// The file.
        place: String,
        /// The line, counted from 1.
        line: usize,
        /// What is wrong.
        problem: String,
        /// What a line has.
        expected: &'static str,
    },
    /// The file has no lines of use.
    #[error("{place}: has no {what}; name the file that belongs to the log")]
    Empty {
        /// The file.
        place: String,
        /// What is missing.
        what: &'static str,
    },
}

/// The relations of a file. O(lines).
pub fn relations(place: &str, reader: impl BufRead) -> Result<Vec<Relation>, RelationError> {
    let mut relations = Vec::new();
    rows(place, reader, "t1 t2 x y z roll pitch yaw", |[first, last, x, y, z, roll, pitch, yaw]| {
        relations.push(Relation {
            times: [first, last].map(microseconds),
            motion: SE3::from_euler(x, y, z, roll, pitch, yaw),
        });
        Ok(())
    })?;
    if relations.is_empty() {
        return Err(RelationError::Empty { place: place.to_owned(), what: "relations" });
    }
    Ok(relations)
}

/// Seconds as microseconds.
pub(super) fn microseconds(seconds: f64) -> i64 {
    (seconds * 1e6).round() as i64
}

/// Hands over the numbers of each line that is neither blank nor a comment.
pub(super) fn rows<const N: usize>(
    place: &str,
    reader: impl BufRead,
    expected: &'static str,
    mut row: impl FnMut([f64; N]) -> Result<(), String>,
) -> Result<(), RelationError> {
    for (number, text) in bounded_lines(reader).enumerate() {
        let refused =
            |problem| RelationError::Line { place: place.to_owned(), line: number + 1, problem, expected };
        let text = text.map_err(|error| refused(format!("cannot be read: {error}")))?;
        let words: Vec<&str> = text.split_whitespace().collect();
        if words.first().is_none_or(|word| word.starts_with('#')) {
            continue;
        }
        if words.len() != N {
            return Err(refused(format!("expected {N} numbers, found {}", words.len())));
        }
        let mut numbers = [0.0_f64; N];
        for (number, word) in numbers.iter_mut().zip(&words) {
            *number = word.parse().map_err(|_| refused(format!("{word:?} is not a number")))?;
            if !number.is_finite() {
                return Err(refused(format!("{word} is not finite")));
            }
        }
        row(numbers).map_err(refused)?;
    }
    Ok(())
}
