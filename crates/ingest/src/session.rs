//! Finds the files of a session in a directory, or streams them from its `DATE_sen.tar.gz`.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

use flate2::bufread::MultiGzDecoder;
use posecut_graph::Expansion;

use crate::IngestError;

/// Refuse a session whose files together are larger than this: 2 GiB. NCLT's largest session has about 200 MB.
const LARGEST_SESSION: u64 = 2 << 30;

/// The NCLT files that ingestion can use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FileKind {
    /// `groundtruth_DATE.csv`
    GroundTruth,
    /// `odometry_mu.csv`: relative poses at the images, 5 Hz.
    RelativeOdometry,
    /// `odometry_cov.csv`: covariances of the relative poses.
    RelativeCovariance,
    /// `odometry_mu_100hz.csv`: poses integrated from the start.
    IntegratedOdometry,
    /// `odometry_cov_100hz.csv`: covariances of the steps between its rows.
    IntegratedCovariance,
    /// `wheels.csv`: left and right wheel speed.
    Wheels,
    /// `ms25.csv`: magnetometer, accelerations, angular rates.
    Imu,
    /// `ms25_euler.csv`: roll, pitch, heading.
    Euler,
    /// `kvh.csv`: heading of the fibre-optic gyro.
    FibreOpticGyro,
    /// `gps.csv`: fixes of the consumer receiver.
    Gps,
    /// `gps_rtk.csv`: fixes of the receiver with real-time kinematics.
    GpsRtk,
    /// `hokuyo_30m.bin`: scans of the planar laser scanner.
    Hokuyo,
}

impl FileKind {
    /// The file's name in NCLT.
    pub fn file_name(self) -> &'static str {
        match self {
            Self::GroundTruth => "groundtruth_DATE.csv",
            Self::RelativeOdometry => "odometry_mu.csv",
            Self::RelativeCovariance => "odometry_cov.csv",
            Self::IntegratedOdometry => "odometry_mu_100hz.csv",
            Self::IntegratedCovariance => "odometry_cov_100hz.csv",
            Self::Wheels => "wheels.csv",
            Self::Imu => "ms25.csv",
            Self::Euler => "ms25_euler.csv",
            Self::FibreOpticGyro => "kvh.csv",
            Self::Gps => "gps.csv",
            Self::GpsRtk => "gps_rtk.csv",
            Self::Hokuyo => "hokuyo_30m.bin",
        }
    }

    fn from_name(name: &str) -> Option<Self> {
        let csv = Path::new(name).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"));
        Some(match name {
            "odometry_mu.csv" => Self::RelativeOdometry,
            "odometry_cov.csv" => Self::RelativeCovariance,
            "odometry_mu_100hz.csv" => Self::IntegratedOdometry,
            "odometry_cov_100hz.csv" => Self::IntegratedCovariance,
            "wheels.csv" => Self::Wheels,
            "ms25.csv" => Self::Imu,
            "ms25_euler.csv" => Self::Euler,
            "kvh.csv" => Self::FibreOpticGyro,
            "gps.csv" => Self::Gps,
            "gps_rtk.csv" => Self::GpsRtk,
            "hokuyo_30m.bin" => Self::Hokuyo,
            _ if name.starts_with("groundtruth_") && csv => Self::GroundTruth,
            _ => return None,
        })
    }
}

enum Place {
    File(PathBuf),
    Member(Vec<u8>),
}

/// The files found, by kind.
pub struct SessionFiles {
    /// The session's name: its date, unless the user gave another.
    pub name: String,
    place: String,
    files: BTreeMap<FileKind, (String, Place)>,
    /// Ascending times of the front camera's images in microseconds; empty if there are none.
    pub image_times: Vec<i64>,
}

/// A file that was read.
pub(crate) struct Content {
    /// Its name without the directory.
    pub(crate) name: String,
    /// Its name for messages.
    pub(crate) shown: String,
    pub(crate) bytes: Vec<u8>,
}

impl SessionFiles {
    /// Finds the files of a session in a directory or in a `.tar.gz`.
    pub fn find(
        path: &Path,
        ground_truth: Option<&Path>,
        images: Option<&Path>,
    ) -> Result<Self, IngestError> {
        let place = path.display().to_string();
        let metadata = fs::metadata(path).map_err(|error| unknown_session(path, &error))?;
        let mut session =
            Self { name: session_name(path), place, files: BTreeMap::new(), image_times: Vec::new() };
        if metadata.is_dir() {
            session.find_in_directory(path)?;
        } else {
            session.find_in_archive(path)?;
            let neighbour = path.with_file_name(format!("groundtruth_{}.csv", session.name));
            if neighbour.is_file() {
                session.add_file(FileKind::GroundTruth, &neighbour);
            }
        }
        if let Some(path) = ground_truth {
            session.add_file(FileKind::GroundTruth, path);
        }
        if let Some(path) = images {
            session.image_times = image_times(path)?;
        }
        Ok(session)
    }

    /// Whether a file of that kind was found.
    pub fn has(&self, kind: FileKind) -> bool {
        self.files.contains_key(&kind)
    }

    /// Takes the laser scans from this file, whatever the session has.
    pub fn set_hokuyo(&mut self, path: &Path) {
        self.add_file(FileKind::Hokuyo, path);
    }

    /// The path of a file, if it was found outside of an archive.
    pub fn path(&self, kind: FileKind) -> Option<&Path> {
        match &self.files.get(&kind)?.1 {
            Place::File(path) => Some(path),
            Place::Member(_) => None,
        }
    }

    /// The directory or archive, for messages.
    pub fn place(&self) -> &str {
        &self.place
    }

    /// The names of the files found, for messages.
    pub fn found(&self) -> String {
        let names: Vec<&str> = self.files.values().map(|(name, _)| name.as_str()).collect();
        if names.is_empty() { "none of NCLT's files".to_owned() } else { names.join(", ") }
    }

    /// Reads a file.
    pub(crate) fn content(&mut self, kind: FileKind) -> Result<Option<Content>, IngestError> {
        let Some((name, place)) = self.files.get_mut(&kind) else { return Ok(None) };
        let (shown, bytes) = match place {
            Place::File(path) => {
                let shown = path.display().to_string();
                let bytes =
                    fs::read(&*path).map_err(|error| IngestError::Io { place: shown.clone(), error })?;
                (shown, bytes)
            }
            Place::Member(bytes) => (format!("{}: {name}", self.place), std::mem::take(bytes)),
        };
        Ok(Some(Content { name: name.clone(), shown, bytes }))
    }

    fn add_file(&mut self, kind: FileKind, path: &Path) {
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        self.files.insert(kind, (name, Place::File(path.to_owned())));
    }

    fn find_in_directory(&mut self, directory: &Path) -> Result<(), IngestError> {
        // NCLT's sensor archive unpacks to a folder named by the date.
        let nested = directory.join(&self.name);
        for folder in [directory, nested.as_path()] {
            if !folder.is_dir() {
                continue;
            }
            let io = |error| IngestError::Io { place: folder.display().to_string(), error };
            let mut entries: Vec<PathBuf> = fs::read_dir(folder)
                .map_err(io)?
                .map(|entry| Ok(entry?.path()))
                .collect::<Result<_, _>>()
                .map_err(io)?;
            entries.sort();
            for path in entries {
                let kind = path.file_name().and_then(|name| FileKind::from_name(&name.to_string_lossy()));
                if let Some(kind) = kind
                    && path.is_file()
                {
                    self.add_file(kind, &path);
                }
            }
            let camera = folder.join("lb3").join("Cam5");
            if camera.is_dir() {
                self.image_times = image_times(&camera)?;
            }
        }
        Ok(())
    }

    fn find_in_archive(&mut self, path: &Path) -> Result<(), IngestError> {
        let io = |error| IngestError::Io { place: path.display().to_string(), error };
        let file = File::open(path).map_err(io)?;
        let broken = |error: std::io::Error| {
            IngestError::session(
                &path.display().to_string(),
                format!("it is neither a CARMEN log nor a whole tar.gz archive ({error})"),
                "name a log whose first line is a message, or download the archive again with scripts/fetch-nclt.sh, which checks it",
            )
        };
        let expanded = Expansion::new(BufReader::new(file), MultiGzDecoder::new);
        let mut archive = tar::Archive::new(expanded);
        let mut room = LARGEST_SESSION;
        for member in archive.entries().map_err(broken)? {
            let mut member = member.map_err(broken)?;
            // Only the last component of a member's path is used, and nothing is unpacked, so no path can escape.
            let member_path = member.path().map_err(broken)?.into_owned();
            let Some(name) = member_path.file_name().map(|name| name.to_string_lossy().into_owned()) else {
                continue;
            };
            let Some(kind) = FileKind::from_name(&name).filter(|_| member.header().entry_type().is_file())
            else {
                continue;
            };
            let mut bytes = Vec::new();
            (&mut member).take(room + 1).read_to_end(&mut bytes).map_err(broken)?;
            room = room.checked_sub(bytes.len() as u64).ok_or_else(|| {
                IngestError::session(
                    &path.display().to_string(),
                    format!(
                        "its files up to {name} have more than {} MiB together, and no NCLT session has",
                        LARGEST_SESSION >> 20
                    ),
                    "name an NCLT archive",
                )
            })?;
            self.files.insert(kind, (name, Place::Member(bytes)));
        }
        Ok(())
    }
}

fn unknown_session(path: &Path, error: &std::io::Error) -> IngestError {
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut neighbours: Vec<String> = fs::read_dir(parent)
        .map(|entries| {
            entries
                .flatten()
                .map(|entry| entry.file_name().to_string_lossy().into_owned())
                .filter(|name| name.starts_with("20"))
                .collect()
        })
        .unwrap_or_default();
    neighbours.sort();
    let remedy = if neighbours.is_empty() {
        "name a session's directory or its DATE_sen.tar.gz; scripts/fetch-nclt.sh downloads them".to_owned()
    } else {
        format!("use one of the sessions in {}: {}", parent.display(), neighbours.join(", "))
    };
    IngestError::session(&path.display().to_string(), format!("there is no such session ({error})"), remedy)
}

/// The date in `2012-01-22_sen.tar.gz` or `…/2012-01-22`, or the whole name if it has none.
fn session_name(path: &Path) -> String {
    let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let name =
        path.file_name().map_or_else(|| "session".to_owned(), |name| name.to_string_lossy().into_owned());
    name.split(['_', '.']).next().filter(|part| !part.is_empty()).map_or(name.clone(), str::to_owned)
}

fn image_times(directory: &Path) -> Result<Vec<i64>, IngestError> {
    let io = |error| IngestError::Io { place: directory.display().to_string(), error };
    let mut times = Vec::new();
    for entry in fs::read_dir(directory).map_err(io)? {
        let path = entry.map_err(io)?.path();
        let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        let image = path.extension().is_some_and(|extension| {
            ["tiff", "tif", "png", "jpg"].iter().any(|known| extension.eq_ignore_ascii_case(known))
        });
        if let (true, Ok(time)) = (image, stem.parse()) {
            times.push(time);
        }
    }
    if times.is_empty() {
        return Err(IngestError::session(
            &directory.display().to_string(),
            "no image in it is named by its time",
            "name a directory of UTIME.tiff files (NCLT: lb3/Cam5), or leave --images out",
        ));
    }
    times.sort_unstable();
    times.dedup();
    Ok(times)
}
