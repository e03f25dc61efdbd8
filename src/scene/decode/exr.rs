use std::io::Cursor;

use exr::math::Vec2;
use exr::meta::MetaData;
use exr::prelude::{ReadChannels, ReadLayers, read};

use super::texels::{Floats, Unreadable};
use crate::film::fits;

/// Reads red, green and blue of the first layer of an OpenEXR file that has them, and alpha if asked; where there is
/// none, it is 1.
///
/// # Errors
/// If it is none, is damaged, or claims a size that it cannot have.
pub(in crate::scene) fn decode(bytes: &[u8], alpha: bool) -> Result<Floats, Unreadable> {
    let channels = if alpha { 4 } else { 3 };
    for header in MetaData::read_from_buffered(Cursor::new(bytes), false)?.headers {
        let [width, height] = [header.layer_size.width(), header.layer_size.height()];
        let length = (width as u64 * height as u64).saturating_mul(4 * channels as u64);
        fits(width, height, length, bytes).map_err(Unreadable::Unfit)?;
    }
    let (layers, bytes) = (read().no_deep_data().largest_resolution_level(), Cursor::new(bytes));
    let black = |size: Vec2<usize>| Floats::new(size.width(), size.height(), channels);
    let floats = if alpha {
        let put = |image: &mut Floats, at: Vec2<usize>, (r, g, b, a): (f32, f32, f32, f32)| {
            image.put(at.x(), at.y(), [r, g, b, a])
        };
        let layers = layers.rgba_channels(|size, _| black(size), put).first_valid_layer();
        layers.all_attributes().non_parallel().from_buffered(bytes)?.layer_data.channel_data.pixels
    } else {
        let put =
            |image: &mut Floats, at: Vec2<usize>, (r, g, b): (f32, f32, f32)| image.put(at.x(), at.y(), [r, g, b]);
        let layers = layers.rgb_channels(|size, _| black(size), put).first_valid_layer();
        layers.all_attributes().non_parallel().from_buffered(bytes)?.layer_data.channel_data.pixels
    };
    Ok(floats)
}
