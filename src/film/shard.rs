//! Divides an image into tiles, and the tiles among machines.

use serde::{Deserialize, Serialize};

use super::window::Window;

/// The side of a tile in pixels.
pub const TILE: u32 = 16;

/// One of several parts of an image, which can be rendered on different machines. A part consists of every n-th tile.
///
/// Parts have whole pixels, not a share of each pixel's samples: sums in another order would differ in their last bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    number: u32,
    count: u32,
}

impl Default for Shard {
    fn default() -> Self {
        Self::WHOLE
    }
}

/// A tile of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TilePlace {
    /// The index of the tile, counted row by row.
    pub number: u32,
    /// The first column and row in the window.
    pub corner: [u32; 2],
    /// The number of pixels per row.
    pub width: u32,
    /// The number of rows.
    pub height: u32,
}

impl Shard {
    /// The whole image.
    pub const WHOLE: Self = Self { number: 1, count: 1 };

    /// Returns part `number` of `count`, counted from 1, or none if there is no such part.
    pub fn new(number: u32, count: u32) -> Option<Self> {
        (1..=count).contains(&number).then_some(Self { number, count })
    }

    /// Returns the number of this part, counted from 1.
    pub fn number(self) -> u32 {
        self.number
    }

    /// Returns the number of parts of the image.
    pub fn count(self) -> u32 {
        self.count
    }

    /// Returns the tiles of a window that belong to this part, in ascending order of their numbers.
    pub fn tiles(self, window: Window) -> impl Iterator<Item = TilePlace> {
        let [columns, rows] = [window.width, window.height].map(|side| side.div_ceil(TILE));
        (self.number - 1..columns * rows).step_by(self.count as usize).map(move |number| {
            let corner = [number % columns * TILE, number / columns * TILE];
            let [width, height] = [window.width - corner[0], window.height - corner[1]].map(|left| left.min(TILE));
            TilePlace { number, corner, width, height }
        })
    }

    /// Returns the index, among the tiles of this part, of the one that contains a pixel of a window, and the index of
    /// the pixel in the tile. Returns none if the tile belongs to another part.
    pub fn place_of(self, window: Window, pixel: u32) -> Option<[usize; 2]> {
        let [x, y] = [pixel % window.width, pixel / window.width];
        let number = y / TILE * window.width.div_ceil(TILE) + x / TILE;
        let width = (window.width - x / TILE * TILE).min(TILE);
        let is_own = number % self.count == self.number - 1;
        is_own.then_some([(number / self.count) as usize, (y % TILE * width + x % TILE) as usize])
    }
}

impl TilePlace {
    /// Returns the number of pixels.
    pub fn pixels(self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Returns the index in the window of one of the tile's pixels.
    pub fn pixel(self, window: Window, place: u32) -> usize {
        let [x, y] = [self.corner[0] + place % self.width, self.corner[1] + place / self.width];
        y as usize * window.width as usize + x as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_of_an_image_have_each_of_its_pixels_once() {
        for (width, height) in [(1, 1), (16, 16), (75, 43), (17, 200)] {
            let window = Window { left: -3, top: 5, width, height };
            for count in [1, 2, 3, 7, 16, 64] {
                let mut found = vec![0; window.pixels() as usize];
                for shard in (1..=count).filter_map(|number| Shard::new(number, count)) {
                    for (index, tile) in shard.tiles(window).enumerate() {
                        for place in 0..tile.pixels() {
                            let pixel = tile.pixel(window, place as u32);
                            found[pixel] += 1;
                            assert_eq!(shard.place_of(window, pixel as u32), Some([index, place]));
                        }
                    }
                }
                assert!(found.iter().all(|&times| times == 1), "{width} x {height} in {count}");
            }
        }
    }

    #[test]
    fn there_is_no_part_before_the_first_or_beyond_the_last() {
        assert_eq!((Shard::new(0, 4), Shard::new(5, 4), Shard::new(1, 0)), (None, None, None));
    }
}
