//! The machine and the date of a measurement.

use std::process::Command;

use crate::process::must;

/// The machine's processors and memory.
pub(crate) struct Machine {
    /// Number of processors.
    pub(crate) cores: usize,
    /// Physical memory in units of 2^30 bytes.
    pub(crate) gigabytes: f64,
    /// The processor's name, or its architecture if the system does not report a name.
    pub(crate) model: String,
}

impl Machine {
    /// This machine. Memory and model are known only on Linux.
    pub(crate) fn here() -> Self {
        let found = |file: &str, key: &str| {
            let text = std::fs::read_to_string(file).unwrap_or_default();
            let line = text.lines().find(|line| line.starts_with(key))?;
            Some(line.split_once(':')?.1.trim().to_owned())
        };
        let kibibytes =
            found("/proc/meminfo", "MemTotal").and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
        Self {
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            gigabytes: kibibytes.unwrap_or_default() / f64::from(1 << 20),
            model: found("/proc/cpuinfo", "model name").unwrap_or_else(|| std::env::consts::ARCH.to_owned()),
        }
    }
}

/// Today's date, YYYY-MM-DD.
pub(crate) fn today() -> anyhow::Result<String> {
    Ok(String::from_utf8(must(Command::new("date").arg("+%F"))?)?.trim().to_owned())
}
