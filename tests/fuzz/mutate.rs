//! Damage to files: random bytes, truncation, numbers that are too large, and pieces of other files of the same kind.

/// Random numbers that are the same on every machine (SplitMix64; Steele, Lea & Flood 2014).
pub struct Dice(u64);

impl Dice {
    pub fn new(seed: u64) -> Self {
        let mut dice = Self(seed);
        dice.0 = dice.bits();
        dice
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }

    /// Returns a number below `most`, or 0 if `most` is 0.
    pub fn below(&mut self, most: usize) -> usize {
        (self.bits() % most.max(1) as u64) as usize
    }

    fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())]
    }

    /// Returns a place in a file. Half of the time it is near the beginning, where headers are.
    fn place(&mut self, length: usize) -> usize {
        match self.below(2) {
            0 => self.below(length.min(192)),
            _ => self.below(length),
        }
    }
}

/// Numbers at the limits of the integer types that formats use for counts, and powers of two next to them.
const COUNTS: [u64; 18] = [
    0,
    1,
    2,
    3,
    0x7f,
    0x80,
    0xff,
    0x100,
    0x7fff,
    0xffff,
    0x1_0000,
    0x00ff_ffff,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x1_0000_0000,
    0x7fff_ffff_ffff_ffff,
    u64::MAX,
];

/// Numbers at and near the limits of types, for text formats.
const NUMBERS: [&str; 26] = [
    "nan",
    "inf",
    "-inf",
    "0",
    "-0.0",
    "-1",
    "1",
    "2.5",
    "255",
    "256",
    "65536",
    "5000000",
    "1000000000",
    "2147483648",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "18446744073709551615",
    "99999999999999999999",
    "-9223372036854775808",
    "1e-320",
    "1e-30",
    "1e30",
    "-1e308",
    "1e999",
    "0x7f",
];

/// Returns a damaged copy of a file. `words` are the words of its format.
pub fn mutated_copy(dice: &mut Dice, corpus: &[Vec<u8>], words: &[&str]) -> Vec<u8> {
    let mut bytes = corpus[dice.below(corpus.len())].clone();
    let changes = dice.pick(&[1, 1, 1, 2, 3, 6]);
    for _ in 0..changes {
        change(dice, &mut bytes, corpus, words);
    }
    bytes
}

fn change(dice: &mut Dice, bytes: &mut Vec<u8>, corpus: &[Vec<u8>], words: &[&str]) {
    let at = dice.place(bytes.len());
    let most = dice.pick(&[4, 16, 256]);
    let end = (at + 1 + dice.below(most)).min(bytes.len());
    match dice.below(12) {
        _ if bytes.is_empty() => bytes.push(dice.below(256) as u8),
        0 => bytes[at] ^= 1 << dice.below(8),
        1 => bytes[at] = dice.below(256) as u8,
        2 => bytes.truncate(at),
        3 => drop(bytes.drain(at..end)),
        4 => {
            let piece = bytes[at..end].to_vec();
            let times = 1 + dice.below(3);
            let to = dice.place(bytes.len());
            bytes.splice(to..to, piece.repeat(times));
        }
        5 => {
            let piece: Vec<u8> = (at..end).map(|_| dice.below(256) as u8).collect();
            bytes.splice(at..at, piece);
        }
        6 | 7 => {
            let (number, width) = (dice.pick(&COUNTS), dice.pick(&[1, 2, 4, 4, 4, 8]));
            let little = number.to_le_bytes()[..width].to_vec();
            let piece: Vec<u8> = if dice.below(2) == 0 { little } else { little.into_iter().rev().collect() };
            let end = (at + width).min(bytes.len());
            bytes.splice(at..end, piece);
        }
        8 => {
            let other = &corpus[dice.below(corpus.len())];
            bytes.truncate(at);
            bytes.extend_from_slice(&other[dice.place(other.len())..]);
        }
        9 | 10 => {
            if let Some((start, end)) = run_from(bytes, at, |c| c.is_ascii_digit() || b"+-.".contains(&c)) {
                bytes.splice(start..end, dice.pick(&NUMBERS).bytes());
            }
        }
        _ if words.is_empty() => bytes[at] = dice.pick(&COUNTS) as u8,
        _ => {
            let word = dice.pick(words);
            let run = run_from(bytes, at, |c| c.is_ascii_alphabetic() || c == b'_').unwrap_or((at, at));
            bytes.splice(run.0..run.1, word.bytes());
        }
    }
}

/// Returns the start and end of the run of matching bytes that contains a place or comes first after it.
fn run_from(bytes: &[u8], at: usize, belongs: impl Fn(u8) -> bool) -> Option<(usize, usize)> {
    let start = at + bytes[at..].iter().position(|&c| belongs(c))?;
    let start = bytes[..start].iter().rposition(|&c| !belongs(c)).map_or(0, |before| before + 1);
    let end = bytes[start..].iter().position(|&c| !belongs(c)).map_or(bytes.len(), |length| start + length);
    Some((start, end))
}

/// Recomputes the checksums of a PNG's chunks, so that damage inside them reaches the decoder.
pub fn with_checksums(bytes: &mut [u8]) {
    let mut at = 8;
    while let Some(length) = bytes.get(at..at + 4) {
        let length = u32::from_be_bytes(length.try_into().expect("four bytes")) as usize;
        let Some(end) = at.checked_add(8 + length).filter(|end| end + 4 <= bytes.len()) else { return };
        let sum = crc32fast::hash(&bytes[at + 4..end]);
        bytes[end..end + 4].copy_from_slice(&sum.to_be_bytes());
        at = end + 4;
    }
}

/// Sets the lengths in a binary glTF file to those that its chunks have.
pub fn with_lengths(bytes: &mut [u8]) {
    let Some(binary) = bytes.windows(4).position(|four| four == b"BIN\0").filter(|&at| at >= 24) else { return };
    let number = |n: usize| (n as u32).to_le_bytes();
    let (whole, json, rest) = (number(bytes.len()), number(binary - 4 - 20), number(bytes.len() - binary - 4));
    for (at, number) in [(8, whole), (12, json), (binary - 4, rest)] {
        bytes[at..at + 4].copy_from_slice(&number);
    }
}
