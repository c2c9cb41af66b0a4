//! The dimension of a graph: plane or space.

use std::fmt;

/// The dimension of the poses of a graph: all records of one file share it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Dimension {
    /// SE(2): poses `[x, y, theta]`.
    Two,
    /// SE(3): poses `[x, y, z, qx, qy, qz, qw]`.
    Three,
}

impl Dimension {
    /// The dimension for the header's number, if it is 2 or 3.
    pub fn from_number(number: u64) -> Option<Self> {
        match number {
            2 => Some(Self::Two),
            3 => Some(Self::Three),
            _ => None,
        }
    }

    /// 2 or 3.
    pub fn number(self) -> u64 {
        match self {
            Self::Two => 2,
            Self::Three => 3,
        }
    }

    /// Numbers in a pose: 3 or 7.
    pub fn pose_components(self) -> usize {
        match self {
            Self::Two => 3,
            Self::Three => 7,
        }
    }

    /// Numbers in a position: 2 or 3.
    pub fn position_components(self) -> usize {
        match self {
            Self::Two => 2,
            Self::Three => 3,
        }
    }

    /// Degrees of freedom of a pose, which is the side of an information matrix: 3 or 6.
    pub fn degrees_of_freedom(self) -> usize {
        match self {
            Self::Two => 3,
            Self::Three => 6,
        }
    }

    /// Terms of the upper triangle of an information matrix: 6 or 21.
    pub fn information_terms(self) -> usize {
        let side = self.degrees_of_freedom();
        side * (side + 1) / 2
    }

    /// The layout of a pose, in words for messages.
    pub fn pose_layout(self) -> &'static str {
        match self {
            Self::Two => "[x, y, theta]",
            Self::Three => "[x, y, z, qx, qy, qz, qw]",
        }
    }

    /// The layout of a position, in words for messages.
    pub fn position_layout(self) -> &'static str {
        match self {
            Self::Two => "[x, y]",
            Self::Three => "[x, y, z]",
        }
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}", self.number())
    }
}
