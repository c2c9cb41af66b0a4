//! Dead reckoning from the wheels' speed and a heading.

use posecut_geometry::{LieGroup, SE3};

use super::{HeadingSource, Reader};
use crate::{Choice, Event, FileKind, IngestError, Table, Trajectory};

/// Integrates the mean speed of both wheels along the heading: trapezoidal rule for the speed, and the middle attitude
/// of each step. Rows outside the heading's times are left out.
pub(super) fn dead_reckoning(
    reader: &mut Reader<'_>,
    heading: HeadingSource,
    longest: i64,
) -> Result<(HeadingSource, Trajectory), IngestError> {
    let wheels = reader.table(FileKind::Wheels, 2)?;
    let heading = choose(reader, heading)?;
    let attitude = attitude(reader, heading, longest)?;
    let covered: Vec<(i64, f64, SE3)> = wheels
        .times
        .iter()
        .zip(&wheels.rows)
        .filter_map(|(&time, row)| Some((time, 0.5 * (row[0] + row[1]), attitude.at(time)?)))
        .collect();
    let Some(&(first, _, start)) = covered.first() else {
        return Err(IngestError::session(
            &wheels.file,
            "no row is within the times of the heading",
            "choose another --heading, and use files of the same session",
        ));
    };
    let mut trajectory = Trajectory { times: vec![first], poses: vec![start], gaps: Vec::new() };
    let mut position = start.translation;
    for pair in covered.windows(2) {
        let [(before, speed_before, attitude_before), (after, speed_after, attitude_after)] =
            [pair[0], pair[1]];
        let seconds = (after - before) as f64 * 1e-6;
        let middle = attitude_before.interpolate(&attitude_after, 0.5).rotation;
        let distance = 0.5 * (speed_before + speed_after) * seconds;
        position += middle * nalgebra::Vector3::new(distance, 0.0, 0.0);
        trajectory.times.push(after);
        trajectory.poses.push(SE3::new(position, attitude_after.rotation));
        if after - before > longest {
            trajectory.gaps.push((before, after));
        }
    }
    Ok((heading, trajectory))
}

fn choose(reader: &mut Reader<'_>, wanted: HeadingSource) -> Result<HeadingSource, IngestError> {
    if wanted != HeadingSource::Auto {
        return Ok(wanted);
    }
    let candidates = [
        (FileKind::FibreOpticGyro, HeadingSource::Kvh),
        (FileKind::Euler, HeadingSource::Euler),
        (FileKind::Imu, HeadingSource::Gyro),
    ];
    let files = &reader.files;
    let Some(&(kind, heading)) = candidates.iter().find(|(kind, _)| files.has(*kind)) else {
        return Err(IngestError::session(
            files.place(),
            format!("wheels.csv gives speeds, but no file gives a heading; found {}", files.found()),
            "add kvh.csv, ms25_euler.csv or ms25.csv",
        ));
    };
    (reader.report)(Event::Chosen(Choice::Heading(kind)));
    Ok(heading)
}

/// Attitudes over time, all at the origin.
fn attitude(
    reader: &mut Reader<'_>,
    heading: HeadingSource,
    longest: i64,
) -> Result<Trajectory, IngestError> {
    let (table, poses) = match heading {
        HeadingSource::Kvh => {
            let table = reader.table(FileKind::FibreOpticGyro, 1)?;
            let poses = table.rows.iter().map(|row| turned(0.0, 0.0, row[0])).collect();
            (table, poses)
        }
        HeadingSource::Gyro => {
            let table = reader.table(FileKind::Imu, 9)?;
            let poses = integrate_yaw_rate(&table);
            (table, poses)
        }
        HeadingSource::Euler | HeadingSource::Auto => {
            let table = reader.table(FileKind::Euler, 3)?;
            let poses = table.rows.iter().map(|row| turned(row[0], row[1], row[2])).collect();
            (table, poses)
        }
    };
    let gaps = table.gaps(longest).collect();
    Ok(Trajectory { times: table.times, poses, gaps })
}

fn turned(roll: f64, pitch: f64, yaw: f64) -> SE3 {
    SE3::from_euler(0.0, 0.0, 0.0, roll, pitch, yaw)
}

/// Column 9 of ms25.csv is the yaw rate in rad/s, positive clockwise seen from above (z down).
fn integrate_yaw_rate(table: &Table) -> Vec<SE3> {
    let mut yaw = 0.0;
    let mut poses = vec![turned(0.0, 0.0, yaw)];
    for (times, rows) in table.times.windows(2).zip(table.rows.windows(2)) {
        let seconds = (times[1] - times[0]) as f64 * 1e-6;
        yaw += 0.5 * (rows[0][8] + rows[1][8]) * seconds;
        poses.push(turned(0.0, 0.0, yaw));
    }
    poses
}
