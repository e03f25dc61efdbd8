//! The primaries of color profiles (ICC.1:2022) embedded in images.

/// Red, green and blue of sRGB in a profile: XYZ adapted to D50, from the profile of IEC 61966-2-1 that the
/// International Color Consortium publishes.
const SRGB: [(&[u8; 4], [f64; 3]); 3] =
    [(b"rXYZ", [0.4361, 0.2225, 0.0139]), (b"gXYZ", [0.3851, 0.7169, 0.0971]), (b"bXYZ", [0.1431, 0.0606, 0.7141])];
/// Profiles of sRGB differ from each other by less than this, those of other primaries by more.
const PRIMARY_TOLERANCE: f64 = 0.005;

/// Describes a profile whose primaries are not those of sRGB. Returns none for sRGB, and for a profile without
/// primaries, such as one made of tables.
pub(super) fn not_srgb(profile: &[u8]) -> Option<String> {
    let differs = |(tag, known): (&[u8; 4], [f64; 3])| {
        let found = primary(profile, tag)?;
        Some(found.iter().zip(known).any(|(found, known)| (found - known).abs() > PRIMARY_TOLERANCE))
    };
    let differing = SRGB.into_iter().map(differs).collect::<Option<Vec<bool>>>()?;
    differing.contains(&true).then(|| "a color profile (ICC) with other primaries".into())
}

/// Returns the XYZ of a primary from its tag: section 10.31 of the standard.
fn primary(profile: &[u8], tag: &[u8; 4]) -> Option<[f64; 3]> {
    let number = |at: usize| Some(u32::from_be_bytes(*profile.get(at..)?.first_chunk()?));
    // The header of 128 bytes is followed by the number of tags, then by the name, offset and size of each tag.
    let mut tags = (0..number(128)?.min(MAX_TAGS) as usize).map(|tag| 132 + 12 * tag);
    let entry = tags.find(|&entry| profile.get(entry..entry + 4) == Some(tag))?;
    let data = number(entry + 4)? as usize;
    let coordinate = |i: usize| Some(f64::from(number(data.checked_add(8 + 4 * i)?)? as i32) / 65536.0);
    Some([coordinate(0)?, coordinate(1)?, coordinate(2)?])
}

/// Maximum number of tags that are searched. Profiles have about twenty.
const MAX_TAGS: u32 = 1000;
