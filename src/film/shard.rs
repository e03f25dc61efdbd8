//! An image in tiles, and the part of them that one machine makes.

use serde::{Deserialize, Serialize};

use super::window::Window;

/// Side of a tile in pixels.
pub const TILE: u32 = 16;

/// One of several parts of an image, which can be made on different machines: every n-th tile.
///
/// Parts have whole pixels, not samples of all: sums of samples in another order would have other last bits.
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
    /// Counted row by row.
    pub number: u32,
    /// Its first column and row in the window.
    pub corner: [u32; 2],
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Shard {
    /// The whole image.
    pub const WHOLE: Self = Self { number: 1, count: 1 };

    /// Part `number` of `count`, counted from 1; none if there is no such part.
    pub fn new(number: u32, count: u32) -> Option<Self> {
        (1..=count).contains(&number).then_some(Self { number, count })
    }

    /// Which one it is, counted from 1.
    pub fn number(self) -> u32 {
        self.number
    }

    /// Number of parts of the image.
    pub fn count(self) -> u32 {
        self.count
    }

    /// The tiles of a window that belong to this part, in ascending order of their numbers.
    pub fn tiles(self, window: Window) -> impl Iterator<Item = TilePlace> {
        let [columns, rows] = [window.width, window.height].map(|side| side.div_ceil(TILE));
        (self.number - 1..columns * rows).step_by(self.count as usize).map(move |number| {
            let corner = [number % columns * TILE, number / columns * TILE];
            let [width, height] = [window.width - corner[0], window.height - corner[1]].map(|left| left.min(TILE));
            TilePlace { number, corner, width, height }
        })
    }

    /// Where among its tiles the one is that holds a pixel of a window, and the pixel's place in it; none if it has no
    /// such tile.
    pub fn place_of(self, window: Window, pixel: u32) -> Option<[usize; 2]> {
        let [x, y] = [pixel % window.width, pixel / window.width];
        let number = y / TILE * window.width.div_ceil(TILE) + x / TILE;
        let width = (window.width - x / TILE * TILE).min(TILE);
        let own = number % self.count == self.number - 1;
        own.then_some([(number / self.count) as usize, (y % TILE * width + x % TILE) as usize])
    }
}

impl TilePlace {
    /// Number of pixels.
    pub fn pixels(self) -> usize {
        self.width as usize * self.height as usize
    }

    /// The number of one of its pixels in the window.
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
