//! Ways to carry light in lanes that no render uses. Tests and benches compare with them.

use std::sync::Arc;

use super::basis::{Heroes, LaneKind};
use super::mixture::Mixture;
use super::{Basis, ColorSpace, Response};

/// Creates a basis of four wavelengths drawn independently for each sample, of which one continues where lanes part.
/// Pharr, Jakob & Humphreys 2023, *Physically Based Rendering*, sections 4.5.4 and 9.5.
pub fn collapsing(space: ColorSpace) -> Basis {
    let mut basis = Basis::wavelengths(space, vec![550.0], &[]);
    basis.heroes = Some(Heroes { count: 4, mixture: Arc::new(Mixture::visible()), collapse: true });
    basis
}

/// Creates a basis of one interpolated wavelength of another, worth to the sensor what it is worth among the others.
///
/// # Panics
/// If the lane is not an interpolated wavelength, or if its reflectances depend on all other lanes.
pub fn basis_of_lane(basis: &Basis, lane: usize) -> Basis {
    let LaneKind::Wavelengths(functions) = &basis.lanes else { panic!("bands have no wavelengths") };
    let mut alone = basis.clone();
    alone.lanes = LaneKind::Wavelengths(Arc::new(vec![functions[lane].clone()]));
    alone.wavelengths_nm = vec![basis.wavelengths_nm[lane]];
    alone.heroes = None;
    assert!(alone.projection.is_none(), "a projection is of all lanes together");
    alone
}

/// Returns a response that keeps one fixed lane and drops all others.
pub fn response_of_lane(response: &Response, lane: usize) -> Response {
    let columns = std::array::from_fn(|i| if i == lane { response.columns[i] } else { [0.0; 4] });
    Response { columns: Arc::new(columns), fine: vec![[0.0; 3]; response.fine.len()].into() }
}
