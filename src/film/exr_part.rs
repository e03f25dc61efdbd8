//! The parts of an OpenEXR file, and their channels.

use exr::prelude::{FlatSamples, Vec2};

use super::exr_attributes::CameraMatrix;

/// A rectangle of pixels, y down. It may begin left of column 0 or above row 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelBounds {
    /// The first column and row.
    pub corner: [i64; 2],
    /// The number of columns and rows.
    pub size: [usize; 2],
}

impl PixelBounds {
    pub(super) fn new(position: Vec2<i32>, size: Vec2<usize>) -> Self {
        Self { corner: [position.x().into(), position.y().into()], size: [size.width(), size.height()] }
    }

    /// Returns the column and row of a pixel, given its index, counted row by row from the top left.
    pub fn place(&self, index: usize) -> [i64; 2] {
        [self.corner[0] + (index % self.size[0]) as i64, self.corner[1] + (index / self.size[0]) as i64]
    }

    /// Returns the index of a pixel, given its column and row.
    pub(crate) fn index(&self, [x, y]: [i64; 2]) -> usize {
        let [column, row] = [(x - self.corner[0]) as usize, (y - self.corner[1]) as usize];
        row * self.size[0] + column
    }

    /// Returns the number of pixels.
    pub(crate) fn pixels(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// Returns the intersection with another rectangle, if it is not empty.
    pub fn common(&self, other: &Self) -> Option<Self> {
        let corner = [0, 1].map(|axis| self.corner[axis].max(other.corner[axis]));
        let [ends, others] = [self, other].map(Self::last);
        let size = [0, 1].map(|axis| ends[axis].min(others[axis]) + 1 - corner[axis]);
        size.iter().all(|&size| size > 0).then(|| Self { corner, size: size.map(|size| size as usize) })
    }

    /// Returns the last column and row.
    pub fn last(&self) -> [i64; 2] {
        [0, 1].map(|axis| self.corner[axis] + self.size[axis] as i64 - 1)
    }
}

/// One image of a file, with its own channels.
#[derive(Clone, Debug)]
pub struct Part {
    /// The name of the part, which multipart files specify.
    pub name: Option<String>,
    /// The data window: the pixels that are present.
    pub bounds: PixelBounds,
    /// How the pixels are stored, such as `zip, scan lines from the top`.
    pub storage: String,
    /// The other attributes as text, sorted by their names in the file.
    pub attributes: Vec<(String, String)>,
    /// The world-to-camera matrix, if the file has one.
    pub camera: Option<CameraMatrix>,
    /// The channels in the order of the file.
    pub channels: Vec<Channel>,
}

impl Part {
    /// Crops the part to some of its pixels. Returns none if the part does not have all of them.
    pub(super) fn crop(&self, bounds: PixelBounds) -> Option<Self> {
        let [left, top] = [0, 1].map(|axis| (bounds.corner[axis] - self.bounds.corner[axis]) as usize);
        let row = |y: usize| {
            let first = (top + y) * self.bounds.size[0] + left;
            first..first + bounds.size[0]
        };
        let places = || (0..bounds.size[1]).flat_map(row);
        let channels = || self.channels.iter().map(|channel| channel.with_pixels(places())).collect();
        let is_whole = self.bounds.common(&bounds) == Some(bounds);
        is_whole.then(|| Self {
            name: self.name.clone(),
            bounds,
            storage: self.storage.clone(),
            attributes: self.attributes.clone(),
            camera: self.camera,
            channels: channels(),
        })
    }
}

/// One value per pixel.
#[derive(Clone, Debug)]
pub struct Channel {
    /// The prefix before the last dot of the full name. Empty at the root.
    pub layer: String,
    /// The rest of the name behind the dot, such as R.
    pub name: String,
    /// How many columns and rows of pixels share a value. Always 1 and 1 where values are read.
    pub sampling: [usize; 2],
    pub(super) samples: FlatSamples,
}

impl Channel {
    /// Creates a channel at the root that comes from no file.
    pub(crate) fn of_values(name: &str, values: Vec<f32>) -> Self {
        Self { layer: String::new(), name: name.to_owned(), sampling: [1, 1], samples: FlatSamples::F32(values) }
    }

    /// Returns the full name with the layer, as in the file.
    pub fn full_name(&self) -> String {
        if self.layer.is_empty() { self.name.clone() } else { format!("{}.{}", self.layer, self.name) }
    }

    fn with_pixels(&self, places: impl Iterator<Item = usize>) -> Self {
        let samples = match &self.samples {
            FlatSamples::F16(values) => FlatSamples::F16(places.map(|index| values[index]).collect()),
            FlatSamples::F32(values) => FlatSamples::F32(places.map(|index| values[index]).collect()),
            FlatSamples::U32(values) => FlatSamples::U32(places.map(|index| values[index]).collect()),
        };
        Self { layer: self.layer.clone(), name: self.name.clone(), sampling: self.sampling, samples }
    }

    /// Returns `half`, `float` or `uint`.
    pub fn kind(&self) -> &'static str {
        match self.samples {
            FlatSamples::F16(_) => "half",
            FlatSamples::F32(_) => "float",
            FlatSamples::U32(_) => "uint",
        }
    }

    /// Returns the value of a pixel, counted row by row from the top left of the data window.
    ///
    /// # Panics
    /// If there is no such pixel.
    pub fn at(&self, index: usize) -> f64 {
        match &self.samples {
            FlatSamples::F16(values) => values[index].to_f64(),
            FlatSamples::F32(values) => values[index].into(),
            FlatSamples::U32(values) => values[index].into(),
        }
    }

    /// Returns all values, row by row from the top left of the data window.
    pub fn values(&self) -> impl Iterator<Item = f64> {
        (0..self.samples.len()).map(|index| self.at(index))
    }

    /// Computes statistics over all values.
    pub fn statistics(&self) -> Statistics {
        let mut result =
            Statistics { nan: 0, infinite: 0, finite: 0, min: f64::INFINITY, max: f64::NEG_INFINITY, mean: 0.0 };
        for value in self.values() {
            if value.is_nan() {
                result.nan += 1;
            } else if value.is_infinite() {
                result.infinite += 1;
            } else {
                result.finite += 1;
                (result.min, result.max) = (result.min.min(value), result.max.max(value));
                result.mean += value;
            }
        }
        result.mean /= result.finite.max(1) as f64;
        result
    }
}

/// Statistics of the values of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// The number of NaN values.
    pub nan: usize,
    /// The number of infinite values of either sign.
    pub infinite: usize,
    /// The number of finite values. The other statistics refer to these.
    pub finite: usize,
    /// The minimum, or infinity if no value is finite.
    pub min: f64,
    /// The maximum, or minus infinity if no value is finite.
    pub max: f64,
    /// The mean, or 0 if no value is finite.
    pub mean: f64,
}
