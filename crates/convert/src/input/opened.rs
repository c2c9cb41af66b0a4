//! An open file whose format is known.

use std::io::{self, BufRead, Cursor, Read};

use anyhow::{Context as _, bail};
use posecut_graph::InputDigest;
use posecut_stage::{Context, Input, Source, open};

use crate::FileFormat;

/// The number of bytes by which a format is recognised. A comment at the start of a file may be long.
const HEAD: u64 = 1 << 16;

/// The largest file that is read into memory as a whole: 1 GiB.
const LARGEST_WHOLE: u64 = 1 << 30;

/// A file, decompressed and hashed while it is read.
pub(super) struct Opened {
    /// What messages call it.
    pub(super) name: String,
    pub(super) format: FileFormat,
    bytes: io::Chain<Cursor<Vec<u8>>, Input>,
}

impl Opened {
    /// Opens a source and recognises its format, unless that is given.
    pub(super) fn open(
        source: &Source,
        format: Option<FileFormat>,
        context: &mut Context,
    ) -> anyhow::Result<Self> {
        let mut input = open(source)?;
        if let Source::File(path) = source {
            context.note_read(path);
        }
        let name = input.name.clone();
        let mut head = Vec::new();
        if format.is_none() {
            (&mut input)
                .take(HEAD)
                .read_to_end(&mut head)
                .with_context(|| format!("{name}: cannot be read"))?;
        }
        let Some(format) = format.or_else(|| recognised(source, &head)) else {
            bail!(
                "{name}: neither the content nor the name of the input determines its format; set --from to jsonl, g2o, toro, jrl, tum or kitti"
            );
        };
        Ok(Self { name, format, bytes: Cursor::new(head).chain(input) })
    }

    /// The whole content, of a format that cannot be read line by line.
    pub(super) fn whole(&mut self) -> anyhow::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let name = self.name.clone();
        self.take(LARGEST_WHOLE + 1)
            .read_to_end(&mut bytes)
            .with_context(|| format!("{name}: cannot be read to its end"))?;
        if bytes.len() as u64 > LARGEST_WHOLE {
            bail!("{name}: exceeds {} MiB, the largest size of a dataset; split it", LARGEST_WHOLE >> 20);
        }
        Ok(bytes)
    }

    /// Reads the file to its end and notes its digest for the provenance.
    pub(super) fn finish(self, context: &mut Context) -> anyhow::Result<()> {
        let name = self.name;
        let (_, input) = self.bytes.into_inner();
        let sha256 = input.finish().with_context(|| format!("{name}: cannot be read to its end"))?;
        let role = if self.format == FileFormat::Jsonl { "graph" } else { "input" };
        context.inputs.push(InputDigest { name: role.to_owned(), sha256 });
        Ok(())
    }
}

/// The format by the content, else by the name of the file. An empty input, or an unknown JSON object on standard input, is left to
/// the reader of JSON Lines, which says what is wrong.
fn recognised(source: &Source, head: &[u8]) -> Option<FileFormat> {
    let by_name = match source {
        Source::File(path) => FileFormat::of_name(path),
        Source::Standard => {
            let start = head.trim_ascii_start();
            (start.is_empty() || start.starts_with(b"{")).then_some(FileFormat::Jsonl)
        }
    };
    FileFormat::of_content(head).or(by_name)
}

impl Read for Opened {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.bytes.read(buffer)
    }
}

impl BufRead for Opened {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.bytes.fill_buf()
    }

    fn consume(&mut self, amount: usize) {
        self.bytes.consume(amount);
    }
}
