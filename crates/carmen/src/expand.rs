//! Compressed logs.

use std::io::{self, Read};

use bzip2::bufread::MultiBzDecoder;
use flate2::bufread::MultiGzDecoder;
use posecut_graph::Expansion;

/// The first bytes of bzip2 files.
const BZIP2: &[u8] = b"BZh";

/// The first bytes of gzip files.
const GZIP: &[u8] = &[0x1f, 0x8b];

/// The content of a log that may be compressed by gzip or bzip2, recognised by its first bytes. Files made to fill memory are
/// refused. O(content).
pub fn expanded(bytes: Vec<u8>) -> io::Result<Vec<u8>> {
    let mut content = Vec::new();
    if bytes.starts_with(BZIP2) {
        Expansion::new(&bytes[..], MultiBzDecoder::new).read_to_end(&mut content)?;
    } else if bytes.starts_with(GZIP) {
        Expansion::new(&bytes[..], MultiGzDecoder::new).read_to_end(&mut content)?;
    } else {
        return Ok(bytes);
    }
    Ok(content)
}

/// Whether a file that begins with these bytes (after gzip) is a CARMEN log: compressed by bzip2, or text whose first line that is
/// not a comment begins with the name of a message.
pub fn looks_like_log(start: &[u8]) -> bool {
    if start.starts_with(BZIP2) {
        return true;
    }
    let Some(line) = start.split(|byte| *byte == b'\n').find(|line| !line.is_empty() && line[0] != b'#')
    else {
        return start.starts_with(b"#");
    };
    let name: Vec<u8> = line.iter().copied().take_while(|byte| !byte.is_ascii_whitespace()).collect();
    !name.is_empty()
        && line.len() > name.len()
        && name[0].is_ascii_uppercase()
        && name.iter().all(|byte| byte.is_ascii_uppercase() || byte.is_ascii_digit() || b"-_".contains(byte))
}
