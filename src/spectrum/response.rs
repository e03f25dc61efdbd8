use super::{Draw, Lanes};

/// What each lane of one light is worth to the sensor: a matrix, 3 film channels x bins.
///
/// It belongs to the light a path ends in, so that a spiky illuminant can be integrated exactly whatever the lanes are.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    /// The film's red, green and blue of each bin.
    columns: Vec<[f64; 3]>,
}

impl Response {
    /// The response in which bin i is film channel i: the bands are the film's own primaries.
    pub fn identity() -> Self {
        Self { columns: vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] }
    }

    /// The film's red, green and blue of light that arrives in lanes.
    pub fn sensor<const N: usize>(&self, draw: &Draw<N>, lanes: Lanes<N>) -> [f64; 3] {
        let mut sensor = [0.0; 3];
        for lane in (0..N).filter(|&lane| lanes[lane] != 0.0) {
            let column = self.columns[draw.bin(lane)];
            for channel in 0..3 {
                sensor[channel] += column[channel] * f64::from(lanes[lane]);
            }
        }
        sensor
    }
}
