//! Reads odometry that NCLT has computed: relative poses, or poses integrated from the start.

use posecut_geometry::{LieGroup, SE3};

use super::Reader;
use crate::covariance::StepCovariances;
use crate::{FileKind, IngestError, Trajectory};

type WithCovariances = (Trajectory, Option<StepCovariances>);

/// `odometry_mu.csv`: each row is the pose relative to the previous image. The first row is not used, because its
/// previous image is not in the file.
pub(super) fn from_relative(reader: &mut Reader<'_>, longest: i64) -> Result<WithCovariances, IngestError> {
    let table = reader.table(FileKind::RelativeOdometry, 6)?;
    if let Some(line) = table.first_inner_nan.or(table.first_reversal) {
        return Err(IngestError::row(
            &table.file,
            line,
            "the relative pose cannot be used, so every pose after it would be wrong",
            "repair the row, or use --odometry integrated",
        ));
    }
    let mut pose = SE3::identity();
    let poses = table
        .rows
        .iter()
        .enumerate()
        .map(|(index, row)| {
            if index > 0 {
                pose = pose.compose(&from_row(row));
            }
            pose
        })
        .collect();
    let gaps = table.gaps(longest).collect();
    let covariances = read_covariances(reader, FileKind::RelativeCovariance)?;
    Ok((Trajectory { times: table.times, poses, gaps }, covariances))
}

/// `odometry_mu_100hz.csv`: each row is a pose in the frame of the start.
pub(super) fn from_integrated(reader: &mut Reader<'_>, longest: i64) -> Result<WithCovariances, IngestError> {
    let table = reader.table(FileKind::IntegratedOdometry, 6)?;
    let poses = table.rows.iter().map(|row| from_row(row)).collect();
    let gaps = table.gaps(longest).collect();
    let covariances = read_covariances(reader, FileKind::IntegratedCovariance)?;
    Ok((Trajectory { times: table.times, poses, gaps }, covariances))
}

/// The pose of x, y, z, roll, pitch, yaw.
pub(crate) fn from_row(row: &[f64]) -> SE3 {
    SE3::from_euler(row[0], row[1], row[2], row[3], row[4], row[5])
}

fn read_covariances(reader: &mut Reader<'_>, kind: FileKind) -> Result<Option<StepCovariances>, IngestError> {
    if !reader.files.has(kind) {
        return Ok(None);
    }
    let table = reader.table(kind, 21)?;
    Ok(Some(StepCovariances::from_table(&table)))
}
