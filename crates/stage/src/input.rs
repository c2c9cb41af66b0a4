//! Reading files and standard input, compressed or not, with a digest of what was read.

use std::fs::File;
use std::io::{self, BufRead, BufReader, IsTerminal, Read};
use std::path::Path;

use anyhow::{Context as _, bail};
use flate2::bufread::MultiGzDecoder;
use sha2::{Digest, Sha256};

use crate::{Expansion, Source};

const BUFFER: usize = 1 << 17;

/// An open input, decompressed and hashed while it is read.
pub struct Input {
    /// What messages call it.
    pub name: String,
    reader: BufReader<Hashing<Box<dyn Read>>>,
}

impl Input {
    /// Reads the rest and returns the SHA-256 of the whole input in hexadecimal.
    pub fn finish(mut self) -> io::Result<String> {
        io::copy(&mut self.reader, &mut io::sink())?;
        Ok(hexadecimal(self.reader.into_inner().hash))
    }
}

impl Read for Input {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.reader.read(buffer)
    }
}

impl BufRead for Input {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.reader.fill_buf()
    }

    fn consume(&mut self, amount: usize) {
        self.reader.consume(amount);
    }
}

struct Hashing<R> {
    reader: R,
    hash: Sha256,
}

impl<R: Read> Read for Hashing<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.reader.read(buffer)?;
        self.hash.update(&buffer[..read]);
        Ok(read)
    }
}

fn hexadecimal(hash: Sha256) -> String {
    use std::fmt::Write as _;
    hash.finalize().iter().fold(String::with_capacity(64), |mut text, byte| {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// The SHA-256 of bytes, in hexadecimal.
pub fn digest(bytes: &[u8]) -> String {
    let mut hash = Sha256::new();
    hash.update(bytes);
    hexadecimal(hash)
}

/// Opens a source. Gzip is recognised by its first bytes, not by the name.
pub fn open(source: &Source) -> anyhow::Result<Input> {
    match source {
        Source::File(path) => open_file(path),
        Source::Standard => {
            if io::stdin().is_terminal() {
                bail!(
                    "there is no input; name a file (posecut-… FILE) or pipe one in (… | posecut-…); --help lists the options"
                );
            }
            decompressed("standard input".to_owned(), Box::new(io::stdin().lock()))
        }
    }
}

/// Opens a file. Gzip is recognised by its first bytes, not by the name.
pub fn open_file(path: &Path) -> anyhow::Result<Input> {
    let name = path.display().to_string();
    let file = File::open(path).with_context(|| format!("{name}: cannot be opened"))?;
    if file.metadata().is_ok_and(|metadata| metadata.is_dir()) {
        bail!("{name}: is a directory, but a file is needed; name a file in it");
    }
    decompressed(name, Box::new(BufReader::with_capacity(BUFFER, file)))
}

fn decompressed(name: String, mut reader: Box<dyn BufRead>) -> anyhow::Result<Input> {
    let start = reader.fill_buf().with_context(|| format!("{name}: cannot be read"))?;
    let reader: Box<dyn Read> = if start.starts_with(&[0x1f, 0x8b]) {
        Box::new(Expansion::new(reader, MultiGzDecoder::new))
    } else {
        Box::new(reader)
    };
    let hashing = Hashing { reader, hash: Sha256::new() };
    Ok(Input { name, reader: BufReader::with_capacity(BUFFER, hashing) })
}
