//! Images that light or color a scene.

use std::path::Path;

/// An image of linear Rec.709 numbers, rows from the top.
pub(super) struct LinearImage {
    pub(super) width: usize,
    pub(super) texels: Vec<[f32; 3]>,
}

/// Reads an OpenEXR or Radiance file from its bytes; the ending of its name says which it is.
///
/// # Errors
/// What is wrong with it, and what to do.
pub(super) fn read_image(path: &Path, bytes: &[u8]) -> Result<LinearImage, (String, Option<String>)> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase();
    let (kind, image) = match ending.as_str() {
        "exr" => ("OpenEXR", read_exr(bytes)),
        "hdr" => ("Radiance", read_radiance(bytes)),
        "png" | "jpg" | "jpeg" => {
            let help = "use an OpenEXR (.exr) or Radiance (.hdr) image";
            return Err((format!("a .{ending} image holds no light brighter than white"), Some(help.into())));
        }
        _ => {
            let help = "images end in .exr (OpenEXR) or .hdr (Radiance)";
            return Err((format!("the kind of image cannot be told from {:?}", path.display()), Some(help.into())));
        }
    };
    let unreadable = |said: String| {
        (format!("{} is no {kind} image ({said})", path.display()), Some("is the file complete?".to_owned()))
    };
    let image = image.map_err(unreadable)?;
    let wrong = image.texels.iter().position(|texel| texel.iter().any(|x| !x.is_finite() || *x < 0.0));
    match wrong {
        Some(at) => {
            let (x, y) = (at % image.width, at / image.width);
            let message = format!("{}: pixel ({x}, {y}) is {:?}", path.display(), image.texels[at]);
            Err((message, Some("light is finite and not negative".into())))
        }
        None => Ok(image),
    }
}

/// Most texels of an image: 16384 x 8192.
const MOST_TEXELS: usize = 1 << 27;

fn read_exr(bytes: &[u8]) -> Result<LinearImage, String> {
    use exr::prelude::{ReadChannels, ReadLayers, read};
    type Pixels = (usize, Vec<[f32; 3]>);
    let described = exr::meta::MetaData::read_from_buffered(std::io::Cursor::new(bytes), false);
    let headers = described.map_err(|error| error.to_string())?.headers;
    if let Some(header) = headers.iter().find(|header| header.layer_size.area() > MOST_TEXELS) {
        let size = header.layer_size;
        return Err(format!("{} x {} pixels are more than {MOST_TEXELS}", size.width(), size.height()));
    }
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgba_channels(
            |size, _| -> Pixels { (size.width(), vec![[0.0; 3]; size.area()]) },
            |(width, texels): &mut Pixels, at, (r, g, b, _): (f32, f32, f32, f32)| {
                texels[at.y() * *width + at.x()] = [r, g, b];
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(std::io::Cursor::new(bytes))
        .map_err(|error| error.to_string())?;
    let (width, texels) = image.layer_data.channel_data.pixels;
    Ok(LinearImage { width, texels })
}

fn read_radiance(bytes: &[u8]) -> Result<LinearImage, String> {
    let mut reader = image::ImageReader::with_format(std::io::Cursor::new(bytes), image::ImageFormat::Hdr);
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(12 * MOST_TEXELS as u64);
    reader.limits(limits);
    let image = reader.decode().map_err(|error| error.to_string())?.into_rgb32f();
    Ok(LinearImage { width: image.width() as usize, texels: image.pixels().map(|pixel| pixel.0).collect() })
}
