//! Floor 0: points, directions and random numbers. Depends on no other room.

mod bounds;
mod complex;
mod cone;
mod distribution;
mod frame;
mod gauss;
mod interpolate;
mod median;
mod neighbors;
mod ray;
mod rounding;
mod sampler;
mod sampling;
mod transform;

pub use bounds::Bounds;
pub use complex::Complex;
pub use cone::Cone;
pub use distribution::{BELOW_ONE, DiscreteSample, Distribution, Distribution2d};
pub use frame::{Frame, horizontal_tangent};
pub use gauss::gauss_legendre;
pub use interpolate::interpolate;
pub use median::median;
pub use neighbors::group_neighbors;
pub use ray::{Ray, unit};
pub use rounding::{UNIT_ROUNDOFF, gamma, offset_origin};
pub use sampler::{BranchKey, Sampler, derive_seed, mix_bits};
pub use sampling::{
    cone, disk_to_square, one_minus_cos_of_cone, sample_cosine_about, sample_cosine_hemisphere, sample_disk,
    sample_sphere, sample_triangle, square_to_disk, triangle_to_square,
};
pub use transform::Transform;

/// Points and directions are 64-bit everywhere: see the rows S1 to X7 of `tests/stability_shapes.rs`.
pub use glam::{DMat2, DMat3, DVec2, DVec3};
