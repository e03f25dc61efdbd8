//! Cryptomattes: which objects each pixel shows, and the coverage of each.
//!
//! Friedman & Jones 2015, *Fully automatic ID mattes with support for motion blur and transparency*. The layout follows
//! the Cryptomatte specification 1.2.0.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

/// The number of objects stored per pixel, two in each layer.
pub const RANKS: usize = 6;

/// The manifest of a matte: its names and their IDs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    /// The name of the matte, with which the names of its layers begin.
    pub name: Cow<'static, str>,
    /// Each name once, with its ID.
    pub entries: Vec<(String, u32)>,
}

impl Manifest {
    /// Creates a manifest from names that may occur several times.
    pub fn new<'a>(name: &'static str, names: impl Iterator<Item = &'a str>) -> Self {
        let mut entries: Vec<_> = names.map(|name| (name.to_owned(), id(name))).collect();
        entries.sort();
        entries.dedup();
        Self { name: name.into(), entries }
    }

    /// Returns the seven hexadecimal digits that identify the matte in the attributes of a file.
    pub fn key(&self) -> String {
        format!("{:08x}", hash(&self.name))[..7].to_owned()
    }

    /// Returns the names and IDs as a JSON object.
    pub fn json(&self) -> String {
        let entries = self.entries.iter().map(|(name, id)| (name.clone(), format!("{id:08x}").into()));
        serde_json::Value::Object(entries.collect()).to_string()
    }
}

/// Returns the ID of a name, whose bits are those of a finite f32 other than 0.
pub fn id(name: &str) -> u32 {
    let hash = hash(name);
    // An exponent of all zeros or all ones would make a denormal, an infinity or a NaN.
    match hash >> 23 & 0xff {
        0 | 0xff => hash ^ 1 << 23,
        _ => hash,
    }
}

fn hash(name: &str) -> u32 {
    murmur3::murmur3_32(&mut name.as_bytes(), 0).expect("memory can be read")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks the values given in the specification.
    #[test]
    fn names_have_the_numbers_of_the_specification() {
        assert_eq!((hash("torus"), id("torus")), (4_053_562_365, 0xf19c_73fd));
        assert_eq!(f32::from_bits(id("torus")), -1.549_436_2e30);
        assert_eq!(hash("равнина"), 2_518_896_926);
        let manifest = Manifest::new("CryptoObject", ["torus", "a \"b\"", "torus"].into_iter());
        assert_eq!(manifest.key(), "3ae39a5");
        assert!(manifest.json().contains("\"torus\":\"f19c73fd\"") && manifest.entries.len() == 2);
    }

    #[test]
    fn every_number_is_a_finite_float() {
        for i in 0..200_000 {
            let number = f32::from_bits(id(&format!("object {i}")));
            assert!(number.is_normal(), "{i}: {number}");
        }
    }
}
