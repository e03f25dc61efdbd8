use super::color::decode_srgb;

/// An image of linear Rec.709 colors or of single numbers, none of them negative; or of heights or directions.
#[derive(Clone, Debug)]
pub struct Image {
    width: usize,
    height: usize,
    /// 3, or 1 if all three are the same.
    channels: usize,
    texels: Texels,
    mean: [f64; 3],
    brightest: (usize, f32),
    most_colorful: [f32; 3],
}

/// The numbers of a texel side by side, in rows from the top.
#[derive(Clone, Debug)]
enum Texels {
    /// Numbers of 8 bits, and the value of each of the 256.
    Bytes(Vec<u8>, Box<[f32; 256]>),
    Floats(Vec<f32>),
}

/// What lies beyond the edges of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The image repeats.
    #[default]
    Repeat,
    /// The texels of its edge continue.
    Clamp,
    /// The image repeats, mirrored every other time.
    Mirror,
}

impl Image {
    /// Creates an image with 8 bits per number, which stand for sRGB or for 256 even steps from 0 to 1.
    ///
    /// # Panics
    /// If it has no texels, an incomplete row, or neither 1 nor 3 channels.
    pub fn of_bytes(width: usize, channels: usize, bytes: Vec<u8>, srgb: bool) -> Self {
        let value = |byte: usize| {
            let even = byte as f64 / 255.0;
            (if srgb { decode_srgb(even) } else { even }) as f32
        };
        Self::new(width, channels, Texels::Bytes(bytes, Box::new(std::array::from_fn(value))))
    }

    /// Creates an image with 8 bits per number, which stand for -128/127 to 1 so that 128 is exactly 0: the directions
    /// of a normal map.
    ///
    /// # Panics
    /// In the same cases as [`Image::of_bytes`].
    pub fn of_signed_bytes(width: usize, channels: usize, bytes: Vec<u8>) -> Self {
        let value = |byte: usize| ((byte as f64 - 128.0) / 127.0) as f32;
        Self::new(width, channels, Texels::Bytes(bytes, Box::new(std::array::from_fn(value))))
    }

    /// Creates an image of linear numbers, which are finite, and not negative if they are light.
    ///
    /// # Panics
    /// In the same cases as [`Image::of_bytes`].
    pub fn of_floats(width: usize, channels: usize, floats: Vec<f32>) -> Self {
        Self::new(width, channels, Texels::Floats(floats))
    }

    fn new(width: usize, channels: usize, texels: Texels) -> Self {
        let length = match &texels {
            Texels::Bytes(bytes, _) => bytes.len(),
            Texels::Floats(floats) => floats.len(),
        };
        assert!(
            width > 0 && length > 0 && (channels == 1 || channels == 3) && length.is_multiple_of(width * channels),
            "{length} numbers, {channels} a texel, {width} texels a row"
        );
        let (height, none) = (length / (width * channels), [0.0; 3]);
        let mut image =
            Self { width, height, channels, texels, mean: none, brightest: (0, 0.0), most_colorful: [0.0; 3] };
        let (mut sum, mut farthest) = ([0.0; 3], -1.0);
        for at in 0..width * height {
            let texel = image.texel_at(at);
            let [low, high] = [texel.into_iter().fold(f32::MAX, f32::min), texel.into_iter().fold(0.0, f32::max)];
            (0..3).for_each(|c| sum[c] += f64::from(texel[c]));
            if high > image.brightest.1 {
                image.brightest = (at, high);
            }
            let from_gray = (high - low) / high.max(f32::MIN_POSITIVE);
            if from_gray > farthest {
                (farthest, image.most_colorful) = (from_gray, texel);
            }
        }
        image.mean = sum.map(|x| x / (width * height) as f64);
        image
    }

    /// Returns the number of texels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns the number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Returns a texel, counted from the upper left corner.
    pub fn texel(&self, column: usize, row: usize) -> [f32; 3] {
        self.texel_at(row * self.width + column)
    }

    #[inline]
    fn texel_at(&self, at: usize) -> [f32; 3] {
        match (&self.texels, self.channels) {
            (Texels::Bytes(bytes, values), 1) => [values[usize::from(bytes[at])]; 3],
            (Texels::Bytes(bytes, values), _) => {
                let texel: &[u8; 3] = bytes[3 * at..].first_chunk().expect("rows are full");
                texel.map(|byte| values[usize::from(byte)])
            }
            (Texels::Floats(floats), 1) => [floats[at]; 3],
            (Texels::Floats(floats), _) => *floats[3 * at..].first_chunk().expect("rows are full"),
        }
    }

    /// Interpolates linearly between the centers of texels, at a place in texels from the upper left corner.
    pub fn bilinear(&self, place: [f64; 2], [across, down]: [Wrap; 2]) -> [f32; 3] {
        let [x, y] = place.map(|x| x - 0.5);
        let (left, above) = (x.floor(), y.floor());
        let (right, below) = ((x - left) as f32, (y - above) as f32);
        let columns = [0, 1].map(|i| across.index(left as isize + i, self.width));
        let rows = [0, 1].map(|i| down.index(above as isize + i, self.height));
        let [upper, lower] = rows.map(|row| columns.map(|column| self.texel(column, row)));
        std::array::from_fn(|c| {
            let mix = |[a, b]: [[f32; 3]; 2]| a[c] + right * (b[c] - a[c]);
            let (upper, lower) = (mix(upper), mix(lower));
            upper + below * (lower - upper)
        })
    }

    /// Returns the mean of all texels.
    pub fn mean(&self) -> [f64; 3] {
        self.mean
    }

    /// Returns the largest number, with the column and row of the first texel that has it.
    pub fn brightest(&self) -> ([usize; 2], f32) {
        let (at, value) = self.brightest;
        ([at % self.width, at / self.width], value)
    }

    /// Returns the texel whose numbers have the largest sum.
    pub fn lightest(&self) -> [f32; 3] {
        let sum = |texel: &[f32; 3]| texel.iter().sum::<f32>();
        let texels = (0..self.width * self.height).map(|at| self.texel_at(at));
        texels.max_by(|a, b| sum(a).total_cmp(&sum(b))).unwrap_or_default()
    }

    /// Returns the first of the texels that are farthest from gray, relative to their brightness.
    pub fn most_colorful(&self) -> [f32; 3] {
        self.most_colorful
    }
}

impl Wrap {
    /// Returns where a place lies in the image, 0 to 1.
    pub(super) fn coordinate(self, x: f64) -> f64 {
        match self {
            Self::Repeat => x - x.floor(),
            Self::Clamp => x.clamp(0.0, 1.0),
            Self::Mirror => {
                let x = x - 2.0 * (0.5 * x).floor();
                if x > 1.0 { 2.0 - x } else { x }
            }
        }
    }

    /// Returns the column or row at a position, which may lie one beyond either end.
    pub fn index(self, at: isize, count: usize) -> usize {
        match self {
            Self::Repeat => at.rem_euclid(count as isize) as usize,
            Self::Clamp | Self::Mirror => at.clamp(0, count as isize - 1) as usize,
        }
    }
}
