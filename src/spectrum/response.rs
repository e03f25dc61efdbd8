use super::{Draw, Lanes};

/// What each lane of one light is worth to the sensor: a matrix, 3 film channels x bins.
///
/// It belongs to the light a path ends in, so that a spiky illuminant can be integrated exactly whatever the lanes are.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    rows: [Vec<f64>; 3],
}

impl Response {
    /// The response in which bin i is film channel i: the bands are the film's own primaries.
    pub fn identity() -> Self {
        Self { rows: [vec![1.0, 0.0, 0.0], vec![0.0, 1.0, 0.0], vec![0.0, 0.0, 1.0]] }
    }

    /// The film's red, green and blue of light that arrives in lanes.
    pub fn sensor<const N: usize>(&self, draw: &Draw<N>, lanes: Lanes<N>) -> [f64; 3] {
        std::array::from_fn(|channel| {
            let row = &self.rows[channel];
            (0..N).filter(|&i| lanes[i] != 0.0).map(|i| row[draw.bin(i)] * f64::from(lanes[i])).sum()
        })
    }
}
