//! Reads the odometry of a session from one of its sources.

mod integrated;
mod wheels;

pub(crate) use integrated::from_row;

use serde::Serialize;

use crate::covariance::StepCovariances;
use crate::{Choice, Event, FileKind, IngestError, Options, SessionFiles, Table, Trajectory, Warning};

/// Which files give the odometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum OdometrySource {
    /// The first available one of the following
    Auto,
    /// odometry_mu.csv: poses relative to the previous image
    Relative,
    /// odometry_mu_100hz.csv: poses integrated from the start
    Integrated,
    /// wheels.csv with a heading: raw dead reckoning
    Wheels,
}

/// Which file gives the heading for dead reckoning with the wheels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum HeadingSource {
    /// The first available one of the following
    Auto,
    /// kvh.csv: the fibre-optic gyro
    Kvh,
    /// ms25_euler.csv: the IMU's own heading, which its magnetometer steers
    Euler,
    /// ms25.csv: the IMU's yaw rate, integrated
    Gyro,
}

/// The odometry of a session.
pub(crate) struct Odometry {
    pub(crate) source: OdometrySource,
    pub(crate) heading: Option<HeadingSource>,
    pub(crate) trajectory: Trajectory,
    /// Covariances of the steps between rows, if the session has them.
    pub(crate) covariances: Option<StepCovariances>,
    pub(crate) dropped_rows: usize,
}

/// Reads tables of one session, and counts the rows that they drop.
pub(crate) struct Reader<'a> {
    pub(crate) files: &'a mut SessionFiles,
    pub(crate) report: &'a mut dyn FnMut(Event<'_>),
    pub(crate) dropped_rows: usize,
}

impl Reader<'_> {
    /// The table of a required file.
    pub(crate) fn table(&mut self, kind: FileKind, columns: usize) -> Result<Table, IngestError> {
        let found = self.files.found();
        let Some(content) = self.files.content(kind)? else {
            return Err(IngestError::session(
                self.files.place(),
                format!("there is no {}; found {found}", kind.file_name()),
                "complete the session with scripts/fetch-nclt.sh, or choose another source (--odometry, --heading)",
            ));
        };
        (self.report)(Event::Opened { name: &content.name, bytes: &content.bytes });
        let mut parsed = |bytes| (self.report)(Event::Parsed(bytes));
        let table = Table::parse(&content.shown, &content.bytes, columns, &mut parsed)?;
        if table.dropped > 0 {
            self.warn(Warning::DroppedRows {
                file: content.shown,
                rows: table.dropped,
                first_reversal: table.first_reversal,
            });
        }
        self.dropped_rows += table.dropped;
        Ok(table)
    }

    /// Reads the fixes of a receiver: mode, satellites, latitude, longitude. Rows without a fix are left out.
    pub(crate) fn table_of_fixes(&mut self, kind: FileKind) -> Result<Table, IngestError> {
        let found = self.files.found();
        let Some(content) = self.files.content(kind)? else {
            return Err(IngestError::session(
                self.files.place(),
                format!("there is no {}; found {found}", kind.file_name()),
                "complete the session with scripts/fetch-nclt.sh, or choose another receiver with --gps, or leave it out",
            ));
        };
        (self.report)(Event::Opened { name: &content.name, bytes: &content.bytes });
        let mut parsed = |bytes| (self.report)(Event::Parsed(bytes));
        Table::parse(&content.shown, &content.bytes, 4, &mut parsed)
    }

    pub(crate) fn warn(&mut self, warning: Warning) {
        (self.report)(Event::Warning(warning));
    }
}

/// Reads the odometry that the options name, or the best available one.
pub(crate) fn read(reader: &mut Reader<'_>, options: &Options) -> Result<Odometry, IngestError> {
    let source = choose(reader, options.odometry)?;
    let longest = (options.longest_silence * 1e6) as i64;
    let before = reader.dropped_rows;
    let (heading, mut trajectory, covariances) = match source {
        OdometrySource::Relative => {
            let (trajectory, covariances) = integrated::from_relative(reader, longest)?;
            (None, trajectory, covariances)
        }
        OdometrySource::Integrated | OdometrySource::Auto => {
            let (trajectory, covariances) = integrated::from_integrated(reader, longest)?;
            (None, trajectory, covariances)
        }
        OdometrySource::Wheels => {
            let (heading, trajectory) = wheels::dead_reckoning(reader, options.heading, longest)?;
            (Some(heading), trajectory, None)
        }
    };
    trajectory.scale(options.wheel_scale);
    Ok(Odometry { source, heading, trajectory, covariances, dropped_rows: reader.dropped_rows - before })
}

fn choose(reader: &mut Reader<'_>, wanted: OdometrySource) -> Result<OdometrySource, IngestError> {
    if wanted != OdometrySource::Auto {
        return Ok(wanted);
    }
    let candidates = [
        (FileKind::RelativeOdometry, OdometrySource::Relative),
        (FileKind::IntegratedOdometry, OdometrySource::Integrated),
        (FileKind::Wheels, OdometrySource::Wheels),
    ];
    let files = &reader.files;
    let Some(&(kind, source)) = candidates.iter().find(|(kind, _)| files.has(*kind)) else {
        return Err(IngestError::session(
            files.place(),
            format!("there is no odometry; found {}", files.found()),
            "add odometry_mu.csv, odometry_mu_100hz.csv or wheels.csv; scripts/fetch-nclt.sh downloads them",
        ));
    };
    (reader.report)(Event::Chosen(Choice::Odometry(kind)));
    Ok(source)
}
