//! A limit on how far compressed input may expand.

use std::cell::Cell;
use std::io::{self, BufRead, Read};
use std::rc::Rc;

/// Content up to this size may have any compression ratio: 256 MiB.
const FREE: u64 = 256 << 20;

/// Longer content may be at most this many times as long as its compressed form. Pose graphs and sensor files expand 3 to
/// 20 times; a file made to fill memory expands a thousand times.
const LARGEST_RATIO: u64 = 100;

/// A decompressor that refuses input made to fill memory.
pub struct Expansion<D> {
    decoder: D,
    compressed: Rc<Cell<u64>>,
    content: u64,
}

impl<D> Expansion<D> {
    /// Wraps a reader of compressed bytes in a decoder.
    pub fn new<R: BufRead>(reader: R, decoder: impl FnOnce(Counted<R>) -> D) -> Self {
        let compressed = Rc::new(Cell::new(0));
        let decoder = decoder(Counted { reader, count: compressed.clone() });
        Self { decoder, compressed, content: 0 }
    }
}

impl<D: Read> Read for Expansion<D> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.decoder.read(buffer)?;
        self.content += read as u64;
        if self.content > FREE && self.content / LARGEST_RATIO > self.compressed.get() {
            return Err(io::Error::new(
                io::ErrorKind::InvalidData,
                format!(
                    "{} compressed bytes expand to more than {} MiB, over the limit of {LARGEST_RATIO} times their size; if you trust the file, decompress it first",
                    self.compressed.get(),
                    self.content >> 20
                ),
            ));
        }
        Ok(read)
    }
}

/// A reader that counts the bytes read from it.
pub struct Counted<R> {
    reader: R,
    count: Rc<Cell<u64>>,
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.reader.read(buffer)?;
        self.count.set(self.count.get() + read as u64);
        Ok(read)
    }
}

impl<R: BufRead> BufRead for Counted<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.reader.fill_buf()
    }

    fn consume(&mut self, amount: usize) {
        self.count.set(self.count.get() + amount as u64);
        self.reader.consume(amount);
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use flate2::bufread::MultiGzDecoder;
    use flate2::write::GzEncoder;

    use super::*;

    fn expanded(compressed: &[u8]) -> io::Result<u64> {
        io::copy(&mut Expansion::new(compressed, MultiGzDecoder::new), &mut io::sink())
    }

    fn compressed(content: impl Iterator<Item = Vec<u8>>) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), flate2::Compression::fast());
        content.for_each(|part| encoder.write_all(&part).unwrap());
        encoder.finish().unwrap()
    }

    #[test]
    fn a_bomb_is_refused_and_a_small_file_of_zeros_is_not() {
        let bomb = compressed((0..300).map(|_| vec![b' '; 1 << 20]));
        let error = expanded(&bomb).unwrap_err().to_string();
        assert!(error.contains("256 MiB") && error.contains("100 times"), "{error}");
        assert_eq!(expanded(&compressed((0..3).map(|_| vec![0; 1 << 20]))).unwrap(), 3 << 20);
    }
}
