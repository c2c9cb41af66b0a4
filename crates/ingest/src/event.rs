//! What ingestion reports while it runs.

use std::fmt;

use crate::distance_factor::DistanceFactor;
use crate::{ClockSource, FileKind};

/// A step of ingestion, for progress, history and messages.
#[derive(Clone, Debug)]
pub enum Event<'a> {
    /// A file of the session was opened.
    Opened {
        /// Its name without the directory.
        name: &'a str,
        /// Its content.
        bytes: &'a [u8],
    },
    /// This many more bytes of the open file were parsed.
    Parsed(u64),
    /// A choice was made that the options left open.
    Chosen(Choice),
    /// Something is missing or was left out.
    Warning(Warning),
}

/// A choice that the options left open, as a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Choice {
    /// The file that gives the odometry.
    Odometry(FileKind),
    /// The file that gives the heading for the wheels.
    Heading(FileKind),
    /// The keyframes.
    Keyframes {
        /// Their number.
        number: usize,
        /// One of this many times of the clock is a keyframe.
        keep_every: u32,
        /// The clock.
        clock: ClockSource,
    },
}

/// Something that is missing or was left out, as a message.
#[derive(Clone, Debug, PartialEq)]
pub enum Warning {
    /// Rows of a file were left out.
    DroppedRows {
        /// The file.
        file: String,
        /// Number of rows.
        rows: usize,
        /// Line of the first row whose time does not advance.
        first_reversal: Option<u64>,
    },
    /// The session has no ground truth.
    NoTruth {
        /// Its directory or archive.
        place: String,
    },
    /// Ground truth was left out because it repeats one pose while the odometry moves.
    FrozenTruth {
        /// The session's directory or archive.
        place: String,
        /// Number of rows.
        rows: usize,
    },
    /// Keyframes were left out because the odometry has a gap there.
    KeyframesInGaps {
        /// The session's directory or archive.
        place: String,
        /// Number of keyframes left out.
        left_out: usize,
        /// Number of all keyframes.
        keyframes: usize,
    },
    /// The odometry has gaps.
    Gaps {
        /// The session's name.
        session: String,
        /// Number of gaps.
        gaps: usize,
        /// A longer silence than this is a gap, seconds.
        longest_silence: f64,
    },
    /// Scans were left out or say nothing.
    Scans {
        /// The file.
        file: String,
        /// Number of scans whose time does not advance.
        out_of_order: usize,
        /// Number of keyframes without a scan near them in time.
        keyframes_without: usize,
        /// Number of keyframes whose scan has no return.
        empty: usize,
    },
    /// The distances of the odometry differ from those of the ground truth.
    WrongDistances {
        /// The session's name.
        session: String,
        /// The factor that the ground truth asks for.
        found: DistanceFactor,
        /// The factor that has been applied already.
        wheel_scale: f64,
    },
}

impl fmt::Display for Choice {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Odometry(kind) => {
                write!(formatter, "odometry from {} (choose another with --odometry)", kind.file_name())
            }
            Self::Heading(kind) => {
                write!(formatter, "heading from {} (choose another with --heading)", kind.file_name())
            }
            Self::Keyframes { number, keep_every, clock } => {
                write!(formatter, "{number} keyframes timed by {} (--keep-every {keep_every})", clock.name())
            }
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::DroppedRows { file, rows, first_reversal } => {
                write!(formatter, "{file}: skipped {rows} of its rows (NaN, or time not advancing)")?;
                first_reversal
                    .map_or(Ok(()), |line| write!(formatter, "; time first does not advance in line {line}"))
            }
            Self::NoTruth { place } => write!(
                formatter,
                "{place}: there is no ground truth (groundtruth_DATE.csv), so nothing can be evaluated; name it with --ground-truth"
            ),
            Self::FrozenTruth { place, rows } => write!(
                formatter,
                "{place}: skipped {rows} of the rows of ground truth, at its ends: they repeat one pose while the odometry moves"
            ),
            Self::KeyframesInGaps { place, left_out, keyframes } => {
                write!(
                    formatter,
                    "{place}: skipped {left_out} of {keyframes} keyframes, in gaps of the odometry"
                )
            }
            Self::Gaps { session, gaps, longest_silence } => {
                let gap = if *gaps == 1 { "gap" } else { "gaps" };
                write!(formatter, "{session}: the odometry has {gaps} {gap} longer than {longest_silence} s")
            }
            Self::Scans { file, out_of_order, keyframes_without, empty } => {
                let parts = [
                    (*out_of_order, "skipped scans whose time does not advance"),
                    (*keyframes_without, "keyframes without a scan within 0.25 s"),
                    (*empty, "scans without any return"),
                ];
                let named: Vec<String> = parts
                    .iter()
                    .filter(|(count, _)| *count > 0)
                    .map(|(count, what)| format!("{what}: {count}"))
                    .collect();
                write!(formatter, "{file}: {}", named.join("; "))
            }
            Self::WrongDistances { session, found, wheel_scale } => {
                let percent = 100.0 * (1.0 / found.median - 1.0);
                write!(
                    formatter,
                    "{session}: the odometry reports distances {:.1} % too {} by the ground truth (median over {} stretches of 20 m); \
                     --wheel-scale {:.3} corrects that",
                    percent.abs(),
                    if percent > 0.0 { "long" } else { "short" },
                    found.stretches,
                    wheel_scale * found.median
                )
            }
        }
    }
}
