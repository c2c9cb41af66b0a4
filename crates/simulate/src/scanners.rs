//! The files of laser scanners, which are too large to be held as rows.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write as _};
use std::path::Path;

use posecut_nclt_sensors::velodyne::{Hit, write_hits};
use posecut_nclt_sensors::write_hokuyo_scan;
use posecut_random::random;

use crate::Options;
use crate::campus::Campus;
use crate::drive::Instant;
use crate::lasers::{planar_scan, spatial_scan};
use crate::session::time;
use crate::world::World;

/// The file of the planar scanner.
pub(crate) const HOKUYO: &str = "hokuyo_30m.bin";
/// The folder of the three-dimensional scanner.
pub(crate) const VELODYNE: &str = "velodyne_sync";

/// The laser scanners of a drive.
#[derive(Clone, Debug)]
pub struct Scanners {
    world: World,
    name: String,
    options: Options,
    start: i64,
    instants: Vec<Instant>,
}

impl Scanners {
    pub(crate) fn new(
        name: &str,
        options: &Options,
        campus: &Campus,
        start: i64,
        instants: Vec<Instant>,
    ) -> Self {
        let any = options.hokuyo.is_some() || options.velodyne.is_some();
        let world = if any { World::new(options.campus, campus) } else { World::default() };
        Self { world, name: name.to_owned(), options: options.clone(), start, instants }
    }

    /// Times and ranges of the planar scanner, if the options ask for it. Its clock is not that of the images: it begins an instant later.
    pub fn planar(&self) -> impl Iterator<Item = (i64, Vec<f64>)> + '_ {
        let mut draw = random(self.options.seed, &format!("{} hokuyo", self.name));
        self.instants_at(self.options.hokuyo, 1).map(move |instant| {
            (
                time(self.start, instant.seconds),
                planar_scan(&self.world, &instant.pose.to_planar(), &mut draw),
            )
        })
    }

    /// Times and hits of the three-dimensional scanner, if the options ask for it.
    pub fn spatial(&self) -> impl Iterator<Item = (i64, Vec<Hit>)> + '_ {
        let mut draw = random(self.options.seed, &format!("{} velodyne", self.name));
        self.instants_at(self.options.velodyne, 0).map(move |instant| {
            (
                time(self.start, instant.seconds),
                spatial_scan(&self.world, &instant.pose.to_planar(), &mut draw),
            )
        })
    }

    /// Writes the files that the options ask for.
    pub fn write(&self, folder: &Path) -> io::Result<()> {
        if self.options.hokuyo.is_some() {
            let mut writer = BufWriter::new(File::create(folder.join(HOKUYO))?);
            for (time, ranges) in self.planar() {
                write_hokuyo_scan(time.unsigned_abs(), &ranges, &mut writer)?;
            }
            writer.flush()?;
        }
        if self.options.velodyne.is_some() {
            let folder = folder.join(VELODYNE);
            fs::create_dir(&folder)?;
            for (time, hits) in self.spatial() {
                let mut file = File::create(folder.join(format!("{time}.bin")))?;
                write_hits(&hits, &mut file)?;
            }
        }
        Ok(())
    }

    /// The instants of a rate, Hz, from the one with an index on; none without a rate.
    fn instants_at(&self, rate: Option<f64>, first: usize) -> impl Iterator<Item = &Instant> {
        let every = rate.map_or(1.0, |rate| (self.options.rate / rate).round().max(1.0));
        let most = if rate.is_some() { usize::MAX } else { 0 };
        self.instants.iter().skip(first).step_by(every as usize).take(most)
    }
}
