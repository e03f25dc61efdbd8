//! Helpers shared by several tests. Each test uses only some of them.

#![allow(dead_code)]

pub mod bodies;
pub mod chi_squared;
pub mod colors;
pub mod exact;
pub mod fresnel;
pub mod larger;
pub mod materials;
pub mod parallel;
pub mod pictures;
pub mod random;
pub mod repository;
pub mod run;
pub mod scenes;
