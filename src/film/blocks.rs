//! Files made of blocks with checksums, so that a truncated or altered file is detected before it is used.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | the kind of the file |
//! | 8, 4, n | per block: its length n, the CRC-32 of length and content, the content; numbers are little-endian |
//! | 8, 4 | the end: a block of length 0 |
//!
//! `postcard` encodes the numbers in a block. Floating-point numbers are stored bit by bit, so that sums continue
//! exactly where they stopped. CRC-32 detects every error burst of up to 32 bits (Koopman 2002, *32-Bit Cyclic
//! Redundancy Codes for Internet Applications*).

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::atomic_file::{cannot_read, cannot_write, replace_with};
use crate::error::{Error, Result};

/// The first bytes of a file, which identify its kind.
pub type Kind = [u8; 8];

/// The bytes of a block's length, and of its length and checksum.
const LENGTH_BYTES: usize = 8;
const HEAD_BYTES: usize = 12;

/// Writes a file of blocks, one block after another.
pub struct BlockWriter<'a> {
    output: &'a mut dyn Write,
    /// The block under construction.
    bytes: Vec<u8>,
}

/// Writes a file of blocks, either completely or not at all.
///
/// # Errors
/// If the file cannot be written. An existing file is then untouched.
pub fn write_blocks(path: &Path, kind: Kind, write: &dyn Fn(&mut BlockWriter) -> io::Result<()>) -> Result<()> {
    let written = |output: &mut dyn Write| {
        output.write_all(&kind)?;
        let mut blocks = BlockWriter { output, bytes: Vec::new() };
        write(&mut blocks)?;
        blocks.bytes.resize(HEAD_BYTES, 0);
        blocks.flush_block()
    };
    replace_with(path, |place| written(place).map_err(|source| cannot_write(path, source)))
}

impl BlockWriter<'_> {
    /// Writes the next block.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn block(&mut self, content: &impl Serialize) -> io::Result<()> {
        let mut bytes = std::mem::take(&mut self.bytes);
        bytes.resize(HEAD_BYTES, 0);
        self.bytes = postcard::to_extend(content, bytes).map_err(io::Error::other)?;
        self.flush_block()
    }

    /// Writes out the block under construction.
    fn flush_block(&mut self) -> io::Result<()> {
        let (head, content) = self.bytes.split_at_mut(HEAD_BYTES);
        let length = (content.len() as u64).to_le_bytes();
        head[..LENGTH_BYTES].copy_from_slice(&length);
        head[LENGTH_BYTES..].copy_from_slice(&checksum(length, content).to_le_bytes());
        self.output.write_all(&self.bytes)?;
        self.bytes.clear();
        Ok(())
    }
}

fn checksum(length: [u8; LENGTH_BYTES], content: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&length);
    hasher.update(content);
    hasher.finalize()
}

/// Reads a file of blocks, one block after another.
pub struct BlockReader {
    path: PathBuf,
    file: BufReader<File>,
    /// The number of bytes of the file that have been read, and that are left.
    place: u64,
    remaining: u64,
}

impl BlockReader {
    /// Opens a file, or returns none if it is of another kind.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn open(path: &Path, kind: Kind) -> Result<Option<Self>> {
        // Opening a pipe would block until somebody writes to it.
        let metadata = std::fs::metadata(path).map_err(|source| cannot_read(path, source))?;
        if !metadata.is_file() || metadata.len() < kind.len() as u64 {
            return Ok(None);
        }
        let (mut blocks, mut found) = (Self::open_at(path, 0)?, Kind::default());
        blocks.fill(&mut found)?;
        Ok((found == kind).then_some(blocks))
    }

    /// Opens a file again, at the [place](Self::place) where another reader left it.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn open_at(path: &Path, place: u64) -> Result<Self> {
        let opened = || {
            let mut file = File::open(path)?;
            let remaining = file.metadata()?.len().saturating_sub(place);
            file.seek(SeekFrom::Start(place))?;
            Ok(Self { path: path.to_owned(), file: BufReader::new(file), place, remaining })
        };
        opened().map_err(|source| cannot_read(path, source))
    }

    /// Returns the number of bytes read so far.
    pub fn place(&self) -> u64 {
        self.place
    }

    /// Reads the next block.
    ///
    /// # Errors
    /// [`Error::Decode`] if the block is damaged, or holds something other than a `T`.
    pub fn block<T: DeserializeOwned>(&mut self) -> Result<T> {
        let bytes = self.content()?;
        match postcard::take_from_bytes(&bytes) {
            Ok((content, [])) => Ok(content),
            // The checksum is right, so the content is undamaged.
            _ => {
                let message =
                    "it was written by another build of the renderer; read it with that build, or create it again";
                Err(Error::Decode { path: self.path.clone(), message: message.to_owned() })
            }
        }
    }

    /// Checks that no block is left.
    ///
    /// # Errors
    /// [`Error::Decode`] if a block is left, or the end is missing.
    pub fn end(mut self) -> Result<()> {
        if self.content()?.is_empty() && self.remaining == 0 { Ok(()) } else { Err(self.damaged()) }
    }

    fn content(&mut self) -> Result<Vec<u8>> {
        let mut head = [0; HEAD_BYTES];
        self.fill(&mut head)?;
        let length: [u8; LENGTH_BYTES] = std::array::from_fn(|i| head[i]);
        let sum: [u8; HEAD_BYTES - LENGTH_BYTES] = std::array::from_fn(|i| head[LENGTH_BYTES + i]);
        let bytes = u64::from_le_bytes(length);
        // A corrupted length must not exhaust the memory.
        if bytes > self.remaining {
            return Err(self.damaged());
        }
        let mut content = vec![0; bytes as usize];
        self.fill(&mut content)?;
        let is_whole = checksum(length, &content) == u32::from_le_bytes(sum);
        if is_whole { Ok(content) } else { Err(self.damaged()) }
    }

    fn fill(&mut self, bytes: &mut [u8]) -> Result<()> {
        if bytes.len() as u64 > self.remaining {
            return Err(self.damaged());
        }
        self.remaining -= bytes.len() as u64;
        self.place += bytes.len() as u64;
        self.file.read_exact(bytes).map_err(|source| cannot_read(&self.path, source))
    }

    /// Returns the error for a file that is not as it was written.
    pub fn damaged(&self) -> Error {
        let message = "it is damaged or truncated; delete it and create it again".to_owned();
        Error::Decode { path: self.path.clone(), message }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_with_other_content_is_distinguished_from_a_damaged_one() {
        let folder = tempfile::tempdir().expect("a folder");
        let (path, kind) = (folder.path().join("a.part"), *b"AbbeTest");
        write_blocks(&path, kind, &|blocks| blocks.block(&u32::MAX)).expect("it can be written");
        let read =
            || BlockReader::open(&path, kind).expect("it can be read").expect("it is of this kind").block::<u8>();
        let text_of = |error: Error| error.to_string();
        let another = text_of(read().expect_err("it is no byte"));
        assert!(another.contains("it was written by another build of the renderer"), "{another}");
        let mut bytes = std::fs::read(&path).expect("it is there");
        bytes[kind.len() + HEAD_BYTES] ^= 1;
        std::fs::write(&path, bytes).expect("it can be written");
        let damaged = text_of(read().expect_err("a bit is wrong"));
        assert!(damaged.contains("it is damaged or truncated"), "{damaged}");
    }
}
