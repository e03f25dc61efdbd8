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
mod offset;
mod ray;
mod sampler;
mod transform;
mod warp;

pub use bounds::Bounds;
pub use complex::Complex;
pub use cone::Cone;
pub use distribution::{BELOW_ONE, DiscreteSample, Distribution, Distribution2d};
pub use frame::{Frame, level};
pub use gauss::gauss_legendre;
pub use interpolate::interpolate;
pub use median::median;
pub use neighbors::neighbors;
pub use offset::{UNIT_ROUNDOFF, gamma, offset_origin};
pub use ray::{Ray, unit};
pub use sampler::{BranchKey, Sampler, mix, seed_of};
pub use transform::Transform;
pub use warp::{
    ball_surface, cone, cosine_about, cosine_hemisphere, disk, disk_in_square, one_minus_cos_of_cone,
    square_around_disk, triangle_coordinates, triangle_square,
};

/// Points and directions are 64-bit everywhere: see the rows S1 to X7 of `tests/stability_shapes.rs`.
pub use glam::{DMat2, DMat3, DVec2, DVec3};
