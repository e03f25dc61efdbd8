//! The parts of the command, a client of the library: its arguments, its messages and the files that it keeps.

pub mod catalog;
pub mod cli;
pub mod diff;
pub mod events;
mod frames;
pub mod info;
pub mod keep;
mod manual;
mod meant;
pub mod merge;
pub mod messages;
mod openjd;
pub mod outputs;
mod problem;
pub mod progress;
pub mod signals;
mod stdout;
pub mod view;
