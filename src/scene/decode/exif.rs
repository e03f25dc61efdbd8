//! The orientation of a photo's camera (JEITA 2023, *Exif 3.0*, section 4.6.5).

/// Returns whether a photo has to be turned or mirrored to be upright.
pub(super) fn is_rotated(exif: &[u8]) -> bool {
    orientation(exif).is_some_and(|orientation| (2..=8).contains(&orientation))
}

/// Returns the orientation from its tag in the first directory: TIFF 6.0, section 2.
fn orientation(exif: &[u8]) -> Option<u16> {
    const ORIENTATION: u16 = 0x112;
    const SHORT: u16 = 3;
    let is_big = match exif.get(..4)? {
        b"MM\0*" => true,
        b"II*\0" => false,
        _ => return None,
    };
    let short = |at: usize| {
        let bytes = *exif.get(at..)?.first_chunk()?;
        Some(if is_big { u16::from_be_bytes(bytes) } else { u16::from_le_bytes(bytes) })
    };
    let first = *exif.get(4..)?.first_chunk()?;
    let first = if is_big { u32::from_be_bytes(first) } else { u32::from_le_bytes(first) } as usize;
    let mut entries = (0..usize::from(short(first)?)).map(|entry| first + 2 + 12 * entry);
    let entry = entries.find(|&entry| short(entry) == Some(ORIENTATION) && short(entry + 2) == Some(SHORT))?;
    short(entry + 8)
}
