//! The parts of an OpenEXR file, and their channels.

use exr::prelude::{FlatSamples, Vec2};

use super::exr_attributes::CameraMatrix;

/// A rectangle of pixels, y down; it may begin left of column 0 or above row 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelBounds {
    /// Its first column and row.
    pub corner: [i64; 2],
    /// Columns and rows.
    pub size: [usize; 2],
}

impl PixelBounds {
    pub(super) fn new(position: Vec2<i32>, size: Vec2<usize>) -> Self {
        Self { corner: [position.x().into(), position.y().into()], size: [size.width(), size.height()] }
    }

    /// The column and row of a pixel by its number, counted row by row from the top left.
    pub fn place(&self, index: usize) -> [i64; 2] {
        [self.corner[0] + (index % self.size[0]) as i64, self.corner[1] + (index / self.size[0]) as i64]
    }

    /// The number of a pixel by its column and row.
    pub(crate) fn index(&self, [x, y]: [i64; 2]) -> usize {
        let [column, row] = [(x - self.corner[0]) as usize, (y - self.corner[1]) as usize];
        row * self.size[0] + column
    }

    /// Number of pixels.
    pub(crate) fn pixels(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// The pixels that another one holds as well, if there are any.
    pub fn common(&self, other: &Self) -> Option<Self> {
        let corner = [0, 1].map(|axis| self.corner[axis].max(other.corner[axis]));
        let [ends, others] = [self, other].map(Self::last);
        let size = [0, 1].map(|axis| ends[axis].min(others[axis]) + 1 - corner[axis]);
        size.iter().all(|&size| size > 0).then(|| Self { corner, size: size.map(|size| size as usize) })
    }

    /// The last column and row.
    pub fn last(&self) -> [i64; 2] {
        [0, 1].map(|axis| self.corner[axis] + self.size[axis] as i64 - 1)
    }
}

/// One image of a file, with channels of its own.
#[derive(Debug)]
pub struct Part {
    /// Its name, which files of several parts give.
    pub name: Option<String>,
    /// The data window: the pixels that are there.
    pub bounds: PixelBounds,
    /// How its pixels are packed, such as `zip, scan lines`.
    pub storage: String,
    /// The other attributes by their names in the file, in their order, as words.
    pub attributes: Vec<(String, String)>,
    /// World to camera, if it is told.
    pub camera: Option<CameraMatrix>,
    /// In the order of the file.
    pub channels: Vec<Channel>,
}

impl Part {
    /// The part cut to some of its pixels; none if it does not have all of them.
    pub(super) fn cut(&self, bounds: PixelBounds) -> Option<Self> {
        let [left, top] = [0, 1].map(|axis| (bounds.corner[axis] - self.bounds.corner[axis]) as usize);
        let row = |y: usize| {
            let first = (top + y) * self.bounds.size[0] + left;
            first..first + bounds.size[0]
        };
        let places = || (0..bounds.size[1]).flat_map(row);
        let channels = || self.channels.iter().map(|channel| channel.of_pixels(places())).collect();
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

/// One number of every pixel.
#[derive(Debug)]
pub struct Channel {
    /// What stands before the last dot of its name; empty at the root.
    pub layer: String,
    /// What stands behind it, such as R.
    pub name: String,
    /// How many columns and rows of pixels share a value; 1 and 1 where values are read.
    pub sampling: [usize; 2],
    pub(super) samples: FlatSamples,
}

impl Channel {
    /// One at the root that is in no file.
    pub(crate) fn of_values(name: &str, values: Vec<f32>) -> Self {
        Self { layer: String::new(), name: name.to_owned(), sampling: [1, 1], samples: FlatSamples::F32(values) }
    }

    /// Layer and name, as the file has them.
    pub fn full_name(&self) -> String {
        if self.layer.is_empty() { self.name.clone() } else { format!("{}.{}", self.layer, self.name) }
    }

    fn of_pixels(&self, places: impl Iterator<Item = usize>) -> Self {
        let samples = match &self.samples {
            FlatSamples::F16(values) => FlatSamples::F16(places.map(|at| values[at]).collect()),
            FlatSamples::F32(values) => FlatSamples::F32(places.map(|at| values[at]).collect()),
            FlatSamples::U32(values) => FlatSamples::U32(places.map(|at| values[at]).collect()),
        };
        Self { layer: self.layer.clone(), name: self.name.clone(), sampling: self.sampling, samples }
    }

    /// `half`, `float` or `uint`.
    pub fn kind(&self) -> &'static str {
        match self.samples {
            FlatSamples::F16(_) => "half",
            FlatSamples::F32(_) => "float",
            FlatSamples::U32(_) => "uint",
        }
    }

    /// The value of a pixel, counted row by row from the top left of the data window.
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

    /// All values, row by row from the top left of the data window.
    pub fn values(&self) -> impl Iterator<Item = f64> {
        (0..self.samples.len()).map(|index| self.at(index))
    }

    /// What can be said of all values at once.
    pub fn statistics(&self) -> Statistics {
        let mut found =
            Statistics { nan: 0, infinite: 0, finite: 0, min: f64::INFINITY, max: f64::NEG_INFINITY, mean: 0.0 };
        for value in self.values() {
            if value.is_nan() {
                found.nan += 1;
            } else if value.is_infinite() {
                found.infinite += 1;
            } else {
                found.finite += 1;
                (found.min, found.max) = (found.min.min(value), found.max.max(value));
                found.mean += value;
            }
        }
        found.mean /= found.finite.max(1) as f64;
        found
    }
}

/// How many values of a channel there are, and how large the finite ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// Values that are no numbers.
    pub nan: usize,
    /// Values that are infinite, of either sign.
    pub infinite: usize,
    /// The others, over which the rest is taken.
    pub finite: usize,
    /// The least; infinity where none is finite.
    pub min: f64,
    /// The largest; minus infinity where none is finite.
    pub max: f64,
    /// Their mean; 0 where none is finite.
    pub mean: f64,
}
