//! Ways to carry light in lanes that no render uses: tests and benches compare with them.

use std::sync::Arc;

use super::basis::{Heroes, LaneKind};
use super::mixture::Mixture;
use super::{Basis, ColorSpace, Response};

/// Four wavelengths drawn independently from sample to sample, of which one goes on where lanes part. Pharr, Jakob &
/// Humphreys 2023, *Physically Based Rendering*, sections 4.5.4 and 9.5.
pub fn collapsing(space: ColorSpace) -> Basis {
    let mut basis = Basis::wavelengths(space, vec![550.0], &[]);
    basis.heroes = Some(Heroes { count: 4, mixture: Arc::new(Mixture::visible()), collapse: true });
    basis
}

/// One of the interpolated wavelengths of a basis alone, worth to the sensor what it is worth among the others.
///
/// # Panics
/// If the lane is no interpolated wavelength, or reads reflectances by way of all others.
pub fn alone(basis: &Basis, lane: usize) -> Basis {
    let LaneKind::Wavelengths(functions) = &basis.lanes else { panic!("bands have no wavelengths") };
    let mut alone = basis.clone();
    alone.lanes = LaneKind::Wavelengths(Arc::new(vec![functions[lane].clone()]));
    alone.wavelengths_nm = vec![basis.wavelengths_nm[lane]];
    alone.heroes = None;
    assert!(alone.projection.is_none(), "a projection is of all lanes together");
    alone
}

/// The same response to one fixed lane and none to the others.
pub fn only(response: &Response, lane: usize) -> Response {
    let columns = std::array::from_fn(|i| if i == lane { response.columns[i] } else { [0.0; 4] });
    Response { columns: Arc::new(columns), fine: vec![[0.0; 3]; response.fine.len()].into() }
}
