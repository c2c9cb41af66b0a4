//! Reads and writes the laser files of the NCLT dataset (Carlevaris-Bianco, Ushani, Eustice, IJRR 35(9), 2016).
//!
//! - [`hokuyo`]: `hokuyo_30m.bin`, the planar scanner.
//! - [`velodyne`]: `velodyne_sync/UTIME.bin`, the three-dimensional scanner.
//! - [`scaled`]: the 16-bit lengths of both; [`times`]: the scan nearest to a time.
//!
//! The layouts are those of the readers that the dataset publishes, `read_hokuyo_30m.py` and `read_vel_sync.py`
//! (<http://robots.engin.umich.edu/nclt/>). The body frame is NCLT's: x forward, y right, z down. Lengths are metres, angles radians, times
//! microseconds UTC.

mod error;
pub mod hokuyo;
pub mod scaled;
pub mod times;
pub mod velodyne;

pub use error::SensorError;
pub use hokuyo::{Hokuyo, write_hokuyo_scan};
