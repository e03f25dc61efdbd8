//! PLY files as stored on disk: a header, and elements in lines or in bytes.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    DefaultElement, ElementDef, Encoding, Header, Property, PropertyAccess, PropertyType, ScalarType,
};

/// A file whose header has been read.
pub(super) struct Body {
    pub(super) header: Header,
    rest: Reader<BufReader<File>>,
    /// The byte that ends each line.
    line_end: u8,
    /// Number of lines that have been read.
    lines: usize,
}

/// Number of elements that are read at once. Each takes several times the memory of what is kept of it.
const BATCH_SIZE: usize = 4096;

impl Body {
    /// Reads the header. Its comments may be in any encoding.
    pub(super) fn open(path: &Path) -> Result<Self, String> {
        let mut file = BufReader::new(File::open(path).map_err(|error| error.to_string())?);
        // Otherwise the end of the first line would be searched for, however far away it is.
        let first = file.fill_buf().map_err(|error| error.to_string())?;
        if !first.starts_with(b"ply") {
            return Err("a PLY file begins with a line `ply`, but this one does not".into());
        }
        let line_end = find_line_end(first);
        let (mut bytes, mut lines, mut is_whole) = (Vec::new(), 0, false);
        while !is_whole {
            let start = bytes.len();
            file.read_until(line_end, &mut bytes).map_err(|error| error.to_string())?;
            is_whole = bytes.len() == start || bytes[start..].trim_ascii() == b"end_header";
            lines += 1;
        }
        let text = String::from_utf8_lossy(&bytes).replace(char::from(line_end), "\n");
        let header = Parser::<DefaultElement>::new().read_header(&mut Reader::new(text.as_bytes()));
        let header = header.map_err(|error| ply_error(error, true))?;
        Ok(Self { header, rest: Reader::new(file), line_end, lines })
    }

    pub(super) fn has_lines(&self) -> bool {
        self.header.encoding == Encoding::Ascii
    }

    /// Calls `keep` with all elements of one kind, one after the other.
    pub(super) fn elements<E: PropertyAccess>(
        &mut self,
        element: &ElementDef,
        mut keep: impl FnMut(E),
    ) -> Result<(), String> {
        if self.has_lines() {
            return self.read_text_elements(element, keep);
        }
        let (parser, mut batch) = (Parser::<E>::new(), element.clone());
        for done in (0..element.count).step_by(BATCH_SIZE) {
            batch.count = BATCH_SIZE.min(element.count - done);
            let read = parser.read_payload_for_element(&mut self.rest, &batch, &self.header);
            let with_totals = |error| with_total_counts(&ply_error(error, false), batch.count, done, element.count);
            read.map_err(with_totals)?.into_iter().for_each(&mut keep);
        }
        Ok(())
    }

    /// Reads elements from lines. The parser of the crate accepts neither `nan` nor numbers such as `1.` and `.5`.
    fn read_text_elements<E: PropertyAccess>(
        &mut self,
        element: &ElementDef,
        mut keep: impl FnMut(E),
    ) -> Result<(), String> {
        let ElementDef { name, count, properties } = element;
        let mut line = Vec::new();
        for done in 0..*count {
            line.clear();
            while line.trim_ascii().is_empty() {
                line.clear();
                let read =
                    self.rest.get_mut().read_until(self.line_end, &mut line).map_err(|error| error.to_string())?;
                if read == 0 {
                    let message = format!("while reading element '{name}' (expected {count}, got {done})");
                    return Err(format!("the file ends too early, {message}"));
                }
                self.lines += 1;
                if properties.is_empty() {
                    break;
                }
            }
            let read = parse_element(&String::from_utf8_lossy(&line), element);
            keep(read.ok_or_else(|| misfit_message(self.lines))?);
        }
        Ok(())
    }
}

/// Returns the byte that ends a line. In old Macintosh files it is a carriage return alone.
fn find_line_end(text: &[u8]) -> u8 {
    let first = text.iter().position(|byte| matches!(byte, b'\r' | b'\n')).unwrap_or(0);
    match text.get(first..) {
        Some([b'\r', next, ..]) if !matches!(next, b'\r' | b'\n') => b'\r',
        _ => b'\n',
    }
}

/// Reads a value with `$read` and wraps it as a property of its type.
macro_rules! property {
    ($kind:expr, $read:expr, $($type:ident => $property:ident),*) => {
        match $kind {
            $(ScalarType::$type => Property::$property($read?),)*
        }
    };
}

/// Reads the element in a line, or returns `None` if the line does not match the header.
fn parse_element<E: PropertyAccess>(line: &str, element: &ElementDef) -> Option<E> {
    let (mut words, mut read) = (line.split_ascii_whitespace(), E::new());
    for (name, property) in &element.properties {
        let value = match &property.data_type {
            PropertyType::Scalar(kind) => property!(kind, words.next()?.parse().ok(),
                Char => Char, UChar => UChar, Short => Short, UShort => UShort,
                Int => Int, UInt => UInt, Float => Float, Double => Double),
            PropertyType::List(_, kind) => {
                let count: usize = words.next()?.parse().ok()?;
                property!(kind, (0..count).map(|_| words.next()?.parse().ok()).collect::<Option<_>>(),
                    Char => ListChar, UChar => ListUChar, Short => ListShort, UShort => ListUShort,
                    Int => ListInt, UInt => ListUInt, Float => ListFloat, Double => ListDouble)
            }
        };
        read.set_property(name, value);
    }
    Some(read)
}

fn misfit_message(line: usize) -> String {
    format!("line {line} does not fit a PLY file with this header")
}

/// Returns a message about the end of a file with the numbers of all elements instead of those of a batch.
fn with_total_counts(message: &str, batch: usize, done: usize, all: usize) -> String {
    let numbers = message.split_once(&format!("(expected {batch}, got "));
    let numbers = numbers.and_then(|(before, rest)| Some((before, rest.split_once(')')?)));
    match numbers {
        Some((before, (got, after))) => match got.parse::<usize>() {
            Ok(got) => format!("{before}(expected {all}, got {}){after}", done + got),
            Err(_) => message.to_owned(),
        },
        None => message.to_owned(),
    }
}

/// Returns the error message for a file, or for a part of it that has lines or none.
fn ply_error(error: ParseError, has_lines: bool) -> String {
    let text = error.to_string();
    let first = text.lines().next().unwrap_or_default().trim_end_matches('.');
    let message = first.split_once(": ").map_or(first, |(_, message)| message);
    match (message.strip_prefix("Unexpected end of file"), error.line()) {
        (Some(place), _) => format!("the file ends too early,{place}"),
        (None, Some(line)) if has_lines => misfit_message(line),
        (None, Some(_)) => "its bytes do not fit a PLY file with this header".into(),
        (None, None) => message.to_owned(),
    }
}
